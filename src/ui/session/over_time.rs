//! Error of the compared upscalers in every frame of the scene's motion, measured in a background thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use eframe::egui::Context;

use super::feature::Feature;
use super::window_task::WindowTask;
use super::{Session, Severity};
use crate::chain::Recipe;
use crate::measure::jod::Viewing;
use crate::measure::metric::Metric;
use crate::measure::shot::{CameraMotion, Shot};
use crate::report::animation::{AnimatedMethod, AnimationFormat, AnimationPlan, Arrangement};
use crate::report::motion::{MotionPlan, MotionReport, measure};
use crate::ui::session::picture_role::PictureRole;
use crate::ui::task::{BackgroundTask, TaskStatus};
use crate::upscale::Upscaling;

/// Selectable numbers of measured frames.
pub(crate) const FRAMES: [u32; 4] = [12, 24, 48, 96];

/// Number of samples per pixel of the references.
const SAMPLES: u32 = 16;

/// Measurement over time: what to measure and to show, and the last result.
#[derive(Debug)]
pub(crate) struct OverTime {
    /// Plotted metric, one that every measurement has.
    pub(crate) metric: Metric,
    /// Number of frames to measure, from frame 0 on.
    pub(crate) frames: u32,
    /// Last result.
    pub(crate) found: Option<Arc<MeasuredClip>>,
    /// Completed fraction of the running measurement, from 0 to 1; `None` if none is running.
    pub(crate) progress: Option<f32>,
    /// Whether a measurement was requested and has not begun.
    wanted: bool,
    task: Option<BackgroundTask<f32, MeasuredClip>>,
}

/// Result of a measurement with its plan.
#[derive(Debug)]
pub(crate) struct MeasuredClip {
    pub(crate) plan: MotionPlan,
    pub(crate) report: MotionReport,
}

impl Default for OverTime {
    fn default() -> Self {
        Self { metric: Metric::Flip, frames: 24, found: None, progress: None, wanted: false, task: None }
    }
}

/// Change of the measurement that the user requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OverTimeChange {
    /// Measures the compared upscalers.
    Measure,
    /// Stops the measurement and keeps the frames so far.
    Cancel,
    /// Plots this metric.
    Metric(Metric),
    /// Sets the number of frames of the next measurement.
    Frames(u32),
}

impl Feature for OverTime {
    type Change = OverTimeChange;

    fn apply(session: &mut Session, change: OverTimeChange) -> Option<WindowTask> {
        let is_still = session.scene_frame_count().is_none();
        let over_time = &mut session.features.over_time;
        match change {
            OverTimeChange::Measure if is_still => {
                session
                    .report(Severity::Error, "Nothing moves: open a scene in motion or add key views to a camera path");
            }
            OverTimeChange::Measure => over_time.wanted = true,
            OverTimeChange::Cancel => over_time.task.iter().for_each(BackgroundTask::cancel),
            OverTimeChange::Metric(metric) => over_time.metric = metric,
            OverTimeChange::Frames(frames) => over_time.frames = frames,
        }
        None
    }

    fn leave_scene(&mut self) {
        *self = Self { metric: self.metric, frames: self.frames, ..Self::default() };
    }
}

impl OverTime {
    /// Handles the result of a measurement. Returns `false` if its thread ended without one.
    fn poll(&mut self) -> bool {
        let Some(task) = &self.task else { return true };
        let status = task.poll(&mut self.progress);
        if matches!(status, TaskStatus::Running) {
            return true;
        }
        (self.task, self.progress) = (None, None);
        match status {
            TaskStatus::Ended(Some(found)) => self.found = Some(Arc::from(found)),
            TaskStatus::Ended(None) | TaskStatus::Running => {}
            TaskStatus::Lost => return false,
        }
        true
    }
}

/// Handles the result of the running measurement and starts a requested one. If `waits` is `true`, measures
/// synchronously instead of in a background thread.
pub(crate) fn step(session: &mut Session, context: &Context, waits: bool) {
    if !session.features.over_time.poll() {
        session.report(Severity::Error, "Measurement over time stopped: internal error");
    }
    if !session.has_size() || !std::mem::take(&mut session.features.over_time.wanted) {
        return;
    }
    let plan = session.plan_over_time();
    let over_time = &mut session.features.over_time;
    if waits {
        over_time.found = measured(plan, &|_| {}, &AtomicBool::new(false)).map(Arc::new);
        return;
    }
    over_time.progress = Some(0.0);
    over_time.task = Some(BackgroundTask::start(context.clone(), move |report_progress, stop| {
        measured(plan, report_progress, stop)
    }));
}

