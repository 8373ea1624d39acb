//! `rayflock bench map`: triangles x rays x kinds of rays, each with every engine.

use anyhow::Result;
use rayflock_bench::contest::Effort;
use rayflock_bench::map::{self, MapBench};
use rayflock_bench::work::Definition;

use super::watcher::Watcher;
use super::{engines, output};
use crate::args::BenchMapArguments;
use crate::failure::{Blame, Failure};
use crate::terminal;

/// What `--quick` measures of the built-in definition.
const QUICK_TRIANGLES: [usize; 3] = [1 << 10, 1 << 14, 1 << 18];
const QUICK_RAYS: [usize; 2] = [1 << 12, 1 << 18];

/// Measures what the user asked for.
pub(super) fn run(args: &BenchMapArguments) -> Result<(), Failure> {
    let definition = define(args).blame_input()?;
    let library = engines::library(&args.engines)?;
    output::check(&args.output)?;

    let count = definition.triangles.len() * definition.rays.len() * definition.kinds.len();
    let mut watcher = Watcher::new("map", count)?;
    let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
    let bench = MapBench { definition, setup: engines::setup(&args.engines, library, effort) };
    let measured = map::measure(&bench, &mut watcher);
    let stopped = watcher.finish();
    let record = measured.blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&map::format(&record)).blame_output()?;
    stopped
}

/// The definition, with what the user wants instead of its lists.
fn define(args: &BenchMapArguments) -> Result<Definition> {
    let mut definition = match &args.definition {
        Some(path) => Definition::read(path)?,
        None => Definition::default_map(),
    };
    if args.quick && args.definition.is_none() {
        definition.triangles = QUICK_TRIANGLES.to_vec();
        definition.rays = QUICK_RAYS.to_vec();
    }
    replace(&mut definition.triangles, &args.triangles);
    replace(&mut definition.rays, &args.rays);
    replace(&mut definition.kinds, &args.kind);
    Ok(definition)
}

/// Takes what was asked for, each once, if anything was.
fn replace<T: Copy + PartialEq>(listed: &mut Vec<T>, asked: &[T]) {
    if asked.is_empty() {
        return;
    }
    listed.clear();
    for &value in asked {
        if !listed.contains(&value) {
            listed.push(value);
        }
    }
}
