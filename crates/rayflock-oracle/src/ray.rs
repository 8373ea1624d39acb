//! A ray in `f64`, and the plane across it in which triangles are judged.

use glam::{DVec2, DVec3};
use rayflock_geom::Ray;

/// A ray, exactly as given, with the axes sorted by its direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct OracleRay {
    pub(super) org: DVec3,
    pub(super) dir: DVec3,
    pub(super) t_min: f64,
    pub(super) t_max: f64,
    pub(super) single: Ray,
    /// The axis along which the direction is longest.
    along: usize,
}

/// A point seen along a ray: projected along the direction onto the coordinate plane through the
/// origin that faces the ray most.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Beside the ray, in scene units; the ray itself is at zero.
    pub(super) beside: DVec2,
    /// Along the ray, in multiples of the direction.
    pub(super) depth: f64,
    /// The largest coordinate of the point relative to the origin.
    pub(super) reach: f64,
}

impl OracleRay {
    pub(super) fn new(ray: &Ray) -> Self {
        let dir = ray.direction.as_dvec3();
        let along = (0..3).max_by(|&a, &b| dir[a].abs().total_cmp(&dir[b].abs())).unwrap_or(0);
        Self {
            org: ray.origin.as_dvec3(),
            dir,
            t_min: f64::from(ray.t_min),
            t_max: f64::from(ray.t_max),
            single: *ray,
            along,
        }
    }

    /// The longest component of the direction, without its sign.
    pub(super) fn speed(&self) -> f64 {
        self.dir[self.along].abs()
    }

    pub(super) fn see(&self, point: DVec3) -> Seen {
        let (x, y, z) = ((self.along + 1) % 3, (self.along + 2) % 3, self.along);
        let offset = point - self.org;
        let depth = offset[z] / self.dir[z];
        let beside = DVec2::new(
            offset[x] - offset[z] * (self.dir[x] / self.dir[z]),
            offset[y] - offset[z] * (self.dir[y] / self.dir[z]),
        );
        Seen { beside, depth, reach: offset.abs().max_element() }
    }
}
