//! Tiles of a scene in motion: every method with history has a renderer of its own, so that the tiles show it with the
//! history of the same frames.

use std::sync::Arc;

use super::request::CompareRequest;
use crate::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer};
use crate::image::{Image, Rgba8};
use crate::measure::checkpoints::Checkpoints;
use crate::measure::shot::{ShotInputs, ShotRenderer};
use crate::ui::engine::replay::ReplayProgress;
use crate::ui::engine::{CATCH_UP_TIME, CHECKPOINT_BYTES};

/// Renderers of the tiles of a scene in motion, one for each recipe with history.
#[derive(Debug, Default)]
pub(super) struct MovingTiles {
    tiles: Vec<MovingTile>,
}

#[derive(Debug)]
struct MovingTile {
    renderer: ShotRenderer,
    checkpoints: Checkpoints,
    /// Renderer with the history of the frames shown, while frames are missing from that of `renderer`.
    shown: Option<Renderer>,
}

/// Picture of a tile.
#[derive(Debug)]
pub(super) struct MovingPicture {
    pub(super) picture: Arc<Image<Rgba8>>,
    /// Fraction of the picture's pixels that were rasterized and shaded, from 0 to 1.
    pub(super) drawn_share: f64,
    /// Progress of drawing the frames before this one; `None` if none is missing.
    pub(super) replay: Option<ReplayProgress>,
}

/// Progress of a tile after one step.
pub(super) enum MovingStep {
    /// One more frame was drawn.
    Drawn(ReplayProgress),
    /// The picture was drawn with the history of all frames.
    Complete(MovingPicture),
}

impl MovingTiles {
    /// Keeps the renderers of the recipes of a request, and creates those that are missing.
    pub(super) fn prepare(&mut self, request: &CompareRequest) {
        let mut old = std::mem::take(&mut self.tiles);
        for (inputs, _) in request.recipes.iter().filter_map(|recipe| request.moving(recipe)) {
            if self.of(&inputs).is_none() {
                self.tiles.push(MovingTile::succeeding(&mut old, inputs));
            }
        }
        let limit = CHECKPOINT_BYTES / self.tiles.len().max(1);
        self.tiles.iter_mut().for_each(|tile| tile.checkpoints.limit(limit));
    }

    /// Draws the frame of a request with a prepared recipe. If frames are missing, the picture has the history of the
    /// frames shown. Returns `None` if the frame has no history with this recipe.
    pub(super) fn draw(&mut self, request: &CompareRequest, recipe: &Recipe) -> Option<MovingPicture> {
        let (inputs, number) = request.moving(recipe)?;
        let tile = self.of(&inputs)?;
        let is_complete = tile.checkpoints.catch_up(&mut tile.renderer, number, CATCH_UP_TIME);
        Some(if is_complete { tile.complete(number) } else { tile.preview(request, recipe, number) })
    }

    /// Draws one frame that is missing before the frame of a request, or else this frame.
    pub(super) fn step(&mut self, request: &CompareRequest, recipe: &Recipe) -> Option<MovingStep> {
        let (inputs, number) = request.moving(recipe)?;
        let tile = self.of(&inputs)?;
        let is_drawn = tile.checkpoints.warm_up(&mut tile.renderer, number);
        Some(if is_drawn {
            MovingStep::Drawn(tile.progress(number))
        } else {
            MovingStep::Complete(tile.complete(number))
        })
    }

    fn of(&mut self, inputs: &ShotInputs) -> Option<&mut MovingTile> {
        self.tiles.iter_mut().find(|tile| tile.renderer.inputs().is_same(inputs))
    }
}

impl MovingTile {
    /// Returns the tile with the same inputs, or a new one that shows the history of a tile with the same recipe.
    fn succeeding(old: &mut Vec<Self>, inputs: ShotInputs) -> Self {
        if let Some(place) = old.iter().position(|tile| tile.renderer.inputs().is_same(&inputs)) {
            return old.swap_remove(place);
        }
        let is_same_method = |tile: &Self| tile.renderer.inputs().recipe == inputs.recipe;
        let shown = old.iter().position(is_same_method).map(|place| {
            let Self { renderer, shown, .. } = old.swap_remove(place);
            shown.unwrap_or_else(|| renderer.into_renderer())
        });
        Self { renderer: ShotRenderer::new(inputs), checkpoints: Checkpoints::within(CHECKPOINT_BYTES), shown }
    }

