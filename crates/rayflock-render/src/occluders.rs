//! Spheres that stand for geometry, where it is enough to know about how much is in the way.
//!
//! ```text
//!   mesh -- cut_pieces --> pieces -- cluster --> clusters of pieces, kept with the object
//!                                                   |  measured where the vertices are now
//!   frame ----------------------------------------> SphereSet: a soft sphere a cluster
//!                                                   |  brought to the world by the transform
//!                                   SceneSpheres: all that can dim anything, as a SphereTree
//!                                                   |  culled by the shaft to a group of lights
//!   tile of points, lights ----------------------> see_tile: what comes through of each light
//!   many points: share_lookouts: some that see alike are one of the tile
//! ```
//!
//! A cluster's sphere lies around the middle of its pieces and reaches to the farthest corner.
//! How much it dims follows from Cauchy's formula: a closed convex surface of area A covers A / 4
//! of a plane, averaged over all directions, so a patch of area A, closed by a lid as large as the
//! sum of its area vectors, covers a quarter of both. The inner radius (or, for what is thin, the
//! opacity) is chosen so that the soft sphere covers as much. So as much light is taken away as by
//! the geometry, if not exactly there.
//!
//! What lies on the hull of the scene can be in no one's way, and is left out: a plane that the
//! whole scene lies on one side of (`hull_planes`).
//!
//! **Source.** L. Szecsi, L. Szirmay-Kalos et al.: virtual light sources with spherical occluders
//! (Szecsi's thesis, chapter 5), for the idea and the inner and outer radius. R. Wang et al.,
//! "Variational sphere set approximation for solid objects", The Visual Computer 22 (2006), for
//! spheres as clusters that Lloyd's iterations improve; D. Cohen-Steiner et al., "Variational Shape
//! Approximation", SIGGRAPH 2004, for clusters that face alike; Z. Ren et al., "Real-time Soft
//! Shadows in Dynamic Scenes using Spherical Harmonic Exponentiation", SIGGRAPH 2006, for sets that
//! follow deforming meshes by what they are bound to.
//!
//! **Departures.** Clusters are of pieces of the surface, not of the volume, so that open, thin
//! and torn meshes have spheres as well and a refit is one pass over the triangles.
//!
//! **Invariants.** Every corner of a piece lies within the outer radius of its sphere. A set whose
//! mesh did not change gives the same spheres; one that moves rigidly gives moved ones. What the
//! shaft rejects could have dimmed nothing. (tests beside each)

mod along_curve;
mod cluster;
mod cut_pieces;
mod hull_planes;
mod measure;
mod point_tile;
mod scene_spheres;
mod see_tile;
mod share_lookouts;
mod sphere_set;
mod sphere_tree;
mod surface_mean;

pub(crate) use along_curve::nearby_order;
pub use point_tile::PointTile;
pub use scene_spheres::{FitStats, SceneSpheres, SphereSettings};
pub use see_tile::{SeenLight, TileSight};
pub(crate) use share_lookouts::{Alike, LookoutTile, SharedLookouts};
pub use sphere_tree::SphereTree;
