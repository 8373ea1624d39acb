//! OBJ files, as text. There is no kept crate that writes them.

use std::io::{self, Write};

use super::FrameMesh;

/// Writes the triangles of a frame as an OBJ file. It has no spheres. Numbers have as many digits
/// as it takes to read the same again.
///
/// # Errors
/// When `out` cannot be written to.
pub fn write_obj(frame: &FrameMesh, out: &mut impl Write) -> io::Result<()> {
    for vertex in &frame.vertices {
        writeln!(out, "v {} {} {}", vertex.x, vertex.y, vertex.z)?;
    }
    for triangle in &frame.triangles {
        let [a, b, c] = triangle.map(|corner| u64::from(corner) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    out.flush()
}
