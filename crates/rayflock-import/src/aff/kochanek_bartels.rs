//! Kochanek-Bartels splines as channels: tension, continuity and bias become tangents, and for
//! rotations the controls of spherical quadrangles.
//!
//! With `before` and `after` the steps from the key before and to the key after, and `span` the
//! time between those two keys, the slopes at a key in units a second are
//!
//! ```text
//! in  = (1 - t) * ((1 - c) (1 + b) before + (1 + c) (1 - b) after) / span
//! out = (1 - t) * ((1 + c) (1 + b) before + (1 - c) (1 - b) after) / span
//! ```
//!
//! so that with `c = 0` the speed is continuous however the keys are spaced, and with all three 0
//! the spline is that of Catmull and Rom. The first and the last key have no slopes: the spline
//! begins at the second key and ends at the last but one, and rests before and after.
//!
//! For rotations, steps are rotation vectors (axis times angle) in the space of the key. Between
//! `q0` and `q1` with the step `d`, the quadrangle has the controls `q0 * R((out * seconds - d) / 2)`
//! and `q1 * R((d - in * seconds) / 2)`, where `R` makes a quaternion of a rotation vector.
//!
//! **Source.** D. Kochanek and R. Bartels, "Interpolating Splines with Local Tension, Continuity,
//! and Bias Control", SIGGRAPH 1984; D. Eberly, "Kochanek-Bartels Cubic Splines" and "Key Frame
//! Interpolation via Splines and Quaternions", Magic Software, 1999, for unevenly spaced keys and
//! for rotations; both as BART's animation code uses them.
//!
//! Signs of quaternions are those of BART's code, and of its pictures: a key gets the sign that is
//! nearer to the key before, but on the way to a key, the one after it still counts with the sign
//! that it is written with. So a turn may swing wide before it goes back; the camera of the robots
//! has them in the picture only so.
//!
//! **Departures.** Rotation axes are given unit length.
//!
//! **Invariants.** The keys are met exactly. A spline of equal keys is constant to the bit.

use glam::{DQuat, DVec3, Quat, Vec3};
use rayflock_scene::{Channel, ChannelValues, Interpolation, NodeIdx};

use super::keys::{Motion, SplineKey};

/// Sine of half the angle between two rotations that are taken for the same, as in BART's code.
const SAME_TURN: f64 = 1e-3;

/// The channels that move `node` like `motion`, in seconds from `start`.
pub(super) fn channels(motion: &Motion, node: NodeIdx, start: f64) -> Vec<Channel> {
    use Interpolation::{CubicSpline, Squad, Step};
    let mut channels = Vec::new();
    let mut add = |times: Vec<f32>, interpolation, values| {
        if !times.is_empty() {
            channels.push(Channel { node, times, interpolation, values });
        }
    };
    let translation = ChannelValues::Translation(tangents(&motion.translation));
    add(inner_times(&motion.translation, start), CubicSpline, translation);
    let rotation = ChannelValues::Rotation(controls(&motion.rotation));
    add(inner_times(&motion.rotation, start), Squad, rotation);
    let scale = ChannelValues::Scale(tangents(&motion.scale));
    add(inner_times(&motion.scale, start), CubicSpline, scale);
    let (times, shows) = visibility(&motion.visibility, start);
    add(times, Step, ChannelValues::Visibility(shows));
    channels
}

/// The times of all keys but the first and the last.
fn inner_times<T>(keys: &[SplineKey<T>], start: f64) -> Vec<f32> {
    keys.windows(3).map(|window| seconds(window[1].time, start)).collect()
}

/// The time since `start`, in the range of key times.
fn seconds(time: f64, start: f64) -> f32 {
    (time - start).clamp(f32::MIN.into(), f32::MAX.into()) as f32
}

/// Times and whether things are there from then on: they are before the first key.
fn visibility(keys: &[(f64, bool)], start: f64) -> (Vec<f32>, Vec<bool>) {
    let before = keys.first().map(|(time, _)| (time - 1.0, true));
    let keys = before.into_iter().chain(keys.iter().copied());
    keys.map(|(time, shows)| (seconds(time, start), shows)).unzip()
}

/// For each inner key the slope in, the value and the slope out.
fn tangents(keys: &[SplineKey<DVec3>]) -> Vec<Vec3> {
    let stored = |window: &[SplineKey<DVec3>]| {
        let (before, key, after) = (&window[0], &window[1], &window[2]);
        let steps = [key.value - before.value, after.value - key.value];
        let [slope_in, slope_out] = slopes(key, steps, after.time - before.time);
        [slope_in, key.value, slope_out].map(DVec3::as_vec3)
    };
    keys.windows(3).flat_map(stored).collect()
}

