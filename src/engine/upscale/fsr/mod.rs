//! FidelityFX Super Resolution 1: an upscaling filter oriented along edges ([`easu`]), and sharpening ([`rcas`]).
//!
//! The implementation follows the equations of AMD's publication (FSR 1.0, 2021). Both passes filter sRGB-encoded
//! values, as the publication requires. FSR 1 is intended for images that are already anti-aliased, and for scales of
//! up to 2.

mod easu;
mod rcas;
mod words;

use std::cell::RefCell;
use std::collections::BTreeMap;

use easu::EasuFrame;
use rcas::Sharpening;

use super::choice::MAX_SHARPENING;
use super::{Anchor, FilterSpace, Offers, Sampling, Scale, Tap, UpscaleInputs, Upscaler, Upscaling, bands};
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;

/// Scales of the publication's quality modes.
pub(super) const SCALES: &[Scale] =
    &[Scale::ONE_AND_THREE_TENTHS, Scale::ONE_AND_A_HALF, Scale::ONE_AND_SEVEN_TENTHS, Scale::TWO];

/// Edge-adaptive upscaling with optional sharpening.
pub(crate) static FSR1: Fsr1 = Fsr1;

/// [`Upscaler`] implementation of [`FSR1`].
pub(crate) struct Fsr1;

/// Offsets of a pixel and its four neighbours, in the order of [`rcas::pixel`].
const CROSS: [(i64, i64); 5] = [(0, -1), (-1, 0), (0, 0), (1, 0), (0, 1)];

/// Returns the sharpening strength in [0, 1].
fn strength(how: Upscaling) -> f32 {
    how.sharpening() as f32 / MAX_SHARPENING as f32
}

/// Returns the pixels of the cross around `at`, clamped to an image of `size` px.
fn cross((width, height): (u32, u32), (x, y): (u32, u32)) -> [(u32, u32); 5] {
    let clamped = |at: i64, length: u32| at.clamp(0, i64::from(length) - 1) as u32;
    CROSS.map(|(dx, dy)| (clamped(i64::from(x) + dx, width), clamped(i64::from(y) + dy, height)))
}

/// Sharpens pixel `at` of an image of `size` px if `how` has sharpening. `plain` computes pixels without sharpening.
pub(super) fn sharpened_pixel(
    how: Upscaling,
    size: (u32, u32),
    at: (u32, u32),
    plain: impl Fn((u32, u32)) -> Rgba8,
) -> Rgba8 {
    if how.sharpening() == 0 { plain(at) } else { rcas::pixel(cross(size, at).map(plain), strength(how)) }
}

/// Returns the pixels without sharpening that pixel `at` is computed from, and their shares, which sum to 1; otherwise
/// like [`sharpened_pixel`].
pub(super) fn sharpening_shares(
    how: Upscaling,
    size: (u32, u32),
    at: (u32, u32),
    plain: impl Fn((u32, u32)) -> Rgba8,
) -> Vec<((u32, u32), f32)> {
    if how.sharpening() == 0 {
        return vec![(at, 1.0)];
    }
    let cross = cross(size, at);
    cross.into_iter().zip(rcas::shares(cross.map(plain), strength(how))).collect()
}

/// Sharpens an image if `how` has sharpening; bit-identical to [`sharpened_pixel`].
pub(super) fn sharpen(how: Upscaling, full: &mut Image<Rgba8>) {
    if how.sharpening() == 0 {
        return;
    }
    let (width, height) = (full.width() as usize, full.height() as usize);
    let plain = full.clone();
    let sharpening = Sharpening { lanes: Lanes::best(), strength: strength(how) };
    bands::fill(full, Scale::ONE, |first, count, rows| {
        let first = first as usize;
        let (above, below) = (usize::from(first > 0), usize::from(first + count < height));
        let plain = &plain.pixels()[(first - above) * width..(first + count + below) * width];
        sharpening.fill(plain, width, above, rows);
    });
}