    fn progress(&self, number: u32) -> ReplayProgress {
        let missing = self.checkpoints.missing(self.renderer.inputs(), number, self.renderer.history_frames());
        ReplayProgress { done: number - missing, of: number + 1 }
    }

    /// Draws a frame with the history of all frames.
    fn complete(&mut self, number: u32) -> MovingPicture {
        self.shown = None;
        let frame = self.checkpoints.draw(&mut self.renderer, number, KeepDepth::No);
        let picture = MovingPicture::of(&frame, None);
        self.renderer.recycle(frame);
        picture
    }

    /// Draws a frame with the history of the frames shown.
    fn preview(&mut self, request: &CompareRequest, recipe: &Recipe, number: u32) -> MovingPicture {
        let progress = self.progress(number);
        let shown = self.shown.get_or_insert_with(|| {
            let mut renderer = Renderer::default();
            self.renderer.history().into_iter().for_each(|history| renderer.restore_history(history));
            renderer
        });
        let frame = shown.render(
            RenderInputs { scene: &request.scene, camera: &request.camera, recipe, viewport: request.viewport },
            KeepDepth::No,
        );
        let picture = MovingPicture::of(&frame, Some(progress));
        shown.recycle(frame);
        picture
    }
}

impl MovingPicture {
    fn of(frame: &Frame, replay: Option<ReplayProgress>) -> Self {
        Self { picture: Arc::new(frame.image().clone()), drawn_share: frame.drawn_share(), replay }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::measure::against::figures;
    use crate::measure::reference::Reference;
    use crate::measure::shot::{CameraMotion, Shot, ShotFrame};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::{Scene, builtin};
    use crate::ui::session::compare::compute::{Compared, Comparer};
    use crate::ui::session::compare::files::ComparedFiles;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 32, height: 24 };

    fn shot() -> Shot {
        let scene: Arc<Scene> = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let camera = scene.home;
        Shot::from_start(scene, camera, CameraMotion::Still, 30.0)
    }

    fn request(shot: &Shot, number: i64, methods: &[&str]) -> CompareRequest {
        let (scene, camera) = shot.view(number);
        let recipe = |method: &&str| Recipe { upscaler: Upscaling::new(method, 2).unwrap(), ..Recipe::default() };
        CompareRequest {
            scene,
            camera,
            sequence: Some(ShotFrame { shot: shot.clone(), number }),
            viewport: SIZE,
            recipes: methods.iter().map(recipe).collect(),
            files: ComparedFiles::default(),
            reference: Reference::Native,
            region: None,
            difference: None,
        }
    }

    /// Asserts that every tile has the picture of all frames from frame 0 on.
    fn assert_complete(compared: &Compared, shot: &Shot, number: u32) {
        for tile in &compared.tiles {
            assert!(tile.replay.is_none());
            let inputs = ShotInputs { shot: shot.clone(), recipe: tile.recipe, viewport: SIZE };
            let frame = ShotRenderer::new(inputs).draw(number, KeepDepth::No);
            assert!(tile.picture.as_ref() == frame.image(), "{} frame {number}", tile.title());
        }
    }

    /// Completes a request. No tile may be measured before its history is complete.
    fn complete(comparer: &mut Comparer, request: CompareRequest) -> Compared {
        let mut last = comparer.start(request).clone();
        while comparer.has_work() {
            if let Some(compared) = comparer.step() {
                assert!(compared.tiles.iter().all(|tile| tile.replay.is_none() || tile.measured.is_none()));
                last = compared.clone();
            }
        }
        last
    }

    const METHODS: [&str; 6] = ["taa", "fsr2", "sgsr2", "accumulation", "bilinear", "taa"];

    #[test]
    fn tiles_follow_consecutive_frames() {
        let (shot, mut comparer) = (shot(), Comparer::default());
        for number in 0..12 {
            let compared = comparer.start(request(&shot, number, &METHODS)).clone();
            assert_complete(&compared, &shot, number as u32);
        }
    }

    #[test]
    fn after_a_jump_tiles_are_replayed_and_measured_against_the_reference_of_the_frame() {
        let (shot, mut comparer) = (shot(), Comparer::default());
        for number in [13, 30, 29, 11] {
            let wanted = request(&shot, number, &METHODS);
            let compared = complete(&mut comparer, wanted.clone());
            assert!(compared.complete && compared.tiles.len() == METHODS.len());
            assert_complete(&compared, &shot, number as u32);
            let reference = run(&wanted.scene, &wanted.camera, &Recipe::default(), SIZE, &mut ());
            for tile in &compared.tiles {
                let (expected, _) = figures(&tile.picture, reference.image()).unwrap();
                let measured = tile.measured.as_ref().unwrap().figures.unwrap();
                assert_eq!(measured, expected, "{} frame {number}", tile.title());
            }
        }
    }

