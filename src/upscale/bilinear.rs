//! Straight lines between the drawn pixels, along rows and then along columns.
//!
//! The four weights at (s, t) between four drawn pixels are (1−s)(1−t), s(1−t), (1−s)t and st.

use super::kernel::{Kernel, SCALES};
use super::{Tap, Upscaler};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

/// Straight lines between drawn pixels.
pub const BILINEAR: Bilinear = Bilinear;

/// See [`BILINEAR`].
pub struct Bilinear;

/// In quarters.
const KERNEL: Kernel<2, 2> = Kernel { quarters: [[4, 0], [3, 1], [2, 2], [1, 3]] };

impl Upscaler for Bilinear {
    fn id(&self) -> &'static str {
        "bilinear"
    }

    fn name(&self) -> &'static str {
        "Bilinear"
    }

    fn help(&self) -> &'static str {
        "Draws the top-left pixel of each block and joins drawn pixels by straight lines, along rows and then columns. \
         Good on smooth shading: never leaves the range of its neighbours, so it cannot ring. Blurs texture, and bends \
         at every drawn pixel show as a lattice of faint crosses. One of the four methods of the source article, which \
         truncates and leaves the border unfilled; here it is rounded and whole."
    }

    fn scales(&self) -> &'static [u32] {
        SCALES
    }

    fn grid(&self, scale: u32) -> SampleGrid {
        SampleGrid::Block { step: scale }
    }

    fn upscale(&self, drawn: &Image<Rgba8>, scale: u32, width: u32, height: u32) -> Image<Rgba8> {
        KERNEL.upscale(drawn, scale, width, height)
    }

    fn taps(&self, x: u32, y: u32, scale: u32, width: u32, height: u32) -> Vec<Tap> {
        KERNEL.taps(x, y, scale, width, height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rising_ramp_never_falls() {
        for scale in SCALES {
            let drawn = Image::from_fn(9, 9, |x, y| [(x * 11 + y * 13) as u8, (x * x) as u8, (y * y) as u8, 255]);
            let size = 9 * scale;
            let full = BILINEAR.upscale(&drawn, *scale, size, size);
            for y in 0..size {
                for x in 0..size {
                    for (nx, ny) in [(x + 1, y), (x, y + 1)] {
                        if let Some(next) = full.get(nx, ny) {
                            let here = full.at(x, y);
                            assert!((0..4).all(|c| here[c] <= next[c]), "×{scale} ({x}, {y}) {here:?} > {next:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn halves_round_up() {
        let drawn = Image::from_pixels(2, 1, vec![[0, 10, 254, 255], [1, 13, 255, 255]]);
        let full = BILINEAR.upscale(&drawn, 2, 3, 1);
        assert_eq!(full.pixels(), [[0, 10, 254, 255], [1, 12, 255, 255], [1, 13, 255, 255]]);
    }

    #[test]
    fn the_middle_of_four_pixels_has_a_quarter_of_each() {
        let taps = BILINEAR.taps(2, 2, 4, 8, 8);
        assert_eq!(taps.iter().map(|t| (t.x, t.y)).collect::<Vec<_>>(), [(0, 0), (4, 0), (0, 4), (4, 4)]);
        assert!(taps.iter().all(|t| t.weight == 0.25));
    }
}
