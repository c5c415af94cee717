//! Stages of the pipeline: the selected one, and the counters and times of all of them.

use std::time::{Duration, Instant};

use super::Session;
use super::feature::Feature;
use super::window_task::WindowTask;
use crate::inspect::Stage;
use crate::measure::stages::StageTimes;
use crate::ui::engine::{Shown, StageFigures};

/// Minimum time between two changes of the times of frames that play, so that they can be read.
const UPDATE_TIME: Duration = Duration::from_millis(250);

/// Selected stage, and the figures of all stages.
#[derive(Clone, Debug)]
pub(crate) struct Stages {
    /// Stage whose switches the pipeline panel shows.
    pub(crate) selected: Stage,
    /// Counters and times of the stages, from the last frame that stayed on screen long enough to be timed.
    pub(crate) figures: Option<StageFigures>,
    played: PlayedTimes,
}

/// Stage times that the frames of a scene recorded while the scene played.
#[derive(Clone, Debug, Default)]
struct PlayedTimes {
    /// Times to show; `None` if a frame was timed since.
    shown: Option<StageTimes>,
    /// Time at which the shown times last changed.
    changed_at: Option<Instant>,
    /// Times of the frames since then.
    recorded: Vec<StageTimes>,
}

impl Default for Stages {
    fn default() -> Self {
        Self { selected: Stage::Rasterize, figures: None, played: PlayedTimes::default() }
    }
}

/// Change of the selected stage. If a stage picture is shown, the picture after the selected stage is shown, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StageChange {
    /// Selects the stage whose switches the pipeline panel shows.
    Select(Stage),
    /// Moves the selection forwards or backwards by this many stages.
    Step(i64),
}

impl Stages {
    /// Returns the times of the stages: those of frames that play, or otherwise those of the last frame that was timed.
    /// Returns `None` if there are none.
    pub(crate) fn times(&self) -> Option<StageTimes> {
        self.played.shown.or(self.figures.map(|figures| figures.times))
    }

    /// Stores the figures of a frame that stayed on screen long enough to be timed.
    pub(crate) fn store_figures(&mut self, figures: StageFigures) {
        self.figures = Some(figures);
        self.played.shown = None;
        self.played.recorded.clear();
    }

    /// Records the times of a frame that plays, received at `now`. [`Self::times`] changes after [`UPDATE_TIME`] at the
    /// earliest, to those of the frame with the median time.
    pub(crate) fn record_played(&mut self, times: StageTimes, now: Instant) {
        let PlayedTimes { shown, changed_at, recorded } = &mut self.played;
        recorded.push(times);
        if changed_at.is_none_or(|before| now.saturating_duration_since(before) >= UPDATE_TIME) {
            recorded.sort_by_key(|times| times.frame);
            (*shown, *changed_at) = (Some(recorded[recorded.len() / 2]), Some(now));
            recorded.clear();
        }
    }
}

impl Feature for Stages {
    type Change = StageChange;

    fn apply(session: &mut Session, change: StageChange) -> Option<WindowTask> {
        let stage = match change {
            StageChange::Select(stage) => stage,
            StageChange::Step(steps) => session.features.stages.selected.stepped(steps),
        };
        session.features.stages.selected = stage;
        if matches!(session.shown, Shown::Stage(_)) {
            session.show(Shown::Stage(stage));
        }
        None
    }

    fn leave_scene(&mut self) {
        (self.figures, self.played) = (None, PlayedTimes::default());
    }
}

impl Session {
    /// Returns the picture after the stage that lies `steps` stages after the shown one. If no stage is shown, the
    /// finished picture counts as the last stage.
    pub(crate) fn stage_beside_shown(&self, steps: i64) -> Shown {
        let now = match self.shown {
            Shown::Stage(stage) => stage,
            Shown::Buffer(_) | Shown::Intermediate(_) => Stage::Upscale,
        };
        Shown::Stage(now.stepped(steps))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn played_times_change_four_times_per_second_to_those_of_the_median_frame() {
        let begin = Instant::now();
        let mut stages = Stages::default();
        let of = |frame_ms| StageTimes { frame: Duration::from_millis(frame_ms), ..StageTimes::default() };
        let shown_ms = |stages: &Stages| stages.times().map(|times| times.frame.as_millis());
        assert_eq!(shown_ms(&stages), None);
        for (at_ms, frame_ms, shown) in [(0, 7, 7), (100, 30, 7), (200, 2, 7), (249, 3, 7), (250, 9, 9), (499, 1, 9)] {
            stages.record_played(of(frame_ms), begin + Duration::from_millis(at_ms));
            assert_eq!(shown_ms(&stages), Some(shown), "at {at_ms} ms");
        }
        stages.store_figures(StageFigures { times: of(5), ..StageFigures::default() });
        assert_eq!(shown_ms(&stages), Some(5), "a frame was timed");
        stages.record_played(of(6), begin + Duration::from_millis(600));
        assert_eq!(shown_ms(&stages), Some(6), "frames from before it do not count");
    }
}
