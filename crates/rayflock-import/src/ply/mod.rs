//! PLY: the Stanford polygon format, ascii or binary of either byte order.
//!
//! Read: `vertex` with positions (`x y z`), normals (`nx ny nz`), colours (`red green blue`,
//! sRGB) and texture coordinates (`s t`, `u v` or `texture_u texture_v`, origin at the bottom
//! left); `face` with a list `vertex_indices` or `vertex_index`, cut into fans; `tristrips`, whose
//! strips end at -1. Vertices without faces are spheres, of their `radius` or one that suits
//! their distances. Other elements and properties are skipped.
//!
//! **Source.** Greg Turk, "The PLY Polygon File Format", 1994.
//!
//! **Invariants.** A header may claim any count, so the bytes that the counts need at least are
//! compared with those that are there before the payload is read.

mod header;
mod rows;

#[cfg(test)]
mod tests;

use glam::{Vec2, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, PropertyAccess};
use rayflock_scene::{Material, Scene, Shape, SurfaceMesh};

use crate::ImportError;
use crate::job::Job;
use crate::mesh_parts::{MeshParts, VertexPoints};
use crate::particles;
use crate::sequence::surfaces;
use crate::texture::linear;
use rows::{FaceRow, SkippedRow, VertexRow};

/// Reads a PLY file.
pub(crate) fn load(bytes: Vec<u8>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    let mut payload = Reader::new(bytes.as_slice());
    let header = Parser::<SkippedRow>::new()
        .read_header(&mut payload)
        .map_err(|error| damage("header", &error, job))?;
    header::check_sizes(&header, payload.get_ref().len(), job)?;
    let rows = read_rows(&header, &mut payload, job)?;
    if !payload.get_ref().is_empty() && payload.get_ref().iter().any(|b| !b.is_ascii_whitespace()) {
        let message = format!("{} bytes are left; they are ignored", payload.get_ref().len());
        job.warn("end of file", message);
    }
    drop(bytes);
    let mesh = surface(&header, &rows, job)?;
    let mut scene =
        Scene { name: job.name(), materials: vec![Material::default()], ..Scene::default() };
    job.add_upright(&mut scene, vec![(job.name(), Shape::Fixed(mesh))]);
    Ok(scene)
}

/// Reads a mesh like [`load`], and tells that each vertex is a point of its own.
pub(crate) fn load_with_points(
    bytes: Vec<u8>,
    job: &mut Job<'_>,
) -> Result<(Scene, VertexPoints), ImportError> {
    let scene = load(bytes, job)?;
    let mesh = surfaces(&scene).next().map(|surface| &surface.mesh);
    let count = mesh.filter(|mesh| mesh.spheres().is_empty()).map_or(0, |m| m.vertices().len());
    if count == 0 {
        return Err(job.invalid("element \"face\"", "no faces", "a mesh"));
    }
    Ok((scene, VertexPoints { count, of_vertices: (0..count as u32).collect() }))
}

/// What the parser found wrong.
fn damage(element: &str, error: &ParseError, job: &Job<'_>) -> ImportError {
    let element = match error.line() {
        Some(line) => format!("{element}, line {line}"),
        None => element.to_owned(),
    };
    job.invalid(element, error.to_string(), "a whole PLY file")
}

/// The rows of all elements that are read.
#[derive(Default)]
struct Rows {
    vertices: Vec<VertexRow>,
    faces: Vec<FaceRow>,
    strips: Vec<FaceRow>,
}

fn read_rows(
    header: &Header,
    payload: &mut Reader<&[u8]>,
    job: &Job<'_>,
) -> Result<Rows, ImportError> {
    let mut rows = Rows::default();
    for (_, element) in &header.elements {
        match element.name.as_str() {
            "vertex" => rows.vertices = read_element(header, element, payload, job)?,
            "face" => rows.faces = read_element(header, element, payload, job)?,
            "tristrips" => rows.strips = read_element(header, element, payload, job)?,
            _ => {
                read_element::<SkippedRow>(header, element, payload, job)?;
            }
        }
    }
    Ok(rows)
}

