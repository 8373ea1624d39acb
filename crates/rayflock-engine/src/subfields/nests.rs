//! Objects that have subfields of their own: a teapot in a stadium.
//!
//! Tiles of the stadium are large for the teapot. An object that is complex for its size, or that
//! moves without changing its shape, is therefore left out of the grids of the scene and gets
//! subfields in its own space, in which it rests: they are written once, whatever way it goes, and
//! objects that share a mesh share them.
//!
//! ```text
//!   choose   objects of 4096 triangles or more, and nothing else, under a similarity, that
//!              moved without changing their shape, or
//!              would have more than sixteen triangles in each of the finest tiles that a grid of
//!              all objects has
//!   hold     a table of the object alone, and stamps that say when it changed
//!   trace    for each place of an object, the rays that come near it (trace_nests)
//! ```
//!
//! **Source.** P. Khanna, J. Mortensen, I. Yu, M. Slater, "Fast Ray Tracing of Scenes With
//! Unstructured Motion", SIGGRAPH 2004 posters, future work.
//!
//! **Invariants.** Whether an object is nested changes no answer: see
//! [`nest_place`](super::nest_place). Triangles without an area in object space may have one in the
//! world, so all rays near the object meet them.
//!
//! **Cost.** 61 bytes a triangle once more; sixteen places a test of each ray.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayflock_geom::{
    Aabb, FrameChanges, Geometry, GeometryObject, Mesh, ObjectId, similarity_scale, transform_point,
};

use super::config::{Config, Nesting};
use super::fields::Fields;
use super::nest_place::NestPlace;
use super::policy::Policy;
use crate::primitives::{ObjectSpan, PrimitiveTable};

/// Objects with fewer triangles are not worth grids of their own.
const FEWEST_TRIANGLES: usize = 4096;

/// There are at most so many places; each costs every batch a list of rays.
const MOST_PLACES: usize = 64;

/// Tiles along a side of the finest grid, see [`tile_grid`](super::tile_grid).
const FINEST_TILES: f32 = 4096.0;

/// An object is small when more triangles than this would be in each of the finest tiles.
const MOST_IN_TILE: f32 = 16.0;

/// Vertices by which the size of an object is judged.
const VERTEX_SAMPLE: usize = 64;

/// Objects with more triangles that may or may not have an area are not nested.
const MOST_LOOSE: usize = 64;

/// The nested objects of a frame.
#[derive(Debug, Default)]
pub(super) struct Nests {
    nests: Vec<Nest>,
    /// One for each object of the frame.
    is_nested: Vec<bool>,
    /// One for each object of the frame: whether its shape cannot be nested.
    is_refused: Vec<bool>,
    before: Vec<Before>,
    /// The spheres around all places, nest by nest.
    bounds: Vec<SphereBlock>,
}

/// A shape with subfields of its own.
#[derive(Debug)]
pub(super) struct Nest {
    shape: Arc<Mesh>,
    pub(super) table: PrimitiveTable,
    pub(super) fields: Fields,
    /// Triangles without an area in object space which may have one in the world.
    pub(super) loose: Vec<u32>,
    bounds: Aabb,
    /// Where the shape is this frame.
    pub(super) places: Vec<NestPlace>,
    /// Directions in object space that batches shared, in this frame and in the one before.
    shared: [Vec<Vec3>; 2],
}

/// An object of the frame before.
#[derive(Debug)]
struct Before {
    object: GeometryObject,
    is_nested: bool,
    /// Whether its shape was looked at and cannot be nested.
    is_refused: bool,
}

