//! Binary glTF: one mesh with a morph target for each frame but the first, and a clip whose weights
//! go from one to the next.
//!
//! **Cost.** Weights take four bytes for each pair of frames, hence [`MorphSet::FRAME_LIMIT`].

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::Vec3;
use gltf::binary::{Glb, Header};
use gltf::json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf::json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf::json::mesh::{Mesh, Mode, MorphTarget, Primitive, Semantic};
use gltf::json::validation::{Checked, USize64};
use gltf::json::{Buffer, Index, Node, Root, Scene, Value, buffer};
use rayflock_geom::Aabb;
use thiserror::Error;

use super::FrameMesh;

/// Why a frame cannot be a morph of the first.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("found {found}, expected {expected} as in the first frame: glTF moves vertices only")]
pub struct MorphError {
    found: String,
    expected: String,
}

/// Frames that are to be one `.glb` file: the same triangles in all, of which the vertices move.
/// It has no spheres.
#[derive(Clone, Debug, Default)]
pub struct MorphSet {
    triangles: Vec<[u32; 3]>,
    frames: Vec<Vec<Vec3>>,
}

impl MorphSet {
    /// Frames that a set can have.
    pub const FRAME_LIMIT: usize = 2000;

    /// A set without frames.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`MorphError`] when the frame has other triangles or another number of vertices than the
    /// first, or is one too many.
    pub fn push(&mut self, frame: &FrameMesh) -> Result<(), MorphError> {
        let wrong = |found: String, expected: String| Err(MorphError { found, expected });
        if let Some(first) = self.frames.first() {
            let counts = |vertices: usize, triangles: usize| {
                format!("{vertices} vertices in {triangles} triangles")
            };
            let expected = counts(first.len(), self.triangles.len());
            if frame.vertices.len() != first.len() || frame.triangles.len() != self.triangles.len()
            {
                return wrong(counts(frame.vertices.len(), frame.triangles.len()), expected);
            }
            if frame.triangles != self.triangles {
                return wrong("other triangles".to_owned(), "those".to_owned());
            }
        }
        if self.frames.len() == Self::FRAME_LIMIT {
            let limit = format!("at most {}", Self::FRAME_LIMIT);
            return wrong("one more frame".to_owned(), limit);
        }
        self.triangles.clone_from(&frame.triangles);
        self.frames.push(frame.vertices.clone());
        Ok(())
    }

    /// Writes the file, with frames of this many a second. Vertices of frames but the first are
    /// rounded to a sum of two numbers.
    ///
    /// # Errors
    /// When `out` cannot be written to.
    pub fn write(&self, frame_rate: f64, out: &mut impl Write) -> io::Result<()> {
        let mut document = Document::default();
        // Meshes of glTF have vertices.
        if let Some(first) = self.frames.first().filter(|_| !self.triangles.is_empty()) {
            let targets = self.add_mesh(first, &mut document);
            if targets > 0 {
                self.add_clip(targets, frame_rate, &mut document);
            }
        }
        document.write(out)
    }

    /// Adds the mesh and its node; tells how many targets it has.
    fn add_mesh(&self, first: &[Vec3], document: &mut Document) -> usize {
        let indices = bytemuck::cast_slice(self.triangles.as_flattened());
        let count = 3 * self.triangles.len();
        let indices = document.add(indices, count, ComponentType::U32, Type::Scalar);
        let positions = document.add_points(first);
        let target = |frame: &Vec<Vec3>| {
            let offsets: Vec<Vec3> = frame.iter().zip(first).map(|(to, from)| to - from).collect();
            let positions = Some(document.add_points(&offsets));
            MorphTarget { positions, normals: None, tangents: None }
        };
        let targets: Vec<MorphTarget> = self.frames[1..].iter().map(target).collect();
        let target_count = targets.len();
        let primitive = Primitive {
            attributes: BTreeMap::from([(Checked::Valid(Semantic::Positions), positions)]),
            extensions: None,
            extras: Default::default(),
            indices: Some(indices),
            material: None,
            mode: Checked::Valid(Mode::Triangles),
            targets: (target_count > 0).then_some(targets),
        };
        let mesh = document.root.push(Mesh {
            extensions: None,
            extras: Default::default(),
            name: None,
            primitives: vec![primitive],
            weights: None,
        });
        let node = document.root.push(Node { mesh: Some(mesh), ..Node::default() });
        let scene = document.root.push(Scene {
            extensions: None,
            extras: Default::default(),
            name: None,
            nodes: vec![node],
        });
        document.root.scene = Some(scene);
        target_count
    }

