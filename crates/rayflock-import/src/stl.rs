//! STL: triangles and nothing else, binary or ascii (3D Systems, 1989).
//!
//! Corners at the very same place become one vertex, in the order of their first use. Stored
//! normals are not used: triangles are flat.
//!
//! Both kinds may begin with `solid`. A file whose size is exactly what the count in its binary
//! header asks for is binary; otherwise `solid` and text make it ascii.

use std::io::Cursor;

use glam::Vec3;
use rayflock_scene::{Material, Scene, Shape};

use crate::ImportError;
use crate::job::Job;
use crate::mesh_parts::MeshParts;

/// Free text before the count of a binary file.
const HEADER_SIZE: usize = 80;
/// Bytes before the first triangle of a binary file.
const PREAMBLE_SIZE: usize = HEADER_SIZE + 4;
/// Bytes a triangle of a binary file.
const TRIANGLE_SIZE: usize = 50;

/// Reads an STL file.
pub(crate) fn load(mut bytes: Vec<u8>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    if is_ascii(&bytes) {
        // The reader wants a name behind the word, which some files leave out.
        let line_end = bytes.iter().position(|&b| b == b'\n').unwrap_or(bytes.len());
        bytes.splice(..line_end, *b"solid ");
    } else {
        check_binary_size(&bytes, job)?;
        // A binary header that begins with "solid" would be taken for ascii.
        bytes[..HEADER_SIZE].fill(0);
    }
    let indexed = stl_io::read_stl(&mut Cursor::new(bytes))
        .map_err(|error| job.invalid("triangles", error.to_string(), "a whole STL file"))?;

    let positions = indexed.vertices.iter().map(|vertex| Vec3::from(vertex.0)).collect();
    let triangles = indexed.faces.iter().map(|face| face.vertices.map(|idx| idx as u32)).collect();
    let parts = MeshParts { positions, triangles, ..MeshParts::default() };
    let mesh = parts.build("mesh", job)?;
    let materials = vec![Material::default()];
    let mut scene = Scene { name: job.name(), materials, ..Scene::default() };
    job.add_upright(&mut scene, vec![(job.name(), Shape::Fixed(mesh))]);
    Ok(scene)
}

/// The number of triangles that a binary header states.
fn stated_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER_SIZE..)?.first_chunk()?;
    Some(u32::from_le_bytes(*count) as usize)
}

fn is_ascii(bytes: &[u8]) -> bool {
    let fits = |count: usize| bytes.len() == PREAMBLE_SIZE + count * TRIANGLE_SIZE;
    let text = |&b: &u8| b.is_ascii_graphic() || b.is_ascii_whitespace();
    bytes.starts_with(b"solid")
        && bytes.iter().take(PREAMBLE_SIZE).all(text)
        && !stated_count(bytes).is_some_and(fits)
}

/// Refuses a count that the file is too short for, before anything is allocated.
fn check_binary_size(bytes: &[u8], job: &mut Job<'_>) -> Result<(), ImportError> {
    let Some(count) = stated_count(bytes) else {
        let found = format!("{} bytes", bytes.len());
        let expected = format!("\"solid\", or a binary header of {PREAMBLE_SIZE} bytes");
        return Err(job.invalid("header", found, expected));
    };
    let held = (bytes.len() - PREAMBLE_SIZE) / TRIANGLE_SIZE;
    if count > held {
        let found = format!("a count of {count} triangles");
        let expected = format!("at most the {held} that the file has room for");
        return Err(job.invalid("header", found, expected));
    }
    let rest = bytes.len() - PREAMBLE_SIZE - count * TRIANGLE_SIZE;
    if rest > 0 {
        job.warn("end of file", format!("{rest} bytes follow the last triangle; they are ignored"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{fixed_mesh, load_bytes};

    const ASCII: &str = "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n\
        vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid part\n";

    fn binary(header: &[u8], stated: u32, held: usize) -> Vec<u8> {
        let mut bytes = vec![0; HEADER_SIZE];
        bytes[..header.len()].copy_from_slice(header);
        bytes.extend(stated.to_le_bytes());
        for idx in 0..held {
            let corners = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, idx as f32];
            bytes.extend(corners.iter().flat_map(|value: &f32| value.to_le_bytes()));
            bytes.extend([0, 0]);
        }
        bytes
    }

    #[test]
    fn ascii_files_are_read_with_or_without_a_name() {
        for text in [ASCII.to_owned(), ASCII.replacen(" part", "", 1)] {
            let (scene, warnings) = load_bytes("a.stl", text.as_bytes()).unwrap();
            assert_eq!(fixed_mesh(&scene, 0).mesh.corners(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
            assert!(warnings.is_empty());
        }
    }

    #[test]
    fn binary_files_share_corners_even_when_they_begin_with_solid() {
        for header in [&b"made by hand"[..], b"solid but binary"] {
            let (scene, _) = load_bytes("a.stl", &binary(header, 2, 2)).unwrap();
            let mesh = fixed_mesh(&scene, 0);
            assert_eq!((mesh.mesh.triangles().len(), mesh.mesh.vertices().len()), (2, 4));
        }
    }

    #[test]
    fn a_count_beyond_the_file_is_refused() {
        let error = load_bytes("a.stl", &binary(b"", u32::MAX, 1)).unwrap_err().to_string();
        assert!(error.contains("4294967295") && error.contains("at most the 1"), "{error}");
    }

    #[test]
    fn damage_is_an_error_and_a_tail_is_a_warning() {
        assert!(load_bytes("a.stl", b"").is_err());
        assert!(load_bytes("a.stl", &[7; 83]).is_err());
        assert!(load_bytes("a.stl", &ASCII.as_bytes()[..60]).is_err());
        assert!(load_bytes("a.stl", ASCII.replace("1 0 0", "1 0 x").as_bytes()).is_err());
        let mut tail = binary(b"", 1, 1);
        tail.extend([1, 2, 3]);
        assert_eq!(load_bytes("a.stl", &tail).unwrap().1.len(), 1);
    }
}
