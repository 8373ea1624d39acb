//! The spheres of all objects, brought up to date with each frame.
//!
//! ```text
//!   object is new                  clusters made with care
//!   same mesh, same place          kept
//!   same mesh, other place         moved
//!   other vertices                 refitted; made anew, quickly, where clusters have parted
//!   other triangles                made anew, quickly
//! ```
//!
//! What changed is told by the identity of shared meshes, as engines do. An object gets spheres in
//! proportion to the root of its surface: by the surface itself, large houses leave a single one to
//! each figure that walks before them.
//!
//! **Invariants.** The spheres of a frame in which nothing but places changed since objects came
//! do not depend on the frames between. Steady state takes no more memory.

use std::sync::Arc;

use glam::Affine3A;
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::simd::segment_walls::Wall;
use rayflock_geom::{Aabb, Geometry, GeometryObject, Mesh, ObjectId};
use rayon::prelude::*;
use tracing::debug_span;

use super::SphereTree;
use super::hull_planes::{HullPlane, TOLERANCE};
use super::sphere_set::{Care, SphereSet, moved, stretch};
use crate::stats::Stopwatch;

/// How spheres are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereSettings {
    /// About how many spheres stand for the scene, walls that nothing is behind left out;
    /// `1..=2^20`. Objects get at least one each.
    pub count: usize,
}

impl Default for SphereSettings {
    /// 512 spheres.
    fn default() -> Self {
        Self { count: 512 }
    }
}

/// What a frame's spheres took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitStats {
    /// Objects whose clusters were made.
    pub fitted: usize,
    /// Objects whose spheres followed their vertices.
    pub refitted: usize,
    /// Objects whose spheres followed their transform.
    pub moved: usize,
    /// Objects that rested.
    pub kept: usize,
    /// Spheres of the frame.
    pub spheres: usize,
    /// Seconds in all.
    pub seconds: f64,
}

/// The spheres of a scene, kept from frame to frame.
#[derive(Debug, Default)]
pub struct SceneSpheres {
    settings: SphereSettings,
    objects: Vec<ObjectSpheres>,
    /// Of the frame, in the order of the objects.
    spheres: Vec<SoftSphere>,
    walls: Vec<Wall>,
    /// Whether each plane of an object is a wall; working memory.
    is_wall: Vec<bool>,
    tree: SphereTree,
}

/// One object with its spheres.
#[derive(Debug)]
struct ObjectSpheres {
    id: ObjectId,
    shape: Arc<Mesh>,
    world_from_object: Option<Affine3A>,
    set: SphereSet,
    /// In world space.
    bounds: Aabb,
    change: Change,
}

/// What has to be done for an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Fit(Care),
    Refit,
    Move,
    Keep,
}

impl SceneSpheres {
    /// No spheres yet.
    pub fn new(settings: SphereSettings) -> Self {
        let settings = SphereSettings { count: settings.count.clamp(1, 1 << 20) };
        Self { settings, ..Self::default() }
    }

    /// Brings all spheres to where `geometry` is.
    pub fn commit(&mut self, geometry: &Geometry) -> FitStats {
        let _span = debug_span!("fit_spheres").entered();
        let stopwatch = Stopwatch::start();
        let mut has_changed = self.match_objects(geometry);
        has_changed |= self.objects.iter().any(|object| object.change != Change::Keep);
        if has_changed {
            self.update_sets();
            self.gather();
            self.tree.build(&self.spheres, &self.walls);
        }
        let count =
            |is: fn(Change) -> bool| self.objects.iter().filter(|object| is(object.change)).count();
        FitStats {
            fitted: count(|change| matches!(change, Change::Fit(_))),
            refitted: count(|change| change == Change::Refit),
            moved: count(|change| change == Change::Move),
            kept: count(|change| change == Change::Keep),
            spheres: self.spheres.len(),
            seconds: stopwatch.seconds(),
        }
    }

    /// The spheres of the committed frame.
    pub const fn tree(&self) -> &SphereTree {
        &self.tree
    }

    /// Bytes held, meshes not included.
    pub fn memory_usage(&self) -> usize {
        let sets = self.objects.iter().map(|object| object.set.memory_usage());
        sets.sum::<usize>()
            + self.objects.capacity() * size_of::<ObjectSpheres>()
            + self.spheres.capacity() * size_of::<SoftSphere>()
            + self.walls.capacity() * size_of::<Wall>()
            + self.is_wall.capacity()
            + self.tree.memory_usage()
    }

