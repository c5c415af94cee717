//! Conditions of a measurement: the machine, the build, and the system load. Times are meaningless without them.

use serde::ser::SerializeMap as _;
use serde::{Deserialize, Serialize, Serializer};
use sysinfo::{CpuRefreshKind, RefreshKind, System};

/// Machine, build, and system load during a measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Host name, which distinguishes machines of the same model in an experiment across several; `None` elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) host: Option<String>,
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
    pub(crate) version: String,
}

impl Machine {
    /// Describes the machine and the build, with the current load as the load at the start of the measurement.
    pub fn at_start() -> Self {
        Self {
            host: None,
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            processor: processor(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            load_at_start: load_average(),
            load_at_end: None,
            optimized: matches!(env!("RASTERSCOPE_OPT_LEVEL"), "2" | "3" | "s" | "z"),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// Records the host name, for experiments that may run on several machines.
    pub fn with_host(self) -> Self {
        Self { host: System::host_name().ok(), ..self }
    }

    /// Records the current load average as the load at the end of the measurement.
    pub fn at_end(self) -> Self {
        Self { load_at_end: load_average(), ..self }
    }

    /// Returns host, processor, hardware threads, platform, build and load as one line without a full stop.
    pub fn summary(&self) -> String {
        let build = if self.optimized { "" } else { ", not optimized" };
        let load = match (self.load_at_start, self.load_at_end) {
            (Some(start), Some(end)) => format!(", load average {start:.2} at the start and {end:.2} at the end"),
            (Some(load), None) | (None, Some(load)) => format!(", load average {load:.2}"),
            (None, None) => String::new(),
        };
        format!("{}, {}{build}{load}", self.label(), self.platform)
    }

    /// Returns the host name, the processor and the number of hardware threads in words.
    fn label(&self) -> String {
        let host = self.host.as_deref().map_or_else(String::new, |host| format!("{host}: "));
        let processor = self.processor.as_deref().unwrap_or("unknown processor");
        format!("{host}{processor}, {} threads", self.threads)
    }

    /// Whether both describe the same machine and build; their loads may differ.
    fn is_same(&self, other: &Self) -> bool {
        let unloaded = |machine: &Self| Self { load_at_start: None, load_at_end: None, ..machine.clone() };
        unloaded(self) == unloaded(other)
    }
}

/// Machines that took part in an experiment, at least one and each once. A single one is serialised as `machine` and has
/// no host name; several are serialised as `machines`. Loads are the highest of all shards that a machine ran.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Machines(Vec<Machine>);

impl Machines {
    /// Collects the machines of all shards; `None` without shards.
    pub(crate) fn of<'a>(shards: impl IntoIterator<Item = &'a Machine>) -> Option<Self> {
        let mut machines: Vec<Machine> = Vec::new();
        for machine in shards {
            match machines.iter_mut().find(|known| known.is_same(machine)) {
                Some(known) => {
                    let highest = |a: Option<f64>, b: Option<f64>| a.zip(b).map_or(a.or(b), |(a, b)| Some(a.max(b)));
                    known.load_at_start = highest(known.load_at_start, machine.load_at_start);
                    known.load_at_end = highest(known.load_at_end, machine.load_at_end);
                }
                None => machines.push(machine.clone()),
            }
        }
        if let [only] = &mut machines[..] {
            only.host = None;
        }
        (!machines.is_empty()).then_some(Self(machines))
    }

    /// Returns the package version of the build that ran the experiment on all of them.
    pub(crate) fn version(&self) -> &str {
        &self.0[0].version
    }

    /// Returns the summaries of all machines as one line without a full stop.
    pub(crate) fn summary(&self) -> String {
        self.0.iter().map(Machine::summary).collect::<Vec<_>>().join("; ")
    }

    /// Whether there is more than one.
    pub(crate) fn are_several(&self) -> bool {
        self.0.len() > 1
    }

    /// Returns the text that identifies one of the machines; `None` if there is only one.
    pub(crate) fn label(&self, machine: &Machine) -> Option<String> {
        self.are_several().then(|| machine.label())
    }
}

impl Serialize for Machines {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        match &self.0[..] {
            [only] => map.serialize_entry("machine", only)?,
            several => map.serialize_entry("machines", several)?,
        }
        map.end()
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

    #[test]
    fn machines_are_listed_once_and_named_only_if_there_are_several() {
        let on = |host: &str, load| Machine {
            host: Some(host.to_owned()),
            load_at_start: Some(load),
            processor: Some("Example 9000".to_owned()),
            threads: 2,
            ..Machine::at_start()
        };
        let (first, again, other) = (on("a", 0.5), on("a", 1.5), on("b", 0.25));
        let one = Machines::of([&first, &again]).unwrap();
        assert_eq!(one.label(&first), None);
        let json = serde_json::to_value(&one).unwrap();
        assert_eq!((json["machine"]["load_at_start"].as_f64(), json["machine"].get("host")), (Some(1.5), None));
        let two = Machines::of([&first, &other, &again]).unwrap();
        assert_eq!(two.label(&again).as_deref(), Some("a: Example 9000, 2 threads"));
        let json = serde_json::to_value(&two).unwrap();
        assert_eq!(json["machines"].as_array().unwrap().len(), 2);
        assert_eq!(json["machines"][1]["host"], "b");
        assert!(two.summary().contains("; b: Example 9000, 2 threads, "), "{}", two.summary());
        assert_eq!(Machines::of([]), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_final_load_is_known_only_after_the_measurement() {
        let started = Machine::at_start();
        assert!(started.load_at_start.is_some() && started.load_at_end.is_none());
        assert!(started.at_end().load_at_end.is_some_and(|load| load >= 0.0));
    }
}
