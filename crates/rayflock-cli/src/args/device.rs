//! What renders whole frames.

use std::fmt;
use std::str::FromStr;

#[cfg(feature = "gpu")]
use rayflock::gpu::AdapterChoice;

const CPU: &str = "cpu";
const GPU: &str = "gpu";

/// What renders whole frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Device {
    /// The processor, with rays traced by the engine that is asked for.
    #[default]
    Cpu,
    /// A graphics card.
    #[cfg(feature = "gpu")]
    Gpu(AdapterChoice),
}

impl FromStr for Device {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, adapter) = match text.split_once(':') {
            Some((name, adapter)) => (name, Some(adapter)),
            None => (text, None),
        };
        match (name, adapter) {
            (CPU, None) => Ok(Self::Cpu),
            (GPU, adapter) => gpu(adapter),
            _ => Err(format!("\"{text}\" is no device; expected cpu, gpu or gpu:ADAPTER")),
        }
    }
}

#[cfg(feature = "gpu")]
fn gpu(adapter: Option<&str>) -> Result<Device, String> {
    let choice = adapter.map_or(Ok(AdapterChoice::Best), str::parse);
    choice.map(Device::Gpu).map_err(|error| error.to_string())
}

#[cfg(not(feature = "gpu"))]
fn gpu(_: Option<&str>) -> Result<Device, String> {
    Err("this program cannot use graphics cards; build one that can with --features gpu".to_owned())
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cpu => f.write_str(CPU),
            #[cfg(feature = "gpu")]
            Self::Gpu(AdapterChoice::Best) => f.write_str(GPU),
            #[cfg(feature = "gpu")]
            Self::Gpu(adapter) => write!(f, "{GPU}:{adapter}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_parsed_as_they_are_printed() {
        let texts = if cfg!(feature = "gpu") { &["cpu", "gpu", "gpu:1"][..] } else { &["cpu"] };
        for &text in texts {
            assert_eq!(text.parse::<Device>().unwrap().to_string(), text);
        }
        for text in ["", "cpu:1", "card"] {
            let message = text.parse::<Device>().unwrap_err();
            assert!(message.contains("expected cpu, gpu or gpu:ADAPTER"), "{message}");
        }
    }

    #[cfg(not(feature = "gpu"))]
    #[test]
    fn a_program_without_the_graphics_card_says_how_to_build_it_in() {
        assert!("gpu:1".parse::<Device>().unwrap_err().contains("--features gpu"));
    }
}
