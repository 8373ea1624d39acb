//! Clips: keyframed channels that move nodes and morph weights.

use glam::{Quat, Vec3};

use crate::NodeIdx;
use crate::sample::KeyValue;

/// Shares of a frame that a clip may run over before it is given one more: file formats round
/// their key times.
pub(crate) const FRAME_TOLERANCE: f64 = 1e-3;

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
    /// Key times in seconds, not empty, finite, never decreasing. Where two keys have the same
    /// time, the value jumps to that of the later one.
    pub times: Vec<f32>,
    /// How values between keys come about.
    pub interpolation: Interpolation,
    /// The keys: as many values a key as [`Interpolation::values_per_key`] says.
    pub values: ChannelValues,
}

/// How values between keys come about. All but `Squad` are those of glTF 2.0, appendix C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the key before.
    Step,
    /// Linear; spherical linear for rotations.
    Linear,
    /// Cubic Hermite with stored tangents: in-tangent, value and out-tangent a key.
    CubicSpline,
    /// Through the keys along spherical quadrangles, with stored control values: in-control, value
    /// and out-control a key. It is made for rotations, whose signs count; other values take the
    /// same way in straight lines.
    Squad,
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
    /// Whether objects on the node, or on nodes that hang on it, are there: one value a key, which
    /// holds until the next, whatever the interpolation.
    Visibility(Vec<bool>),
}

impl Interpolation {
    /// Values that a channel stores for each key: 3 where tangents or controls are stored too, or
    /// else 1.
    pub const fn values_per_key(self) -> usize {
        match self {
            Self::Step | Self::Linear => 1,
            Self::CubicSpline | Self::Squad => 3,
        }
    }
}

impl Channel {
    /// Whether the property has the same value at all times.
    pub(crate) fn is_constant(&self) -> bool {
        let interpolation = self.interpolation;
        match &self.values {
            ChannelValues::Translation(values) | ChannelValues::Scale(values) => {
                is_constant(values, 1, interpolation)
            }
            ChannelValues::Rotation(values) => is_constant(values, 1, interpolation),
            ChannelValues::Weights { weights_per_key, values } => {
                is_constant(values, *weights_per_key, interpolation)
            }
            ChannelValues::Visibility(values) => values.windows(2).all(|pair| pair[0] == pair[1]),
        }
    }
}

/// Whether all keys and controls have the same value, and there are no tangents. A value has
/// `width` entries.
fn is_constant<T: KeyValue>(values: &[T], width: usize, interpolation: Interpolation) -> bool {
    let slots = interpolation.values_per_key();
    let value_slot = slots / 2;
    let has_tangents = interpolation == Interpolation::CubicSpline;
    values.iter().enumerate().all(|(idx, &value)| {
        let is_tangent = has_tangents && idx / width % slots != value_slot;
        let expected =
            if is_tangent { value * 0.0 } else { values[value_slot * width + idx % width] };
        value == expected
    })
}

impl Clip {
    /// The time within the clip, from 0 up to but without the [`duration`](Self::duration): clips
    /// repeat for ever, before time 0 as after the end, unless the scene states
    /// [how many frames](crate::Scene::frame_count) it has. So at exactly the duration, the clip is
    /// at its start again; its last key is what times just before then approach. A time that is
    /// no number is taken for 0.
    pub fn local_time(&self, time: f64) -> f64 {
        let duration = self.duration();
        let local = time.rem_euclid(duration);
        if local < duration { local } else { 0.0 }
    }

    /// How many frames, at this many a second, play the clip once; at least 1. The frame after
    /// them would be the first again, or lie behind it.
    pub fn frame_count(&self, frame_rate: f64) -> usize {
        let frames = self.duration() * frame_rate - FRAME_TOLERANCE;
        (frames.ceil() as usize).max(1)
    }

    /// The time of the last key of any channel, in seconds.
    pub fn duration(&self) -> f64 {
        let last = self.channels.iter().filter_map(|channel| channel.times.last());
        last.fold(0.0, |duration, &time| duration.max(f64::from(time)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(interpolation: Interpolation, values: ChannelValues) -> Channel {
        Channel { node: NodeIdx(0), times: vec![0.0, 2.5], interpolation, values }
    }

    fn clip() -> Clip {
        let values = ChannelValues::Translation(vec![Vec3::ZERO, Vec3::X]);
        let channels = vec![channel(Interpolation::Linear, values)];
        Clip { name: "walk".to_owned(), channels }
    }

    #[test]
    fn clips_repeat_and_end_where_they_start() {
        let local = |time| clip().local_time(time);
        let times = [0.0, 1.0, 2.5, 3.0, 5.0, -0.5, -1e-30, f64::NAN, f64::INFINITY];
        assert_eq!(times.map(local), [0.0, 1.0, 0.0, 0.5, 0.0, 2.0, 0.0, 0.0, 0.0]);
        assert_eq!(Clip { name: String::new(), channels: vec![] }.local_time(3.0), 0.0);
    }

    #[test]
    fn frames_play_the_clip_once() {
        let frames = |rate| clip().frame_count(rate);
        assert_eq!([frames(24.0), frames(10.0), frames(1.0), frames(0.1)], [60, 25, 3, 1]);
        assert_eq!([frames(0.0), frames(f64::NAN), frames(-3.0)], [1, 1, 1]);
    }

    #[test]
    fn a_clip_of_82_frames_in_f32_seconds_has_82() {
        let mut clip = clip();
        clip.channels[0].times[1] = 82.0 / 24.0;
        assert_eq!(clip.frame_count(24.0), 82);
    }

    #[test]
    fn constant_channels_are_told() {
        let (one, zero) = (Vec3::ONE, Vec3::ZERO);
        let translation = |interpolation, values: &[Vec3]| {
            channel(interpolation, ChannelValues::Translation(values.to_vec())).is_constant()
        };
        assert!(translation(Interpolation::Linear, &[one, one]));
        assert!(!translation(Interpolation::Linear, &[one, zero]));
        assert!(translation(Interpolation::CubicSpline, &[zero, one, zero, zero, one, zero]));
        assert!(!translation(Interpolation::CubicSpline, &[zero, one, one, zero, one, zero]));
        assert!(translation(Interpolation::Squad, &[one; 6]));
        assert!(!translation(Interpolation::Squad, &[one, one, zero, one, one, one]));
        let weights = |values: &[f32]| {
            let values = ChannelValues::Weights { weights_per_key: 2, values: values.to_vec() };
            channel(Interpolation::Step, values).is_constant()
        };
        assert!(weights(&[0.25, 0.75, 0.25, 0.75]));
        assert!(!weights(&[0.25, 0.75, 0.75, 0.25]));
    }
}
