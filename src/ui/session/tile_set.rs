//! Contents of the tiles of a comparison.

use std::path::{Path, PathBuf};

use crate::chain::Recipe;
use crate::ui::session::picture_role::PictureRole;
use crate::upscale::{self, Scale, Upscaling};

/// Content of a tile.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tile {
    /// Recipe with which the tile is drawn.
    pub(super) recipe: Recipe,
    /// Picture file that the tile shows instead.
    pub(super) file: Option<PathBuf>,
}

/// Contents of all tiles, and the index of the active one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TileSet {
    /// Content of each tile. The recipe of the active tile may be outdated: the session stores its current recipe.
    pub(super) tiles: Vec<Tile>,
    /// Picture file to measure against; `None` if the reference is drawn.
    pub(super) reference: Option<PathBuf>,
    /// Index of the tile that shows the session's recipe.
    pub(crate) active: usize,
}

impl TileSet {
    /// Returns the number of tiles, visible or not; at least 1.
    pub(crate) fn count(&self) -> usize {
        self.tiles.len().max(1)
    }

    /// Returns the recipe of a tile. `of_active` is the recipe of the active tile, which the session stores.
    pub(crate) fn recipe(&self, tile: usize, of_active: Recipe) -> Recipe {
        if tile == self.active { of_active } else { self.tiles.get(tile).map_or(of_active, |tile| tile.recipe) }
    }

    /// Stores the session's recipe as the recipe of the active tile. No-op if no recipes are stored yet.
    pub(crate) fn store(&mut self, of_active: Recipe) {
        if let Some(tile) = self.tiles.get_mut(self.active) {
            tile.recipe = of_active;
        }
    }

    /// Returns the picture file of a role; `None` if its picture is drawn.
    pub(crate) fn file(&self, role: PictureRole) -> Option<&Path> {
        match role {
            PictureRole::Tile(tile) => self.tiles.get(tile)?.file.as_deref(),
            PictureRole::Reference => self.reference.as_deref(),
            PictureRole::Depths | PictureRole::Ids => None,
        }
    }

    /// Adds tiles until there are `count`. Each added tile gets an upscaler that no other tile uses, if there is one.
    pub(super) fn fill(&mut self, count: usize, of_active: Recipe) {
        while self.tiles.len() < count {
            let base = self.tiles.first().map_or(of_active, |tile| tile.recipe);
            let used = |upscaler: &Upscaling| self.tiles.iter().any(|tile| tile.recipe.upscaler == *upscaler);
            let next = suggestions().find(|upscaler| !used(upscaler)).unwrap_or(base.upscaler);
            let recipe = if self.tiles.is_empty() { of_active } else { Recipe { upscaler: next, ..base } };
            self.tiles.push(Tile { recipe, file: None });
        }
    }
}

/// Returns an iterator over all upscalers, the most instructive comparisons first. May repeat entries.
fn suggestions() -> impl Iterator<Item = Upscaling> {
    const FIRST: [(&str, u32); 4] = [("native", 1), ("bicubic", 4), ("nearest", 4), ("checkerboard", 1)];
    let first = FIRST.into_iter().filter_map(|(method, scale)| Upscaling::new(method, scale));
    first.chain(methods(None)).chain(Upscaling::every())
}

/// Returns every upscaling method once, in the order of the menus: at `scale` or the nearest offered scale, or at its
/// largest scale if `scale` is `None`.
pub(crate) fn methods(scale: Option<Scale>) -> impl Iterator<Item = Upscaling> {
    upscale::all().into_iter().filter_map(move |method| {
        let largest = *method.offers().scales.last()?;
        Upscaling::new(method.id(), scale.unwrap_or(largest))
    })
}
