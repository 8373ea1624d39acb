//! Objects that the device makes from what it holds: their geometry does not cross the bus.
//!
//! ```text
//!   once:        meshes, keys, morph targets, skins --> sources
//!   each frame:  shares, places --> objects;  weights, joints --> pose
//!                sources, objects, pose --[deform_vertices]--> vertices
//!                              --[write_triangles]--> primitives, normals of attributes
//! ```
//!
//! The frame that the evaluator has made on the host says how each mesh came about; of objects that
//! follow keys, morph targets or joints, or move as a whole, only that is sent. Bounds are written
//! by the stages of `gpu:compute`, which follow: their chunks do not end where objects do.
//!
//! **Source.** See `rayflock_scene::Deformation`; the stages do what the evaluator does.
//!
//! **Invariants.** A vertex is deformed once, so triangles that share it meet. Spheres, and meshes
//! that nobody tells how they came about, are the host's.
//!
//! **Cost.** 112 bytes an object and a frame, 48 a joint and 12 a weight; 32 bytes a vertex are
//! kept.

mod source;
mod sources;
#[cfg(test)]
mod tests;

use glam::Affine3A;
use rayflock_engine::Budget;
use rayflock_geom::{GeometryObject, ObjectChange};
use rayflock_scene::{Bend, Deformation, SceneFrame};
use wgpu::Buffer;

#[cfg(test)]
pub(crate) use self::source::INFLUENCE_WORDS;
use self::source::{Key, Placed, Source};
use self::sources::SourceStore;
use crate::GpuContext;
use crate::buffer::{GrowingBuffer, part_of};
use crate::layout::{DEFORMED_VERTEX_BYTES, DeformedObject, NOWHERE};
use crate::pass::{Groups, StageEncoder};
use crate::pipeline::{ComputeStage, compute_stage};
use crate::primitives::PrimitiveStore;
use crate::shaders;
use crate::stage_clock::StageClock;

/// Vertices that a binding may hold.
const MOST_VERTICES: usize = (128 << 20) / DEFORMED_VERTEX_BYTES;

/// Invocations of a workgroup.
const GROUP: usize = 64;

/// Words of a joint and of a morph target in the pose, as in `frame/deform_vertices.wgsl`.
pub(crate) const JOINT_WORDS: usize = 12;
pub(crate) const TARGET_WORDS: usize = 3;

/// Makes objects on the device.
#[derive(Debug)]
pub(super) struct Deformer {
    deform_vertices: ComputeStage,
    write_triangles: ComputeStage,
    sources: SourceStore,
    /// What each object of the frame is made from, if the device can make it.
    placed: Vec<Option<Placed>>,
    /// What is sent of the frame.
    objects: Vec<DeformedObject>,
    pose: Vec<u32>,
    object_buffer: GrowingBuffer,
    pose_buffer: GrowingBuffer,
    vertex_buffer: GrowingBuffer,
}

impl Deformer {
    pub(super) fn new(context: &GpuContext) -> Self {
        Self {
            deform_vertices: compute_stage(context, shaders::DEFORM_VERTICES, &[]),
            write_triangles: compute_stage(context, shaders::WRITE_TRIANGLES, &[]),
            sources: SourceStore::default(),
            placed: Vec::new(),
            objects: Vec::new(),
            pose: Vec::new(),
            object_buffer: GrowingBuffer::storage("deformed objects"),
            pose_buffer: GrowingBuffer::storage("pose"),
            vertex_buffer: GrowingBuffer::storage("deformed vertices"),
        }
    }

    /// Sees which objects of a frame the device can make, and sends what they are made from.
    pub(super) fn plan(&mut self, context: &GpuContext, frame: &SceneFrame) {
        let mut vertex_count = 0;
        let mut source = |object: &GeometryObject| {
            let source = source_of(frame, object)?;
            vertex_count += source.vertex_count();
            (vertex_count <= MOST_VERTICES).then_some(source)
        };
        let sources = frame.geometry.objects().iter().map(&mut source).collect();
        self.placed = self.sources.place(context, sources);
    }

    /// Whether the device can make the object at this place of the frame that was planned.
    pub(super) fn can_make(&self, object_idx: usize) -> bool {
        self.placed.get(object_idx).is_some_and(Option::is_some)
    }