impl Nests {
    /// Chooses the objects of a frame that are nested; `spans` tells where their triangles lie in
    /// the table.
    pub(super) fn choose(&mut self, config: &Config, geometry: &Geometry, spans: &[ObjectSpan]) {
        self.nests.iter_mut().for_each(|nest| nest.places.clear());
        self.is_nested.clear();
        self.is_refused.clear();
        if config.nesting == Nesting::Off {
            self.is_nested.resize(spans.len(), false);
            return;
        }
        let finest = finest_tile(geometry);
        let before = std::mem::take(&mut self.before);
        let mut earlier = before.iter().peekable();
        for (object, span) in geometry.objects().iter().zip(spans) {
            while earlier.next_if(|earlier| earlier.object.id < object.id).is_some() {}
            let same = earlier.peek().filter(|earlier| {
                earlier.object.id == object.id && Arc::ptr_eq(&earlier.object.shape, &object.shape)
            });
            let moved = |same: &Before| same.object.world_from_object != object.world_from_object;
            let was_refused = same.is_some_and(|same| same.is_refused);
            let is_wanted = !was_refused
                && is_candidate(object, span)
                && (same.is_some_and(|same| same.is_nested || moved(same))
                    || is_small(object, finest));
            let is_nested = is_wanted && self.hold(config, geometry, object, span);
            self.is_nested.push(is_nested);
            // Where there was no room, there may be some in the next frame.
            let is_unfit = is_wanted && !is_nested && self.place_count() < MOST_PLACES;
            self.is_refused.push(was_refused || is_unfit);
        }
        self.remember(before, geometry);
        self.nests.retain(|nest| !nest.places.is_empty());
        self.share_budget(config, geometry.prim_count());
        self.list_bounds();
    }

    /// Whether the object at a position is nested.
    pub(super) fn is_nested(&self, object_idx: usize) -> bool {
        self.is_nested[object_idx]
    }

    /// Number of nested objects.
    pub(super) fn place_count(&self) -> usize {
        self.nests.iter().map(|nest| nest.places.len()).sum()
    }

    /// Begins the frame of all subfields.
    pub(super) fn begin_frame(&mut self, policy: &dyn Policy) {
        for nest in &mut self.nests {
            nest.shared.swap(0, 1);
            nest.shared[0].clear();
            policy.begin_frame(&mut nest.fields, &nest.table);
        }
    }

    /// Nanoseconds spent on bringing subfields up to date since this was asked last.
    pub(super) fn take_update_ns(&mut self) -> u64 {
        self.nests.iter_mut().map(|nest| nest.fields.take_update_ns()).sum()
    }

    /// The nests, and the spheres around their places, nest by nest.
    pub(super) fn parts(&mut self) -> (&mut [Nest], &[SphereBlock]) {
        (&mut self.nests, &self.bounds)
    }

    /// Gives an object a place in a nest; returns whether it can be nested.
    fn hold(
        &mut self,
        config: &Config,
        geometry: &Geometry,
        object: &GeometryObject,
        span: &ObjectSpan,
    ) -> bool {
        if self.place_count() == MOST_PLACES {
            return false;
        }
        let Some(nest) = self.nest_of(config, geometry, &object.shape) else { return false };
        let first = [span.first_slot.triangles as u32, span.first_rank as u32];
        let place = NestPlace::new(object.world_from_object, &nest.bounds, first, object.mask);
        let is_held = place.is_some() && nest.loose.len() <= MOST_LOOSE;
        nest.places.extend(place.filter(|_| is_held));
        is_held
    }

    /// The nest of a shape: the one that holds it, one that is not needed any more, or a new one.
    fn nest_of(
        &mut self,
        config: &Config,
        geometry: &Geometry,
        shape: &Arc<Mesh>,
    ) -> Option<&mut Nest> {
        let held = self.nests.iter().position(|nest| Arc::ptr_eq(&nest.shape, shape));
        let idx = match held {
            Some(idx) => idx,
            None => {
                let is_gone = |nest: &Nest| {
                    let mut shapes = geometry.objects().iter().map(|object| &object.shape);
                    !shapes.any(|shape| Arc::ptr_eq(shape, &nest.shape))
                };
                let free = self.nests.iter().position(is_gone);
                let idx = free.unwrap_or(self.nests.len());
                if idx == self.nests.len() {
                    self.nests.push(Nest::new(config, shape));
                }
                self.nests[idx].hold(shape).then_some(idx)?
            }
        };
        self.nests.get_mut(idx)
    }

    fn remember(&mut self, mut before: Vec<Before>, geometry: &Geometry) {
        before.clear();
        let verdicts = self.is_nested.iter().zip(&self.is_refused);
        let objects = geometry.objects().iter().zip(verdicts);
        before.extend(objects.map(|(object, (&is_nested, &is_refused))| {
            let object = object.clone();
            Before { object, is_nested, is_refused }
        }));
        self.before = before;
    }

