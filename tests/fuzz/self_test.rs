//! Tests that the driver finds panics, slow and endless executions, wrong results and memory growth.

use std::fs;
use std::panic::catch_unwind;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use fastrand::Rng;
use tempfile::TempDir;

use crate::fuzz::driver::{Failure, Plan, Report, Target, run};
use crate::fuzz::input::{Input, NOTES};

/// Name of the file that every input in these tests contains.
const FILE: &str = "text.txt";

/// Target that calls a function if its input contains the word `bad`.
struct Bad {
    run: fn(&str) -> Result<(), Failure>,
    /// Limit of memory growth in one execution, in bytes.
    max_growth: u64,
    /// Time limit of an execution.
    limit: Duration,
}

impl Bad {
    /// Creates a target that fails as `run` does, or after 100 ms.
    fn new(run: fn(&str) -> Result<(), Failure>) -> Self {
        Self { run, max_growth: ANY_GROWTH, limit: Duration::from_millis(100) }
    }
}

/// Limit of memory growth that is never exceeded, in bytes, because other tests of this process may cause growth.
const ANY_GROWTH: u64 = u64::MAX;

impl Target for Bad {
    fn name(&self) -> &'static str {
        "bad"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let words = ["good", "fine", "sound", "bad"];
        let lines: String = (0..20).map(|_| format!("{} {}\n", words[rng.usize(..4)], rng.u8(..))).collect();
        Input::file(FILE, lines).with("unread.txt", "unread")
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let text = fs::read_to_string(folder.join(FILE)).unwrap_or_default();
        if text.contains("bad") { (self.run)(&text) } else { Ok(()) }
    }

    fn limit(&self) -> Duration {
        self.limit
    }

    fn max_growth(&self) -> u64 {
        self.max_growth
    }
}

/// Fuzzes a target that fails as `bad` does. Returns the report and the folder of its findings.
fn fuzzed(bad: fn(&str) -> Result<(), Failure>) -> (Report, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let report = run(&Arc::new(Bad::new(bad)), &plan(&folder));
    (report, folder)
}

fn plan(folder: &TempDir) -> Plan {
    let [findings, running] = ["findings", "running"].map(|name| folder.path().join(name));
    Plan { time: Duration::from_millis(200), seed: 5, first: 0, saved: None, findings, running }
}

/// Returns the folder and the failure of the only finding. Panics unless there is exactly one.
fn only(report: &Report) -> (&Path, &Failure) {
    assert_eq!(report.findings.len(), 1, "{report:?}");
    let (folder, failure) = report.findings.first_key_value().unwrap();
    (folder, failure)
}

#[test]
fn a_sound_target_has_no_findings() {
    let (report, folder) = fuzzed(|_| Ok(()));
    assert!(report.executions > 10 && report.findings.is_empty() && report.slowest.0 > Duration::ZERO, "{report:?}");
    assert_eq!(fs::read_dir(folder.path().join("running")).unwrap().count(), 0, "nothing is left");
}

#[test]
fn a_panic_is_minimised_saved_and_reproduced() {
    let (report, folder) = fuzzed(|text| panic!("{text}"));
    let (saved, failure) = only(&report);
    assert!(matches!(failure, Failure::Panic(place) if place.contains("tests/fuzz/self_test.rs:")), "{failure}");
    assert_eq!(Input::read(saved).unwrap(), Input::file(FILE, "bad"));
    let notes = fs::read_to_string(saved.join(NOTES)).unwrap();
    let command =
        format!("RASTERSCOPE_FUZZ_INPUT={} cargo test --lib -- --exact fuzz::bad --nocapture", saved.display());
    assert!(notes.contains(&command) && notes.contains("RASTERSCOPE_FUZZ_SEED=5"), "{notes}");

    let again = Plan { saved: Some(saved.to_owned()), ..plan(&folder) };
    let report = run(&Arc::new(Bad::new(|text| panic!("{text}"))), &again);
    assert_eq!((report.executions, report.findings.len()), (1, 1));
    let report = run(&Arc::new(Bad::new(|_| Ok(()))), &again);
    assert_eq!((report.executions, report.findings.len()), (1, 0), "repaired");
}

#[test]
fn a_panic_that_the_program_catches_is_found() {
    let (report, _folder) = fuzzed(|text| {
        drop(catch_unwind(|| assert!(!text.contains("bad"), "caught")));
        Ok(())
    });
    assert!(only(&report).1.to_string().contains("caught"), "{report:?}");
}

#[test]
fn a_panic_on_another_thread_is_found() {
    let (report, _folder) = fuzzed(|_| {
        rayon::scope(|scope| scope.spawn(|_| panic!("in a pool")));
        Ok(())
    });
    assert!(matches!(only(&report).1, Failure::Panic(_)), "{report:?}");
}

#[test]
fn a_wrong_result_is_minimised() {
    let (report, _folder) = fuzzed(|text| Err(Failure::Wrong(format!("sum: {} bytes", text.len()))));
    let (saved, failure) = only(&report);
    assert!(failure.to_string().starts_with("sum: "), "{failure}");
    assert_eq!(Input::read(saved).unwrap().size(), "bad".len());
}

#[test]
fn a_slow_execution_is_found() {
    let (report, _folder) = fuzzed(|_| {
        std::thread::sleep(Duration::from_millis(150));
        Ok(())
    });
    assert!(matches!(only(&report).1, Failure::Slow(time) if *time >= Duration::from_millis(150)), "{report:?}");
}

#[test]
fn an_execution_without_end_is_abandoned() {
    let (report, _folder) = fuzzed(|_| {
        loop {
            std::thread::park();
        }
    });
    let (saved, failure) = only(&report);
    assert!(matches!(failure, Failure::Hang(_)), "{report:?}");
    assert!(Input::read(saved).unwrap().0.contains_key(FILE));
}

#[cfg(target_os = "linux")]
#[test]
fn excessive_memory_growth_is_found() {
    const MOST: u64 = 64 << 20;
    let folder = tempfile::tempdir().unwrap();
    let bad = |_: &str| {
        // Pages count as resident once they are written. Other tests of this process may free memory at the same time.
        let bytes = vec![1_u8; MOST as usize * 4];
        assert_eq!(std::hint::black_box(bytes)[7], 1);
        Ok(())
    };
    // Writing the pages may take longer than the usual limit.
    let bad = Bad { max_growth: MOST, limit: Duration::from_secs(30), ..Bad::new(bad) };
    let report = run(&Arc::new(bad), &plan(&folder));
    assert!(report.findings.values().any(|failure| matches!(failure, Failure::Memory(_))), "{report:?}");
}

#[test]
fn an_input_that_ended_the_process_is_executed_first() {
    let folder = tempfile::tempdir().unwrap();
    let plan = Plan { time: Duration::ZERO, first: 3, ..plan(&folder) };
    Input::file(FILE, "left bad").write(&plan.running.join("bad")).unwrap();
    let report =
        run(&Arc::new(Bad::new(|text| if text.starts_with("left") { panic!("again") } else { Ok(()) })), &plan);
    assert!(only(&report).1.to_string().contains("again"), "{report:?}");
}
