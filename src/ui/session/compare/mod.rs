//! Comparison of several pictures of one view, each with its own recipe. They are shown as tiles side by side, as a
//! wipe, as a flip, or as a difference image. Every mode shows error metrics against a named reference. A tile or the
//! reference may also be a picture from a file.
//!
//! The active tile shows the session's own recipe: the pipeline panel edits it and the inspector explains it. Clicking
//! another tile makes it active. The first tile is A, the second B.

pub mod compute;

pub mod files;

mod moving;

mod request;

mod stored;

use std::path::PathBuf;
use std::sync::Arc;

use compute::{CompareRequest, Compared};
use files::{ComparedFiles, OpenedPicture, OpenedPictures, PictureLook};

use super::feature::Feature;
use super::picture_role::PictureRole;
use super::range::RangeChange;
use super::tile_set::{Tile, TileSet, methods};
use super::window_task::WindowTask;
use super::{PictureSize, Session, Severity, Undoable};
use crate::chain::Recipe;
use crate::inspect::Buffer;
use crate::inspect::project::MAX_TILES;
use crate::measure::difference::Difference;
use crate::measure::reference::Reference;
use crate::measure::region::PixelRegion;
use crate::measure::tone::Tone;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::ui::engine::Shown;
use crate::upscale::Scale;

/// Comparison mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mode {
    /// No comparison: the canvas shows one picture.
    #[default]
    Off,
    /// Tiles side by side.
    Tiles,
    /// Picture A to the left of a movable line, picture B to its right.
    Wipe,
    /// Picture A, or picture B while Shift is held.
    Flip,
    /// Difference image A − B.
    Difference,
}

impl Mode {
    /// All modes except `Off`, each with its display name and help text.
    pub(crate) const ALL: [(Self, &'static str, &'static str); 4] = [
        (
            Self::Tiles,
            "Tiles",
            "Show pictures side by side with a shared zoom, position and selected pixel; hold Shift to show A in every tile  (T)",
        ),
        (Self::Wipe, "Wipe", "Show A left of a line and B right of it; drag the line to move it  (W)"),
        (Self::Flip, "Flip", "Show A on the whole canvas; hold Shift to show B  (B)"),
        (
            Self::Difference,
            "Difference",
            "Show the difference of A and B in a colour map; hold Shift to show B, Ctrl to show A  (D)",
        ),
    ];
}

/// Mode, settings and results of the comparison.
#[derive(Debug)]
pub(crate) struct CompareState {
    /// Current comparison mode.
    pub(crate) mode: Mode,
    /// Mode of the last comparison, which the workspace “Compare” continues.
    pub(crate) last_mode: Mode,
    /// Reference that errors are measured against, unless it is a picture file.
    pub(crate) reference: Reference,
    /// Opened picture files.
    pub(crate) pictures: OpenedPictures,
    /// Kind of difference that the difference image shows.
    pub(crate) difference: Difference,
    /// Factor by which the difference image amplifies differences.
    pub(crate) gain: u32,
    /// Position of the wipe line, as a fraction of the canvas width from 0 to 1.
    pub(crate) wipe: f32,
    /// Region whose error metrics are measured in addition to those of the whole picture.
    pub(crate) region: Option<PixelRegion>,
    /// Whether dragging on a picture draws the measured region instead of panning.
    pub(crate) draws_region: bool,
    /// Results so far; `None` if there are none.
    pub(crate) compared: Option<Compared>,
}

impl Default for CompareState {
    fn default() -> Self {
        Self {
            mode: Mode::Off,
            last_mode: Mode::Tiles,
            reference: Reference::ALL[0],
            pictures: OpenedPictures::default(),
            difference: Difference::ALL[0],
            gain: 1,
            wipe: 0.5,
            region: None,
            draws_region: false,
            compared: None,
        }
    }
}

/// Change to the comparison that the user requests.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CompareChange {
    /// Sets the comparison mode.
    Mode(Mode),
    /// Sets the mode, or stops comparing if it is already active.
    Toggle(Mode),
    /// Shows this number of tiles.
    Count(usize),
    /// Shows every upscaling method, as [`methods`] returns them for this scale.
    Every(Option<Scale>),
    /// Makes this tile the active one.
    Activate(usize),
    /// Sets the recipe of a tile.
    Recipe(usize, Box<Recipe>),
    /// Removes a tile, unless only two are left.
    Remove(usize),
    /// Swaps A and B.
    Swap,
    /// Sets the kind of difference image.
    Difference(Difference),
    /// Sets the gain of the difference image.
    Gain(u32),
    /// Moves the wipe line to this fraction of the canvas width.
    Wipe(f32),
    /// Sets or clears the region whose error metrics are measured in addition to those of the whole picture.
    Region(Option<PixelRegion>),
    /// Sets whether dragging on a picture draws the region.
    DrawRegion(bool),
    /// Toggles whether dragging on a picture draws the region.
    ToggleRegion,
    /// Sets the reference that errors are measured against, and draws it.
    Reference(Reference),
    /// Shows a picture file in a tile or as reference.
    File(PictureRole, Arc<OpenedPicture>),
    /// Draws the picture of a tile or the reference again, in place of a picture file.
    RemoveFile(PictureRole),
    /// Replaces the content of an opened picture file after the file has changed.
    Reload(Arc<OpenedPicture>),
    /// Sets exposure and tone curve of float pictures.
    Tone(Tone),
    /// Sets which layer of an opened picture is shown and compared, and in which range.
    Look(PathBuf, PictureLook),
}

