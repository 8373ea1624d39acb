//! How a camera forms its picture.

use glam::{Vec2, Vec3};
use rayflock_scene::Projection;

use crate::View;

/// Angles of view that a plane can hold.
const FOV_RANGE: (f32, f32) = (1e-4, std::f32::consts::PI - 1e-2);

/// A projection as a function of film position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Rays from one point; the film is a plane of directions.
    Pinhole {
        /// The point, in world space.
        origin: Vec3,
        /// The directions; those of rays have unit length.
        film: FilmPlane,
    },
    /// Rays in one direction; the film is a plane of origins.
    Parallel {
        /// The direction, of unit length.
        direction: Vec3,
        /// The origins, in world space.
        film: FilmPlane,
    },
}

/// A vector in world space for each position on the film, in pixels from the top left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPlane {
    /// That of the corner.
    pub top_left: Vec3,
    /// What a pixel to the right adds.
    pub right: Vec3,
    /// What a pixel down adds.
    pub down: Vec3,
}

impl Lens {
    /// The projection of `view` for a film of `width` times `height` pixels.
    pub fn new(view: &View, width: usize, height: usize) -> Self {
        let world_from_camera = &view.world_from_camera;
        let axis = |v: Vec3| world_from_camera.transform_vector3(v);
        let eye = Vec3::from(world_from_camera.translation);
        let plane = |middle: Vec3, picture_height: f32| {
            let pixel = picture_height / height as f32;
            let (right, down) = (axis(Vec3::X) * pixel, axis(Vec3::NEG_Y) * pixel);
            let to_corner = right * (0.5 * width as f32) + down * (0.5 * height as f32);
            FilmPlane { top_left: middle - to_corner, right, down }
        };
        match view.projection {
            Projection::Perspective { vertical_fov } => {
                let half = (0.5 * vertical_fov.clamp(FOV_RANGE.0, FOV_RANGE.1)).tan();
                Self::Pinhole { origin: eye, film: plane(axis(Vec3::NEG_Z), 2.0 * half) }
            }
            Projection::Orthographic { height: picture_height } => {
                let direction = axis(Vec3::NEG_Z).normalize_or(Vec3::NEG_Z);
                Self::Parallel { direction, film: plane(eye, picture_height) }
            }
        }
    }

    /// The direction or origin of the ray through film position `at`.
    pub(crate) fn value(&self, at: Vec2) -> Vec3 {
        let point = |film: &FilmPlane| film.top_left + film.right * at.x + film.down * at.y;
        match self {
            Self::Pinhole { film, .. } => point(film).normalize_or(Vec3::NEG_Z),
            Self::Parallel { film, .. } => point(film),
        }
    }
}
