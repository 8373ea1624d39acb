//! `rayflock bench scaling`: how cost grows with triangles, rays and threads.

use rayflock_bench::contest::Effort;
use rayflock_bench::scaling::{self, ScalingBench};
use rayflock_bench::work::Definition;

use super::watcher::Watcher;
use super::{engines, output};
use crate::args::BenchScalingArguments;
use crate::failure::{Blame, Failure};
use crate::terminal;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchScalingArguments) -> Result<(), Failure> {
    let library = engines::library(&args.engines)?;
    output::check(&args.output)?;
    let mut definition = Definition::default_map();
    definition.triangles.clone_from(&args.triangles);
    definition.rays.clone_from(&args.rays);
    definition.kinds.clone_from(&args.kind);
    let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
    let bench = ScalingBench {
        definition,
        fixed_triangles: args.fixed_triangles,
        fixed_rays: args.fixed_rays,
        threads: doubled_up_to(rayon::current_num_threads()),
        setup: engines::setup(&args.engines, library, effort),
    };

    let mut watcher = Watcher::new("scaling", bench.cell_count().blame_input()?)?;
    let measured = scaling::measure(&bench, &mut watcher);
    let stopped = watcher.finish();
    let record = measured.blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&scaling::format(&record)).blame_output()?;
    stopped
}

/// 1, 2, 4, ... and `last`.
fn doubled_up_to(last: usize) -> Vec<usize> {
    let doubled = std::iter::successors(Some(1), |&count| Some(2 * count));
    doubled.take_while(|&count| count < last).chain([last]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_number_of_threads_is_always_there() {
        assert_eq!(doubled_up_to(1), [1]);
        assert_eq!(doubled_up_to(2), [1, 2]);
        assert_eq!(doubled_up_to(6), [1, 2, 4, 6]);
    }
}
