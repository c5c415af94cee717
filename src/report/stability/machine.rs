//! Where a report was made: times mean nothing without it.

use serde::Serialize;

/// A machine and a build.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Operating system and processor architecture.
    pub platform: String,
    /// Name of the processor, where the system tells.
    pub processor: Option<String>,
    /// Threads that run at once.
    pub threads: usize,
    /// Processes that wanted to run in the last minute, on average, where the system tells.
    pub load: Option<f64>,
    /// Whether the program was optimised: times of others say little.
    pub optimized: bool,
    /// Version of this program.
    pub version: &'static str,
}

impl Machine {
    /// The one that this runs on.
    pub fn here() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).ok();
        let named = |line: &str| Some(line.strip_prefix("model name")?.split_once(':')?.1.trim().to_owned());
        Self {
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            processor: read("/proc/cpuinfo").and_then(|text| text.lines().find_map(named)),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            load: read("/proc/loadavg").and_then(|text| text.split_whitespace().next()?.parse().ok()),
            optimized: !cfg!(debug_assertions),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}
