//! VTK: polygons, triangle strips and points, in legacy files and XML files.
//!
//! Read: data sets `POLYDATA` and, of legacy files, `UNSTRUCTURED_GRID`; of point data the
//! `NORMALS` and a `radius`. Points are spheres where no cell but vertices is there. Lines and
//! cells with a volume are not drawn, and told. Other attributes are skipped.
//!
//! **Source.** "VTK File Formats", Kitware, version 4.2 of the VTK documentation and its
//! supplement on legacy files of version 5.1.
//!
//! **Departures.** The readers are our own. Those of the crate vtkio (0.6.3, its last release)
//! panic on an XML piece without points and on an array shorter than its header; of legacy files
//! they drop an attribute that is not understood and all behind it without a word, and refuse
//! `nan`; their errors name no place.
//!
//! **Invariants.** Counts are compared with the bytes that are left before anything is allocated.

mod legacy;
mod numbers;
mod piece;
mod xml;

#[cfg(test)]
mod tests;

use rayflock_scene::{Material, Scene, Shape};

use crate::ImportError;
use crate::job::Job;
use piece::Piece;

/// Reads a VTK file of either kind, whatever its extension.
pub(crate) fn load(bytes: Vec<u8>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    let start = bytes.trim_ascii_start();
    let piece: Piece = if start.starts_with(b"#") {
        legacy::read(start, job)?
    } else if start.starts_with(b"<") {
        xml::read(start, job)?
    } else {
        let found = String::from_utf8_lossy(&start[..start.len().min(40)]).into_owned();
        let expected = "\"# vtk DataFile Version\" or \"<VTKFile\"";
        return Err(job.invalid("header", format!("\"{found}\""), expected));
    };
    drop(bytes);
    let mesh = piece.surface(job)?;
    let materials = vec![Material::default()];
    let mut scene = Scene { name: job.name(), materials, ..Scene::default() };
    job.add_upright(&mut scene, vec![(job.name(), Shape::Fixed(mesh))]);
    Ok(scene)
}
