//! Playback of a sequence, with the earlier frames that the history of a frame depends on.

use std::ops::Range;

use super::{FrameSequence, Turn};
use crate::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer};
use crate::math::lanes::Lanes;

/// Playback of a sequence with one recipe. Before a frame is drawn, the earlier frames that its temporal history
/// depends on are drawn, unless they were drawn already.
#[derive(Debug)]
pub(crate) struct Playback {
    pub(super) recipe: Recipe,
    lanes: Lanes,
    /// Renderer that keeps the temporal history; `None` for recipes that read no earlier frame.
    history: Option<RenderRun>,
}

/// Consecutive frames drawn by one renderer.
#[derive(Debug)]
struct RenderRun {
    renderer: Renderer,
    /// Range of frame numbers drawn so far. In a still view, every frame is the same, and the numbers count the
    /// repetitions from 0.
    frames: Range<i64>,
}

impl Playback {
    /// Creates a playback for `recipe` with the best instruction set of the processor; draws nothing yet.
    pub(crate) fn new(recipe: Recipe) -> Self {
        Self::on(recipe, Lanes::best())
    }

    /// Creates a playback for `recipe` with the given instruction set; draws nothing yet.
    pub(crate) fn on(recipe: Recipe, lanes: Lanes) -> Self {
        let reads_past = recipe.upscaler.upscaler().reads().history;
        let history = reads_past.then(|| RenderRun { renderer: Renderer::on(lanes), frames: 0..0 });
        Self { recipe, lanes, history }
    }

    /// Draws the next frame that is missing from the history of frame `number`, if any. Returns whether a frame was
    /// drawn. `number` must be greater than −[`Turn::WARM_UP`].
    pub(crate) fn warm_up(&mut self, shot: &FrameSequence<'_>, number: i64) -> bool {
        let Some(run) = &mut self.history else { return false };
        let converges_after = self.recipe.upscaler.upscaler().converges_after(self.recipe.upscaler);
        let Some(missing) = run.missing(shot.turn, number, converges_after) else { return false };
        if missing != run.frames.end || run.frames.is_empty() {
            // History from another position in the sequence would leak into the image.
            *run = RenderRun { renderer: Renderer::on(self.lanes), frames: missing..missing };
        }
        run.draw(shot, &self.recipe, missing, |_| ());
        true
    }

    /// First draws the frames that are missing from the history of frame `number`, then draws this frame. Calls `look`
    /// with it and returns the result of `look`. Recipes without history use the renderer `shared`.
    pub(crate) fn draw<T>(
        &mut self,
        shot: &FrameSequence<'_>,
        number: i64,
        shared: &mut Renderer,
        look: impl FnOnce(&Frame) -> T,
    ) -> T {
        while self.warm_up(shot, number) {}
        match &mut self.history {
            Some(run) => run.draw(shot, &self.recipe, number, look),
            None => drawn(shot, number, &self.recipe, shared, look),
        }
    }

    /// Returns the bytes held by the renderer of a recipe with history; 0 without history.
    pub(crate) fn bytes(&self) -> usize {
        self.history.as_ref().map_or(0, |run| run.renderer.bytes())
    }
}

impl RenderRun {
    /// Returns the number of the frame to draw next to build the history of frame `number`, or `None` if that history
    /// is complete. A still view is drawn at least until its history has converged.
    fn missing(&self, turn: Turn, number: i64, converges_after: u32) -> Option<i64> {
        let warm_up = i64::from(Turn::WARM_UP);
        let Range { start, end } = self.frames;
        if turn.is_still() {
            return (end - start < warm_up.max(converges_after.into())).then_some(end);
        }
        // Every playback starts at the same frame: accumulated history depends on how many frames were drawn before.
        if start != -warm_up || number < end { Some(-warm_up) } else { (number > end).then_some(end) }
    }

    fn draw<T>(&mut self, shot: &FrameSequence<'_>, recipe: &Recipe, number: i64, look: impl FnOnce(&Frame) -> T) -> T {
        self.frames.end += 1;
        drawn(shot, number, recipe, &mut self.renderer, look)
    }
}

/// Draws frame `number`, calls `look` with it, and returns the result.
fn drawn<T>(
    shot: &FrameSequence<'_>,
    number: i64,
    recipe: &Recipe,
    renderer: &mut Renderer,
    look: impl FnOnce(&Frame) -> T,
) -> T {
    let (scene, camera) = shot.view(number);
    let frame = renderer
        .render(RenderInputs { scene: &scene, camera: &camera, recipe, viewport: shot.viewport }, KeepDepth::No);
    let seen = look(&frame);
    renderer.recycle(frame);
    seen
}
