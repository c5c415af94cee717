//! Measurements of all upscalers that start by themselves: when a panel that shows them is open, they are missing or out
//! of date, and neither the user nor another program is busy.

use std::time::Duration;

use eframe::egui::Ui;

use super::Workbench;
use crate::measure::other_programs::{DISTURBING_SHARE, INTERVAL, OtherPrograms};
use crate::ui::engine::Request;
use crate::ui::session::workspace::Panel;

/// Time without input after which a measurement starts.
const QUIET: Duration = Duration::from_millis(1500);

/// Measurements of all upscalers.
#[derive(Debug, Default)]
pub(super) struct UpscalerMeasurement {
    /// Sequence number of the latest measurement; responses with another number are discarded.
    pub(super) number: u64,
    /// Decides when a measurement starts by itself.
    pub(super) idle: IdleMeasurement,
}

/// Observations that decide whether a measurement starts by itself.
#[derive(Debug, Default)]
pub(super) struct IdleMeasurement {
    others: OtherPrograms,
    /// Request whose measurement the user has cancelled or cleared.
    declined: Option<Request>,
    /// Time of the last input or change of the view, in seconds.
    busy_at: f64,
    /// View at that time.
    seen: Option<Request>,
}

impl IdleMeasurement {
    /// Remembers that the user does not want a measurement of this view.
    pub(super) fn decline(&mut self, request: Request) {
        self.declined = Some(request);
    }

    /// Whether neither input nor a change of the view has occurred for [`QUIET`].
    fn is_quiet(&mut self, ui: &Ui, request: &Request) -> bool {
        let (now, has_input) = ui.input(|input| (input.time, !input.events.is_empty() || input.pointer.any_down()));
        let is_same = self.seen.as_ref().is_some_and(|seen| seen.same_complete_frame(request));
        if has_input || !is_same {
            (self.busy_at, self.seen) = (now, Some(request.clone()));
        }
        now - self.busy_at >= QUIET.as_secs_f64()
    }
}

impl Workbench {
    /// Starts a measurement if one is due, and observes other programs during a measurement. Synchronous windows, such
    /// as those of screenshots, measure only on request.
    pub(super) fn measure_when_idle(&mut self, ui: &Ui) {
        let is_shown = [Panel::FrameTime, Panel::ErrorTime].iter().any(|panel| self.docks.shows(*panel));
        if !is_shown || self.widgets.is_synchronous {
            return;
        }
        if self.session.features.tasks.measuring.is_some() {
            if let Some(share) = self.measuring.idle.others.share() {
                self.session.features.timings.record_others(share);
            }
            return;
        }
        let request = self.session.request();
        let is_declined =
            self.measuring.idle.declined.as_ref().is_some_and(|declined| declined.same_complete_frame(&request));
        let is_wanted = self.session.features.timings.automatic
            && self.session.features.case.is_none()
            && self.session.view_of_scene().is_some()
            && !is_declined
            && !self.session.features.timings.measurement_fits(&request);
        if !is_wanted {
            return;
        }
        let is_quiet = self.measuring.idle.is_quiet(ui, &request);
        let others = self.measuring.idle.others.share();
        if is_quiet && others.is_some_and(|share| share <= DISTURBING_SHARE) {
            self.measuring.idle.others.reset();
            self.measure();
        } else {
            ui.request_repaint_after(INTERVAL);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use eframe::egui::{Theme, vec2};

    use super::*;
    use crate::chain::Recipe;
    use crate::scene::SceneSource;
    use crate::ui::headless::Headless;
    use crate::ui::session::command::Command;
    use crate::ui::session::long_tasks::MeasureCommand;
    use crate::ui::session::timings::TimingsChange;
    use crate::ui::session::{PictureSize, Session};
    use crate::ui::worker::Worker;

    /// Window with the panel “Frame time”.
    struct Window {
        headless: Headless,
        bench: Workbench,
    }

    impl Window {
        fn new(automatic: bool) -> Self {
            let source = SceneSource::named("triangle".into());
            let scene = source.load().unwrap().scene;
            let home = scene.home;
            let mut session = Session::new(Arc::new(scene), source, Recipe::default(), home);
            session.state.size = PictureSize::Fixed(16, 12);
            session.features.timings.automatic = automatic;
            let mut bench = Workbench::new(session, Worker::spawn(|| ()));
            bench.show_panel(Panel::FrameTime);
            let mut window = Self { headless: Headless::new(vec2(900.0, 600.0), 1.0, Theme::Dark), bench };
            while window.bench.session().view_of_scene().is_none() {
                window.passes(1);
                std::thread::sleep(Duration::from_millis(1));
            }
            window
        }

        fn passes(&mut self, count: usize) {
            for _ in 0..count {
                self.headless.pass(Vec::new(), |ui| self.bench.show(ui));
            }
        }

        /// Whether a measurement runs or has run after two quiet seconds beside other programs that use this share.
        fn measures(&mut self, others: f64) -> bool {
            // A measurement that starts forgets what was observed before.
            self.bench.measuring.idle.others = OtherPrograms::of_share(others);
            self.passes(20);
            self.bench.session().features.tasks.measuring.is_some()
                || self.bench.session().features.timings.has_measurement()
        }
    }

    #[test]
    fn a_measurement_starts_by_itself_until_the_user_declines() {
        let mut window = Window::new(true);
        assert!(window.measures(0.02));
        window
            .bench
            .queue(vec![Command::Measure(MeasureCommand::CancelUpscalers), Command::Timings(TimingsChange::Clear)]);
        assert!(!window.measures(0.02), "the user does not want it");
        window.bench.session_mut().state.recipe.wireframe = true;
        assert!(window.measures(0.02), "other settings are measured again");
    }

    #[test]
    fn no_measurement_starts_beside_busy_programs_or_if_it_is_switched_off() {
        assert!(!Window::new(true).measures(0.3));
        assert!(!Window::new(false).measures(0.02));
    }
}
