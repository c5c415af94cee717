//! Errors of a moving view: each frame of a sequence against the reference of the same frame.
//!
//! A temporal method can equal its reference once the view rests and still be far from it while the view moves. Methods
//! are therefore compared over a sequence: the camera orbits its target by a constant angle per frame and ends at the
//! given view. Methods that read earlier frames see [`Turn::WARM_UP`] more frames before those that count. [`Playback`] draws
//! such frames, whether to time them or to judge them: equal numbers are equal pictures, bit for bit.

use std::ops::Range;
use std::sync::Arc;

use serde::Serialize;

use super::against::{Figures, Standard, figures};
use super::reference::{Gathering, Reference};
use crate::chain::{Frame, KeepDepth, Recipe, Renderer};
use crate::image::Image;
use crate::math::lanes::Lanes;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

/// A camera that orbits its target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Turn {
    /// Angle between two frames in degrees; 0 is the still view.
    pub degrees: f32,
    /// Number of frames that are measured, at least 1.
    pub frames: u32,
}

impl Turn {
    /// A camera that stands still.
    pub const STILL: Self = Self { degrees: 0.0, frames: 1 };

    /// Frames that precede the measured ones for methods that read earlier frames; longer than the memory of every method.
    pub const WARM_UP: u32 = 20;

    /// Returns a turn by `degrees` per frame over the default number of frames, or the still view for 0°.
    pub fn by(degrees: f32) -> Self {
        if degrees == 0.0 { Self::STILL } else { Self { degrees, ..Self::default() } }
    }

    /// Whether the camera stands still.
    pub fn is_still(&self) -> bool {
        self.degrees == 0.0
    }

    /// Returns the camera of frame `number`, counted from 0. The last frame sees the view `last`; negative numbers are frames
    /// before the measured ones.
    pub fn camera(&self, last: &Camera, number: i64) -> Camera {
        let mut camera = *last;
        let frames_before = i64::from(self.frames) - 1 - number;
        if !self.is_still() && frames_before != 0 {
            camera.orbit((-self.degrees * frames_before as f32).to_radians(), 0.0);
        }
        camera
    }

    /// Returns the number of the frame that round `round` of a timing run draws: the measured frames, again and again. Rounds of
    /// the warm-up have negative numbers, as have the frames before the measured ones.
    pub fn frame_of_round(&self, round: i64) -> i64 {
        if round < 0 { round } else { round % i64::from(self.frames) }
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
    /// Number of frames, at least 1.
    pub frames: usize,
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
        Some(Self { frames: frames.len(), mean, worst })
    }
}

/// Draws frames of a sequence by one recipe, each with the history that it has in the sequence.
#[derive(Debug)]
pub struct Playback {
    recipe: Recipe,
    lanes: Lanes,
    /// `None` for recipes that read no earlier frame.
    history: Option<Run>,
}

/// Consecutive frames that one renderer drew.
#[derive(Debug)]
struct Run {
    renderer: Renderer,
    /// Numbers of the frames. A still view is one frame drawn again and again, counted from 0.
    frames: Range<i64>,
}

impl Playback {
    /// Prepares to draw by `recipe`; nothing is drawn yet.
    pub fn new(recipe: Recipe) -> Self {
        Self::on(recipe, Lanes::best())
    }

    /// Prepares to draw by `recipe` on the given lanes.
    pub fn on(recipe: Recipe, lanes: Lanes) -> Self {
        let reads_past = recipe.upscaler.upscaler().reads().past;
        let history = reads_past.then(|| Run { renderer: Renderer::on(lanes), frames: 0..0 });
        Self { recipe, lanes, history }
    }

    /// Returns the recipe.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Draws at most one of the frames before frame `number` > −[`Turn::WARM_UP`] that the recipe's history depends on; returns
    /// whether there was one.
    pub fn warm_up(&mut self, shot: &Shot<'_>, number: i64) -> bool {
        let Some(run) = &mut self.history else { return false };
        let Some(missing) = run.missing(shot.turn, number) else { return false };
        if missing != run.frames.end || run.frames.is_empty() {
            // The history of another place of the sequence must not show.
            *run = Run { renderer: Renderer::on(self.lanes), frames: missing..missing };
        }
        run.draw(shot, &self.recipe, missing, |_| ());
        true
    }

