//! How to take what files leave open.

use std::fmt;
use std::str::FromStr;

use rayflock_scene::InBetweens;

/// How to take what a file leaves open.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Which way is up in files of formats that do not say: all but glTF and AFF.
    pub up_axis: UpAxis,
    /// Files that an AFF file includes are read up to this level of detail; by default up to the
    /// level that the file states, or all if it states none.
    pub detail: Option<u32>,
    /// What a file is whose name ends in a number.
    pub numbered_file: NumberedFile,
    /// Frames a second of sequences, point caches and frame sets; `None` for what the source
    /// states, or else 24.
    pub frame_rate: Option<f64>,
    /// What such sources show between two frames.
    pub in_betweens: InBetweens,
}

/// Which way is up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// +Y, as in scenes.
    #[default]
    Y,
    /// +Z, as in most CAD and robotics data; the objects hang on a node that turns them.
    Z,
}

/// What a file is whose name ends in a number, such as `mesh_0001.obj`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NumberedFile {
    /// One file.
    #[default]
    Alone,
    /// The first frame of a sequence, if its number is the smallest of those beside it whose
    /// names are the same but for the number; or else one file.
    FirstFrame,
}

impl fmt::Display for UpAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

impl FromStr for UpAxis {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            _ => Err(format!("found \"{name}\", expected y or z")),
        }
    }
}
