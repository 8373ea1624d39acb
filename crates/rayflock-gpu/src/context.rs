//! An open graphics device: what every stage works on.
//!
//! **Invariants.** Devices are opened with the limits that WebGPU guarantees, whatever the adapter
//! has, so that what works here works everywhere. A device that fails never panics: the first
//! fault is kept, and [`GpuContext::check`] tells it.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use wgpu::{Adapter, Device, DeviceDescriptor, Features, Limits, Queue};

use crate::adapter::{AdapterSummary, choose};
use crate::{AdapterChoice, GpuError};

/// An open graphics device.
pub struct GpuContext {
    adapter: AdapterSummary,
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    fault: Arc<Fault>,
}

/// The first thing that went wrong on a device, told by the driver on a thread of its choice.
#[derive(Debug, Default)]
struct Fault(Mutex<Option<String>>);

impl Fault {
    fn note(&self, reason: String) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(reason);
    }

    fn get(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl GpuContext {
    /// Opens an adapter.
    ///
    /// # Errors
    /// [`GpuError`] when there is none, or it cannot be used.
    pub fn new(choice: AdapterChoice) -> Result<Arc<Self>, GpuError> {
        let adapter = choose(choice)?;
        let summary = AdapterSummary::new(&adapter);
        check_limits(&adapter, &summary)?;
        let descriptor = DeviceDescriptor {
            required_limits: Limits::default(),
            // Only what is told of stages depends on it.
            required_features: adapter.features() & Features::TIMESTAMP_QUERY,
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = opened.map_err(|error| GpuError::NoDevice {
            adapter: summary.name.clone(),
            reason: error.to_string(),
        })?;

        let fault = Arc::new(Fault::default());
        let (uncaptured, lost) = (Arc::clone(&fault), Arc::clone(&fault));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            uncaptured.note(error.to_string());
        }));
        device.set_device_lost_callback(move |reason, message| {
            lost.note(format!("{reason:?} {message}").trim().to_owned());
        });
        Ok(Arc::new(Self { adapter: summary, device, queue, fault }))
    }

    /// What the device runs on.
    pub const fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// Gives the device up, as its loss would: what is asked of it afterwards fails.
    pub fn destroy(&self) {
        self.device.destroy();
        self.note("it was given up".to_owned());
    }

    /// Tells what went wrong, if anything did.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        match self.fault.get() {
            Some(reason) => Err(GpuError::Lost { adapter: self.adapter.name.clone(), reason }),
            None => Ok(()),
        }
    }

    /// Keeps a fault that the driver did not tell by itself.
    pub(crate) fn note(&self, reason: String) {
        self.fault.note(reason);
    }
}

impl fmt::Debug for GpuContext {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuContext").field("adapter", &self.adapter).finish_non_exhaustive()
    }
}

/// Whether the adapter has what WebGPU guarantees.
fn check_limits(adapter: &Adapter, summary: &AdapterSummary) -> Result<(), GpuError> {
    let mut wrong = None;
    let found = adapter.limits();
    Limits::default().check_limits_with_fail_fn(&found, false, |limit, expected, found| {
        wrong.get_or_insert(GpuError::TooSmall {
            adapter: summary.name.clone(),
            limit: limit.to_owned(),
            found,
            expected,
        });
    });
    wrong.map_or(Ok(()), Err)
}