    /// Draws frame `number`, after those that its history depends on, and returns what `look` makes of it. Recipes without
    /// history share a renderer.
    pub fn draw<T>(
        &mut self,
        shot: &Shot<'_>,
        number: i64,
        shared: &mut Renderer,
        look: impl FnOnce(&Frame) -> T,
    ) -> T {
        while self.warm_up(shot, number) {}
        match &mut self.history {
            Some(run) => run.draw(shot, &self.recipe, number, look),
            None => drawn(shot, number, (&self.recipe, shared), look),
        }
    }

    /// Returns the bytes that the renderer of a recipe with history holds; 0 without history.
    pub fn bytes(&self) -> usize {
        self.history.as_ref().map_or(0, |run| run.renderer.bytes())
    }
}

impl Run {
    /// Returns the number of the frame that has to be drawn next so that frame `number` has its history; `None` if it has it.
    fn missing(&self, turn: Turn, number: i64) -> Option<i64> {
        let warm_up = i64::from(Turn::WARM_UP);
        let Range { start, end } = self.frames;
        if turn.is_still() {
            return (end - start < warm_up).then_some(end);
        }
        // All playbacks begin at the same frame: what a method accumulates depends on the number of frames before.
        if start != -warm_up || number < end { Some(-warm_up) } else { (number > end).then_some(end) }
    }

    fn draw<T>(&mut self, shot: &Shot<'_>, recipe: &Recipe, number: i64, look: impl FnOnce(&Frame) -> T) -> T {
        self.frames.end += 1;
        drawn(shot, number, (recipe, &mut self.renderer), look)
    }
}

/// Draws frame `number` and returns what `look` makes of it.
fn drawn<T>(
    shot: &Shot<'_>,
    number: i64,
    (recipe, renderer): (&Recipe, &mut Renderer),
    look: impl FnOnce(&Frame) -> T,
) -> T {
    let camera = shot.turn.camera(shot.camera, number);
    let frame = renderer.render(shot.scene, &camera, recipe, shot.viewport, KeepDepth::No);
    let seen = look(&frame);
    renderer.recycle(frame);
    seen
}

/// Judges recipes over a sequence piece by piece: each frame by every recipe, before the next frame.
#[derive(Debug)]
pub struct Judge {
    reference: Reference,
    playbacks: Vec<Playback>,
    renderer: Renderer,
    /// References of the present frame, each with the recipe that it is of. Recipes that differ in nothing but the upscaler
    /// share one.
    standards: Vec<(Recipe, Standard)>,
    gathering: Option<Box<Gathering>>,
    /// Figures of each recipe, frame by frame.
    figures: Vec<Vec<Figures>>,
    /// Number of frames judged, over all recipes.
    judged: usize,
}

impl Judge {
    /// Prepares to judge recipes against a reference; nothing is drawn yet.
    pub fn new(reference: Reference, recipes: impl IntoIterator<Item = Recipe>) -> Self {
        let playbacks: Vec<_> = recipes.into_iter().map(Playback::new).collect();
        Self {
            reference,
            figures: vec![Vec::new(); playbacks.len()],
            playbacks,
            renderer: Renderer::default(),
            standards: Vec::new(),
            gathering: None,
            judged: 0,
        }
    }

    /// Draws at most one frame, of a reference or by a recipe. If that completes a frame of a recipe, `look` sees it with every
    /// pixel's FLIP, and the number of the recipe is returned.
    pub fn step(&mut self, shot: &Shot<'_>, look: impl FnOnce(usize, &Frame, Image<f32>)) -> Option<usize> {
        if self.is_complete(shot.turn) {
            return None;
        }
        let (frame, place) = (self.judged / self.playbacks.len(), self.judged % self.playbacks.len());
        let playback = &mut self.playbacks[place];
        let plain = Recipe { upscaler: Upscaling::NATIVE, ..playback.recipe };
        let Some((_, standard)) = self.standards.iter().find(|(of, _)| *of == plain) else {
            let begin = || {
                let camera = shot.turn.camera(shot.camera, frame as i64);
                Box::new(self.reference.begin(shot.scene, &camera, &plain, shot.viewport))
            };
            let gathering = self.gathering.get_or_insert_with(begin);
            if !gathering.step() {
                self.standards.push((plain, Standard::new(gathering.picture())));
                self.gathering = None;
            }
            return None;
        };
        if playback.warm_up(shot, frame as i64) {
            return None;
        }
        let figures = playback.draw(shot, frame as i64, &mut self.renderer, |drawn| {
            let (figures, flip) = standard.figures(drawn.image())?;
            look(place, drawn, flip);
            Some(figures)
        });
        self.figures[place].extend(figures);
        self.judged += 1;
        if self.judged.is_multiple_of(self.playbacks.len()) {
            self.standards.clear();
        }
        Some(place)
    }

