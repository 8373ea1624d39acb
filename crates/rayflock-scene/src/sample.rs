//! Values of channels between their keys.
//!
//! Before the first key a channel has the value of the first, after the last that of the last.
//!
//! **Source.** glTF 2.0 specification, appendix C (Khronos Group, 2021): step, linear, spherical
//! linear along the shorter arc, and cubic Hermite interpolation whose stored tangents are scaled
//! by the seconds between the keys; rotations are normalised. Squad: K. Shoemake, "Quaternion
//! calculus and fast animation", SIGGRAPH course notes, 1987.
//!
//! **Departures.** Polynomials are written around the difference of two keys, so that between
//! equal keys the value is exactly theirs and nothing seems to move.
//!
//! **Cost.** A binary search a channel.

use std::ops::{Add, Mul, Sub};

use glam::{Quat, Vec3};

use crate::Interpolation;

/// Sine of the angle between quaternions below which an arc is taken for a straight line; its
/// length is wrong by less than the square of this.
const SLERP_LIMIT: f32 = 1e-3;

/// Where a time lies among the keys of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KeySpan {
    /// The key at or before the time.
    before: usize,
    /// The key after it; the same one before the first and after the last key.
    after: usize,
    /// Time between the two.
    seconds: f32,
    /// How far the time is from one to the other, from 0 to 1.
    share: f32,
}

impl KeySpan {
    /// Where `time` lies among `times`, which are not empty and never decrease. Of keys at the
    /// same time the last counts.
    pub(crate) fn locate(times: &[f32], time: f32) -> Self {
        let last = times.len() - 1;
        let key_count = times.partition_point(|&key| key <= time);
        let at_key = |key| Self { before: key, after: key, seconds: 0.0, share: 0.0 };
        if key_count == 0 {
            return at_key(0);
        }
        if key_count > last {
            return at_key(last);
        }
        let (before, after) = (key_count - 1, key_count);
        let seconds = times[after] - times[before];
        Self { before, after, seconds, share: (time - times[before]) / seconds }
    }

    /// The key at or before the time, or else the first.
    pub(crate) fn key(&self) -> usize {
        self.before
    }

    /// The value in the span, where `stored(i)` is value `i` of the channel: one value a key, or
    /// three as [`Interpolation`] says.
    pub(crate) fn sample<T: KeyValue>(
        &self,
        interpolation: Interpolation,
        stored: impl Fn(usize) -> T,
    ) -> T {
        let (before, after) = (self.before, self.after);
        let value = match interpolation {
            Interpolation::Step => stored(before),
            Interpolation::Linear => stored(before).towards(stored(after), self.share),
            Interpolation::CubicSpline => {
                let (v0, v1) = (stored(3 * before + 1), stored(3 * after + 1));
                let (out_tangent, in_tangent) = (stored(3 * before + 2), stored(3 * after));
                self.hermite(v0, out_tangent, v1, in_tangent)
            }
            Interpolation::Squad => {
                let (v0, v1) = (stored(3 * before + 1), stored(3 * after + 1));
                let (out_control, in_control) = (stored(3 * before + 2), stored(3 * after));
                let s = self.share;
                v0.along(v1, s).along(out_control.along(in_control, s), 2.0 * s * (1.0 - s))
            }
        };
        value.made_valid()
    }

    /// The cubic from `v0` to `v1` with these slopes in units a second.
    fn hermite<T: KeyValue>(&self, v0: T, slope0: T, v1: T, slope1: T) -> T {
        let (s, s2) = (self.share, self.share * self.share);
        let s3 = s2 * s;
        let slopes = slope0 * (s3 - 2.0 * s2 + s) + slope1 * (s3 - s2);
        v0 + (v1 - v0) * (3.0 * s2 - 2.0 * s3) + slopes * self.seconds
    }
}

/// What a channel can hold keys of.
pub(crate) trait KeyValue:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
    /// The value `share` of the way to `other`.
    fn towards(self, other: Self, share: f32) -> Self {
        self + (other - self) * share
    }

    /// The value `share` of the way to `other` as it is stored: rotations may take the longer arc.
    fn along(self, other: Self, share: f32) -> Self {
        self + (other - self) * share
    }

    /// The value as it can be used.
    fn made_valid(self) -> Self {
        self
    }
}