    /// Makes these objects of the frame: writes their primitives and the normals among the
    /// `attributes`.
    pub(super) fn make(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        (frame, wanted): (&SceneFrame, &[usize]),
        primitives: &PrimitiveStore,
        attributes: &Buffer,
    ) {
        self.objects.clear();
        self.pose.clear();
        let Some(part) = primitives.parts().next() else { return };
        let first_ranks: Vec<usize> = primitives.ranks().map(|ranks| ranks.start).collect();
        for &object_idx in wanted {
            self.pose_object(frame, object_idx, first_ranks[object_idx]);
        }
        let Some(last) = self.objects.last() else { return };
        let vertex_count = (last.first_vertex + last.vertex_count) as usize;
        let triangle_count = (last.first_triangle + last.triangle_count) as usize;
        let vertex_bytes = vertex_count * DEFORMED_VERTEX_BYTES;
        let sources = self.sources.buffer().as_entire_binding();
        let pose = self.pose_buffer.write(context, &self.pose).as_entire_binding();
        let objects = self.object_buffer.write(context, &self.objects);
        let objects = part_of(objects, size_of_val(&*self.objects));
        let vertices = part_of(self.vertex_buffer.reserve(context, vertex_bytes), vertex_bytes);
        let mut encoder = StageEncoder::new(context, clock);
        let resources = [objects.clone(), sources.clone(), pose, vertices.clone()];
        let groups = Groups::Count(vertex_count.div_ceil(GROUP));
        encoder.stage(&self.deform_vertices, &resources, groups);
        let attributes = attributes.as_entire_binding();
        let primitives = part_of(part.buffer, part.bytes());
        let resources = [objects, sources, vertices, primitives, attributes];
        let groups = Groups::Count(triangle_count.div_ceil(GROUP));
        encoder.stage(&self.write_triangles, &resources, groups);
        encoder.submit();
    }

    /// Tells what is held and was sent.
    pub(super) fn hold(&self, budget: &mut Budget) {
        self.sources.hold(budget);
        for buffer in [&self.object_buffer, &self.pose_buffer, &self.vertex_buffer] {
            buffer.hold(budget);
        }
        budget.sent_bytes += (size_of_val(&*self.objects) + size_of_val(&*self.pose)) as u64;
    }

    /// Adds an object to those that are made.
    fn pose_object(&mut self, frame: &SceneFrame, object_idx: usize, first_rank: usize) {
        let object = &frame.geometry.objects()[object_idx];
        let Some(placed) = &self.placed[object_idx] else { return };
        let last = self.objects.last().copied().unwrap_or_default();
        let place = object.world_from_object.unwrap_or(Affine3A::IDENTITY);
        let [x_axis, y_axis, z_axis, translation] = place.to_cols_array_2d();
        let mut written = DeformedObject {
            x_axis,
            first_vertex: last.first_vertex + last.vertex_count,
            y_axis,
            vertex_count: object.shape.vertices().len() as u32,
            z_axis,
            first_triangle: last.first_triangle + last.triangle_count,
            translation,
            triangle_count: object.shape.triangles().len() as u32,
            first_rank: first_rank as u32,
            mask: object.mask,
            corners: placed.corners,
            positions: placed.base.positions,
            normals: placed.base.normals,
            next_positions: placed.next.positions,
            next_normals: placed.next.normals,
            influences: placed.influences,
            joints: NOWHERE,
            ..DeformedObject::default()
        };
        match deformation(frame, object) {
            Deformation::Between(span) => written.share = span.share,
            Deformation::Bent(bend) => write_pose(&mut self.pose, &mut written, bend, placed),
            _ => {}
        }
        self.objects.push(written);
    }
}

/// How the mesh of an object came about.
fn deformation<'a>(frame: &'a SceneFrame, object: &GeometryObject) -> &'a Deformation {
    frame.deformations.get(object.id.0 as usize).unwrap_or(&Deformation::None)
}

/// What the device can make an object from; none where the host has to write it.
fn source_of(frame: &SceneFrame, object: &GeometryObject) -> Option<Source> {
    let mesh = &object.shape;
    if mesh.triangles().is_empty() || mesh.triangles().len() < mesh.prim_count() {
        return None;
    }
    match deformation(frame, object) {
        Deformation::Between(span) => {
            let [base, next] = [&span.before, &span.after].map(Key::new);
            let source = Source { base, next: Some(next), targets: None, skin: None };
            source.makes(mesh).then_some(source)
        }
        Deformation::Bent(Bend { rest, targets, skin, .. }) => {
            let (base, targets) = (Key::new(rest), Some(targets.clone()));
            let source = Source { base, next: None, targets, skin: skin.clone() };
            source.makes(mesh).then_some(source)
        }
        _ => {
            let moves = frame.changes.get(object.id) == ObjectChange::Transformed;
            moves.then(|| Source::rigid(&frame.surfaces[object.id.0 as usize]))
        }
    }
}

/// Adds joints and the targets that count to the pose.
fn write_pose(pose: &mut Vec<u32>, object: &mut DeformedObject, bend: &Bend, placed: &Placed) {
    object.joints = pose.len() as u32;
    for joint in &bend.world_from_rest {
        let words: [f32; JOINT_WORDS] = joint.to_cols_array();
        pose.extend(words.map(f32::to_bits));
    }
    object.targets = pose.len() as u32;
    for (columns, &weight) in placed.targets.iter().zip(&bend.weights) {
        if weight != 0.0 {
            let words: [u32; TARGET_WORDS] = [columns.positions, columns.normals, weight.to_bits()];
            pose.extend(words);
            object.target_count += 1;
        }
    }
}
