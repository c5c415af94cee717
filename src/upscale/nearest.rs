//! Each sample fills its block.

use rayon::prelude::*;

use super::lattice::Lattice;
use super::separable::SCALES;
use super::{Anchor, Drawn, Light, Offers, Sampling, Tap, Upscaler, Upscaling};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::Choice as _;

/// Each sample fills its block.
pub static NEAREST: Nearest = Nearest;

/// See [`NEAREST`].
pub struct Nearest;

impl Upscaler for Nearest {
    fn id(&self) -> &'static str {
        "nearest"
    }

    fn name(&self) -> &'static str {
        "Nearest"
    }

    fn help(&self) -> &'static str {
        "Repeats each sample over its block. The cheapest, and good for finding out what was drawn: invents no colour. \
         Edges turn into stairs as large as the block; anchored at the corner, the picture moves right and down by \
         (scale − 1)/2 px, too. One of the four methods of the source article, which leaves the last blocks unfilled; \
         here the picture is whole."
    }

    fn offers(&self) -> Offers {
        Offers { scales: SCALES, anchors: Anchor::ALL, lights: &[Light::Bytes], deringing: false, sharpening: false }
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &Drawn<'_>, full: &mut Image<Rgba8>) {
        let (width, height) = full.size();
        let lattice = how.lattice();
        let sources: Vec<_> = (0..width).map(|x| source(lattice, x, drawn.color.width())).collect();
        let rows_of = |y: u32| source(lattice, y, drawn.color.height());
        // Rows of one block are copies of its first.
        let (pixels, _) = lattice.scale.ratio();
        let rows = ROWS_PER_BAND.next_multiple_of(pixels);
        let bands = full.pixels_mut().par_chunks_mut((width * rows).max(1) as usize);
        bands.zip((0..height).into_par_iter().step_by(rows as usize)).for_each(|(band, first)| {
            let mut filled: &mut [Rgba8] = &mut [];
            for (row, y) in band.chunks_exact_mut(width as usize).zip(first..) {
                if y > first && rows_of(y) == rows_of(y - 1) {
                    row.copy_from_slice(filled);
                } else {
                    widen(drawn.color.row(rows_of(y)), lattice, &sources, row);
                }
                filled = row;
            }
        });
    }

    fn pixel(&self, how: Upscaling, drawn: &Drawn<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Rgba8 {
        let (columns, rows) = drawn.color.size();
        drawn.color.at(source(how.lattice(), x, columns), source(how.lattice(), y, rows))
    }

    fn taps(&self, how: Upscaling, drawn: &Drawn<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Vec<Tap> {
        let (columns, rows) = drawn.color.size();
        let (x, y) = how.grid().pixel(source(how.lattice(), x, columns), source(how.lattice(), y, rows));
        vec![Tap { x, y, weight: 1.0 }]
    }
}

/// Rows that are filled in at a time.
const ROWS_PER_BAND: u32 = 64;

/// The sample that output pixel `at` copies: anchored at the corner the last one at or before it, as published, else the
/// nearest; of `samples`.
fn source(lattice: Lattice, at: u32, samples: u32) -> u32 {
    match lattice.anchor {
        Anchor::Corner => (lattice.place(at).cell as u32).min(samples.saturating_sub(1)),
        Anchor::Centre => lattice.nearest(at, samples),
    }
}

/// Fills a row; each scale in a loop of its own, as a loop over pixels of blocks of any size is several times slower.
fn widen(samples: &[Rgba8], lattice: Lattice, sources: &[u32], row: &mut [Rgba8]) {
    match lattice.scale.whole() {
        Some(2) => repeat::<2>(samples, row),
        Some(3) => repeat::<3>(samples, row),
        Some(4) => repeat::<4>(samples, row),
        _ => {
            for (pixel, source) in row.iter_mut().zip(sources) {
                *pixel = samples[*source as usize];
            }
        }
    }
}

fn repeat<const N: usize>(samples: &[Rgba8], row: &mut [Rgba8]) {
    let (blocks, rest) = row.as_chunks_mut::<N>();
    let whole = blocks.len();
    for (block, sample) in blocks.iter_mut().zip(samples) {
        *block = [*sample; N];
    }
    rest.fill(samples[whole.min(samples.len() - 1)]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::Scale;

    #[test]
    fn a_block_is_its_sample_and_the_last_one_is_cut() {
        let drawn = Image::from_pixels(2, 1, vec![[1; 4], [2; 4]]);
        for (scale, columns) in [(2_u32, [1, 1, 2]), (3, [1, 1, 1])] {
            let how = Upscaling::new("nearest", Scale::from(scale)).unwrap();
            let full = how.upscale(&Drawn::from(&drawn), 3, 1);
            assert_eq!(full.row(0), columns.map(|code| [code; 4]));
        }
    }
}
