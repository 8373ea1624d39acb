//! Rays of one bounce, and the columns that stages hand to each other.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayflock_geom::{Column, RayBatch, RayOrder};

use crate::shading::sampling::PathSeed;
use crate::shading::turns::Chances;

/// What a ray carries besides its geometry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    /// Multiplies what the ray finds.
    pub(crate) weight: Vec3,
    /// Absorption of what the ray passes through, per scene unit.
    pub(crate) absorption: Vec3,
    /// The pixel, counted by rows within the band.
    pub(crate) pixel_idx: u32,
    /// Chooses the sample points on emitters.
    pub(crate) seed: PathSeed,
    /// The density with which the last turn went this way, by solid angle; 0 where there was no
    /// other way, as from the camera.
    pub(crate) density: f32,
}

impl Path {
    /// A path that has met nothing yet, of the first pixel.
    pub(crate) const NEW: Self = Self {
        weight: Vec3::ONE,
        absorption: Vec3::ZERO,
        pixel_idx: 0,
        seed: PathSeed::NONE,
        density: 0.0,
    };
}

/// Rays of one bounce; neighbours are close in the picture or in direction.
#[derive(Debug, Default)]
pub(crate) struct Wave {
    /// The turns behind these rays: 0 for rays from the camera.
    pub(crate) bounce: u32,
    /// Origins; empty where all rays share one.
    pub(crate) origins: Vec<Vec3>,
    /// Directions; empty where all rays share one.
    pub(crate) directions: Vec<Vec3>,
    /// One a ray.
    pub(crate) paths: Vec<Path>,
    /// The origin or direction that all rays share.
    pub(crate) shared: Shared,
    /// What neighbours have in common.
    pub(crate) order: RayOrder,
}

/// What the rays of a wave share, so that engines can make use of it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum Shared {
    /// Nothing: both columns are full.
    #[default]
    Nothing,
    /// The origin, as from a pinhole.
    Origin(Vec3),
    /// The direction, as of an orthographic camera.
    Direction(Vec3),
}

impl Wave {
    /// Number of rays.
    pub(crate) fn len(&self) -> usize {
        self.paths.len()
    }

    /// Makes this a wave without rays, keeping its memory.
    pub(crate) fn clear(&mut self, bounce: u32) {
        self.bounce = bounce;
        self.origins.clear();
        self.directions.clear();
        self.paths.clear();
        self.shared = Shared::Nothing;
        self.order = RayOrder::Coherent;
    }

    /// Adds a ray to a wave that shares nothing.
    pub(crate) fn push(&mut self, origin: Vec3, direction: Vec3, path: Path) {
        self.origins.push(origin);
        self.directions.push(direction);
        self.paths.push(path);
    }

    /// The rays as a question to an engine.
    pub(crate) fn batch(&self) -> RayBatch<'_> {
        let (origins, directions) = (Column::from(&self.origins), Column::from(&self.directions));
        let batch = match self.shared {
            Shared::Nothing => RayBatch::new(origins, directions),
            Shared::Origin(origin) => RayBatch::new(origin, directions),
            Shared::Direction(direction) => RayBatch::new(origins, direction),
        };
        let Ok(batch) = batch else { unreachable!("the columns of a wave have one length") };
        batch.with_order(self.order)
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.origins.capacity() * size_of::<Vec3>()
            + self.directions.capacity() * size_of::<Vec3>()
            + self.paths.capacity() * size_of::<Path>()
    }
}

/// Light on its way to a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contribution {
    /// The pixel, counted by rows within the band.
    pub(crate) pixel_idx: u32,
    /// Radiance to add.
    pub(crate) radiance: Vec3,
}

/// Shadow rays toward one light.
#[derive(Debug, Default)]
pub(crate) struct ShadowWave {
    /// Origins; empty where the light is the origin.
    pub(crate) origins: Vec<Vec3>,
    /// Directions; empty where the light has one.
    pub(crate) directions: Vec<Vec3>,
}

