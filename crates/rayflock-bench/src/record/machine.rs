//! What a benchmark ran on.

use rayflock::geom::simd::SimdLevel;
use serde::{Deserialize, Serialize};
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

/// What a benchmark ran on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Operating system.
    pub os: String,
    /// Architecture of the processor.
    pub arch: String,
    /// The processor as it names itself.
    pub cpu: String,
    /// Logical processors.
    pub cores: usize,
    /// Memory in GiB, rounded.
    pub memory_gib: u64,
    /// The instruction set of the kernels.
    pub simd: String,
}

impl Machine {
    /// This machine.
    pub fn here() -> Self {
        let what = RefreshKind::nothing()
            .with_cpu(CpuRefreshKind::nothing())
            .with_memory(MemoryRefreshKind::nothing().with_ram());
        let system = System::new_with_specifics(what).ok();
        let system = system.as_ref();
        let cpu = system.and_then(|system| system.cpus().first()).map_or("", |cpu| cpu.brand());
        let memory = system.map_or(0, System::total_memory);
        Self {
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
            cpu: cpu.trim().to_owned(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            memory_gib: (memory as f64 / f64::from(1 << 30)).round() as u64,
            simd: SimdLevel::best().name().to_owned(),
        }
    }

    /// The name of the folder that keeps records of machines like this one: processor, number
    /// of cores and instruction set in lower case, words joined by hyphens.
    pub fn class(&self) -> String {
        let text = format!("{} {} cores {}", self.cpu, self.cores, self.simd).to_lowercase();
        let words =
            text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join("-")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machine_has_a_processor_memory_and_a_class_that_can_be_a_folder() {
        let machine = Machine::here();
        assert!(machine.cores > 0 && machine.memory_gib > 0, "{machine:?}");
        let class = Machine {
            cpu: "Some CPU(tm) 9-core / @2.1".to_owned(),
            cores: 2,
            simd: "AVX-512".to_owned(),
            ..machine
        }
        .class();
        assert_eq!(class, "some-cpu-tm-9-core-2-1-2-cores-avx-512");
    }
}
