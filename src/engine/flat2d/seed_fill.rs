//! Span-based region filling from a seed.
//!
//! *Flood fill* recolours the connected region that has the seed's own colour; *boundary fill* recolours everything up
//! to a boundary of one colour. Pixels are connected across sides (4-connected) or also across corners (8-connected).
//! Each has a characteristic failure: an 8-connected fill leaks through a boundary that is itself only 8-connected,
//! such as a diagonal wall; a 4-connected fill stops where a region continues across a corner.
//!
//! The recursion depth of a pixel-by-pixel recursive fill can reach the number of pixels in the region. This
//! implementation pops a seed from a stack, fills the whole run of fillable pixels around it, and pushes one seed for
//! each adjacent run in the rows above and below. The fill terminates because filled pixels are no longer fillable; a
//! flood fill with the region's own colour fills nothing.

use std::ops::Range;

use super::PixelSpan;
use crate::image::Image;

/// Criterion that bounds the filled region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FillCriterion<T> {
    /// Fills the connected region that has the colour of the seed.
    Flood,
    /// Fills the region up to a boundary of this colour. Pixels that already have the new colour count as filled.
    Boundary(T),
}

/// Neighbourhood that connects pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Connectivity {
    /// Neighbours share a side.
    Four,
    /// Neighbours share a side or a corner.
    Eight,
}

/// Fill in progress; each item of the iterator fills one span of the image. See [`seed_fill`].
#[derive(Debug)]
pub(crate) struct SeedFill<'a, T> {
    image: &'a mut Image<T>,
    connectivity: Connectivity,
    new: T,
    fillable: Fillable<T>,
    seeds: Vec<(u32, u32)>,
}

/// Set of colours that the fill may replace.
#[derive(Clone, Copy, Debug)]
enum Fillable<T> {
    Only(T),
    AllBut(T),
}

/// Fills `image` with `new` from `seed`, in disjoint spans. A seed outside the picture fills nothing.
pub(crate) fn seed_fill<T: Copy + PartialEq>(
    image: &mut Image<T>,
    seed: (u32, u32),
    region: FillCriterion<T>,
    connectivity: Connectivity,
    new: T,
) -> SeedFill<'_, T> {
    let old = image.get(seed.0, seed.1);
    let fillable = match (region, old) {
        (FillCriterion::Boundary(boundary), _) => Fillable::AllBut(boundary),
        (FillCriterion::Flood, old) => Fillable::Only(old.unwrap_or(new)),
    };
    let seeds = if old.is_some() { vec![seed] } else { Vec::new() };
    SeedFill { image, connectivity, new, fillable, seeds }
}

impl<T: Copy + PartialEq> SeedFill<'_, T> {
    /// Returns the image in its current state.
    #[cfg(test)]
    pub(crate) fn image(&self) -> &Image<T> {
        self.image
    }

    /// Returns the stack of seeds; the last one is used next. Some of these pixels may already be filled.
    pub(crate) fn seeds(&self) -> &[(u32, u32)] {
        &self.seeds
    }

    fn is_fillable(&self, x: u32, y: u32) -> bool {
        let color = self.image.at(x, y);
        color != self.new
            && match self.fillable {
                Fillable::Only(old) => color == old,
                Fillable::AllBut(boundary) => color != boundary,
            }
    }

    /// Returns the columns of the run of fillable pixels that contains pixel (`x`, `y`), which must be fillable.
    fn run_around(&self, x: u32, y: u32) -> Range<u32> {
        let x0 = (0..x).rev().take_while(|x| self.is_fillable(*x, y)).last().unwrap_or(x);
        let x1 = (x..self.image.width()).take_while(|x| self.is_fillable(*x, y)).last().unwrap_or(x);
        x0..x1 + 1
    }

    /// Pushes one seed for each run of fillable pixels in the given columns of row `y`.
    fn push_runs(&mut self, columns: Range<u32>, y: u32) {
        let mut in_run = false;
        for x in columns {
            let fillable = self.is_fillable(x, y);
            if fillable && !in_run {
                self.seeds.push((x, y));
            }
            in_run = fillable;
        }
    }

    /// Fills a run of pixels in row `y` and pushes seeds for adjacent runs in the rows above and below.
    fn fill_run(&mut self, columns: Range<u32>, y: u32) {
        columns.clone().for_each(|x| self.image.set(x, y, self.new));
        let beside = match self.connectivity {
            Connectivity::Four => columns,
            Connectivity::Eight => columns.start.saturating_sub(1)..(columns.end + 1).min(self.image.width()),
        };
        if y > 0 {
            self.push_runs(beside.clone(), y - 1);
        }
        if y + 1 < self.image.height() {
            self.push_runs(beside, y + 1);
        }
    }
}

