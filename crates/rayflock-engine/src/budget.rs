//! What the stages of an engine took and what its buffers hold, for engines whose stages run on a
//! device, where no profiler of the host sees them.

/// Times by stage since the last commit, and memory by kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Budget {
    /// How stages were timed.
    pub clock: Clock,
    /// In the order in which they first ran.
    pub stages: Vec<StageTime>,
    /// Of the device and of the host.
    pub buffers: Vec<HeldBytes>,
    /// Bytes of geometry and of what it looks like that the last commit sent to the device.
    pub sent_bytes: u64,
}

/// How stages are timed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// They are not.
    #[default]
    None,
    /// By the device, when a stage begins and when it ends.
    Timestamps,
    /// By the host, from handing work over until what comes of it is there: the device cannot tell
    /// stages apart.
    Submissions,
}

/// What a stage took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageTime {
    /// The stage.
    pub name: &'static str,
    /// How often it ran.
    pub runs: u64,
    /// Seconds that it took in all.
    pub seconds: f64,
}

/// What one kind of buffer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeldBytes {
    /// What is held.
    pub name: &'static str,
    /// Bytes.
    pub bytes: u64,
}

impl Budget {
    /// Whether there is nothing to tell.
    pub fn is_empty(&self) -> bool {
        self.stages.is_empty() && self.buffers.is_empty()
    }

    /// Adds to the bytes of a kind.
    pub fn hold(&mut self, name: &'static str, bytes: u64) {
        match self.buffers.iter_mut().find(|held| held.name == name) {
            Some(held) => held.bytes += bytes,
            None => self.buffers.push(HeldBytes { name, bytes }),
        }
    }

    /// Bytes of all kinds.
    pub fn bytes(&self) -> u64 {
        self.buffers.iter().map(|held| held.bytes).sum()
    }
}

impl Clock {
    /// The name, as statistics tell it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Timestamps => "timestamps",
            Self::Submissions => "submissions",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_a_kind_add_up() {
        let mut budget = Budget::default();
        assert!(budget.is_empty());
        for (name, bytes) in [("rays", 3), ("hits", 4), ("rays", 5)] {
            budget.hold(name, bytes);
        }
        assert_eq!(budget.buffers[0], HeldBytes { name: "rays", bytes: 8 });
        assert_eq!((budget.buffers.len(), budget.bytes()), (2, 12));
    }
}
