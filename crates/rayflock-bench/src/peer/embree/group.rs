//! A group: the objects that share Embree geometries, one of triangles and one of spheres.
//!
//! A group is one object, or for merged layouts all objects of one mask.

use rayflock::geom::{GeometryObject, ObjectId, PrimId};

use super::ffi::Scene;
use super::write::{count_non_finite, write_spheres, write_vertices};

/// Which of the scenes of a layout with instances a group is in. The number is the id of the
/// instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum Part {
    /// What has not moved yet.
    Static = 0,
    /// What has.
    Moving = 1,
}

/// An object's place in the columns of its group.
#[derive(Clone, Debug)]
pub(super) struct Member {
    /// The object.
    pub(super) id: ObjectId,
    first_vertex: usize,
    first_triangle: u32,
    first_sphere: u32,
    triangle_count: u32,
    non_finite: usize,
}

/// Objects that share geometries.
#[derive(Debug)]
pub(super) struct Group {
    /// Where it is.
    pub(super) part: Part,
    /// Which rays see it.
    pub(super) mask: u32,
    /// Its objects, in the order of their primitives.
    pub(super) members: Vec<Member>,
    /// The geometry of triangles.
    pub(super) triangles: Option<u32>,
    /// The geometry of spheres.
    pub(super) spheres: Option<u32>,
}

/// The columns of a new group.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// Three coordinates a vertex.
    pub(super) vertices: Vec<f32>,
    /// Corners of the triangles.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Four numbers a sphere.
    pub(super) spheres: Vec<f32>,
}

impl Group {
    /// A group of `objects`, without geometries yet, and its columns.
    pub(super) fn new(part: Part, mask: u32, objects: &[&GeometryObject]) -> (Self, Columns) {
        let mut columns = Columns::default();
        let members = objects.iter().map(|object| columns.add(object)).collect();
        (Self { part, mask, members, triangles: None, spheres: None }, columns)
    }

    /// Whether the group is made of these objects, in this order.
    pub(super) fn is_of(&self, objects: &[&GeometryObject]) -> bool {
        self.members.len() == objects.len()
            && self.members.iter().zip(objects).all(|(member, object)| member.id == object.id)
    }

    /// Writes the place of the member at `member_idx` anew, which is now `object`.
    pub(super) fn rewrite(
        &mut self,
        member_idx: usize,
        object: &GeometryObject,
        scene: &mut Scene,
    ) {
        let member = &mut self.members[member_idx];
        let mut non_finite = 0;
        if let Some(id) = self.triangles {
            let first = 3 * member.first_vertex;
            let end = first + 3 * object.shape.vertices().len();
            let vertices = &mut scene.vertices_mut(id)[first..end];
            write_vertices(object, vertices);
            non_finite += count_non_finite(object, vertices);
        }
        if let Some(id) = self.spheres {
            let first = 4 * member.first_sphere as usize;
            let end = first + 4 * object.shape.spheres().len();
            non_finite += write_spheres(object, &mut scene.vertices_mut(id)[first..end]);
        }
        member.non_finite = non_finite;
    }

    /// How many primitives of the group are not finite.
    pub(super) fn non_finite(&self) -> usize {
        self.members.iter().map(|member| member.non_finite).sum()
    }

    /// The geometries.
    pub(super) fn geometries(&self) -> impl Iterator<Item = u32> + use<> {
        self.triangles.into_iter().chain(self.spheres)
    }

    /// The object and its primitive that primitive `prim_id` of geometry `geom_id` stands for.
    pub(super) fn prim(&self, geom_id: u32, prim_id: u32) -> (ObjectId, PrimId) {
        let is_sphere = self.spheres == Some(geom_id);
        let first = |member: &Member| match is_sphere {
            true => member.first_sphere,
            false => member.first_triangle,
        };
        let member_idx = self.members.partition_point(|member| first(member) <= prim_id);
        let member = &self.members[member_idx.saturating_sub(1)];
        let before = if is_sphere { member.triangle_count } else { 0 };
        (member.id, PrimId(prim_id - first(member) + before))
    }
}

impl Columns {
    fn add(&mut self, object: &GeometryObject) -> Member {
        let (shape, first_vertex) = (&object.shape, self.vertices.len() / 3);
        let first_sphere = self.spheres.len() / 4;
        let first_triangle = self.triangles.len();

        self.vertices.resize(3 * (first_vertex + shape.vertices().len()), 0.0);
        let vertices = &mut self.vertices[3 * first_vertex..];
        write_vertices(object, vertices);
        let mut non_finite = count_non_finite(object, vertices);
        let offset = first_vertex as u32;
        self.triangles.extend(shape.triangles().iter().map(|corners| corners.map(|i| i + offset)));
        self.spheres.resize(4 * (first_sphere + shape.spheres().len()), 0.0);
        non_finite += write_spheres(object, &mut self.spheres[4 * first_sphere..]);

        Member {
            id: object.id,
            first_vertex,
            first_triangle: first_triangle as u32,
            first_sphere: first_sphere as u32,
            triangle_count: shape.triangles().len() as u32,
            non_finite,
        }
    }
}
