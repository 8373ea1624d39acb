//! From statements to columns and triangles of corners.

use std::collections::{BTreeSet, HashMap};

use glam::{Vec2, Vec3};

use super::statement::{Statement, statements};
use crate::ImportError;
use crate::job::Job;
use crate::texture::linear;

/// A corner's texture coordinate or normal that is not given.
pub(super) const NONE: u32 = u32::MAX;

/// Most MTL files that one OBJ file may name.
const LIBRARY_LIMIT: usize = 64;

/// A corner of a triangle: positions in the columns of [`ObjFile`], or [`NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// The faces of one name.
#[derive(Debug, Default)]
pub(super) struct Group {
    pub(super) name: String,
    pub(super) triangles: Vec<[Corner; 3]>,
    /// For each triangle, a position in [`ObjFile::material_names`].
    pub(super) materials: Vec<u32>,
}

/// The content of an OBJ file; every corner lies in the columns.
#[derive(Debug, Default)]
pub(super) struct ObjFile {
    pub(super) positions: Vec<Vec3>,
    /// Linear; as long as `positions`, or empty.
    pub(super) colors: Vec<Vec3>,
    /// With the origin at the top left.
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    /// Groups with at least one triangle.
    pub(super) groups: Vec<Group>,
    /// Empty for faces before any `usemtl`.
    pub(super) material_names: Vec<String>,
    pub(super) libraries: Vec<String>,
}

/// Reads the statements of an OBJ file.
pub(super) fn parse(bytes: &[u8], job: &mut Job<'_>) -> Result<ObjFile, ImportError> {
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        return Err(job.invalid("text", format!("a zero byte at offset {at}"), "an OBJ file"));
    }
    let mut parser = Parser::default();
    for statement in statements(bytes) {
        parser.read(&statement).map_err(|(found, expected)| {
            job.invalid(format!("line {}", statement.line), found, expected)
        })?;
    }
    parser.finish(job)
}

/// Found and expected.
type Fault = (String, String);

#[derive(Debug, Default)]
struct Parser {
    file: ObjFile,
    group_idx: usize,
    group_idxs: HashMap<String, usize>,
    /// `None` before any `usemtl`.
    material_idx: Option<u32>,
    material_idxs: HashMap<String, u32>,
    /// The largest index into each column and the line that names it: faces may come first.
    highest: [(u32, usize); 3],
    /// Room for the corners of one face.
    corners: Vec<Corner>,
    known_count: usize,
    unknown: BTreeSet<String>,
    undrawn_count: usize,
    small_count: usize,
}

impl Parser {
    fn read(&mut self, statement: &Statement<'_>) -> Result<(), Fault> {
        self.known_count += 1;
        match statement.keyword() {
            "v" => self.position(statement)?,
            "vt" => {
                let [u, v] = numbers(statement, 1, "1 to 3 numbers")?;
                self.file.uvs.push(Vec2::new(u, 1.0 - v));
            }
            "vn" => {
                let normal: [f32; 3] = numbers(statement, 3, "3 numbers")?;
                self.file.normals.push(Vec3::from(normal));
            }
            "f" | "fo" => self.face(statement)?,
            "o" | "g" => self.group(statement.rest()),
            "usemtl" => self.material_idx = Some(self.material(statement.rest())),
            "mtllib" => self.library(statement.rest())?,
            "s" => {}
            "l" | "p" => self.undrawn_count += 1,
            unknown => {
                self.known_count -= 1;
                if self.unknown.len() < 8 {
                    self.unknown.insert(crate::error::shorten(unknown));
                }
            }
        }
        Ok(())
    }

    fn position(&mut self, statement: &Statement<'_>) -> Result<(), Fault> {
        let values = statement.numbers().map_err(|found| (found, "numbers".to_owned()))?;
        let &[x, y, z, ref more @ ..] = values.as_slice() else {
            return Err((statement.quote(), "3 coordinates".to_owned()));
        };
        if let [r, g, b, ..] = *more {
            // Colours may begin at a later vertex than the first.
            self.file.colors.resize(self.file.positions.len(), Vec3::ONE);
            self.file.colors.push(Vec3::new(r, g, b).map(linear));
        }
        self.file.positions.push(Vec3::new(x, y, z));
        Ok(())
    }

