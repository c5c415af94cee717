//! Rendering for comparisons: draws all tiles, measures their errors one by one, and reuses results that are still
//! valid.

use std::sync::Arc;

use super::files::{OpenedPicture, is_same};
use super::moving::{MovingPicture, MovingStep, MovingTiles};
pub use super::request::CompareRequest;
use crate::chain::{Recipe, RenderInputs, Renderer};
use crate::image::{Image, Rgba8};
use crate::inspect::what_if::Changes;
use crate::measure::against::{ErrorMetrics, figures, figures_within};
use crate::measure::checkpoints;
use crate::measure::difference::{self, Difference};
use crate::measure::picture_error::PictureErrors;
use crate::measure::reference::ProgressiveRender;
use crate::ui::engine::replay::ReplayProgress;
use crate::upscale::Upscaling;

/// Picture of a tile and the error metrics measured so far.
#[derive(Clone, Debug)]
pub struct TileResult {
    /// Recipe of the tile.
    pub recipe: Recipe,
    /// File of the picture; `None` if the picture is drawn.
    pub(crate) file: Option<Arc<OpenedPicture>>,
    /// Final picture of the recipe, or the picture of the file as displayed.
    pub picture: Arc<Image<Rgba8>>,
    /// Fraction of the picture's pixels that were rasterized and shaded, from 0 to 1.
    pub(crate) drawn_share: f64,
    /// Progress of drawing the frames before this one, whose history the picture lacks; `None` if no frame is missing.
    pub(crate) replay: Option<ReplayProgress>,
    /// Error metrics against the reference; `None` until measured.
    pub measured: Option<TileMetrics>,
    /// Error metrics within the region; `None` if there is no region or it contains no pixels.
    pub region_figures: Option<ErrorMetrics>,
}

impl TileResult {
    /// Returns the name of the picture's file, or of its upscaler with the anchor.
    pub(crate) fn title(&self) -> String {
        self.file.as_ref().map_or_else(|| self.recipe.upscaler.label_with_anchor(), |file| file.name())
    }
}

/// Error metrics of a picture against the reference.
#[derive(Clone, Debug)]
pub struct TileMetrics {
    /// Error metrics of the whole picture; `None` if the two pictures differ in size.
    pub figures: Option<ErrorMetrics>,
    /// FLIP error of every pixel; `None` if the two pictures differ in size.
    flip: Option<Arc<Image<f32>>>,
    /// Errors of the stored values; `None` unless both pictures are files with comparable layers.
    pub(crate) stored: Option<PictureErrors>,
}

/// Difference image of the first two tiles.
#[derive(Clone, Debug)]
pub struct DifferenceImage {
    /// Kind of difference, and the factor that amplifies it.
    pub kind: (Difference, u32),
    /// Difference at every pixel, before amplification.
    pub values: Arc<Image<f32>>,
    /// Amplified differences, mapped to colours.
    pub picture: Arc<Image<Rgba8>>,
    /// Pixels that differ; `None` unless the kind of difference is [`Difference::Changed`].
    pub(crate) changes: Option<Arc<Changes>>,
}

/// Results computed so far for a [`CompareRequest`].
#[derive(Clone, Debug)]
pub struct Compared {
    /// Request that these results belong to.
    pub(crate) request: CompareRequest,
    /// One tile for each recipe of the request.
    pub tiles: Vec<TileResult>,
    /// Difference of the first two tiles, if requested.
    pub difference: Option<DifferenceImage>,
    /// Whether all requested results are present. After [`Comparer::cancel_replay`], those of tiles that lack frames in
    /// their history are not.
    pub complete: bool,
}

/// Worker for the most recent request: draws all pictures at once, then measures them tile by tile.
#[derive(Debug, Default)]
pub struct Comparer {
    results: Option<Compared>,
    begun: bool,
    /// Whether the frames that are missing from the history of tiles are not drawn.
    is_replay_cancelled: bool,
    /// Finished references, keyed by [`reference_recipe`].
    references: Vec<(Recipe, Arc<Image<Rgba8>>)>,
    rendering_reference: Option<(Recipe, ProgressiveRender)>,
    renderer: Renderer,
    moving: MovingTiles,
}

