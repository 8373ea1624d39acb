//! `rayflock info`: what is in a scene, what moves how, and what is wrong with it; or the graphics
//! adapters ([`devices`]).

mod report;
mod text;

use super::devices;
use crate::args::InfoArguments;
use crate::failure::{Blame, Failure};
use crate::terminal;

use report::Report;

/// Prints the report, as text or as one JSON object.
pub(super) fn run(args: &InfoArguments) -> Result<(), Failure> {
    // One of both, as clap sees to.
    let Some(input) = &args.input else { return devices::run(args.json) };
    let report = Report::new(input, args.clip.as_deref()).blame_input()?;
    let text = if args.json {
        serde_json::to_string_pretty(&report).blame_output()? + "\n"
    } else {
        text::format(&report)
    };
    terminal::answer(&text).blame_output()
}