    /// Adds the clip: at frame `i` target `i - 1` has weight 1 and the others none.
    fn add_clip(&self, target_count: usize, frame_rate: f64, document: &mut Document) {
        let frame_count = self.frames.len();
        let times: Vec<f32> = (0..frame_count).map(|i| (i as f64 / frame_rate) as f32).collect();
        let mut weights = vec![0.0_f32; frame_count * target_count];
        for target in 0..target_count {
            weights[(target + 1) * target_count + target] = 1.0;
        }
        let mut add = |numbers: &[f32]| {
            let bytes = bytemuck::cast_slice(numbers);
            document.add(bytes, numbers.len(), ComponentType::F32, Type::Scalar)
        };
        let (input, output) = (add(&times), add(&weights));
        let ends = [times.first(), times.last()].map(|end| end.map(|&end| Value::from(vec![end])));
        let [min, max] = ends;
        let times = &mut document.root.accessors[input.value()];
        (times.min, times.max) = (min, max);
        let interpolation = Checked::Valid(Interpolation::Linear);
        let (extensions, extras) = (None, Default::default());
        let sampler = Sampler { extensions, extras, input, interpolation, output };
        let path = Checked::Valid(Property::MorphTargetWeights);
        let (extensions, extras) = (None, Default::default());
        let target = Target { extensions, extras, node: Index::new(0), path };
        let (extensions, extras) = (None, Default::default());
        let channel = Channel { sampler: Index::new(0), target, extensions, extras };
        document.root.push(Animation {
            extensions: None,
            extras: Default::default(),
            channels: vec![channel],
            name: None,
            samplers: vec![sampler],
        });
    }
}

/// A glTF document and the bytes that its accessors are about.
#[derive(Debug, Default)]
struct Document {
    root: Root,
    bytes: Vec<u8>,
}

impl Document {
    /// Adds an array whose items are of four-byte numbers, so that all arrays are aligned.
    fn add(
        &mut self,
        bytes: &[u8],
        count: usize,
        component_type: ComponentType,
        type_: Type,
    ) -> Index<Accessor> {
        let view = self.root.push(buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.bytes.len())),
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: Default::default(),
        });
        self.bytes.extend_from_slice(bytes);
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(component_type)),
            extensions: None,
            extras: Default::default(),
            type_: Checked::Valid(type_),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    fn add_points(&mut self, points: &[Vec3]) -> Index<Accessor> {
        let bytes = bytemuck::cast_slice(points);
        let accessor = self.add(bytes, points.len(), ComponentType::F32, Type::Vec3);
        let Aabb { min, max } = Aabb::around(points.iter().copied());
        let row = |corner: Vec3| Some(Value::from(corner.to_array().to_vec()));
        let added = &mut self.root.accessors[accessor.value()];
        (added.min, added.max) = (row(min), row(max));
        accessor
    }

    fn write(mut self, out: &mut impl Write) -> io::Result<()> {
        if !self.bytes.is_empty() {
            self.root.push(Buffer {
                byte_length: USize64::from(self.bytes.len()),
                name: None,
                uri: None,
                extensions: None,
                extras: Default::default(),
            });
        }
        let json = self.root.to_vec().map_err(io::Error::other)?;
        let file = Glb {
            // The length is computed when it is written.
            header: Header { magic: *b"glTF", version: 2, length: 0 },
            json: Cow::Owned(json),
            bin: (!self.bytes.is_empty()).then_some(Cow::Owned(self.bytes)),
        };
        out.write_all(&file.to_vec().map_err(io::Error::other)?)?;
        out.flush()
    }
}
