//! Planar rows of samples: one buffer per number, and padded, so that sample `i` is at index `i + PAD`.

use std::ops::Range;

use super::quads::window;
use crate::math::lanes::*;

/// Number of copies of the first sample of a row before it, and of the last one after it.
pub(super) const PAD: usize = 2;

/// Decoded samples of a row: Y, Co, Cg, and alpha as an 8-bit value.
pub(super) type Planes = [Vec<f32>; 4];

/// Returns a buffer for a number of every sample of a padded row. A vector can be loaded from every index.
pub(super) fn padded_row(samples: u32) -> Vec<f32> {
    vec![0.0; samples as usize + 2 * PAD + WIDE]
}

/// Combination of three numbers with the same index in three runs.
#[derive(Clone, Copy, Debug)]
pub(super) enum Combination {
    /// Sum with these weights.
    Weighted([f32; 3]),
    Sum,
    SumOfSquares,
    Least,
    Greatest,
}

/// Combines the numbers of three runs, and stores the results in a range of `to`. Reads and writes up to 15 more numbers
/// after it.
#[inline(always)]
pub(super) fn combine<S: Simd>(simd: S, runs: [&[f32]; 3], to: &mut [f32], range: &Range<usize>, by: Combination) {
    let length = range.len().next_multiple_of(WIDE);
    let to = &mut to[range.start..range.start + length];
    // One loop for each, with a closure that is compiled for the instruction set.
    macro_rules! stored {
        (|$a:ident, $b:ident, $c:ident| $result:expr) => {
            combine_by(
                simd,
                runs,
                to,
                #[inline(always)]
                |$a, $b, $c| $result,
            )
        };
    }
    match by {
        Combination::Weighted([u, v, w]) => stored!(|a, b, c| a * u + b * v + c * w),
        Combination::Sum => stored!(|a, b, c| a + b + c),
        Combination::SumOfSquares => stored!(|a, b, c| a * a + b * b + c * c),
        Combination::Least => stored!(|a, b, c| a.min(b).min(c)),
        Combination::Greatest => stored!(|a, b, c| a.max(b).max(c)),
    }
}

#[inline(always)]
fn combine_by<S: Simd>(
    simd: S,
    runs: [&[f32]; 3],
    to: &mut [f32],
    of: impl Fn(f32x16<S>, f32x16<S>, f32x16<S>) -> f32x16<S>,
) {
    let [first, second, third] = each!(i in [0, 1, 2] => runs[i][..to.len()].as_chunks::<WIDE>().0);
    let to = to.as_chunks_mut::<WIDE>().0;
    for (to, ((first, second), third)) in to.iter_mut().zip(first.iter().zip(second).zip(third)) {
        let [first, second, third] = each!(numbers in [first, second, third] => f32x16::load_array_ref(simd, numbers));
        of(first, second, third).store_array(to);
    }
}

/// Samples of a row, one for each of sixteen output pixels.
#[derive(Clone, Copy)]
pub(super) enum SampleLanes<S: Simd> {
    /// Adjacent samples; the first has this padded index.
    Adjacent(usize),
    /// Samples among the sixteen from a padded index on, selected by byte indices.
    Among(usize, u8x64<S>),
}

impl<S: Simd> SampleLanes<S> {
    /// Returns the samples at padded indices, in ascending order and within 16 of the first one.
    #[inline(always)]
    pub(super) fn ascending(simd: S, padded: &[u32; WIDE]) -> Self {
        /// Copies four times the number of a lane into each of four bytes.
        const BYTES: u32 = 0x0404_0404;
        /// Offsets of the four bytes of a number.
        const PLACES: u32 = 0x0302_0100;
        let first = padded[0];
        let order = (u32x16::load_array_ref(simd, padded) - first) * BYTES + PLACES;
        Self::Among(first as usize, order.bitcast())
    }

    /// Reads a number of the samples.
    #[inline(always)]
    pub(super) fn read(&self, simd: S, row: &[f32]) -> f32x16<S> {
        self.read_beside(simd, row, 1)
    }

    /// Reads a number of the samples before these, of these, or of those after them, for `by` of 0, 1 or 2.
    #[inline(always)]
    pub(super) fn read_beside(&self, simd: S, row: &[f32], by: usize) -> f32x16<S> {
        let (Self::Adjacent(first) | Self::Among(first, _)) = self;
        let sixteen = f32x16::load_array_ref(simd, window(row, first + by - 1));
        match self {
            Self::Adjacent(_) => sixteen,
            Self::Among(_, order) => sixteen.swizzle_dyn(*order),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_read_in_ascending_order_with_repetitions() {
        let mut random = fastrand::Rng::with_seed(6);
        let row: Vec<f32> = (0..60).map(|_| random.f32()).collect();
        for _ in 0..100 {
            let mut padded = [random.u32(1..20); WIDE];
            for lane in 1..WIDE {
                padded[lane] = (padded[lane - 1] + random.u32(0..2)).min(padded[0] + 15);
            }
            for by in 0..3 {
                let expected = padded.map(|index| row[index as usize + by - 1]);
                for lanes in Lanes::all() {
                    let read = on_lanes!(lanes, simd => {
                        SampleLanes::ascending(simd, &padded).read_beside(simd, &row, by).to_array()
                    });
                    assert_eq!(read, expected, "{} {padded:?}", lanes.name());
                }
            }
        }
    }
}
