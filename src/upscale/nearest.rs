//! Each drawn pixel fills its block.

use rayon::prelude::*;

use super::kernel::SCALES;
use super::{Tap, Upscaler};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

/// Each drawn pixel fills its block.
pub const NEAREST: Nearest = Nearest;

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
        "Draws the top-left pixel of each block and repeats it over the block. The cheapest, and good for finding out \
         what was drawn: invents no colour. Edges turn into stairs as large as the block, and as the drawn pixel is \
         the block's corner, not its centre, the picture moves right and down by (scale − 1)/2 px. One of the four \
         methods of the source article, which leaves the last blocks unfilled; here the picture is whole."
    }

    fn scales(&self) -> &'static [u32] {
        SCALES
    }

    fn grid(&self, scale: u32) -> SampleGrid {
        SampleGrid::Block { step: scale }
    }

    fn upscale(&self, drawn: &Image<Rgba8>, scale: u32, width: u32, height: u32) -> Image<Rgba8> {
        let mut full = Image::filled(width, height, [0; 4]);
        let (width, scale) = (width as usize, scale as usize);
        let blocks = full.pixels_mut().par_chunks_mut((width * scale).max(1));
        blocks.enumerate().for_each(|(row, block)| fill_blocks(drawn.row(row as u32), scale, width, block));
        full
    }

    fn taps(&self, x: u32, y: u32, scale: u32, _width: u32, _height: u32) -> Vec<Tap> {
        vec![Tap { x: x - x % scale, y: y - y % scale, weight: 1.0 }]
    }
}

/// Fills a row of blocks: its first row of pixels from the samples, the others from the first.
fn fill_blocks(samples: &[Rgba8], scale: usize, width: usize, blocks: &mut [Rgba8]) {
    let (first, rest) = blocks.split_at_mut(width);
    for (pixels, sample) in first.chunks_mut(scale).zip(samples) {
        pixels.fill(*sample);
    }
    for row in rest.chunks_exact_mut(width) {
        row.copy_from_slice(first);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawn_pixel_fills_its_block_and_no_more() {
        let drawn = Image::from_fn(3, 2, |x, y| [x as u8, y as u8, 7, 255]);
        for (width, height) in [(9, 5), (12, 8)] {
            let full = NEAREST.upscale(&drawn, 4, width, height);
            assert_eq!(full, Image::from_fn(width, height, |x, y| drawn.at(x / 4, y / 4)));
        }
    }
}
