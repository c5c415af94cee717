//! Several pictures of one view, each drawn by a recipe of its own: as tiles side by side, one wiped over the other, one
//! flipped against the other, or their difference, with figures against a named reference.
//!
//! The tile that is active is the session's own recipe: the pipeline panel edits it and the inspector tells about it.
//! Clicking another tile makes that one active. The first tile is A, the second B.

pub mod bar;

pub mod compute;

pub mod tiles;

use crate::chain::Recipe;
use crate::measure::difference::Difference;
use crate::measure::reference::Reference;
use crate::measure::region::Region;
use crate::pipeline::settings::Choice as _;
use crate::upscale::{self, Upscaling};

/// Most tiles at a time.
pub const MOST_TILES: usize = 16;

/// How pictures are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Not at all: the canvas shows one picture.
    #[default]
    Off,
    /// Side by side.
    Tiles,
    /// A left of a line that can be moved, B right of it.
    Wipe,
    /// A, and B as long as a key is held.
    Flip,
    /// A − B.
    Difference,
}

impl Mode {
    /// All ways to compare, with name and explanation.
    pub const ALL: [(Self, &'static str, &'static str); 4] = [
        (
            Self::Tiles,
            "Tiles",
            "Side by side, with one zoom, position and pick; hold Shift to see A in every tile  (T)",
        ),
        (Self::Wipe, "Wipe", "A left of the line, B right of it; drag the line  (W)"),
        (Self::Flip, "Flip", "A in the whole canvas, B as long as Shift is held  (B)"),
        (Self::Difference, "Difference", "A − B by a colour map; hold Shift for B, Ctrl for A  (D)"),
    ];
}

/// The recipes of all tiles, and which of them is active.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tiles {
    /// That of the active one may be out of date: the session has it.
    recipes: Vec<Recipe>,
    /// The tile that the session's recipe is of.
    pub active: usize,
}

impl Tiles {
    /// How many there are, shown or not; one at least.
    pub fn count(&self) -> usize {
        self.recipes.len().max(1)
    }

    /// The recipe of a tile, given that of the active one.
    pub fn recipe(&self, tile: usize, of_active: Recipe) -> Recipe {
        if tile == self.active { of_active } else { self.recipes.get(tile).copied().unwrap_or(of_active) }
    }

    /// Takes the recipe of the active tile into the list, unless there never was another tile.
    pub fn store(&mut self, of_active: Recipe) {
        if let Some(recipe) = self.recipes.get_mut(self.active) {
            *recipe = of_active;
        }
    }

    /// Adds tiles until there are `count`, drawn by methods that no other tile has as far as there are such.
    fn fill(&mut self, count: usize, of_active: Recipe) {
        while self.recipes.len() < count {
            let base = *self.recipes.first().unwrap_or(&of_active);
            let used = |upscaler: &Upscaling| self.recipes.iter().any(|tile| tile.upscaler == *upscaler);
            let next = suggestions().find(|upscaler| !used(upscaler)).unwrap_or(base.upscaler);
            let recipe = if self.recipes.is_empty() { of_active } else { Recipe { upscaler: next, ..base } };
            self.recipes.push(recipe);
        }
    }
}

/// What is compared, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// How.
    pub mode: Mode,
    /// What figures are against.
    pub reference: Reference,
    /// What of the difference is shown.
    pub difference: Difference,
    /// How much it is amplified.
    pub gain: u32,
    /// Where the line of the wipe stands, as a share of the canvas's width.
    pub wipe: f32,
    /// A rectangle of the picture that has figures of its own.
    pub region: Option<Region>,
    /// Whether dragging draws that rectangle.
    pub draws_region: bool,
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            mode: Mode::Off,
            reference: Reference::ALL[0],
            difference: Difference::ALL[0],
            gain: 1,
            wipe: 0.5,
            region: None,
            draws_region: false,
        }
    }
}

/// A change of what is compared.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Compare this way.
    Mode(Mode),
    /// Compare this way, or stop comparing if it is done already.
    Toggle(Mode),
    /// Show so many tiles.
    Count(usize),
    /// Show every upscaler, each with its greatest enlargement.
    Every,
    /// Make this tile the active one.
    Activate(usize),
    /// Draw this tile by this recipe.
    Recipe(usize, Box<Recipe>),
    /// Take this tile away.
    Remove(usize),
    /// A becomes B and B becomes A.
    Swap,
    /// Show this of the difference.
    Difference(Difference),
    /// Amplify the difference so much.
    Gain(u32),
    /// Put the line of the wipe here.
    Wipe(f32),
    /// Measure this rectangle, too.
    Region(Option<Region>),
    /// Have dragging draw the rectangle, or not.
    DrawRegion(bool),
    /// Have dragging draw the rectangle if it does not, and the other way round.
    ToggleRegion,
    /// Measure against this.
    Reference(Reference),
}

