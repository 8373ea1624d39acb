//! Buffers that grow, and the way back from the device.

use rayflock_engine::Budget;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindingResource, Buffer,
    BufferBinding, BufferDescriptor, BufferSize, BufferUsages, CommandEncoder, MapMode, PollType,
};

use crate::layout::DeviceHit;
use crate::{GpuContext, GpuError};

/// The least size of a buffer, in bytes: what a uniform of a few numbers takes.
const SMALLEST: u64 = 256;

/// Bytes of the counts of workgroups by which a stage is dispatched.
pub(crate) const DISPATCH_BYTES: usize = 12;

/// Where hits lie in what is read back, behind the counters.
const HITS_OFFSET: usize = 256;

/// A buffer that is made anew, twice as large at least, when it is too small. What it held is
/// lost then.
#[derive(Debug)]
pub(crate) struct GrowingBuffer {
    label: &'static str,
    usage: BufferUsages,
    buffer: Option<Buffer>,
}

impl GrowingBuffer {
    /// A buffer that takes no memory yet. Data can be copied to and from it, whatever its usage.
    pub(crate) const fn new(label: &'static str, usage: BufferUsages) -> Self {
        Self { label, usage, buffer: None }
    }

    /// A buffer that stages read and write.
    pub(crate) const fn storage(label: &'static str) -> Self {
        Self::new(label, BufferUsages::STORAGE)
    }

    /// A buffer for the counts of workgroups by which a stage is dispatched.
    pub(crate) const fn dispatch() -> Self {
        Self::new("dispatch", BufferUsages::STORAGE.union(BufferUsages::INDIRECT))
    }

    /// The buffer, with room for so many bytes.
    pub(crate) fn reserve(&mut self, context: &GpuContext, bytes: usize) -> &Buffer {
        let bytes = bytes as u64;
        if self.size() < bytes {
            self.buffer = None;
        }
        let (label, usage) = (self.label, self.usage);
        self.buffer.get_or_insert_with(|| {
            let size = bytes.next_power_of_two().max(SMALLEST);
            // Reading back goes through buffers that can be mapped, which may be nothing else.
            let copies = if usage.contains(BufferUsages::MAP_READ) {
                BufferUsages::COPY_DST
            } else {
                BufferUsages::COPY_DST | BufferUsages::COPY_SRC
            };
            context.device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | copies,
                mapped_at_creation: false,
            })
        })
    }

    /// Makes `data` the beginning of the buffer.
    pub(crate) fn write<T: bytemuck::Pod>(&mut self, context: &GpuContext, data: &[T]) -> &Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let buffer = self.reserve(context, bytes.len());
        context.queue.write_buffer(buffer, 0, bytes);
        buffer
    }

    /// Writes `data` from `offset` on, where room has been reserved before.
    pub(crate) fn write_at<T: bytemuck::Pod>(
        &self,
        context: &GpuContext,
        offset: usize,
        data: &[T],
    ) {
        context.queue.write_buffer(self.buffer(), offset as u64, bytemuck::cast_slice(data));
    }

    /// The buffer, for which room has been reserved before.
    pub(crate) fn buffer(&self) -> &Buffer {
        let Some(buffer) = &self.buffer else {
            unreachable!("room for \"{}\" is reserved before it is used", self.label)
        };
        buffer
    }

    /// Bytes that there is room for.
    pub(crate) fn size(&self) -> u64 {
        self.buffer.as_ref().map_or(0, Buffer::size)
    }

    /// Tells what the buffer holds.
    pub(crate) fn hold(&self, budget: &mut Budget) {
        budget.hold(self.label, self.size());
    }
}

/// The first `bytes` of a buffer, for a stage.
pub(crate) fn part_of(buffer: &Buffer, bytes: usize) -> BindingResource<'_> {
    range_of(buffer, 0, bytes)
}

/// So many bytes of a buffer from `offset` on, a multiple of 256.
pub(crate) fn range_of(buffer: &Buffer, offset: usize, bytes: usize) -> BindingResource<'_> {
    let (offset, size) = (offset as u64, BufferSize::new(bytes as u64));
    BindingResource::Buffer(BufferBinding { buffer, offset, size })
}

