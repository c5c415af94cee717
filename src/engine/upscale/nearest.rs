//! Nearest-neighbour upscaling: each sample fills its block.

use fearless_simd::Level;

use super::bands;
#[cfg(target_arch = "x86_64")]
use super::lanes::pixels_to_alignment;
use super::lattice::{Lattice, LatticePosition};
#[cfg(target_arch = "x86_64")]
use super::nearest_avx2::NearestAvx2;
use super::separable::SCALES;
use super::{Anchor, FilterSpace, Offers, Sampling, Tap, UpscaleInputs, Upscaler, Upscaling};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::Choice as _;

/// Nearest-neighbour upscaling.
pub(crate) static NEAREST: Nearest = Nearest;

/// [`Upscaler`] implementation of [`NEAREST`].
pub(crate) struct Nearest;

impl Upscaler for Nearest {
    fn id(&self) -> &'static str {
        "nearest"
    }

    fn name(&self) -> &'static str {
        "Nearest"
    }

    fn help(&self) -> &'static str {
        "Repeats each sample over its block. Good for seeing what was drawn: invents no colour. Edges turn into stairs \
         as large as the block. Anchored at the corner, the picture moves right and down: by ½ px at ×1.5 and ×2, 1 px \
         at ×3, 1½ px at ×4. Blocks cut off by the border are filled in, too."
    }

    fn artefacts(&self) -> &'static str {
        "stairs as large as a block"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: SCALES,
            anchors: Anchor::ALL,
            lights: &[FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: false,
        }
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        fill(Level::new(), how.lattice(), drawn.color, full);
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Rgba8 {
        let (columns, rows) = drawn.color.size();
        let [column, row] = [(x, columns), (y, rows)].map(|(at, samples)| of_pixel(how.lattice(), at, samples));
        drawn.color.at(column, row)
    }

    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Vec<Tap> {
        let (columns, rows) = drawn.color.size();
        let [column, row] = [(x, columns), (y, rows)].map(|(at, samples)| of_pixel(how.lattice(), at, samples));
        let (x, y) = how.grid().pixel(column, row);
        vec![Tap { x, y, weight: 1.0 }]
    }
}

/// Returns the index of the sample that an output pixel copies, which is less than `samples`. With the corner anchor,
/// this is the last sample at or before the pixel; otherwise, it is the nearest sample.
fn source(lattice: Lattice, place: LatticePosition, samples: u32) -> u32 {
    match lattice.anchor {
        Anchor::Corner => (place.cell as u32).min(samples.saturating_sub(1)),
        Anchor::Centre => lattice.nearest_to(place, samples),
    }
}

fn of_pixel(lattice: Lattice, at: u32, samples: u32) -> u32 {
    source(lattice, lattice.place(at), samples)
}

/// Returns the indices of the samples that pixel `first` and all pixels after it copy.
fn sources(lattice: Lattice, first: u32, samples: u32) -> impl Iterator<Item = u32> {
    lattice.places_from(first).map(move |place| source(lattice, place, samples))
}

/// Upscales samples into an image. `level` selects the instruction set, which does not affect the result.
fn fill(level: Level, lattice: Lattice, drawn: &Image<Rgba8>, full: &mut Image<Rgba8>) {
    let columns: Vec<_> = sources(lattice, 0, drawn.width()).take(full.width() as usize).collect();
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = level.as_avx2() {
        let (samples, to_alignment) = (drawn.width() as usize, pixels_to_alignment(full.pixels()));
        let nearest = NearestAvx2::new(avx2, &columns, samples, to_alignment);
        return fill_by(|samples, rows| nearest.fill(samples, rows), lattice, drawn, full);
    }
    fill_by(|samples, rows| widen(samples, &columns, rows), lattice, drawn, full);
}

/// Calls `widen` once for each row of samples, with all pixel rows that copy it.
fn fill_by(
    widen: impl Fn(&[Rgba8], &mut [Rgba8]) + Sync,
    lattice: Lattice,
    drawn: &Image<Rgba8>,
    full: &mut Image<Rgba8>,
) {
    let width = full.width() as usize;
    bands::fill(full, lattice.scale, |first, count, mut band| {
        let rows: Vec<_> = sources(lattice, first, drawn.height()).take(count).collect();
        for same in rows.chunk_by(|a, b| a == b) {
            let (own, rest) = band.split_at_mut(same.len() * width);
            widen(drawn.row(same[0]), own);
            band = rest;
        }
    });
}

/// Fills identical pixel rows from one row of samples; `columns` holds the sample index of each pixel.
fn widen(samples: &[Rgba8], columns: &[u32], rows: &mut [Rgba8]) {
    let (widened, copies) = rows.split_at_mut(columns.len());
    for (pixel, column) in widened.iter_mut().zip(columns) {
        *pixel = samples[*column as usize];
    }
    copies.chunks_exact_mut(columns.len()).for_each(|row| row.copy_from_slice(widened));
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
            let full = how.upscale(&UpscaleInputs::from(&drawn), 3, 1);
            assert_eq!(full.row(0), columns.map(|code| [code; 4]));
        }
    }

    #[test]
    fn wide_lanes_and_plain_code_copy_the_same_samples() {
        for lattice in crate::upscale::lattice::tests::every() {
            for (width, height) in [(1, 1), (7, 5), (8, 3), (33, 18), (100, 13), (131, 97)] {
                let drawn =
                    Image::from_fn(lattice.samples(width), lattice.samples(height), |x, y| [x as u8, y as u8, 3, 4]);
                let [mut wide, mut plain] = [1, 2].map(|code| Image::filled(width, height, [code; 4]));
                fill(Level::new(), lattice, &drawn, &mut wide);
                fill(Level::fallback(), lattice, &drawn, &mut plain);
                assert_eq!(wide, plain, "{lattice:?} {width} × {height}");
            }
        }
    }
}
