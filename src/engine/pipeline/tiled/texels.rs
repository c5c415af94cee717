//! SIMD reads and bilinear filtering of texels, for the texture taps of sixteen samples.

use super::gather::{Taps, gather, quads};
use super::texture::{Layout, TextureReader};
use crate::math::lanes::*;
use crate::pipeline::sample::{ALPHA_SCALE, Sampler};

impl TextureReader<'_> {
    /// Reads and filters 8-bit texels, for as many samples as a register holds, starting at sample `first`. Returns
    /// red, green, blue and alpha in [0, 1].
    #[inline(always)]
    pub(super) fn read_bytes<S: Simd>(&self, simd: S, layout: Layout, taps: &Taps, first: usize) -> [S::f32s; 4] {
        let places = |tap: usize| &taps.index[tap][first..first + S::u32s::LEN];
        let scales = self.scales();
        let texels = match layout {
            Layout::Single => {
                let codes = codes::<S>(gather(simd, self.gathers, self.texels.all, places(0)));
                return each!(channel in [0, 1, 2, 3] => codes[channel] * scales[channel]);
            }
            Layout::Four => each!(tap in [0, 1, 2, 3] => gather(simd, self.gathers, self.texels.all, places(tap))),
            Layout::Quads | Layout::PowerOfTwoQuads => {
                quads(simd, self.gathers, [self.texels.all, self.texels.below], places(0))
            }
        };
        let weights = weights(
            simd,
            S::f32s::from_slice(simd, &taps.right[first..first + S::f32s::LEN]),
            S::f32s::from_slice(simd, &taps.down[first..first + S::f32s::LEN]),
        );
        let codes = each!(tap in [0, 1, 2, 3] => codes::<S>(texels[tap]));
        each!(channel in [0, 1, 2, 3] => {
            let sum = codes[0][channel] * weights[0]
                + codes[1][channel] * weights[1]
                + codes[2][channel] * weights[2]
                + codes[3][channel] * weights[3];
            sum * scales[channel]
        })
    }

    /// Reads and filters texels in linear light, for sixteen samples. Returns red, green, blue and alpha in [0, 1].
    #[inline(always)]
    pub(super) fn read_linear<S: Simd>(&self, simd: S, layout: Layout, taps: &Taps) -> [f32x16<S>; 4] {
        let scales = self.scales();
        if layout == Layout::Single {
            let [low, high] = each!(first in [0, LANES] => {
                let texels = each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
                    f32x4::load_array_ref(simd, &self.linear.all[taps.index[0][first + lane] as usize])
                });
                transpose_quads(texels)
            });
            return each!(channel in [0, 1, 2, 3] => low[channel].combine(high[channel]) * scales[channel]);
        }
        let weights =
            weights(simd, f32x16::load_array_ref(simd, &taps.right), f32x16::load_array_ref(simd, &taps.down));
        let halves = each!(tap in [0, 1, 2, 3] => weights[tap].split());
        let low = each!(tap in [0, 1, 2, 3] => halves[tap].0);
        let high = each!(tap in [0, 1, 2, 3] => halves[tap].1);
        let [low, high] = each!((weights, first) in [(low, 0), (high, LANES)] => {
            self.mix_linear(simd, layout, weights, &taps.index, first)
        });
        each!(channel in [0, 1, 2, 3] => low[channel].combine(high[channel]) * scales[channel])
    }

    /// Returns the factors that scale the filtered channels to [0, 1].
    #[inline(always)]
    fn scales(&self) -> [f32; 4] {
        let Sampler { scale, .. } = self.sampler;
        [scale, scale, scale, ALPHA_SCALE]
    }

    /// Filters four texels in linear light for each of eight samples, starting at sample `first`. Processes two samples
    /// at a time with all their channels, because loading each channel separately, with twelve loads per sample, takes
    /// longer.
    #[inline(always)]
    fn mix_linear<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        weights: [F32<S>; 4],
        index: &[[u32; WIDE]; 4],
        first: usize,
    ) -> [F32<S>; 4] {
        let weights = each!(tap in [0, 1, 2, 3] => repeat_each(simd, weights[tap]));
        let two = match layout {
            Layout::Single | Layout::Four => each!(lane in [0, 1, 2, 3] => {
                let [a, b, c, d] = each!(tap in [0, 1, 2, 3] => {
                    let [low, high] = each!(of in [lane, lane + LANES / 2] => {
                        f32x4::load_array_ref(simd, &self.linear.all[index[tap][first + of] as usize])
                    });
                    low.combine(high) * weights[tap][lane]
                });
                a + b + c + d
            }),
            Layout::Quads | Layout::PowerOfTwoQuads => {
                let places = u32x8::from_slice(simd, &index[0][first..first + LANES]);
                let pairs = each!(row in [self.linear.all, self.linear.below] => neighbours_at(simd, row, places));
                each!(lane in [0, 1, 2, 3] => {
                    let [a, b, c, d] = each!((tap, row, column) in [(0, 0, 0), (1, 0, 1), (2, 1, 0), (3, 1, 1)] => {
                        let [low, high] = each!(of in [lane, lane + LANES / 2] => {
                            f32x4::load_array_ref(simd, &pairs[row][of][column])
                        });
                        low.combine(high) * weights[tap][lane]
                    });
                    a + b + c + d
                })
            }
        };
        transpose_halves(two)
    }
}

/// Returns the bilinear weights of the upper left, upper right, lower left and lower right texel.
#[inline(always)]
fn weights<S: Simd, F: SimdFloat<S, Element = f32>>(simd: S, right: F, down: F) -> [F; 4] {
    let one = F::splat(simd, 1.0);
    let (left, up) = (one - right, one - down);
    [left * up, right * up, left * down, right * down]
}

/// Unpacks 8-bit texels into red, green, blue and alpha, as floats from 0 to 255.
#[inline(always)]
pub(super) fn codes<S: Simd>(texels: S::u32s) -> [S::f32s; 4] {
    each!(shift in [0, 8, 16, 24] => ((texels >> shift) & 255).bitcast::<S::i32s>().to_float::<S::f32s>())
}

/// Returns the texels at eight indices, each with its right neighbour.
///
/// # Panics
///
/// Panics if a texel or its right neighbour is out of bounds.
#[inline(always)]
#[expect(
    unsafe_code,
    reason = "one bounds check for eight reads: a fully textured picture is drawn an eighth faster than with one each"
)]
fn neighbours_at<S: Simd, T: Copy>(_: S, texels: &[T], index: u32x8<S>) -> [[T; 2]; LANES] {
    // Lengths are below 2³², because texture sizes are limited.
    let last = texels.len().saturating_sub(1) as u32;
    assert!(index.simd_lt(last).to_bitmask() == 0xFF, "all texels are within the texture");
    let index = index.to_array();
    each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
        // SAFETY: `index[lane]` is less than the index of the last texel, as asserted above. This texel and the next
        // one therefore lie within the slice, and an array has the alignment of its items.
        unsafe { texels.as_ptr().add(index[lane] as usize).cast::<[T; 2]>().read() }
    })
}
