//! Why hours of sun cannot be told.

use jiff::civil::Date;
use rayflock_engine::EngineError;
use thiserror::Error;

/// Why hours of sun cannot be told.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SunError {
    /// A place that is not on Earth.
    #[error("the {angle} is {found} degrees, expected {expected}")]
    Place {
        /// Latitude or longitude.
        angle: &'static str,
        /// Its value in degrees.
        found: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// The days run backward.
    #[error("the last day, {last}, lies before the first, {first}")]
    Dates {
        /// The first day.
        first: Date,
        /// The last day.
        last: Date,
    },
    /// The hours of the day are none, or too many.
    #[error(
        "the hours run from minute {from} to minute {to} of the day, expected the first to be \
         less than the second, and that at most 1440"
    )]
    Hours {
        /// The first minute.
        from: u32,
        /// The minute after the last.
        to: u32,
    },
    /// An instant outside the years that can be computed.
    #[error("the sun's position on {when} is not known: {reason}")]
    Position {
        /// The instant or day.
        when: String,
        /// What the computation says.
        reason: String,
    },
    /// There is nothing to shine on.
    #[error("found no triangles, expected some for the sun to shine on")]
    NoTriangles,
    /// More vertices than numbers for them.
    #[error("found {found} vertices, expected at most {max}", max = u32::MAX)]
    TooManyVertices {
        /// Vertices of all objects.
        found: usize,
    },
    /// A frame has other samples than the first.
    #[error(
        "found {found} {what}, expected {expected} as in the first frame: hours are added up for \
         each of them, so they must stay the same from frame to frame"
    )]
    Topology {
        /// Faces or vertices.
        what: &'static str,
        /// How many the frame has.
        found: usize,
        /// How many the first frame had.
        expected: usize,
    },
    /// The engine cannot hold the geometry.
    #[error(transparent)]
    Engine(#[from] EngineError),
}
