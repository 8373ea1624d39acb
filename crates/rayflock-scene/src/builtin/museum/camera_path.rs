//! A calm walk around the museum's sculpture: one round, nearer and farther, lower and higher.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Vec3};

use super::super::keyed_path::{camera_channels, key_times, wave};
use super::super::node;
use super::FRAME_COUNT;
use super::hall::around_axis;
use crate::{Camera, Clip, Node, NodeIdx, Projection};

/// Where the camera is at `time` of a walk of `duration` seconds.
fn eye(time: f32, duration: f32) -> Vec3 {
    let angle = PI + TAU * time / duration;
    let radius = 4.2 + 0.45 * wave(time, duration);
    let height = 2.15 - 0.45 * wave(time, duration);
    around_axis(angle, radius, height)
}

/// What the camera looks at: from the heap on the block at the start up to the sails at the end.
fn target(time: f32, duration: f32) -> Vec3 {
    Vec3::Y * (2.5 - 0.3 * wave(time, duration))
}

/// The camera, the node that carries it and the clip that moves the node, for a walk that takes
/// `duration` seconds.
pub(super) fn build(duration: f32) -> (Node, Camera, Clip) {
    let camera = Camera {
        name: "walk".to_owned(),
        node: Some(NodeIdx(0)),
        node_from_camera: Affine3A::IDENTITY,
        projection: Projection::Perspective { vertical_fov: 45.0_f32.to_radians() },
    };
    let times = key_times(duration, FRAME_COUNT);
    let channels = camera_channels(
        NodeIdx(0),
        &times,
        |time| eye(time, duration),
        |time| target(time, duration),
    );
    let clip = Clip { name: "walk".to_owned(), channels };
    (node("walk", None, eye(0.0, duration)), camera, clip)
}

#[cfg(test)]
mod tests {
    use super::super::hall::INNER_RADIUS;
    use super::*;

    #[test]
    fn the_walk_stays_between_barrier_and_columns() {
        for frame in 0..=FRAME_COUNT {
            let eye = eye(frame as f32, FRAME_COUNT as f32);
            let distance = eye.with_y(0.0).length();
            assert!((3.0..INNER_RADIUS - 0.3).contains(&distance), "frame {frame}: {distance}");
            assert!((1.5..3.0).contains(&eye.y), "frame {frame}: {}", eye.y);
        }
    }
}
