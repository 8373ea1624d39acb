//! What is in the world and how it moves.
//!
//! A [`Scene`] is everything a file or a generator describes: nodes, objects, materials, lights,
//! cameras and clips. An [`Evaluator`] turns it, for a time, into a [`SceneFrame`]: the geometry
//! that engines trace, what changed since the frame before, and what shading needs.
//!
//! Conventions: right-handed, +Y up, cameras look along -Z; seconds, radians, scene units.
//! The crate knows no engines and no files.
#![forbid(unsafe_code)]

mod animated_mesh;
mod animation;
mod bounds_over_clip;
pub mod builtin;
mod camera;
mod deform;
mod error;
mod evaluator;
mod frame;
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
pub use error::SceneError;
pub use evaluator::Evaluator;
pub use frame::SceneFrame;
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
