//! The vocabulary of Rayflock: what every other crate says when it talks about rays and geometry.
//!
//! | Part | Types | Use it when |
//! |---|---|---|
//! | One frame of geometry | [`Mesh`], [`Geometry`], [`GeometryObject`] | you describe what can be hit |
//! | What moved since the last frame | [`FrameChanges`], [`ObjectChange`] | you hand an engine the next frame |
//! | A question | [`RayBatch`], [`Column`], [`RayOrder`] | you ask about many rays at once |
//! | An answer | [`Hits`], [`HitBuffer`], [`Hit`] | you read what was hit |
//! | Bounds | [`Aabb`], [`Sphere`], [`SphereCone`] | you write an engine |
//! | Kernels | [`simd`] | you write an engine |
//!
//! Lengths are in scene units, angles in radians, `t` in multiples of a ray's direction vector.
//!
//! ```
//! use glam::Vec3;
//! use rayflock_geom::{Geometry, GeometryObject, Mesh, ObjectId};
//!
//! let triangle = Mesh::from_triangles(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
//! let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), triangle)])?;
//! assert_eq!(geometry.prim_count(), 1);
//! # Ok::<(), rayflock_geom::GeometryError>(())
//! ```
#![deny(unsafe_code)]

mod aabb;
mod affine;
mod column;
mod frame_changes;
mod geometry;
mod hits;
mod ids;
mod mesh;
mod prefetch;
mod ray;
mod ray_batch;
pub mod simd;
mod sphere;
mod sphere_cone;
mod user_primitives;

pub use aabb::Aabb;
pub use affine::{RayTransform, similarity_scale, transform_point, transform_sphere};
pub use column::{Column, ColumnElement};
pub use frame_changes::{FrameChanges, ObjectChange};
pub use geometry::{Geometry, GeometryError, GeometryObject};
pub use hits::{Hit, HitBuffer, Hits};
pub use ids::{NO_ID, ObjectId, PrimId};
pub use mesh::{Mesh, PrimKind, is_degenerate_triangle};
pub use prefetch::prefetch;
pub use ray::{Ray, RayState};
pub use ray_batch::{RayBatch, RayBatchError, RayOrder};
pub use sphere::Sphere;
pub use sphere_cone::SphereCone;
pub use user_primitives::{UserHit, UserPrimitives};
