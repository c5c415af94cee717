//! Checkerboard rendering: half of the image is drawn as 2×2-pixel squares, the other half is interpolated.
//!
//! Every pixel of a missing square touches two drawn pixels: one in its row and one in its column. It becomes their
//! mean. At image borders there may be only one or none. One rule covers all cases: a missing pixel is *the mean of the
//! nearest drawn pixels*.
//!
//! ```text
//!   a a . . e e      . at column 2, row 1: mean of the a beside it and the c below it
//!   a a . . e e      . at column 2, row 0: the a beside it, because nothing lies above
//!   . . c c . .      . at column 0, row 3, an image corner: mean of the a and the c two pixels away
//!   . . c c . .
//! ```

use std::ops::Range;

use rayon::prelude::*;

use super::{BEHIND, OFFERS, TOUCHING, neighbours, packed_column, step};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;
use crate::upscale::{Offers, Sampling, Tap, UpscaleInputs, Upscaler, Upscaling};

/// Checkerboard rendering that sets each missing pixel to the mean of the nearest drawn ones.
pub(crate) static CHECKERBOARD: Checkerboard = Checkerboard;

/// [`Upscaler`] implementation of [`CHECKERBOARD`].
pub(crate) struct Checkerboard;

impl Upscaler for Checkerboard {
    fn id(&self) -> &'static str {
        "checkerboard"
    }

    fn name(&self) -> &'static str {
        "Checkerboard"
    }

    fn help(&self) -> &'static str {
        "Draws the 2×2-pixel squares of one colour of a checkerboard, half of the picture; every other pixel becomes \
         the mean of its two drawn neighbours, one beside it and one above or below. Good where little changes within \
         two pixels. Each missing pixel is filled from one diagonal side, so slanted edges become jagged and thin \
         lines break up. Means are rounded; pixels at the border are filled in, too."
    }

    fn artefacts(&self) -> &'static str {
        "slanted edges fray, thin lines break"
    }

    fn offers(&self) -> Offers {
        OFFERS
    }

    fn sampling(&self, _how: Upscaling) -> Sampling {
        Sampling::Grid(SampleGrid::Checkerboard)
    }

    fn upscale(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        let (width, height) = full.size();
        let rows = full.pixels_mut().par_chunks_mut((width as usize).max(1));
        rows.zip(0..height).for_each(|(row, y)| fill_row(drawn.color, y, width, height, row));
    }

    fn pixel(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        mean_of_sources(drawn.color, size, at)
    }

    fn taps(
        &self,
        _how: Upscaling,
        _drawn: &UpscaleInputs<'_>,
        (width, height): (u32, u32),
        (x, y): (u32, u32),
    ) -> Vec<Tap> {
        let [a, b] = sources(x, y, width, height);
        if a == b {
            vec![Tap { x: a.0, y: a.1, weight: 1.0 }]
        } else {
            [a, b].map(|(x, y)| Tap { x, y, weight: 0.5 }).to_vec()
        }
    }
}

/// Computes one pixel, bit-identical to the whole-image kernel.
pub(super) fn mean_of_sources(drawn: &Image<Rgba8>, (width, height): (u32, u32), (x, y): (u32, u32)) -> Rgba8 {
    let [a, b] = sources(x, y, width, height).map(|(x, y)| drawn.at(packed_column(x), y));
    mean(a, b)
}

/// Returns the two drawn pixels whose mean is pixel (x, y); both are equal if there is only one.
fn sources(x: u32, y: u32, width: u32, height: u32) -> [(u32, u32); 2] {
    let drawn = [(x, y); 2];
    if SampleGrid::Checkerboard.sample_at(x, y).is_some() {
        return drawn;
    }
    let pair = |by| {
        let [beside, across] = neighbours(by, (width, height), (x, y));
        Some([beside.or(across)?, across.or(beside)?])
    };
    // A drawn square lies left of or above every missing square, so a pixel that touches no drawn pixel has one behind
    // it.
    pair(TOUCHING).or_else(|| pair(BEHIND)).unwrap_or(drawn)
}

