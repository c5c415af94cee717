//! Errors of a moving view: each frame of a sequence is compared with the reference of the same frame.
//!
//! A temporal method can match its reference in a still view, yet differ from it strongly in a moving view. Methods are
//! therefore compared over a sequence: the camera orbits its target by a constant angle per frame, and an animated scene
//! moves at a constant frame rate. Both end at the given view and pose. Methods that read earlier frames get [`Turn::WARM_UP`] more frames before the measured ones. [`Playback`]
//! draws such frames for timing and for error measurement: frames with the same number are bit-identical.

mod playback;

pub(crate) use playback::Playback;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::against::{ErrorMetrics, PreparedReference, figures};
use super::metric::Metric;
use super::reference::{ProgressiveRender, Reference};
use super::shot::{CameraMotion, Shot, ShotOrigin};
use crate::chain::{Frame, Recipe, Renderer};
use crate::image::Image;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

/// Motion of a sequence: a camera orbit around its target at a constant angle per frame, and the frame rate of animated
/// scenes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    /// Angle between two frames in degrees; 0 keeps the camera still.
    pub degrees: f32,
    /// Number of measured frames, at least 1.
    pub frames: u32,
    /// Number of frames per second of an animated scene; 0 keeps the scene in its pose.
    #[serde(default)]
    pub frames_per_second: f32,
}

impl Turn {
    /// Still view: a single frame without motion of camera and scene.
    pub const STILL: Self = Self { degrees: 0.0, frames: 1, frames_per_second: 0.0 };

    /// Number of warm-up frames in motion for methods that read earlier frames; what is older has little weight in them.
    pub const WARM_UP: u32 = 20;

    /// Returns an orbit of `degrees` per frame over the default number of frames, or a still view for 0°.
    pub fn by(degrees: f32) -> Self {
        if degrees == 0.0 { Self::STILL } else { Self { degrees, ..Self::default() } }
    }

    /// Whether neither the camera nor an animated scene moves.
    pub fn is_still(&self) -> bool {
        self.degrees == 0.0 && self.frames_per_second == 0.0
    }

    /// Returns the frames of the sequence, counted from 0; negative numbers are warm-up frames. The last frame has the scene
    /// and the camera that are given.
    pub fn shot(&self, last: &Arc<Scene>, camera: &Camera) -> Shot {
        let origin = ShotOrigin { number: i64::from(self.frames) - 1, time_s: last.time_s() };
        Shot {
            scene: Arc::clone(last),
            camera: *camera,
            motion: CameraMotion::Orbit { degrees_per_frame: self.degrees },
            frames_per_second: self.frames_per_second.into(),
            origin,
        }
    }

    /// Returns the number of the frame that a timing run draws in round `round`. A run repeats the measured frames in
    /// order. Warm-up rounds have negative numbers and draw warm-up frames.
    pub fn frame_of_round(&self, round: i64) -> i64 {
        if round < 0 { round } else { round % i64::from(self.frames) }
    }
}

impl Default for Turn {
    fn default() -> Self {
        Self { degrees: 0.5, frames: 16, frames_per_second: 30.0 }
    }
}

/// A frame sequence: final pose of the scene, final view, and motion.
#[derive(Clone, Copy, Debug)]
pub struct FrameSequence<'a> {
    /// Scene in the pose of the last frame.
    pub scene: &'a Arc<Scene>,
    /// Camera of the last frame.
    pub camera: &'a Camera,
    /// Size of every frame, in pixels.
    pub viewport: Viewport,
    /// Motion of camera and scene up to the final view and pose.
    pub turn: Turn,
}

impl FrameSequence<'_> {
    /// Returns the scene and the camera of frame `number`, counted from 0; negative numbers are warm-up frames.
    fn view(&self, number: i64) -> (Arc<Scene>, Camera) {
        self.turn.shot(self.scene, self.camera).view(number)
    }
}

/// Error over the frames of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionError {
    /// Number of measured frames, at least 1.
    pub frames: usize,
    /// Mean over the frames: MSE, SSIM, FLIP, the number of differing pixels and the selected metric are averaged. PSNR is
    /// computed from the mean MSE, and the largest difference is the maximum over all frames.
    pub mean: ErrorMetrics,
    /// Metrics of the frame with the largest FLIP error.
    pub worst: ErrorMetrics,
}

