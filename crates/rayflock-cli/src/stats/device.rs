//! What a frame took of a graphics device, as `--stats` tells it.

use std::collections::BTreeMap;

use rayflock::engine::Budget;
use serde::{Deserialize, Serialize};

/// What the stages on a device took for one frame, and what is held for them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DeviceRecord {
    /// How stages were timed: by the device's timestamps, or by submissions.
    pub(crate) clock: String,
    /// By name.
    pub(crate) stages: BTreeMap<String, DeviceStage>,
    /// Bytes on either side, by what they hold.
    pub(crate) bytes: BTreeMap<String, u64>,
    /// Bytes of geometry and attributes that went to the device for this frame.
    pub(crate) sent_bytes: u64,
}

/// What one stage took.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DeviceStage {
    /// How often it ran.
    pub(crate) runs: u64,
    /// Milliseconds of the device.
    pub(crate) ms: f64,
}

impl DeviceRecord {
    /// What was counted; none where no device was at work.
    pub(crate) fn new(budget: &Budget) -> Option<Self> {
        let stages = budget.stages.iter().map(|time| {
            let stage = DeviceStage { runs: time.runs, ms: 1e3 * time.seconds };
            (time.name.to_owned(), stage)
        });
        let bytes = budget.buffers.iter().map(|held| (held.name.to_owned(), held.bytes));
        (!budget.is_empty()).then(|| Self {
            clock: budget.clock.name().to_owned(),
            stages: stages.collect(),
            bytes: bytes.collect(),
            sent_bytes: budget.sent_bytes,
        })
    }
}

#[cfg(test)]
mod tests {
    use rayflock::engine::{Clock, StageTime};

    use super::*;

    #[test]
    fn only_devices_have_a_record_and_it_is_told_by_name() {
        assert_eq!(DeviceRecord::new(&Budget::default()), None);
        let mut budget = Budget { clock: Clock::Timestamps, ..Budget::default() };
        budget.stages.push(StageTime { name: "refine", runs: 2, seconds: 0.003 });
        budget.hold("pairs", 64);
        let json = serde_json::to_string(&DeviceRecord::new(&budget)).unwrap();
        let expected = r#"{"clock":"timestamps","stages":{"refine":{"runs":2,"ms":3.0}},"#;
        assert!(json.starts_with(expected) && json.contains(r#""pairs":64"#), "{json}");
    }
}
