//! Where a sensor is, at each time.

use glam::{Affine3A, Mat3, Quat, Vec3};
use rayflock_scene::SceneFrame;

use super::SensorError;
use super::error::ensure_value;

/// A place and an attitude in the world. The sensor looks along its -Z, with +Y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where the sensor's origin is, in world space.
    pub position: Vec3,
    /// Turns the sensor's axes to those of the world; of unit length.
    pub rotation: Quat,
}

impl Pose {
    /// The sensor's axes are those of the world: it looks along -Z.
    pub const fn at(position: Vec3) -> Self {
        Self { position, rotation: Quat::IDENTITY }
    }

    /// Looks from `position` towards `target`, with +Y of the world as nearly up as can be; straight
    /// up or down as if tilted from along -Z. Without a direction to look in, as [`Pose::at`].
    pub fn looking_at(position: Vec3, target: Vec3) -> Self {
        let back = (position - target).normalize_or(Vec3::Z);
        let right = Vec3::Y.cross(back);
        let right = if right.length() < 1e-4 { Vec3::X } else { right.normalize() };
        let axes = Mat3::from_cols(right, back.cross(right), back);
        Self { position, rotation: Quat::from_mat3(&axes).normalize() }
    }

    /// The pose of a `world_from_sensor` that neither scales nor shears.
    pub fn from_transform(world_from_sensor: &Affine3A) -> Self {
        let rotation = Quat::from_mat3a(&world_from_sensor.matrix3).normalize();
        Self { position: world_from_sensor.translation.into(), rotation }
    }

    /// `world_from_sensor`.
    pub fn transform(&self) -> Affine3A {
        Affine3A::from_rotation_translation(self.rotation, self.position)
    }

    fn check(&self) -> Result<(), SensorError> {
        let Self { position, rotation } = self;
        ensure_value(position.is_finite(), "sensor's position", position, "finite coordinates")?;
        let is_right = rotation.is_finite() && rotation.is_normalized();
        ensure_value(is_right, "sensor's rotation", rotation, "a quaternion of unit length")
    }
}

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseKey {
    /// In seconds of the scene.
    pub time: f64,
    /// The pose.
    pub pose: Pose,
}

/// Where a sensor is, at each time.
#[derive(Clone, Debug, PartialEq)]
pub enum PosePath {
    /// At rest.
    Fixed(Pose),
    /// On a camera of the scene, by its position in
    /// [`Scene::cameras`](rayflock_scene::Scene::cameras).
    Camera(usize),
    /// Along poses, sorted by time: straight from place to place, and on the shortest turn; before
    /// the first and after the last at rest.
    Keyed(Vec<PoseKey>),
}

impl PosePath {
    pub(super) fn check(&self) -> Result<(), SensorError> {
        match self {
            Self::Fixed(pose) => pose.check(),
            Self::Camera(_) => Ok(()),
            Self::Keyed(keys) => {
                ensure_value(!keys.is_empty(), "number of poses", keys.len(), "at least 1")?;
                keys.iter().try_for_each(|key| {
                    let is_right = key.time.is_finite();
                    ensure_value(is_right, "time of a pose", key.time, "a finite time")?;
                    key.pose.check()
                })?;
                keys.windows(2).try_for_each(|pair| {
                    let [before, time] = [pair[0].time, pair[1].time];
                    let expected = format!("more than {before}, that of the pose before");
                    ensure_value(before < time, "time of a pose", time, expected)
                })
            }
        }
    }

    /// `world_from_sensor` at the time of `frame`.
    ///
    /// # Errors
    /// [`SensorError::Camera`] where the frame does not have the camera.
    pub fn at(&self, frame: &SceneFrame) -> Result<Affine3A, SensorError> {
        match self {
            Self::Fixed(pose) => Ok(pose.transform()),
            Self::Camera(camera_idx) => {
                let (found, count) = (*camera_idx, frame.cameras.len());
                frame.cameras.get(found).copied().ok_or(SensorError::Camera { found, count })
            }
            Self::Keyed(keys) => Ok(between(keys, frame.time).transform()),
        }
    }
}

/// The pose at a time; `keys` are sorted and at least one.
fn between(keys: &[PoseKey], time: f64) -> Pose {
    let after = keys.partition_point(|key| key.time <= time);
    match (after.checked_sub(1).map(|before| &keys[before]), keys.get(after)) {
        (Some(before), Some(after)) => {
            let share = ((time - before.time) / (after.time - before.time)) as f32;
            let (from, to) = (&before.pose, &after.pose);
            Pose {
                position: from.position.lerp(to.position, share),
                rotation: from.rotation.slerp(to.rotation, share).normalize(),
            }
        }
        (Some(only), None) | (None, Some(only)) => only.pose,
        (None, None) => Pose::at(Vec3::ZERO),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_looks_where_it_should_with_up_up() {
        for (target, up) in [
            (Vec3::new(3.0, 0.0, -1.0), Vec3::Y),
            (Vec3::new(0.0, 9.0, 0.0), Vec3::Z),
            (Vec3::new(0.0, -9.0, 0.0), Vec3::NEG_Z),
        ] {
            let position = Vec3::new(0.0, 2.0, 0.0);
            let pose = Pose::looking_at(position, target);
            let ahead = pose.transform().transform_vector3(Vec3::NEG_Z);
            assert!((ahead - (target - position).normalize()).length() < 1e-6, "{ahead}");
            assert!(pose.transform().transform_vector3(Vec3::Y).dot(up) > 0.5, "{target}");
            pose.check().unwrap();
        }
        let nowhere = Pose::looking_at(Vec3::ONE, Vec3::ONE);
        assert!(nowhere.rotation.abs_diff_eq(Quat::IDENTITY, 1e-6));
    }

    #[test]
    fn keys_are_met_and_joined() {
        let key = |time, x: f32| PoseKey {
            time,
            pose: Pose { position: Vec3::X * x, rotation: Quat::from_rotation_y(0.1 * x) },
        };
        let keys = [key(1.0, 0.0), key(2.0, 4.0), key(4.0, 6.0)];
        for (time, x) in [(0.0, 0.0), (1.0, 0.0), (1.5, 2.0), (2.0, 4.0), (3.0, 5.0), (9.0, 6.0)] {
            let pose = between(&keys, time);
            assert!((pose.position.x - x).abs() < 1e-5, "{time}: {pose:?}");
            assert!(pose.rotation.abs_diff_eq(Quat::from_rotation_y(0.1 * x), 1e-5), "{time}");
        }
    }

    #[test]
    fn paths_that_cannot_be_are_told_what_is_wrong() {
        let key = |time| PoseKey { time, pose: Pose::at(Vec3::ZERO) };
        for (path, expected) in [
            (PosePath::Keyed(vec![]), "the number of poses is 0, expected at least 1"),
            (
                PosePath::Keyed(vec![key(1.0), key(1.0)]),
                "the time of a pose is 1, expected more than 1",
            ),
            (PosePath::Keyed(vec![key(f64::NAN)]), "the time of a pose is NaN"),
            (PosePath::Fixed(Pose::at(Vec3::NAN)), "the sensor's position is [NaN"),
            (
                PosePath::Fixed(Pose {
                    position: Vec3::ZERO,
                    rotation: Quat::from_xyzw(1.0, 1.0, 0.0, 0.0),
                }),
                "a quaternion of unit length",
            ),
        ] {
            let message = path.check().unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