/// Measures a clip. Returns `None` if it is cancelled before the second frame.
fn measured(plan: MotionPlan, report_progress: &dyn Fn(f32), stop: &AtomicBool) -> Option<MeasuredClip> {
    let report = measure(&plan, &mut |done, of| {
        report_progress(done as f32 / of.max(1) as f32);
        !stop.load(Ordering::Relaxed)
    });
    // Only pictures, which the plan does not keep, can fail.
    let report = report.ok().flatten()?;
    Some(MeasuredClip { plan, report })
}

impl Session {
    /// Returns the motion of scene and camera in the window.
    fn shot(&self) -> Shot {
        let motion = CameraMotion::along(self.features.camera_path.followed());
        let frames_per_second = self.features.scene_time.frames_per_second.into();
        Shot::from_start(Arc::clone(&self.scene), self.state.camera, motion, frames_per_second)
    }

    /// Returns the recipes of the compared pictures, without those from files; without a comparison, the session's
    /// recipe.
    fn compared_recipes(&self) -> Vec<Recipe> {
        let tiles = &self.state.tiles;
        let count = if self.features.comparison.is_on() { self.features.comparison.shown(tiles) } else { 0 };
        let drawn = (0..count).filter(|tile| tiles.file(PictureRole::Tile(*tile)).is_none());
        let recipes: Vec<_> = drawn.map(|tile| tiles.recipe(tile, self.state.recipe)).collect();
        if recipes.is_empty() { vec![self.state.recipe] } else { recipes }
    }

    /// Returns the measurement of the compared upscalers, or of the present upscaler and of native rendering.
    fn plan_over_time(&self) -> MotionPlan {
        let mut upscalers: Vec<Upscaling> = Vec::new();
        let compares = self.features.comparison.is_on();
        let native = (!compares).then_some(Upscaling::NATIVE);
        for upscaler in native.into_iter().chain(self.compared_recipes().iter().map(|recipe| recipe.upscaler)) {
            if !upscalers.contains(&upscaler) {
                upscalers.push(upscaler);
            }
        }
        MotionPlan {
            shot: self.shot(),
            recipe: Recipe { wireframe: false, ..self.state.recipe },
            upscalers,
            viewport: self.viewport(),
            frames: self.features.over_time.frames,
            samples: SAMPLES,
            pixels_per_degree: Viewing::default().pixels_per_degree,
            keeps_pictures: false,
        }
    }

    /// Whether a result was measured with the scene, the camera path, the settings and the size of the window.
    pub(crate) fn is_measured_now(&self, clip: &MeasuredClip) -> bool {
        let MotionPlan { shot, recipe, viewport, upscalers, .. } = &clip.plan;
        let now = self.plan_over_time();
        let upscaler = Upscaling::NATIVE;
        let same_recipe = Recipe { upscaler, ..*recipe } == Recipe { upscaler, ..now.recipe };
        shot.is_same(&now.shot) && same_recipe && (viewport, upscalers) == (&now.viewport, &now.upscalers)
    }

    /// Returns the animation of the compared methods over one loop, side by side.
    ///
    /// # Errors
    /// Returns the reason if nothing moves or the animation is too large.
    pub(crate) fn animation(&self, format: AnimationFormat) -> Result<AnimationPlan, String> {
        const STILL: &str = "Nothing moves: open a scene in motion or add key views to a camera path";
        let frames = self.scene_frame_count().ok_or(STILL)?;
        let recipes = self.compared_recipes();
        let is_single = recipes.len() == 1;
        let method = |(letter, recipe): (char, Recipe)| {
            let label = recipe.upscaler.label();
            AnimatedMethod { label: if is_single { label } else { format!("{letter}: {label}") }, recipe }
        };
        let plan = AnimationPlan {
            shot: self.shot(),
            methods: ('A'..='Z').zip(recipes).map(method).collect(),
            viewport: self.viewport(),
            frames: u32::try_from(frames).unwrap_or(u32::MAX),
            arrangement: Arrangement::SideBySide,
            format,
        };
        plan.check().map(|()| plan)
    }
}