/// Binds resources by their position.
pub(crate) fn bind(
    context: &GpuContext,
    layout: &BindGroupLayout,
    resources: &[BindingResource<'_>],
) -> BindGroup {
    let numbered = (0..).zip(resources.iter().cloned());
    let entries: Vec<_> =
        numbered.map(|(binding, resource)| BindGroupEntry { binding, resource }).collect();
    context.device.create_bind_group(&BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

/// The way back from the device: a buffer that the host can read.
#[derive(Debug)]
pub(crate) struct ReadBack {
    buffer: GrowingBuffer,
}

impl ReadBack {
    pub(crate) const fn new() -> Self {
        Self { buffer: GrowingBuffer::new("read back", BufferUsages::MAP_READ) }
    }

    /// The buffer, to copy so many bytes to.
    pub(crate) fn target(&mut self, context: &GpuContext, bytes: usize) -> Buffer {
        self.buffer.reserve(context, bytes).clone()
    }

    /// Runs what is encoded, which must write the buffer of [`Self::target`], and hands the first
    /// `bytes` of it to `take`.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(crate) fn run(
        &mut self,
        context: &GpuContext,
        encoder: CommandEncoder,
        bytes: usize,
        take: impl FnOnce(&[u8]),
    ) -> Result<(), GpuError> {
        let buffer = self.buffer.reserve(context, bytes).clone();
        context.queue.submit([encoder.finish()]);
        context.check()?;
        // What goes wrong is told by the mapped range.
        buffer.map_async(MapMode::Read, ..bytes as u64, |_| {});
        if let Err(error) = context.device.poll(PollType::wait_indefinitely()) {
            context.note(error.to_string());
        }
        context.check()?;
        match buffer.get_mapped_range(..bytes as u64) {
            Ok(range) => take(&range),
            Err(error) => context.note(error.to_string()),
        }
        buffer.unmap();
        context.check()
    }

    /// Runs what is encoded, and reads counters and the first hits.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(crate) fn run_for_hits<Counters: bytemuck::Pod>(
        &mut self,
        context: &GpuContext,
        mut encoder: CommandEncoder,
        [counters, source]: [&Buffer; 2],
        hits: &mut [DeviceHit],
    ) -> Result<Counters, GpuError> {
        const { assert!(size_of::<Counters>() <= HITS_OFFSET) };
        let (counter_bytes, hit_bytes) = (size_of::<Counters>(), size_of_val(hits));
        let bytes = HITS_OFFSET + hit_bytes;
        let target = self.target(context, bytes);
        let (offset, size) = (HITS_OFFSET as u64, Some(hit_bytes as u64));
        encoder.copy_buffer_to_buffer(counters, 0, &target, 0, Some(counter_bytes as u64));
        encoder.copy_buffer_to_buffer(source, 0, &target, offset, size);
        let mut found = Counters::zeroed();
        self.run(context, encoder, bytes, |bytes| {
            found = bytemuck::pod_read_unaligned(&bytes[..counter_bytes]);
            hits.copy_from_slice(bytemuck::cast_slice(&bytes[HITS_OFFSET..]));
        })?;
        Ok(found)
    }

    /// Runs what is encoded, and reads the number of two words that `source` begins with then.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(crate) fn run_for_number(
        &mut self,
        context: &GpuContext,
        mut encoder: CommandEncoder,
        source: &Buffer,
    ) -> Result<u64, GpuError> {
        const BYTES: usize = size_of::<u64>();
        let target = self.target(context, BYTES);
        encoder.copy_buffer_to_buffer(source, 0, &target, 0, Some(BYTES as u64));
        let mut number = 0;
        let take = |bytes: &[u8]| number = bytemuck::pod_read_unaligned(bytes);
        self.run(context, encoder, BYTES, take)?;
        Ok(number)
    }

    /// Tells what the buffer holds.
    pub(crate) fn hold(&self, budget: &mut Budget) {
        self.buffer.hold(budget);
    }
}
