//! `rayflock sun`: plan, hours, files, a picture and a summary.

mod hours;
mod measure;
mod output;
mod picture;
mod plan;
mod summary;

use crate::args::SunArguments;
use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::terminal;

use measure::Study;
use plan::SunPlan;

/// Plans the study, then carries it out.
pub(super) fn run(args: &SunArguments) -> Result<(), Failure> {
    let plan = SunPlan::new(args)?;
    let engine = args.engine.create().blame_input()?;
    for warning in &plan.input.warnings {
        terminal::say(format_args!("warning: {warning}"));
    }
    plan.check_output().blame_output()?;

    let interrupt = Interrupt::listen().blame_output()?;
    if plan.steps.is_empty() {
        terminal::say(format_args!("note: {}", summary::NO_SUN));
    }
    let mut study = Study::new(&plan, engine)?;
    study.measure(&interrupt)?;
    let hours = study.finish();
    for output in &plan.outputs {
        output.write(&hours).blame_output()?;
    }
    if let Some(picture) = &plan.picture {
        study.draw(picture, &hours)?;
    }
    terminal::answer(&summary::format(&plan, &hours, study.effort())).blame_output()
}