/// Fills row `y`: its interior in blocks of four pixels, and its ends pixel by pixel.
fn fill_row(drawn: &Image<Rgba8>, y: u32, width: u32, height: u32, row: &mut [Rgba8]) {
    let drawn_first = SampleGrid::Checkerboard.sample_at(0, y).is_some();
    let filled =
        step(y, TOUCHING, height).map_or(0..0, |across| fill_blocks(drawn.row(y), drawn.row(across), drawn_first, row));
    for x in (0..filled.start).chain(filled.end..width) {
        let [a, b] = sources(x, y, width, height).map(|(x, y)| drawn.at(packed_column(x), y));
        row[x as usize] = mean(a, b);
    }
}

/// Fills the blocks of four pixels whose sources all lie inside the image. `own` has the drawn pixels of the same row.
/// `across` has the drawn pixels of the row above or below that the missing pixels touch. Returns the columns filled.
fn fill_blocks(own: &[Rgba8], across: &[Rgba8], drawn_first: bool, row: &mut [Rgba8]) -> Range<u32> {
    let width = row.len();
    let blocks = if drawn_first { 0..(width - 1) / 4 } else { 1.min(width / 4)..width / 4 };
    for block in blocks.clone() {
        let i = 2 * block;
        row[4 * block..4 * block + 4].copy_from_slice(&if drawn_first {
            [own[i], own[i + 1], mean(own[i + 1], across[i]), mean(own[i + 2], across[i + 1])]
        } else {
            [mean(own[i - 1], across[i]), mean(own[i], across[i + 1]), own[i], own[i + 1]]
        });
    }
    4 * blocks.start as u32..4 * blocks.end as u32
}

/// Computes the mean of two colours in each channel, rounding halves up. It follows from a + b = 2 (a | b) − (a ^ b).
/// The mask keeps bits from shifting into the adjacent channel.
fn mean(a: Rgba8, b: Rgba8) -> Rgba8 {
    let (a, b) = (u32::from_ne_bytes(a), u32::from_ne_bytes(b));
    ((a | b) - (((a ^ b) >> 1) & 0x7f7f_7f7f)).to_ne_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_rounds_half_up_in_every_channel() {
        for a in 0..=255_u8 {
            for b in 0..=255_u8 {
                let expected = (u16::from(a) + u16::from(b)).div_ceil(2) as u8;
                assert_eq!(mean([a, b, a, 255], [b, a, a, 0]), [expected, expected, a, 128], "{a}, {b}");
            }
        }
    }

    #[test]
    fn packed_columns_are_those_of_the_grid() {
        for (x, y) in (0..40).flat_map(|x| (0..8).map(move |y| (x, y))) {
            if let Some((column, _)) = SampleGrid::Checkerboard.sample_at(x, y) {
                assert_eq!(packed_column(x), column, "({x}, {y})");
            }
        }
    }

    #[test]
    fn a_missing_pixel_is_the_mean_of_the_nearest_drawn_ones() {
        for (width, height) in (1..=13).flat_map(|width| (1..=13).map(move |height| (width, height))) {
            for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
                let mut sources = sources(x, y, width, height).to_vec();
                sources.sort_unstable();
                sources.dedup();
                assert_eq!(sources, nearest_drawn(x, y, width, height), "({x}, {y}) of {width}×{height}");
            }
        }
    }

    /// Returns the nearest drawn pixels in sorted order, found by testing all of them.
    fn nearest_drawn(x: u32, y: u32, width: u32, height: u32) -> Vec<(u32, u32)> {
        let distance = |&(i, j): &(u32, u32)| x.abs_diff(i).pow(2) + y.abs_diff(j).pow(2);
        let drawn: Vec<_> = (0..width)
            .flat_map(|i| (0..height).map(move |j| (i, j)))
            .filter(|(i, j)| SampleGrid::Checkerboard.sample_at(*i, *j).is_some())
            .collect();
        let least = drawn.iter().map(distance).min();
        drawn.into_iter().filter(|place| Some(distance(place)) == least).collect()
    }
}
