//! What a caller can choose about virtual lights.

use crate::occluders::SphereSettings;

/// How virtual lights are left and gathered. Values out of range are taken as the nearest one in
/// range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VplSettings {
    /// About how many virtual lights there are, `0..=2^20`: half as many walks start from the
    /// lights, and a walk leaves one to three, by how bright the scene is. A quarter as many again
    /// stand for the background, if it shines.
    pub light_count: u32,
    /// What points see of virtual lights.
    pub visibility: Visibility,
    /// Where a light is so close to a point that its geometry term (both cosines over the squared
    /// distance) exceeds `bound * walks / diagonal^2` of the scene, that is what counts. Smaller
    /// values take bright spots from corners, and light with them; infinity takes nothing. The
    /// bound grows with the lights, so the error vanishes.
    pub bound: f32,
    /// Whether few shadow rays a point stand for all: noise in place of time. Then `visibility`, if
    /// it is not exact, is only a guess that the rays correct.
    pub chosen: Option<ChosenRays>,
}

/// Few shadow rays a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChosenRays {
    /// How many, `1..=1024`.
    pub count: u32,
    /// To which lights.
    pub by: ChosenBy,
}

/// Which lights get a ray. All give the same picture in the mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChosenBy {
    /// All lights alike: noisy; to compare with.
    Uniform,
    /// In proportion to what is guessed to arrive: importance resampling.
    Weight,
    /// In proportion to what would arrive if nothing were in the way, to correct the guess that is
    /// taken of all: a control variate. Best where the guess is nearly right.
    Difference,
}

/// How visibility between points and virtual lights is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Visibility {
    /// By a shadow ray for each pair.
    #[default]
    Exact,
    /// Past spheres that stand for geometry: nearly, but fast.
    Spheres(SphereSettings),
    /// By shadow rays from few points, each for neighbours that see about the same: nearly, and
    /// several times faster than exactly. Light that is found by cuts or by chosen rays, where no two
    /// points ask about the same lights, is found as by [`Exact`](Self::Exact).
    Lookouts(LookoutSettings),
    /// Everything sees everything: light leaks, but fast.
    None,
}

/// How points share what they see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookoutSettings {
    /// How many points share one that looks, at most; `1..=64`, of which 1, 4, 16, 32 and 64 differ.
    /// Fewer are nearer to what is exact.
    pub points: usize,
}

impl Default for LookoutSettings {
    /// 32 points.
    fn default() -> Self {
        Self { points: 32 }
    }
}

impl Default for VplSettings {
    /// A thousand lights, exact visibility with all rays, and a bound that shows hardly any spots.
    fn default() -> Self {
        Self { light_count: 1024, visibility: Visibility::Exact, bound: 1.0, chosen: None }
    }
}

impl VplSettings {
    /// The same settings with every value in its range.
    pub(crate) fn clamped(&self) -> Self {
        let bound = if self.bound.is_nan() { f32::INFINITY } else { self.bound.max(0.0) };
        let chosen =
            self.chosen.map(|chosen| ChosenRays { count: chosen.count.clamp(1, 1024), ..chosen });
        Self { light_count: self.light_count.min(1 << 20), bound, chosen, ..*self }
    }

    /// Walks that start from the lights.
    pub(crate) const fn walk_count(&self) -> u32 {
        self.light_count.div_ceil(2)
    }

    /// Lights that stand for the background.
    pub(crate) const fn sky_count(&self) -> usize {
        self.light_count.div_ceil(4) as usize
    }
}
