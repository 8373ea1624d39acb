//! `rayflock info --devices`: the graphics adapters of this machine.

use anyhow::Result;
use serde::Serialize;

use crate::failure::{Blame, Failure};
use crate::terminal;

/// A graphics adapter.
#[derive(Debug, Serialize)]
struct DeviceReport {
    /// Its number, for `--engine gpu:compute@NUMBER`.
    number: usize,
    /// Name of the card.
    name: String,
    /// What it is: discrete, integrated, virtual, software, or other.
    kind: &'static str,
    /// Interface to the driver.
    interface: String,
    /// Name and version of the driver.
    driver: String,
}

/// Prints the adapters, as text or as one JSON array.
pub(super) fn run(as_json: bool) -> Result<(), Failure> {
    let text = report(as_json).blame_input()?;
    terminal::answer(&text).blame_output()
}

fn report(as_json: bool) -> Result<String> {
    let devices = list()?;
    if as_json {
        return Ok(serde_json::to_string_pretty(&devices)? + "\n");
    }
    if devices.is_empty() {
        return Ok("no graphics adapter was found\n".to_owned());
    }
    let line = |d: &DeviceReport| {
        format!("{}: {} ({}, {}, driver {})\n", d.number, d.name, d.kind, d.interface, d.driver)
    };
    Ok(devices.iter().map(line).collect())
}

#[cfg(feature = "gpu")]
fn list() -> Result<Vec<DeviceReport>> {
    let adapters = rayflock::gpu::list_adapters().into_iter().enumerate();
    let report = |(number, adapter): (usize, rayflock::gpu::AdapterSummary)| DeviceReport {
        number,
        name: adapter.name,
        kind: adapter.kind,
        interface: adapter.interface,
        driver: adapter.driver,
    };
    Ok(adapters.map(report).collect())
}

#[cfg(not(feature = "gpu"))]
fn list() -> Result<Vec<DeviceReport>> {
    anyhow::bail!("this program cannot use graphics cards; build one that can with --features gpu")
}
