//! What a picture shows: light, or what lies behind it.

use std::fmt;

/// What the pixels of a picture tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shown {
    /// Light: a picture.
    #[default]
    Light,
    /// Light from virtual lights alone, where there are any.
    Indirect,
    /// The shading normal of what is seen first: red, green and blue are x, y and z, each from -1
    /// at black to 1.
    Normals,
    /// The distance to what is seen first: white is the diagonal of the scene, and what nothing is
    /// seen of.
    Depth,
    /// Rays traced for the pixel, pairs with virtual lights not included: white is
    /// [`Shown::COST_OF_WHITE`] a sample.
    Cost,
    /// Light, dimmed, and a dot in its colour for each virtual light that is seen.
    Vpls,
    /// Light, dimmed, and before it the spheres that stand for geometry, where visibility is asked
    /// of them: each in a colour of its own, as far as it takes light away.
    Spheres,
}

impl Shown {
    /// All that can be shown.
    pub const ALL: [Self; 7] = [
        Self::Light,
        Self::Indirect,
        Self::Normals,
        Self::Depth,
        Self::Cost,
        Self::Vpls,
        Self::Spheres,
    ];

    /// Rays a sample that [`Shown::Cost`] shows white.
    pub const COST_OF_WHITE: u32 = 32;

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Indirect => "indirect",
            Self::Normals => "normals",
            Self::Depth => "depth",
            Self::Cost => "cost",
            Self::Vpls => "vpls",
            Self::Spheres => "spheres",
        }
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