impl KeyValue for f32 {}

impl KeyValue for Vec3 {}

impl KeyValue for Quat {
    fn towards(self, other: Self, share: f32) -> Self {
        let valid = (self.made_valid(), other.made_valid());
        if valid.0 == valid.1 { valid.0 } else { valid.0.slerp(valid.1, share) }
    }

    /// Both have unit length, or nearly. Signs stay as they are, so that the four values of a
    /// quadrangle stay on one side.
    fn along(self, other: Self, share: f32) -> Self {
        let (apart, together) = ((other - self).length(), (other + self).length());
        let angle = 2.0 * apart.atan2(together);
        let sine = angle.sin();
        if sine < SLERP_LIMIT {
            // Too near for an arc: a straight line, or the same rotation with the other sign.
            return if apart < together { self + (other - self) * share } else { self };
        }
        let weight = |part: f32| (part * angle).sin() / sine;
        self * weight(1.0 - share) + other * weight(share)
    }

    /// The rotation with unit length; none where it has no length.
    fn made_valid(self) -> Self {
        let length = self.length();
        if length.is_normal() { self * length.recip() } else { Self::IDENTITY }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;

    fn sample<T: KeyValue>(
        interpolation: Interpolation,
        times: &[f32],
        values: &[T],
        time: f32,
    ) -> T {
        KeySpan::locate(times, time).sample(interpolation, |i| values[i])
    }

    #[test]
    fn step_keeps_the_value_until_the_next_key() {
        let (times, values) = ([1.0, 2.0, 4.0], [10.0, 20.0, 40.0]);
        let at = |time| sample(Interpolation::Step, &times, &values, time);
        assert_eq!(
            [0.0, 1.0, 1.999, 2.0, 3.9, 4.0, 9.0].map(at),
            [10.0, 10.0, 10.0, 20.0, 20.0, 40.0, 40.0]
        );
    }

    #[test]
    fn linear_goes_straight_and_rests_outside() {
        let (times, values) = ([1.0, 3.0], [Vec3::ZERO, Vec3::new(2.0, 4.0, -2.0)]);
        let at = |time| sample(Interpolation::Linear, &times, &values, time);
        assert_eq!(at(1.5), Vec3::new(0.5, 1.0, -0.5));
        assert_eq!((at(0.0), at(7.0)), (values[0], values[1]));
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let (a, b) = (Quat::IDENTITY, Quat::from_rotation_z(FRAC_PI_2));
        for end in [b, -b] {
            let third = sample(Interpolation::Linear, &[0.0, 3.0], &[a, end], 1.0);
            let turned = third * Vec3::X;
            let expected = Vec3::new(0.75_f32.sqrt(), 0.5, 0.0);
            assert!(turned.distance(expected) < 1e-4, "{turned}");
        }
    }

    #[test]
    fn cubic_tangents_are_scaled_by_the_time_between_keys() {
        // Slope 1 a second leaving 0, slope 3 arriving at 8, two seconds apart; at the middle:
        // 0.5 * 8 + 2 * (0.125 * 1 - 0.125 * 3) = 3.5.
        let stored = [9.0, 0.0, 1.0, 3.0, 8.0, 9.0];
        let at = |time| sample(Interpolation::CubicSpline, &[1.0, 3.0], &stored, time);
        assert_eq!([0.0, 1.0, 2.0, 3.0, 5.0].map(at), [0.0, 0.0, 3.5, 8.0, 8.0]);
    }

    #[test]
    fn squad_passes_its_keys_exactly_and_leaves_them_along_its_controls() {
        let turn = |degrees: f32| Quat::from_rotation_z(degrees.to_radians());
        // The controls of a steady turn are its keys.
        let steady = [0.0, 0.0, 0.0, 100.0, 100.0, 100.0, 150.0, 150.0, 150.0].map(turn);
        let at =
            |stored: &[Quat], time| sample(Interpolation::Squad, &[0.0, 2.0, 3.0], stored, time);
        for (time, degrees) in [(0.5, 25.0), (1.0, 50.0), (2.5, 125.0)] {
            assert!(at(&steady, time).angle_between(turn(degrees)) < 1e-3);
        }
        let mut eased = steady;
        (eased[2], eased[3]) = (turn(-40.0), turn(180.0));
        for (key, time) in [0.0, 2.0, 3.0].into_iter().enumerate() {
            assert_eq!(at(&eased, time), at(&steady, time));
            assert!(at(&eased, time).angle_between(steady[3 * key + 1]) < 1e-6);
        }
        // At s = 1/4: 25 degrees along the keys, 15 along the controls, 3/8 of the way between.
        assert!(at(&eased, 0.5).angle_between(turn(25.0 - 0.375 * 10.0)) < 1e-3);
    }

    #[test]
    fn squad_takes_the_arc_that_is_stored() {
        let [a, b] = [Quat::IDENTITY, Quat::from_xyzw(0.0, 0.0, 1.0, -1e-3).normalize()];
        for (sign, side) in [(1.0, 1.0), (-1.0, -1.0)] {
            let end = b * sign;
            let middle = sample(Interpolation::Squad, &[0.0, 1.0], &[a, a, a, end, end, end], 0.5);
            assert!((middle * Vec3::X).distance(side * Vec3::Y) < 1e-2, "{middle}");
        }
    }

    #[test]
    fn cubic_rotations_are_normalised() {
        let zero = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let stored = [zero, Quat::IDENTITY, zero, zero, Quat::from_rotation_z(FRAC_PI_2), zero];
        let middle = sample(Interpolation::CubicSpline, &[0.0, 1.0], &stored, 0.5);
        assert!(middle.is_normalized());
        assert!(middle.angle_between(Quat::from_rotation_z(0.5 * FRAC_PI_2)) < 1e-3);
    }

    #[test]
    fn rotations_without_length_turn_nothing() {
        for odd in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::NAN] {
            assert_eq!(sample(Interpolation::Step, &[0.0], &[odd], 0.0), Quat::IDENTITY);
        }
    }