    /// Whether all frames are judged.
    pub fn is_complete(&self, turn: Turn) -> bool {
        self.judged >= self.total(turn)
    }

    /// Number of frames to judge, over all recipes.
    pub fn total(&self, turn: Turn) -> usize {
        self.playbacks.len() * turn.frames as usize
    }

    /// Number of frames judged, over all recipes.
    pub fn judged(&self) -> usize {
        self.judged
    }

    /// Returns the error of a recipe over the frames judged so far; `None` before the first.
    pub fn error(&self, recipe: usize) -> Option<MotionError> {
        MotionError::of(self.figures.get(recipe)?)
    }
}

/// Returns how far the sequence of recipe `b` is from that of recipe `a`, each frame from the same camera. `go_on` is called
/// before each frame with the share that is done, and returns whether to go on; if not, there is no error.
pub fn between(shot: &Shot<'_>, [a, b]: [&Recipe; 2], go_on: &mut dyn FnMut(f32) -> bool) -> Option<MotionError> {
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
    use crate::measure::error::compare;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 48, height: 32 };

    fn error_of(upscaler: Upscaling, turn: Turn) -> MotionError {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        judged(&shot, upscaler).error(0).unwrap()
    }

    fn judged(shot: &Shot<'_>, upscaler: Upscaling) -> Judge {
        let mut judge = Judge::new(Reference::Native, [Recipe { upscaler, ..Recipe::default() }]);
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
        let error = error_of(Upscaling::NATIVE, Turn { degrees: 0.5, frames: 3 });
        assert_eq!((error.frames, error.mean.codes.mse, error.worst.flip), (3, 0.0, 0.0));
    }

    #[test]
    fn a_temporal_method_that_is_exact_at_rest_has_an_error_in_motion() {
        assert_eq!(error_of(temporal(), Turn::STILL).mean.codes.mse, 0.0);
        let moving = error_of(temporal(), Turn { degrees: 0.5, frames: 3 });
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
    fn recipes_of_several_pipelines_have_references_of_their_own() {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let turn = Turn { degrees: 0.5, frames: 2 };
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        let mut other = Recipe::default();
        other.set("shading=normals").unwrap();
        let mut judge = Judge::new(Reference::Native, [Recipe::default(), other]);
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
        let turn = Turn { degrees: 0.5, frames: 4 };
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
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
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn: Turn::STILL };
        let recipe = Recipe { upscaler: Upscaling::new("accumulation", 2).unwrap(), ..Recipe::default() };
        let settled = Renderer::default().render_settled(&scene, &scene.home, &recipe, SIZE);
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
        let turn = Turn { degrees: 0.5, frames: 3 };
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn };
        let mut shares = Vec::new();
        let error = between(&shot, [&Recipe::default(), &recipe], &mut |share| {
            shares.push(share);
            true
        });
        assert_eq!(error, Some(error_of(temporal(), turn)));
        assert!(shares.is_sorted() && shares.contains(&0.0) && shares.last() < Some(&1.0), "{shares:?}");
        let still = Shot { turn: Turn::STILL, ..shot };
        let error = between(&still, [&Recipe::default(), &recipe], &mut |_| true);
        assert_eq!(error, Some(error_of(temporal(), still.turn)));
    }

    #[test]
    fn a_cancelled_comparison_has_no_error_and_draws_no_further() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let shot = Shot { scene: &scene, camera: &scene.home, viewport: SIZE, turn: Turn::default() };
        let temporal = Recipe { upscaler: temporal(), ..Recipe::default() };
        let mut calls = 0;
        let error = between(&shot, [&Recipe::default(), &temporal], &mut |_| {
            calls += 1;
            calls < 5
        });
        assert!(error.is_none() && calls < 10, "{calls} calls");
    }
}