impl Comparer {
    /// Starts a request: draws missing pictures and reuses results of the last request that are still valid.
    pub fn start(&mut self, request: CompareRequest) -> &Compared {
        self.begun = false;
        let same_view = self.results.as_ref().is_some_and(|known| known.request.same_view(&request));
        let same_reference =
            same_view && self.results.as_ref().is_some_and(|known| known.request.has_same_reference(&request));
        if !same_reference {
            self.references.clear();
            self.rendering_reference = None;
        }
        let old = self.results.take().filter(|_| same_view);
        self.is_replay_cancelled &= old.as_ref().is_some_and(|old| old.request.recipes == request.recipes);
        self.moving.prepare(&request);
        let mut tiles: Vec<TileResult> = Vec::with_capacity(request.recipes.len());
        for (index, recipe) in request.recipes.iter().enumerate() {
            let file = request.files.of_tile(index);
            let is_kept = |tile: &&TileResult| tile.recipe == *recipe && is_same(tile.file.as_ref(), file);
            let kept = old.iter().flat_map(|old| &old.tiles).chain(&tiles).find(is_kept);
            let mut tile = kept.cloned().unwrap_or_else(|| match file {
                Some(file) => of_file(*recipe, file),
                None => self.drawn(&request, *recipe),
            });
            tile.measured = tile.measured.filter(|_| same_reference);
            tile.region_figures = None;
            tiles.push(tile);
        }
        let difference = difference_of(&request, &tiles, old.as_ref());
        self.results.insert(Compared { request, tiles, difference, complete: false })
    }

    /// Computes the next part of the results: a missing frame of a tile's history, a sample of a reference, or error
    /// metrics. Returns `None` if no result has changed.
    pub(crate) fn step(&mut self) -> Option<&Compared> {
        self.begun = true;
        let known = self.results.as_ref().filter(|known| !known.complete)?;
        if let Some(tile) = known.tiles.iter().find(|tile| tile.replay.is_some() && !self.is_replay_cancelled) {
            return self.replay(tile.recipe);
        }
        let is_next = |tile: &TileResult| tile.measured.is_none() && tile.replay.is_none();
        let Some(place) = known.tiles.iter().position(is_next) else {
            return self.complete();
        };
        let (recipe, picture) = (known.tiles[place].recipe, known.tiles[place].picture.clone());
        let Some(reference) = self.reference(recipe) else {
            self.add_reference_sample(recipe);
            return None;
        };
        let (figures, flip) = figures(&picture, &reference).unzip();
        let known = self.results.as_mut()?;
        let files = known.tiles[place].file.as_ref().zip(known.request.files.reference.as_ref());
        let stored = files.and_then(|(file, reference)| file.errors_against(reference));
        known.tiles[place].measured = Some(TileMetrics { figures, flip: flip.map(Arc::new), stored });
        self.results.as_ref()
    }

    /// Draws one frame that is missing from the history of a recipe's tiles, or else their picture. Returns `None` if
    /// progress need not be shown yet.
    fn replay(&mut self, recipe: Recipe) -> Option<&Compared> {
        let known = self.results.as_mut()?;
        let step = self.moving.step(&known.request, &recipe)?;
        let of_recipe = known.tiles.iter_mut().filter(|tile| tile.recipe == recipe && tile.file.is_none());
        let is_shown = match step {
            MovingStep::Drawn(progress) => {
                of_recipe.for_each(|tile| tile.replay = Some(progress));
                progress.done.is_multiple_of(checkpoints::SPACING)
            }
            MovingStep::Complete(drawn) => {
                of_recipe.for_each(|tile| {
                    (tile.picture, tile.replay, tile.measured) = (drawn.picture.clone(), None, None);
                });
                known.difference = difference_of(&known.request, &known.tiles, None);
                true
            }
        };
        self.results.as_ref().filter(|_| is_shown)
    }

    /// Computes the error metrics of the region in every tile, which is cheap, and marks the results complete.
    fn complete(&mut self) -> Option<&Compared> {
        let known = self.results.clone()?;
        let tiles = known.tiles.into_iter().map(|mut tile| {
            let flip = tile.measured.as_ref().and_then(|measured| measured.flip.clone());
            tile.region_figures = known.request.region.zip(flip).and_then(|(region, flip)| {
                figures_within(region, &tile.picture, &*self.reference(tile.recipe)?, &flip)
            });
            tile
        });
        let tiles = tiles.collect();
        Some(self.results.insert(Compared { tiles, complete: true, ..known }))
    }

    /// Whether any result is missing.
    pub(crate) fn has_work(&self) -> bool {
        self.results.as_ref().is_some_and(|known| !known.complete)
    }

    /// Whether computing the missing results has begun.
    pub(crate) fn has_begun(&self) -> bool {
        self.begun && self.has_work()
    }

    /// Stops drawing the frames that are missing from the history of tiles, until another view or other recipes are
    /// requested. These tiles are not measured, because their pictures depend on the frames that were shown.
    pub(crate) fn cancel_replay(&mut self) {
        self.is_replay_cancelled = true;
    }

