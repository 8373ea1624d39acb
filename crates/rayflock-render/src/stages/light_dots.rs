//! Dots in a picture where virtual lights are.

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::RayBatch;
use rayflock_scene::Projection;

use crate::vpl::VirtualLights;
use crate::{Film, View};

/// How far the picture is dimmed.
const DIMMED: f32 = 0.25;

/// Dims `film` and adds a dot of three pixels a side for each light that `view` sees; lights of
/// nothing but a highlight have no colour of their own, and no dot.
pub(crate) fn light_dots(
    engine: &mut dyn RayEngine,
    lights: &VirtualLights,
    view: &View,
    film: &mut Film,
) {
    film.pixels_mut().iter_mut().flatten().for_each(|channel| *channel *= DIMMED);
    let near = 0..lights.distant().start;
    let (positions, intensities) = (&lights.positions()[near.clone()], lights.intensities());
    let directions: Vec<Vec3> = positions.iter().map(|end| *end - eye(view, *end)).collect();
    let origins: Vec<Vec3> = positions.iter().map(|end| eye(view, *end)).collect();
    let batch =
        RayBatch::new(&origins, &directions).and_then(|batch| batch.with_interval(0.0, 1.0 - 1e-3));
    let Ok(batch) = batch else { unreachable!("there is an origin for each direction") };
    let mut hidden = vec![false; positions.len()];
    if !positions.is_empty() {
        engine.occluded(&batch, &mut hidden);
    }
    for ((position, intensity), hidden) in positions.iter().zip(intensities).zip(hidden) {
        let color = *intensity / intensity.max_element().max(f32::MIN_POSITIVE);
        if let Some((x, y)) = pixel(view, *position, film)
            && !hidden
            && color != Vec3::ZERO
        {
            draw(film, x, y, color);
        }
    }
}

/// Where the ray of the camera through `point` starts.
fn eye(view: &View, point: Vec3) -> Vec3 {
    let camera = &view.world_from_camera;
    match view.projection {
        Projection::Perspective { .. } => Vec3::from(camera.translation),
        Projection::Orthographic { .. } => {
            let in_camera = camera.inverse().transform_point3(point);
            camera.transform_point3(in_camera.with_z(0.0))
        }
    }
}

/// The pixel, counted from the top left, in which `point` lies; `None` behind the camera.
fn pixel(view: &View, point: Vec3, film: &Film) -> Option<(isize, isize)> {
    let in_camera = view.world_from_camera.inverse().transform_point3(point);
    let (width, height) = (film.width() as f32, film.height() as f32);
    let half_height = match view.projection {
        Projection::Perspective { vertical_fov } => -in_camera.z * (0.5 * vertical_fov).tan(),
        Projection::Orthographic { height } => 0.5 * height,
    };
    let scale = 0.5 * height / half_height;
    let (x, y) = (0.5 * width + in_camera.x * scale, 0.5 * height - in_camera.y * scale);
    let is_inside = (-1.0..width + 1.0).contains(&x) && (-1.0..height + 1.0).contains(&y);
    (in_camera.z < 0.0 && is_inside).then_some((x.floor() as isize, y.floor() as isize))
}

fn draw(film: &mut Film, x: isize, y: isize, color: Vec3) {
    let (width, height) = (film.width(), film.height());
    for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
        if let (Ok(x), Ok(y)) = (usize::try_from(x + dx), usize::try_from(y + dy))
            && x < width
            && y < height
        {
            film.pixels_mut()[y * width + x] = color.to_array();
        }
    }
}
