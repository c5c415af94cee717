//! Fuzzing driver, which executes a target on random inputs until its time is up and saves every input that fails.
//!
//! An execution fails if it panics (even if the program catches the panic), if the target finds a wrong result, if it
//! exceeds the time limit, or if the resident memory of the process grows by more than 1 GiB. A failing input is
//! executed again to confirm it, minimised, and saved below `target/fuzz-findings` with the command that reproduces it.
//! Files are written before each execution. If an execution ends the whole process, its input remains and is executed
//! first in the next run.
//!
//! Environment variables: `RASTERSCOPE_FUZZ_SECONDS` (time for each target), `RASTERSCOPE_FUZZ_SEED`,
//! `RASTERSCOPE_FUZZ_FIRST` (number of the first iteration), and `RASTERSCOPE_FUZZ_INPUT` (folder of a saved input,
//! which is executed once instead).

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use fastrand::Rng;

use crate::fuzz::input::{Input, NOTES, minimise};
use crate::fuzz::{panics, process};

/// Time for each target unless `RASTERSCOPE_FUZZ_SECONDS` is set, in seconds.
const SECONDS: f64 = 3.0;

/// Default time limit of an execution. Inputs are small, so an execution that takes longer does unbounded work.
pub(crate) const LIMIT: Duration = Duration::from_secs(2);

/// Multiple of the time limit after which an execution is abandoned. Unlike the limit, it includes time spent waiting
/// for a processor.
const GIVE_UP: u32 = 30;

/// Default limit of the growth of resident memory in one execution, in bytes.
const MAX_GROWTH: u64 = 1 << 30;

/// Stack size of threads that execute and draw, in bytes. It is that of a main thread, because unoptimised SIMD kernels
/// have large stack frames.
pub(crate) const STACK_BYTES: usize = 8 << 20;

/// Number of further executions that must confirm a failure of time or memory, which another process may have caused.
const CONFIRMATIONS: usize = 2;

/// Time limit for minimising one input.
const MINIMISING: Duration = Duration::from_secs(10);

/// Number of different failures after which a target stops.
const MAX_FINDINGS: usize = 8;

/// Fuzz target: a part of the program that is executed on random inputs.
pub(crate) trait Target: Send + Sync + 'static {
    /// Returns the name of the target, which is also the name of its test.
    fn name(&self) -> &'static str;

    /// Returns a random input.
    fn generate(&self, rng: &mut Rng) -> Input;

    /// Executes the input whose files are in `folder`.
    fn run(&self, folder: &Path) -> Result<(), Failure>;

    /// Returns the time limit of one execution.
    fn limit(&self) -> Duration {
        LIMIT
    }

    /// Returns the limit of the growth of resident memory in one execution, in bytes.
    fn max_growth(&self) -> u64 {
        MAX_GROWTH
    }

    /// Returns the Cargo features that the target needs besides the default ones, for the command that reproduces a
    /// failure.
    fn features(&self) -> &'static str {
        ""
    }
}

/// Reason why an execution failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Failure {
    /// A panic with its location and message.
    Panic(String),
    /// A wrong result, described in words; the text before the first colon identifies its class.
    Wrong(String),
    /// An execution that exceeded the time limit, with its duration.
    Slow(Duration),
    /// An execution that exceeded the memory limit, with the growth of resident memory in bytes.
    Memory(u64),
    /// An execution that was abandoned after this time.
    Hang(Duration),
}

impl Failure {
    /// Returns the class of the failure, which is usually equal for failures with the same cause.
    fn class(&self) -> String {
        match self {
            // The location only, because messages contain values.
            Self::Panic(text) => format!("panic {}", text.split(": ").next().unwrap_or_default()),
            Self::Wrong(text) => {
                let words = text.split(':').next().unwrap_or_default();
                format!("wrong {}", words.chars().filter(|c| !c.is_ascii_digit()).collect::<String>())
            }
            Self::Slow(_) => "slow".to_owned(),
            Self::Memory(_) => "memory".to_owned(),
            Self::Hang(_) => "hang".to_owned(),
        }
    }

