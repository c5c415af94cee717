//! Lab page on filling a region of a painted grid from a seed.

mod picture;

use glam::DVec2;

use super::recording::{Ink, Mark, MethodComparison, MethodResult, RecordedStep, Recording, Tone, cell, pair, time_of};
use crate::flat2d::seed_fill::{Connectivity, FillCriterion, seed_fill};
use crate::flat2d::stack_fill::stack_fill;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};
use picture::painted;

choice! {
    /// Criterion by which a pixel belongs to the filled region.
    pub RegionKind {
        Flood = "flood", "Flood", "All pixels of the seed's colour that are connected with it.";
        Boundary = "boundary", "Boundary", "All connected pixels up to a wall, of any colour.";
    }
}

choice! {
    /// Connectivity of the filled region.
    pub Neighbours {
        Four = "four", "4-connected", "Neighbours share an edge: right, below, left, above.";
        Eight = "eight", "8-connected", "Neighbours share an edge or a corner.";
    }
}

choice! {
    /// Order in which a seed fill visits pixels.
    pub FillOrder {
        Spans = "spans", "By spans",
            "Fills whole runs and pushes one seed for each run above and below: the stack stays small.";
        Pixels = "pixels", "By pixels",
            "Fills pixel by pixel in the order of the recursion, and shows the stack of pending calls.";
    }
}

choice! {
    /// Preset grid.
    pub SeedFillPreset {
        Room = "room", "Two rooms", "4-connected walls with a door.";
        DiagonalWall = "diagonal-wall", "Diagonal wall",
            "A wall whose pixels touch at corners only: an 8-connected fill leaks through.";
        DiagonalRegion = "diagonal-region", "Diagonal region",
            "Two rooms that are connected through corners only: a 4-connected fill misses most of the region.";
        Comb = "comb", "Comb", "Narrow corridors: the deepest recursion.";
        Empty = "empty", "Empty", "An empty grid to paint on.";
    }
}

/// Content of a pixel of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// Background pixel, which a fill may replace.
    Paper,
    /// Wall: the boundary colour of a boundary fill.
    Wall,
    /// Coloured pixel: a flood fill stops there, a boundary fill does not.
    Spot,
    /// Pixel filled by the algorithm.
    Filled,
}

/// Size of the grid, in columns and rows.
const SIZE: (u32, u32) = (30, 20);

/// Input and settings of the lab page on seed fills.
#[derive(Clone, Debug, PartialEq)]
pub struct SeedFillLesson {
    /// Grid before the fill.
    pub grid: Image<Paint>,
    /// Column and row of the pixel where the fill starts.
    pub seed: (u32, u32),
    /// Criterion by which a pixel belongs to the region.
    pub region: RegionKind,
    /// Connectivity of the region.
    pub neighbours: Neighbours,
    /// Order in which the fill visits pixels.
    pub order: FillOrder,
}

impl Default for SeedFillLesson {
    fn default() -> Self {
        let region = RegionKind::Flood;
        let (grid, seed) = SeedFillPreset::Room.grid();
        Self { grid, seed, region, neighbours: Neighbours::Four, order: FillOrder::Spans }
    }
}

impl SeedFillPreset {
    /// Returns the grid of the preset and its seed.
    pub fn grid(self) -> (Image<Paint>, (u32, u32)) {
        let (width, height) = SIZE;
        let paint = |is_wall: &dyn Fn(u32, u32) -> bool| {
            Image::from_fn(width, height, |x, y| if is_wall(x, y) { Paint::Wall } else { Paint::Paper })
        };
        match self {
            Self::Room => {
                let frame =
                    |x, y| (x == 3 || x == 26) && (2..18).contains(&y) || (y == 2 || y == 17) && (3..27).contains(&x);
                let middle = |x, y| x == 14 && (3..17).contains(&y) && y != 9;
                let mut grid = paint(&|x, y| frame(x, y) || middle(x, y));
                (18..22).for_each(|x| (5..8).for_each(|y| grid.set(x, y, Paint::Spot)));
                (grid, (8, 6))
            }
            Self::DiagonalWall => (paint(&|x, y| x + y == 22), (5, 5)),
            Self::DiagonalRegion => {
                let grid = paint(&|x, y| {
                    let room =
                        (2..9).contains(&x) && (2..7).contains(&y) || (16..26).contains(&x) && (12..18).contains(&y);
                    let corridor = (9..16).contains(&x) && x == y + 2;
                    !(room || corridor || x == 16 && y == 14)
                });
                (grid, (4, 4))
            }
            Self::Comb => (paint(&|x, y| x % 2 == 1 && if x % 4 == 1 { y > 0 } else { y + 1 < height }), (0, 10)),
            Self::Empty => (paint(&|_, _| false), (width / 2, height / 2)),
        }
    }
}

impl SeedFillLesson {
    /// Replaces the grid by a picture that is reduced to the grid's size: dark pixels become [`Paint::Wall`], coloured
    /// ones [`Paint::Spot`].
    pub(crate) fn set_picture(&mut self, picture: &Image<Rgba8>) {
        self.grid = painted(picture, SIZE);
    }

