//! Primitives that a face cannot place sixteen at a time: triangles that reach behind the start of
//! central rays or are out of range, spheres and user primitives. One by one, in `f64`.
//!
//! A triangle that reaches behind has edge functions all the same: with `n_k` the normal of the
//! plane through the origin and edge k, a ray in front hits the triangle iff all `n_k . (x, y, 1)`
//! have the sign of `det`, the triangle's volume with the origin. It has no box and no bound on its
//! nearness.
//!
//! **Invariants.** With `n` the largest distance of a corner, `e` the longest edge and `N` twice the
//! area: where `|det|` is above `2^-11 e N + 12 PERTURBATION n^2 e`, neither the corners' moves (at
//! most `8 PERTURBATION n^2 e`) nor the error of a depth behind the origin (`2^-12 e`) change its
//! sign. Others may be hit anywhere.

use glam::{DVec3, Vec3};

use super::face::{Face, FaceKind};
use super::face_triangle::FaceReach;
use super::ray_triangle::{DEPTH_ERROR, PERTURBATION};
use crate::Sphere;

/// The whole face.
const EVERYWHERE: [f32; 4] = [f32::MIN, f32::MAX, f32::MIN, f32::MAX];

impl Face {
    /// Sets up one triangle of any kind; `None` if no ray of the face hits it.
    pub fn place_triangle(&self, corners: [Vec3; 3]) -> Option<FaceReach> {
        let anywhere = FaceReach::anywhere(EVERYWHERE, f32::INFINITY);
        match self.kind {
            FaceKind::Central => self.place_wide(corners, anywhere),
            FaceKind::Parallel { .. } => Some(anywhere),
        }
    }

    fn place_wide(&self, corners: [Vec3; 3], anywhere: FaceReach) -> Option<FaceReach> {
        let p = corners.map(|corner| self.rotated(corner));
        let (edge1, edge2) = (p[1] - p[0], p[2] - p[0]);
        let longest = edge1.length().max(edge2.length()).max((p[2] - p[1]).length());
        let normal = edge1.cross(edge2);
        let farthest = p[0].length().max(p[1].length()).max(p[2].length());
        let (depth_error, perturbation) = (f64::from(DEPTH_ERROR), f64::from(PERTURBATION));

        let most = p[0].z.max(p[1].z).max(p[2].z);
        if most < -2.0 * depth_error * longest - 4.0 * perturbation * farthest {
            return None;
        }
        let det = p[0].dot(normal);
        let unsure = 2.0 * depth_error * longest * normal.length()
            + 12.0 * perturbation * farthest * farthest * longest;
        if det.abs() <= unsure || det.is_nan() {
            return Some(anywhere);
        }
        let mut placed = anywhere;
        for (k, edge) in placed.edges.iter_mut().enumerate() {
            let (from, to) = (p[k], p[(k + 1) % 3]);
            let plane = from.cross(to) * det.signum();
            let widened = 32.0 * perturbation * from.length() * to.length();
            let size = plane.abs().max_element().max(widened).max(f64::MIN_POSITIVE);
            *edge = [plane.x, plane.y, plane.z + widened].map(|value| (value / size) as f32);
        }
        Some(placed)
    }

    /// Sets up a primitive within a bounding sphere; `None` if no ray of the face touches it.
    /// `slack` is relative to distances, as for [`cone_sphere`](super::cone_sphere).
    pub fn place_sphere(&self, sphere: &Sphere, slack: f32) -> Option<FaceReach> {
        if sphere.radius < 0.0 {
            return None;
        }
        let p = self.rotated(sphere.center);
        let reach = match self.kind {
            FaceKind::Central => 0.0,
            FaceKind::Parallel { reach } => f64::from(reach),
        };
        let radius = f64::from(sphere.radius);
        let slack = 4.0 * f64::from(slack) * (p.length() + radius + reach);
        let radius = radius * (1.0 + 4.0 * f64::from(DEPTH_ERROR)) + slack;
        match self.kind {
            FaceKind::Parallel { .. } => {
                let bounds = [p.x - radius, p.x + radius, p.y - radius, p.y + radius];
                Some(FaceReach::anywhere(bounds.map(|bound| bound as f32), (radius - p.z) as f32))
            }
            FaceKind::Central if p.z + radius < 0.0 => None,
            FaceKind::Central if p.z - radius < 1e-3 * radius => {
                Some(FaceReach::anywhere(EVERYWHERE, f32::INFINITY))
            }
            FaceKind::Central => {
                let [x0, x1] = slopes(p.x, p.z, radius);
                let [y0, y1] = slopes(p.y, p.z, radius);
                let nearest = 1.0 / (p.z - radius) * (1.0 + 1e-6);
                let bounds = [x0, x1, y0, y1].map(|bound| bound as f32);
                Some(FaceReach::anywhere(bounds, nearest as f32))
            }
        }
    }

    /// A point in the coordinates of the face, before any division.
    fn rotated(&self, point: Vec3) -> DVec3 {
        let p = point.as_dvec3() - self.center.as_dvec3();
        let [a, b, c] = self.rows.map(Vec3::as_dvec3);
        DVec3::new(a.dot(p), b.dot(p), c.dot(p))
    }
}

/// Least and largest `x / z` in a cube around (x, z), enlarged for the rounding of rays' points.
fn slopes(x: f64, z: f64, radius: f64) -> [f64; 2] {
    let (near, far) = (z - radius, z + radius);
    let (low, high) = (x - radius, x + radius);
    let low = low / if low < 0.0 { near } else { far };
    let high = high / if high < 0.0 { far } else { near };
    let slack = 16.0 * f64::from(PERTURBATION);
    [low - slack * (1.0 + low * low), high + slack * (1.0 + high * high)]
}
