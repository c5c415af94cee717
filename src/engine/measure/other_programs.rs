//! Processor time that other programs take from a measurement.

use std::time::{Duration, Instant};

use sysinfo::{Pid, ProcessRefreshKind, ProcessesToUpdate, System, get_current_pid};

/// Minimum interval over which the share is measured. Systems count processor time in steps of up to 16 ms.
pub const INTERVAL: Duration = Duration::from_millis(900);

/// Share of all processors above which other programs distort frame times. Idle desktops stay below it.
pub const DISTURBING_SHARE: f64 = 0.1;

/// Observes how much processor time other programs use.
#[derive(Debug, Default)]
pub struct OtherPrograms {
    /// Access to the counters of the system; `None` before the first use, and where there is none.
    system: Option<(System, Pid)>,
    /// Time of the last reading, and the processor time of this program until then, in milliseconds.
    before: Option<(Instant, u64)>,
    share: Option<f64>,
}

impl OtherPrograms {
    /// Returns the share of all processors that other programs used in the last interval, in [0, 1]. Returns `None`
    /// before the first interval has passed and where the system does not report it.
    pub fn share(&mut self) -> Option<f64> {
        if self.before.is_none_or(|(at, _)| at.elapsed() >= INTERVAL) {
            self.read();
        }
        self.share
    }

    /// Creates an observer that always reports `share`, for tests of what depends on it.
    pub fn of_share(share: f64) -> Self {
        let never = Instant::now() + Duration::from_secs(1 << 20);
        Self { system: None, before: Some((never, 0)), share: Some(share) }
    }

    /// Forgets what was observed, so that the next share covers only the time from now on.
    pub fn reset(&mut self) {
        (self.before, self.share) = (None, None);
    }

    fn read(&mut self) -> Option<()> {
        if self.system.is_none() {
            self.system = System::new().ok().zip(get_current_pid().ok());
        }
        let (system, own) = self.system.as_mut()?;
        system.refresh_cpu_usage();
        system.refresh_processes_specifics(
            ProcessesToUpdate::Some(&[*own]),
            false,
            ProcessRefreshKind::nothing().with_cpu(),
        );
        let (now, own_ms) = (Instant::now(), system.process(*own)?.accumulated_cpu_time());
        if let Some((at, before_ms)) = self.before.replace((now, own_ms)) {
            let available_ms = (now - at).as_secs_f64() * 1e3 * system.cpus().len() as f64;
            let own = own_ms.saturating_sub(before_ms) as f64 / available_ms;
            self.share = Some(others_share(f64::from(system.global_cpu_usage()) / 100.0, own));
        }
        Some(())
    }
}

/// Returns the share of all processors that other programs use: the total share without that of this program.
fn others_share(total: f64, own: f64) -> f64 {
    (total - own).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn our_own_time_does_not_count() {
        assert_eq!(others_share(0.75, 0.5), 0.25);
        assert_eq!(others_share(0.5, 0.51), 0.0, "the counters are not read at exactly the same time");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_share_is_known_after_an_interval_and_not_before() {
        let mut others = OtherPrograms::default();
        assert_eq!((others.share(), others.share()), (None, None));
        std::thread::sleep(INTERVAL);
        assert!(others.share().is_some_and(|share| (0.0..=1.0).contains(&share)));
        others.reset();
        assert_eq!(others.share(), None);
    }
}
