//! Stages of the pipeline: the selected one, and the counters and times of all of them.

use super::Session;
use super::feature::Feature;
use super::window_task::WindowTask;
use crate::inspect::Stage;
use crate::ui::engine::{Shown, StageFigures};

/// Selected stage, and the figures of all stages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stages {
    /// Stage whose switches the pipeline panel shows.
    pub(crate) selected: Stage,
    /// Counters and times of the stages, from the last frame that stayed on screen long enough to be timed.
    pub(crate) figures: Option<StageFigures>,
}

impl Default for Stages {
    fn default() -> Self {
        Self { selected: Stage::Rasterize, figures: None }
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
        self.figures = None;
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