impl Upscaler for Fsr1 {
    fn id(&self) -> &'static str {
        "fsr1"
    }

    fn name(&self) -> &'static str {
        "FSR 1"
    }

    fn help(&self) -> &'static str {
        "Weights twelve samples by a kernel stretched along the local edge, clamps the result to the range of the four \
         nearest, and optionally sharpens. Good on slanted edges. Stairs in the drawn picture are taken for edges and \
         kept; fine texture may turn into strokes. Source: AMD FidelityFX Super Resolution 1.0, EASU and RCAS (2021)."
    }

    fn artefacts(&self) -> &'static str {
        "stairs in the drawn picture are taken for edges"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: SCALES,
            anchors: &[Anchor::Centre, Anchor::Corner],
            lights: &[FilterSpace::Bytes],
            deringing: false,
            sharpening: true,
            history: false,
        }
    }

    fn alters_samples(&self) -> bool {
        true
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        fill(Lanes::best(), how, drawn.color, full);
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        sharpened_pixel(how, size, at, |at| easu::pixel(drawn.color, how.lattice(), at))
    }

    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let enlarged = |at| easu::pixel(drawn.color, how.lattice(), at);
        let mut sums: BTreeMap<(u32, u32), f32> = BTreeMap::new();
        for (at, share) in sharpening_shares(how, size, at, enlarged) {
            for (row, column, weight) in easu::taps(drawn.color, how.lattice(), at) {
                *sums.entry((row, column)).or_default() += share * weight;
            }
        }
        let grid = how.grid();
        let tap = |((row, column), weight)| {
            let (x, y) = grid.pixel(column, row);
            Tap { x, y, weight }
        };
        sums.into_iter().map(tap).collect()
    }
}

/// Number of rows processed at a time: their per-sample data and the rows before sharpening stay in the L2 cache.
const STRIP: usize = 32;

/// Scratch buffers for a strip of rows.
#[derive(Default)]
struct StripScratch {
    easu: easu::EasuScratch,
    /// Upscaled rows before sharpening.
    enlarged: Vec<Rgba8>,
}

thread_local! {
    /// Scratch buffers reused between images: allocating them each time takes a tenth of the time of all other work.
    static SCRATCH: RefCell<StripScratch> = RefCell::default();
}

fn fill(lanes: Lanes, how: Upscaling, drawn: &Image<Rgba8>, full: &mut Image<Rgba8>) {
    let (width, height) = (full.width() as usize, full.height() as usize);
    let easu = EasuFrame { drawn, phases: easu::phases(lanes, how.lattice()), width };
    let sharpening = (how.sharpening() > 0).then(|| Sharpening { lanes, strength: strength(how) });
    let job = FillJob { easu, sharpening, height };
    bands::fill(full, Scale::ONE, |band, _, pixels| {
        SCRATCH.with_borrow_mut(|scratch| job.fill_band(band as usize, pixels, scratch));
    });
}

/// Inputs of an image to fill, shared by its bands.
struct FillJob<'a> {
    easu: EasuFrame<'a>,
    /// `None` if the image is not sharpened.
    sharpening: Option<Sharpening>,
    /// Height of the image, in pixels.
    height: usize,
}

impl FillJob<'_> {
    /// Fills the rows of a band, strip by strip. The first of them is row `band` of the image.
    fn fill_band(&self, band: usize, pixels: &mut [Rgba8], scratch: &mut StripScratch) {
        let Self { easu, sharpening, height } = self;
        let StripScratch { easu: scratch, enlarged } = scratch;
        let width = easu.width;
        let Some(sharpening) = sharpening else {
            for (strip, rows) in pixels.chunks_mut(STRIP * width).enumerate() {
                easu.fill((band + strip * STRIP) as u32, rows, scratch);
            }
            return;
        };
        if enlarged.len() < (STRIP + 2) * width {
            enlarged.resize((STRIP + 2) * width, [0; 4]);
        }
        let mut made = 0;
        for (strip, rows) in pixels.chunks_mut(STRIP * width).enumerate() {
            let (first, count) = (band + strip * STRIP, rows.len() / width);
            // Sharpening also reads the row above and the row below each row. The previous strip has already computed
            // two of the rows needed here.
            let (above, below) = (usize::from(first > 0), usize::from(first + count < *height));
            let known = if strip == 0 { 0 } else { above + 1 };
            enlarged.copy_within((made - known) * width..made * width, 0);
            made = above + count + below;
            easu.fill((first - above + known) as u32, &mut enlarged[known * width..made * width], scratch);
            sharpening.fill(&enlarged[..made * width], width, above, rows);
        }
    }
}

#[cfg(test)]
mod tests;
