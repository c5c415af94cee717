//! Errors of a moving view: each frame of a sequence against the reference of the same frame.
//!
//! A temporal method can equal its reference once the view rests and still be far from it while the view moves. Methods
//! are therefore compared over a sequence: the camera orbits its target by a constant angle per frame and ends at the
//! given view. Methods that read earlier frames see [`Turn::WARM_UP`] more frames before those that count.

use std::sync::Arc;

use serde::Serialize;

use super::against::{Figures, figures};
use super::reference::{Gathering, Reference};
use crate::chain::{KeepDepth, Recipe, Renderer};
use crate::image::{Image, Rgba8};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

/// A camera that orbits its target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Turn {
    /// Angle between two frames in degrees; 0 measures the still view alone.
    pub degrees: f32,
    /// Number of frames that are measured, at least 1.
    pub frames: u32,
}

impl Turn {
    /// Frames that precede the measured ones for methods that read earlier frames; longer than the memory of every method.
    pub const WARM_UP: u32 = 20;

    /// Returns a turn by `degrees` per frame over the default number of frames, or the still view for 0°.
    pub fn by(degrees: f32) -> Self {
        let frames = if degrees == 0.0 { 1 } else { Self::default().frames };
        Self { degrees, frames }
    }

    /// Returns the camera `frames_before` frames before the last one, which sees the view `last`.
    pub fn camera(&self, last: &Camera, frames_before: u32) -> Camera {
        let mut camera = *last;
        if self.degrees != 0.0 && frames_before > 0 {
            camera.orbit((-self.degrees * frames_before as f32).to_radians(), 0.0);
        }
        camera
    }
}

impl Default for Turn {
    fn default() -> Self {
        Self { degrees: 0.5, frames: 16 }
    }
}

/// The view at the end of a sequence.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// Scene that the camera sees.
    pub scene: &'a Arc<Scene>,
    /// The last camera of the sequence.
    pub camera: &'a Camera,
    /// Size of the pictures.
    pub viewport: Viewport,
    /// Motion of the camera up to this view.
    pub turn: Turn,
}

/// Error over the frames of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MotionError {
    /// Mean over the frames: MSE, SSIM, FLIP and differing pixels are averaged, PSNR is that of the mean MSE, and the largest
    /// difference is the largest of all frames.
    pub mean: Figures,
    /// Figures of the frame with the largest FLIP.
    pub worst: Figures,
}

impl MotionError {
    /// Summarizes the figures of each frame; `None` if there are none.
    pub fn of(frames: &[Figures]) -> Option<Self> {
        let worst = *frames.iter().max_by(|a, b| a.flip.total_cmp(&b.flip))?;
        let count = frames.len() as f64;
        let mean_of = |value: fn(&Figures) -> f64| frames.iter().map(value).sum::<f64>() / count;
        let mut mean = worst;
        mean.flip = mean_of(|figures| figures.flip);
        mean.codes.mse = mean_of(|figures| figures.codes.mse);
        mean.codes.psnr_db = 10.0 * (255.0 * 255.0 / mean.codes.mse).log10();
        mean.codes.ssim = mean_of(|figures| figures.codes.ssim);
        mean.codes.differing_pixels = mean_of(|figures| figures.codes.differing_pixels as f64).round() as u64;
        mean.codes.max_abs = frames.iter().map(|figures| figures.codes.max_abs).max()?;
        Some(Self { mean, worst })
    }
}

/// References of all measured frames, drawn piece by piece.
#[derive(Debug)]
pub struct References {
    reference: Reference,
    recipe: Recipe,
    gathering: Option<Gathering>,
    pictures: Vec<Image<Rgba8>>,
}

impl References {
    /// Prepares the references of a recipe's pipeline; nothing is drawn yet.
    pub fn new(reference: Reference, recipe: Recipe) -> Self {
        Self { reference, recipe, gathering: None, pictures: Vec::new() }
    }