    /// Cancels all work and drops all results.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    fn drawn(&mut self, request: &CompareRequest, recipe: Recipe) -> TileResult {
        if let Some(MovingPicture { picture, drawn_share, replay }) = self.moving.draw(request, &recipe) {
            return TileResult {
                recipe,
                file: None,
                picture,
                drawn_share,
                replay,
                measured: None,
                region_figures: None,
            };
        }
        let CompareRequest { scene, camera, viewport, .. } = request;
        let frame =
            self.renderer.render_converged(RenderInputs { scene, camera, recipe: &recipe, viewport: *viewport });
        let tile = TileResult {
            recipe,
            file: None,
            picture: Arc::new(frame.image().clone()),
            drawn_share: frame.drawn_share(),
            replay: None,
            measured: None,
            region_figures: None,
        };
        self.renderer.recycle(frame);
        tile
    }

    /// Returns the reference from a file or the finished reference for `recipe`, if there is one. Tiles with the same
    /// [`reference_recipe`] share it.
    fn reference(&self, recipe: Recipe) -> Option<Arc<Image<Rgba8>>> {
        if let Some(file) = self.results.as_ref().and_then(|known| known.request.files.reference.as_ref()) {
            return Some(file.shown.clone());
        }
        let wanted = reference_recipe(recipe);
        self.references.iter().find(|(known, _)| *known == wanted).map(|(_, picture)| picture.clone())
    }

    /// Renders one more sample per pixel of the reference for `recipe`.
    fn add_reference_sample(&mut self, recipe: Recipe) {
        let wanted = reference_recipe(recipe);
        let Some(CompareRequest { scene, camera, viewport, reference, .. }) =
            self.results.as_ref().map(|known| &known.request)
        else {
            return;
        };
        let same = self.rendering_reference.take().filter(|(known, _)| *known == wanted);
        let (_, mut gathering) = same.unwrap_or_else(|| (wanted, reference.begin(scene, camera, &wanted, *viewport)));
        if gathering.step() {
            self.rendering_reference = Some((wanted, gathering));
        } else {
            self.references.push((wanted, Arc::new(gathering.picture())));
        }
    }
}

/// Returns the tile of a picture file.
fn of_file(recipe: Recipe, file: &Arc<OpenedPicture>) -> TileResult {
    TileResult {
        recipe,
        file: Some(file.clone()),
        picture: file.shown.clone(),
        drawn_share: 1.0,
        replay: None,
        measured: None,
        region_figures: None,
    }
}

/// Returns `recipe` without the settings that do not affect its reference: upscaler and wireframe.
fn reference_recipe(recipe: Recipe) -> Recipe {
    Recipe { upscaler: Upscaling::NATIVE, wireframe: false, ..recipe }
}

/// Computes the requested difference of the first two tiles, reusing that of `old` if it has the same pictures.
fn difference_of(request: &CompareRequest, tiles: &[TileResult], old: Option<&Compared>) -> Option<DifferenceImage> {
    let ((difference, gain), [a, b, ..]) = (request.difference?, tiles) else { return None };
    let kept = old.filter(|old| {
        let pictures = old.tiles.iter().take(2).map(|tile| &tile.picture);
        pictures.zip([a, b]).all(|(old, new)| Arc::ptr_eq(old, &new.picture))
    });
    differing(difference, gain, kept.and_then(|old| old.difference.as_ref()), [a, b])
}

