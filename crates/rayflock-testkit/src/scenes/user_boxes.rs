//! Axis-aligned boxes as user primitives.

use rayflock_geom::{Aabb, Ray, Sphere, UserHit, UserPrimitives};

/// Boxes that tests trace through the trait for user primitives. `u` is the axis of the face that
/// is hit, `v` is 0 on entry and 1 on exit.
#[derive(Clone, Debug)]
pub struct UserBoxes(pub Vec<Aabb>);

impl UserPrimitives for UserBoxes {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounding_sphere(&self, prim_idx: usize) -> Sphere {
        let aabb = &self.0[prim_idx];
        let radius = 0.5 * aabb.size().length() * (1.0 + 1e-5) + f32::MIN_POSITIVE;
        let empty = if aabb.is_empty() { f32::NAN } else { radius };
        Sphere::new(aabb.center(), empty)
    }

    fn intersect(&self, prim_idx: usize, rays: &[Ray], hits: &mut [Option<UserHit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = intersect_box(&self.0[prim_idx], ray);
        }
    }
}

/// The slab test in `f64`: the ray is inside between the last entry and the first exit.
fn intersect_box(aabb: &Aabb, ray: &Ray) -> Option<UserHit> {
    let (mut entry, mut exit) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for axis in 0..3 {
        let (org, dir) = (f64::from(ray.origin[axis]), f64::from(ray.direction[axis]));
        let (low, high) = (f64::from(aabb.min[axis]), f64::from(aabb.max[axis]));
        if dir == 0.0 {
            if org < low || org > high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - org) / dir, (high - org) / dir);
        if a.min(b) > entry.0 {
            entry = (a.min(b), axis);
        }
        if a.max(b) < exit.0 {
            exit = (a.max(b), axis);
        }
    }
    if entry.0 > exit.0 {
        return None;
    }
    let crossings = [(entry, 0.0), (exit, 1.0)];
    crossings.into_iter().find_map(|((t, axis), v)| {
        let t = t as f32;
        let inside = ray.t_min <= t && t <= ray.t_max && t.is_finite();
        inside.then_some(UserHit { t, u: f32::from(axis as u8), v })
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_box_is_entered_left_and_passed_by() {
        let boxes = UserBoxes(vec![Aabb { min: -Vec3::ONE, max: Vec3::ONE }]);
        let ray = Ray::new(Vec3::new(-3.0, 0.5, 0.5), Vec3::X);
        let rays = [
            ray,
            Ray { t_min: 2.5, ..ray },
            Ray { origin: Vec3::new(-3.0, 1.5, 0.0), ..ray },
            Ray { t_max: 1.9, ..ray },
        ];
        let mut hits = [None; 4];
        boxes.intersect(0, &rays, &mut hits);
        let t = hits.map(|hit| hit.map(|hit| (hit.t, hit.v)));
        assert_eq!(t, [Some((2.0, 0.0)), Some((4.0, 1.0)), None, None]);
    }
}