impl<T: Copy + PartialEq> Iterator for SeedFill<'_, T> {
    type Item = PixelSpan;

    fn next(&mut self) -> Option<PixelSpan> {
        loop {
            let (x, y) = self.seeds.pop()?;
            if self.is_fillable(x, y) {
                let run = self.run_around(x, y);
                self.fill_run(run.clone(), y);
                return Some(PixelSpan { y, x0: run.start, x1: run.end });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WALL: u8 = b'#';

    const NEW: u8 = b'*';

    fn picture(rows: &[&str]) -> Image<u8> {
        let pixels = rows.iter().flat_map(|row| row.bytes()).collect();
        Image::from_pixels(rows[0].len() as u32, rows.len() as u32, pixels)
    }

    fn filled(
        mut image: Image<u8>,
        seed: (u32, u32),
        region: FillCriterion<u8>,
        connectivity: Connectivity,
    ) -> Image<u8> {
        seed_fill(&mut image, seed, region, connectivity, NEW).for_each(drop);
        image
    }

    /// Returns the filled image, computed by growing the region until nothing changes: the reference for the span-based
    /// fill.
    fn by_spreading(
        image: &Image<u8>,
        seed: (u32, u32),
        region: FillCriterion<u8>,
        connectivity: Connectivity,
    ) -> Image<u8> {
        let old = image.at(seed.0, seed.1);
        let may = |x: u32, y: u32| match region {
            FillCriterion::Flood => image.at(x, y) == old && old != NEW,
            FillCriterion::Boundary(boundary) => ![boundary, NEW].contains(&image.at(x, y)),
        };
        let mut reached = Image::from_fn(image.width(), image.height(), |x, y| (x, y) == seed && may(x, y));
        loop {
            let touches = |x: u32, y: u32| {
                let steps = [-1, 0, 1].into_iter().flat_map(|dx| [-1, 0, 1].map(|dy| (dx, dy)));
                steps.filter(|(dx, dy)| connectivity == Connectivity::Eight || dx * dy == 0).any(|(dx, dy)| {
                    let neighbour = x.checked_add_signed(dx).zip(y.checked_add_signed(dy));
                    neighbour.is_some_and(|(x, y)| reached.get(x, y) == Some(true))
                })
            };
            let next = Image::from_fn(image.width(), image.height(), |x, y| may(x, y) && touches(x, y));
            if next == reached {
                return Image::from_fn(image.width(), image.height(), |x, y| {
                    if reached.at(x, y) { NEW } else { image.at(x, y) }
                });
            }
            reached = next;
        }
    }

    #[test]
    fn the_filled_region_is_the_connected_one() {
        let mut random = fastrand::Rng::with_seed(71);
        for round in 0..600 {
            let (width, height) = (random.u32(1..14), random.u32(1..14));
            let walls = [0.1, 0.35, 0.5][round % 3];
            let image = Image::from_fn(width, height, |_, _| match random.f32() {
                share if share < walls => WALL,
                share if share > 0.95 => NEW,
                _ => b'.',
            });
            let seed = (random.u32(0..width), random.u32(0..height));
            for region in [FillCriterion::Flood, FillCriterion::Boundary(WALL), FillCriterion::Boundary(NEW)] {
                for connectivity in [Connectivity::Four, Connectivity::Eight] {
                    assert_eq!(
                        filled(image.clone(), seed, region, connectivity),
                        by_spreading(&image, seed, region, connectivity),
                        "{region:?} {connectivity:?} from {seed:?} in {image:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_two_failures_are_those_of_the_textbook() {
        let diagonal_wall = picture(&["..#.", ".#..", "#..."]);
        let four = filled(diagonal_wall.clone(), (0, 0), FillCriterion::Flood, Connectivity::Four);
        assert_eq!(four, picture(&["**#.", "*#..", "#..."]), "stops at the corner");
        let eight = filled(diagonal_wall, (0, 0), FillCriterion::Flood, Connectivity::Eight);
        assert_eq!(eight, picture(&["**#*", "*#**", "#***"]), "leaks through the wall");
    }

    #[test]
    fn a_flood_of_its_own_colour_and_a_seed_outside_end_at_once() {
        let mut image = Image::filled(50, 50, NEW);
        for region in [FillCriterion::Flood, FillCriterion::Boundary(WALL)] {
            assert_eq!(seed_fill(&mut image, (3, 3), region, Connectivity::Four, NEW).count(), 0);
            assert_eq!(seed_fill(&mut image, (50, 3), region, Connectivity::Four, b'.').count(), 0);
        }
    }

    #[test]
    fn spans_never_share_a_pixel_and_the_stack_stays_small() {
        // A comb of corridors is the worst case for recursion.
        let mut image = Image::from_fn(400, 400, |x, y| if x % 2 == 1 && y > 0 { WALL } else { b'.' });
        let open = image.pixels().iter().filter(|p| **p == b'.').count();
        let mut fill = seed_fill(&mut image, (0, 399), FillCriterion::Flood, Connectivity::Four, NEW);
        let (mut covered, mut deepest) = (0, 0);
        while let Some(span) = fill.next() {
            covered += (span.x1 - span.x0) as usize;
            deepest = deepest.max(fill.seeds().len());
        }
        assert_eq!(covered, open);
        assert!(deepest <= 400, "{deepest} seeds");
        assert!(fill.image().pixels().iter().all(|p| *p != b'.'));
    }
}