    /// Makes the objects those of `geometry`, and notes how each changed; whether any vanished.
    fn match_objects(&mut self, geometry: &Geometry) -> bool {
        let before = self.objects.len();
        self.objects.retain(|object| geometry.object(object.id).is_some());
        let vanished = self.objects.len() < before;
        for object in geometry.objects() {
            match self.objects.binary_search_by_key(&object.id, |known| known.id) {
                Ok(idx) => self.objects[idx].follow(object),
                Err(idx) => self.objects.insert(idx, ObjectSpheres::new(object)),
            }
        }
        vanished
    }

    /// Makes, refits and moves what has changed.
    fn update_sets(&mut self) {
        let total: f32 = self.objects.iter().map(ObjectSpheres::size_in_world).sum();
        let per_size = self.settings.count as f32 / total.max(f32::MIN_POSITIVE);
        self.objects.par_iter_mut().for_each(|object| {
            let share = (object.size_in_world() * per_size).round();
            object.update((share as usize).clamp(1, self.settings.count));
        });
    }

    /// Brings to the world all spheres that can be in the way, and walls in place of those that can
    /// only be in the way of light from without.
    fn gather(&mut self) {
        let bounds = |bounds: Aabb, object: &ObjectSpheres| bounds.union(&object.bounds);
        let tolerance = TOLERANCE * self.objects.iter().fold(Aabb::EMPTY, bounds).size().length();
        let Self { objects, spheres, walls, is_wall, .. } = self;
        spheres.clear();
        walls.clear();
        for (object_idx, object) in objects.iter().enumerate() {
            is_wall.clear();
            is_wall.extend(object.set.planes().iter().map(|plane| {
                let wall = wall(objects, object_idx, plane, tolerance);
                walls.extend(wall);
                wall.is_some()
            }));
            let in_the_way = object
                .set
                .spheres()
                .filter(|(plane_idx, _)| plane_idx.is_none_or(|plane_idx| !is_wall[plane_idx]));
            spheres.extend(in_the_way.map(|(_, sphere)| object.in_world(&sphere)));
        }
    }
}

/// The wall that stands for what lies in a plane of an object, if nothing of the scene lies behind
/// it.
fn wall(
    objects: &[ObjectSpheres],
    object_idx: usize,
    plane: &HullPlane,
    tolerance: f32,
) -> Option<Wall> {
    let density = plane.density();
    let plane = match &objects[object_idx].world_from_object {
        Some(transform) => plane.transformed(transform)?,
        None => *plane,
    };
    let mut others = objects.iter().enumerate().filter(|(idx, _)| *idx != object_idx);
    let is_hull = others.all(|(_, other)| plane.has_before_it(&other.bounds, tolerance));
    if is_hull { plane.wall(density, tolerance) } else { None }
}

impl ObjectSpheres {
    fn new(object: &GeometryObject) -> Self {
        Self {
            id: object.id,
            shape: Arc::clone(&object.shape),
            world_from_object: object.world_from_object,
            set: SphereSet::new(&object.shape),
            bounds: Aabb::EMPTY,
            change: Change::Fit(Care::Careful),
        }
    }

    /// Takes over mesh and place of the frame, and notes what that changes.
    fn follow(&mut self, object: &GeometryObject) {
        let is_placed_alike = self.world_from_object == object.world_from_object;
        self.change = match Arc::ptr_eq(&self.shape, &object.shape) {
            true if is_placed_alike => Change::Keep,
            true => Change::Move,
            false if object.shape.has_topology_of(&self.shape) => Change::Refit,
            false => Change::Fit(Care::Quick),
        };
        self.world_from_object = object.world_from_object;
        if self.change != Change::Keep {
            self.shape = Arc::clone(&object.shape);
        }
    }

    /// The root of the surface that can be in the way, in world space.
    fn size_in_world(&self) -> f32 {
        let stretch = self.world_from_object.as_ref().map_or(1.0, stretch);
        self.set.free_area().sqrt() * stretch
    }

    /// Does what the change asks for; `count` is the object's share of spheres.
    fn update(&mut self, count: usize) {
        match self.change {
            Change::Fit(care) => self.set.fit(&self.shape, count, care),
            Change::Refit => {
                self.set.refit(&self.shape);
                if self.set.is_worn() {
                    self.set.fit(&self.shape, count, Care::Quick);
                    self.change = Change::Fit(Care::Quick);
                }
            }
            Change::Move => {}
            Change::Keep => return,
        }
        let bounds = self.set.bounds();
        self.bounds = self.world_from_object.as_ref().map_or(bounds, |m| bounds.transformed(m));
    }

    fn in_world(&self, sphere: &SoftSphere) -> SoftSphere {
        self.world_from_object.as_ref().map_or(*sphere, |transform| moved(sphere, transform))
    }
}
