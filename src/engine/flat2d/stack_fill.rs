//! Pixel-by-pixel region filling in the order of the textbook's recursion, but with an explicit stack.
//!
//! The recursive form calls itself for each neighbour of a pixel. Here, the pending calls are pixels on a stack. The
//! stack can grow in proportion to the region's area, which would overflow the call stack of a recursive program.
//! [`super::seed_fill`] fills the same pixels by spans, with a stack that stays small.

use super::seed_fill::{Connectivity, FillCriterion};
use crate::image::Image;

/// Offsets (right, down) of the neighbours that share a side; [`CORNERS`] holds the offsets of those that share only a
/// corner.
const SIDES: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];
const CORNERS: [(i32, i32); 4] = [(1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Fill in progress; each item of the iterator is one filled pixel. See [`stack_fill`].
#[derive(Debug)]
pub(crate) struct StackFill<'a, T> {
    image: &'a mut Image<T>,
    connectivity: Connectivity,
    new: T,
    old: Option<T>,
    region: FillCriterion<T>,
    stack: Vec<(u32, u32)>,
}

/// Fills `image` with `new` from `seed`, one pixel per item. A seed outside the picture fills nothing.
pub(crate) fn stack_fill<T: Copy + PartialEq>(
    image: &mut Image<T>,
    seed: (u32, u32),
    region: FillCriterion<T>,
    connectivity: Connectivity,
    new: T,
) -> StackFill<'_, T> {
    let old = image.get(seed.0, seed.1);
    StackFill { image, connectivity, new, old, region, stack: vec![seed] }
}

impl<T: Copy + PartialEq> StackFill<'_, T> {
    /// Returns the stack of pending pixels; the last one is used next. Some of these pixels may already be filled.
    pub(crate) fn stack(&self) -> &[(u32, u32)] {
        &self.stack
    }

    fn is_fillable(&self, (x, y): (u32, u32)) -> bool {
        self.image.get(x, y).is_some_and(|color| {
            color != self.new
                && match self.region {
                    FillCriterion::Flood => Some(color) == self.old,
                    FillCriterion::Boundary(boundary) => color != boundary,
                }
        })
    }
}

impl<T: Copy + PartialEq> Iterator for StackFill<'_, T> {
    type Item = (u32, u32);

    fn next(&mut self) -> Option<(u32, u32)> {
        loop {
            let pixel = self.stack.pop()?;
            if !self.is_fillable(pixel) {
                continue;
            }
            self.image.set(pixel.0, pixel.1, self.new);
            let corners: &[_] = if self.connectivity == Connectivity::Eight { &CORNERS } else { &[] };
            // The last pixel pushed is the first one filled: the neighbour to the right, as in the recursion.
            for (right, down) in corners.iter().chain(SIDES.iter().rev()) {
                let neighbour = pixel.0.checked_add_signed(*right).zip(pixel.1.checked_add_signed(*down));
                if let Some(neighbour) = neighbour.filter(|neighbour| self.is_fillable(*neighbour)) {
                    self.stack.push(neighbour);
                }
            }
            return Some(pixel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flat2d::seed_fill::seed_fill;

    #[test]
    fn the_same_pixels_are_filled_as_by_spans() {
        let mut random = fastrand::Rng::with_seed(72);
        for _ in 0..400 {
            let image = Image::from_fn(random.u32(1..14), random.u32(1..14), |_, _| random.u8(0..3));
            let seed = (random.u32(0..image.width()), random.u32(0..image.height()));
            for region in [FillCriterion::Flood, FillCriterion::Boundary(1), FillCriterion::Boundary(9)] {
                for connectivity in [Connectivity::Four, Connectivity::Eight] {
                    let (mut by_pixels, mut by_spans) = (image.clone(), image.clone());
                    let filled = stack_fill(&mut by_pixels, seed, region, connectivity, 9).count();
                    seed_fill(&mut by_spans, seed, region, connectivity, 9).for_each(drop);
                    assert_eq!(by_pixels, by_spans, "{region:?} {connectivity:?} from {seed:?} in {image:?}");
                    let changed = image.pixels().iter().zip(by_pixels.pixels()).filter(|(a, b)| a != b).count();
                    assert_eq!(filled, changed, "each pixel comes once");
                }
            }
        }
    }

    #[test]
    fn a_seed_outside_fills_nothing_and_a_large_region_needs_no_recursion() {
        let mut image = Image::filled(1_000, 1_000, 0_u8);
        assert_eq!(stack_fill(&mut image, (1_000, 3), FillCriterion::Flood, Connectivity::Four, 1).count(), 0);
        let mut fill = stack_fill(&mut image, (500, 500), FillCriterion::Flood, Connectivity::Four, 1);
        let mut deepest = 0;
        let mut filled = 0;
        while fill.next().is_some() {
            filled += 1;
            deepest = deepest.max(fill.stack().len());
        }
        assert_eq!(filled, 1_000_000);
        assert!(deepest > 100_000, "recursion would be {deepest} deep or more");
    }
}