impl Comparison {
    /// Whether anything is compared.
    pub fn is_on(&self) -> bool {
        self.mode != Mode::Off
    }

    /// How many pictures there are to be drawn: all tiles, or A and B.
    pub fn shown(&self, tiles: &Tiles) -> usize {
        match self.mode {
            Mode::Off => 0,
            Mode::Tiles => tiles.count(),
            Mode::Wipe | Mode::Flip | Mode::Difference => 2,
        }
    }

    /// Whether the pictures shown have samples in different places of their blocks.
    pub fn anchors_differ(&self, tiles: &Tiles, of_active: Recipe) -> bool {
        let recipes = (0..self.shown(tiles)).map(|tile| tiles.recipe(tile, of_active));
        let mut anchors = recipes.filter_map(|recipe| recipe.upscaler.block_anchor());
        let first = anchors.next();
        anchors.any(|anchor| Some(anchor) != first)
    }

    /// Applies a change to this, to the tiles and to the recipe of the active one.
    pub fn apply(&mut self, change: Change, tiles: &mut Tiles, recipe: &mut Recipe) {
        tiles.fill(1, *recipe);
        tiles.store(*recipe);
        match change {
            Change::Mode(mode) => self.mode = mode,
            Change::Toggle(mode) => self.mode = if self.mode == mode { Mode::Off } else { mode },
            Change::Count(count) => {
                self.mode = Mode::Tiles;
                tiles.recipes.truncate(count.max(1));
                tiles.fill(count.min(MOST_TILES), *recipe);
            }
            Change::Every => {
                self.mode = Mode::Tiles;
                let recipes = every_method().map(|upscaler| Recipe { upscaler, ..*recipe }).take(MOST_TILES);
                *tiles = Tiles { recipes: recipes.collect(), active: 0 };
            }
            Change::Activate(tile) => tiles.active = tile,
            Change::Recipe(tile, wanted) => {
                tiles.fill((tile + 1).min(MOST_TILES), *recipe);
                if let Some(place) = tiles.recipes.get_mut(tile) {
                    *place = *wanted;
                }
            }
            Change::Remove(tile) => {
                if tiles.recipes.len() > 2 && tile < tiles.recipes.len() {
                    tiles.recipes.remove(tile);
                    tiles.active -= usize::from(tiles.active > tile);
                }
            }
            Change::Swap => {
                if let [a, b, ..] = &mut tiles.recipes[..] {
                    std::mem::swap(a, b);
                }
            }
            Change::Difference(difference) => self.difference = difference,
            Change::Gain(gain) => self.gain = gain,
            Change::Wipe(share) => self.wipe = share.clamp(0.0, 1.0),
            Change::Region(region) => self.region = region,
            Change::DrawRegion(draws) => self.draws_region = draws,
            Change::ToggleRegion => self.draws_region ^= self.is_on() || self.draws_region,
            Change::Reference(reference) => self.reference = reference,
        }
        if self.is_on() {
            tiles.fill(2, *recipe);
        }
        tiles.active = tiles.active.min(tiles.recipes.len() - 1);
        *recipe = tiles.recipes[tiles.active];
    }
}

/// What is worth comparing, the most telling first.
fn suggestions() -> impl Iterator<Item = Upscaling> {
    const FIRST: [(&str, u32); 4] = [("native", 1), ("bicubic", 4), ("nearest", 4), ("checkerboard", 1)];
    let first = FIRST.into_iter().filter_map(|(method, scale)| Upscaling::new(method, scale));
    first.chain(every_method()).chain(Upscaling::every())
}

/// Every method with its greatest enlargement.
fn every_method() -> impl Iterator<Item = Upscaling> {
    upscale::ALL.iter().filter_map(|method| Upscaling::new(method.id(), *method.offers().scales.last()?))
}

