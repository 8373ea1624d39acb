//! Which graphics adapters there are, and which one is meant.

use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

use arrayvec::ArrayString;
use wgpu::{Adapter, Backends, DeviceType, Instance, InstanceDescriptor};

use crate::GpuError;

/// The interfaces to drivers that the engines can work with: GL cannot render to what they need.
const BACKENDS: Backends = Backends::VULKAN.union(Backends::METAL).union(Backends::DX12);

/// Longest part of a name that can be asked for.
const NAME_LENGTH: usize = 64;

/// Which adapter is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AdapterChoice {
    /// The most capable: a card of its own before one within the processor, software last.
    #[default]
    Best,
    /// The one with this number in the list of [`list_adapters`].
    Number(usize),
    /// The first whose name holds this, in any case.
    Named(ArrayString<NAME_LENGTH>),
}

/// The kind of adapters that are no card.
const SOFTWARE: &str = "software";

/// What is known about an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// Name of the card.
    pub name: String,
    /// What it is: discrete, integrated, virtual, software, or other.
    pub kind: &'static str,
    /// Interface to the driver.
    pub interface: String,
    /// Name and version of the driver.
    pub driver: String,
}

impl AdapterSummary {
    pub(crate) fn new(adapter: &Adapter) -> Self {
        let info = adapter.get_info();
        let driver = format!("{} {}", info.driver, info.driver_info);
        let interface = info.backend.to_string();
        let kind = kind_name(info.device_type);
        Self { name: info.name, kind, interface, driver: driver.trim().to_owned() }
    }

    /// Whether a processor stands in for a card.
    pub(crate) fn is_software(&self) -> bool {
        self.kind == SOFTWARE
    }
}

impl fmt::Display for AdapterSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {}, driver {})", self.name, self.kind, self.interface, self.driver)
    }
}

impl FromStr for AdapterChoice {
    type Err = GpuError;

    /// A number, or a part of a name. Digits alone are a number: `1060` is not a part of a name,
    /// but `GTX 1060` is.
    fn from_str(text: &str) -> Result<Self, GpuError> {
        if text.is_empty() {
            return Err(GpuError::EmptyName);
        }
        if let Ok(number) = text.parse() {
            return Ok(Self::Number(number));
        }
        let name = ArrayString::from(text);
        name.map(Self::Named).map_err(|_| GpuError::LongName { found: text.to_owned() })
    }
}

impl fmt::Display for AdapterChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Best => f.write_str("best"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Named(name) => f.write_str(name),
        }
    }
}

/// The adapters of this machine, the most capable first. The position of one is its number.
pub fn list_adapters() -> Vec<AdapterSummary> {
    find_adapters().iter().map(AdapterSummary::new).collect()
}

/// The adapter that is meant.
pub(crate) fn choose(choice: AdapterChoice) -> Result<Adapter, GpuError> {
    let mut adapters = find_adapters();
    if adapters.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    match position(choice, &adapters.iter().map(|a| a.get_info().name).collect::<Vec<_>>()) {
        Some(idx) => Ok(adapters.swap_remove(idx)),
        None => {
            let there = adapters.iter().map(AdapterSummary::new).enumerate();
            let there: Vec<_> = there.map(|(idx, adapter)| format!("{idx}: {adapter}")).collect();
            let there = there.join("; ");
            Err(GpuError::UnknownAdapter { asked: choice.to_string(), there })
        }
    }
}

fn position(choice: AdapterChoice, names: &[String]) -> Option<usize> {
    match choice {
        AdapterChoice::Best => (!names.is_empty()).then_some(0),
        AdapterChoice::Number(number) => (number < names.len()).then_some(number),
        AdapterChoice::Named(part) => {
            let part = part.to_lowercase();
            names.iter().position(|name| name.to_lowercase().contains(&part))
        }
    }
}

fn find_adapters() -> Vec<Adapter> {
    let mut adapters = pollster::block_on(instance().enumerate_adapters(BACKENDS));
    adapters.sort_by_key(|adapter| preference(adapter.get_info().device_type));
    adapters
}

/// The way to all drivers, opened once and kept: with the last one that is closed, drivers are
/// unloaded, and one of them crashed where another thread opened one at that moment.
fn instance() -> &'static Instance {
    static INSTANCE: OnceLock<Instance> = OnceLock::new();
    INSTANCE.get_or_init(|| {
        let mut descriptor = InstanceDescriptor::new_without_display_handle();
        descriptor.backends = BACKENDS;
        Instance::new(descriptor)
    })
}

const fn preference(kind: DeviceType) -> u8 {
    match kind {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    }
}

const fn kind_name(kind: DeviceType) -> &'static str {
    match kind {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Other => "other",
        DeviceType::Cpu => SOFTWARE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adapters_are_chosen_by_number_or_part_of_a_name() {
        let names = ["Big Card".to_owned(), "llvmpipe (LLVM)".to_owned()];
        let find = |text: &str| position(text.parse().unwrap(), &names);
        assert_eq!(position(AdapterChoice::Best, &names), Some(0));
        assert_eq!((find("1"), find("2")), (Some(1), None));
        assert_eq!((find("LLVMpipe"), find("big"), find("swift")), (Some(1), Some(0), None));
        assert_eq!(position(AdapterChoice::Best, &[]), None);
    }

    #[test]
    fn choices_are_parsed_as_they_are_printed() {
        for text in ["3", "llvmpipe"] {
            assert_eq!(text.parse::<AdapterChoice>().unwrap().to_string(), text);
        }
        let message = "x".repeat(65).parse::<AdapterChoice>().unwrap_err().to_string();
        assert!(message.contains("too long for the name of an adapter"), "{message}");
    }
}
