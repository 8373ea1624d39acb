//! How one body flies, bounces and comes to rest, as a function of time.
//!
//! ```text
//!  start   .-.
//!     \  .'   '.
//!      o'       \      .-.
//!                \   .'   '.    .-.
//!  ---------------\-'-------\--'---\---   floor, height 0
//!             first contact
//! ```
//!
//! From its launch the body flies freely to the floor, then hops [`HOPS`] times, each hop with a
//! part of the speed of the one before. It spins around one axis: evenly in the air, then slower
//! and slower, until it has turned by `turn` when it lies still. All in closed form, so that any
//! time can be asked for.

use glam::{Quat, Vec3};

use super::GRAVITY;

/// How often a body leaves the floor again.
const HOPS: u32 = 3;
/// The part of the upward and of the sideways speed that a hop keeps.
const BOUNCE: f32 = 0.33;
const SLIDE: f32 = 0.55;

/// A body's flight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
    /// When it is let go, in seconds.
    pub(super) launch: f32,
    /// Where it is until then.
    pub(super) start: Vec3,
    /// Its velocity then.
    pub(super) velocity: Vec3,
    /// The axis of its spin, of unit length.
    pub(super) axis: Vec3,
    /// How far it has turned when it lies still, in radians.
    pub(super) turn: f32,
}

impl Flight {
    /// Seconds from the launch to the first contact, and the downward speed then.
    fn first_contact(&self) -> (f32, f32) {
        let up = self.velocity.y;
        let speed = (up * up + 2.0 * GRAVITY * self.start.y).sqrt();
        ((up + speed) / GRAVITY, speed)
    }

    /// Seconds that hop `hop`, from 1, takes after a contact at `speed`.
    fn hop_seconds(speed: f32, hop: u32) -> f32 {
        2.0 * speed * BOUNCE.powi(hop as i32) / GRAVITY
    }

    /// When the body lies still, in seconds.
    pub(super) fn end(&self) -> f32 {
        let (contact, speed) = self.first_contact();
        let hops: f32 = (1..=HOPS).map(|hop| Self::hop_seconds(speed, hop)).sum();
        self.launch + contact + hops
    }

    /// The place of the body at `time`, were it a point.
    pub(super) fn position(&self, time: f32) -> Vec3 {
        let elapsed = time - self.launch;
        if elapsed <= 0.0 {
            return self.start;
        }
        let (contact, speed) = self.first_contact();
        if elapsed < contact {
            return self.start + self.velocity * elapsed - fall(elapsed);
        }

        // Hop on until the hop in which `time` lies.
        let sideways = self.velocity.with_y(0.0);
        let mut position = (self.start + self.velocity * contact).with_y(0.0);
        let mut remaining = elapsed - contact;
        for hop in 1..=HOPS {
            let seconds = Self::hop_seconds(speed, hop);
            let velocity =
                sideways * SLIDE.powi(hop as i32) + Vec3::Y * speed * BOUNCE.powi(hop as i32);
            if remaining < seconds {
                return position + velocity * remaining - fall(remaining);
            }
            position += (velocity * seconds).with_y(0.0);
            remaining -= seconds;
        }
        position
    }

    /// How the body is turned at `time`, relative to the start.
    pub(super) fn rotation(&self, time: f32) -> Quat {
        let elapsed = (time - self.launch).max(0.0);
        let (contact, _) = self.first_contact();
        let slowing = self.end() - self.launch - contact;
        // At the rate of the air for the whole fall and half the hopping, `turn` is reached.
        let rate = self.turn / (contact + 0.5 * slowing);
        let slowed = (elapsed - contact).clamp(0.0, slowing);
        let turned = elapsed.min(contact) + slowed - 0.5 * slowed * slowed / slowing;
        Quat::from_axis_angle(self.axis, rate * turned)
    }
}

fn fall(elapsed: f32) -> Vec3 {
    Vec3::Y * (0.5 * GRAVITY * elapsed * elapsed)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLIGHT: Flight = Flight {
        launch: 1.0,
        start: Vec3::new(0.0, 2.0, 0.0),
        velocity: Vec3::new(1.0, 1.5, -0.5),
        axis: Vec3::X,
        turn: 9.0,
    };

    #[test]
    fn it_starts_at_rest_and_ends_at_rest() {
        assert_eq!(FLIGHT.position(0.5), FLIGHT.start);
        assert_eq!(FLIGHT.rotation(1.0), Quat::IDENTITY);
        let end = FLIGHT.end();
        assert_eq!(FLIGHT.position(end + 0.1), FLIGHT.position(end + 5.0));
        assert_eq!(FLIGHT.position(end + 0.1).y, 0.0);
        let last = Quat::from_axis_angle(Vec3::X, 9.0);
        assert!(FLIGHT.rotation(end).angle_between(last) < 1e-3);
    }

    #[test]
    fn it_moves_without_a_jump() {
        let step = 1e-3;
        let mut time = 0.9;
        while time < FLIGHT.end() + 0.1 {
            let moved = FLIGHT.position(time).distance(FLIGHT.position(time + step));
            assert!(moved < 5.0 * step, "{moved} at {time}");
            time += step;
        }
    }
}