/// The letter of a tile.
pub fn letter(tile: usize) -> char {
    char::from(b'A' + (tile % 26) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A comparison with what the session holds of it.
    #[derive(Default)]
    struct Bench {
        comparison: Comparison,
        tiles: Tiles,
        recipe: Recipe,
    }

    impl Bench {
        fn apply(&mut self, change: Change) {
            self.comparison.apply(change, &mut self.tiles, &mut self.recipe);
        }

        fn recipes(&self) -> Vec<Recipe> {
            (0..self.tiles.count()).map(|tile| self.tiles.recipe(tile, self.recipe)).collect()
        }
    }

    #[test]
    fn comparing_starts_with_the_present_picture_and_another() {
        let mut bench = Bench::default();
        bench.recipe.wireframe = true;
        let before = bench.recipe;
        bench.apply(Change::Toggle(Mode::Wipe));
        let recipes = bench.recipes();
        assert_eq!((recipes.len(), recipes[0], bench.recipe), (2, before, before));
        assert_eq!(Recipe { upscaler: before.upscaler, ..recipes[1] }, before, "only the upscaler differs");
        assert_ne!(recipes[1].upscaler, recipes[0].upscaler);
        bench.apply(Change::Toggle(Mode::Wipe));
        assert!(!bench.comparison.is_on());
    }

    #[test]
    fn a_tile_keeps_what_was_changed_while_it_was_active() {
        let mut bench = Bench::default();
        bench.apply(Change::Count(4));
        bench.apply(Change::Activate(2));
        bench.recipe.wireframe = true;
        bench.apply(Change::Activate(0));
        assert!(!bench.recipe.wireframe);
        assert_eq!(bench.recipes().iter().map(|r| r.wireframe).collect::<Vec<_>>(), [false, false, true, false]);
    }

    #[test]
    fn tiles_are_all_different_until_methods_run_out() {
        let mut bench = Bench::default();
        bench.apply(Change::Count(8));
        let mut upscalers: Vec<_> = bench.recipes().iter().map(|recipe| recipe.upscaler).collect();
        upscalers.sort();
        upscalers.dedup();
        assert_eq!(upscalers.len(), 8);
        bench.apply(Change::Every);
        let methods: Vec<_> = bench.recipes().iter().map(|recipe| recipe.upscaler.method()).collect();
        assert_eq!(methods, upscale::ALL.iter().map(|method| method.id()).collect::<Vec<_>>());
    }

    #[test]
    fn anchors_differ_only_among_enlarged_pictures_that_are_shown() {
        let mut bench = Bench::default();
        bench.apply(Change::Count(3));
        let differ = |bench: &Bench| bench.comparison.anchors_differ(&bench.tiles, bench.recipe);
        let labels = |bench: &Bench| bench.recipes().iter().map(|r| r.upscaler.label()).collect::<Vec<_>>();
        assert_eq!(labels(&bench), ["Native", "Bicubic ×4", "Nearest ×4"]);
        assert!(!differ(&bench), "corners, and native has no blocks");
        let fsr = Recipe { upscaler: Upscaling::new("fsr1", 2).unwrap(), ..bench.recipe };
        bench.apply(Change::Recipe(2, Box::new(fsr)));
        assert!(differ(&bench));
        let stated: Vec<_> = bench.recipes().iter().map(|recipe| recipe.upscaler.label_with_anchor()).collect();
        assert_eq!(stated, ["Native", "Bicubic ×4, corner", "FSR 1 ×2, centre"]);
        bench.apply(Change::Mode(Mode::Wipe));
        assert!(!differ(&bench), "the third is not shown");
    }

    #[test]
    fn removing_keeps_the_active_tile_where_it_can_and_two_at_least() {
        let mut bench = Bench::default();
        bench.apply(Change::Count(4));
        bench.apply(Change::Activate(2));
        let third = bench.recipe;
        bench.apply(Change::Remove(0));
        assert_eq!((bench.tiles.active, bench.recipe, bench.tiles.count()), (1, third, 3));
        bench.apply(Change::Activate(2));
        bench.apply(Change::Remove(2));
        assert_eq!((bench.tiles.active, bench.recipe), (1, third));
        bench.apply(Change::Remove(0));
        assert_eq!(bench.tiles.count(), 2);
    }

    #[test]
    fn swapping_changes_places_and_not_the_active_place() {
        let mut bench = Bench::default();
        bench.apply(Change::Mode(Mode::Difference));
        let [a, b] = bench.recipes()[..] else { panic!("two tiles") };
        bench.apply(Change::Swap);
        assert_eq!(bench.recipes(), [b, a]);
        assert_eq!(bench.recipe, b);
    }
}
