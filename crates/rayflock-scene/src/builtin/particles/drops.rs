//! The paths of the drops, in closed form.
//!
//! A drop lives a whole number of times in a round of the animation: it is thrown, falls, bounces
//! once, slides on and shrinks away. At any time all are somewhere on their way.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec3};
use rayflock_geom::{Mesh, Sphere};
use rayon::prelude::*;

use super::{DROPS, DURATION, FRAME_RATE, JETS};
use crate::builtin::random::Random;
use crate::{AnimatedMesh, MaterialIdx, MotionKind, PrimMaterials, SurfaceAttributes, SurfaceMesh};

/// Lives in a round of the animation.
const LIVES: f32 = 4.0;
const LIFETIME: f32 = DURATION / LIVES;
/// Downward acceleration, in scene units per square second.
const GRAVITY: f32 = 4.5;
/// The part of the upward and of the sideways speed that a bounce keeps.
const BOUNCE: f32 = 0.35;
const SLIDE: f32 = 0.5;
/// How far jets are from the middle.
const RING: f32 = 1.6;

/// One drop.
#[derive(Clone, Copy, Debug)]
struct Drop {
    /// Its age at time 0, less than a life.
    age: f32,
    start: Vec3,
    velocity: Vec3,
    radius: f32,
    jet: usize,
}

/// All drops.
#[derive(Debug)]
pub(super) struct Drops {
    drops: Vec<Drop>,
    /// Without drops, to be shared by all frames.
    empty: Mesh,
    attributes: Arc<SurfaceAttributes>,
}

impl Drops {
    /// The drops of all jets.
    pub(super) fn new() -> Self {
        let mut random = Random::new(5);
        let drops: Vec<Drop> = (0..DROPS).map(|idx| Drop::new(idx % JETS, &mut random)).collect();
        let materials = drops.iter().map(|drop| MaterialIdx(drop.jet as u32)).collect();
        let materials = PrimMaterials::PerPrim(materials);
        let attributes = Arc::new(SurfaceAttributes { materials, ..SurfaceAttributes::default() });
        Self { drops, empty: Mesh::default(), attributes }
    }
}

impl AnimatedMesh for Drops {
    fn time_range(&self) -> (f64, f64) {
        (0.0, f64::from(DURATION - 1.0 / FRAME_RATE))
    }

    fn motion(&self) -> MotionKind {
        MotionKind::Deforming
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        let time = time as f32;
        let spheres = self.drops.par_iter().map(|drop| drop.at(time)).collect();
        let mesh = Arc::new(self.empty.clone().with_spheres(spheres));
        let attributes = Arc::clone(&self.attributes);
        Ok(SurfaceMesh { mesh, normals: Arc::default(), attributes })
    }
}

impl Drop {
    fn new(jet: usize, random: &mut Random) -> Self {
        let around = Quat::from_rotation_y(TAU * jet as f32 / JETS as f32);
        let radius = random.between(0.009, 0.021);
        let start = Vec3::new(RING, radius, 0.0) + random.in_disc(0.05);
        // Inward, aside and upward, and the wider the less upward.
        let spread = random.in_disc(0.42);
        let velocity = Vec3::new(-1.15, 0.0, 0.75)
            + spread
            + Vec3::Y * random.between(4.1, 4.7) * (1.0 - 0.5 * spread.length_squared());
        Self {
            age: LIFETIME * random.unit(),
            start: around * start,
            velocity: around * velocity,
            radius,
            jet,
        }
    }

    /// The drop at `time` in seconds.
    fn at(&self, time: f32) -> Sphere {
        let age = (time + self.age).rem_euclid(LIFETIME);
        // It starts and lands with its centre a radius above the floor.
        let landing = 2.0 * self.velocity.y / GRAVITY;
        let sideways = self.velocity.with_y(0.0);
        let center = if age < landing {
            self.start + sideways * age + Vec3::Y * height(self.velocity.y, age)
        } else {
            let (since, speed) = (age - landing, BOUNCE * self.velocity.y);
            let rise = height(speed, since).max(0.0);
            self.start + sideways * (landing + SLIDE * since) + Vec3::Y * rise
        };
        Sphere::new(center, self.radius * size(age / LIFETIME))
    }
}

/// The height of a body thrown upward at `speed`, after some seconds.
fn height(speed: f32, seconds: f32) -> f32 {
    (speed - 0.5 * GRAVITY * seconds) * seconds
}

/// The part of its radius that a drop has after this share of its life, never nothing: it comes
/// and goes without a jump.
fn size(share: f32) -> f32 {
    (share / 0.02).min((1.0 - share) / 0.08).clamp(0.02, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drops_stay_above_the_floor_and_repeat() {
        let drops = Drops::new();
        let at = |time: f64| drops.at(time).unwrap().mesh;
        assert_eq!(at(0.0).spheres().len(), DROPS);
        for time in [0.0, 2.3, 9.9] {
            for (drop, again) in at(time).spheres().iter().zip(at(time + 10.0).spheres()) {
                assert!(drop.is_valid() && drop.center.y > 0.0, "{drop:?}");
                assert!(drop.center.y + 1e-6 >= drop.radius, "{drop:?}");
                assert!(drop.center.with_y(0.0).length() < 9.0, "{drop:?}");
                let turns = drop.radius.min(again.radius) < 1e-3;
                assert!(turns || again.center.abs_diff_eq(drop.center, 1e-3), "{drop:?} {again:?}");
            }
        }
    }

    #[test]
    fn frames_have_one_topology_and_every_drop_moves() {
        let drops = Drops::new();
        let [a, b] = [1.0, 1.0 + 1.0 / 24.0].map(|time| drops.at(time).unwrap().mesh);
        assert!(b.has_topology_of(&a));
        let resting = a.spheres().iter().zip(b.spheres()).filter(|(a, b)| a.center == b.center);
        assert_eq!(resting.count(), 0);
    }
}
