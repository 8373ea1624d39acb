//! Cones, and spheres that are no spheres any more, as triangles.
//!
//! Cones and cylinders have no caps. A sphere becomes triangles only where a transform stretches
//! it unevenly; otherwise it stays one.
//!
//! **Departures.** AFF's are round. Ours are inscribed: a cone of [`SEGMENTS`] segments lies at
//! most 0.12 % of its radius inside the round one, a sphere of [`ROWS`] rows at most 0.5 %.
//! Vertex normals are the round ones. A negative radius, which AFF has for
//! surfaces seen from within only, is taken for a positive one: our surfaces have two sides.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::patch::Patch;

/// Pieces around a cone or cylinder.
pub(super) const SEGMENTS: u32 = 64;
/// Pieces from pole to pole of a stretched sphere.
const ROWS: u32 = 16;
/// Triangles of a stretched sphere: two a piece, but one at the poles.
pub(super) const SPHERE_TRIANGLES: usize = (4 * ROWS * (ROWS - 1)) as usize;
/// Triangles that cones and stretched spheres may become, all together: their commands are short.
pub(super) const LIMIT: usize = 1 << 24;
/// Triangles of a cone, at most.
pub(super) const CONE_TRIANGLES: usize = 2 * SEGMENTS as usize;

/// One end of a cone.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConeEnd {
    pub(super) center: Vec3,
    pub(super) radius: f32,
}

/// The cone or cylinder between two ends; `None` where both are at one place.
pub(super) fn cone(base: ConeEnd, apex: ConeEnd) -> Option<Patch> {
    let [from, to] = [base, apex].map(|end| end.center.as_dvec3());
    let radii = [base, apex].map(|end| f64::from(end.radius.abs()));
    let axis = (to - from).try_normalize()?;
    let right = axis.any_orthonormal_vector();
    let up = axis.cross(right);
    let slope = (radii[0] - radii[1]) / (to - from).length();

    let mut patch = Patch::default();
    for (center, radius) in [(from, radii[0]), (to, radii[1])] {
        for segment in 0..SEGMENTS {
            let (sin, cos) = (TAU * f64::from(segment) / f64::from(SEGMENTS)).sin_cos();
            let side = cos * right + sin * up;
            push(&mut patch, center + radius * side, side + slope * axis);
        }
    }
    for segment in 0..SEGMENTS {
        let [a, b] = [segment, (segment + 1) % SEGMENTS];
        let [c, d] = [b + SEGMENTS, a + SEGMENTS];
        // An end without radius has one triangle a segment.
        patch.triangles.extend((radii[0] > 0.0).then_some([a, b, c]));
        patch.triangles.extend((radii[1] > 0.0).then_some([a, c, d]));
    }
    Some(patch)
}

/// A sphere as triangles.
pub(super) fn sphere(center: Vec3, radius: f32) -> Patch {
    const COLUMNS: u32 = 2 * ROWS;
    let (center, radius) = (center.as_dvec3(), f64::from(radius));
    let mut patch = Patch::default();
    for row in 0..=ROWS {
        let (sin, height) = (PI * f64::from(row) / f64::from(ROWS)).sin_cos();
        // The poles are single points to the bit.
        let ring = if row % ROWS == 0 { 0.0 } else { sin };
        for column in 0..COLUMNS {
            let (sin, cos) = (TAU * f64::from(column) / f64::from(COLUMNS)).sin_cos();
            let outward = DVec3::new(ring * sin, height, ring * cos);
            push(&mut patch, center + radius * outward, outward);
        }
    }
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let [a, b] = [column, (column + 1) % COLUMNS].map(|column| row * COLUMNS + column);
            let [c, d] = [b + COLUMNS, a + COLUMNS];
            patch.triangles.extend((row + 1 < ROWS).then_some([a, d, c]));
            patch.triangles.extend((row > 0).then_some([a, c, b]));
        }
    }
    patch
}

fn push(patch: &mut Patch, position: DVec3, normal: DVec3) {
    patch.positions.push(position.as_vec3());
    patch.normals.push(normal.normalize_or_zero().as_vec3());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that triangles face outward, like their normals, and that the edges inside a
    /// surface have two sides.
    fn check(patch: &Patch, open_edges: usize) {
        let mut edges = std::collections::HashMap::new();
        for &triangle in &patch.triangles {
            let [a, b, c] = triangle.map(|idx| patch.positions[idx as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.length() > 0.0);
            for corner in triangle {
                assert!(normal.dot(patch.normals[corner as usize]) > 0.0, "{triangle:?}");
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let bits = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
                *edges.entry((bits(from), bits(to))).or_insert(0) += 1;
                *edges.entry((bits(to), bits(from))).or_insert(0) -= 1;
            }
        }
        assert_eq!(edges.values().filter(|&&sum| sum > 0).count(), open_edges);
    }

    #[test]
    fn cylinders_and_cones_are_open_tubes_that_face_outward() {
        let end = |y: f32, radius| ConeEnd { center: Vec3::new(1.0, y, 2.0), radius };
        let tube = cone(end(0.0, 0.5), end(3.0, 0.5)).unwrap();
        assert_eq!(tube.triangles.len(), CONE_TRIANGLES);
        check(&tube, 2 * SEGMENTS as usize);
        for (position, normal) in tube.positions.iter().zip(&tube.normals) {
            let outward = (position - Vec3::new(1.0, position.y, 2.0)) / 0.5;
            assert!(outward.abs_diff_eq(*normal, 1e-5));
        }
        let pointed = cone(end(2.0, -1.0), end(0.0, 0.0)).unwrap();
        assert_eq!(pointed.triangles.len(), SEGMENTS as usize);
        check(&pointed, SEGMENTS as usize);
        assert!((pointed.normals[0].y + 0.2_f32.sqrt()).abs() < 1e-5, "{}", pointed.normals[0]);
        assert!(cone(end(1.0, 1.0), end(1.0, 2.0)).is_none());
    }

    #[test]
    fn spheres_are_closed() {
        let ball = sphere(Vec3::new(1.0, 2.0, 3.0), 0.5);
        assert_eq!(ball.triangles.len(), SPHERE_TRIANGLES);
        for position in &ball.positions {
            assert!((position.distance(Vec3::new(1.0, 2.0, 3.0)) - 0.5).abs() < 1e-6);
        }
    }
}
