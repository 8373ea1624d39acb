//! NumPy frame sets: `.npz` files with the triangles or points of one frame or many.
//!
//! | Array | Shape | What it is |
//! |---|---|---|
//! | `vertices` | (F, V, 3) or (V, 3) | positions, of each frame or of all |
//! | `triangles` | (F, M, 3) or (M, 3) | positions in the frame's vertices |
//! | `centers` | (F, N, 3) or (N, 3) | middles of spheres |
//! | `radii` | (F, N), (N,) or () | their radii; without it, one that suits their distances |
//! | `frame_rate` | () | frames a second |
//!
//! Where frames differ in length, an array has the rows of all frames, (sum, 3), and
//! `vertex_offsets`, `triangle_offsets` or `center_offsets`, (F + 1,), say where each begins and
//! the last ends; `radii` then has as many entries as `centers` has rows.
//!
//! Positions are float32 or float64, everything else int32, int64, uint32 or uint64.
//!
//! **Invariants.** What an array claims is compared with the bytes that are there before it is
//! read: arrays are views of the unpacked bytes. Their texts are short before they are parsed.
//!
//! **Cost.** Memory for all frames, in single precision.

mod archive;
mod frames;
mod rows;

#[cfg(test)]
mod tests;

use glam::Vec3;
use rayflock_scene::{FrameSource, Material, Scene, Shape};

use crate::ImportError;
use crate::job::Job;
use crate::particles::usual_radius;
use crate::sequence::add_stream;
use archive::Archive;
use frames::{ArrayFrames, FrameRadii};
use rows::Rows;

/// Reads a frame set.
pub(crate) fn load(bytes: Vec<u8>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    let mut archive = Archive::open(&bytes, job)?;
    let frames = read_frames(&mut archive, job)?;
    let frame_rate = frame_rate(&mut archive, job)?;
    drop(bytes);
    let materials = vec![Material::default()];
    let mut scene = Scene { name: job.name(), materials, ..Scene::default() };
    scene.frame_rate = frame_rate;
    if frames.is_static() {
        let surface = frames.load(0).map_err(|reason| job.invalid("arrays", reason, "a frame"))?;
        job.add_upright(&mut scene, vec![(job.name(), Shape::Fixed(surface))]);
    } else {
        add_stream(&mut scene, frames, job)?;
    }
    Ok(scene)
}

fn read_frames(archive: &mut Archive<'_>, job: &mut Job<'_>) -> Result<ArrayFrames, ImportError> {
    let vertices = rows::vectors("vertices", "vertex_offsets", archive, job)?;
    let triangles = rows::triangles(archive, job)?;
    let centers = rows::vectors("centers", "center_offsets", archive, job)?;
    if vertices.is_some() != triangles.is_some() || (vertices.is_none() && centers.is_none()) {
        let found = format!("the arrays {}", archive.names().join(", "));
        return Err(job.invalid("arrays", found, "vertices and triangles, or centers"));
    }
    let radii = match &centers {
        Some(centers) => radii(archive, centers, job)?,
        None => FrameRadii::All(0.0),
    };
    let (vertices, triangles) = (vertices.unwrap_or_default(), triangles.unwrap_or_default());
    let centers = centers.unwrap_or_default();
    ArrayFrames::new(vertices, triangles, centers, radii, job)
}

/// The radii of `centers`, which are found out where the file does not say.
fn radii(
    archive: &mut Archive<'_>,
    centers: &Rows<Vec3>,
    job: &mut Job<'_>,
) -> Result<FrameRadii, ImportError> {
    if let Some(radii) = rows::radii(centers, archive, job)? {
        return Ok(radii);
    }
    let first = centers.iter().find(|centers| !centers.is_empty()).unwrap_or_default();
    Ok(FrameRadii::All(usual_radius(first, "centers", job)))
}

/// The rate, if it is stated and makes sense.
fn frame_rate(archive: &mut Archive<'_>, job: &mut Job<'_>) -> Result<Option<f64>, ImportError> {
    let Some(array) = archive.get("frame_rate", job)? else { return Ok(None) };
    match array.numbers(job)?.values.as_slice() {
        [rate] if rate.is_finite() && *rate > 0.0 => Ok(Some(*rate)),
        values => {
            let found = values.first().map_or_else(|| "nothing".to_owned(), ToString::to_string);
            job.warn("frame_rate", format!("{found} is no rate; it is ignored"));
            Ok(None)
        }
    }
}