impl MotionError {
    /// Summarises the metrics of each frame. Returns `None` for an empty slice.
    pub fn of(frames: &[ErrorMetrics]) -> Option<Self> {
        let worst = *frames.iter().max_by(|a, b| a.flip.total_cmp(&b.flip))?;
        let count = frames.len() as f64;
        let mean_of = |value: fn(&ErrorMetrics) -> f64| frames.iter().map(value).sum::<f64>() / count;
        let mut mean = worst;
        mean.flip = mean_of(|figures| figures.flip);
        mean.codes.mse = mean_of(|figures| figures.codes.mse);
        mean.codes.psnr_db = 10.0 * (255.0 * 255.0 / mean.codes.mse).log10();
        mean.codes.ssim = mean_of(|figures| figures.codes.ssim);
        mean.codes.differing_pixels = mean_of(|figures| figures.codes.differing_pixels as f64).round() as u64;
        let selected: Option<Vec<f64>> = frames.iter().map(|figures| figures.selected).collect();
        mean.selected = selected.map(|values| values.iter().sum::<f64>() / count);
        mean.codes.max_abs = frames.iter().map(|figures| figures.codes.max_abs).max()?;
        Some(Self { frames: frames.len(), mean, worst })
    }
}

/// Incremental error measurement of several recipes over a sequence. Each frame is drawn with every recipe before the
/// next frame.
#[derive(Debug)]
pub struct ErrorMeasurement {
    reference: Reference,
    playbacks: Vec<Playback>,
    renderer: Renderer,
    /// References of the current frame with their recipes. Recipes that differ only in the upscaler share a reference.
    references: Vec<(Recipe, PreparedReference)>,
    gathering: Option<Box<ProgressiveRender>>,
    /// Further metric to measure.
    selected: Option<Metric>,
    /// Metrics of each recipe, per frame.
    figures: Vec<Vec<ErrorMetrics>>,
    /// Number of frames measured, over all recipes.
    measured_frames: usize,
}

impl ErrorMeasurement {
    /// Prepares to measure recipes against a reference; draws nothing yet.
    pub fn new(reference: Reference, recipes: impl IntoIterator<Item = Recipe>) -> Self {
        let playbacks: Vec<_> = recipes.into_iter().map(Playback::new).collect();
        Self {
            reference,
            figures: vec![Vec::new(); playbacks.len()],
            playbacks,
            renderer: Renderer::default(),
            references: Vec::new(),
            gathering: None,
            selected: None,
            measured_frames: 0,
        }
    }

    /// Selects a metric to measure besides those of every measurement.
    pub fn selecting(self, metric: Metric) -> Self {
        Self { selected: (!ErrorMetrics::always_has(metric)).then_some(metric), ..self }
    }

    /// Draws at most one frame, either of a reference or with a recipe. When that completes a frame of a recipe, calls
    /// `look` with the frame and the FLIP error of every pixel, and returns the index of the recipe.
    pub fn step(&mut self, shot: &FrameSequence<'_>, look: impl FnOnce(usize, &Frame, Image<f32>)) -> Option<usize> {
        if self.is_complete(shot.turn) {
            return None;
        }
        let (frame, place) = (self.measured_frames / self.playbacks.len(), self.measured_frames % self.playbacks.len());
        let playback = &mut self.playbacks[place];
        let plain = Recipe { upscaler: Upscaling::NATIVE, ..playback.recipe };
        let Some((_, standard)) = self.references.iter().find(|(of, _)| *of == plain) else {
            let begin = || {
                let (scene, camera) = shot.view(frame as i64);
                Box::new(self.reference.begin(&scene, &camera, &plain, shot.viewport))
            };
            let gathering = self.gathering.get_or_insert_with(begin);
            if !gathering.step() {
                self.references.push((plain, PreparedReference::new(gathering.picture())));
                self.gathering = None;
            }
            return None;
        };
        if playback.warm_up(shot, frame as i64) {
            return None;
        }
        let selected = self.selected;
        let figures = playback.draw(shot, frame as i64, &mut self.renderer, |drawn| {
            let (mut figures, flip) = standard.figures(drawn.image())?;
            figures.selected = selected.and_then(|metric| standard.measure(drawn.image(), metric));
            look(place, drawn, flip);
            Some(figures)
        });
        self.figures[place].extend(figures);
        self.measured_frames += 1;
        if self.measured_frames.is_multiple_of(self.playbacks.len()) {
            self.references.clear();
        }
        Some(place)
    }