impl Feature for CompareState {
    type Change = CompareChange;

    fn apply(session: &mut Session, change: CompareChange) -> Option<WindowTask> {
        session.compare(change);
        None
    }

    fn leave_scene(&mut self) {
        self.compared = None;
    }
}

impl CompareState {
    /// Whether a comparison is active.
    pub(crate) fn is_on(&self) -> bool {
        self.mode != Mode::Off
    }

    /// Returns the number of pictures to draw: one per tile in the mode `Tiles`, two (A and B) in the other modes, and
    /// none if the comparison is off.
    pub(crate) fn shown(&self, tiles: &TileSet) -> usize {
        match self.mode {
            Mode::Off => 0,
            Mode::Tiles => tiles.count(),
            Mode::Wipe | Mode::Flip | Mode::Difference => 2,
        }
    }

    /// Whether the upscalers of the visible pictures place the rendered sample at different positions within a block of
    /// pixels.
    pub(crate) fn anchors_differ(&self, tiles: &TileSet, of_active: Recipe) -> bool {
        let recipes = (0..self.shown(tiles)).map(|tile| tiles.recipe(tile, of_active));
        let mut anchors = recipes.filter_map(|recipe| recipe.upscaler.block_anchor());
        let first = anchors.next();
        anchors.any(|anchor| Some(anchor) != first)
    }

    /// Applies a change to the comparison, to the tiles and to the recipe of the active tile.
    pub(crate) fn apply(&mut self, change: CompareChange, tiles: &mut TileSet, recipe: &mut Recipe) {
        tiles.fill(1, *recipe);
        tiles.store(*recipe);
        match change {
            CompareChange::Mode(mode) => self.mode = mode,
            CompareChange::Toggle(mode) => self.mode = if self.mode == mode { Mode::Off } else { mode },
            CompareChange::Count(count) => {
                self.mode = Mode::Tiles;
                tiles.tiles.truncate(count.max(1));
                tiles.fill(count.min(MAX_TILES), *recipe);
            }
            CompareChange::Every(scale) => {
                self.mode = Mode::Tiles;
                let recipes = methods(scale).map(|upscaler| Recipe { upscaler, ..*recipe }).take(MAX_TILES);
                tiles.tiles = recipes.map(|recipe| Tile { recipe, file: None }).collect();
                tiles.active = 0;
            }
            CompareChange::Activate(tile) => tiles.active = tile,
            CompareChange::Recipe(tile, wanted) => {
                wanted.upscaler.upscaler().retry();
                tiles.fill((tile + 1).min(MAX_TILES), *recipe);
                if let Some(place) = tiles.tiles.get_mut(tile) {
                    place.recipe = *wanted;
                }
            }
            CompareChange::Remove(tile) => {
                if tiles.tiles.len() > 2 && tile < tiles.tiles.len() {
                    tiles.tiles.remove(tile);
                    tiles.active -= usize::from(tiles.active > tile);
                }
            }
            CompareChange::Swap => {
                if let [a, b, ..] = &mut tiles.tiles[..] {
                    std::mem::swap(a, b);
                }
            }
            CompareChange::Difference(difference) => self.difference = difference,
            CompareChange::Gain(gain) => self.gain = gain,
            CompareChange::Wipe(share) => self.wipe = share.clamp(0.0, 1.0),
            CompareChange::Region(region) => self.region = region,
            CompareChange::DrawRegion(draws) => self.draws_region = draws,
            CompareChange::ToggleRegion => self.draws_region ^= self.is_on() || self.draws_region,
            CompareChange::Reference(reference) => (self.reference, tiles.reference) = (reference, None),
            CompareChange::File(role, picture) => {
                self.set_file(role, Some(picture.path.clone()), tiles, recipe);
                self.pictures.insert(picture);
            }
            CompareChange::RemoveFile(role) => self.set_file(role, None, tiles, recipe),
            CompareChange::Reload(picture) => self.pictures.insert(picture),
            CompareChange::Tone(tone) => self.pictures.set_tone(tone),
            CompareChange::Look(path, look) => self.pictures.set_look(&path, look),
        }
        if self.is_on() {
            self.last_mode = self.mode;
            tiles.fill(2, *recipe);
        }
        tiles.active = tiles.active.min(tiles.tiles.len() - 1);
        *recipe = tiles.tiles[tiles.active].recipe;
    }