/// Computes the difference of two tiles, reusing known values if only the gain has changed. Returns `None` if the
/// pictures differ in size.
fn differing(
    difference: Difference,
    gain: u32,
    old: Option<&DifferenceImage>,
    [a, b]: [&TileResult; 2],
) -> Option<DifferenceImage> {
    let values = match old.filter(|old| old.kind.0 == difference) {
        Some(old) if old.kind.1 == gain => return Some(old.clone()),
        Some(old) => old.values.clone(),
        None => Arc::new(difference::values(difference, &a.picture, &b.picture)?),
    };
    let picture = Arc::new(difference::picture(difference, gain, &values));
    let changes = match difference {
        Difference::Changed => Changes::of_pictures(&a.picture, &b.picture).map(Arc::new),
        Difference::Absolute | Difference::Signed | Difference::Squared | Difference::Flip => None,
    };
    Some(DifferenceImage { kind: (difference, gain), values, picture, changes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::measure::reference::Reference;
    use crate::measure::region::PixelRegion;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::SceneSource;
    use crate::ui::session::compare::files::ComparedFiles;

    fn request(methods: &[(&str, u32)]) -> CompareRequest {
        let scene = SceneSource::named("triangle".into()).load().unwrap().scene;
        let recipe = |(method, scale): &(&str, u32)| Recipe {
            upscaler: Upscaling::new(method, *scale).unwrap(),
            ..Recipe::default()
        };
        CompareRequest {
            camera: scene.home,
            scene: Arc::new(scene),
            sequence: None,
            viewport: Viewport { width: 48, height: 32 },
            recipes: methods.iter().map(recipe).collect(),
            files: ComparedFiles::default(),
            reference: Reference::Native,
            region: None,
            difference: None,
        }
    }

    fn finished(comparer: &mut Comparer, request: CompareRequest) -> Compared {
        comparer.start(request);
        while comparer.has_work() {
            comparer.step();
        }
        comparer.results.clone().unwrap()
    }

    #[test]
    fn every_tile_equals_the_frame_of_the_chain_and_native_has_no_error() {
        let request = request(&[("native", 1), ("nearest", 4), ("bilinear", 2)]);
        let compared = finished(&mut Comparer::default(), request.clone());
        assert_eq!(compared.tiles.len(), 3);
        for tile in &compared.tiles {
            let frame = run(&request.scene, &request.camera, &tile.recipe, request.viewport, &mut ());
            assert_eq!(*tile.picture, *frame.image());
        }
        let mse = |tile: usize| compared.tiles[tile].measured.as_ref().unwrap().figures.unwrap().codes.mse;
        assert_eq!(mse(0), 0.0);
        assert!(mse(1) > 0.0 && mse(2) > 0.0);
    }

    #[test]
    fn results_that_are_still_valid_are_reused() {
        let mut comparer = Comparer::default();
        let first = finished(&mut comparer, request(&[("native", 1), ("nearest", 4)]));
        let mut next = first.request.clone();
        next.recipes[1].upscaler = Upscaling::new("bilinear", 4).unwrap();
        next.region = Some(PixelRegion { left: 10, top: 10, right: 30, bottom: 25 });
        let second = finished(&mut comparer, next.clone());
        assert!(Arc::ptr_eq(&first.tiles[0].picture, &second.tiles[0].picture));
        assert!(!Arc::ptr_eq(&first.tiles[1].picture, &second.tiles[1].picture));
        assert_eq!(second.tiles[0].region_figures.map(|figures| figures.codes.differing_pixels), Some(0));
        next.viewport.width = 50;
        let third = finished(&mut comparer, next);
        assert!(!Arc::ptr_eq(&third.tiles[0].picture, &second.tiles[0].picture));
        assert_eq!(third.tiles[0].picture.size(), (50, 32));
    }

    #[test]
    fn changed_pixels_are_counted_for_their_kind_of_difference() {
        let mut comparer = Comparer::default();
        let mut request = request(&[("native", 1), ("nearest", 4)]);
        request.difference = Some((Difference::Absolute, 1));
        assert!(finished(&mut comparer, request.clone()).difference.unwrap().changes.is_none());
        request.difference = Some((Difference::Changed, 1));
        let compared = finished(&mut comparer, request);
        let pairs = compared.tiles[0].picture.pixels().iter().zip(compared.tiles[1].picture.pixels());
        let differing = pairs.filter(|(a, b)| a != b).count() as u64;
        let shown = compared.difference.unwrap();
        assert_eq!(shown.changes.map(|changes| changes.count), Some(differing));
        assert_eq!(shown.values.pixels().iter().filter(|value| **value == 1.0).count() as u64, differing);
        assert!(differing > 0);
    }

    #[test]
    fn a_change_of_gain_reuses_the_difference_values() {
        let mut comparer = Comparer::default();
        let mut request = request(&[("native", 1), ("nearest", 4)]);
        request.difference = Some((Difference::Absolute, 1));
        let first = finished(&mut comparer, request.clone()).difference.unwrap();
        request.difference = Some((Difference::Absolute, 16));
        let second = finished(&mut comparer, request.clone()).difference.unwrap();
        assert!(Arc::ptr_eq(&first.values, &second.values));
        assert_ne!(first.picture, second.picture);
        request.recipes.swap(0, 1);
        request.difference = Some((Difference::Signed, 1));
        let swapped = finished(&mut comparer, request).difference.unwrap();
        assert!(!Arc::ptr_eq(&swapped.values, &second.values));
    }

    #[test]
    fn a_finished_comparison_leaves_nothing_to_do() {
        let mut comparer = Comparer::default();
        finished(&mut comparer, request(&[("native", 1), ("nearest", 2)]));
        assert!(!comparer.has_work());
        assert!(comparer.step().is_none());
    }
}
