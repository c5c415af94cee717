//! Filling a region of a painted grid from a seed.

use glam::DVec2;

use super::picture::painted;
use super::recording::{Comparison, Ink, Mark, Recording, Rival, Step, Tone, cell, pair, time_of};
use crate::flat2d::seed_fill::{Connectivity, Region, seed_fill};
use crate::flat2d::stack_fill::stack_fill;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// What is filled.
    RegionKind {
        Flood = "flood", "Flood", "Everything of the seed's own colour that hangs together with it.";
        Boundary = "boundary", "Boundary", "Everything up to a wall, whatever colour it has.";
    }
}

choice! {
    /// Which neighbours belong together.
    Neighbours {
        Four = "four", "4, over sides", "Right, below, left, above.";
        Eight = "eight", "8, over corners too", "The four corners as well.";
    }
}

choice! {
    /// How the fill proceeds.
    FillOrder {
        Spans = "spans", "By spans", "Whole runs are filled, and one seed is kept for each run above and below: the stack stays small.";
        Pixels = "pixels", "By pixels", "Pixel by pixel in the order of the recursion, with the stack of waiting calls laid open.";
    }
}

choice! {
    /// A grid to start from.
    SeedFillPreset {
        Room = "room", "Two rooms", "Walls that are closed over sides, and a door.";
        DiagonalWall = "diagonal-wall", "Diagonal wall", "A wall that hangs together over corners only: an 8-connected fill leaks through.";
        DiagonalRegion = "diagonal-region", "Diagonal region", "A region that hangs together over corners only: a 4-connected fill misses most of it.";
        Comb = "comb", "Comb", "Narrow corridors: the deepest recursion.";
        Empty = "empty", "Empty", "Nothing but paper, to paint on.";
    }
}

/// What a pixel of the grid is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// Nothing yet.
    Paper,
    /// A wall.
    Wall,
    /// Another colour than the paper: a flood stops there, a boundary fill does not.
    Spot,
    /// What is filled in.
    Filled,
}

/// Columns and rows of the grid.
const SIZE: (u32, u32) = (30, 20);

/// A grid and a seed.
#[derive(Clone, Debug, PartialEq)]
pub struct SeedFillLesson {
    /// The picture.
    pub grid: Image<Paint>,
    /// Where the fill begins.
    pub seed: (u32, u32),
    /// What is filled.
    pub region: RegionKind,
    /// Over which neighbours.
    pub neighbours: Neighbours,
    /// In which order.
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
    /// Its picture and its seed.
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
    /// Makes a picture the grid, reduced to its size: what is dark is wall, what has a colour is spot.
    pub fn set_picture(&mut self, picture: &Image<Rgba8>) {
        self.grid = painted(picture, SIZE);
    }

    fn region(&self) -> Region<Paint> {
        match self.region {
            RegionKind::Flood => Region::Flood,
            RegionKind::Boundary => Region::Boundary(Paint::Wall),
        }
    }

    fn connectivity(&self) -> Connectivity {
        match self.neighbours {
            Neighbours::Four => Connectivity::Four,
            Neighbours::Eight => Connectivity::Eight,
        }
    }