    fn region(&self) -> FillCriterion<Paint> {
        match self.region {
            RegionKind::Flood => FillCriterion::Flood,
            RegionKind::Boundary => FillCriterion::Boundary(Paint::Wall),
        }
    }

    fn connectivity(&self) -> Connectivity {
        match self.neighbours {
            Neighbours::Four => Connectivity::Four,
            Neighbours::Eight => Connectivity::Eight,
        }
    }

    /// Paints a pixel; positions outside the grid are ignored.
    pub fn paint(&mut self, (x, y): (u32, u32), paint: Paint) {
        if self.grid.get(x, y).is_some() {
            self.grid.set(x, y, paint);
        }
    }

    pub(super) fn record(&self) -> Recording {
        let mut recording = Recording::new(self.grid.size());
        let places = (0..self.grid.height()).flat_map(|y| (0..self.grid.width()).map(move |x| (x, y)));
        let painted = places.filter_map(|(x, y)| {
            let ink = match self.grid.at(x, y) {
                Paint::Paper => return None,
                Paint::Wall => Ink::Wall,
                Paint::Spot => Ink::Group(3),
                Paint::Filled => Ink::Full,
            };
            Some(cell((x.into(), y.into()), ink))
        });
        recording.ground.extend(painted);
        let mut grid = self.grid.clone();
        let deepest = match self.order {
            FillOrder::Pixels => self.record_pixels(&mut grid, &mut recording),
            FillOrder::Spans => self.record_spans(&mut grid, &mut recording),
        };
        let filled: usize = recording.steps.iter().map(|step| step.cells.len()).sum();
        recording.fact("pixels filled", filled.to_string());
        recording.fact("steps", recording.steps.len().to_string());
        recording.fact("largest stack size", deepest.to_string());
        recording
    }

    /// Records a fill pixel by pixel. Returns the maximum number of pixels on the stack.
    fn record_pixels(&self, grid: &mut Image<Paint>, recording: &mut Recording) -> usize {
        let mut walk = stack_fill(grid, self.seed, self.region(), self.connectivity(), Paint::Filled);
        let mut deepest = 0;
        recording.collect(std::iter::from_fn(|| {
            let (x, y) = walk.next()?;
            deepest = deepest.max(walk.stack().len());
            let says = format!("Pixel ({x}, {y}) is popped and filled; its open neighbours are pushed.");
            Some(stack_step(&[(x, y)], walk.stack(), says))
        }));
        deepest
    }

    fn record_spans(&self, grid: &mut Image<Paint>, recording: &mut Recording) -> usize {
        let mut walk = seed_fill(grid, self.seed, self.region(), self.connectivity(), Paint::Filled);
        let mut deepest = 0;
        recording.collect(std::iter::from_fn(|| {
            let span = walk.next()?;
            deepest = deepest.max(walk.seeds().len());
            let says = format!(
                "Row {}: columns {} to {} are filled; one seed per open run above and below is pushed.",
                span.y,
                span.x0,
                span.x1 - 1
            );
            let filled: Vec<_> = (span.x0..span.x1).map(|x| (x, span.y)).collect();
            Some(stack_step(&filled, walk.seeds(), says))
        }));
        deepest
    }

    pub(super) fn walk(&self) -> usize {
        let mut grid = self.grid.clone();
        match self.order {
            FillOrder::Pixels => {
                stack_fill(&mut grid, self.seed, self.region(), self.connectivity(), Paint::Filled).count()
            }
            FillOrder::Spans => {
                seed_fill(&mut grid, self.seed, self.region(), self.connectivity(), Paint::Filled).count()
            }
        }
    }

