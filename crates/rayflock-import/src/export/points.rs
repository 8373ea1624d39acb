//! Files of points that a sensor told, with all that is known of each.
//!
//! | Format | Holds |
//! |---|---|
//! | [`Ply`](PointFormat::Ply) | points in world space, binary, coloured |
//! | [`Pcd`](PointFormat::Pcd) | points in world space, binary, for the Point Cloud Library |
//! | [`Npz`](PointFormat::Npz) | everything, as arrays for NumPy |
//! | [`Csv`](PointFormat::Csv) | a line a point |
//!
//! This crate knows no sensors: whoever has a sweep hands over its columns.

mod csv;
mod npz;
mod pcd;
mod ply;

use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;
use thiserror::Error;

/// What is known of points: a column for each thing, all of one length but those of time steps.
#[derive(Clone, Debug, Default)]
pub struct PointColumns<'a> {
    /// Positions in world space.
    pub position: &'a [Vec3],
    /// Positions in the frame of the sensor.
    pub position_in_sensor: &'a [Vec3],
    /// Unit normals in world space.
    pub normal: &'a [Vec3],
    /// Distances along beams.
    pub range: &'a [f32],
    /// How much light came back.
    pub intensity: &'a [f32],
    /// When, in seconds.
    pub time: &'a [f64],
    /// Objects.
    pub object_id: &'a [u32],
    /// Primitives within objects.
    pub prim_id: &'a [u32],
    /// Beams.
    pub beam_idx: &'a [u32],
    /// Rows of beams.
    pub row: &'a [u32],
    /// Columns of beams.
    pub column: &'a [u32],
    /// Which of the beam's returns, from 1 on.
    pub return_number: &'a [u8],
    /// How many returns of the beam there are.
    pub return_count: &'a [u8],
    /// Colours in sRGB, which PLY holds.
    pub color: Vec<[u8; 3]>,
    /// When each time step was, in seconds.
    pub step_time: Vec<f64>,
    /// Where the sensor was in each time step: matrices, row by row.
    pub world_from_sensor: Vec<[f32; 16]>,
    /// Pictures of first returns, which NPZ holds; none where beams make no picture.
    pub images: Option<PointImages>,
}

/// Pictures of first returns, row by row from the top.
#[derive(Clone, Debug, Default)]
pub struct PointImages {
    /// Rows and columns.
    pub shape: (usize, usize),
    /// Infinite where nothing came back.
    pub range: Vec<f32>,
    /// Infinite where nothing came back.
    pub depth: Vec<f32>,
    /// 0 where nothing came back.
    pub intensity: Vec<f32>,
}

/// How points are written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointFormat {
    /// The Polygon File Format.
    Ply,
    /// The format of the Point Cloud Library.
    Pcd,
    /// Arrays for NumPy.
    Npz,
    /// Comma-separated values.
    Csv,
}

/// Why points cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PointFileError {
    /// The name of the file tells no format.
    #[error(
        "cannot tell the format of the output \"{}\": expected a .ply, .pcd, .npz or .csv file",
        path.display()
    )]
    UnknownFormat {
        /// The name.
        path: PathBuf,
    },
    /// A column has another length than the others.
    #[error("{column} has {found} entries, expected {expected}, as many as there are points")]
    ColumnLength {
        /// The column.
        column: &'static str,
        /// Its length.
        found: usize,
        /// That of the others.
        expected: usize,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// An array cannot be written.
    #[error(transparent)]
    Npz(#[from] ndarray_npy::WriteNpzError),
    /// An array does not have the shape that it should have.
    #[error(transparent)]
    Shape(#[from] ndarray::ShapeError),
    /// A point cannot be written as PCD.
    #[error("cannot write points as PCD: {0}")]
    Pcd(#[from] pcd_rs::Error),
    /// A line cannot be written.
    #[error(transparent)]
    Csv(#[from] ::csv::Error),
}

impl PointFormat {
    /// The format that the extension of a path tells.
    ///
    /// # Errors
    /// [`PointFileError::UnknownFormat`] for other extensions.
    pub fn of_path(path: &Path) -> Result<Self, PointFileError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "ply" => Ok(Self::Ply),
            "pcd" => Ok(Self::Pcd),
            "npz" => Ok(Self::Npz),
            "csv" => Ok(Self::Csv),
            _ => Err(PointFileError::UnknownFormat { path: path.to_owned() }),
        }
    }
}

impl PointColumns<'_> {
    /// Number of points.
    pub const fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are no points.
    pub const fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Fails unless all columns have one length.
    fn check(&self) -> Result<(), PointFileError> {
        let expected = self.len();
        for (column, found) in [
            ("position_in_sensor", self.position_in_sensor.len()),
            ("normal", self.normal.len()),
            ("range", self.range.len()),
            ("intensity", self.intensity.len()),
            ("time", self.time.len()),
            ("object_id", self.object_id.len()),
            ("prim_id", self.prim_id.len()),
            ("beam", self.beam_idx.len()),
            ("row", self.row.len()),
            ("column", self.column.len()),
            ("return_number", self.return_number.len()),
            ("return_count", self.return_count.len()),
            ("color", self.color.len()),
        ] {
            if found != expected {
                return Err(PointFileError::ColumnLength { column, found, expected });
            }
        }
        Ok(())
    }
}

/// Writes points.
///
/// # Errors
/// [`PointFileError`] when columns have different lengths, or `out` cannot be written to.
pub fn write_points(
    points: &PointColumns<'_>,
    format: PointFormat,
    out: &mut (impl Write + Seek),
) -> Result<(), PointFileError> {
    points.check()?;
    match format {
        PointFormat::Ply => ply::write(points, out),
        PointFormat::Pcd => pcd::write(points, out),
        PointFormat::Npz => npz::write(points, out),
        PointFormat::Csv => csv::write(points, out),
    }?;
    Ok(out.flush()?)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    const FORMATS: [PointFormat; 4] =
        [PointFormat::Ply, PointFormat::Pcd, PointFormat::Npz, PointFormat::Csv];

    #[test]
    fn names_tell_formats() {
        let format = |name: &str| PointFormat::of_path(Path::new(name));
        let found = ["a.ply", "b/a.PCD", "a.b.npz", "a.csv"].map(|name| format(name).unwrap());
        assert_eq!(found, FORMATS);
        for name in ["a.las", "ply", "", "a."] {
            let message = format(name).unwrap_err().to_string();
            assert!(message.contains(&format!("\"{name}\": expected a .ply, .pcd")), "{message}");
        }
    }

    #[test]
    fn a_sweep_that_met_nothing_is_a_file_all_the_same() {
        for format in FORMATS {
            let mut file = Cursor::new(Vec::new());
            write_points(&PointColumns::default(), format, &mut file).unwrap();
            assert!(file.get_ref().len() > 50, "{format:?}");
        }
    }

    #[test]
    fn columns_of_different_lengths_are_refused() {
        let points = PointColumns {
            position: &[Vec3::X, Vec3::Y],
            position_in_sensor: &[Vec3::X, Vec3::Y],
            normal: &[Vec3::X],
            ..PointColumns::default()
        };
        for format in FORMATS {
            let mut file = Cursor::new(Vec::new());
            let message = write_points(&points, format, &mut file).unwrap_err().to_string();
            assert_eq!(message, "normal has 1 entries, expected 2, as many as there are points");
            assert!(file.get_ref().is_empty());
        }
    }
}
