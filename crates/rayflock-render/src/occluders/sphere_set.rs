//! The spheres of one object, in its own space, and the pieces they are bound to.
//!
//! **Cost.** A refit reads each piece three times, some nanoseconds each, in parallel.

use std::ops::Range;

use glam::{Affine3A, Vec3, Vec3A};
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::{Aabb, Mesh, similarity_scale, transform_point};
use rayon::prelude::*;

use super::along_curve::cluster_quickly;
use super::cluster::{WeightedPoint, cluster_carefully};
use super::cut_pieces::{Piece, cut_pieces, surface_area, whole_pieces};
use super::hull_planes::{HullPlane, hull_planes, plane_of_piece};
use super::measure::{Measured, measure};

/// Clusters that one task measures at least.
const CLUSTERS_PER_TASK: usize = 8;

/// A set is worn out when the squared radii have grown by this factor since the fit.
const WORN: f32 = 1.5;

/// How pieces are brought to clusters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Care {
    /// Well, for many frames; what lies on the hull apart from the rest.
    Careful,
    /// At once, for this frame.
    Quick,
}

/// Spheres that stand for a mesh.
#[derive(Debug)]
pub(super) struct SphereSet {
    /// Cluster after cluster.
    pieces: Vec<Piece>,
    clusters: Vec<Cluster>,
    planes: Vec<HullPlane>,
    /// The surface that is not on the hull.
    free_area: f32,
    /// Of squared outer radii when the clusters were made.
    fitted_size: f32,
    buffers: Buffers,
}

/// Pieces that have a sphere in common.
#[derive(Clone, Debug)]
struct Cluster {
    pieces: Range<usize>,
    /// The plane of the hull that they lie in.
    plane_idx: Option<usize>,
    measured: Measured,
}

/// Working memory.
#[derive(Debug, Default)]
struct Buffers {
    cut: Vec<Piece>,
    /// Of the hull, for each piece that lies in one.
    plane_idxs: Vec<Option<usize>>,
    points: Vec<WeightedPoint>,
    ranges: Vec<Range<usize>>,
}

impl SphereSet {
    /// A set for `mesh`, without spheres yet.
    pub(super) fn new(mesh: &Mesh) -> Self {
        let planes = hull_planes(mesh);
        let free = |piece: &Piece| plane_of_piece(mesh, &planes, piece).is_none();
        let areas = whole_pieces(mesh).filter(free).filter_map(|piece| piece.placed(mesh));
        let free_area = areas.map(|piece| piece.area()).sum();
        let (pieces, clusters) = (Vec::new(), Vec::new());
        Self { pieces, clusters, planes, free_area, fitted_size: 0.0, buffers: Buffers::default() }
    }

    /// The surface that is not on the hull, in object space.
    pub(super) const fn free_area(&self) -> f32 {
        self.free_area
    }

    /// Makes clusters of the pieces of `mesh`: about `count` for what is not on the hull, and more
    /// for that.
    pub(super) fn fit(&mut self, mesh: &Mesh, count: usize, care: Care) {
        if care == Care::Quick {
            self.planes.clear();
            self.free_area = surface_area(mesh);
        }
        let area_per_sphere = self.free_area.max(f32::MIN_POSITIVE) / count.max(1) as f32;
        cut_pieces(mesh, area_per_sphere, &mut self.buffers.cut);
        self.find_planes(mesh);
        self.pieces.clear();
        self.clusters.clear();
        for plane_idx in (0..self.planes.len()).map(Some).chain([None]) {
            let area = self.gather_points(mesh, plane_idx);
            let share = (area / area_per_sphere).round() as usize;
            self.cluster_points(share.clamp(1, 4 * count.max(1)), plane_idx, care);
        }
        self.measure(mesh);
        self.fitted_size = self.size();
    }

    /// Notes for each piece in which plane of the hull it lies.
    fn find_planes(&mut self, mesh: &Mesh) {
        let Buffers { cut, plane_idxs, .. } = &mut self.buffers;
        plane_idxs.clear();
        match self.planes.is_empty() {
            true => plane_idxs.resize(cut.len(), None),
            false => {
                let plane = |piece| plane_of_piece(mesh, &self.planes, piece);
                cut.par_iter().map(plane).collect_into_vec(plane_idxs);
            }
        }
    }

