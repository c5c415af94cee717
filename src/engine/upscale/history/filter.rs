//! Reading of the history with filters of 4 × 4 pixels.
//!
//! Adjacent pixels mostly read adjacent history pixels. Four of them are then filtered together: a vector holds the same tap
//! of all four, so no horizontal sum is needed.

use super::window::PastPlaces;
use crate::image::Image;
use crate::math::lanes::*;
use crate::upscale::quads::Quad;

/// Number of pixels that are filtered together.
const TOGETHER: usize = 4;

/// Weights of a separable filter of 4 × 4 pixels at sixteen positions. The position lies between the second and the third
/// pixel of each axis.
pub(in crate::upscale) struct FilterWeights<S: Simd> {
    pub(in crate::upscale) across: [f32x16<S>; 4],
    pub(in crate::upscale) down: [f32x16<S>; 4],
}

impl<S: Simd> FilterWeights<S> {
    /// Returns the weights at four positions from lane `first` on, with each of them four times in a row.
    #[inline(always)]
    fn repeated(&self, simd: S, first: usize) -> Self {
        let order = u8x64::load_array_ref(simd, &ORDERS[first / TOGETHER]);
        Self {
            across: each!(i in [0, 1, 2, 3] => self.across[i].swizzle_dyn(order)),
            down: each!(i in [0, 1, 2, 3] => self.down[i].swizzle_dyn(order)),
        }
    }
}

/// Byte indices that repeat each of four numbers four times, for every group of four among sixteen numbers.
const ORDERS: [[u8; 64]; WIDE / TOGETHER] = {
    let mut orders = [[0; 64]; WIDE / TOGETHER];
    let mut place = 0;
    while place < 64 * WIDE / TOGETHER {
        let (group, byte) = (place / 64, place % 64);
        let number = group * TOGETHER + byte / (4 * TOGETHER);
        orders[group][byte] = (4 * number + byte % 4) as u8;
        place += 1;
    }
    orders
};

impl<S: Simd> PastPlaces<S> {
    /// Reads the history at all known positions with a filter, first along the columns. With `IS_CLAMPED`, the results are
    /// clamped to the range of the nearest 2 × 2 pixels. The other positions keep their numbers.
    #[inline(always)]
    pub(in crate::upscale) fn read_filtered<const IS_CLAMPED: bool>(
        &self,
        simd: S,
        history: &Image<Quad>,
        weights: &FilterWeights<S>,
        read: &mut [Quad; WIDE],
    ) {
        let adjacent = self.adjacent_fours();
        let (mut across, mut down) = ([[0.0; WIDE]; 4], [[0.0; WIDE]; 4]);
        if adjacent != [true; WIDE / TOGETHER] {
            across = each!(i in [0, 1, 2, 3] => weights.across[i].to_array());
            down = each!(i in [0, 1, 2, 3] => weights.down[i].to_array());
        }
        let groups = (0..).step_by(TOGETHER).zip(read.as_chunks_mut::<TOGETHER>().0);
        for ((first, read), is_adjacent) in groups.zip(adjacent) {
            if is_adjacent {
                let weights = weights.repeated(simd, first);
                let filtered = self.four_filtered::<IS_CLAMPED>(simd, history, &weights, first);
                filtered.store_slice(read.as_flattened_mut());
                continue;
            }
            for (lane, read) in (first..).zip(read) {
                let across = each!(i in [0, 1, 2, 3] => across[i][lane]);
                let down = each!(i in [0, 1, 2, 3] => down[i][lane]);
                if let Some(filtered) = self.one_filtered::<IS_CLAMPED>(simd, history, [across, down], lane) {
                    filtered.store_array(read);
                }
            }
        }
    }

    /// Filters the history at one position. Returns `None` if the position is not known.
    #[inline(always)]
    fn one_filtered<const IS_CLAMPED: bool>(
        &self,
        simd: S,
        history: &Image<Quad>,
        [across, down]: [[f32; 4]; 2],
        lane: usize,
    ) -> Option<f32x4<S>> {
        let rows @ [first, second, third, fourth] = self.window(simd, history, lane)?;
        let column = first * down[0] + second * down[1] + third * down[2] + fourth * down[3];
        let [a, b, c, d] = each!(i in [0, 1, 2, 3] => f32x4::splat(simd, across[i]));
        let (even, odd) = (column * a.combine(b).combine(c.combine(d))).split();
        let (even, odd) = (even + odd).split();
        let sum = even + odd;
        if !IS_CLAMPED {
            return Some(sum);
        }
        let (least, greatest) = (inner_pair(rows[1].min(rows[2])), inner_pair(rows[1].max(rows[2])));
        Some(sum.max(least[0].min(least[1])).min(greatest[0].max(greatest[1])))
    }

    /// Filters the history at four positions from lane `lane` on, which come from adjacent pixels inside the image.
    #[inline(always)]
    fn four_filtered<const IS_CLAMPED: bool>(
        &self,
        simd: S,
        history: &Image<Quad>,
        weights: &FilterWeights<S>,
        lane: usize,
    ) -> f32x16<S> {
        let FilterWeights { across, down } = weights;
        let width = history.width() as usize;
        let first = self.first_inside(lane, width);
        let pixels = &history.pixels()[first..][..3 * width + 3 + TOGETHER];
        let tap = |row: usize, column: usize| {
            f32x16::from_slice(simd, pixels[row * width + column..][..TOGETHER].as_flattened())
        };
        let [a, b, c, d] = each!(column in [0, 1, 2, 3] => {
            let sum = tap(0, column) * down[0] + tap(1, column) * down[1] + tap(2, column) * down[2]
                + tap(3, column) * down[3];
            sum * across[column]
        });
        let sum = (a + c) + (b + d);
        if !IS_CLAMPED {
            return sum;
        }
        let [least, other_least] = each!(column in [1, 2] => tap(1, column).min(tap(2, column)));
        let [greatest, other_greatest] = each!(column in [1, 2] => tap(1, column).max(tap(2, column)));
        sum.max(least.min(other_least)).min(greatest.max(other_greatest))
    }
}

/// Returns the second and the third of four quads.
#[inline(always)]
fn inner_pair<S: Simd>(quads: f32x16<S>) -> [f32x4<S>; 2] {
    let (low, high) = quads.split();
    [low.split().1, high.split().0]
}
