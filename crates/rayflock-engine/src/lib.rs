//! Interchangeable engines that trace rays against geometry whose every triangle may move each
//! frame.
//!
//! | Engine | What it is | Use it when |
//! |---|---|---|
//! | [`brute`] | all rays against all primitives | you want the definition of the answer, or have a few hundred primitives |
//! | [`hierarchy`] | a structure over the rays, nothing over the geometry | everything moves, and rays share an origin or a direction or neighbours go similar ways |
//! | [`bvh`] | a tree over the geometry, built anew each frame, and streams of rays | rays share nothing: diffuse light, mirrors that are curved; or neighbours go alike and triangles are few |
//! | [`subfields`] | a grid of primitives for each direction, brought up to date when a ray wants it | very many rays share a direction |
//! | [`auto`] | asks whichever of the others is expected to answer soonest | you have no reason to choose |
//!
//! [`list_hits`] lists all hits of each ray with any of them, [`hit_normals`] tells which way what
//! was hit faces.
//!
//! Read them in this order: [`RayEngine`] (the question), [`brute`] (the definition of the
//! answer), [`hierarchy`] (the idea) and its stages in the order of their list.
//!
//! ```
//! use glam::Vec3;
//! use rayflock_engine::{EngineKind, create};
//! use rayflock_geom::{
//!     FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch,
//! };
//!
//! let mesh = Mesh::from_triangles(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
//! let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(7), mesh)])?;
//! let mut engine = create(EngineKind::Hierarchy);
//! engine.commit(&geometry, &FrameChanges::all())?;
//!
//! let origins = [Vec3::new(0.25, 0.25, 2.0), Vec3::new(2.0, 0.0, 2.0)];
//! let rays = RayBatch::new(&origins[..], -Vec3::Z)?;
//! let mut hits = HitBuffer::new(rays.len());
//! engine.closest_hit(&rays, &mut hits.as_hits());
//! assert_eq!(hits.get(0).object_id, ObjectId(7));
//! assert!(hits.get(1).is_miss());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod answer;
mod answers;
pub mod auto;
pub mod brute;
mod budget;
pub mod bvh;
mod engine;
pub mod hierarchy;
mod hit_list;
mod normals;
mod packet;
mod parts;
mod primitives;
mod scratch;
mod sort_keyed;
pub mod subfields;
mod triangle_leaf;
mod wanted;

pub use budget::{Budget, Clock, HeldBytes, StageTime};
pub use engine::{CommitStats, EngineError, EngineKind, Fact, RayEngine, TraceStats};
pub use hit_list::{HitList, list_hits};
pub use normals::{HitColumns, hit_normals};
pub use primitives::{Ignored, count_ignored};

/// Makes an engine with its default settings and an empty frame.
pub fn create(kind: EngineKind) -> Box<dyn RayEngine> {
    match kind {
        EngineKind::Auto => Box::new(auto::AutoEngine::default()),
        EngineKind::Brute => Box::new(brute::BruteEngine::default()),
        EngineKind::Hierarchy => Box::new(hierarchy::HierarchyEngine::default()),
        EngineKind::Bvh => Box::new(bvh::BvhEngine::default()),
        EngineKind::Subfields => Box::new(subfields::SubfieldsEngine::default()),
    }
}
