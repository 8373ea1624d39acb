//! `rayflock bench compare` and `rayflock bench report`: what records say.

use rayflock_bench::compare::Comparison;
use rayflock_bench::record::Record;
use rayflock_bench::table;

use super::output;
use crate::args::{BenchCompareArguments, BenchReportArguments};
use crate::failure::{Blame, Failure};
use crate::terminal;

/// Tells what has changed between two records.
pub(super) fn compare(args: &BenchCompareArguments) -> Result<(), Failure> {
    let old = Record::read(&args.old).blame_input()?;
    let new = Record::read(&args.new).blame_input()?;
    terminal::answer(&Comparison::new(&old, &new).text()).blame_output()
}

/// Tells what a record says, on standard output and in files.
pub(super) fn report(args: &BenchReportArguments) -> Result<(), Failure> {
    let record = Record::read(&args.record).blame_input()?;
    output::check(&args.output)?;
    output::write(&args.output, &record)?;
    terminal::answer(&table::format(&record)).blame_output()
}
