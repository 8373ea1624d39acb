//! Rows of arrays, frame by frame.

use glam::Vec3;

use super::archive::{Archive, Array, Numbers};
use super::frames::FrameRadii;
use crate::ImportError;
use crate::job::Job;

/// Frames that an array without any numbers may have: nothing else bounds them.
const EMPTY_FRAME_LIMIT: usize = 1 << 20;

/// Values of each frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rows<T> {
    /// The same in all frames.
    Same(Vec<T>),
    /// Those of frame i are `values[starts[i]..starts[i + 1]]`.
    Framed {
        /// Of all frames.
        values: Vec<T>,
        /// One more than there are frames, never decreasing, none beyond `values`.
        starts: Vec<usize>,
    },
}

impl<T> Default for Rows<T> {
    fn default() -> Self {
        Self::Same(Vec::new())
    }
}

impl<T> Rows<T> {
    /// Number of frames, if frames differ.
    pub(super) fn frame_count(&self) -> Option<usize> {
        match self {
            Self::Same(_) => None,
            Self::Framed { starts, .. } => Some(starts.len() - 1),
        }
    }

    /// The values of a frame.
    pub(super) fn frame(&self, frame_idx: usize) -> &[T] {
        match self {
            Self::Same(values) => values,
            Self::Framed { values, starts } => &values[starts[frame_idx]..starts[frame_idx + 1]],
        }
    }

    /// The values of all frames, or those that all share.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[T]> {
        (0..self.frame_count().unwrap_or(1)).map(|frame_idx| self.frame(frame_idx))
    }
}

/// The points of an array, if it is there.
pub(super) fn vectors(
    name: &str,
    offsets_name: &str,
    archive: &mut Archive<'_>,
    job: &Job<'_>,
) -> Result<Option<Rows<Vec3>>, ImportError> {
    let Some(array) = archive.get(name, job)? else { return Ok(None) };
    let numbers = array.floats(job)?;
    let offsets = archive.get(offsets_name, job)?;
    triples(&array, &numbers, offsets, job).map(|rows| Some(rows.map_values(Vec3::from)))
}

/// The array `triangles`, if it is there. Negative numbers become large ones.
pub(super) fn triangles(
    archive: &mut Archive<'_>,
    job: &Job<'_>,
) -> Result<Option<Rows<[u32; 3]>>, ImportError> {
    let Some(array) = archive.get("triangles", job)? else { return Ok(None) };
    let numbers = array.whole_numbers(job)?;
    let offsets = archive.get("triangle_offsets", job)?;
    let rows = triples(&array, &numbers, offsets, job)?;
    let index = |idx: i64| u32::try_from(idx).unwrap_or(u32::MAX);
    Ok(Some(rows.map_values(|corners: [i64; 3]| corners.map(index))))
}

/// The array `radii`, if it is there: a number for all, or as many as there are centres.
pub(super) fn radii(
    centers: &Rows<Vec3>,
    archive: &mut Archive<'_>,
    job: &Job<'_>,
) -> Result<Option<FrameRadii>, ImportError> {
    let Some(array) = archive.get("radii", job)? else { return Ok(None) };
    let Numbers { values, shape } = array.floats(job)?;
    if let (&[radius], [] | [1]) = (values.as_slice(), shape.as_slice()) {
        return Ok(Some(FrameRadii::All(radius)));
    }
    let rows = match centers {
        Rows::Framed { values: all, starts } if values.len() == all.len() => {
            Rows::Framed { values, starts: starts.clone() }
        }
        _ if centers.iter().all(|centers| centers.len() == values.len()) => Rows::Same(values),
        _ => {
            let found = format!("the shape {}", shape_text(&shape));
            return Err(array.invalid(found, "a number, or one for each of the centers", job));
        }
    };
    Ok(Some(FrameRadii::Each(rows)))
}

/// Rows of three: of all frames, frame by frame, or cut at offsets.
fn triples<T: Copy>(
    array: &Array,
    numbers: &Numbers<T>,
    offsets: Option<Array>,
    job: &Job<'_>,
) -> Result<Rows<[T; 3]>, ImportError> {
    let values: Vec<[T; 3]> = numbers.values.as_chunks().0.to_vec();
    match (numbers.shape.as_slice(), offsets) {
        ([_, 3], None) => Ok(Rows::Same(values)),
        ([frame_count, 0, 3], None) if *frame_count > EMPTY_FRAME_LIMIT => {
            let found = format!("{frame_count} frames without rows");
            Err(array.invalid(found, &format!("at most {EMPTY_FRAME_LIMIT}"), job))
        }
        ([frame_count, row_count, 3], None) if *frame_count > 0 => {
            let starts = (0..=*frame_count).map(|frame_idx| frame_idx * row_count).collect();
            Ok(Rows::Framed { values, starts })
        }
        ([row_count, 3], Some(offsets)) => {
            let starts = starts(&offsets, *row_count, job)?;
            Ok(Rows::Framed { values, starts })
        }
        (shape, offsets) => {
            let expected = match offsets {
                Some(_) => "(sum, 3), as there are offsets",
                None => "(frames, rows, 3) or (rows, 3), one frame at least",
            };
            let found = format!("the shape {}", shape_text(shape));
            Err(array.invalid(found, expected, job))
        }
    }
}

/// Offsets as positions of rows.
fn starts(offsets: &Array, row_count: usize, job: &Job<'_>) -> Result<Vec<usize>, ImportError> {
    let Numbers { values, shape } = offsets.whole_numbers(job)?;
    let starts = values.iter().map(|&start| usize::try_from(start).ok());
    let starts = starts.collect::<Option<Vec<usize>>>().filter(|starts| {
        let ends = (starts.first(), starts.last());
        shape.len() == 1
            && starts.len() > 1
            && starts.is_sorted()
            && ends == (Some(&0), Some(&row_count))
    });
    starts.ok_or_else(|| {
        let found = match values.iter().zip(values.iter().skip(1)).find(|(a, b)| a > b) {
            Some((before, after)) => format!("{after} after {before}"),
            None => {
                let [first, last] = [values.first(), values.last()];
                let [first, last] = [first, last].map(|end| end.copied().unwrap_or_default());
                format!("{first} to {last} in the shape {}", shape_text(&shape))
            }
        };
        let expected =
            format!("rising from 0 to {row_count}, the number of rows, one more than frames");
        offsets.invalid(found, &expected, job)
    })
}

impl<T: Copy> Rows<[T; 3]> {
    fn map_values<U>(self, convert: impl Fn([T; 3]) -> U) -> Rows<U> {
        match self {
            Self::Same(values) => Rows::Same(values.into_iter().map(convert).collect()),
            Self::Framed { values, starts } => {
                Rows::Framed { values: values.into_iter().map(convert).collect(), starts }
            }
        }
    }
}

/// A shape as Python writes it.
fn shape_text(shape: &[usize]) -> String {
    let words: Vec<String> = shape.iter().map(ToString::to_string).collect();
    match words.as_slice() {
        [only] => format!("({only},)"),
        _ => format!("({})", words.join(", ")),
    }
}
