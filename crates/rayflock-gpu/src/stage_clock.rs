//! How long stages take on the device: by its timestamps, where it has them, else by the time from
//! a submission to what comes of it.
//!
//! **Cost.** Two timestamps a pass, and a copy of them back for each run of rays.

use std::time::Instant;

use rayflock_engine::{Budget, Clock, StageTime};
use tracing::debug;
use wgpu::{
    BufferUsages, CommandEncoder, ComputePass, ComputePassDescriptor, ComputePassTimestampWrites,
    Features, QuerySet, QuerySetDescriptor, QueryType, RenderPassTimestampWrites,
};

use crate::buffer::{GrowingBuffer, ReadBack};
use crate::{GpuContext, GpuError};

/// Passes that are timed between two looks at the clock; those beyond are not.
const MOST_PASSES: usize = 1024;

/// Where the time goes that no pass is known to take.
const WHOLE_RUNS: &str = "whole runs";

/// Times of stages since the frame began.
#[derive(Debug)]
pub(crate) struct StageClock {
    /// None where the device has no timestamps.
    timestamps: Option<Timestamps>,
    times: Vec<StageTime>,
}

#[derive(Debug)]
struct Timestamps {
    queries: QuerySet,
    /// The stages of passes whose times have not been read.
    under_way: Vec<&'static str>,
    resolved: GrowingBuffer,
    read_back: ReadBack,
}

impl StageClock {
    pub(crate) fn new(context: &GpuContext) -> Self {
        let has_timestamps = context.device.features().contains(Features::TIMESTAMP_QUERY);
        Self { timestamps: has_timestamps.then(|| Timestamps::new(context)), times: Vec::new() }
    }

    /// Begins to count anew.
    pub(crate) fn begin_frame(&mut self) {
        self.times.clear();
    }

    /// Begins a pass that computes a stage.
    pub(crate) fn compute_pass<'a>(
        &mut self,
        encoder: &'a mut CommandEncoder,
        stage: &'static str,
    ) -> ComputePass<'a> {
        let timed = self.timestamps.as_mut().and_then(|timestamps| timestamps.next(stage));
        let timestamp_writes = timed.map(|(query_set, [begin, end])| ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        });
        encoder.begin_compute_pass(&ComputePassDescriptor { label: Some(stage), timestamp_writes })
    }

    /// What a pass that draws a stage has to be begun with.
    pub(crate) fn render_pass(
        &mut self,
        stage: &'static str,
    ) -> Option<RenderPassTimestampWrites<'_>> {
        let timed = self.timestamps.as_mut()?.next(stage);
        timed.map(|(query_set, [begin, end])| RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        })
    }

    /// Takes the times of all passes that have been submitted. `since` is when the host began to
    /// wait for them.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(crate) fn collect(&mut self, context: &GpuContext, since: Instant) -> Result<(), GpuError> {
        let Some(timestamps) = &mut self.timestamps else {
            add(&mut self.times, WHOLE_RUNS, since.elapsed().as_secs_f64());
            return Ok(());
        };
        timestamps.read(context, &mut self.times)
    }

    /// What was counted.
    pub(crate) fn budget(&self) -> Budget {
        let has_timestamps = self.timestamps.is_some();
        let clock = if has_timestamps { Clock::Timestamps } else { Clock::Submissions };
        Budget { clock, stages: self.times.clone(), ..Budget::default() }
    }
}

impl Timestamps {
    fn new(context: &GpuContext) -> Self {
        let queries = context.device.create_query_set(&QuerySetDescriptor {
            label: Some("stages"),
            ty: QueryType::Timestamp,
            count: 2 * MOST_PASSES as u32,
        });
        Self {
            queries,
            under_way: Vec::new(),
            resolved: GrowingBuffer::new("timestamps", BufferUsages::QUERY_RESOLVE),
            read_back: ReadBack::new(),
        }
    }

    /// The queries of one more pass, if there are any left.
    fn next(&mut self, stage: &'static str) -> Option<(&QuerySet, [u32; 2])> {
        let begin = 2 * self.under_way.len() as u32;
        if self.under_way.len() == MOST_PASSES {
            return None;
        }
        self.under_way.push(stage);
        Some((&self.queries, [begin, begin + 1]))
    }

    fn read(&mut self, context: &GpuContext, times: &mut Vec<StageTime>) -> Result<(), GpuError> {
        let count = 2 * self.under_way.len();
        if count == 0 {
            return Ok(());
        }
        let bytes = count * size_of::<u64>();
        let resolved = self.resolved.reserve(context, bytes);
        let target = self.read_back.target(context, bytes);
        let mut encoder = context.device.create_command_encoder(&Default::default());
        encoder.resolve_query_set(&self.queries, 0..count as u32, resolved, 0);
        encoder.copy_buffer_to_buffer(resolved, 0, &target, 0, Some(bytes as u64));
        let tick = 1e-9 * f64::from(context.queue.get_timestamp_period());
        self.read_back.run(context, encoder, bytes, |bytes| {
            let ticks: Vec<[u64; 2]> = bytemuck::pod_collect_to_vec(bytes);
            for (&stage, [begin, end]) in self.under_way.iter().zip(ticks) {
                let seconds = tick * end.saturating_sub(begin) as f64;
                debug!(stage, milliseconds = 1e3 * seconds, "on the device");
                add(times, stage, seconds);
            }
        })?;
        self.under_way.clear();
        Ok(())
    }
}

fn add(times: &mut Vec<StageTime>, name: &'static str, seconds: f64) {
    match times.iter_mut().find(|time| time.name == name) {
        Some(time) => {
            time.runs += 1;
            time.seconds += seconds;
        }
        None => times.push(StageTime { name, runs: 1, seconds }),
    }
}
