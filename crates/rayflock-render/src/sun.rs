//! Hours of direct sun on surfaces that may move while the sun does.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`sun_position`] | you want to know where the sun stands, at a [`Place`] and an instant |
//! | [`Bearings`] | you turn that into a direction of a scene: which way is up, and north |
//! | [`Days`] | you want all the sun's directions of some days, step by step |
//! | [`SunMeter`] | you add up, for each face or vertex, how long they shine on it |
//!
//! # What is added up
//!
//! The hours between two times of the day are cut into steps of equal length, and the sun stands
//! where it does in the middle of a step for all of it (midpoint rule). A sample is lit during a
//! step iff
//!
//! 1. the middle of the sun's disc is above the horizon, at an elevation above 0, without the
//!    refraction of the air;
//! 2. the surface faces it: the front does, or, with [`Sides::Both`], either side;
//! 3. nothing lies on the ray from the sample to the sun, of any length.
//!
//! Samples are the centroids of faces, or the vertices with the normals of their faces, weighted
//! by area.
//!
//! **Source**: I. Reda and A. Andreas, *Solar Position Algorithm for Solar Radiation
//! Applications*, Solar Energy 76(5), 2004, for the sun's position.
//!
//! **Invariants**: hours do not depend on the engine, the number of threads, or the order of the
//! steps where their lengths are whole seconds.
//!
//! **Cost**: one batch of rays a step, of one direction, with a ray for each sample that faces the
//! sun; about 60 bytes a sample.
//!
//! # Example
//!
//! ```
//! use glam::Vec3;
//! use jiff::{civil::date, tz::Offset};
//! use rayflock_engine::{EngineKind, create};
//! use rayflock_geom::{FrameChanges, Geometry, GeometryObject, Mesh, ObjectId};
//! use rayflock_render::sun::{Axis, Bearings, Days, Place, Sampling, Sides, SunMeter};
//!
//! let corners = vec![Vec3::ZERO, Vec3::X, -Vec3::Z];
//! let plate = Mesh::from_triangles(corners, vec![[0, 1, 2]])?;
//! let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), plate)])?;
//! let mut meter = SunMeter::new(create(EngineKind::Auto), Sampling::Faces, Sides::Both);
//! meter.commit(&geometry, &FrameChanges::all())?;
//!
//! let berlin = Place::from_degrees(52.5, 13.4)?;
//! let bearings = Bearings::new(Axis::Y, 0.0);
//! let midsummer = Days { utc_offset: Offset::constant(2), ..Days::one(date(2024, 6, 21)) };
//! for step in midsummer.sunlit_steps(&berlin, &bearings)? {
//!     meter.add(step.to_sun, step.seconds);
//! }
//! let hours = meter.seconds()[0] / 3600.0;
//! assert!((16.5..17.0).contains(&hours));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bearings;
mod days;
mod error;
mod meter;
mod position;
mod samples;
mod see;
mod world_mesh;

pub use bearings::{Axis, Bearings};
pub use days::{Days, SunStep};
pub use error::SunError;
pub use meter::{Sides, SunMeter};
pub use position::{Place, SunPosition, sun_position};
pub use samples::{Sampling, SunSample};
pub use see::Seen;
pub use world_mesh::WorldMesh;
