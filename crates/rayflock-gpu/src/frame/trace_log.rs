//! What each trace of a picture counted, kept on the device until the picture is done.

use rayflock_engine::Budget;
use wgpu::{Buffer, BufferUsages, CommandEncoder};

use super::buffers::WaveCounts;
use crate::buffer::{GrowingBuffer, ReadBack};
use crate::compute::{pairs_needed, tests_of};
use crate::layout::{Counters, ScanCounters};
use crate::method::TestCounts;
use crate::{GpuContext, GpuError};

/// What is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Traced {
    Primary,
    Secondary,
    Shadow,
}

/// How it was found out what rays hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// By the stages of `gpu:compute`, the first of which takes so many cone tests.
    Traced(usize),
    /// By scan conversion, which counts single tests.
    Scanned,
}

/// Counters of the traces of a sample, in their order.
#[derive(Debug)]
pub(super) struct TraceLog {
    buffer: GrowingBuffer,
    /// What is traced, and how.
    asked: Vec<(Traced, Asked)>,
}

/// What one trace counted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Logged {
    pub(super) traced: Traced,
    pub(super) asked: Asked,
    counters: Counters,
    /// As they were when it was traced: rays of the wave, and those towards its light.
    pub(super) counts: WaveCounts,
}

/// Bytes of an entry, and where the counts begin in it.
const COUNTS_OFFSET: usize = size_of::<Counters>();
const SCAN_BYTES: usize = size_of::<ScanCounters>();
const ENTRY_BYTES: usize = COUNTS_OFFSET + size_of::<WaveCounts>();

impl Logged {
    pub(super) fn tests(&self) -> TestCounts {
        let counters = &self.counters;
        match self.asked {
            Asked::Traced(cone_tests) => tests_of(cone_tests, counters),
            Asked::Scanned => {
                let ScanCounters { triangle_tests, sphere_tests } =
                    bytemuck::pod_read_unaligned(&bytemuck::bytes_of(counters)[..SCAN_BYTES]);
                TestCounts {
                    triangles: triangle_tests.into(),
                    spheres: sphere_tests.into(),
                    ..TestCounts::default()
                }
            }
        }
    }

    /// Pairs that a buffer has to hold.
    pub(super) fn pairs_needed(&self) -> usize {
        match self.asked {
            Asked::Traced(_) => pairs_needed(&self.counters),
            Asked::Scanned => 0,
        }
    }
}

impl TraceLog {
    pub(super) const fn new() -> Self {
        let buffer = GrowingBuffer::new("trace log", BufferUsages::empty());
        Self { buffer, asked: Vec::new() }
    }

    /// Begins anew, with room for so many traces.
    pub(super) fn begin(&mut self, context: &GpuContext, most: usize) {
        self.asked.clear();
        self.buffer.reserve(context, most * ENTRY_BYTES);
    }

    /// Keeps the counters of a trace and the counts of its wave as they are then.
    pub(super) fn add(
        &mut self,
        encoder: &mut CommandEncoder,
        traced: Traced,
        asked: Asked,
        [counters, counts]: [&Buffer; 2],
    ) {
        let offset = (self.asked.len() * ENTRY_BYTES) as u64;
        let log = self.buffer.buffer();
        let bytes = size_of::<Counters>() as u64;
        encoder.copy_buffer_to_buffer(counters, 0, log, offset, Some(bytes));
        let (offset, bytes) = (offset + COUNTS_OFFSET as u64, size_of::<WaveCounts>() as u64);
        encoder.copy_buffer_to_buffer(counts, 0, log, offset, Some(bytes));
        self.asked.push((traced, asked));
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        self.buffer.hold(budget);
    }

    /// Waits for all that was added.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(super) fn read(
        &self,
        context: &GpuContext,
        read_back: &mut ReadBack,
    ) -> Result<Vec<Logged>, GpuError> {
        let mut logged = Vec::new();
        if self.asked.is_empty() {
            return Ok(logged);
        }
        let bytes = self.asked.len() * ENTRY_BYTES;
        let target = read_back.target(context, bytes);
        let mut encoder = context.device.create_command_encoder(&Default::default());
        let log = self.buffer.buffer();
        encoder.copy_buffer_to_buffer(log, 0, &target, 0, Some(bytes as u64));
        read_back.run(context, encoder, bytes, |bytes| {
            let entries = bytes.chunks_exact(ENTRY_BYTES).zip(&self.asked);
            logged.extend(entries.map(|(entry, &(traced, asked))| {
                let (counters, counts) = entry.split_at(COUNTS_OFFSET);
                let counters = bytemuck::pod_read_unaligned(counters);
                Logged { traced, asked, counters, counts: bytemuck::pod_read_unaligned(counts) }
            }));
        })?;
        Ok(logged)
    }
}