    /// Returns whether other processes on the machine may cause the failure.
    fn depends_on_load(&self) -> bool {
        matches!(self, Self::Slow(_) | Self::Memory(_))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Panic(text) => write!(f, "panicked at {text}"),
            Self::Wrong(text) => f.write_str(text),
            Self::Slow(time) => write!(f, "took {:.1} s", time.as_secs_f64()),
            Self::Memory(bytes) => write!(f, "resident memory grew by {} MiB", bytes >> 20),
            Self::Hang(time) => write!(f, "did not end within {:.0} s", time.as_secs_f64()),
        }
    }
}

/// Executions to run, and the folder for failing inputs.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Time after which no further execution starts.
    pub(crate) time: Duration,
    /// Seed from which the random numbers of every iteration derive.
    pub(crate) seed: u64,
    /// Number of the first iteration.
    pub(crate) first: u64,
    /// Folder of a saved input that is executed once instead of random inputs.
    pub(crate) saved: Option<PathBuf>,
    /// Folder of saved failures.
    pub(crate) findings: PathBuf,
    /// Folder for the files of the current execution of each target.
    pub(crate) running: PathBuf,
}

impl Plan {
    /// Returns the plan described by the environment variables.
    fn from_environment() -> Self {
        fn variable<T: std::str::FromStr>(name: &str) -> Option<T> {
            let text = std::env::var(name).ok()?;
            Some(text.parse().unwrap_or_else(|_| panic!("{name}={text} is not a number")))
        }
        // The tests are in `target/debug/deps`.
        let program = std::env::current_exe().expect("a path of the tests");
        let findings = program.ancestors().nth(3).expect("a target folder").join("fuzz-findings");
        // Creating a file takes 0.03 ms in memory and 2 ms on a busy disk.
        let memory = Path::new("/dev/shm");
        let running = if memory.is_dir() {
            memory.join(format!("rasterscope-fuzz-{:08x}", hash(&findings.to_string_lossy())))
        } else {
            findings.join("running")
        };
        Self {
            time: Duration::from_secs_f64(variable("RASTERSCOPE_FUZZ_SECONDS").unwrap_or(SECONDS)),
            seed: variable("RASTERSCOPE_FUZZ_SEED").unwrap_or(1),
            first: variable("RASTERSCOPE_FUZZ_FIRST").unwrap_or(0),
            saved: std::env::var_os("RASTERSCOPE_FUZZ_INPUT").map(PathBuf::from),
            findings,
            running,
        }
    }
}

/// Result of fuzzing one target.
#[derive(Debug, Default)]
pub(crate) struct Report {
    /// Number of executed inputs.
    pub(crate) executions: u64,
    /// Folders of saved inputs with the reason of the failure, one for each class of failures.
    pub(crate) findings: BTreeMap<PathBuf, Failure>,
    /// Number of failures of time or memory that could not be confirmed.
    pub(crate) unconfirmed: u64,
    /// Duration of the longest execution, and the number of its iteration.
    pub(crate) slowest: (Duration, u64),
    /// Largest resident memory of the process, in bytes.
    pub(crate) peak: u64,
    /// Duration of the whole run.
    pub(crate) time: Duration,
}

/// Fuzzes a target as the environment variables specify. Panics if there are findings.
#[expect(clippy::print_stderr, reason = "the counts of a run are its result")]
pub(crate) fn fuzz(target: impl Target) {
    let (target, plan) = (Arc::new(target), Plan::from_environment());
    let name = target.name();
    let report = run(&target, &plan);
    let Report { executions, findings, unconfirmed, slowest: (slowest, iteration), peak, time } = report;
    let unconfirmed = if unconfirmed > 0 { format!(" ({unconfirmed} more not confirmed)") } else { String::new() };
    eprintln!(
        "fuzz {name}: {executions} executions in {:.1} s, {} findings{unconfirmed}, slowest {:.1} ms (seed {}, iteration \
         {iteration}), peak memory {} MiB",
        time.as_secs_f64(),
        findings.len(),
        slowest.as_secs_f64() * 1e3,
        plan.seed,
        peak >> 20,
    );
    let listed = findings.iter().map(|(folder, failure)| format!("\n  {}: {failure}", folder.display()));
    assert!(findings.is_empty(), "fuzz {name}: see {NOTES} in{}", listed.collect::<String>());
}

