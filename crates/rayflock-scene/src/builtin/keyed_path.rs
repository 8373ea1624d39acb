//! Paths as keyframes: functions of time, sampled densely enough to be played linearly.

use std::f32::consts::TAU;

use glam::{Mat3, Quat, Vec3};

use crate::{Channel, ChannelValues, Interpolation, NodeIdx};

/// The times of `key_count + 1` keys, evenly over `0..=duration` seconds.
pub(super) fn key_times(duration: f32, key_count: usize) -> Vec<f32> {
    (0..=key_count).map(|key| duration * key as f32 / key_count as f32).collect()
}

/// A channel that moves `node` linearly through `position` at each of `times`.
pub(super) fn translation_channel(
    node: NodeIdx,
    times: &[f32],
    position: impl Fn(f32) -> Vec3,
) -> Channel {
    let values = ChannelValues::Translation(times.iter().map(|&time| position(time)).collect());
    Channel { node, times: times.to_vec(), interpolation: Interpolation::Linear, values }
}

/// A channel that turns `node` through `rotation` at each of `times`.
pub(super) fn rotation_channel(
    node: NodeIdx,
    times: &[f32],
    rotation: impl Fn(f32) -> Quat,
) -> Channel {
    let values = ChannelValues::Rotation(times.iter().map(|&time| rotation(time)).collect());
    Channel { node, times: times.to_vec(), interpolation: Interpolation::Linear, values }
}

/// Two channels that carry `node`, a camera's, along `eye` while it looks at `target`.
pub(super) fn camera_channels(
    node: NodeIdx,
    times: &[f32],
    eye: impl Fn(f32) -> Vec3,
    target: impl Fn(f32) -> Vec3,
) -> Vec<Channel> {
    let rotation = |time| look_rotation(target(time) - eye(time));
    vec![rotation_channel(node, times, rotation), translation_channel(node, times, eye)]
}

/// The rotation that makes a camera look along `forward` with +Y upward in the picture.
pub(super) fn look_rotation(forward: Vec3) -> Quat {
    let back = -forward.normalize_or(Vec3::NEG_Z);
    let right = Vec3::Y.cross(back).normalize_or(Vec3::X);
    Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back))
}

/// A wave between -1 and 1 with the given period, 1 at time 0.
pub(super) fn wave(time: f32, period: f32) -> f32 {
    (TAU * time / period).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_at_its_target_and_stays_upright() {
        for forward in [Vec3::X, -Vec3::Z, Vec3::new(-1.0, 0.5, 2.0)] {
            let rotation = look_rotation(forward);
            assert!((rotation * Vec3::NEG_Z).abs_diff_eq(forward.normalize(), 1e-6));
            assert!((rotation * Vec3::X).y.abs() < 1e-6);
            assert!((rotation * Vec3::Y).y > 0.0);
        }
    }

    #[test]
    fn times_reach_both_ends() {
        let times = key_times(6.0, 300);
        assert_eq!((times[0], times[300], times.len()), (0.0, 6.0, 301));
    }
}
