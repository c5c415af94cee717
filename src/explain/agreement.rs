//! Agreement of a drawing with the other renderer's picture.
//!
//! The measure is the negative logarithm of a likelihood: each pixel either agrees, up to rounding noise of one or two
//! codes, or has any colour. So a few wild pixels cannot outweigh many that agree, as they would in a mean square.

use std::ops::Add;
use std::sync::LazyLock;

use rasterscope_engine::image::{Image, Rgba8};

use crate::window::Window;

/// Largest difference, in 8-bit codes of any channel, at which two pixels count as equal.
pub const TOLERANCE: u8 = 2;

/// Rounding of colours to 8-bit codes, as it shows in differences from our codes, which are rounded to nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Rounding {
    /// The nearest code: equal to ours.
    Nearest,
    /// The next lower code: in half of all pixels one less than ours.
    Down,
    /// The next higher code: in half of all pixels one more than ours.
    Up,
}

/// Share of pixels that the model expects to disagree for reasons of no interest, such as rounded vertices at edges.
const OUTLIERS: f64 = 0.03;

/// Probabilities of differences of 0, 1 and 2 codes in pixels that agree.
const AGREEING: [f64; 3] = [0.9, 0.09, 0.01];

/// Factor by which the cost of a disagreeing pixel grows with the logarithm of its difference, so that smaller
/// differences are still better.
const SLOPE: f64 = 0.5;

/// Added cost of a pixel, in nats, if codes are not rounded to nearest: two differences are possible instead of one.
const COST_OF_CHOICE: f64 = 0.2;

/// Difference that a code on the wrong side of a rounded value counts as, in codes.
const WRONG_SIDE: u8 = TOLERANCE + 1;

/// Side of the squares over which pictures are averaged for the coarse measure, in pixels.
const SQUARE_PX: usize = 16;

/// Cost of a pixel with each difference, in nats.
static COST: LazyLock<[f64; 256]> = LazyLock::new(|| {
    std::array::from_fn(|difference| {
        let uniform = OUTLIERS / 256.0;
        match AGREEING.get(difference) {
            Some(share) => -((1.0 - OUTLIERS) * share + uniform).ln(),
            None => -uniform.ln() + SLOPE * (difference as f64 / f64::from(WRONG_SIDE)).ln(),
        }
    })
});

/// Window of the other renderer's picture, prepared for comparisons.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    /// Place of the window in the whole picture.
    pub(crate) window: Window,
    /// Pixels of the window.
    picture: Image<Rgba8>,
    coarse: Vec<[f64; 3]>,
}

/// Agreement of one drawing with the targets.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Agreement {
    /// Negative log-likelihood of the target, in nats; smaller is better.
    pub(crate) cost: f64,
    /// Sum of the absolute differences of squares of pixels, in codes: small if shapes and brightness agree roughly.
    pub(crate) coarse: f64,
    /// Number of pixels that differ by more than [`TOLERANCE`].
    pub(crate) differing: u64,
}

impl Target {
    /// Prepares a window of a picture.
    pub(crate) fn new(picture: &Image<Rgba8>, window: Window) -> Self {
        let picture = window.of(picture);
        Self { window, coarse: coarse(&picture), picture }
    }

    /// Returns the number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.picture.pixels().len()
    }

    /// Compares a drawing of the same window.
    pub(crate) fn agreement(&self, ours: &Image<Rgba8>, rounding: Rounding) -> Agreement {
        let mut counts = [0_u64; 256];
        for (theirs, ours) in self.picture.pixels().iter().zip(ours.pixels()) {
            counts[usize::from(difference(*theirs, *ours, rounding))] += 1;
        }
        let cost: f64 = counts.iter().zip(COST.iter()).map(|(count, cost)| *count as f64 * cost).sum();
        let choice = if rounding == Rounding::Nearest { 0.0 } else { COST_OF_CHOICE * ours.pixels().len() as f64 };
        let squares = coarse(ours);
        let apart: f64 =
            self.coarse.iter().zip(&squares).map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).abs()).sum::<f64>()).sum();
        Agreement { cost: cost + choice, coarse: apart, differing: counts[usize::from(TOLERANCE) + 1..].iter().sum() }
    }
}

impl Add for Agreement {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            cost: self.cost + other.cost,
            coarse: self.coarse + other.coarse,
            differing: self.differing + other.differing,
        }
    }
}

/// Returns the difference of each pixel of two pictures, in codes.
pub(crate) fn differences(theirs: &Image<Rgba8>, ours: &Image<Rgba8>, rounding: Rounding) -> Image<u8> {
    let pairs = theirs.pixels().iter().zip(ours.pixels());
    let codes = pairs.map(|(theirs, ours)| difference(*theirs, *ours, rounding)).collect();
    Image::from_pixels(theirs.width(), theirs.height(), codes)
}

/// Returns the largest difference of the three colour channels, in codes, from what the rounding allows.
pub(crate) fn difference(theirs: Rgba8, ours: Rgba8, rounding: Rounding) -> u8 {
    let of_channel = |channel: usize| {
        let (theirs, ours) = (theirs[channel], ours[channel]);
        let (toward, apart) = match rounding {
            Rounding::Nearest => return theirs.abs_diff(ours),
            Rounding::Down => (theirs <= ours, theirs.abs_diff(ours)),
            Rounding::Up => (theirs >= ours, theirs.abs_diff(ours)),
        };
        if toward { apart.saturating_sub(1) } else { apart.max(WRONG_SIDE) }
    };
    of_channel(0).max(of_channel(1)).max(of_channel(2))
}

/// Returns the mean colours of the squares of a picture, row by row.
fn coarse(picture: &Image<Rgba8>) -> Vec<[f64; 3]> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let columns = width.div_ceil(SQUARE_PX);
    let mut sums = vec![[0_u32; 4]; columns * height.div_ceil(SQUARE_PX)];
    for y in 0..height {
        for (column, run) in picture.row(y as u32).chunks(SQUARE_PX).enumerate() {
            let sum = &mut sums[y / SQUARE_PX * columns + column];
            for [r, g, b, _] in run {
                *sum = [sum[0] + u32::from(*r), sum[1] + u32::from(*g), sum[2] + u32::from(*b), sum[3] + 1];
            }
        }
    }
    sums.iter().map(|sum| [0, 1, 2].map(|channel| f64::from(sum[channel]) / f64::from(sum[3]))).collect()
}