    pub(super) fn explanation(&self) -> &'static str {
        match (self.neighbours, self.order) {
            (Neighbours::Four, FillOrder::Spans) => {
                "A seed fill spreads from a pixel to its neighbours. A 4-connected fill cannot pass between two wall \
                 pixels that touch at a corner, but it also stops where the region continues through a corner only. \
                 Instead of recursing for each pixel, this variant fills a whole run and pushes one seed (dots) per \
                 open run above and below. Paint walls with the mouse and watch the stack."
            }
            (Neighbours::Eight, FillOrder::Spans) => {
                "An 8-connected fill reaches regions that are connected diagonally, and leaks through walls that are \
                 only diagonal. So an 8-connected fill needs 4-connected walls, while 8-connected walls stop a \
                 4-connected fill. Try the presets Diagonal wall and Diagonal region with both kinds of neighbours."
            }
            (_, FillOrder::Pixels) => {
                "The textbook procedure calls itself for every neighbour. Each pending call (dots) occupies a frame of \
                 the program's stack. Their number grows with the area, so a large region overflows the stack. Compare \
                 the largest stack size with the one of the fill by spans."
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        vec![DVec2::new(self.seed.0.into(), self.seed.1.into()) + 0.5]
    }

    pub(super) fn move_handle(&mut self, _: usize, to: DVec2) {
        let within = |place: f64, length: u32| (place.floor().max(0.0) as u32).min(length - 1);
        self.seed = (within(to.x, self.grid.width()), within(to.y, self.grid.height()));
    }
}

/// Compared methods: display name, connectivity and fill order.
const METHODS: [(&str, Neighbours, FillOrder); 4] = [
    ("4-connected, by pixels", Neighbours::Four, FillOrder::Pixels),
    ("4-connected, by spans", Neighbours::Four, FillOrder::Spans),
    ("8-connected, by pixels", Neighbours::Eight, FillOrder::Pixels),
    ("8-connected, by spans", Neighbours::Eight, FillOrder::Spans),
];

impl SeedFillLesson {
    /// Compares all methods on the grid, enlarged 8 times. The reference is the region connected to the seed by the
    /// chosen connectivity.
    pub(super) fn compare(&self) -> MethodComparison {
        const LARGER: u32 = 8;
        let (width, height) = (self.grid.width() * LARGER, self.grid.height() * LARGER);
        let larger = Self {
            grid: Image::from_fn(width, height, |x, y| self.grid.at(x / LARGER, y / LARGER)),
            seed: (self.seed.0 * LARGER, self.seed.1 * LARGER),
            ..self.clone()
        };
        let truth = larger.connected_region();
        let rivals = METHODS.into_iter().map(|(name, neighbours, order)| {
            let way = Self { neighbours, order, ..larger.clone() };
            let filled = way.filled();
            let wrong = filled.pixels().iter().zip(truth.pixels()).filter(|(a, b)| a != b).count();
            MethodResult { name, error: wrong as f64, time: time_of(|| way.walk()) }
        });
        MethodComparison {
            task: format!("the grid on {width} × {height} px, {}", self.neighbours.name()),
            error: "wrong pixels",
            methods: rivals.collect(),
            note: None,
        }
    }

    /// Returns for each pixel whether the fill reaches it.
    fn filled(&self) -> Image<bool> {
        let (mut grid, mut filled) = (self.grid.clone(), self.grid.map(|_| false));
        let (region, connectivity) = (self.region(), self.connectivity());
        match self.order {
            FillOrder::Pixels => stack_fill(&mut grid, self.seed, region, connectivity, Paint::Filled)
                .for_each(|(x, y)| filled.set(x, y, true)),
            FillOrder::Spans => seed_fill(&mut grid, self.seed, region, connectivity, Paint::Filled)
                .for_each(|span| (span.x0..span.x1).for_each(|x| filled.set(x, span.y, true))),
        }
        filled
    }

    /// Returns for each pixel whether it is connected to the seed. Follows the definition: repeated sweeps over the
    /// whole grid add every fillable pixel that has a connected neighbour, until nothing changes. Needs no stack.
    fn connected_region(&self) -> Image<bool> {
        let (width, height) = self.grid.size();
        let seed = self.grid.at(self.seed.0, self.seed.1);
        let is_open = |paint: Paint| match self.region {
            RegionKind::Flood => paint == seed,
            RegionKind::Boundary => paint != Paint::Wall,
        };
        let reach = |(dx, dy): &(i64, i64)| self.neighbours == Neighbours::Eight || dx * dy == 0;
        let around: Vec<(i64, i64)> = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))).filter(reach).collect();
        let mut belongs = Image::from_fn(width, height, |x, y| (x, y) == self.seed && is_open(self.grid.at(x, y)));
        let mut forwards: Vec<(u32, u32)> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
        loop {
            let mut joined = false;
            for (x, y) in forwards.iter().copied().filter(|(x, y)| is_open(self.grid.at(*x, *y))) {
                let beside = |(dx, dy): &(i64, i64)| belongs.at_clamped(i64::from(x) + dx, i64::from(y) + dy);
                if !belongs.at(x, y) && around.iter().any(beside) {
                    belongs.set(x, y, true);
                    joined = true;
                }
            }
            if !joined {
                return belongs;
            }
            // Every other sweep runs backwards, so that paths in both directions are found equally fast.
            forwards.reverse();
        }
    }
}

/// Returns a recorded step that sets the pixels `filled` and shows the stack of pending pixels after it.
fn stack_step(filled: &[(u32, u32)], stack: &[(u32, u32)], says: String) -> RecordedStep {
    /// Maximum number of pending pixels listed in the state.
    const LISTED: usize = 14;
    let center = |(x, y): &(u32, u32)| DVec2::new((*x).into(), (*y).into()) + 0.5;
    let mut state = vec![pair("stack size", stack.len().to_string())];
    state.extend(stack.iter().rev().take(LISTED).enumerate().map(|(place, (x, y))| {
        let name = if place == 0 { "top of the stack".to_owned() } else { format!("{place} below top") };
        (name, format!("({x}, {y})"))
    }));
    RecordedStep {
        cells: filled.iter().map(|(x, y)| cell((i64::from(*x), i64::from(*y)), Ink::Full)).collect(),
        marks: stack.iter().map(|pixel| Mark::Dot(center(pixel), Tone::Focus)).collect(),
        description: says,
        state,
    }
}