    /// Gives each nest its part of the budget, by primitives.
    fn share_budget(&mut self, config: &Config, prim_count: usize) {
        for nest in &mut self.nests {
            let share = nest.shape.triangles().len() as f64 / prim_count.max(1) as f64;
            nest.fields.config.budget = (config.budget as f64 * share) as usize;
        }
    }

    fn list_bounds(&mut self) {
        self.bounds.clear();
        for (idx, place) in self.nests.iter().flat_map(|nest| &nest.places).enumerate() {
            if idx % LANES == 0 {
                self.bounds.push(SphereBlock::EMPTY);
            }
            self.bounds[idx / LANES].set(idx % LANES, &place.bound);
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let nest = |nest: &Nest| nest.table.memory_usage() + nest.fields.memory_usage();
        self.nests.iter().map(nest).sum::<usize>()
            + self.bounds.capacity() * size_of::<SphereBlock>()
            + self.before.capacity() * size_of::<Before>()
    }
}

impl Nest {
    fn new(config: &Config, shape: &Arc<Mesh>) -> Self {
        Self {
            shape: Arc::clone(shape),
            table: PrimitiveTable::new(config.simd),
            fields: Fields::new(*config),
            loose: Vec::new(),
            bounds: Aabb::EMPTY,
            places: Vec::new(),
            shared: Default::default(),
        }
    }

    /// Notes a direction that a batch shares; returns whether one of the frame before did too.
    pub(super) fn notes_direction(&mut self, direction: Vec3) -> bool {
        let [now, before] = &mut self.shared;
        if !now.contains(&direction) {
            now.push(direction);
        }
        before.contains(&direction)
    }

    /// Takes a shape; returns whether it can be held.
    fn hold(&mut self, shape: &Arc<Mesh>) -> bool {
        let object = GeometryObject::new(ObjectId(0), Arc::clone(shape));
        let Ok(geometry) = Geometry::new(vec![object]) else { return false };
        self.shape = Arc::clone(shape);
        self.bounds = shape.bounds();
        self.table.commit(&geometry, &FrameChanges::all());
        self.table.write_triangles();
        self.list_loose();
        let contents = &mut self.fields.contents;
        contents.frame += 1;
        contents.kept_frame = contents.frame;
        contents.kept.list(self.table.spans(), |_| true);
        true
    }

    fn list_loose(&mut self) {
        self.loose.clear();
        if !self.table.has_ignored() {
            return;
        }
        let table = &self.table;
        let is_ignored = |idx: &u32| table.mask(*idx) == 0;
        let may_have_area = |idx: &u32| {
            let [a, b, c] = self.shape.corners(*idx as usize);
            a != b && b != c && c != a && [a, b, c].iter().all(|corner| corner.is_finite())
        };
        let all = 0..self.shape.triangles().len() as u32;
        self.loose.extend(all.filter(is_ignored).filter(may_have_area).take(MOST_LOOSE + 1));
    }
}

/// Whether an object has triangles enough, and nothing else, and keeps its angles.
fn is_candidate(object: &GeometryObject, span: &ObjectSpan) -> bool {
    let is_similar = |transform| similarity_scale(&transform).is_some();
    span.count.triangles >= FEWEST_TRIANGLES
        && span.prim_count() == span.count.triangles
        && object.world_from_object.is_none_or(is_similar)
}

/// Whether an object has so many triangles for its size that tiles of this size hold too many.
fn is_small(object: &GeometryObject, finest: f32) -> bool {
    let tiles = (sampled_size(object).size().max_element() / finest).max(1.0);
    object.shape.triangles().len() as f32 > MOST_IN_TILE * tiles * tiles
}

/// The size of the finest tiles of grids around all objects.
fn finest_tile(geometry: &Geometry) -> f32 {
    let all = geometry.objects().iter().map(sampled_size);
    let all = all.fold(Aabb::EMPTY, |all, one| all.union(&one));
    all.size().max_element() / FINEST_TILES
}

/// About the box around an object, by some of its vertices.
fn sampled_size(object: &GeometryObject) -> Aabb {
    let vertices = object.shape.vertices();
    let step = vertices.len().div_ceil(VERTEX_SAMPLE).max(1);
    Aabb::around(vertices.iter().step_by(step).map(|&vertex| {
        object.world_from_object.map_or(vertex, |transform| transform_point(&transform, vertex))
    }))
}
