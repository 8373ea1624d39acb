//! A walk as keyframes.
//!
//! For each foot the walk says where the ankle is in the course of a cycle (two steps): for
//! [`STANCE`] of it the foot stands, moving backward under the body as fast as the body moves
//! forward, rolling from heel to toe; then it swings forward. Hip and knee follow from the
//! triangle of thigh, shin and the line from hip to ankle; so feet neither slide nor sink.
//!
//! All angles are forward pitches: positive swings a limb, or lifts the toes, forward.

use std::f32::consts::{PI, TAU};

use glam::{FloatExt, Quat, Vec2, Vec3};

use super::figure::Figure;
use super::path::Path;
use super::skeleton::{
    ARM, CHEST, FOOT, FOREARM, HEAD, PELVIS, SHIN, SPINE, THIGH, joint_node, rest,
};
use crate::builtin::keyed_path::{rotation_channel, translation_channel};
use crate::{Channel, NodeIdx};

/// The share of a cycle in which a foot stands.
const STANCE: f32 = 0.6;
/// The share after which the heel of the standing foot lifts.
const HEEL_OFF: f32 = 0.36;
/// Pitch of the foot when the toes leave the ground, and when the heel comes down.
const TOE_OFF_PITCH: f32 = -0.65;
const STRIKE_PITCH: f32 = 0.22;
/// From the ankle forward to the ball of the foot, and backward to the heel.
const BALL: f32 = 0.115;
const HEEL: f32 = 0.05;
/// How far the pelvis is lower than at rest, and how much it bobs.
const PELVIS_DROP: f32 = 0.045;
const PELVIS_BOB: f32 = 0.016;

/// The channels that move a figure whose nodes begin at `root`: its way, and its joints.
pub(super) fn channels(figure: &Figure, root: NodeIdx, times: &[f32]) -> Vec<Channel> {
    let path = Path::new(&figure.route);
    let gait = Gait { stride: path.length() / (figure.cycle_count as f32 * figure.scale) };
    let lap = |time: f32| figure.lap_at(time);
    let cycle = |time: f32| lap(time) * figure.cycle_count as f32;
    let joint_channel = |joint: usize, rotation: &dyn Fn(f32) -> Quat| {
        rotation_channel(joint_node(root, joint), times, |time| rotation(cycle(time)))
    };

    let pelvis = |time: f32| rest(PELVIS) - Vec3::Y * pelvis_drop(cycle(time));
    let mut channels = vec![
        translation_channel(root, times, |time| path.position(lap(time))),
        rotation_channel(root, times, |time| path.heading(lap(time))),
        translation_channel(joint_node(root, PELVIS), times, pelvis),
        joint_channel(SPINE, &|cycle| pitch(-0.04) * Quat::from_rotation_y(-0.05 * swing(cycle))),
        joint_channel(CHEST, &|cycle| Quat::from_rotation_y(-0.10 * swing(cycle))),
        joint_channel(HEAD, &|cycle| pitch(0.04) * Quat::from_rotation_y(0.15 * swing(cycle))),
    ];
    for side in [0, 1] {
        // The right leg is half a cycle behind, and arms swing against legs.
        let half = 0.5 * side as f32;
        let outward = 0.06 * (1.0 - 2.0 * side as f32);
        channels.extend([
            joint_channel(ARM[side], &|cycle| {
                Quat::from_rotation_z(outward) * pitch(0.03 - 0.36 * swing(cycle + half))
            }),
            joint_channel(FOREARM[side], &|cycle| pitch(0.28 - 0.14 * swing(cycle + half))),
            joint_channel(THIGH[side], &|cycle| pitch(gait.leg(cycle, half).hip)),
            joint_channel(SHIN[side], &|cycle| pitch(-gait.leg(cycle, half).knee)),
            joint_channel(FOOT[side], &|cycle| pitch(gait.leg(cycle, half).ankle)),
        ]);
    }
    channels
}

fn pitch(angle: f32) -> Quat {
    Quat::from_rotation_x(-angle)
}

/// How far forward the left leg is in the cycle: 1 when its heel comes down, then -1.
fn swing(cycle: f32) -> f32 {
    (TAU * cycle).cos()
}

/// The pelvis is lowest when both feet stand, twice a cycle.
fn pelvis_drop(cycle: f32) -> f32 {
    PELVIS_DROP + PELVIS_BOB * (2.0 * TAU * (cycle - 0.05)).cos()
}

/// Angles of the joints of one leg.
#[derive(Clone, Copy, Debug)]
struct Leg {
    hip: f32,
    knee: f32,
    ankle: f32,
}

/// A way of walking.
#[derive(Clone, Copy, Debug)]
struct Gait {
    /// Distance a cycle, in figure space.
    stride: f32,
}

impl Gait {
    /// The leg that is `offset` cycles behind, in the given cycle of the walk.
    fn leg(self, cycle: f32, offset: f32) -> Leg {
        let (ankle, foot_pitch) = self.foot((cycle + offset).rem_euclid(1.0));
        let hip = Vec2::new(0.0, rest(THIGH[0]).y - pelvis_drop(cycle));
        let thigh_length = rest(THIGH[0]).y - rest(SHIN[0]).y;
        let shin_length = rest(SHIN[0]).y - rest(FOOT[0]).y;

        // The triangle of thigh, shin and the line from hip to ankle.
        let line = ankle - hip;
        let length = line.length().min(0.9995 * (thigh_length + shin_length));
        let angle = |opposite: f32, a: f32, b: f32| {
            ((a * a + b * b - opposite * opposite) / (2.0 * a * b)).clamp(-1.0, 1.0).acos()
        };
        let hip_pitch = line.x.atan2(-line.y) + angle(shin_length, thigh_length, length);
        let knee = PI - angle(length, thigh_length, shin_length);
        Leg { hip: hip_pitch, knee, ankle: foot_pitch - (hip_pitch - knee) }
    }

    /// Where the ankle is, forward and up, and the pitch of its foot, at a place in its cycle
    /// from 0 to 1.
    fn foot(self, cycle: f32) -> (Vec2, f32) {
        if cycle < STANCE {
            return self.standing_foot(cycle);
        }
        let (start, start_pitch) = self.standing_foot(STANCE);
        let (end, end_pitch) = self.standing_foot(0.0);
        let share = (cycle - STANCE) / (1.0 - STANCE);
        let smooth = share * share * (3.0 - 2.0 * share);
        let lift = Vec2::Y * 0.045 * (PI * share).sin();
        (start.lerp(end, smooth) + lift, start_pitch.lerp(end_pitch, smooth))
    }

    fn standing_foot(self, cycle: f32) -> (Vec2, f32) {
        let height = rest(FOOT[0]).y;
        let flat = Vec2::new(self.stride * (0.5 * STANCE - cycle), height);
        if cycle < 0.1 {
            // Roll over the heel.
            let pitch = STRIKE_PITCH * (1.0 - cycle / 0.1);
            return (flat + rolled(Vec2::new(-HEEL, -height), pitch), pitch);
        }
        // Roll over the ball.
        let pitch = TOE_OFF_PITCH * ((cycle - HEEL_OFF) / (STANCE - HEEL_OFF)).max(0.0).powi(2);
        (flat + rolled(Vec2::new(BALL, -height), pitch), pitch)
    }
}

/// How far the ankle moves when the foot turns by `pitch` around a point at `pivot` from it.
fn rolled(pivot: Vec2, pitch: f32) -> Vec2 {
    pivot - Vec2::from_angle(pitch).rotate(pivot)
}
