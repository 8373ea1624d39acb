//! `rayflock sense`: plan, sweeps, files, a picture and a summary.

mod output;
mod pattern;
mod picture;
mod plan;
mod scan;
mod summary;
mod work;

use crate::args::SenseArguments;
use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::terminal;

use plan::SensePlan;
use work::Work;

/// Plans the sweeps, then carries them out.
pub(super) fn run(args: &SenseArguments) -> Result<(), Failure> {
    let plan = SensePlan::new(args)?;
    let engine = args.engine.create().blame_input()?;
    for warning in &plan.input.warnings {
        terminal::say(format_args!("warning: {warning}"));
    }
    plan.check_output().blame_output()?;

    let interrupt = Interrupt::listen().blame_output()?;
    let mut work = Work::new(&plan, engine).blame_input()?;
    work.sweep_all(&interrupt)?;
    terminal::answer(&summary::format(&plan, work.effort())).blame_output()
}
