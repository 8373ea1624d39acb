//! Clips: keyframed channels that move nodes and morph weights.

use glam::{Quat, Vec3};

use crate::NodeIdx;

/// A named animation, as a file stores it.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name in the file, to be chosen by.
    pub name: String,
    /// What moves.
    pub channels: Vec<Channel>,
}

/// One property of one node over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What moves.
    pub node: NodeIdx,
    /// Key times in seconds, strictly increasing, not empty.
    pub times: Vec<f32>,
    /// How values between keys come about.
    pub interpolation: Interpolation,
    /// The keys: one value a key, or with [`Interpolation::CubicSpline`] three (in-tangent,
    /// value, out-tangent).
    pub values: ChannelValues,
}

/// How values between keys come about (glTF 2.0, appendix C).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the key before.
    Step,
    /// Linear; spherical linear for rotations.
    Linear,
    /// Cubic Hermite with stored tangents.
    CubicSpline,
}

/// Keys of one kind of property.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelValues {
    /// Translations of the node.
    Translation(Vec<Vec3>),
    /// Rotations of the node.
    Rotation(Vec<Quat>),
    /// Scales of the node.
    Scale(Vec<Vec3>),
    /// Morph weights of the node: `weights_per_key` values for each value.
    Weights {
        /// Number of morph targets.
        weights_per_key: usize,
        /// The weights, value after value.
        values: Vec<f32>,
    },
}

impl Clip {
    /// The time of the last key of any channel, in seconds.
    pub fn duration(&self) -> f64 {
        let last = self.channels.iter().filter_map(|channel| channel.times.last());
        last.fold(0.0, |duration, &time| duration.max(f64::from(time)))
    }
}