    /// Whether all frames of all recipes are measured.
    pub fn is_complete(&self, turn: Turn) -> bool {
        self.measured_frames >= self.total(turn)
    }

    /// Returns the number of frames to measure, over all recipes.
    pub fn total(&self, turn: Turn) -> usize {
        self.playbacks.len() * turn.frames as usize
    }

    /// Returns the number of frames measured so far, over all recipes.
    pub fn measured_frames(&self) -> usize {
        self.measured_frames
    }

    /// Returns the error of a recipe over the frames measured so far, or `None` before the first.
    pub fn error(&self, recipe: usize) -> Option<MotionError> {
        MotionError::of(self.figures.get(recipe)?)
    }
}

/// Returns the error of recipe `b` against recipe `a` over a sequence; both draw each frame with the same camera.
/// `go_on` receives the completed fraction in [0, 1] before each frame and returns whether to continue. If `go_on`
/// returns `false`, the result is `None`.
pub fn between(
    shot: &FrameSequence<'_>,
    [a, b]: [&Recipe; 2],
    go_on: &mut dyn FnMut(f32) -> bool,
) -> Option<MotionError> {
    let mut playbacks = [a, b].map(|recipe| Playback::new(*recipe));
    let mut renderer = Renderer::default();
    let mut measured = Vec::new();
    for number in 0..shot.turn.frames {
        let share = number as f32 / shot.turn.frames as f32;
        for playback in &mut playbacks {
            while go_on(share) && playback.warm_up(shot, number.into()) {}
        }
        if !go_on(share) {
            return None;
        }
        let [a, b] = playbacks
            .each_mut()
            .map(|playback| playback.draw(shot, number.into(), &mut renderer, |frame| frame.image().clone()));
        measured.push(figures(&b, &a)?.0);
    }
    MotionError::of(&measured)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::RenderInputs;
    use crate::measure::error::compare;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 48, height: 32 };

    fn error_of(upscaler: Upscaling, turn: Turn) -> MotionError {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let shot = FrameSequence { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        judged(&shot, upscaler).error(0).unwrap()
    }

    fn judged(shot: &FrameSequence<'_>, upscaler: Upscaling) -> ErrorMeasurement {
        let mut judge = ErrorMeasurement::new(Reference::Native, [Recipe { upscaler, ..Recipe::default() }]);
        while !judge.is_complete(shot.turn) {
            judge.step(shot, |_, _, _| ());
        }
        judge
    }

    fn temporal() -> Upscaling {
        Upscaling::new("checkerboard-temporal", 1).unwrap()
    }

    #[test]
    fn native_has_no_error_in_motion() {
        let error = error_of(Upscaling::NATIVE, Turn { degrees: 0.5, frames: 3, ..Turn::STILL });
        assert_eq!((error.frames, error.mean.codes.mse, error.worst.flip), (3, 0.0, 0.0));
    }

    #[test]
    fn a_temporal_method_that_is_exact_at_rest_has_an_error_in_motion() {
        assert_eq!(error_of(temporal(), Turn::STILL).mean.codes.mse, 0.0);
        let moving = error_of(temporal(), Turn { degrees: 0.5, frames: 3, ..Turn::STILL });
        assert!(moving.mean.codes.mse > 0.0 && moving.worst.flip >= moving.mean.flip, "{moving:?}");
    }

    #[test]
    fn each_frame_is_compared_with_the_reference_of_its_own_camera() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let turn = Turn { degrees: 2.0, frames: 3, ..Turn::STILL };
        let bilinear = Recipe { upscaler: Upscaling::new("bilinear", 2).unwrap(), ..Recipe::default() };
        let mean_mse = (0..3).map(|frame| {
            let mut camera = scene.home;
            camera.orbit((2.0 * (frame as f32 - 2.0)).to_radians(), 0.0);
            let draw = |recipe| {
                Renderer::default().render_converged(RenderInputs {
                    scene: &scene,
                    camera: &camera,
                    recipe,
                    viewport: SIZE,
                })
            };
            compare(draw(&bilinear).image(), draw(&Recipe::default()).image()).unwrap().mse
        });
        let mean_mse = mean_mse.sum::<f64>() / 3.0;
        assert!((error_of(bilinear.upscaler, turn).mean.codes.mse - mean_mse).abs() < 1e-9 * mean_mse);
    }

    #[test]
    fn recipes_of_different_pipelines_have_separate_references() {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let turn = Turn { degrees: 0.5, frames: 2, ..Turn::STILL };
        let shot = FrameSequence { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        let mut other = Recipe::default();
        other.set("shading=normals").unwrap();
        let mut judge = ErrorMeasurement::new(Reference::Native, [Recipe::default(), other]);
        let mut order = Vec::new();
        while !judge.is_complete(turn) {
            order.extend(judge.step(&shot, |recipe, frame, flip| {
                assert!(recipe < 2 && flip.size() == frame.image().size());
            }));
        }
        assert_eq!(order, [0, 1, 0, 1], "each frame by every recipe before the next");
        assert_eq!([0, 1].map(|recipe| judge.error(recipe).unwrap().mean.flip), [0.0; 2]);
    }

    #[test]
    fn a_frame_has_the_same_history_wherever_playback_begins() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let turn = Turn { degrees: 0.5, frames: 4, ..Turn::STILL };
        let shot = FrameSequence { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        for upscaler in [temporal(), Upscaling::new("accumulation", 2).unwrap(), Upscaling::new("bilinear", 2).unwrap()]
        {
            let recipe = Recipe { upscaler, ..Recipe::default() };
            let (mut shared, mut forwards, mut jumping) =
                (Renderer::default(), Playback::new(recipe), Playback::new(recipe));
            let of = |playback: &mut Playback, shared: &mut Renderer, number: i64| {
                playback.draw(&shot, number, shared, |frame| frame.image().clone())
            };
            let frames: Vec<_> = (0..4).map(|number| of(&mut forwards, &mut shared, number)).collect();
            for number in [2, 3, 0] {
                let again = of(&mut jumping, &mut shared, number);
                assert!(again == frames[number as usize], "{} frame {number}", upscaler.label());
            }
        }
    }

    #[test]
    fn a_still_view_is_drawn_as_it_is_at_rest() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let shot = FrameSequence { scene: &scene, camera: &scene.home, viewport: SIZE, turn: Turn::STILL };
        let recipe = Recipe { upscaler: Upscaling::new("accumulation", 2).unwrap(), ..Recipe::default() };
        let settled = Renderer::default().render_converged(RenderInputs {
            scene: &scene,
            camera: &scene.home,
            recipe: &recipe,
            viewport: SIZE,
        });
        let (mut playback, mut shared) = (Playback::new(recipe), Renderer::default());
        for _ in 0..2 {
            assert!(playback.draw(&shot, 0, &mut shared, |frame| frame.image() == settled.image()));
        }
        assert!(!playback.warm_up(&shot, 0), "it is warm");
    }

    #[test]
    fn two_recipes_are_compared_frame_by_frame() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let recipe = Recipe { upscaler: temporal(), ..Recipe::default() };
        let turn = Turn { degrees: 0.5, frames: 3, ..Turn::STILL };
        let shot = FrameSequence { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        let mut shares = Vec::new();
        let error = between(&shot, [&Recipe::default(), &recipe], &mut |share| {
            shares.push(share);
            true
        });
        assert_eq!(error, Some(error_of(temporal(), turn)));
        assert!(shares.is_sorted() && shares.contains(&0.0) && shares.last() < Some(&1.0), "{shares:?}");
        let still = FrameSequence { turn: Turn::STILL, ..shot };
        let error = between(&still, [&Recipe::default(), &recipe], &mut |_| true);
        assert_eq!(error, Some(error_of(temporal(), still.turn)));
    }

    #[test]
    fn a_cancelled_comparison_has_no_error_and_draws_no_further() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let shot = FrameSequence { scene: &scene, camera: &scene.home, viewport: SIZE, turn: Turn::default() };
        let temporal = Recipe { upscaler: temporal(), ..Recipe::default() };
        let mut calls = 0;
        let error = between(&shot, [&Recipe::default(), &temporal], &mut |_| {
            calls += 1;
            calls < 5
        });
        assert!(error.is_none() && calls < 10, "{calls} calls");
    }
}
