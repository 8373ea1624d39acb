//! The devices that tests share, and the engines on them.

use std::sync::{Arc, OnceLock};

use rayflock_gpu::{AdapterChoice, GpuContext, GpuEngine, GpuEngineKind, list_adapters};

/// A device on each adapter.
pub(crate) fn contexts() -> &'static [Arc<GpuContext>] {
    static CONTEXTS: OnceLock<Vec<Arc<GpuContext>>> = OnceLock::new();
    CONTEXTS.get_or_init(|| {
        let adapter_count = list_adapters().len();
        let required = std::env::var("RAYFLOCK_GPU_ADAPTERS").map_or(0, |text| {
            text.parse().expect("RAYFLOCK_GPU_ADAPTERS must be a number of adapters")
        });
        assert!(adapter_count >= required, "{adapter_count} adapters, {required} are required");
        if adapter_count == 0 {
            eprintln!("skipped: there is no graphics adapter");
        }
        let open = |number| GpuContext::new(AdapterChoice::Number(number)).unwrap();
        (0..adapter_count).map(open).collect()
    })
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
