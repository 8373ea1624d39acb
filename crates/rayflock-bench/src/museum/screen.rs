//! Finds the settings of Embree that are best for the pictures of a scene.
//!
//! Every setting gets the frame before the first and renders the first, once; the three best in
//! update and tracing then take part like other engines, and the best of them counts.
//!
//! **Cost**: one engine at a time, a picture for each setting.

use super::contestant::Contestant;
use super::{MuseumBench, Stage};
use crate::peer::embree::Setting;
use crate::{BenchError, EngineSpec};

/// Settings that are measured fully.
const FINALIST_COUNT: usize = 3;

/// The best settings, which all go by the name `embree:best`.
pub(super) fn screen(
    bench: &MuseumBench,
    stage: &mut Stage<'_>,
    frame: u32,
) -> Result<Vec<Contestant>, BenchError> {
    let contestant =
        |setting| Contestant::new(EngineSpec::Embree(setting), bench.library.as_ref(), bench.size);
    let mut tried = Vec::new();
    for setting in Setting::all().into_iter().filter(|setting| !setting.robust) {
        let mut one = [contestant(setting)?];
        stage.render(bench, &mut one, frame)?;
        tried.push((setting, one[0].mean_total_ms()));
    }
    tried.sort_by(|a, b| a.1.total_cmp(&b.1));
    let finalists = tried.into_iter().take(FINALIST_COUNT).map(|(setting, _)| {
        let mut contestant = contestant(setting)?;
        contestant.name = EngineSpec::EmbreeBest.to_string();
        Ok(contestant)
    });
    finalists.collect()
}
