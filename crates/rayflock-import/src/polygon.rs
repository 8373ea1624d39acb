//! Polygons cut into triangles.
//!
//! Where a fan from the first corner covers the polygon, that is what it becomes: all convex
//! polygons do, with two triangles fewer than corners. Others are projected along the axis that
//! their normal is nearest to, and get their ears cut.
//!
//! **Source.** D. Eberly, "Triangulation by Ear Clipping", 2008, as the `earcut` crate has it;
//! the normal is Newell's (Sutherland, Sproull and Schumacker, 1974).
//!
//! **Departures.** Corners on a straight line between their neighbours may get no triangle.
//!
//! **Cost.** Linear for fans; ears take up to the square of the corners, so polygons of more than
//! [`EAR_LIMIT`] corners are fans whatever their form.

use earcut::Earcut;
use glam::{DVec3, Vec3};

/// Most corners of a polygon that is not cut into a fan.
const EAR_LIMIT: usize = 10_000;

/// The triangles of a polygon, facing like it, as positions in `corners`; none for fewer than
/// three corners.
pub(crate) fn triangulate(corners: &[Vec3]) -> Vec<[u32; 3]> {
    let normal = newell_normal(corners);
    let last = (corners.len() as u32).max(2) - 1;
    let fan: Vec<[u32; 3]> = (1..last).map(|idx| [0, idx, idx + 1]).collect();
    let faces = |triangle: &[u32; 3]| triangle_normal(corners, *triangle).dot(normal);
    if corners.len() > EAR_LIMIT || fan.iter().all(|triangle| faces(triangle) >= 0.0) {
        return fan;
    }
    let mut cut = cut_ears(corners, normal);
    for triangle in cut.iter_mut().filter(|triangle| faces(triangle) < 0.0) {
        triangle.swap(1, 2);
    }
    if cut.is_empty() { fan } else { cut }
}

fn cut_ears(corners: &[Vec3], normal: DVec3) -> Vec<[u32; 3]> {
    let size = normal.abs();
    let flat = |corner: &Vec3| {
        let corner = corner.as_dvec3();
        if size.z >= size.x && size.z >= size.y {
            [corner.x, corner.y]
        } else if size.y >= size.x {
            [corner.z, corner.x]
        } else {
            [corner.y, corner.z]
        }
    };
    let mut idxs: Vec<u32> = Vec::new();
    Earcut::new().earcut(corners.iter().map(flat), &[], &mut idxs);
    idxs.as_chunks().0.to_vec()
}

/// Twice the area of the polygon, along its normal.
fn newell_normal(corners: &[Vec3]) -> DVec3 {
    let from_first = |idx: usize| corners[idx].as_dvec3() - corners[0].as_dvec3();
    (1..corners.len()).map(|idx| from_first(idx - 1).cross(from_first(idx))).sum()
}

fn triangle_normal(corners: &[Vec3], triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|idx| corners[idx as usize].as_dvec3());
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area_of(corners: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f64> {
        let normal = newell_normal(corners).normalize_or_zero();
        triangles.iter().map(|&t| 0.5 * triangle_normal(corners, t).dot(normal)).collect()
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
        assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
        for few in 0..3 {
            assert!(triangulate(&square[..few]).is_empty());
        }
    }

    #[test]
    fn concave_polygons_are_covered_once_and_keep_their_side() {
        // An arrow head whose notch the first corner cannot see past, in three planes and turned
        // both ways.
        let flat = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (3.0, 1.0), (0.0, 1.0)];
        let planes: [fn(f32, f32) -> Vec3; 3] = [
            |x, y| Vec3::new(x, y, 1.0),
            |x, y| Vec3::new(2.0, x, y),
            |x, y| Vec3::new(y, 3.0 + 0.1 * x, x),
        ];
        for place in planes {
            let mut corners = flat.map(|(x, y)| place(x, y));
            for _ in 0..2 {
                let areas = area_of(&corners, &triangulate(&corners));
                assert_eq!(areas.len(), 3);
                assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
                let whole = 0.5 * newell_normal(&corners).length();
                assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-5, "{areas:?}");
                corners.reverse();
            }
        }
    }

    #[test]
    fn polygons_without_area_are_fans_all_the_same() {
        let flat = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::X];
        assert_eq!(triangulate(&flat).len(), 2);
        let huge = [Vec3::ZERO, Vec3::MAX, -Vec3::MAX, Vec3::Y, Vec3::MIN, Vec3::X];
        assert!(!triangulate(&huge).is_empty());
    }
}
