//! Attributes of points and cells, of which few are read.

use glam::Vec3;

use super::Statement;
use super::cursor::{Cursor, Encoding};
use crate::ImportError;
use crate::job::Job;
use crate::vtk::numbers::Scalar;
use crate::vtk::piece::{Piece, is_radius};

/// What the attributes that follow belong to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Attributes {
    /// Values an attribute has.
    count: usize,
    are_of_points: bool,
}

/// An array as its line describes it.
#[derive(Clone, Copy, Debug)]
struct Array<'a> {
    /// What messages call it.
    name: &'a str,
    components: usize,
    /// Groups of components.
    count: usize,
    scalar: Scalar,
    is_normals: bool,
}

impl Attributes {
    /// Those behind a line `POINT_DATA n`.
    pub(super) fn of_points(statement: &Statement<'_>, job: &Job<'_>) -> Result<Self, ImportError> {
        Ok(Self { count: statement.count(1, job)?, are_of_points: true })
    }

    /// Those behind a line `CELL_DATA n`.
    pub(super) fn of_cells(statement: &Statement<'_>, job: &Job<'_>) -> Result<Self, ImportError> {
        Ok(Self { count: statement.count(1, job)?, are_of_points: false })
    }

    /// Reads or passes over an attribute; `false` for one that is not understood.
    pub(super) fn attribute(
        &self,
        statement: &Statement<'_>,
        cursor: &mut Cursor<'_>,
        piece: &mut Piece,
        job: &mut Job<'_>,
    ) -> Result<bool, ImportError> {
        let keyword = statement.keyword();
        let fixed = |components| (components, self.count, Scalar::legacy(statement.word(2)));
        // Bytes stand for fractions here, which are written as such in text.
        let color = match cursor.encoding {
            Encoding::Ascii => Scalar::F32,
            Encoding::Binary => Scalar::U8,
        };
        let (components, count, scalar) = match keyword.as_str() {
            "SCALARS" if statement.words.len() > 3 => fixed(statement.count(3, job)?),
            "SCALARS" | "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => fixed(1),
            "VECTORS" | "NORMALS" => fixed(3),
            "TENSORS" => fixed(9),
            "TENSORS6" => fixed(6),
            "TEXTURE_COORDINATES" => {
                (statement.count(2, job)?, self.count, Scalar::legacy(statement.word(3)))
            }
            "COLOR_SCALARS" => (statement.count(2, job)?, self.count, Some(color)),
            "LOOKUP_TABLE" => (4, statement.count(2, job)?, Some(color)),
            _ => return Ok(false),
        };
        let Some(scalar) = scalar else { return Ok(false) };
        if keyword == "SCALARS" && cursor.is_next("LOOKUP_TABLE") {
            cursor.statement();
        }
        let (name, is_normals) = (statement.word(1), keyword == "NORMALS");
        self.array(Array { name, components, count, scalar, is_normals }, cursor, piece, job)?;
        Ok(true)
    }

    /// Reads or passes over the arrays of a line `FIELD name n`; `false` when one is not
    /// understood.
    pub(super) fn field(
        &self,
        statement: &Statement<'_>,
        cursor: &mut Cursor<'_>,
        piece: &mut Piece,
        job: &mut Job<'_>,
    ) -> Result<bool, ImportError> {
        for _ in 0..statement.count(2, job)? {
            let mut line = cursor.statement().unwrap_or_default();
            while line.eq_ignore_ascii_case("METADATA") {
                while !cursor.line().is_empty() {}
                line = cursor.statement().unwrap_or_default();
            }
            let array = Statement::new(&line);
            let (components, count) = (array.count(1, job)?, array.count(2, job)?);
            let Some(scalar) = Scalar::legacy(array.word(3)) else { return Ok(false) };
            let (name, is_normals) = (array.word(0), false);
            self.array(Array { name, components, count, scalar, is_normals }, cursor, piece, job)?;
        }
        Ok(true)
    }

    fn array(
        &self,
        array: Array<'_>,
        cursor: &mut Cursor<'_>,
        piece: &mut Piece,
        job: &Job<'_>,
    ) -> Result<(), ImportError> {
        let Array { name, components, count, scalar, is_normals } = array;
        let total = components.saturating_mul(count);
        let fits = self.are_of_points && count == piece.points.len();
        if fits && components == 1 && is_radius(name) {
            piece.radii = cursor.numbers(name, total, scalar, job)?;
        } else if fits && is_normals {
            let numbers = cursor.numbers::<f32>(name, total, scalar, job)?;
            piece.normals = numbers.as_chunks().0.iter().map(|&n| Vec3::from(n)).collect();
        } else {
            cursor.skip(name, total, scalar, job)?;
        }
        Ok(())
    }
}
