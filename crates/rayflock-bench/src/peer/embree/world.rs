//! The current frame as Embree holds it.
//!
//! | Layout | Scenes |
//! |---|---|
//! | kept | one of low quality, a geometry an object: Embree builds a tree a geometry and keeps those of geometries that were not committed again |
//! | instances | one for what is static and one for what moves, instanced in a third |
//! | merged | one, with one geometry |
//!
//! Static geometry is built at medium quality.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Instant;

use rayflock::engine::CommitStats;
use rayflock::geom::{FrameChanges, Geometry, GeometryObject, ObjectChange, ObjectId, PrimId};

use super::ffi::{Device, Scene, Tracer};
use super::group::{Columns, Group, Part};
use super::layout::{
    Bounds, FEATURE_INSTANCE, FEATURE_SPHERE_POINT, FEATURE_TRIANGLE, QUALITY_LOW, QUALITY_MEDIUM,
    QUALITY_REFIT, SCENE_DYNAMIC, SCENE_ROBUST,
};
use super::moving::Moving;
use super::{Build, Layout, Quality};

/// The current frame.
#[derive(Debug)]
pub(super) struct World {
    build: Build,
    root: Scene,
    /// By object or, merged, by mask.
    groups: BTreeMap<u32, Group>,
    owners: Owners,
    moving: Moving,
    /// What was committed last.
    previous: Option<Geometry>,
    conversion_ns: u64,
}

impl World {
    /// An empty frame.
    pub(super) fn new(device: &Arc<Device>, build: Build, robust: bool) -> Self {
        let flags = SCENE_DYNAMIC | if robust { SCENE_ROBUST } else { 0 };
        let is_medium = build.quality == Quality::Medium;
        let moving_quality = if is_medium { QUALITY_MEDIUM } else { QUALITY_LOW };
        let mut root = match build.layout {
            Layout::Merged => Scene::new(device, moving_quality, flags),
            Layout::Kept | Layout::Instances => Scene::new(device, QUALITY_LOW, flags),
        };
        if build.layout == Layout::Instances {
            for (part, quality, flags) in [
                (Part::Static, QUALITY_MEDIUM, flags & !SCENE_DYNAMIC),
                (Part::Moving, moving_quality, flags),
            ] {
                let mut scene = Scene::new(device, quality, flags);
                scene.commit();
                root.attach_scene(part as u32, scene);
                root.set_enabled(part as u32, false);
                root.commit_geometry(part as u32);
            }
        }
        root.commit();
        Self {
            build,
            root,
            groups: BTreeMap::new(),
            owners: Owners::default(),
            moving: Moving::default(),
            previous: None,
            conversion_ns: 0,
        }
    }

    /// Makes `geometry` the current frame.
    pub(super) fn commit(&mut self, geometry: &Geometry) -> CommitStats {
        self.conversion_ns = 0;
        let start = Instant::now();
        let previous = self.previous.as_ref();
        let changes = previous.map(|previous| FrameChanges::between(previous, geometry));
        self.moving.note(changes.as_ref());
        let changes = changes.unwrap_or_default();
        let wanted = self.arrange(geometry);
        self.converted_since(start);

        let mut touched = BTreeSet::new();
        self.remove_unwanted(&wanted, &changes, &mut touched);
        let mut rewritten_count = 0;
        for (&key, wanted) in &wanted {
            let changed = wanted.objects.iter().filter(|object| has_changed(object, &changes));
            rewritten_count += changed.map(|object| object.shape.prim_count()).sum::<usize>();
            self.update(key, wanted, &changes, &mut touched);
        }
        self.build_scenes(&touched);

        let start = Instant::now();
        self.previous = Some(geometry.clone());
        self.converted_since(start);
        self.stats(geometry.prim_count(), rewritten_count)
    }

    fn stats(&self, prim_count: usize, rewritten_count: usize) -> CommitStats {
        CommitStats { prim_count, rewritten_count, conversion_ns: self.conversion_ns }
    }

    fn converted_since(&mut self, start: Instant) {
        self.conversion_ns += start.elapsed().as_nanos() as u64;
    }

