//! Comparison as part of a project file.

use std::path::{Path, PathBuf};

use super::files::{OpenedPictures, PictureLook};
use super::{CompareState, Mode};
use crate::chain::Recipe;
use crate::inspect::project::{ComparedFile, ComparedTile, Comparison, ComparisonView};
use crate::inspect::view::Range;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::sequences::Sequences;
use crate::ui::session::tile_set::{Tile, TileSet};

impl CompareState {
    /// Returns the comparison for a project; `None` if there is none. `of_active` is the recipe of the active tile.
    pub(crate) fn stored(&self, tiles: &TileSet, of_active: Recipe, sequences: &Sequences) -> Option<Comparison> {
        let view = match self.mode {
            Mode::Off => return None,
            Mode::Tiles => ComparisonView::Tiles,
            Mode::Wipe => ComparisonView::Wipe,
            Mode::Flip => ComparisonView::Flip,
            Mode::Difference => ComparisonView::Difference,
        };
        let file = |role| tiles.file(role).map(Path::to_owned);
        let tile = |tile| ComparedTile { settings: tiles.recipe(tile, of_active), file: file(PictureRole::Tile(tile)) };
        let mut files: Vec<ComparedFile> = Vec::new();
        for path in tiles.files() {
            if files.iter().all(|known| known.file != path) {
                files.push(self.pictures.stored(path, sequences));
            }
        }
        Some(Comparison {
            view,
            tiles: (0..tiles.count()).map(tile).collect(),
            active: tiles.active,
            reference: self.reference,
            reference_file: file(PictureRole::Reference),
            playback: sequences.stored(&files),
            files,
            difference: self.difference,
            gain: self.gain,
            wipe: self.wipe,
            region: self.region,
            tone: self.pictures.tone(),
        })
    }

    /// Restores a comparison of a project. `of_active` is the recipe of the active tile, which the session stores. Returns
    /// the picture files to open; until then, their tiles are drawn.
    pub(crate) fn restore(
        &mut self,
        stored: &Comparison,
        tiles: &mut TileSet,
        of_active: Recipe,
    ) -> Vec<(PictureRole, PathBuf)> {
        self.mode = match stored.view {
            ComparisonView::Tiles => Mode::Tiles,
            ComparisonView::Wipe => Mode::Wipe,
            ComparisonView::Flip => Mode::Flip,
            ComparisonView::Difference => Mode::Difference,
        };
        self.last_mode = self.mode;
        (self.reference, self.difference, self.gain) = (stored.reference, stored.difference, stored.gain);
        (self.wipe, self.region) = (stored.wipe, stored.region);
        self.pictures.set_tone(stored.tone);
        for ComparedFile { file, layer, range, .. } in &stored.files {
            let range = range.map(|(low, high)| Range { low, high });
            self.pictures.set_look(file, PictureLook { layer: layer.clone(), range });
        }
        tiles.tiles = stored.tiles.iter().map(|tile| Tile { recipe: tile.settings, file: None }).collect();
        (tiles.reference, tiles.active) = (None, stored.active);
        tiles.store(of_active);
        let of_tiles = stored.tiles.iter().map(|tile| &tile.file).enumerate();
        let of_tiles = of_tiles.filter_map(|(tile, file)| Some((PictureRole::Tile(tile), file.clone()?)));
        of_tiles.chain(stored.reference_file.clone().map(|file| (PictureRole::Reference, file))).collect()
    }
}

impl TileSet {
    /// Returns the path of every picture file or sequence, also repeatedly.
    fn files(&self) -> impl Iterator<Item = &Path> {
        let of_tiles = self.tiles.iter().filter_map(|tile| tile.file.as_deref());
        of_tiles.chain(self.reference.as_deref())
    }
}

impl OpenedPictures {
    /// Returns the look of a picture file, and its shift if it is a sequence.
    fn stored(&self, path: &Path, sequences: &Sequences) -> ComparedFile {
        let PictureLook { layer, range } = self.look_of(path);
        ComparedFile {
            file: path.to_owned(),
            layer,
            range: range.map(|Range { low, high }| (low, high)),
            shift: sequences.get(path).map_or(0, |sequence| sequence.shift),
        }
    }
}