/// For each inner key the control of the way in, the value and the control of the way out.
fn controls(keys: &[SplineKey<DQuat>]) -> Vec<Quat> {
    let turns = signed_turns(keys);
    let stored = |idx: usize| {
        let [earlier, time, later] = [idx - 1, idx, idx + 1].map(|idx| keys[idx].time);
        let before = step(turns[idx - 1], turns[idx]);
        let [after, written_after] =
            [turns[idx + 1], keys[idx + 1].value].map(|next| step(turns[idx], next));
        let [slope_in, _] = slopes(&keys[idx], [before, written_after], later - earlier);
        let [_, slope_out] = slopes(&keys[idx], [before, after], later - earlier);
        let turned = |step: DVec3| turns[idx] * DQuat::from_scaled_axis(0.5 * step);
        let control_in = turned(before - slope_in * (time - earlier));
        let control_out = turned(slope_out * (later - time) - after);
        [control_in, turns[idx], control_out].map(DQuat::as_quat)
    };
    (1..keys.len().max(1) - 1).flat_map(stored).collect()
}

/// The rotations, from the third on with the sign that is nearer to the one before.
fn signed_turns(keys: &[SplineKey<DQuat>]) -> Vec<DQuat> {
    let mut turns: Vec<DQuat> = Vec::with_capacity(keys.len());
    for (idx, key) in keys.iter().enumerate() {
        let is_far = idx > 1 && turns[idx - 1].dot(key.value) < 0.0;
        turns.push(if is_far { -key.value } else { key.value });
    }
    turns
}

/// The rotation vector from one quaternion to another, in the space of the first; none where they
/// are as good as the same but for their signs.
fn step(from: DQuat, to: DQuat) -> DVec3 {
    let relative = from.conjugate() * to;
    let (axis, cosine) = (relative.xyz(), relative.w);
    let sine = axis.length();
    if sine < SAME_TURN { 2.0 * axis } else { axis * (2.0 * sine.atan2(cosine) / sine) }
}

