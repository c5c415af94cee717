//! Conditions of a measurement: the machine, the build, and the system load. Times are meaningless without them.

use serde::Serialize;
use sysinfo::{CpuRefreshKind, RefreshKind, System};

/// Machine, build, and system load during a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Operating system and processor architecture.
    pub(crate) platform: String,
    /// Model name of the processor; `None` where the system does not report it.
    pub(crate) processor: Option<String>,
    /// Number of hardware threads.
    pub(crate) threads: usize,
    /// Load average over one minute when the measurement began, in runnable processes; `None` where the system does not
    /// report it.
    pub(crate) load_at_start: Option<f64>,
    /// Load average over one minute when the measurement ended; `None` before that.
    pub(crate) load_at_end: Option<f64>,
    /// Whether the build is optimised; times of debug builds are not representative.
    pub(crate) optimized: bool,
    /// Package version of the Rasterscope build that ran the measurement.
    pub(crate) version: &'static str,
}

impl Machine {
    /// Describes the machine and the build, with the current load as the load at the start of the measurement.
    pub fn at_start() -> Self {
        Self {
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            processor: processor(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            load_at_start: load_average(),
            load_at_end: None,
            optimized: !cfg!(debug_assertions),
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// Records the current load average as the load at the end of the measurement.
    pub fn at_end(self) -> Self {
        Self { load_at_end: load_average(), ..self }
    }

    /// Returns processor, hardware threads, platform, build and load as one line without a full stop.
    pub fn summary(&self) -> String {
        let processor = self.processor.as_deref().unwrap_or("unknown processor");
        let build = if self.optimized { "" } else { ", not optimized" };
        let load = match (self.load_at_start, self.load_at_end) {
            (Some(start), Some(end)) => format!(", load average {start:.2} at the start and {end:.2} at the end"),
            (Some(load), None) | (None, Some(load)) => format!(", load average {load:.2}"),
            (None, None) => String::new(),
        };
        format!("{processor}, {} threads, {}{build}{load}", self.threads, self.platform)
    }
}

/// Returns the model name of the processor; `None` where the system does not report it.
fn processor() -> Option<String> {
    let system = System::new_with_specifics(RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing())).ok()?;
    let name = system.cpus().first()?.brand().trim();
    (!name.is_empty()).then(|| name.to_owned())
}

/// Returns the load average over the last minute; `None` where the system does not report it.
fn load_average() -> Option<f64> {
    System::load_average().ok().map(|load| load.one)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_names_the_processor_and_the_load_at_both_ends() {
        let machine = Machine {
            processor: Some("Example 9000".to_owned()),
            threads: 2,
            load_at_start: Some(0.5),
            optimized: true,
            ..Machine::at_start()
        };
        assert!(machine.summary().starts_with("Example 9000, 2 threads, "), "{}", machine.summary());
        assert!(machine.summary().ends_with(", load average 0.50"), "{}", machine.summary());
        let ended = Machine { load_at_end: Some(1.25), ..machine };
        assert!(ended.summary().ends_with("load average 0.50 at the start and 1.25 at the end"), "{}", ended.summary());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_final_load_is_known_only_after_the_measurement() {
        let started = Machine::at_start();
        assert!(started.load_at_start.is_some() && started.load_at_end.is_none());
        assert!(started.at_end().load_at_end.is_some_and(|load| load >= 0.0));
    }
}
