//! Planes that a mesh lies on one side of: walls of rooms, grounds.
//!
//! Two points that a scene holds see each other past such a plane whatever lies in it, as long as
//! everything else lies on the same side. So the pieces in it have spheres of their own, which take
//! part only when something comes to lie behind the plane. That is most of the surface of a room,
//! and the part that spheres are worst at.
//!
//! Light from behind the plane, as from the sky below the ground, has to come through what lies in
//! it: a parallelogram around that.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};
use rayflock_geom::simd::segment_walls::Wall;
use rayflock_geom::{Aabb, Mesh, Sphere};

use super::cut_pieces::{Piece, PlacedPiece, whole_pieces};

/// Planes looked at, those of most surface first.
const MOST_PLANES: usize = 64;

/// Steps of a unit within which normals are alike at first sight.
const NORMAL_STEPS: f32 = 64.0;

/// A plane is worth keeping with this share of the surface of its mesh.
const LEAST_SHARE: f32 = 0.01;

/// What may lie behind the plane, relative to the size of the mesh.
pub(super) const TOLERANCE: f32 = 0.003;

/// A plane with everything on the side that the normal points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HullPlane {
    pub(super) normal: Vec3,
    /// The product of the normal and a point of the plane.
    pub(super) offset: f32,
    area: f32,
    /// How far from it what lies in it may be, in the space of the mesh.
    tolerance: f32,
    /// A parallelogram around what lies in it: a corner and two edges from there.
    corner: Vec3,
    edges: [Vec3; 2],
}

impl HullPlane {
    fn height(&self, point: Vec3) -> f32 {
        self.normal.dot(point) - self.offset
    }

    /// The plane under a transform; `None` where that has no inverse.
    pub(super) fn transformed(&self, transform: &Affine3A) -> Option<Self> {
        let inverse = transform.matrix3.inverse().transpose();
        let normal = (inverse * self.normal).try_normalize()?;
        let point = transform.transform_point3(self.offset * self.normal);
        let corner = transform.transform_point3(self.corner);
        let edges = self.edges.map(|edge| transform.transform_vector3(edge));
        let moved = || Self { normal, offset: normal.dot(point), corner, edges, ..*self };
        normal.is_finite().then(moved)
    }

    /// What lies in the plane, as seen from behind, `tolerance` below it; `None` without area.
    /// `self` is as it was found, or transformed with its area growing alike everywhere.
    pub(super) fn wall(&self, density: f32, tolerance: f32) -> Option<Wall> {
        Wall::new(self.corner - tolerance * self.normal, self.edges, density)
    }

    /// How much light the parallelogram takes away, in the space of the mesh: all where at least half
    /// of it is filled, as what lies beside a round floor is without as well.
    pub(super) fn density(&self) -> f32 {
        let [first, second] = self.edges;
        let all = first.cross(second).length();
        (2.0 * self.area / all.max(f32::MIN_POSITIVE)).min(1.0)
    }

    /// Makes the parallelogram the smallest rectangle around `points` with a side along one of
    /// `sides`.
    fn surround(&mut self, points: &[Vec3], sides: [Vec3; 3]) {
        let mut smallest = f32::INFINITY;
        for side in sides {
            let along = side.reject_from_normalized(self.normal).normalize_or_zero();
            let axes = [along, self.normal.cross(along)];
            let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
            for point in points {
                for (axis_idx, axis) in axes.iter().enumerate() {
                    let at = axis.dot(*point);
                    low[axis_idx] = low[axis_idx].min(at);
                    high[axis_idx] = high[axis_idx].max(at);
                }
            }
            let lengths = [high[0] - low[0], high[1] - low[1]];
            let area = lengths[0] * lengths[1];
            if along != Vec3::ZERO && area < smallest {
                smallest = area;
                self.corner = self.offset * self.normal + low[0] * axes[0] + low[1] * axes[1];
                self.edges = [lengths[0] * axes[0], lengths[1] * axes[1]];
            }
        }
    }