    /// Paints a pixel of the grid, if it is one.
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
        recording.fact("most that ever waited", deepest.to_string());
        recording
    }

    /// Returns the greatest length of the stack.
    fn record_pixels(&self, grid: &mut Image<Paint>, recording: &mut Recording) -> usize {
        let mut walk = stack_fill(grid, self.seed, self.region(), self.connectivity(), Paint::Filled);
        let mut deepest = 0;
        recording.collect(std::iter::from_fn(|| {
            let (x, y) = walk.next()?;
            deepest = deepest.max(walk.stack().len());
            let says =
                format!("Pixel ({x}, {y}) is taken from the stack and filled; its open neighbours are put there.");
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
                "Row {}: columns {} to {} are filled; one seed per open run beside is kept.",
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
                "A seed fill spreads from a pixel to its neighbours. Over sides only, it cannot slip between two walls that touch at a corner, \
                 but it also stops where the region itself goes on over a corner. Instead of calling itself for each pixel, this one fills a whole run \
                 and remembers one seed (dots) per open run above and below. Paint walls with the mouse and watch the stack."
            }
            (Neighbours::Eight, FillOrder::Spans) => {
                "Over corners as well, the fill reaches regions that hang together diagonally, and leaks through walls that do. So a fill over \
                 corners needs walls closed over sides, and a fill over sides is enough for them. Try the presets Diagonal wall and Diagonal region \
                 with both kinds of neighbours."
            }
            (_, FillOrder::Pixels) => {
                "The textbook's procedure calls itself for every neighbour. Each call that has not ended yet takes room on the stack of the program: \
                 here these are the dots. Their number grows with the area, and a large region overflows the stack. Compare the greatest number with \
                 the one of filling by spans."
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

/// Name of each way, its neighbours and its order.
const WAYS: [(&str, Neighbours, FillOrder); 4] = [
    ("4 neighbours, by pixels", Neighbours::Four, FillOrder::Pixels),
    ("4 neighbours, by spans", Neighbours::Four, FillOrder::Spans),
    ("8 neighbours, by pixels", Neighbours::Eight, FillOrder::Pixels),
    ("8 neighbours, by spans", Neighbours::Eight, FillOrder::Spans),
];

impl SeedFillLesson {
    /// All ways on the grid made larger, against what hangs together over the chosen neighbours.
    pub(super) fn compare(&self) -> Comparison {
        const LARGER: u32 = 8;
        let (width, height) = (self.grid.width() * LARGER, self.grid.height() * LARGER);
        let larger = Self {
            grid: Image::from_fn(width, height, |x, y| self.grid.at(x / LARGER, y / LARGER)),
            seed: (self.seed.0 * LARGER, self.seed.1 * LARGER),
            ..self.clone()
        };
        let truth = larger.hanging_together();
        let rivals = WAYS.into_iter().map(|(name, neighbours, order)| {
            let way = Self { neighbours, order, ..larger.clone() };
            let filled = way.filled();
            let wrong = filled.pixels().iter().zip(truth.pixels()).filter(|(a, b)| a != b).count();
            Rival { name, error: wrong as f64, time: time_of(|| way.walk()) }
        });
        Comparison {
            task: format!("the grid on {width} × {height} px, {}", self.neighbours.name()),
            error: "wrong pixels",
            rivals: rivals.collect(),
            note: None,
        }
    }

    /// Which pixels the fill reaches.
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

    /// Which pixels hang together with the seed, by definition: the whole grid is gone over again and again, and each open
    /// pixel beside one that belongs to it joins, until none does. No stack and no order of filling is involved.
    fn hanging_together(&self) -> Image<bool> {
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
            // Every second time from the end: ways back are found as fast as ways on.
            forwards.reverse();
        }
    }
}

/// A step with the stack as it is afterwards.
fn stack_step(filled: &[(u32, u32)], stack: &[(u32, u32)], says: String) -> Step {
    /// Waiting pixels that are written out.
    const LISTED: usize = 14;
    let center = |(x, y): &(u32, u32)| DVec2::new((*x).into(), (*y).into()) + 0.5;
    let mut state = vec![pair("waiting", stack.len().to_string())];
    state.extend(stack.iter().rev().take(LISTED).enumerate().map(|(place, (x, y))| {
        let name = if place == 0 { "top of the stack".to_owned() } else { format!("{place} below") };
        (name, format!("({x}, {y})"))
    }));
    Step {
        cells: filled.iter().map(|(x, y)| cell((i64::from(*x), i64::from(*y)), Ink::Full)).collect(),
        marks: stack.iter().map(|pixel| Mark::Dot(center(pixel), Tone::Focus)).collect(),
        says,
        state,
    }
}
