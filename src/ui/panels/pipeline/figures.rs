//! Figures in the row of a stage: number of items, time, or the reason why the frame skips the stage.

use std::time::Duration;

use eframe::egui::{Color32, TextStyle, Ui};

use super::milliseconds;
use crate::chain::KeepDepth;
use crate::chain::whole::FramePart;
use crate::inspect::Stage;
use crate::measure::stages::StageTimes;
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::settings::{Choice as _, Execution};
use crate::ui::engine::RenderedView;
use crate::ui::format;
use crate::ui::panels::skipped_work;
use crate::ui::session::Session;

/// Figures in the row of a stage.
pub(super) struct RowFigures {
    pub(super) detail: Detail,
    pub(super) time: StageTime,
    /// Stage whose time is part of the time of this stage, if any.
    included: Option<Stage>,
}

/// Text beside the name of a stage.
pub(super) enum Detail {
    /// Number of items that the stage passes on.
    Count(StageCount),
    /// Reason why the frame skips the stage.
    Skipped(String),
    /// Neither the count nor a reason for skipping is known.
    Nothing,
}

/// Number of items that a stage passes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StageCount {
    number: u64,
    /// Abbreviated unit, shown in the row.
    unit: &'static str,
    /// Description of the counted items, shown in the tooltip.
    meaning: &'static str,
}

impl StageCount {
    /// Returns the number with its unit, or the number alone where the unit would not fit into `width` points.
    pub(super) fn fitting(&self, ui: &Ui, width: f32) -> String {
        let number = format::short_count(self.number);
        let text = format!("{number} {}", self.unit);
        let font = TextStyle::Small.resolve(ui.style());
        let size = ui.painter().layout_no_wrap(text.clone(), font, Color32::WHITE).size();
        if size.x <= width { text } else { number }
    }
}

/// Time of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StageTime {
    /// Time spent in the stage.
    Measured(Duration),
    /// The time is part of the time of this stage.
    PartOf(Stage),
    /// The stage was not timed, or takes no time.
    Unknown,
}

impl RowFigures {
    pub(super) fn of(stage: Stage, session: &Session) -> Self {
        let view = session.view.as_ref();
        let reason = view.and_then(|view| skip_reason(stage, view));
        let is_skipped = reason.is_some();
        let detail = match reason {
            Some(reason) => Detail::Skipped(reason),
            None => view.and_then(|view| count_of(stage, session, view)).map_or(Detail::Nothing, Detail::Count),
        };
        let measured = session.features.stages.times().and_then(|times| time_of(stage, &times));
        let is_tiled = view.is_some_and(|view| view.frame.execution == Execution::Tiled);
        let time = match (measured, timed_within(stage)) {
            (Some(time), _) => StageTime::Measured(time),
            (None, Some(other)) if is_tiled && !is_skipped => StageTime::PartOf(other),
            (None, _) => StageTime::Unknown,
        };
        let is_included = |other: &&Stage| is_tiled && timed_within(**other) == Some(stage);
        Self { detail, time, included: Stage::ALL.iter().find(is_included).copied() }
    }

    pub(super) fn tooltip(&self, ui: &mut Ui, stage: Stage) {
        ui.strong(stage.name());
        ui.label(stage.help());
        match &self.detail {
            Detail::Count(count) => drop(ui.label(format!("{} {}.", format::count(count.number), count.meaning))),
            Detail::Skipped(reason) => drop(ui.label(format!("Skipped: {reason}."))),
            Detail::Nothing => {}
        }
        match self.time {
            StageTime::Measured(time) => drop(ui.label(format!("{}. {TIME_HELP}", milliseconds(time)))),
            StageTime::PartOf(other) => {
                let text = format!("In tiled execution, its time is part of the time of “{}”.", other.name());
                ui.label(text);
            }
            StageTime::Unknown => {}
        }
        if let Some(other) = self.included {
            ui.label(format!("In tiled execution, the time includes that of “{}”.", other.name()));
        }
    }
}

/// Explanation of the time in the tooltip of a row.
const TIME_HELP: &str = "Time spent in this stage, in the frame with the median time of several. The bar is its share \
                         of the frame time. While a scene plays, the frames of the last quarter of a second count. \
                         Classic execution divides the time of rasterize, depth, interpolate and \
                         shade in proportion to partial frames that each run one more stage; 0 means too short to \
                         measure.";

/// Returns the measured time of a stage; `None` if it was not timed or is part of the time of another stage.
pub(super) fn time_of(stage: Stage, times: &StageTimes) -> Option<Duration> {
    match stage {
        Stage::Assemble => None,
        Stage::Transform => Some(times.transform),
        Stage::Clip => times.clip,
        Stage::Project => times.project,
        Stage::Cull => Some(times.cull),
        Stage::Rasterize => Some(times.rasterize),
        Stage::Depth => times.depth,
        Stage::Interpolate => times.interpolate,
        Stage::Shade => Some(times.shade),
        Stage::Upscale => Some(times.upscale),
    }
}

