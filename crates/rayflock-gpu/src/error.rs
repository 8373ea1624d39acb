//! Why the graphics card cannot be used.

use thiserror::Error;

/// Why the graphics card cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter at all.
    #[error(
        "no graphics adapter was found (looked for Vulkan, Metal and DX12); install the driver of \
         your card, or a software one such as Mesa's lavapipe (mesa-vulkan-drivers)"
    )]
    NoAdapter,
    /// The adapter asked for is not there.
    #[error("there is no graphics adapter \"{asked}\"; there are: {there}")]
    UnknownAdapter {
        /// What was asked for.
        asked: String,
        /// The adapters, with their numbers.
        there: String,
    },
    /// The name of an adapter is empty.
    #[error("no adapter is named; expected its number, or a part of its name")]
    EmptyName,
    /// The name of an adapter is too long to be kept.
    #[error("\"{found}\" is too long for the name of an adapter; a part of the name will do")]
    LongName {
        /// What was asked for.
        found: String,
    },
    /// There is no engine of this name.
    #[error("unknown engine \"{found}\"; there are: {there}, each with @ADAPTER")]
    UnknownEngine {
        /// What was asked for.
        found: String,
        /// The engines.
        there: String,
    },
    /// The adapter has less than WebGPU guarantees.
    #[error("the adapter {adapter} is too small: {limit} is {found}, expected {expected}")]
    TooSmall {
        /// Its name.
        adapter: String,
        /// Which of its limits.
        limit: String,
        /// What the adapter has.
        found: u64,
        /// What is needed.
        expected: u64,
    },
    /// The adapter gives no device.
    #[error("the adapter {adapter} cannot be opened: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The device failed while it was in use.
    #[error("the graphics device {adapter} was lost: {reason}")]
    Lost {
        /// Its name.
        adapter: String,
        /// What happened.
        reason: String,
    },
}
