//! Cells of legacy files: lists of points, of one kind or with a kind each.

use super::Statement;
use super::cursor::Cursor;
use crate::ImportError;
use crate::job::Job;
use crate::vtk::numbers::Scalar;
use crate::vtk::piece::{Cells, Piece};

/// Lists of points, one after the other.
#[derive(Debug, Default)]
pub(super) struct CellLists {
    pub(super) corners: Vec<i64>,
    /// Where in `corners` each list ends; not checked.
    pub(super) ends: Vec<i64>,
}

impl CellLists {
    /// Reads the lists of a section whose line ends in two counts: up to version 4 of lists and of
    /// numbers in them, each list with its length in front; from version 5 of offsets and of
    /// numbers, in two arrays.
    pub(super) fn read(
        statement: &Statement<'_>,
        cursor: &mut Cursor<'_>,
        job: &Job<'_>,
    ) -> Result<Self, ImportError> {
        let (count, size) = (statement.count(1, job)?, statement.count(2, job)?);
        let keyword = statement.keyword();
        if cursor.is_next("OFFSETS") {
            let mut ends = array(&keyword, count, cursor, job)?;
            // The first list begins at 0.
            ends.drain(..ends.len().min(1));
            let corners = array(&keyword, size, cursor, job)?;
            return Ok(Self { corners, ends });
        }
        let numbers = cursor.numbers::<i64>(&keyword, size, Scalar::I32, job)?;
        let mut lists = Self::default();
        let mut rest = numbers.as_slice();
        for cell_idx in 0..count {
            let (length, list) = rest.split_first().unwrap_or((&-1, &[]));
            let list = usize::try_from(*length).ok().and_then(|length| list.get(..length));
            let list = list.ok_or_else(|| {
                let place = format!("{keyword}, cell {cell_idx}");
                let found = if rest.is_empty() { "nothing" } else { "a length beyond the list" };
                job.invalid(place, found, format!("{count} cells in {size} numbers"))
            })?;
            lists.corners.extend_from_slice(list);
            lists.ends.push(lists.corners.len() as i64);
            rest = &rest[1 + list.len()..];
        }
        if rest.is_empty() {
            return Ok(lists);
        }
        let found = format!("{} numbers behind the last cell", rest.len());
        Err(job.invalid(keyword, found, format!("{count} cells in {size} numbers")))
    }
}

/// An array with a line of its own: its name and type.
fn array(
    keyword: &str,
    count: usize,
    cursor: &mut Cursor<'_>,
    job: &Job<'_>,
) -> Result<Vec<i64>, ImportError> {
    let line = cursor.statement().unwrap_or_default();
    let scalar = Statement::new(&line).scalar(1, job)?;
    cursor.numbers(keyword, count, scalar, job)
}

/// The cells of an unstructured grid.
#[derive(Debug, Default)]
pub(super) struct Grid {
    pub(super) lists: CellLists,
    /// A kind a list.
    pub(super) types: Vec<i64>,
}

impl Grid {
    /// Adds the cells to a piece, by their kinds.
    pub(super) fn sort_into(&self, piece: &mut Piece, job: &Job<'_>) -> Result<(), ImportError> {
        if self.types.len() != self.lists.ends.len() {
            let found = format!("{} types", self.types.len());
            let expected = format!("{}, one a cell", self.lists.ends.len());
            return Err(job.invalid("CELL_TYPES", found, expected));
        }
        let mut all = Cells::new("CELLS");
        all.add_all(&self.lists.ends, &self.lists.corners, piece.points.len(), job)?;
        piece.polygons = Cells::new("CELLS");
        piece.strips = Cells::new("CELLS");
        for (cell, kind) in all.iter().zip(&self.types) {
            match kind {
                // Vertices.
                1 | 2 => {}
                3 | 4 => piece.leave_out("lines", 1),
                5 | 7 | 9 => piece.polygons.push(cell),
                6 => piece.strips.push(cell),
                // A pixel has its corners in rows.
                8 => match *cell {
                    [a, b, c, d] => piece.polygons.push(&[a, b, d, c]),
                    _ => piece.leave_out("cells of other kinds", 1),
                },
                10..=19 => piece.leave_out("cells with a volume", 1),
                _ => piece.leave_out("cells of other kinds", 1),
            }
        }
        Ok(())
    }
}