fn read_element<Row: PropertyAccess>(
    header: &Header,
    element: &ElementDef,
    payload: &mut Reader<&[u8]>,
    job: &Job<'_>,
) -> Result<Vec<Row>, ImportError> {
    Parser::<Row>::new()
        .read_payload_for_element(payload, element, header)
        .map_err(|error| damage(&format!("element \"{}\"", element.name), &error, job))
}

/// Triangles, or spheres where there are no faces.
fn surface(header: &Header, rows: &Rows, job: &mut Job<'_>) -> Result<SurfaceMesh, ImportError> {
    let columns = header::columns(header);
    if !rows.vertices.is_empty() && !columns.positions {
        return Err(job.invalid("element \"vertex\"", "no x, y and z", "positions"));
    }
    if rows.faces.is_empty() && rows.strips.is_empty() && !rows.vertices.is_empty() {
        return Ok(spheres(&rows.vertices, columns.radius, job));
    }
    let mut parts = MeshParts { triangles: triangles(rows, job)?, ..MeshParts::default() };
    for row in &rows.vertices {
        parts.positions.push(Vec3::from(row.position));
        if columns.normals {
            parts.normals.push(Vec3::from(row.normal));
        }
        if columns.colors {
            parts.colors.push(Vec3::from(row.color).map(linear));
        }
        if columns.uvs {
            parts.uvs.push(Vec2::new(row.uv[0], 1.0 - row.uv[1]));
        }
    }
    parts.build("mesh", job)
}

/// Spheres at all vertices.
fn spheres(vertices: &[VertexRow], has_radius: bool, job: &mut Job<'_>) -> SurfaceMesh {
    let centers: Vec<Vec3> = vertices.iter().map(|row| Vec3::from(row.position)).collect();
    let radii: Option<Vec<f32>> =
        has_radius.then(|| vertices.iter().map(|row| row.radius).collect());
    particles::spheres(&centers, radii.as_deref(), "element \"vertex\"", job)
}

/// Fans of all faces, then strips.
fn triangles(rows: &Rows, job: &mut Job<'_>) -> Result<Vec<[u32; 3]>, ImportError> {
    let vertex_count = rows.vertices.len();
    let check = |idx: i64, kind: &str, row_idx: usize| {
        let inside = u32::try_from(idx).ok().filter(|&idx| (idx as usize) < vertex_count);
        inside.ok_or_else(|| {
            let expected = format!("less than {vertex_count}, the number of vertices");
            job.invalid(format!("{kind} {row_idx}"), format!("vertex {idx}"), expected)
        })
    };
    let mut triangles = Vec::new();
    let mut small_count = 0;
    for (face_idx, face) in rows.faces.iter().enumerate() {
        let corners = face.indices.iter().map(|&idx| check(idx, "face", face_idx));
        let corners = corners.collect::<Result<Vec<_>, _>>()?;
        match corners.as_slice() {
            [first, rim @ ..] if rim.len() >= 2 => {
                triangles.extend(rim.windows(2).map(|pair| [*first, pair[0], pair[1]]));
            }
            _ => small_count += 1,
        }
    }
    for (row_idx, row) in rows.strips.iter().enumerate() {
        for strip in row.indices.split(|&idx| idx == -1) {
            let strip = strip.iter().map(|&idx| check(idx, "strip", row_idx));
            let strip = strip.collect::<Result<Vec<_>, _>>()?;
            triangles.extend(strip.windows(3).enumerate().map(|(idx, w)| match idx % 2 {
                0 => [w[0], w[1], w[2]],
                _ => [w[0], w[2], w[1]],
            }));
        }
    }
    if small_count > 0 {
        let message = format!("{small_count} have fewer than 3 corners; they are ignored");
        job.warn("element \"face\"", message);
    }
    Ok(triangles)
}