    /// Whether a box lies on the near side, but for `tolerance`.
    pub(super) fn has_before_it(&self, bounds: &Aabb, tolerance: f32) -> bool {
        let lowest = Vec3::select(self.normal.cmpgt(Vec3::ZERO), bounds.min, bounds.max);
        bounds.is_empty() || self.height(lowest) >= -tolerance
    }

    /// Whether all corners of a triangle lie in the plane.
    fn holds(&self, corners: &[Vec3; 3]) -> bool {
        corners.iter().all(|&corner| self.height(corner).abs() <= self.tolerance)
    }

    /// Whether all of the mesh lies on the near side.
    fn supports(&self, mesh: &Mesh) -> bool {
        let above = |&point: &Vec3| !point.is_finite() || self.height(point) >= -self.tolerance;
        let ball_above = |ball: &Sphere| {
            !ball.is_valid() || self.height(ball.center) >= ball.radius - self.tolerance
        };
        mesh.vertices().iter().all(above)
            && mesh.spheres().iter().all(ball_above)
            && mesh.user().is_none()
    }
}

/// The planes of the hull of `mesh` that hold a good part of its surface.
pub(super) fn hull_planes(mesh: &Mesh) -> Vec<HullPlane> {
    let tolerance = TOLERANCE * mesh.bounds().size().length();
    let mut triangles: Vec<(f32, [Vec3; 3])> = whole_pieces(mesh)
        .filter_map(|piece| {
            let placed = piece.placed(mesh)?;
            let PlacedPiece::Triangle(corners) = placed else { return None };
            Some((placed.area(), corners))
        })
        .collect();
    triangles.sort_by(|a, b| b.0.total_cmp(&a.0));
    let total: f32 = triangles.iter().map(|triangle| triangle.0).sum();

    let mut planes = candidates(mesh, &triangles, tolerance);
    for (area, corners) in &triangles {
        if let Some(plane) = planes.iter_mut().find(|plane| plane.holds(corners)) {
            plane.area += area;
        }
    }
    planes.retain(|plane| plane.area >= LEAST_SHARE * total && plane.supports(mesh));
    for plane in &mut planes {
        let held: Vec<[Vec3; 3]> =
            triangles.iter().map(|triangle| triangle.1).filter(|at| plane.holds(at)).collect();
        if let Some([a, b, c]) = held.first() {
            plane.surround(held.as_flattened(), [b - a, c - b, a - c]);
        }
    }
    planes
}

/// Planes that hold most of the surface and have the extreme points of the mesh on one side;
/// without area yet.
fn candidates(mesh: &Mesh, triangles: &[(f32, [Vec3; 3])], tolerance: f32) -> Vec<HullPlane> {
    // Triangles of about one plane, which is that of the first of them.
    let mut alike: HashMap<[i32; 4], (f32, usize)> = HashMap::new();
    for (triangle_idx, (area, corners)) in triangles.iter().enumerate() {
        alike.entry(plane_key(corners, tolerance)).or_insert((0.0, triangle_idx)).0 += area;
    }
    let mut alike: Vec<(f32, usize)> = alike.into_values().collect();
    alike.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));

    let extremes = extremes(mesh);
    let mut planes: Vec<HullPlane> = Vec::new();
    for (_, triangle_idx) in alike {
        let corners = &triangles[triangle_idx].1;
        if planes.len() < MOST_PLANES && !planes.iter().any(|plane| plane.holds(corners)) {
            planes.extend(plane_of(corners, &extremes, tolerance));
        }
    }
    planes
}

/// Alike for most triangles of a plane, whichever way they face.
fn plane_key([a, b, c]: &[Vec3; 3], tolerance: f32) -> [i32; 4] {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let normal = normal * 1.0_f32.copysign(normal[normal.abs().max_position()]);
    let [x, y, z] = (NORMAL_STEPS * normal).round().to_array();
    [x as i32, y as i32, z as i32, (normal.dot(*a) / (2.0 * tolerance)).round() as i32]
}