impl ShadowWave {
    /// Number of rays.
    pub(crate) fn len(&self) -> usize {
        self.origins.len().max(self.directions.len())
    }

    /// Makes this a wave without rays, keeping its memory.
    pub(crate) fn clear(&mut self) {
        self.origins.clear();
        self.directions.clear();
    }

    /// Makes this the rays of all `runs`, in their order.
    pub(crate) fn join(&mut self, runs: &[ShadedRun]) {
        join_columns(runs, |run| &run.shadow.origins, &mut self.origins);
        join_columns(runs, |run| &run.shadow.directions, &mut self.directions);
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        (self.origins.capacity() + self.directions.capacity()) * size_of::<Vec3>()
    }
}

/// Makes `joined` one column of all runs, in parallel.
fn join_columns(
    runs: &[ShadedRun],
    column: impl Fn(&ShadedRun) -> &[Vec3] + Sync,
    joined: &mut Vec<Vec3>,
) {
    joined.resize(runs.iter().map(|run| column(run).len()).sum(), Vec3::ZERO);
    copy_columns(runs, &column, joined);
}

fn copy_columns(
    runs: &[ShadedRun],
    column: &(impl Fn(&ShadedRun) -> &[Vec3] + Sync),
    joined: &mut [Vec3],
) {
    match runs {
        [] => {}
        [run] => joined.copy_from_slice(column(run)),
        _ => {
            let (left, right) = runs.split_at(runs.len() / 2);
            let middle = left.iter().map(|run| column(run).len()).sum();
            let (to_left, to_right) = joined.split_at_mut(middle);
            rayon::join(
                || copy_columns(left, column, to_left),
                || copy_columns(right, column, to_right),
            );
        }
    }
}

/// A point that lights may light, with all that its radiance depends on.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LitPoint {
    /// Where shadow rays end.
    pub(crate) shadow_position: Vec3,
    /// Shading normal.
    pub(crate) normal: Vec3,
    /// Toward where the ray came from, of unit length.
    pub(crate) to_viewer: Vec3,
    /// Diffuse share times the path's weight.
    pub(crate) diffuse: Vec3,
    /// Highlight times the path's weight.
    pub(crate) specular: Vec3,
    /// Exponent of the highlight.
    pub(crate) shininess: f32,
    /// The pixel, counted by rows within the band.
    pub(crate) pixel_idx: u32,
    /// Chooses the sample points on emitters.
    pub(crate) seed: PathSeed,
}

/// What shading one run of rays gives; kept from batch to batch for its memory.
#[derive(Debug, Default)]
pub(crate) struct ShadedRun {
    /// Light that needs no shadow ray: emission, ambient light, background.
    pub(crate) unshadowed: Vec<Contribution>,
    /// Points to be lit.
    pub(crate) points: Vec<LitPoint>,
    /// How likely the path of each point goes on toward a light itself; empty where turns are not
    /// left to chance.
    pub(crate) chances: Vec<Chances>,
    /// Mirrored rays.
    pub(crate) mirror: Wave,
    /// Refracted rays.
    pub(crate) refraction: Wave,
    /// Shadow rays toward the light at hand.
    pub(crate) shadow: ShadowWave,
    /// What arrives if nothing is in the way, one a shadow ray.
    pub(crate) lit: Vec<Contribution>,
    /// All pixels of the run's rays lie here.
    pub(crate) pixels: Range<usize>,
}

impl ShadedRun {
    /// Empties all but shadow rays and what they bring.
    pub(crate) fn clear(&mut self, bounce: u32) {
        self.unshadowed.clear();
        self.points.clear();
        self.chances.clear();
        self.mirror.clear(bounce + 1);
        self.refraction.clear(bounce + 1);
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.unshadowed.capacity() * size_of::<Contribution>()
            + self.points.capacity() * size_of::<LitPoint>()
            + self.chances.capacity() * size_of::<Chances>()
            + self.mirror.memory_usage()
            + self.refraction.memory_usage()
            + self.shadow.memory_usage()
            + self.lit.capacity() * size_of::<Contribution>()
    }
}
