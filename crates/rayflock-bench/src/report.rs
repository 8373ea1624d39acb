//! A record for people and their programs: a page, Markdown, CSV.
//!
//! | Form | Use it when |
//! |---|---|
//! | [`html`] | somebody reads all of it: one file, no script, no network, light and dark |
//! | [`markdown`] | it goes into a document |
//! | [`csv`](fn@csv) | a program goes on with it: one row a cell and engine |
//!
//! What is said of who is ahead comes from [`crate::ratio`] alone.

mod chart;
mod color;
mod counters;
mod csv;
mod figures;
mod heading;
mod heat;
mod map;
mod markdown;
mod museum;
mod page;
mod scaling;
mod scene;
mod spheres;
#[cfg(test)]
mod tests;
mod times;
mod verdicts;

use crate::BenchError;
use crate::record::Record;

pub use self::csv::csv;
pub use markdown::markdown;

/// The record as one HTML file that needs nothing else.
///
/// # Errors
/// [`BenchError::Draw`] when a chart cannot be drawn.
pub fn html(record: &Record) -> Result<String, BenchError> {
    let content = match record.benchmark.as_str() {
        "museum" => museum::sections(record)?,
        "scaling" => scaling::sections(record)?,
        "scene" => scene::sections(record),
        "spheres" => spheres::sections(record)?,
        _ => map::sections(record),
    };
    Ok(page::page(record, &content).into_string())
}
