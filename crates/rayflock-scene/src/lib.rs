//! What is in the world and how it moves.
//!
//! A [`Scene`] is everything a file or a generator describes: nodes, objects, materials, lights,
//! cameras and clips. An [`Evaluator`] turns it, for a time, into a [`SceneFrame`]: the geometry
//! that engines trace, what changed since the frame before, and what shading needs.
//!
//! | Part | Types | Use it when |
//! |---|---|---|
//! | A world | [`Scene`], [`SceneObject`], [`Node`], [`Light`], [`Camera`] | you import or generate one |
//! | What things look like | [`Material`], [`Texture`], [`SurfaceMesh`] | you import, or shade |
//! | What nodes do | [`Clip`], [`Channel`] | joints, rigid parts and morph weights move by keys, or objects come and go |
//! | Meshes that bend | [`Shape::Deformed`], [`MorphTarget`], [`Skin`] | vertices follow weights and joints |
//! | Meshes keyed by vertex | [`VertexFrames`] | every vertex has a path, triangles stay |
//! | Meshes keyed as a whole | [`MeshSequence`] | every frame has a mesh of its own |
//! | Meshes too many to hold | [`FrameStream`], [`FrameSource`] | frames are loaded when they are shown |
//! | Meshes as functions of time | [`AnimatedMesh`] | none of these fits |
//! | Scenes at a time | [`Evaluator`], [`SceneFrame`], [`MotionKind`] | you trace or render |
//! | A camera for scenes without | [`frame_bounds`] | the source brings none |
//! | Scenes that need no file | [`builtin`] | you try, test or measure |
//!
//! Conventions: right-handed, +Y up, cameras look along -Z; seconds, radians, scene units.
//! The crate knows no engines and no files.
//!
//! # Time
//!
//! One clip is played, and repeats: at its end it is at its start again
//! ([`Clip::local_time`]), unless the scene states how many frames it has. Animated meshes do not
//! repeat; outside their time range they rest.
//! A frame depends on its time alone, not on the frames made before; only what it says about
//! changes does.
//!
//! # Example
//!
//! ```
//! use std::sync::Arc;
//!
//! use glam::Vec3;
//! use rayflock_geom::{Mesh, ObjectChange, ObjectId};
//! use rayflock_scene::{
//!     Channel, ChannelValues, Clip, Evaluator, Interpolation, LocalTransform, Material,
//!     MaterialIdx, MotionKind, Node, NodeIdx, Scene, SceneObject, Shape, SurfaceMesh,
//! };
//!
//! // A triangle on a node that slides along X for two seconds.
//! let mesh = Mesh::from_triangles(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
//! let slide = Channel {
//!     node: NodeIdx(0),
//!     times: vec![0.0, 2.0],
//!     interpolation: Interpolation::Linear,
//!     values: ChannelValues::Translation(vec![Vec3::ZERO, 4.0 * Vec3::X]),
//! };
//! let scene = Scene {
//!     nodes: vec![Node {
//!         name: "sledge".to_owned(),
//!         parent: None,
//!         rest: LocalTransform::IDENTITY,
//!         rest_weights: vec![],
//!     }],
//!     objects: vec![SceneObject {
//!         name: "triangle".to_owned(),
//!         node: Some(NodeIdx(0)),
//!         mask: u32::MAX,
//!         shape: Shape::Fixed(SurfaceMesh::new(mesh, MaterialIdx(0))),
//!     }],
//!     materials: vec![Material::default()],
//!     clips: vec![Clip { name: "slide".to_owned(), channels: vec![slide] }],
//!     ..Scene::default()
//! };
//!
//! let mut evaluator = Evaluator::new(Arc::new(scene), Some("slide"))?;
//! assert_eq!(evaluator.motion_kinds(), [MotionKind::Rigid]);
//! evaluator.evaluate(0.0)?;
//! let frame = evaluator.evaluate(0.5)?;
//! assert_eq!(frame.changes.get(ObjectId(0)), ObjectChange::Transformed);
//! assert_eq!(frame.geometry.bounds().min, Vec3::X);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod animated_mesh;
mod animation;
mod blend;
mod bounds_over_clip;
pub mod builtin;
mod camera;
mod deform;
mod deformation;
mod error;
mod evaluator;
mod frame;
mod frame_stream;
mod framing;
mod key_times;
mod light;
mod material;
mod mesh_sequence;
mod motion;
mod node;
mod object;
mod pose;
mod sample;
mod scene;
mod surface;
mod track;
mod validate;
mod vertex_frames;

pub use animated_mesh::AnimatedMesh;
pub use animation::{Channel, ChannelValues, Clip, Interpolation};
pub use camera::{Camera, Projection};
pub use deformation::{Bend, Deformation, KeySpan};
pub use error::SceneError;
pub use evaluator::Evaluator;
pub use frame::SceneFrame;
pub use frame_stream::{FRAMES_KEPT, FrameSource, FrameStream, InBetweens};
pub use framing::frame_bounds;
pub use light::{Falloff, Light, LightKind};
pub use material::{Background, Fresnel, Material, MaterialIdx, Texture, TextureIdx};
pub use mesh_sequence::MeshSequence;
pub use motion::MotionKind;
pub use node::{LocalTransform, Node, NodeIdx};
pub use object::{MorphTarget, SceneObject, Shape, Skin, VertexInfluences};
pub use scene::Scene;
pub use surface::{PrimMaterials, SurfaceAttributes, SurfaceMesh};
pub use vertex_frames::{VertexFrames, VertexKey};
