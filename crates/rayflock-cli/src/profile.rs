//! `--trace`: what each thread did when, as a Chrome trace.
//!
//! Crates of the library mark their stages as spans of `tracing`, one a stage and task and none a
//! ray. A subscriber that writes them down is there only while the user wants a profile: without
//! one, a span is one comparison.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;
use tracing::level_filters::LevelFilter;
use tracing_chrome::ChromeLayerBuilder;
use tracing_subscriber::Layer;
use tracing_subscriber::layer::SubscriberExt;

use crate::output::atomic;

/// Does `work`, and writes a profile of it to `path`, if that is wanted: also of work that failed
/// or was stopped. May be asked once a program, since threads of all pools are watched.
pub(crate) fn record<T>(path: Option<&Path>, work: impl FnOnce() -> T) -> Result<T> {
    let Some(path) = path else { return Ok(work()) };
    let mut outcome = None;
    atomic::write_whole(path, |partial| {
        let file = TraceFile { file: File::create(partial)?, failure: Arc::default() };
        let failure = Arc::clone(&file.failure);
        let builder = ChromeLayerBuilder::new().writer(file);
        let (layer, guard) = builder.include_args(true).include_locations(false).build();
        let spans = layer.with_filter(LevelFilter::DEBUG);
        tracing::subscriber::set_global_default(tracing_subscriber::registry().with(spans))?;
        outcome = Some(work());
        drop(guard);
        let failure = failure.lock().unwrap_or_else(PoisonError::into_inner).take();
        failure.map_or(Ok(()), |failure| Err(failure.into()))
    })?;
    let Some(outcome) = outcome else { unreachable!("what was written was recorded") };
    Ok(outcome)
}

/// A file that keeps its first error for the end: the thread that writes the profile would panic.
struct TraceFile {
    file: File,
    failure: Arc<Mutex<Option<io::Error>>>,
}

impl Write for TraceFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        if failure.is_none() {
            *failure = self.file.write_all(bytes).err();
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