    /// Which groups this frame is made of.
    fn arrange<'a>(&self, geometry: &'a Geometry) -> BTreeMap<u32, Wanted<'a>> {
        let mut wanted = BTreeMap::new();
        for object in geometry.objects() {
            let is_merged = self.build.layout == Layout::Merged;
            let is_moving = is_merged || self.moving.contains(object.id);
            let part = if is_moving { Part::Moving } else { Part::Static };
            let key = if is_merged { object.mask } else { object.id.0 };
            let new = || Wanted { part, mask: object.mask, objects: Vec::new() };
            wanted.entry(key).or_insert_with(new).objects.push(object);
        }
        wanted
    }

    /// Removes groups that are not wanted, or not as they are.
    fn remove_unwanted(
        &mut self,
        wanted: &BTreeMap<u32, Wanted<'_>>,
        changes: &FrameChanges,
        touched: &mut BTreeSet<u32>,
    ) {
        let fits = |(key, group): &(&u32, &Group)| {
            wanted.get(key).is_some_and(|wanted| wanted.fits(group, changes))
        };
        let unwanted: Vec<_> =
            self.groups.iter().filter(|entry| !fits(entry)).map(|(&key, _)| key).collect();
        for key in unwanted {
            self.remove(key, touched);
        }
    }

    fn remove(&mut self, key: u32, touched: &mut BTreeSet<u32>) {
        let Some(group) = self.groups.remove(&key) else { return };
        touched.insert(group.part as u32);
        for id in group.geometries() {
            self.owners.release(id);
            self.scene_mut(group.part).detach(id);
        }
    }

    /// Brings one group up to date.
    fn update(
        &mut self,
        key: u32,
        wanted: &Wanted<'_>,
        changes: &FrameChanges,
        touched: &mut BTreeSet<u32>,
    ) {
        let Some(mut group) = self.groups.remove(&key) else {
            return self.add(key, wanted, touched);
        };
        let before = group.non_finite();
        let is_new_mask = group.mask != wanted.mask;
        let is_changed = wanted.objects.iter().any(|object| has_changed(object, changes));
        if is_changed {
            let start = Instant::now();
            let layout = self.build.layout;
            let scene = part_of(&mut self.root, layout, group.part);
            for (member_idx, object) in wanted.objects.iter().enumerate() {
                if has_changed(object, changes) {
                    group.rewrite(member_idx, object, scene);
                }
            }
            self.converted_since(start);
            touched.insert(group.part as u32);
        }
        group.mask = wanted.mask;
        // A refit tree knows only what was valid when it was built.
        let is_stale = before + group.non_finite() > 0 && is_changed;
        for id in group.geometries().filter(|_| is_changed) {
            let scene = self.scene_mut(group.part);
            if is_new_mask {
                scene.set_mask(id, wanted.mask);
            }
            scene.commit_vertices(id);
        }
        self.groups.insert(key, group);
        if is_stale && self.build.quality == Quality::Refit {
            self.remove(key, touched);
            self.add(key, wanted, touched);
        }
    }

    /// Adds a group that is not there.
    fn add(&mut self, key: u32, wanted: &Wanted<'_>, touched: &mut BTreeSet<u32>) {
        let start = Instant::now();
        let (mut group, columns) = Group::new(wanted.part, wanted.mask, &wanted.objects);
        let Columns { vertices, triangles, spheres } = columns;
        let quality = self.geometry_quality(wanted.part);
        let scene = part_of(&mut self.root, self.build.layout, wanted.part);
        if !triangles.is_empty() {
            let id = self.owners.take(key);
            group.triangles = Some(id);
            scene.attach_triangles(id, vertices, triangles);
        }
        if !spheres.is_empty() {
            let id = self.owners.take(key);
            group.spheres = Some(id);
            scene.attach_spheres(id, spheres);
        }
        self.converted_since(start);

        let scene = part_of(&mut self.root, self.build.layout, wanted.part);
        for id in group.geometries() {
            scene.set_mask(id, wanted.mask);
            scene.set_quality(id, quality);
            scene.commit_geometry(id);
        }
        touched.insert(wanted.part as u32);
        self.groups.insert(key, group);
    }

    fn geometry_quality(&self, part: Part) -> u32 {
        match (part, self.build.quality) {
            (Part::Static, _) | (_, Quality::Medium) => QUALITY_MEDIUM,
            (_, Quality::Low) => QUALITY_LOW,
            (_, Quality::Refit) => QUALITY_REFIT,
        }
    }

    /// Builds the scenes whose parts were touched.
    fn build_scenes(&mut self, touched: &BTreeSet<u32>) {
        if touched.is_empty() {
            return;
        }
        if self.build.layout == Layout::Instances {
            for &part in touched {
                let scene = self.root.instanced_mut(part);
                scene.commit();
                let has_any = !scene.is_empty();
                self.root.set_enabled(part, has_any);
                self.root.commit_geometry(part);
            }
        }
        self.root.commit();
    }

    fn scene_mut(&mut self, part: Part) -> &mut Scene {
        part_of(&mut self.root, self.build.layout, part)
    }

    /// The frame, ready to be traced.
    pub(super) fn tracer(&self) -> Tracer<'_> {
        self.root.tracer()
    }

    /// The box around everything.
    pub(super) fn bounds(&self) -> Bounds {
        self.root.bounds()
    }

    /// What the frame holds, as `feature_mask`.
    pub(super) fn features(&self) -> u32 {
        let has_spheres = self.groups.values().any(|group| group.spheres.is_some());
        let is_instanced = self.build.layout == Layout::Instances;
        FEATURE_TRIANGLE
            | if has_spheres { FEATURE_SPHERE_POINT } else { 0 }
            | if is_instanced { FEATURE_INSTANCE } else { 0 }
    }

    /// The object and its primitive that primitive `prim_id` of geometry `geom_id` stands for;
    /// `None` for what is no geometry.
    pub(super) fn prim(&self, geom_id: u32, prim_id: u32) -> Option<(ObjectId, PrimId)> {
        let key = self.owners.get(geom_id)?;
        self.groups.get(&key).map(|group| group.prim(geom_id, prim_id))
    }

    /// Whether geometry `geom_id` holds spheres.
    pub(super) fn is_sphere(&self, geom_id: u32) -> bool {
        let group = self.owners.get(geom_id).and_then(|key| self.groups.get(&key));
        group.is_some_and(|group| group.spheres == Some(geom_id))
    }

    /// Bytes of the buffers shared with Embree.
    pub(super) fn memory_usage(&self) -> usize {
        self.root.memory_usage()
    }
}