/// Fuzzes a target according to a plan.
pub(crate) fn run<T: Target>(target: &Arc<T>, plan: &Plan) -> Report {
    panics::record();
    let begun = Instant::now();
    let mut fuzzer = Fuzzer {
        target: Arc::clone(target),
        plan,
        executor: Executor::new(target),
        running: plan.running.join(target.name()),
        report: Report::default(),
    };
    fuzzer.execute_all(begun);
    // No input is left to be executed first in the next run; a folder that cannot be removed is harmless.
    drop(fs::remove_dir_all(&fuzzer.running));
    Report { time: begun.elapsed(), ..fuzzer.report }
}

/// State of a fuzzing run.
struct Fuzzer<'a, T> {
    target: Arc<T>,
    plan: &'a Plan,
    executor: Executor,
    /// Folder with the files of the current execution.
    running: PathBuf,
    report: Report,
}

impl<T: Target> Fuzzer<'_, T> {
    fn execute_all(&mut self, begun: Instant) {
        if let Some(saved) = &self.plan.saved {
            let input = Input::read(saved).expect("a readable folder");
            if let Err(failure) = self.execute(&input, None) {
                self.report.findings.insert(saved.clone(), failure);
            }
            return;
        }
        if let Ok(left) = Input::read(&self.running) {
            self.check(&left, None);
        }
        let mut iteration = self.plan.first;
        loop {
            // Each iteration has a generator of its own, so that any of them can be repeated alone.
            let mut rng = Rng::with_seed(self.plan.seed.rotate_left(32) ^ iteration);
            let input = self.target.generate(&mut rng);
            self.check(&input, Some(iteration));
            let is_over = begun.elapsed() >= self.plan.time || self.report.findings.len() >= MAX_FINDINGS;
            if is_over || self.executor.is_stuck {
                return;
            }
            iteration += 1;
        }
    }

    /// Executes an input. Confirms, minimises and saves it if it fails in a new way.
    fn check(&mut self, input: &Input, iteration: Option<u64>) {
        let Err(failure) = self.execute(input, iteration) else { return };
        let class = failure.class();
        if self.report.findings.values().any(|known| known.class() == class) {
            return;
        }
        let fails_again = |fuzzer: &mut Self, input: &Input| {
            fuzzer.execute(input, None).is_err_and(|failure| failure.class() == class)
        };
        let again = !self.executor.is_stuck && (0..CONFIRMATIONS).all(|_| fails_again(self, input));
        if failure.depends_on_load() && !again {
            self.report.unconfirmed += 1;
            return;
        }
        let deadline = Instant::now() + MINIMISING;
        let least = if again {
            minimise(input.clone(), deadline, |candidate| !self.executor.is_stuck && fails_again(self, candidate))
        } else {
            input.clone()
        };
        let folder = self.save(&least, input.size(), &failure, iteration);
        self.report.findings.insert(folder, failure);
    }

    fn execute(&mut self, input: &Input, iteration: Option<u64>) -> Result<(), Failure> {
        input.write(&self.running).expect("a folder that can be written to");
        let limit = self.target.limit();
        let outcome = self.executor.execute(&self.running, limit * GIVE_UP);
        self.report.executions += 1;
        self.report.peak = self.report.peak.max(outcome.peak);
        if let Some(iteration) = iteration.filter(|_| outcome.time > self.report.slowest.0) {
            self.report.slowest = (outcome.time, iteration);
        }
        match outcome.result {
            Ok(()) if outcome.time > limit => Err(Failure::Slow(outcome.time)),
            Ok(()) if outcome.growth > self.target.max_growth() => Err(Failure::Memory(outcome.growth)),
            result => result,
        }
    }

    /// Saves a failing input. Returns its folder, whose name identifies the class of the failure.
    fn save(&self, input: &Input, size: usize, failure: &Failure, iteration: Option<u64>) -> PathBuf {
        let name = self.target.name();
        let folder = self.plan.findings.join(format!("{name}-{:08x}", hash(&failure.class())));
        input.write(&folder).expect("a folder that can be written to");
        let features = match self.target.features() {
            "" => String::new(),
            features => format!("--features {features} "),
        };
        let command = format!("cargo test {features}--lib -- --exact fuzz::{name} --nocapture");
        let seed = self.plan.seed;
        let found = iteration.map_or_else(
            || "found in an input that an earlier process left".to_owned(),
            |n| format!("found by RASTERSCOPE_FUZZ_SEED={seed} RASTERSCOPE_FUZZ_FIRST={n} RASTERSCOPE_FUZZ_SECONDS=0 {command}"),
        );
        let notes = format!(
            "{failure}\n\nRASTERSCOPE_FUZZ_INPUT={} {command}\n\n{found}\n{} bytes, {size} before minimising\n",
            folder.display(),
            input.size(),
        );
        fs::write(folder.join(NOTES), notes).expect("a folder that can be written to");
        folder
    }
}