/// Returns the stage whose time includes that of `stage` in tiled execution; `None` if `stage` is timed on its own.
pub(super) fn timed_within(stage: Stage) -> Option<Stage> {
    match stage {
        Stage::Project => Some(Stage::Transform),
        Stage::Clip => Some(Stage::Cull),
        Stage::Depth => Some(Stage::Rasterize),
        Stage::Interpolate => Some(Stage::Shade),
        Stage::Assemble | Stage::Transform | Stage::Cull | Stage::Rasterize | Stage::Shade | Stage::Upscale => None,
    }
}

/// Returns the reason why a frame skips a stage completely; `None` if the stage runs.
fn skip_reason(stage: Stage, view: &RenderedView) -> Option<String> {
    let part = match stage {
        Stage::Assemble => return None,
        // Even without culling by facing, the stage `Cull` removes zero-area triangles and sets up edges.
        Stage::Transform | Stage::Project | Stage::Cull | Stage::Rasterize | Stage::Interpolate | Stage::Shade => {
            PipelinePart::Vertices
        }
        Stage::Clip => PipelinePart::Clipping,
        Stage::Depth => PipelinePart::Depth,
        Stage::Upscale => {
            let (scene, recipe) = (&view.request.scene, &view.request.recipe);
            let step = FramePart::Upscaling.step(scene, recipe, KeepDepth::Yes, view.frame.view_change());
            return step.reason().map(str::to_owned);
        }
    };
    skipped_work::reasons_in_all(&view.frame.plans, part)
}

/// Returns the number of items that a stage passes on; `None` if it is not known.
fn count_of(stage: Stage, session: &Session, view: &RenderedView) -> Option<StageCount> {
    let (counters, geometry) = (session.features.stages.figures?.counters, view.frame.geometry());
    let (number, unit, meaning) = match stage {
        Stage::Assemble => (session.scene.triangle_count() as u64, "tris", "triangles in the scene"),
        Stage::Transform => (geometry.vertices as u64, "verts", "vertices transformed"),
        Stage::Clip => (geometry.triangles_clipped as u64, "tris", "triangles left after clipping"),
        Stage::Project => (geometry.triangles_clipped as u64, "tris", "triangles projected"),
        Stage::Cull => (view.rasterized as u64, "tris", "triangles to rasterize"),
        Stage::Rasterize => (counters.covered, "frags", "fragments: samples covered by a triangle"),
        Stage::Depth => (counters.passed, "frags", "fragments passed the depth test"),
        Stage::Interpolate => return None,
        Stage::Shade => (counters.shaded, "frags", "fragments shaded"),
        Stage::Upscale => (view.frame.drawn_pixels(), "px", "pixels drawn"),
    };
    Some(StageCount { number, unit, meaning })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use eframe::egui::{Theme, vec2};

    use super::*;
    use crate::chain::Recipe;
    use crate::pipeline::settings::DepthTest;
    use crate::scene::SceneSource;
    use crate::ui::engine::Engine;
    use crate::ui::headless::Headless;
    use crate::ui::session::PictureSize;

    fn session() -> Session {
        let source = SceneSource::named("interpenetrating".into());
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        let mut session = Session::new(Arc::new(scene), source, Recipe::default(), home);
        session.state.size = PictureSize::Fixed(32, 20);
        session
    }

    fn reasons(session: &Session) -> Vec<(Stage, String)> {
        let view = Engine::default().answer(session.request());
        Stage::ALL.iter().filter_map(|stage| Some((*stage, skip_reason(*stage, &view)?))).collect()
    }

    #[test]
    fn a_stage_is_skipped_if_no_draw_runs_it() {
        let mut session = session();
        session.state.recipe.pipeline.depth_test = DepthTest::Off;
        let skipped = reasons(&session);
        assert!(skipped.contains(&(Stage::Depth, "the depth test is off".to_owned())), "{skipped:?}");
        assert!(skipped.contains(&(Stage::Upscale, "every pixel is drawn".to_owned())), "{skipped:?}");
        assert!(skipped.iter().all(|(stage, _)| *stage != Stage::Shade), "{skipped:?}");

        let camera = &mut session.state.camera;
        camera.target = camera.eye * 2.0 - camera.target;
        session.state.recipe.set("upscaler.method=nearest").unwrap();
        let skipped = reasons(&session);
        assert_eq!(skipped.len(), Stage::ALL.len() - 2, "{skipped:?}");
        assert!(skipped.iter().all(|(_, reason)| reason == "the whole object is outside the view"), "{skipped:?}");
    }

    #[test]
    fn a_narrow_row_omits_the_unit_of_a_count_but_no_digit() {
        let mut headless = Headless::new(vec2(200.0, 100.0), 1.0, Theme::Dark);
        let count = StageCount { number: 14_860, unit: "tris", meaning: "triangles" };
        headless.pass(Vec::new(), |ui| {
            assert_eq!(count.fitting(ui, 200.0), format!("{} tris", format::short_count(14_860)));
            assert_eq!(count.fitting(ui, 1.0), format::short_count(14_860));
        });
    }

    #[test]
    fn only_stages_without_a_time_of_their_own_are_timed_within_another() {
        let times = StageTimes::default();
        for stage in Stage::ALL.iter().filter(|stage| timed_within(**stage).is_some()) {
            assert_eq!(time_of(*stage, &times), None, "{stage:?}");
        }
    }
}
