//! All spheres of a frame in blocks of sixteen, found again by the shaft that light comes through.
//!
//! ```text
//!     tile                        lights        The shaft from a ball to another is a cone that
//!    .-""-.  ______________      .-.            starts at the smaller one and grows to the
//!   (  o   )               -----( o )           larger: 16 spheres, or 16 blocks of them, are
//!    '-..-'  ______________-----'-'             asked at a time whether it touches them.
//! ```
//!
//! **Invariants.** Spheres are found in the order of the tree, whatever the shaft; none that a
//! segment of the shaft touches is left out. (property test)

use rayflock_geom::simd::cone_sphere::{Reach, SphereBlock, touches};
use rayflock_geom::simd::segment_spheres::{Blocker, SoftSphere};
use rayflock_geom::simd::segment_walls::Wall;
use rayflock_geom::simd::sphere_blocks::around_blocks;
use rayflock_geom::simd::{LANES, Simd, SimdLevel, SimdMask, dispatch};
use rayflock_geom::{Sphere, SphereCone};

use super::along_curve::sort_along_curve;
use super::cluster::WeightedPoint;

/// Relative to distances: covers the rounding of squared distances in the kernel.
const SLACK: f32 = 1e-4;

/// Points share what they see within this share of the median radius.
const LOOKOUT: f32 = 0.5;

/// The spheres of a frame.
#[derive(Debug, Default)]
pub struct SphereTree {
    spheres: Vec<SoftSphere>,
    /// The same, ready for the kernel.
    blockers: Vec<Blocker>,
    /// Their bounds.
    blocks: Vec<SphereBlock>,
    /// Bounds of sixteen blocks each.
    parents: Vec<SphereBlock>,
    /// What lies around all of the scene.
    walls: Vec<Wall>,
    /// Outer radius of the middle one, were they sorted by it.
    median_radius: f32,
    /// Working memory.
    points: Vec<WeightedPoint>,
    radii: Vec<f32>,
}

/// All segments between two balls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaft {
    cone: SphereCone,
    reach: Reach,
}

impl Shaft {
    /// The shaft between two balls.
    pub(super) fn between(a: &Sphere, b: &Sphere) -> Self {
        let (start, end) = if a.radius <= b.radius { (a, b) } else { (b, a) };
        let offset = end.center - start.center;
        let distance = offset.length();
        let axis = offset / distance;
        let sin = (end.radius - start.radius) / distance;
        // One ball within the other, or nearly: directions are not bounded then.
        let is_bounded = axis.is_finite() && sin < 0.999;
        let (cos, sin) = if is_bounded { ((1.0 - sin * sin).sqrt(), sin) } else { (0.0, 0.0) };
        let axis = if axis.is_finite() { axis } else { glam::Vec3::Z };
        let cone = SphereCone { origin: *start, axis, cos, sin };
        Self { cone, reach: Reach { near: 0.0, far: distance + end.radius } }
    }

    /// Which of sixteen spheres some segment may touch, one bit each.
    #[inline(always)]
    pub(super) fn touched<S: Simd>(&self, simd: S, block: &SphereBlock) -> u32 {
        let (kept, _) = touches(simd, &self.cone, self.reach, SLACK, &block.load(simd));
        kept.to_bitmask() as u32
    }
}

impl SphereTree {
    /// Makes this the tree of `spheres`, keeping its memory; `walls` hide what is behind them.
    pub fn build(&mut self, spheres: &[SoftSphere], walls: &[Wall]) {
        self.walls.clear();
        self.walls.extend_from_slice(walls);
        self.points.clear();
        let point = |(idx, sphere): (u32, &SoftSphere)| WeightedPoint::at(sphere.center, idx);
        self.points.extend((0..).zip(spheres).map(point));
        sort_along_curve(&mut self.points);
        self.spheres.clear();
        self.spheres.extend(self.points.iter().map(|point| spheres[point.idx as usize]));
        self.blockers.clear();
        self.blockers.extend(self.spheres.iter().map(Blocker::new));

        self.radii.clear();
        self.radii.extend(self.spheres.iter().map(|sphere| sphere.outer));
        let middle = self.radii.len() / 2;
        self.median_radius = match self.radii.get(middle) {
            Some(_) => *self.radii.select_nth_unstable_by(middle, f32::total_cmp).1,
            None => f32::INFINITY,
        };

        self.blocks.clear();
        self.blocks.extend(self.spheres.chunks(LANES).map(|spheres| {
            let mut block = SphereBlock::EMPTY;
            for (lane, sphere) in spheres.iter().enumerate() {
                block.set(lane, &Sphere::new(sphere.center, sphere.outer));
            }
            block
        }));
        self.parents.clear();
        dispatch!(SimdLevel::best().level(), simd => {
            for blocks in self.blocks.chunks(LANES) {
                let mut parent = SphereBlock::EMPTY;
                around_blocks(simd, blocks).store(&mut parent);
                self.parents.push(parent);
            }
        });
    }

