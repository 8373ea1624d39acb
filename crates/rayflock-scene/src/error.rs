//! The errors of this crate.

use thiserror::Error;

/// Why a scene cannot be evaluated.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The node hierarchy loops.
    #[error("node {node_idx} (\"{name}\") is its own ancestor")]
    CyclicNodes {
        /// A node on the loop.
        node_idx: u32,
        /// Its name.
        name: String,
    },
    /// Something names a thing that is not there.
    #[error("{element} names {what} {idx}, but the number of these is {count}")]
    Index {
        /// What names it.
        element: String,
        /// The kind of thing named.
        what: &'static str,
        /// Its position.
        idx: usize,
        /// How many there are.
        count: usize,
    },
    /// Two lists that belong together differ in length.
    #[error("{element} has {found} {what}, expected {expected}")]
    Length {
        /// What holds the list.
        element: String,
        /// What is listed.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },
    /// Key times are missing, go back, or are not finite.
    #[error("{element}: key {key_idx} has the time {time}, expected {expected}")]
    KeyTime {
        /// What holds the keys.
        element: String,
        /// Which key.
        key_idx: usize,
        /// Its time in seconds.
        time: String,
        /// What would be right.
        expected: &'static str,
    },
    /// A list that must hold something is empty.
    #[error("{element} has no {what}")]
    Empty {
        /// What holds the list.
        element: String,
        /// What should be listed.
        what: &'static str,
    },
    /// An animated mesh could not be had.
    #[error("object \"{object}\" at {time} s: {reason}")]
    AnimatedMesh {
        /// The object's name.
        object: String,
        /// The time asked for, in seconds.
        time: String,
        /// What went wrong.
        reason: String,
    },
    /// The clip does not exist.
    #[error("no clip is called \"{name}\"; there are: {available}")]
    UnknownClip {
        /// The name asked for.
        name: String,
        /// The names there are.
        available: String,
    },
    /// The camera does not exist.
    #[error("no camera is called \"{name}\"; there are: {available}")]
    UnknownCamera {
        /// The name asked for.
        name: String,
        /// The names there are.
        available: String,
    },
    /// The objects do not make a geometry.
    #[error(transparent)]
    Geometry(#[from] rayflock_geom::GeometryError),
}
