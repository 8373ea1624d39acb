//! Points and cells, and the mesh they make.

use std::collections::BTreeMap;

use glam::Vec3;
use rayflock_scene::SurfaceMesh;

use crate::ImportError;
use crate::job::Job;
use crate::mesh_parts::MeshParts;
use crate::particles;

/// What is read of a data set.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub(super) points: Vec<Vec3>,
    pub(super) polygons: Cells,
    pub(super) strips: Cells,
    /// How many cells of kinds that are not drawn there are.
    pub(super) undrawn: BTreeMap<&'static str, usize>,
    /// A normal a point, or none.
    pub(super) normals: Vec<Vec3>,
    /// A radius a point, or none.
    pub(super) radii: Vec<f32>,
}

/// Cells as lists of points, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Cells {
    /// What the file calls them.
    pub(super) name: String,
    /// Positions of points.
    corners: Vec<u32>,
    /// Where in `corners` each cell ends; never decreasing.
    ends: Vec<usize>,
}

impl Cells {
    /// No cells yet, of this name.
    pub(super) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// Adds a cell of these points, which must be below `point_count`.
    pub(super) fn add(
        &mut self,
        corners: &[i64],
        point_count: usize,
        job: &Job<'_>,
    ) -> Result<(), ImportError> {
        for &corner in corners {
            let known = u32::try_from(corner).ok().filter(|&idx| (idx as usize) < point_count);
            self.corners.push(known.ok_or_else(|| {
                let place = format!("{}, cell {}", self.name, self.ends.len());
                let expected = format!("less than {point_count}, the number of points");
                job.invalid(place, format!("point {corner}"), expected)
            })?);
        }
        self.ends.push(self.corners.len());
        Ok(())
    }

    /// Adds the cells whose ends in `corners` are given.
    pub(super) fn add_all(
        &mut self,
        ends: &[i64],
        corners: &[i64],
        point_count: usize,
        job: &Job<'_>,
    ) -> Result<(), ImportError> {
        let mut start = 0;
        for (cell_idx, &end) in ends.iter().enumerate() {
            let cell = usize::try_from(end).ok().and_then(|end| corners.get(start..end));
            let cell = cell.ok_or_else(|| {
                let place = format!("{}, offset of cell {cell_idx}", self.name);
                let expected = format!("from {start} to {}, the length of the list", corners.len());
                job.invalid(place, end.to_string(), expected)
            })?;
            self.add(cell, point_count, job)?;
            start += cell.len();
        }
        Ok(())
    }

    /// Adds a cell of points that are known to be there.
    pub(super) fn push(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len());
    }

    /// Adds the cells of another list, whose points begin at `first`.
    fn append(&mut self, other: &Self, first: u32) {
        let ends_before = self.corners.len();
        self.corners.extend(other.corners.iter().map(|corner| first + corner));
        self.ends.extend(other.ends.iter().map(|end| ends_before + end));
    }

    /// The points of each cell.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.corners[start..end])
    }
}

/// Whether an array of this name holds radii.
pub(super) fn is_radius(name: &str) -> bool {
    ["radius", "radii"].iter().any(|known| name.eq_ignore_ascii_case(known))
}

impl Piece {
    /// Notes cells that are not drawn.
    pub(super) fn leave_out(&mut self, kind: &'static str, count: usize) {
        if count > 0 {
            *self.undrawn.entry(kind).or_default() += count;
        }
    }

    /// Adds another piece behind this one. Attributes that only one of them has are lost.
    pub(super) fn append(&mut self, other: Self) {
        if self.points.is_empty() {
            let undrawn = std::mem::take(&mut self.undrawn);
            *self = other;
            undrawn.into_iter().for_each(|(kind, count)| self.leave_out(kind, count));
            return;
        }
        let first = self.points.len() as u32;
        let has_all = |ours: usize, others: usize| ours > 0 && others == other.points.len();
        match has_all(self.normals.len(), other.normals.len()) {
            true => self.normals.extend(other.normals),
            false => self.normals.clear(),
        }
        match has_all(self.radii.len(), other.radii.len()) {
            true => self.radii.extend(other.radii),
            false => self.radii.clear(),
        }
        self.polygons.append(&other.polygons, first);
        self.strips.append(&other.strips, first);
        self.points.extend(other.points);
        other.undrawn.into_iter().for_each(|(kind, count)| self.leave_out(kind, count));
    }

    /// Triangles, or spheres at all points where there are no cells but vertices.
    pub(super) fn surface(self, job: &mut Job<'_>) -> Result<SurfaceMesh, ImportError> {
        let triangles = self.triangles(job);
        if !self.undrawn.is_empty() {
            let kinds = self.undrawn.iter().map(|(kind, count)| format!("{count} {kind}"));
            let kinds = kinds.collect::<Vec<_>>().join(", ");
            job.warn("cells", format!("{kinds}: these are not drawn"));
        }
        if triangles.is_empty() && self.undrawn.is_empty() {
            let radii = Some(self.radii.as_slice()).filter(|radii| !radii.is_empty());
            return Ok(particles::spheres(&self.points, radii, "points", job));
        }
        let (positions, normals) = (self.points, self.normals);
        MeshParts { positions, triangles, normals, ..MeshParts::default() }.build("cells", job)
    }

    /// Fans of all polygons, then strips.
    fn triangles(&self, job: &mut Job<'_>) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        let mut small_count = 0;
        for polygon in self.polygons.iter() {
            match polygon {
                [first, rim @ ..] if rim.len() >= 2 => {
                    triangles.extend(rim.windows(2).map(|pair| [*first, pair[0], pair[1]]));
                }
                _ => small_count += 1,
            }
        }
        for strip in self.strips.iter() {
            small_count += usize::from(strip.len() < 3);
            triangles.extend(strip.windows(3).enumerate().map(|(idx, w)| match idx % 2 {
                0 => [w[0], w[1], w[2]],
                _ => [w[0], w[2], w[1]],
            }));
        }
        if small_count > 0 {
            let message = format!("{small_count} have fewer than 3 corners; they are ignored");
            job.warn("cells", message);
        }
        triangles
    }
}