/// The slopes into and out of a key between two steps that take `span` seconds together.
fn slopes<T>(key: &SplineKey<T>, [before, after]: [DVec3; 2], span: f64) -> [DVec3; 2] {
    if span <= 0.0 {
        return [DVec3::ZERO; 2];
    }
    let (looseness, bias) = (1.0 - key.tension, key.bias);
    let slope = |c: f64| {
        let sum = (1.0 - c) * (1.0 + bias) * before + (1.0 + c) * (1.0 - bias) * after;
        sum * (looseness / span)
    };
    [slope(key.continuity), slope(-key.continuity)]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Affine3A;
    use rayflock_scene::{Camera, Clip, Evaluator, LocalTransform, Node, Projection, Scene};

    use super::*;

    fn key<T>(time: f64, value: T) -> SplineKey<T> {
        SplineKey { time, value, tension: 0.0, continuity: 0.0, bias: 0.0 }
    }

    fn positions(keys: &[(f64, f64)]) -> Motion {
        let key = |&(time, x): &(f64, f64)| key(time, DVec3::new(x, -x, 0.0));
        Motion { translation: keys.iter().map(key).collect(), ..Motion::default() }
    }

    /// Turns about Y, in degrees.
    fn turns(keys: &[(f64, f64)]) -> Motion {
        let turn = |degrees: f64| DQuat::from_rotation_y(degrees.to_radians());
        let key = |&(time, degrees): &(f64, f64)| key(time, turn(degrees));
        Motion { rotation: keys.iter().map(key).collect(), ..Motion::default() }
    }

    /// Plays a motion on a node that carries a camera, from time 0 on.
    fn play(motion: &Motion) -> impl FnMut(f64) -> Affine3A + use<> {
        let node = Node {
            name: String::new(),
            parent: None,
            rest: LocalTransform::IDENTITY,
            rest_weights: Vec::new(),
        };
        let camera = Camera {
            name: String::new(),
            node: Some(NodeIdx(0)),
            node_from_camera: Affine3A::IDENTITY,
            projection: Projection::Orthographic { height: 1.0 },
        };
        let clip = Clip { name: String::new(), channels: channels(motion, NodeIdx(0), 0.0) };
        let scene = Scene {
            nodes: vec![node],
            cameras: vec![camera],
            clips: vec![clip],
            frame_count: Some(1),
            ..Scene::default()
        };
        let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
        move |time| evaluator.evaluate(time).unwrap().cameras[0]
    }

    fn x_of(motion: &Motion) -> impl FnMut(f64) -> f32 + use<> {
        let mut play = play(motion);
        move |time| play(time).translation.x
    }

    fn degrees_of(motion: &Motion) -> impl FnMut(f64) -> f32 + use<> {
        let mut play = play(motion);
        move |time| {
            let back = play(time).matrix3.z_axis;
            back.x.atan2(back.z).to_degrees()
        }
    }

    #[test]
    fn keys_are_met_exactly_and_the_ends_rest() {
        let keys = [(-1.0, 9.0), (0.0, 1.0), (0.25, 4.0), (2.0, -2.5), (3.0, 7.0)];
        let mut motion = positions(&keys);
        let mut x = x_of(&motion);
        assert_eq!([-9.0, 0.0, 0.25, 2.0, 2.5, 9.0].map(&mut x), [1.0, 1.0, 4.0, -2.5, -2.5, -2.5]);
        for key in &mut motion.translation {
            (key.tension, key.continuity, key.bias) = (0.3, -0.7, 0.5);
        }
        assert_eq!([0.0, 0.25, 2.0].map(x_of(&motion)), [1.0, 4.0, -2.5]);

        let keys = [(-1.0, 0.0), (0.0, 40.0), (0.25, 100.0), (2.0, -30.0), (3.0, 0.0)];
        let found = [-9.0, 0.0, 0.25, 2.0, 9.0].map(degrees_of(&turns(&keys)));
        for (found, expected) in found.into_iter().zip([40.0, 40.0, 100.0, -30.0, -30.0]) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn without_tension_continuity_and_bias_it_is_catmull_rom() {
        let [p0, p1, p2, p3] = [3.0, 1.0, 4.0, -2.0];
        let keys = [(-1.0, p0), (0.0, p1), (1.0, p2), (2.0, p3)];
        let mut x = x_of(&positions(&keys));
        for time in [0.2, 0.5, 0.9_f64] {
            let (s, s2, s3) = (time, time * time, time * time * time);
            let expected = 0.5
                * (2.0 * p1
                    + (p2 - p0) * s
                    + (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3) * s2
                    + (3.0 * p1 - p0 - 3.0 * p2 + p3) * s3);
            assert!((f64::from(x(time)) - expected).abs() < 1e-5);
        }
    }

    #[test]
    fn speed_is_continuous_however_keys_are_spaced() {
        let keys = [(-0.5, 0.0), (0.0, 10.0), (1.0, 50.0), (1.5, 60.0), (4.0, 20.0), (5.0, 0.0)];
        let mut x = x_of(&positions(&keys));
        let mut degrees = degrees_of(&turns(&keys));
        for (idx, key) in [(2, 1.0), (3, 1.5)] {
            let chord = (keys[idx + 1].1 - keys[idx - 1].1) / (keys[idx + 1].0 - keys[idx - 1].0);
            let speed = |at: &mut dyn FnMut(f64) -> f32, from: f64| {
                f64::from(at(from + 2e-3) - at(from)) / 2e-3
            };
            for from in [key - 2e-3, key] {
                assert!((speed(&mut x, from) - chord).abs() < 0.7, "key {idx}");
                assert!((speed(&mut degrees, from) - chord).abs() < 0.7, "key {idx}");
            }
        }
    }

    #[test]
    fn tension_continuity_and_bias_shape_the_tangents() {
        // Steps of 2 and 6 about the middle key, one second each.
        let slopes_of = |tension, continuity, bias| {
            let key = SplineKey { time: 1.0, value: DVec3::ZERO, tension, continuity, bias };
            slopes(&key, [2.0 * DVec3::X, 6.0 * DVec3::X], 2.0).map(|slope| slope.x)
        };
        assert_eq!(slopes_of(0.0, 0.0, 0.0), [4.0, 4.0]);
        assert_eq!(slopes_of(1.0, 0.0, 0.0), [0.0, 0.0]);
        assert_eq!(slopes_of(0.0, -1.0, 0.0), [2.0, 6.0]);
        assert_eq!(slopes_of(0.0, 1.0, 0.0), [6.0, 2.0]);
        assert_eq!(slopes_of(0.0, 0.0, 1.0), [2.0, 2.0]);
        assert_eq!(slopes_of(0.0, 0.0, -1.0), [6.0, 6.0]);
    }

    #[test]
    fn the_sign_of_the_key_after_the_next_counts_as_it_is_written() {
        // 200 degrees and -160 are one rotation, with quaternions of opposite signs: from 120
        // degrees they are 80 ahead, or 280 back. Halfway, the keys say 100 and the controls 95
        // (80 and 110), or 140 (80 and 200).
        for (third, halfway) in [(200.0, 97.5), (-160.0, 120.0)] {
            let keys = [(-1.0, 40.0), (0.0, 80.0), (1.0, 120.0), (2.0, third), (3.0, third)];
            let mut degrees = degrees_of(&turns(&keys));
            for (time, expected) in [(0.0, 80.0), (0.5, halfway), (1.0, 120.0)] {
                let found = degrees(time);
                assert!((found - expected).abs() < 1e-3, "{third}: {found} at {time}");
            }
        }
    }

    #[test]
    fn equal_keys_do_not_move() {
        let still = turns(&[(0.0, 33.0), (1.0, 33.0), (2.0, 33.0), (3.0, 33.0)]);
        let mut play = play(&still);
        let first = play(0.0);
        assert!([1.0, 1.3, 1.9, 2.5].iter().all(|&time| play(time) == first));
    }

    #[test]
    fn keys_at_one_time_jump() {
        let keys = [(0.0, 5.0), (0.0, 5.0), (0.0, 8.0), (1.0, 9.0), (1.0, 9.0), (1.0, 9.0)];
        let found = [-1.0, 0.0, 2.0].map(x_of(&positions(&keys)));
        assert_eq!(found, [5.0, 8.0, 9.0]);
    }
}