/// Returns the FNV-1a hash, which is equal on every platform.
fn hash(text: &str) -> u32 {
    text.bytes().fold(0x811C_9DC5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

/// Thread that executes inputs, so that an execution that never ends can be abandoned.
struct Executor {
    folders: Sender<PathBuf>,
    outcomes: Receiver<Outcome>,
    /// Whether an execution was abandoned, after which no further input can be executed.
    is_stuck: bool,
}

/// Outcome of one execution.
struct Outcome {
    result: Result<(), Failure>,
    time: Duration,
    /// Growth of the resident memory, in bytes.
    growth: u64,
    /// Largest resident memory of the process, in bytes.
    peak: u64,
}

impl Executor {
    fn new<T: Target>(target: &Arc<T>) -> Self {
        let ((folders, inbox), (outbox, outcomes)) = (channel::<PathBuf>(), channel());
        let target = Arc::clone(target);
        std::thread::Builder::new()
            .name(format!("{}{}", panics::THREADS, target.name()))
            .stack_size(STACK_BYTES)
            .spawn(move || {
                for folder in inbox {
                    // The receiver may be gone after an execution was abandoned.
                    drop(outbox.send(outcome(&*target, &folder)));
                }
            })
            .expect("a thread");
        Self { folders, outcomes, is_stuck: false }
    }

    fn execute(&mut self, folder: &Path, longest: Duration) -> Outcome {
        self.folders.send(folder.to_owned()).expect("the thread catches panics");
        match self.outcomes.recv_timeout(longest) {
            Ok(outcome) => outcome,
            Err(RecvTimeoutError::Timeout) => {
                self.is_stuck = true;
                Outcome { result: Err(Failure::Hang(longest)), time: longest, growth: 0, peak: 0 }
            }
            Err(RecvTimeoutError::Disconnected) => unreachable!("the thread catches panics"),
        }
    }
}

/// Executes a target on the input in `folder`, and measures time and memory. Runs on the executor's thread.
fn outcome<T: Target>(target: &T, folder: &Path) -> Outcome {
    let meter = process::PeakMeter::start();
    let begun = process::Stopwatch::start();
    let result = catch_unwind(AssertUnwindSafe(|| target.run(folder)));
    let time = begun.elapsed();
    let (peak, growth) = meter.finish();
    let result = match (panics::take_own(), result) {
        (Some(panic), _) => Err(Failure::Panic(panic)),
        (None, Ok(result)) => result,
        // A thread pool raises a panic of one of its threads again here.
        (None, Err(_)) => Err(Failure::Panic(panics::take_elsewhere().unwrap_or_default())),
    };
    Outcome { result, time, growth, peak }
}
