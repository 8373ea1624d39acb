//! Drops that leave the liquid and fall back into it, again and again.
//!
//! A jet throws a drop at regular times, a whole number of times in a round of the animation.
//! The drop starts and ends below the surface, where it has no size, and flies as a body does
//! without air.

use glam::{Vec2, Vec3};
use rayflock_geom::Sphere;

use super::{DURATION, TANK};
use crate::builtin::random::Random;

/// Number of jets.
const JETS: usize = 22;
/// Downward acceleration, in scene units per square second: slow motion.
const GRAVITY: f32 = 2.2;
/// The height at which drops start and end: below every wave.
const SOURCE: f32 = 0.2;
/// Upward speeds; the fastest drop stays below the rim.
const SPEEDS: (f32, f32) = (1.45, 1.95);
/// Sizes of drops, from centre to surface.
const RADII: (f32, f32) = (0.035, 0.085);
/// How near drops come to the panes.
const MARGIN: f32 = 0.12;

/// Throws a drop each so many seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    period: f32,
    /// When the first drop starts, less than a period.
    first: f32,
    /// Where drops start and end, seen from above.
    from: Vec2,
    to: Vec2,
    /// Upward, at the start.
    speed: f32,
    radius: f32,
}

/// The jets, spread over the tank.
pub(super) fn jets() -> Vec<Jet> {
    let mut random = Random::new(11);
    let room = Vec2::new(TANK.x, TANK.z) - MARGIN;
    let place = |random: &mut Random| {
        room * Vec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0))
    };
    let mut jet = |jet_idx: usize| {
        let period = DURATION / [4.0, 5.0][jet_idx % 2];
        let from = place(&mut random);
        let to = from.lerp(place(&mut random), 0.25);
        Jet {
            period,
            first: period * random.unit(),
            from,
            to,
            speed: random.between(SPEEDS.0, SPEEDS.1),
            radius: random.between(RADII.0, RADII.1),
        }
    };
    (0..JETS).map(&mut jet).collect()
}

impl Jet {
    /// Seconds from the start of a drop to its end.
    fn flight_seconds(&self) -> f32 {
        2.0 * self.speed / GRAVITY
    }

    /// The drop in flight at `time`, if there is one.
    pub(super) fn drop_at(&self, time: f32) -> Option<Sphere> {
        let elapsed = (time - self.first).rem_euclid(self.period);
        let share = elapsed / self.flight_seconds();
        if share >= 1.0 {
            return None;
        }
        let height = SOURCE + self.speed * elapsed - 0.5 * GRAVITY * elapsed * elapsed;
        let place = self.from.lerp(self.to, share);
        // Grows at the start and shrinks at the end, both out of sight.
        let size = (8.0 * share.min(1.0 - share)).min(1.0);
        let center = Vec3::new(place.x, height, place.y);
        (size > 0.0).then(|| Sphere::new(center, size * self.radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drops_fly_one_at_a_time_below_the_rim_and_repeat() {
        for jet in jets() {
            assert!(jet.flight_seconds() < jet.period, "{jet:?}");
            for frame in 0..240 {
                let time = frame as f32 / 24.0;
                let Some(drop) = jet.drop_at(time) else { continue };
                assert!(drop.center.y + drop.radius < TANK.y, "{drop:?}");
                assert!(drop.center.x.abs() + drop.radius < TANK.x, "{drop:?}");
                assert!(drop.center.z.abs() + drop.radius < TANK.z, "{drop:?}");
                let again = jet.drop_at(time + DURATION).map_or(Vec3::NAN, |drop| drop.center);
                let is_turn = drop.radius < 1e-3;
                assert!(is_turn || again.abs_diff_eq(drop.center, 1e-3), "{drop:?} {again}");
            }
        }
    }
}