    /// The walls.
    pub fn walls(&self) -> &[Wall] {
        &self.walls
    }

    /// The spheres, in the order of the tree.
    pub fn spheres(&self) -> &[SoftSphere] {
        &self.spheres
    }

    /// How far points may lie from where they look from, for what they see to change little.
    pub(crate) const fn reach_of_lookouts(&self) -> f32 {
        LOOKOUT * self.median_radius
    }

    /// Calls `found` with each sphere that a segment of the shaft may touch, in order: its place
    /// and itself. Returns how many lanes were tested.
    #[inline(always)]
    pub(super) fn in_shaft<S: Simd>(
        &self,
        simd: S,
        shaft: &Shaft,
        mut found: impl FnMut(&SoftSphere, &Blocker),
    ) -> u64 {
        let mut tests = 0;
        for (parent_idx, parent) in self.parents.iter().enumerate() {
            tests += LANES as u64;
            let mut touched = shaft.touched(simd, parent);
            while touched != 0 {
                let block_idx = parent_idx * LANES + touched.trailing_zeros() as usize;
                touched &= touched - 1;
                tests += LANES as u64;
                let mut lanes = shaft.touched(simd, &self.blocks[block_idx]);
                while lanes != 0 {
                    let idx = block_idx * LANES + lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    found(&self.spheres[idx], &self.blockers[idx]);
                }
            }
        }
        tests
    }

    /// Bytes held.
    pub fn memory_usage(&self) -> usize {
        self.spheres.capacity() * size_of::<SoftSphere>()
            + self.blockers.capacity() * size_of::<Blocker>()
            + (self.blocks.capacity() + self.parents.capacity()) * size_of::<SphereBlock>()
            + self.points.capacity() * size_of::<WeightedPoint>()
            + self.walls.capacity() * size_of::<Wall>()
            + self.radii.capacity() * size_of::<f32>()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(Vec3::from)
    }

    proptest! {
        #[test]
        fn no_sphere_that_a_segment_touches_is_left_out(
            balls in prop::array::uniform2((vector(), 0.0..0.8_f32)),
            ends in prop::collection::vec(prop::array::uniform2(vector()), 1..20),
            spheres in prop::collection::vec((vector(), 0.001..0.2_f32), 1..600),
        ) {
            let soft = |&(center, outer): &(Vec3, f32)| SoftSphere {
                center, inner: 0.0, outer, opacity: 1.0, flatness: Vec3::ZERO,
            };
            let mut tree = SphereTree::default();
            tree.build(&spheres.iter().map(soft).collect::<Vec<_>>(), &[]);
            let [a, b] = balls.map(|(center, radius)| Sphere::new(center, radius));
            let shaft = Shaft::between(&a, &b);
            for level in SimdLevel::available() {
                let mut found = Vec::new();
                dispatch!(level.level(), simd => {
                    tree.in_shaft(simd, &shaft, |sphere, _| found.push(*sphere));
                });
                for [from, to] in &ends {
                    let within = |ball: &Sphere, v: Vec3| {
                        ball.center + ball.radius * v.normalize_or(Vec3::X) * v.length().min(1.0)
                    };
                    let (from, to) = (within(&a, *from), within(&b, *to));
                    for sphere in tree.spheres() {
                        let along = (sphere.center - from).dot(to - from)
                            / (to - from).length_squared().max(1e-20);
                        let nearest = from.lerp(to, along.clamp(0.0, 1.0));
                        let is_touched = nearest.distance(sphere.center) <= sphere.outer;
                        prop_assert!(!is_touched || found.contains(sphere), "{sphere:?}");
                    }
                }
            }
        }
    }
}
