//! The devices that the tests of stages share.

use std::sync::{Arc, OnceLock};

use wgpu::Buffer;

use crate::buffer::ReadBack;
use crate::{AdapterChoice, GpuContext, list_adapters};

/// A device on each adapter that can be used; `tests/suite/` makes sure that there are as many as
/// expected.
pub(crate) fn contexts() -> &'static [Arc<GpuContext>] {
    static CONTEXTS: OnceLock<Vec<Arc<GpuContext>>> = OnceLock::new();
    let open = |number| {
        let opened = GpuContext::new(AdapterChoice::Number(number));
        opened.inspect_err(|error| eprintln!("skipped: {error}")).ok()
    };
    CONTEXTS.get_or_init(|| (0..list_adapters().len()).filter_map(open).collect())
}

/// The first `count` entries of a buffer.
pub(crate) fn read<T: bytemuck::Pod>(
    context: &GpuContext,
    buffer: &Buffer,
    count: usize,
) -> Vec<T> {
    let bytes = count * size_of::<T>();
    let mut read_back = ReadBack::new();
    let target = read_back.target(context, bytes);
    let mut encoder = context.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &target, 0, Some(bytes as u64));
    let mut found = Vec::new();
    let take = |bytes: &[u8]| found = bytemuck::pod_collect_to_vec(bytes);
    read_back.run(context, encoder, bytes, take).unwrap();
    found
}

/// Whether numbers of a device are those of the host, within rounding.
pub(crate) fn near(found: &[f32], expected: &[f32]) -> bool {
    found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 3e-5 * (1.0 + b.abs()))
}