    fn face(&mut self, statement: &Statement<'_>) -> Result<(), Fault> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for word in statement.arguments() {
            let corner = self.corner(word, statement.line).ok_or_else(|| {
                let (v, vt, vn) =
                    (self.file.positions.len(), self.file.uvs.len(), self.file.normals.len());
                let found = format!("the corner \"{word}\" after {v} v, {vt} vt and {vn} vn");
                (found, "v, v/vt, v//vn or v/vt/vn, counted from 1 or back from -1".to_owned())
            })?;
            corners.push(corner);
        }
        match corners.as_slice() {
            [first, rim @ ..] if rim.len() >= 2 => self.add_fan(*first, rim),
            _ => self.small_count += 1,
        }
        self.corners = corners;
        Ok(())
    }

    /// Cuts a polygon into triangles that all have its first corner.
    fn add_fan(&mut self, first: Corner, rim: &[Corner]) {
        let material_idx = self.material_idx.unwrap_or_else(|| self.material(""));
        if self.file.groups.is_empty() {
            self.group("");
        }
        let group = &mut self.file.groups[self.group_idx];
        for pair in rim.windows(2) {
            group.triangles.push([first, pair[0], pair[1]]);
            group.materials.push(material_idx);
        }
    }

    fn corner(&mut self, word: &str, line: usize) -> Option<Corner> {
        let file = &self.file;
        let column_lengths = [file.positions.len(), file.uvs.len(), file.normals.len()];
        let mut indices = [NONE; 3];
        let mut parts = word.split('/');
        for (column, (index, length)) in indices.iter_mut().zip(column_lengths).enumerate() {
            let part = parts.next().unwrap_or_default();
            if part.is_empty() {
                continue;
            }
            let stated: i64 = part.parse().ok()?;
            let resolved = match stated {
                0 => return None,
                1.. => stated - 1,
                _ => length as i64 + stated,
            };
            *index = u32::try_from(resolved).ok().filter(|&index| index != NONE)?;
            if *index >= self.highest[column].0 {
                self.highest[column] = (*index, line);
            }
        }
        let [position, uv, normal] = indices;
        let complete = position != NONE && parts.next().is_none();
        complete.then_some(Corner { position, uv, normal })
    }

    /// Goes on with the group of this name.
    fn group(&mut self, name: &str) {
        self.group_idx = *self.group_idxs.entry(name.to_owned()).or_insert_with(|| {
            self.file.groups.push(Group { name: name.to_owned(), ..Group::default() });
            self.file.groups.len() - 1
        });
    }

    /// The position of a material name, which may be new.
    fn material(&mut self, name: &str) -> u32 {
        let names = &mut self.file.material_names;
        *self.material_idxs.entry(name.to_owned()).or_insert_with(|| {
            names.push(name.to_owned());
            names.len() as u32 - 1
        })
    }

    /// Remembers an MTL file. Their number is limited, since reading each again and again would
    /// take for ever.
    fn library(&mut self, name: &str) -> Result<(), Fault> {
        let libraries = &mut self.file.libraries;
        if libraries.iter().any(|known| known == name) {
            return Ok(());
        }
        if libraries.len() == LIBRARY_LIMIT {
            let found = format!("more than {LIBRARY_LIMIT} MTL files");
            return Err((found, format!("at most {LIBRARY_LIMIT}")));
        }
        libraries.push(name.to_owned());
        Ok(())
    }

    fn finish(mut self, job: &mut Job<'_>) -> Result<ObjFile, ImportError> {
        self.check_indices(job)?;
        self.file.groups.retain(|group| !group.triangles.is_empty());
        if !self.file.colors.is_empty() {
            self.file.colors.resize(self.file.positions.len(), Vec3::ONE);
        }
        let unknown = Vec::from_iter(self.unknown).join(", ");
        if self.known_count == 0 && !unknown.is_empty() {
            return Err(job.invalid(
                "text",
                format!("only {unknown}"),
                "statements such as v or f",
            ));
        }
        if !unknown.is_empty() {
            job.warn("statements", format!("{unknown} are not read"));
        }
        if self.undrawn_count > 0 {
            job.warn("statements", format!("{} lines or points are not drawn", self.undrawn_count));
        }
        if self.small_count > 0 {
            let message =
                format!("{} have fewer than 3 corners; they are ignored", self.small_count);
            job.warn("faces", message);
        }
        if self.file.groups.is_empty() && !self.file.positions.is_empty() {
            job.warn("faces", "there are none; vertices alone are not drawn");
        }
        Ok(self.file)
    }

    /// Checks that the largest index of each column is there.
    fn check_indices(&self, job: &Job<'_>) -> Result<(), ImportError> {
        let file = &self.file;
        let columns =
            [("v", file.positions.len()), ("vt", file.uvs.len()), ("vn", file.normals.len())];
        for ((keyword, length), (highest, line)) in columns.into_iter().zip(self.highest) {
            // Line 0 means that no face names the column.
            if line > 0 && highest as usize >= length {
                let found = format!("{keyword} {}", u64::from(highest) + 1);
                let expected = format!("at most {length}, the number of {keyword} statements");
                return Err(job.invalid(format!("line {line}"), found, expected));
            }
        }
        Ok(())
    }
}

/// The first `N` arguments; those after `least` may be missing and are then 0.
fn numbers<const N: usize>(
    statement: &Statement<'_>,
    least: usize,
    expected: &str,
) -> Result<[f32; N], Fault> {
    let values = statement.numbers().map_err(|found| (found, expected.to_owned()))?;
    if values.len() < least {
        return Err((statement.quote(), expected.to_owned()));
    }
    let mut first = [0.0; N];
    first.iter_mut().zip(values).for_each(|(first, value)| *first = value);
    Ok(first)
}
