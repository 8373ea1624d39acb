//! Indirect light by virtual lights: walks from the lights leave lights, which light everything.
//!
//! | Part | What it is |
//! |---|---|
//! | [`VirtualLights`] | the lights, as columns |
//! | [`PairVisibility`] | what points see of lights, asked in tiles of many points and many lights |
//!
//! **Source**: A. Keller, *Instant Radiosity*, SIGGRAPH 1997; L. Szecsi, thesis, ch. 5, for
//! visibility that may be approximate.

mod pair_visibility;
mod virtual_lights;

pub use pair_visibility::{PairTile, PairVisibility, VisibilityStats};
pub use virtual_lights::{Lobe, VirtualLight, VirtualLights};