    /// Draws at most one more sample per pixel; returns whether more remains to be drawn.
    pub fn step(&mut self, shot: &Shot<'_>) -> bool {
        let done = self.pictures.len() as u32;
        if done >= shot.turn.frames {
            return false;
        }
        let begin = || {
            let camera = shot.turn.camera(shot.camera, shot.turn.frames - 1 - done);
            self.reference.begin(shot.scene, &camera, &self.recipe, shot.viewport)
        };
        let gathering = self.gathering.get_or_insert_with(begin);
        if !gathering.step() {
            self.pictures.push(gathering.picture());
            self.gathering = None;
        }
        (self.pictures.len() as u32) < shot.turn.frames
    }

    /// Draws everything; `None` if it was cancelled.
    pub fn complete(mut self, shot: &Shot<'_>, cancelled: &dyn Fn() -> bool) -> Option<Self> {
        while self.step(shot) {
            if cancelled() {
                return None;
            }
        }
        Some(self)
    }

    /// Returns the reference of the last frame, which is that of the still view; `None` until it is drawn.
    pub fn still(&self) -> Option<&Image<Rgba8>> {
        self.pictures.last()
    }

    /// Returns the references of the frames drawn so far, in their order.
    pub fn pictures(&self) -> &[Image<Rgba8>] {
        &self.pictures
    }
}

/// Draws the sequence of one recipe frame by frame and compares each with its reference.
#[derive(Debug)]
pub struct MotionTest {
    recipe: Recipe,
    renderer: Renderer,
    /// Frames still to be drawn, including the current one.
    remaining: u32,
    figures: Vec<Figures>,
}

impl MotionTest {
    /// Prepares the sequence of `recipe`; nothing is drawn yet.
    pub fn new(recipe: Recipe, turn: Turn) -> Self {
        let reads_past = recipe.upscaler.upscaler().reads().past;
        let warm_up = if reads_past && turn.degrees != 0.0 { Turn::WARM_UP } else { 0 };
        Self { recipe, renderer: Renderer::default(), remaining: turn.frames + warm_up, figures: Vec::new() }
    }

    /// Draws the next frame. Returns the error once the last frame is measured; `None` before that.
    pub fn step(&mut self, shot: &Shot<'_>, references: &References) -> Option<MotionError> {
        self.remaining = self.remaining.checked_sub(1)?;
        let camera = shot.turn.camera(shot.camera, self.remaining);
        let frame = if shot.turn.degrees == 0.0 {
            self.renderer.render_settled(shot.scene, &camera, &self.recipe, shot.viewport)
        } else {
            self.renderer.render(shot.scene, &camera, &self.recipe, shot.viewport, KeepDepth::No)
        };
        if self.remaining < shot.turn.frames {
            let number = (shot.turn.frames - 1 - self.remaining) as usize;
            let reference = references.pictures().get(number)?;
            self.figures.push(figures(frame.image(), reference)?.0);
        }
        self.renderer.recycle(frame);
        if self.remaining == 0 { MotionError::of(&self.figures) } else { None }
    }

    /// Whether all frames are drawn.
    pub fn is_complete(&self) -> bool {
        self.remaining == 0
    }

    /// Draws all frames; `None` if it was cancelled.
    pub fn complete(
        mut self,
        shot: &Shot<'_>,
        references: &References,
        cancelled: &dyn Fn() -> bool,
    ) -> Option<MotionError> {
        while !cancelled() {
            let error = self.step(shot, references);
            if self.is_complete() {
                return error;
            }
        }
        None
    }
}