/// A group as this frame needs it.
#[derive(Debug)]
struct Wanted<'a> {
    part: Part,
    mask: u32,
    objects: Vec<&'a GeometryObject>,
}

impl Wanted<'_> {
    /// Whether `group` can become this by moving vertices.
    fn fits(&self, group: &Group, changes: &FrameChanges) -> bool {
        let keeps_topology = |object: &&GeometryObject| {
            !matches!(changes.get(object.id), ObjectChange::Retopologised | ObjectChange::Added)
        };
        self.part == group.part
            && group.is_of(&self.objects)
            && self.objects.iter().all(keeps_topology)
    }
}

fn has_changed(object: &GeometryObject, changes: &FrameChanges) -> bool {
    changes.get(object.id) != ObjectChange::Unchanged
}

/// The scene that holds a part.
fn part_of(root: &mut Scene, layout: Layout, part: Part) -> &mut Scene {
    if layout == Layout::Instances { root.instanced_mut(part as u32) } else { root }
}

/// Which group each geometry belongs to. Geometry ids are unique over all scenes, so that a hit
/// needs no instance id.
#[derive(Debug, Default)]
struct Owners {
    /// Keys of groups by geometry id.
    keys: Vec<Option<u32>>,
    free: Vec<u32>,
}

impl Owners {
    /// A geometry id for the group `key`.
    fn take(&mut self, key: u32) -> u32 {
        let id = self.free.pop().unwrap_or_else(|| {
            self.keys.push(None);
            self.keys.len() as u32 - 1
        });
        self.keys[id as usize] = Some(key);
        id
    }

    fn release(&mut self, id: u32) {
        self.keys[id as usize] = None;
        self.free.push(id);
    }

    fn get(&self, id: u32) -> Option<u32> {
        self.keys.get(id as usize).copied().flatten()
    }
}
