//! The one place that names the SIMD crate, and the kernels written with it.
//!
//! A kernel is an `#[inline(always)]` function over any instruction set `S: Simd`; whoever runs
//! it enters once a batch through [`dispatch!`] with a [`SimdLevel`]. Vectors have [`LANES`]
//! lanes of 32 bits everywhere; where registers are narrower, one vector is several of them.
//!
//! Arrays of vectors are built entry by entry, never by `array::map`: it is not inlined, and a call
//! from code compiled for AVX-512 to code that is not passes every vector through memory.
//!
//! Operations are IEEE 754 without fused multiply-add wherever a result is visible, so every
//! level gives the same bits.

pub mod aligned_rays;
pub mod axes;
pub mod cone_sphere;
pub mod face;
pub mod face_boxes;
mod face_rare;
pub mod face_rows;
#[cfg(test)]
mod face_tests;
pub mod face_triangle;
mod least_of_each;
pub mod neighbours;
pub mod point_box;
mod point_columns;
pub mod power;
pub mod ray_beams;
pub mod ray_boxes;
pub mod ray_lanes;
pub mod ray_sphere;
pub mod ray_triangle;
pub mod segment_spheres;
pub mod segment_walls;
pub mod space_curve;
pub mod sphere_blocks;
pub mod strip_rows;
pub mod triangle_boxes;
pub mod triangle_lanes;
pub mod triangle_rows;

use std::fmt;
use std::hash::{Hash, Hasher};

use fearless_simd::f32x4;
pub use fearless_simd::prelude::*;
pub use fearless_simd::{Simd, dispatch, f32x16, mask32x16, u32x16};

pub use self::point_columns::point_columns;

/// Lanes of every vector.
pub const LANES: usize = 16;

/// One value a lane.
pub type Lanes = [f32; LANES];

/// The instruction set that kernels run on: found at run time, forced for tests.
///
/// It never changes an answer.
#[derive(Clone, Copy)]
pub struct SimdLevel(fearless_simd::Level);

impl SimdLevel {
    /// The widest level of this machine.
    pub fn best() -> Self {
        Self(fearless_simd::Level::new())
    }

    /// Every level of this machine that the build can run, narrowest first.
    pub fn available() -> Vec<Self> {
        let best = fearless_simd::Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let levels = [
            best.as_sse2().map(Simd::level),
            best.as_sse4_2().map(Simd::level),
            best.as_avx2().map(Simd::level),
            best.as_avx512().map(Simd::level),
        ];
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let levels = [Some(best)];
        levels.into_iter().flatten().map(Self).collect()
    }

    /// The level to hand to [`dispatch!`].
    pub const fn level(self) -> fearless_simd::Level {
        self.0
    }

    /// A short name, as in `avx512`.
    pub fn name(self) -> &'static str {
        dispatch!(self.0, simd => simd_name(simd))
    }
}

#[inline(always)]
fn simd_name<S: Simd>(_: S) -> &'static str {
    let full = std::any::type_name::<S>();
    match full.rsplit("::").next() {
        Some("Avx512") => "avx512",
        Some("Avx2") => "avx2",
        Some("Sse4_2") => "sse4.2",
        Some("Sse2") => "sse2",
        Some("Neon") => "neon",
        Some("WasmSimd128") => "simd128",
        _ => "scalar",
    }
}

impl Default for SimdLevel {
    fn default() -> Self {
        Self::best()
    }
}

impl PartialEq for SimdLevel {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for SimdLevel {}

impl Hash for SimdLevel {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl fmt::Debug for SimdLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for SimdLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