/// Which of the planes a piece lies in.
pub(super) fn plane_of_piece(mesh: &Mesh, planes: &[HullPlane], piece: &Piece) -> Option<usize> {
    match piece.placed(mesh)? {
        PlacedPiece::Triangle(corners) => planes.iter().position(|plane| plane.holds(&corners)),
        PlacedPiece::Ball(_) => None,
    }
}

/// The plane of a triangle with the extreme points of the mesh on one side, if they are.
fn plane_of([a, b, c]: &[Vec3; 3], extremes: &[Vec3], tolerance: f32) -> Option<HullPlane> {
    let double = (b - a).cross(c - a);
    let normal = double.try_normalize()?;
    let (corner, edges) = (*a, [Vec3::ZERO; 2]);
    let plane = HullPlane { normal, offset: normal.dot(*a), area: 0.0, tolerance, corner, edges };
    let flipped = HullPlane { normal: -normal, offset: -plane.offset, ..plane };
    let supports =
        |plane: &HullPlane| extremes.iter().all(|&point| plane.height(point) >= -tolerance);
    [plane, flipped].into_iter().find(supports)
}

/// The farthest vertices along 26 directions.
fn extremes(mesh: &Mesh) -> Vec<Vec3> {
    let step = |digit: u8| f32::from(digit % 3) - 1.0;
    let directions = (0..27).map(|i: u8| Vec3::new(step(i), step(i / 3), step(i / 9)));
    let farthest = |direction: Vec3| {
        let finite = mesh.vertices().iter().copied().filter(|vertex| vertex.is_finite());
        finite.max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)))
    };
    directions.filter(|&direction| direction != Vec3::ZERO).filter_map(farthest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor of two triangles, and one that stands on it.
    fn floor_and_sail() -> Mesh {
        let vertices = vec![
            Vec3::ZERO,
            4.0 * Vec3::Z,
            Vec3::new(4.0, 0.0, 4.0),
            4.0 * Vec3::X,
            Vec3::new(2.0, 2.0, 2.0),
        ];
        Mesh::from_triangles(vertices, vec![[0, 1, 2], [0, 2, 3], [0, 2, 4]]).unwrap()
    }

    #[test]
    fn a_floor_is_a_plane_of_the_hull_and_what_stands_on_it_is_not() {
        let mesh = floor_and_sail();
        let planes = hull_planes(&mesh);
        assert_eq!(planes.len(), 1);
        assert_eq!((planes[0].normal, planes[0].offset), (Vec3::Y, 0.0));
        let found = whole_pieces(&mesh).map(|piece| plane_of_piece(&mesh, &planes, &piece));
        assert_eq!(found.collect::<Vec<_>>(), [Some(0), Some(0), None]);
        // The largest triangle has a diagonal, along which the floor does not lie.
        let edges = planes[0].edges.map(Vec3::length);
        assert!((edges[0] - 4.0).abs() < 1e-4 && (edges[1] - 4.0).abs() < 1e-4, "{edges:?}");
        assert!((planes[0].density() - 1.0).abs() < 1e-4);
        let wall = planes[0].wall(1.0, 0.01).unwrap();
        assert!((wall.height(Vec3::ZERO) - 0.01).abs() < 1e-5, "{wall:?}");
    }

    #[test]
    fn a_plane_tells_what_lies_behind_it_wherever_it_is_moved() {
        let plane = hull_planes(&floor_and_sail())[0];
        let turn = Affine3A::from_rotation_z(std::f32::consts::FRAC_PI_2);
        let moved = plane.transformed(&(Affine3A::from_translation(5.0 * Vec3::X) * turn)).unwrap();
        // Up is now toward -X, from the plane x = 5.
        let box_at = |x: f32| Aabb { min: Vec3::splat(x), max: Vec3::splat(x + 0.5) };
        assert!(moved.has_before_it(&box_at(4.4), 1e-3));
        assert!(!moved.has_before_it(&box_at(4.8), 1e-3));
        assert!(moved.has_before_it(&Aabb::EMPTY, 0.0));
    }
}