/// Returns how far the sequence of recipe `b` is from that of recipe `a`, each frame from the same camera.
pub fn between(shot: &Shot<'_>, [a, b]: [&Recipe; 2]) -> Option<MotionError> {
    if shot.turn.degrees == 0.0 {
        let still = [a, b].map(|recipe| {
            Renderer::default().render_settled(shot.scene, shot.camera, recipe, shot.viewport).image().clone()
        });
        return MotionError::of(&[figures(&still[1], &still[0])?.0]);
    }
    let reads_past = |recipe: &Recipe| recipe.upscaler.upscaler().reads().past;
    let warm_up = if reads_past(a) || reads_past(b) { Turn::WARM_UP } else { 0 };
    let mut renderers = [(Renderer::default(), a), (Renderer::default(), b)];
    let mut measured = Vec::new();
    for remaining in (0..shot.turn.frames + warm_up).rev() {
        let camera = shot.turn.camera(shot.camera, remaining);
        let frames = renderers
            .each_mut()
            .map(|(renderer, recipe)| renderer.render(shot.scene, &camera, recipe, shot.viewport, KeepDepth::No));
        if remaining < shot.turn.frames {
            measured.push(figures(frames[1].image(), frames[0].image())?.0);
        }
        for ((renderer, _), frame) in renderers.iter_mut().zip(frames) {
            renderer.recycle(frame);
        }
    }
    MotionError::of(&measured)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::error::compare;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 96, height: 54 };

    fn error_of(upscaler: Upscaling, turn: Turn) -> MotionError {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        let references = References::new(Reference::Native, Recipe::default()).complete(&shot, &|| false).unwrap();
        let recipe = Recipe { upscaler, ..Recipe::default() };
        MotionTest::new(recipe, turn).complete(&shot, &references, &|| false).unwrap()
    }

    #[test]
    fn native_has_no_error_in_motion() {
        let error = error_of(Upscaling::NATIVE, Turn { degrees: 0.5, frames: 3 });
        assert_eq!((error.mean.codes.mse, error.worst.flip), (0.0, 0.0));
    }

    #[test]
    fn a_temporal_method_that_is_exact_at_rest_has_an_error_in_motion() {
        let temporal = Upscaling::new("checkerboard-temporal", 1).unwrap();
        assert_eq!(error_of(temporal, Turn::by(0.0)).mean.codes.mse, 0.0);
        let moving = error_of(temporal, Turn { degrees: 0.5, frames: 3 });
        assert!(moving.mean.codes.mse > 0.0 && moving.worst.flip >= moving.mean.flip, "{moving:?}");
    }

    #[test]
    fn each_frame_is_compared_with_the_reference_of_its_own_camera() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let turn = Turn { degrees: 2.0, frames: 3 };
        let bilinear = Recipe { upscaler: Upscaling::new("bilinear", 2).unwrap(), ..Recipe::default() };
        let mean_mse = (0..3).map(|frame| {
            let mut camera = scene.home;
            camera.orbit((2.0 * (frame as f32 - 2.0)).to_radians(), 0.0);
            let draw = |recipe| Renderer::default().render_settled(&scene, &camera, recipe, SIZE);
            compare(draw(&bilinear).image(), draw(&Recipe::default()).image()).unwrap().mse
        });
        let mean_mse = mean_mse.sum::<f64>() / 3.0;
        assert!((error_of(bilinear.upscaler, turn).mean.codes.mse - mean_mse).abs() < 1e-9 * mean_mse);
    }

    #[test]
    fn two_recipes_are_compared_frame_by_frame() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let temporal = Upscaling::new("checkerboard-temporal", 1).unwrap();
        let recipe = Recipe { upscaler: temporal, ..Recipe::default() };
        let turn = Turn { degrees: 0.5, frames: 3 };
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        assert_eq!(between(&shot, [&Recipe::default(), &recipe]), Some(error_of(temporal, turn)));
        let still = Shot { turn: Turn::by(0.0), ..shot };
        assert_eq!(between(&still, [&Recipe::default(), &recipe]), Some(error_of(temporal, still.turn)));
    }

    #[test]
    fn a_cancelled_sequence_has_no_error() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn: Turn::default() };
        assert!(References::new(Reference::Native, Recipe::default()).complete(&shot, &|| true).is_none());
    }
}
