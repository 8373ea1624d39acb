//! Legacy files: a header of text, then sections that begin with a line of words and go on with
//! numbers, as text or as bytes.

mod attributes;
mod cells;
mod cursor;

use glam::Vec3;

use super::numbers::Scalar;
use super::piece::{Cells, Piece};
use crate::ImportError;
use crate::job::Job;
use attributes::Attributes;
use cells::{CellLists, Grid};
use cursor::{Cursor, Encoding};

/// Data sets that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DataSet {
    PolyData,
    UnstructuredGrid,
}

/// Reads a whole file.
pub(super) fn read(bytes: &[u8], job: &mut Job<'_>) -> Result<Piece, ImportError> {
    let mut cursor = Cursor::new(bytes);
    let data_set = header(&mut cursor, job)?;
    let mut sections = Sections::default();
    while let Some(line) = cursor.statement() {
        if !sections.read(&Statement::new(&line), &mut cursor, job)? {
            let message = format!("\"{line}\" is not understood; it and what follows is ignored");
            job.warn("attributes", message);
            break;
        }
    }
    if !sections.has_points {
        return Err(job.invalid("data set", "no POINTS", "a section POINTS"));
    }
    let Sections { mut piece, grid, .. } = sections;
    if data_set == DataSet::UnstructuredGrid {
        grid.sort_into(&mut piece, job)?;
    }
    Ok(piece)
}

/// Reads the first four lines.
fn header(cursor: &mut Cursor<'_>, job: &Job<'_>) -> Result<DataSet, ImportError> {
    let magic = cursor.line();
    if !magic.to_ascii_lowercase().starts_with("# vtk datafile version") {
        return Err(job.invalid("line 1", format!("\"{magic}\""), "\"# vtk DataFile Version\""));
    }
    // The second line is a title.
    cursor.line();
    let encoding = cursor.line();
    cursor.encoding = match encoding.to_ascii_uppercase().as_str() {
        "ASCII" => Encoding::Ascii,
        "BINARY" => Encoding::Binary,
        _ => return Err(job.invalid("line 3", format!("\"{encoding}\""), "ASCII or BINARY")),
    };
    let line = cursor.statement().unwrap_or_default();
    let statement = Statement::new(&line);
    match (statement.keyword().as_str(), statement.word(1).to_ascii_uppercase().as_str()) {
        ("DATASET", "POLYDATA") => Ok(DataSet::PolyData),
        ("DATASET", "UNSTRUCTURED_GRID") => Ok(DataSet::UnstructuredGrid),
        ("DATASET", _) => Err(ImportError::Unsupported {
            file: job.file.to_owned(),
            element: "header".to_owned(),
            found: format!("\"{line}\""),
            expected: "DATASET POLYDATA or UNSTRUCTURED_GRID".to_owned(),
        }),
        _ => Err(job.invalid("header", format!("\"{line}\""), "DATASET")),
    }
}

/// A line that begins a section.
#[derive(Debug)]
struct Statement<'a> {
    line: &'a str,
    words: Vec<&'a str>,
}

impl<'a> Statement<'a> {
    fn new(line: &'a str) -> Self {
        Self { line, words: line.split_ascii_whitespace().collect() }
    }

    /// The first word in capitals.
    fn keyword(&self) -> String {
        self.word(0).to_ascii_uppercase()
    }

    /// A word, or nothing.
    fn word(&self, idx: usize) -> &'a str {
        self.words.get(idx).copied().unwrap_or_default()
    }

    /// A word as a count.
    fn count(&self, idx: usize, job: &Job<'_>) -> Result<usize, ImportError> {
        self.word(idx).parse().map_err(|_| {
            let expected = format!("a count as word {}", idx + 1);
            job.invalid(self.place(), format!("\"{}\"", self.line), expected)
        })
    }

    /// A word as a type of numbers.
    fn scalar(&self, idx: usize, job: &Job<'_>) -> Result<Scalar, ImportError> {
        Scalar::legacy(self.word(idx)).ok_or_else(|| {
            let expected = format!("a type of numbers such as float as word {}", idx + 1);
            job.invalid(self.place(), format!("\"{}\"", self.line), expected)
        })
    }

    /// The place for a message.
    fn place(&self) -> String {
        if self.words.is_empty() { "end of file".to_owned() } else { self.keyword() }
    }
}

/// What the sections have brought so far.
#[derive(Debug, Default)]
struct Sections {
    piece: Piece,
    grid: Grid,
    has_points: bool,
    /// `None` before the first section of attributes.
    attributes: Option<Attributes>,
}

impl Sections {
    /// Reads a section; `false` for an attribute that is not understood.
    fn read(
        &mut self,
        statement: &Statement<'_>,
        cursor: &mut Cursor<'_>,
        job: &mut Job<'_>,
    ) -> Result<bool, ImportError> {
        let keyword = statement.keyword();
        match keyword.as_str() {
            "POINTS" => self.points(statement, cursor, job)?,
            "VERTICES" => {
                CellLists::read(statement, cursor, job)?;
            }
            "LINES" => {
                let lines = CellLists::read(statement, cursor, job)?;
                self.piece.leave_out("lines", lines.ends.len());
            }
            "POLYGONS" => self.piece.polygons = self.cells(statement, cursor, job)?,
            "TRIANGLE_STRIPS" => self.piece.strips = self.cells(statement, cursor, job)?,
            "CELLS" => self.grid.lists = CellLists::read(statement, cursor, job)?,
            "CELL_TYPES" => {
                let count = statement.count(1, job)?;
                self.grid.types = cursor.numbers("CELL_TYPES", count, Scalar::I32, job)?;
            }
            "POINT_DATA" => self.attributes = Some(Attributes::of_points(statement, job)?),
            "CELL_DATA" => self.attributes = Some(Attributes::of_cells(statement, job)?),
            // Ends at a blank line.
            "METADATA" => while !cursor.line().is_empty() {},
            // Fields may come before everything else.
            "FIELD" => {
                let of_all = Attributes::default();
                let attributes = self.attributes.as_ref().unwrap_or(&of_all);
                return attributes.field(statement, cursor, &mut self.piece, job);
            }
            _ => match &self.attributes {
                Some(attributes) => {
                    return attributes.attribute(statement, cursor, &mut self.piece, job);
                }
                None => {
                    let found = format!("\"{}\"", statement.line);
                    return Err(job.invalid("data set", found, "a section such as POLYGONS"));
                }
            },
        }
        Ok(true)
    }

    fn points(
        &mut self,
        statement: &Statement<'_>,
        cursor: &mut Cursor<'_>,
        job: &Job<'_>,
    ) -> Result<(), ImportError> {
        let (count, scalar) = (statement.count(1, job)?, statement.scalar(2, job)?);
        let numbers = cursor.numbers::<f32>("POINTS", count.saturating_mul(3), scalar, job)?;
        self.piece.points = numbers.as_chunks().0.iter().map(|&point| Vec3::from(point)).collect();
        self.has_points = true;
        Ok(())
    }

    fn cells(
        &self,
        statement: &Statement<'_>,
        cursor: &mut Cursor<'_>,
        job: &Job<'_>,
    ) -> Result<Cells, ImportError> {
        let lists = CellLists::read(statement, cursor, job)?;
        let mut cells = Cells::new(&statement.keyword());
        cells.add_all(&lists.ends, &lists.corners, self.piece.points.len(), job)?;
        Ok(cells)
    }
}
