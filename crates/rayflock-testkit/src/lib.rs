//! What Rayflock's tests share: seeded scenes and rays, case files, the independent oracle.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`oracle`] | you want to know whether a hit is right |
//! | [`cases`] | you have a small example and its exact answer |
//! | [`image_difference()`] | you compare pictures |
//! | [`scenes`] | you need geometry: odd, huge, broken, closed, moving |
//! | [`rays`] | you need rays at it, in every form and with every hint |
//! | [`Rng`] | you need numbers that a seed reproduces |
//!
//! ```
//! use glam::Vec3;
//! use rayflock_geom::{Geometry, GeometryObject, Hit, ObjectId, Ray};
//! use rayflock_testkit::oracle::{Fault, Oracle};
//! use rayflock_testkit::scenes::ClosedMesh;
//!
//! let cube = GeometryObject::new(ObjectId(0), ClosedMesh::cube().mesh());
//! let oracle = Oracle::new(&Geometry::new(vec![cube])?);
//! let ray = Ray::new(Vec3::ZERO, Vec3::new(1.0, 0.3, 0.1));
//! assert!(matches!(oracle.judge(&ray, &Hit::MISS), Err(Fault::Beaten { .. })));
//! # Ok::<(), rayflock_geom::GeometryError>(())
//! ```
#![forbid(unsafe_code)]

mod aim;
pub mod cases;
mod image_difference;
pub mod rays;
mod rng;
pub mod scenes;

pub use rayflock_oracle as oracle;

pub use image_difference::{ImageDifference, image_difference};
pub use rng::Rng;
