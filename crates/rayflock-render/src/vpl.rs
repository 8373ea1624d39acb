//! Indirect light by virtual lights: walks from the lights leave lights, which light everything.
//!
//! | Part | What it is |
//! |---|---|
//! | [`VplSettings`] | how many lights, which visibility, which bound |
//! | [`VirtualLights`] | the lights, as columns |
//! | [`PairVisibility`] | what points see of lights, asked in tiles of many points and many lights |
//!
//! ```text
//! picture:        shoot:  walks from sources, step by step -> engine: closest_hit -> lights
//! wave of points: gather: tile of points and lights: who faces whom
//!                           -> PairVisibility: exact (engine: occluded), or none
//!                           -> sums, cut off at the bound
//!                 gather_past_spheres: the same without pairs, by `occluders`
//!                 gather_from_lookouts: rays from one point for its neighbours, too
//!                 gather_by_cuts: for many thousands of lights, by `lightcuts`
//!                 or gather_chosen (`resample`): guessed visibility chooses few lights a point,
//!                           -> exact visibility corrects the guess
//! ```
//!
//! **Source**: A. Keller, *Instant Radiosity*, SIGGRAPH 1997; L. Szecsi, thesis, ch. 5, for
//! visibility that may be approximate.
//!
//! **What is left out**: light that comes by a mirror or through glass onto a rough surface that
//! is seen, as no virtual light lies on the way (caustics). Light that is scattered once after that
//! is there.

mod exact_visibility;
mod gather;
mod gather_by_cuts;
mod gather_from_lookouts;
mod gather_past_spheres;
pub(crate) mod indirect;
mod light_blocks;
mod light_ways;
mod lookout_cells;
mod pair_visibility;
mod resample;
mod settings;
pub(crate) mod shadow_segments;
mod shoot;
mod sources;
mod sphere_visibility;
mod virtual_lights;

pub use pair_visibility::{PairTile, PairVisibility, VisibilityStats};
pub use settings::{ChosenBy, ChosenRays, LookoutSettings, Visibility, VplSettings};
pub use virtual_lights::{Lobe, VirtualLight, VirtualLights};
