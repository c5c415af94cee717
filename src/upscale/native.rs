//! No upscaling: every pixel is drawn.

use super::{Tap, Upscaler};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

/// Every pixel is drawn; the reference that the others are compared with.
pub const NATIVE: Native = Native;

/// See [`NATIVE`].
pub struct Native;

impl Upscaler for Native {
    fn id(&self) -> &'static str {
        "native"
    }

    fn name(&self) -> &'static str {
        "Native"
    }

    fn help(&self) -> &'static str {
        "Every pixel is drawn. Nothing is saved, nothing is guessed: what the other methods are compared with."
    }

    fn scales(&self) -> &'static [u32] {
        &[1]
    }

    fn grid(&self, _scale: u32) -> SampleGrid {
        SampleGrid::FULL
    }

    fn upscale(&self, drawn: &Image<Rgba8>, _scale: u32, _width: u32, _height: u32) -> Image<Rgba8> {
        drawn.clone()
    }

    fn taps(&self, x: u32, y: u32, _scale: u32, _width: u32, _height: u32) -> Vec<Tap> {
        vec![Tap { x, y, weight: 1.0 }]
    }
}