    #[test]
    fn of_keys_at_the_same_time_the_last_counts() {
        let (times, values) = ([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 5.0, 6.0]);
        let at = |time| sample(Interpolation::Linear, &times, &values, time);
        assert_eq!([0.5, 1.0, 1.5].map(at), [0.5, 5.0, 5.5]);
    }

    proptest! {
        #[test]
        fn between_equal_keys_nothing_moves(
            value in prop::array::uniform4(-1.0..1.0_f32), time in 0.0..3.0_f32,
        ) {
            let quat = Quat::from_array(value).normalize();
            let (vec, zero) = (Vec3::from_slice(&value), Vec3::ZERO);
            let times = [0.0, 0.7, 3.0];
            let first = sample(Interpolation::Linear, &times, &[quat; 3], 0.0);
            prop_assert_eq!(sample(Interpolation::Linear, &times, &[quat; 3], time), first);
            prop_assert_eq!(sample(Interpolation::Linear, &times, &[vec; 3], time), vec);
            let cubic = [zero, vec, zero, zero, vec, zero, zero, vec, zero];
            prop_assert_eq!(sample(Interpolation::CubicSpline, &times, &cubic, time), vec);
            let first = sample(Interpolation::Squad, &times, &[quat; 9], 0.0);
            prop_assert_eq!(sample(Interpolation::Squad, &times, &[quat; 9], time), first);
            prop_assert_eq!(sample(Interpolation::Squad, &times, &[vec; 9], time), vec);
        }

        #[test]
        fn a_cubic_with_the_slope_of_its_chord_is_the_chord(
            v0 in -5.0..5.0_f32, v1 in -5.0..5.0_f32, time in 0.0..2.0_f32,
        ) {
            let slope = (v1 - v0) / 2.0;
            let stored = [0.0, v0, slope, slope, v1, 0.0];
            let found = sample(Interpolation::CubicSpline, &[0.0, 2.0], &stored, time);
            prop_assert!((found - (v0 + slope * time)).abs() < 1e-5);
        }
    }
}
