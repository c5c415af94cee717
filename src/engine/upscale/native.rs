//! Native rendering without upscaling.

use super::{Anchor, FilterSpace, Offers, Sampling, Scale, Tap, UpscaleInputs, Upscaler, Upscaling};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

/// Native rendering: every pixel is drawn. Baseline for all other upscalers.
pub(crate) static NATIVE: Native = Native;

/// [`Upscaler`] implementation of [`NATIVE`].
pub(crate) struct Native;

impl Upscaler for Native {
    fn id(&self) -> &'static str {
        "native"
    }

    fn name(&self) -> &'static str {
        "Native"
    }

    fn help(&self) -> &'static str {
        "Draws every pixel and reconstructs none: the baseline for the other methods."
    }

    fn artefacts(&self) -> &'static str {
        "none: the baseline of the other methods"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: &[Scale::ONE],
            anchors: &[Anchor::Corner],
            lights: &[FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: false,
        }
    }

    fn sampling(&self, _how: Upscaling) -> Sampling {
        Sampling::Grid(SampleGrid::FULL)
    }

    fn upscale(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        full.pixels_mut().copy_from_slice(drawn.color.pixels());
    }

    fn pixel(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Rgba8 {
        drawn.color.at(x, y)
    }

    fn taps(&self, _how: Upscaling, _drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Vec<Tap> {
        vec![Tap { x, y, weight: 1.0 }]
    }
}
