//! The devices that tests share, and the engines on them.

use std::sync::{Arc, OnceLock};

use rayflock_gpu::{AdapterChoice, GpuContext, GpuEngine, GpuEngineKind, list_adapters};

/// A device on each adapter, which tests share.
pub(crate) fn contexts() -> &'static [Arc<GpuContext>] {
    static CONTEXTS: OnceLock<Vec<Arc<GpuContext>>> = OnceLock::new();
    CONTEXTS.get_or_init(open_all)
}

/// Opens each adapter, and says which of them cannot be used.
pub(crate) fn open_all() -> Vec<Arc<GpuContext>> {
    let open = |number| {
        let opened = GpuContext::new(AdapterChoice::Number(number));
        opened.inspect_err(|error| eprintln!("skipped: {error}")).ok()
    };
    let opened: Vec<_> = (0..list_adapters().len()).filter_map(open).collect();
    let required = std::env::var("RAYFLOCK_GPU_ADAPTERS").map_or(0, |text| {
        text.parse().expect("RAYFLOCK_GPU_ADAPTERS must be a number of adapters")
    });
    let count = opened.len();
    assert!(count >= required, "{count} adapters can be used, {required} are required");
    if count == 0 {
        eprintln!("skipped: there is no graphics adapter that can be used");
    }
    opened
}

/// Every engine on every device. Says which is next, so that a failure tells.
pub(crate) fn engines() -> impl Iterator<Item = GpuEngine> {
    let pairs = contexts()
        .iter()
        .flat_map(|context| GpuEngineKind::ALL.into_iter().map(move |kind| (kind, context)));
    pairs.map(|(kind, context)| {
        eprintln!("{kind} on {}", context.adapter());
        GpuEngine::new(kind, context).unwrap()
    })
}
