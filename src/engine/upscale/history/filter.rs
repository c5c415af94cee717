//! Reading of the history with filters of 4 × 4 or 2 × 2 pixels.
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
        Self {
            across: each!(i in [0, 1, 2, 3] => repeated::<4, S>(simd, self.across[i], first)),
            down: each!(i in [0, 1, 2, 3] => repeated::<4, S>(simd, self.down[i], first)),
        }
    }
}

/// Returns the numbers from lane `first` on, with each of them `TIMES` times in a row.
#[inline(always)]
fn repeated<const TIMES: usize, S: Simd>(simd: S, numbers: f32x16<S>, first: usize) -> f32x16<S> {
    let order = u8x64::load_array_ref(simd, const { &repeating(TIMES) });
    numbers.swizzle_dyn(order + (4 * first) as u8)
}

/// Returns the byte indices that repeat each of the first of sixteen numbers.
const fn repeating(times: usize) -> [u8; 64] {
    let mut order = [0; 64];
    let mut place = 0;
    while place < 64 {
        order[place] = (4 * (place / (4 * times)) + place % 4) as u8;
        place += 1;
    }
    order
}

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
        for (group, read) in read.as_chunks_mut::<TOGETHER>().0.iter_mut().enumerate() {
            let first = group * TOGETHER;
            if adjacent[group] {
                let weights = weights.repeated(simd, first);
                let filtered = self.four_filtered::<IS_CLAMPED>(simd, history, &weights, first);
                filtered.store_slice(read.as_flattened_mut());
                continue;
            }
            let across = each!(i in [0, 1, 2, 3] => weights.across[i].to_array());
            let down = each!(i in [0, 1, 2, 3] => weights.down[i].to_array());
            for (number, read) in read.iter_mut().enumerate() {
                let lane = first + number;
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
        let taps = each!(row in [0, 1, 2, 3] => {
            each!(column in [0, 1, 2, 3] => four_from(simd, pixels, row * width + column))
        });
        let [a, b, c, d] = each!(i in [0, 1, 2, 3] => {
            let sum = taps[0][i] * down[0] + taps[1][i] * down[1] + taps[2][i] * down[2] + taps[3][i] * down[3];
            sum * across[i]
        });
        let sum = (a + c) + (b + d);
        if !IS_CLAMPED {
            return sum;
        }
        let [least, other_least] = each!(column in [1, 2] => taps[1][column].min(taps[2][column]));
        let [greatest, other_greatest] = each!(column in [1, 2] => taps[1][column].max(taps[2][column]));
        sum.max(least.min(other_least)).min(greatest.max(other_greatest))
    }
}

impl<S: Simd> PastPlaces<S> {
    /// Reads the history at all known positions bilinearly. The others keep their numbers.
    #[inline(always)]
    pub(in crate::upscale) fn read_bilinear(&self, simd: S, history: &Image<Quad>, read: &mut [Quad; WIDE]) {
        let adjacent = self.adjacent_fours();
        for (group, read) in read.as_chunks_mut::<TOGETHER>().0.iter_mut().enumerate() {
            let first = group * TOGETHER;
            if adjacent[group] {
                self.four_bilinear(simd, history, first).store_slice(read.as_flattened_mut());
                continue;
            }
            let [across, down] = each!(axis in [0, 1] => self.fraction[axis].to_array());
            for (number, read) in read.iter_mut().enumerate() {
                let lane = first + number;
                let Some(rows) = self.four(history, lane) else { continue };
                let [above, below] = each!(row in [0, 1] => {
                    let [left, right] = each!(column in [0, 1] => f32x4::load_array_ref(simd, &rows[row][column]));
                    left + (right - left) * across[lane]
                });
                (above + (below - above) * down[lane]).store_array(read);
            }
        }
    }

    /// Reads the history bilinearly at four positions from lane `lane` on, which come from adjacent pixels inside the
    /// image.
    #[inline(always)]
    fn four_bilinear(&self, simd: S, history: &Image<Quad>, lane: usize) -> f32x16<S> {
        let width = history.width() as usize;
        let first = self.first_inside(lane, width) + width + 1;
        let pixels = &history.pixels()[first..][..width + 1 + TOGETHER];
        let [across, down] = each!(axis in [0, 1] => repeated::<4, S>(simd, self.fraction[axis], lane));
        let [above, below] = each!(row in [0, 1] => {
            let (left, right) = (four_from(simd, pixels, row * width), four_from(simd, pixels, row * width + 1));
            left + (right - left) * across
        });
        above + (below - above) * down
    }

    /// Returns both numbers of pairs at all positions, read bilinearly. They are zero where the position is not known.
    #[inline(always)]
    pub(in crate::upscale) fn pairs_bilinear(&self, simd: S, history: &Image<[f32; 2]>) -> [f32x16<S>; 2] {
        let adjacent = self.adjacent_fours();
        let [low, high] = each!(half in [0, 1] => {
            if adjacent[2 * half] & adjacent[2 * half + 1] {
                self.eight_pairs_bilinear(simd, history, half * LANES)
            } else {
                let mut pairs = [[0.0; 2]; LANES];
                let [across, down] = each!(axis in [0, 1] => self.fraction[axis].to_array());
                for (number, pair) in pairs.iter_mut().enumerate() {
                    let lane = half * LANES + number;
                    let Some([[a, b], [c, d]]) = self.four(history, lane) else { continue };
                    for (i, number) in pair.iter_mut().enumerate() {
                        let (above, below) = (a[i] + (b[i] - a[i]) * across[lane], c[i] + (d[i] - c[i]) * across[lane]);
                        *number = above + (below - above) * down[lane];
                    }
                }
                f32x16::from_slice(simd, pairs.as_flattened())
            }
        });
        let (first, second) = low.deinterleave(high);
        [first, second]
    }

    /// Reads pairs bilinearly at eight positions from lane `lane` on. The first four, and the others, come from adjacent
    /// pixels inside the image.
    #[inline(always)]
    fn eight_pairs_bilinear(&self, simd: S, history: &Image<[f32; 2]>, lane: usize) -> f32x16<S> {
        let width = history.width() as usize;
        let fours = each!(lane in [lane, lane + TOGETHER] => {
            &history.pixels()[self.first_inside(lane, width) + width + 1..][..width + 1 + TOGETHER]
        });
        let [across, down] = each!(axis in [0, 1] => repeated::<2, S>(simd, self.fraction[axis], lane));
        let [above, below] = each!(row in [0, 1] => {
            let (left, right) = (eight_from(simd, fours, row * width), eight_from(simd, fours, row * width + 1));
            left + (right - left) * across
        });
        above + (below - above) * down
    }
}

/// Returns the four pixels from index `at` on.
#[inline(always)]
fn four_from<S: Simd>(simd: S, pixels: &[Quad], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, pixels[at..][..TOGETHER].as_flattened())
}

/// Returns the four pairs from index `at` on of each of two slices.
#[inline(always)]
fn eight_from<S: Simd>(simd: S, slices: [&[[f32; 2]]; 2], at: usize) -> f32x16<S> {
    let [low, high] = each!(pairs in [slices[0], slices[1]] => {
        f32x8::from_slice(simd, pairs[at..][..TOGETHER].as_flattened())
    });
    low.combine(high)
}

/// Returns the second and the third of four quads.
#[inline(always)]
fn inner_pair<S: Simd>(quads: f32x16<S>) -> [f32x4<S>; 2] {
    let (low, high) = quads.split();
    [low.split().1, high.split().0]
}