    /// Makes the points those of the pieces in a plane, or in none; returns their area.
    fn gather_points(&mut self, mesh: &Mesh, plane_idx: Option<usize>) -> f32 {
        let Buffers { cut, plane_idxs, points, .. } = &mut self.buffers;
        points.clear();
        let mut area = 0.0;
        let in_plane = (0..).zip(&*cut).zip(&*plane_idxs).filter(|(_, idx)| **idx == plane_idx);
        for ((idx, piece), _) in in_plane {
            if let Some(placed) = piece.placed(mesh) {
                let (position, normal, weight) = (placed.middle(), placed.normal(), placed.area());
                points.push(WeightedPoint { position, normal, weight, idx, code: 0 });
                area += weight;
            }
        }
        area
    }

    fn cluster_points(&mut self, count: usize, plane_idx: Option<usize>, care: Care) {
        let Buffers { cut, points, ranges, .. } = &mut self.buffers;
        match care {
            Care::Careful => *ranges = cluster_carefully(points, count),
            Care::Quick => {
                ranges.clear();
                cluster_quickly(points, count, ranges);
            }
        }
        let start = self.pieces.len();
        self.pieces.extend(points.iter().map(|point| cut[point.idx as usize]));
        let nothing = Measured { sphere: SoftSphere::default(), bounds: Aabb::EMPTY };
        self.clusters.extend(ranges.iter().map(|range| Cluster {
            pieces: start + range.start..start + range.end,
            plane_idx,
            measured: nothing,
        }));
    }

    /// Brings the spheres to where the pieces are on `mesh`, which is that of the fit with other
    /// vertices. Nothing is known to be on the hull from then on.
    pub(super) fn refit(&mut self, mesh: &Mesh) {
        self.planes.clear();
        self.clusters.iter_mut().for_each(|cluster| cluster.plane_idx = None);
        self.measure(mesh);
    }

    fn measure(&mut self, mesh: &Mesh) {
        let pieces = &self.pieces;
        self.clusters.par_iter_mut().with_min_len(CLUSTERS_PER_TASK).for_each(|cluster| {
            cluster.measured = measure(mesh, &pieces[cluster.pieces.clone()]);
        });
    }

    fn size(&self) -> f32 {
        self.clusters.iter().map(|cluster| cluster.measured.sphere.outer.powi(2)).sum()
    }

    /// Whether pieces that have a sphere in common have parted so far that others should.
    pub(super) fn is_worn(&self) -> bool {
        self.size() > WORN * self.fitted_size
    }

    /// Planes of the hull.
    pub(super) fn planes(&self) -> &[HullPlane] {
        &self.planes
    }

    /// The box around the pieces.
    pub(super) fn bounds(&self) -> Aabb {
        let boxes = self.clusters.iter().map(|cluster| cluster.measured.bounds);
        boxes.fold(Aabb::EMPTY, |all, bounds| all.union(&bounds))
    }

    /// The spheres that dim anything, with the plane of the hull that each stands for.
    pub(super) fn spheres(&self) -> impl Iterator<Item = (Option<usize>, SoftSphere)> + '_ {
        let spheres =
            self.clusters.iter().map(|cluster| (cluster.plane_idx, cluster.measured.sphere));
        spheres.filter(|(_, sphere)| sphere.opacity > 0.0 && sphere.outer > 0.0)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let Buffers { cut, plane_idxs, points, ranges } = &self.buffers;
        (self.pieces.capacity() + cut.capacity()) * size_of::<Piece>()
            + self.clusters.capacity() * size_of::<Cluster>()
            + plane_idxs.capacity() * size_of::<Option<usize>>()
            + points.capacity() * size_of::<WeightedPoint>()
            + ranges.capacity() * size_of::<Range<usize>>()
    }
}

/// The factor by which a transform stretches lengths at most.
pub(super) fn stretch(transform: &Affine3A) -> f32 {
    let m = &transform.matrix3;
    similarity_scale(transform).unwrap_or_else(|| {
        // The Frobenius norm bounds that of the matrix.
        let squared = [m.x_axis, m.y_axis, m.z_axis].map(Vec3A::length_squared);
        (squared[0] + squared[1] + squared[2]).sqrt()
    })
}

/// A sphere that covers the image of what `sphere` covers; a moved one where `transform` is a
/// similarity.
pub(super) fn moved(sphere: &SoftSphere, transform: &Affine3A) -> SoftSphere {
    let scale = stretch(transform);
    let turned = transform.transform_vector3(sphere.flatness).normalize_or_zero();
    let flatness = match similarity_scale(transform) {
        Some(_) => turned * sphere.flatness.length(),
        None => Vec3::ZERO,
    };
    SoftSphere {
        center: transform_point(transform, sphere.center),
        inner: scale * sphere.inner,
        outer: scale * sphere.outer,
        opacity: sphere.opacity,
        flatness,
    }
}
