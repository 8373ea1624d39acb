//! One frame of geometry: a list of objects, each a shared mesh at a place.

use std::sync::Arc;

use glam::Affine3A;
use thiserror::Error;

use crate::affine::similarity_scale;
use crate::{Aabb, Mesh, NO_ID, ObjectId};

/// A mesh in the world.
#[derive(Clone, Debug)]
pub struct GeometryObject {
    /// Stable identity from frame to frame.
    pub id: ObjectId,
    /// Rays see the object iff `ray.mask & mask != 0`.
    pub mask: u32,
    /// The primitives, in object space.
    pub shape: Arc<Mesh>,
    /// Where the object is; `None` when its vertices are in world space already.
    pub world_from_object: Option<Affine3A>,
}

impl GeometryObject {
    /// An object in world space that all rays see.
    pub fn new(id: ObjectId, shape: impl Into<Arc<Mesh>>) -> Self {
        Self { id, mask: u32::MAX, shape: shape.into(), world_from_object: None }
    }

    /// This object at another place.
    pub const fn with_transform(mut self, world_from_object: Affine3A) -> Self {
        self.world_from_object = Some(world_from_object);
        self
    }

    /// This object with another mask.
    pub const fn with_mask(mut self, mask: u32) -> Self {
        self.mask = mask;
        self
    }

    /// Whether nothing differs from `other`: the shared mesh, the place, the mask. Meshes are
    /// compared by identity.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.shape, &other.shape)
            && self.mask == other.mask
            && self.world_from_object == other.world_from_object
    }

    /// The box around the object, in world space.
    pub fn bounds(&self) -> Aabb {
        let bounds = self.shape.bounds();
        self.world_from_object.map_or(bounds, |transform| bounds.transformed(&transform))
    }
}

/// All objects of one frame, sorted by id. Cloning shares them, and allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    objects: Arc<Vec<GeometryObject>>,
}

/// Why objects do not make a geometry.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A triangle names a vertex that is not there.
    #[error(
        "triangle {triangle_idx} names vertex {vertex_idx}, but there are {vertex_count} vertices"
    )]
    VertexIndex {
        /// Which triangle of the mesh.
        triangle_idx: usize,
        /// The vertex it names.
        vertex_idx: u32,
        /// Vertices in the mesh.
        vertex_count: usize,
    },
    /// A deformed mesh has another number of vertices.
    #[error("the deformed mesh has {found} vertices, the mesh it deforms has {expected}")]
    VertexCount {
        /// Vertices given.
        found: usize,
        /// Vertices in the mesh.
        expected: usize,
    },
    /// Two objects share an id.
    #[error("two objects have the id {0}; ids must be unique within a frame")]
    DuplicateId(u32),
    /// The reserved id was used.
    #[error("the object id {NO_ID} is reserved for \"none\"")]
    ReservedId,
    /// More primitives than ids.
    #[error("{0} primitives; at most {max} can be told apart", max = NO_ID - 1)]
    TooManyPrimitives(usize),
    /// Spheres under a transform that would make ellipsoids of them.
    #[error(
        "object {0} holds spheres, but its transform scales unevenly or shears: spheres stay \
         spheres only under rotation, translation and uniform scale"
    )]
    SphereTransform(u32),
}

impl Geometry {
    /// A frame made of `objects`, in any order.
    ///
    /// # Errors
    /// [`GeometryError`] for ids that are not unique or reserved, for more than `2^32 - 2`
    /// primitives, and for spheres under a transform that is not a similarity.
    pub fn new(mut objects: Vec<GeometryObject>) -> Result<Self, GeometryError> {
        objects.sort_by_key(|object| object.id);
        for pair in objects.windows(2) {
            if pair[0].id == pair[1].id {
                return Err(GeometryError::DuplicateId(pair[0].id.0));
            }
        }
        if objects.last().is_some_and(|object| object.id == ObjectId::NONE) {
            return Err(GeometryError::ReservedId);
        }
        for object in &objects {
            let distorts = |m: &Affine3A| m.is_finite() && similarity_scale(m).is_none();
            let has_spheres = !object.shape.spheres().is_empty();
            if has_spheres && object.world_from_object.as_ref().is_some_and(distorts) {
                return Err(GeometryError::SphereTransform(object.id.0));
            }
        }
        let geometry = Self { objects: Arc::new(objects) };
        match geometry.prim_count() {
            count if count >= NO_ID as usize => Err(GeometryError::TooManyPrimitives(count)),
            _ => Ok(geometry),
        }
    }

    /// The objects, sorted by id.
    pub fn objects(&self) -> &[GeometryObject] {
        &self.objects
    }

    /// The object with this id.
    pub fn object(&self, id: ObjectId) -> Option<&GeometryObject> {
        self.objects
            .binary_search_by_key(&id, |object| object.id)
            .ok()
            .map(|idx| &self.objects[idx])
    }

    /// The objects that `keep` accepts, with their ids.
    pub fn subset(&self, keep: impl Fn(&GeometryObject) -> bool) -> Self {
        let kept = self.objects.iter().filter(|object| keep(object)).cloned();
        Self { objects: Arc::new(kept.collect()) }
    }

    /// Number of primitives in all objects.
    pub fn prim_count(&self) -> usize {
        self.objects.iter().map(|object| object.shape.prim_count()).sum()
    }

    /// The box around all objects, in world space.
    pub fn bounds(&self) -> Aabb {
        self.objects.iter().fold(Aabb::EMPTY, |bounds, object| bounds.union(&object.bounds()))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::Sphere;

    fn object(id: u32) -> GeometryObject {
        GeometryObject::new(ObjectId(id), Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, 1.0)]))
    }

    #[test]
    fn objects_are_sorted_and_found_by_id() {
        let geometry = Geometry::new(vec![object(7), object(2)]).unwrap();
        assert_eq!(geometry.objects()[0].id, ObjectId(2));
        assert!(geometry.object(ObjectId(7)).is_some());
        assert!(geometry.object(ObjectId(3)).is_none());
        assert_eq!(geometry.subset(|object| object.id.0 > 2).objects()[0].id, ObjectId(7));
    }

    #[test]
    fn wrong_ids_are_errors() {
        let twice = Geometry::new(vec![object(1), object(1)]);
        assert_eq!(twice.unwrap_err(), GeometryError::DuplicateId(1));
        assert_eq!(Geometry::new(vec![object(NO_ID)]).unwrap_err(), GeometryError::ReservedId);
    }

    #[test]
    fn spheres_must_stay_spheres() {
        let stretched = object(4).with_transform(Affine3A::from_scale(Vec3::new(1.0, 2.0, 1.0)));
        let error = Geometry::new(vec![stretched]).unwrap_err();
        assert_eq!(error, GeometryError::SphereTransform(4));
        let turned = Affine3A::from_rotation_y(1.0) * Affine3A::from_scale(Vec3::splat(2.0));
        assert!(Geometry::new(vec![object(4).with_transform(turned)]).is_ok());
    }
}
