//! Points as spheres.
//!
//! Points that have no radius get half of the median distance to their nearest neighbours, so
//! that spheres of a dense cloud touch: of a sample of points, the nearest neighbour is looked for
//! along the longest side of the cloud, outward from the point until the rest is farther away than
//! what was found.
//!
//! **Cost.** For n points spread evenly, sorting and about `n^(2/3)` steps a sampled point.

use glam::Vec3;
use rayflock_geom::{Aabb, Mesh, Sphere};
use rayflock_scene::{MaterialIdx, SurfaceMesh};

use crate::job::Job;

/// Points whose nearest neighbour is looked for.
const SAMPLE_COUNT: usize = 256;

/// The radius of a point without neighbours.
const LONELY_RADIUS: f32 = 0.5;

/// Spheres at points, of a radius a point, or of a usual one where nobody says; `element` names the
/// points in warnings. `radii` are as many as `centers`.
pub(crate) fn spheres(
    centers: &[Vec3],
    radii: Option<&[f32]>,
    element: &str,
    job: &mut Job<'_>,
) -> SurfaceMesh {
    let spheres: Vec<Sphere> = match radii {
        Some(radii) => centers
            .iter()
            .zip(radii)
            .map(|(&center, &radius)| Sphere::new(center, radius))
            .collect(),
        None => {
            let radius = usual_radius(centers, element, job);
            centers.iter().map(|&center| Sphere::new(center, radius)).collect()
        }
    };
    let invalid_count = spheres.iter().filter(|sphere| !sphere.is_valid()).count();
    if invalid_count > 0 {
        let message = format!("{invalid_count} spheres have no finite, positive radius; ignored");
        job.warn(element, message);
    }
    SurfaceMesh::new(Mesh::from_spheres(spheres), MaterialIdx(0))
}

/// The radius of points that have none: that of the job, which is found with the first points.
pub(crate) fn usual_radius(centers: &[Vec3], element: &str, job: &mut Job<'_>) -> f32 {
    if let Some(radius) = job.point_radius {
        return radius;
    }
    if centers.is_empty() {
        return LONELY_RADIUS;
    }
    let radius = radius_from_spacing(centers);
    job.point_radius = Some(radius);
    job.warn(
        element,
        format!("points without a radius are shown with {radius}, half of the usual distance"),
    );
    radius
}

/// Half of the median distance of points to their nearest neighbours.
fn radius_from_spacing(centers: &[Vec3]) -> f32 {
    let mut sorted: Vec<Vec3> =
        centers.iter().copied().filter(|center| center.is_finite()).collect();
    let extent = Aabb::around(sorted.iter().copied()).size();
    let axis = extent.max_position();
    sorted.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
    let step = sorted.len().div_ceil(SAMPLE_COUNT).max(1);
    let mut distances: Vec<f32> = (0..sorted.len())
        .step_by(step)
        .filter_map(|idx| nearest_distance(&sorted, axis, idx))
        .collect();
    distances.sort_by(f32::total_cmp);
    let median = distances.get(distances.len() / 2);
    median.map_or(LONELY_RADIUS, |median| 0.5 * median)
}

/// The distance from a point to the nearest other place among points sorted along `axis`.
fn nearest_distance(sorted: &[Vec3], axis: usize, idx: usize) -> Option<f32> {
    let center = sorted[idx];
    let mut nearest = f32::INFINITY;
    let mut look = |other: &Vec3| {
        let distance = center.distance(*other);
        if distance > 0.0 {
            nearest = nearest.min(distance);
        }
        (other[axis] - center[axis]).abs() <= nearest
    };
    // Each side ends by itself; what the first found ends the second sooner.
    let _ = sorted[idx + 1..].iter().all(&mut look);
    let _ = sorted[..idx].iter().rev().all(&mut look);
    nearest.is_finite().then_some(nearest)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{LoadOptions, Reporter};

    /// A block of points, `distance` apart along each axis.
    fn block(side: u16, distance: f32) -> Vec<Vec3> {
        let place = |i: u16| f32::from(i) * distance;
        let row = |x, y| (0..side).map(move |z| Vec3::new(place(x), place(y), place(z)));
        (0..side).flat_map(|x| (0..side).flat_map(move |y| row(x, y))).collect()
    }

    #[test]
    fn spheres_of_a_dense_cloud_touch() {
        for distance in [0.25, 3.0] {
            let mut points = block(9, distance);
            points.push(Vec3::NAN);
            points.push(points[0]);
            assert_eq!(radius_from_spacing(&points), 0.5 * distance);
        }
    }

    #[test]
    fn points_without_neighbours_have_some_radius() {
        for points in [vec![Vec3::ONE], vec![Vec3::ONE; 5], vec![Vec3::NAN]] {
            assert_eq!(radius_from_spacing(&points), LONELY_RADIUS);
        }
    }

    #[test]
    fn a_found_radius_is_told_once_and_stays() {
        let (options, mut reporter) = (LoadOptions::default(), Reporter::new());
        let mut job = Job::new(Path::new("a.ply"), &options, &mut reporter);
        let radius = |points: &[Vec3], job: &mut Job<'_>| {
            spheres(points, None, "points", job).mesh.spheres()[0].radius
        };
        assert_eq!(radius(&block(3, 2.0), &mut job), 1.0);
        assert_eq!(radius(&block(3, 7.0), &mut job), 1.0);
        let told: Vec<_> = reporter.warnings().iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), 1);
        assert!(told[0].starts_with("a.ply: points: points without a radius are shown with 1,"));
    }

    #[test]
    fn given_radii_are_taken_and_bad_ones_told() {
        let (options, mut reporter) = (LoadOptions::default(), Reporter::new());
        let mut job = Job::new(Path::new("a.ply"), &options, &mut reporter);
        let radii = [1.0, 0.0, f32::NAN];
        let surface = spheres(&block(2, 1.0)[..3], Some(&radii), "points", &mut job);
        assert_eq!(surface.mesh.spheres()[0].radius, 1.0);
        assert_eq!(reporter.warnings().len(), 1);
        assert!(reporter.warnings()[0].message.starts_with("2 spheres"));
    }
}