    /// Sets the file of a tile or of the reference. Starts a comparison if there is none.
    fn set_file(&mut self, role: PictureRole, file: Option<PathBuf>, tiles: &mut TileSet, recipe: &Recipe) {
        if !self.is_on() && file.is_some() {
            self.mode = self.last_mode;
        }
        match role {
            PictureRole::Reference => tiles.reference = file,
            // They take part in no comparison.
            PictureRole::Depths | PictureRole::Ids => {}
            PictureRole::Tile(tile) => {
                tiles.fill((tile + 1).min(MAX_TILES), *recipe);
                if let Some(place) = tiles.tiles.get_mut(tile) {
                    place.file = file;
                }
            }
        }
    }

    /// Returns the opened picture of a role; `None` if its picture is drawn. If A is a file, it is the reference unless
    /// another file is, because drawn references show the scene.
    pub(crate) fn opened(&self, tiles: &TileSet, role: PictureRole) -> Option<Arc<OpenedPicture>> {
        let file = match role {
            PictureRole::Tile(_) | PictureRole::Depths | PictureRole::Ids => tiles.file(role),
            PictureRole::Reference => tiles.file(role).or_else(|| tiles.file(PictureRole::Tile(0))),
        };
        self.pictures.get(file?)
    }

    /// Returns the name of the reference: that of its file, or its kind.
    pub(crate) fn reference_name(&self, tiles: &TileSet) -> String {
        let file = self.opened(tiles, PictureRole::Reference);
        file.map_or_else(|| self.reference.name().to_owned(), |file| file.name())
    }

    /// Returns the picture files of all visible tiles and of the reference.
    pub(crate) fn files(&self, tiles: &TileSet) -> ComparedFiles {
        ComparedFiles {
            tiles: (0..self.shown(tiles)).map(|tile| self.opened(tiles, PictureRole::Tile(tile))).collect(),
            reference: self.opened(tiles, PictureRole::Reference),
        }
    }
}

impl Session {
    /// Returns the current comparison request; `None` if comparison is off.
    pub(crate) fn compare_request(&self) -> Option<CompareRequest> {
        let CompareState { mode, reference, region, difference, gain, .. } = self.features.comparison;
        let shows_difference = mode == Mode::Difference;
        let tiles = 0..self.features.comparison.shown(&self.state.tiles);
        self.features.comparison.is_on().then(|| CompareRequest {
            scene: self.scene.clone(),
            camera: self.state.camera,
            sequence: self.shot_frame(),
            viewport: self.viewport(),
            recipes: tiles.map(|tile| self.state.tiles.recipe(tile, self.state.recipe)).collect(),
            files: self.features.comparison.files(&self.state.tiles),
            reference,
            region,
            difference: shows_difference.then_some((difference, gain)),
        })
    }

    /// Changes the comparison. A comparison shows final colours only.
    pub(in crate::ui) fn compare(&mut self, change: CompareChange) {
        if change == CompareChange::ToggleRegion && !self.features.comparison.is_on() {
            // Without a comparison, the key of this command resets the value range.
            self.features.range.apply(RangeChange::Reset, self.shown, None);
            return;
        }
        let Undoable { tiles, recipe, .. } = &mut self.state;
        self.features.comparison.apply(change, tiles, recipe);
        if self.features.comparison.is_on() {
            self.shown = Shown::Buffer(Buffer::Color);
        }
    }

    /// Shows an opened picture file in a comparison. The drawn pictures take its size if they can, because only pictures
    /// of one size can be compared.
    pub(in crate::ui) fn show_compared_picture(&mut self, role: PictureRole, picture: Arc<OpenedPicture>) {
        let (width, height) = picture.picture.size();
        let mut text = format!("Opened {} as {}: {}", picture.name(), role.name(), picture.picture.description());
        let size = Viewport { width, height };
        if size != self.viewport() && size.check().is_ok() {
            self.state.size = PictureSize::Fixed(width, height);
            text += "; the picture has its size now";
        }
        self.compare(CompareChange::File(role, picture));
        self.features.messages.offered_picture = None;
        self.report(Severity::Info, text);
    }
}

#[cfg(test)]
mod tests;
