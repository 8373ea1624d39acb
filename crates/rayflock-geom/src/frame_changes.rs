//! What moved since the last frame.

use std::sync::Arc;

use crate::{Geometry, GeometryObject, ObjectId};

/// How one object differs from the last frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectChange {
    /// Same mesh, same place.
    Unchanged,
    /// Same mesh under another transform or mask.
    Transformed,
    /// Same triangles, other vertices; spheres of the same number.
    Deformed,
    /// Anything may differ.
    Retopologised,
    /// Not there in the last frame.
    Added,
    /// There in the last frame, gone now.
    Removed,
}

impl Default for FrameChanges {
    /// Anything may have changed.
    fn default() -> Self {
        Self::all()
    }
}

/// One [`ObjectChange`] an object, relative to the geometry committed before.
///
/// A hint that saves engines work; [`FrameChanges::all`] is always correct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameChanges {
    /// Sorted by id; objects that are not listed have `unlisted`.
    listed: Vec<(ObjectId, ObjectChange)>,
    unlisted: ObjectChange,
}

impl FrameChanges {
    /// Anything may have changed.
    pub const fn all() -> Self {
        Self { listed: Vec::new(), unlisted: ObjectChange::Retopologised }
    }

    /// Nothing has changed.
    pub const fn none() -> Self {
        Self { listed: Vec::new(), unlisted: ObjectChange::Unchanged }
    }

    /// Exactly how `current` differs from `previous`, told by the identity of the shared meshes.
    pub fn between(previous: &Geometry, current: &Geometry) -> Self {
        let mut changes = Self::none();
        for object in current.objects() {
            let change = previous
                .object(object.id)
                .map_or(ObjectChange::Added, |before| change_between(before, object));
            changes.set(object.id, change);
        }
        for object in previous.objects() {
            if current.object(object.id).is_none() {
                changes.set(object.id, ObjectChange::Removed);
            }
        }
        changes
    }

    /// Records how object `id` changed.
    pub fn set(&mut self, id: ObjectId, change: ObjectChange) {
        match self.listed.binary_search_by_key(&id, |&(listed_id, _)| listed_id) {
            Ok(idx) => self.listed[idx].1 = change,
            Err(idx) => self.listed.insert(idx, (id, change)),
        }
    }

    /// How object `id` changed.
    pub fn get(&self, id: ObjectId) -> ObjectChange {
        self.listed
            .binary_search_by_key(&id, |&(listed_id, _)| listed_id)
            .map_or(self.unlisted, |idx| self.listed[idx].1)
    }

    /// The objects that were recorded, in order of their ids.
    pub fn iter(&self) -> impl Iterator<Item = (ObjectId, ObjectChange)> + '_ {
        self.listed.iter().copied()
    }
}

fn change_between(before: &GeometryObject, now: &GeometryObject) -> ObjectChange {
    if now.is_same(before) {
        ObjectChange::Unchanged
    } else if Arc::ptr_eq(&before.shape, &now.shape) {
        ObjectChange::Transformed
    } else if now.shape.has_topology_of(&before.shape) {
        ObjectChange::Deformed
    } else {
        ObjectChange::Retopologised
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};

    use super::*;
    use crate::Mesh;

    fn triangle() -> Arc<Mesh> {
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        Arc::new(Mesh::from_triangles(vertices, vec![[0, 1, 2]]).unwrap())
    }

    fn frame(objects: Vec<GeometryObject>) -> Geometry {
        Geometry::new(objects).unwrap()
    }

    #[test]
    fn between_tells_every_kind_of_change() {
        let mesh = triangle();
        let object = |id| GeometryObject::new(ObjectId(id), Arc::clone(&mesh));
        let before = frame((0..5).map(object).collect());
        let moved = object(1).with_transform(Affine3A::from_translation(Vec3::X));
        let deformed = mesh.with_vertices(vec![Vec3::ZERO, Vec3::X, Vec3::Z]).unwrap();
        let now = frame(vec![
            object(0),
            moved,
            GeometryObject::new(ObjectId(2), deformed),
            GeometryObject::new(ObjectId(3), triangle()),
            object(7),
        ]);
        let changes = FrameChanges::between(&before, &now);
        let expected = [
            (0, ObjectChange::Unchanged),
            (1, ObjectChange::Transformed),
            (2, ObjectChange::Deformed),
            (3, ObjectChange::Retopologised),
            (4, ObjectChange::Removed),
            (7, ObjectChange::Added),
        ];
        let found: Vec<_> = changes.iter().map(|(id, change)| (id.0, change)).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn unlisted_objects_follow_the_default() {
        assert_eq!(FrameChanges::all().get(ObjectId(3)), ObjectChange::Retopologised);
        assert_eq!(FrameChanges::none().get(ObjectId(3)), ObjectChange::Unchanged);
    }
}