    #[test]
    fn tiles_are_complete_at_once_after_a_dropped_frame_and_a_step_back() {
        let (shot, mut comparer) = (shot(), Comparer::default());
        for number in [0, 2, 5, 4, 3] {
            let compared = comparer.start(request(&shot, number, &METHODS)).clone();
            assert_complete(&compared, &shot, number as u32);
        }
    }

    #[test]
    fn another_camera_or_size_draws_the_frames_of_the_tiles_again() {
        let (shot, mut comparer) = (shot(), Comparer::default());
        complete(&mut comparer, request(&shot, 3, &METHODS));
        let mut turned = shot;
        turned.camera.orbit(0.3, 0.0);
        let compared = complete(&mut comparer, request(&turned, 3, &METHODS));
        assert_complete(&compared, &turned, 3);
        let viewport = Viewport { width: SIZE.width - 2, ..SIZE };
        let compared = complete(&mut comparer, CompareRequest { viewport, ..request(&turned, 3, &["taa"]) });
        let inputs = ShotInputs { shot: turned, recipe: compared.tiles[0].recipe, viewport };
        assert!(compared.tiles[0].picture.as_ref() == ShotRenderer::new(inputs).draw(3, KeepDepth::No).image());
    }

    #[test]
    fn a_cancelled_replay_rests_and_is_not_measured_until_another_request() {
        let (shot, mut comparer) = (shot(), Comparer::default());
        let first = request(&shot, 30, &["taa", "bilinear"]);
        comparer.start(first.clone());
        comparer.step();
        comparer.cancel_replay();
        let rest = |comparer: &mut Comparer, request: CompareRequest| {
            let mut last = comparer.start(request).clone();
            for _ in 0..20 {
                last = comparer.step().cloned().unwrap_or(last);
            }
            assert!(!comparer.has_work());
            last
        };
        let rested = rest(&mut comparer, first.clone());
        let [taa, bilinear] = &rested.tiles[..] else { panic!("two tiles") };
        assert!(taa.replay.is_some() && taa.measured.is_none());
        assert!(bilinear.measured.as_ref().is_some_and(|measured| measured.figures.is_some()));
        let other_recipes = CompareRequest { recipes: request(&shot, 30, &["taa", "nearest"]).recipes, ..first };
        for (number, other) in [(30, other_recipes), (29, request(&shot, 29, &["taa", "bilinear"]))] {
            comparer.cancel_replay();
            let compared = complete(&mut comparer, other);
            assert_complete(&compared, &shot, number);
            assert!(compared.tiles.iter().all(|tile| tile.measured.is_some()));
        }
    }

    #[test]
    fn a_picture_without_its_history_says_so_until_another_frame_is_requested() {
        let (shot, mut comparer) = (shot(), Comparer::default());
        let jumped = comparer.start(request(&shot, 30, &["taa", "bilinear"])).clone();
        let progress = jumped.tiles[0].replay;
        assert_eq!(progress, Some(ReplayProgress { done: 0, of: 31 }));
        assert!(jumped.tiles[1].replay.is_none(), "a method without history lacks no frames");
        let shown: Vec<_> = (0..20).filter_map(|_| comparer.step().map(|compared| compared.tiles[0].replay)).collect();
        assert_eq!(shown, [8, 16].map(|done| Some(ReplayProgress { done, of: 31 })));
        let compared = complete(&mut comparer, request(&shot, 4, &["taa", "bilinear"]));
        assert_complete(&compared, &shot, 4);
    }

    #[test]
    fn a_frame_between_two_frames_is_a_still_view() {
        let (shot, mut comparer) = (shot(), Comparer::default());
        let scene = shot.scene.at(0.51 / 30.0);
        let between = CompareRequest { scene, ..request(&shot, 1, &["taa"]) };
        let compared = complete(&mut comparer, between.clone());
        let still = Renderer::default().render_converged(RenderInputs {
            scene: &between.scene,
            camera: &between.camera,
            recipe: &between.recipes[0],
            viewport: SIZE,
        });
        assert!(compared.tiles[0].picture.as_ref() == still.image());
    }
}
