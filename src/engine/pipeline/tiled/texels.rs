//! SIMD reads and bilinear filtering of texels, for the texture taps of sixteen samples.

use super::gather::{Taps, gather, quads};
use super::texture::{Layout, TextureReader};
use crate::math::lanes::*;
use crate::pipeline::formulas::{bilinear_weights, weighted_sum};
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
        let shares =
            each!(of in [&taps.right, &taps.down] => S::f32s::from_slice(simd, &of[first..first + S::f32s::LEN]));
        let weights = bilinear_weights(S::f32s::splat(simd, 1.0), shares);
        let codes = each!(tap in [0, 1, 2, 3] => codes::<S>(texels[tap]));
        each!(channel in [0, 1, 2, 3] => {
            weighted_sum(each!(tap in [0, 1, 2, 3] => codes[tap][channel]), weights) * scales[channel]
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
        let shares = each!(of in [&taps.right, &taps.down] => f32x16::load_array_ref(simd, of));
        let weights = bilinear_weights(f32x16::splat(simd, 1.0), shares);
        let mixed = self.mix_linear(simd, layout, weights, &taps.index);
        each!(channel in [0, 1, 2, 3] => mixed[channel] * scales[channel])
    }

    /// Returns the factors that scale the filtered channels to [0, 1].
    #[inline(always)]
    fn scales(&self) -> [f32; 4] {
        let Sampler { scale, .. } = self.sampler;
        [scale, scale, scale, ALPHA_SCALE]
    }

    /// Filters four texels in linear light for each of sixteen samples. Processes four samples at a time with all their
    /// channels, because loading each channel separately, with twelve loads per sample, takes longer.
    #[inline(always)]
    fn mix_linear<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        weights: [f32x16<S>; 4],
        index: &[[u32; WIDE]; 4],
    ) -> [f32x16<S>; 4] {
        let weights = each!(tap in [0, 1, 2, 3] => repeat_each(simd, weights[tap]));
        let four = match layout {
            Layout::Single | Layout::Four => each!(lane in [0, 1, 2, 3] => {
                let texels = each!(tap in [0, 1, 2, 3] => {
                    joined(each!(of in [lane, lane + 4, lane + 8, lane + 12] => {
                        f32x4::load_array_ref(simd, &self.linear.all[index[tap][of] as usize])
                    }))
                });
                weighted_sum(texels, each!(tap in [0, 1, 2, 3] => weights[tap][lane]))
            }),
            Layout::Quads | Layout::PowerOfTwoQuads => {
                let pairs = each!(row in [self.linear.all, self.linear.below] => neighbours_at(simd, row, &index[0]));
                each!(lane in [0, 1, 2, 3] => {
                    let [upper, lower] = each!(row in [0, 1] => {
                        columns(simd, each!(of in [lane, lane + 4, lane + 8, lane + 12] => &pairs[row][of]))
                    });
                    let texels = [upper[0], upper[1], lower[0], lower[1]];
                    weighted_sum(texels, each!(tap in [0, 1, 2, 3] => weights[tap][lane]))
                })
            }
        };
        transpose_quarters(four)
    }
}

/// Joins the texels of four samples.
#[inline(always)]
fn joined<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> f32x16<S> {
    a.combine(b).combine(c.combine(d))
}

/// Returns the left and the right texels of four samples. If a register holds the texels of four samples, both texels of a
/// sample are loaded at once; otherwise this takes longer than single loads.
#[inline(always)]
fn columns<S: Simd>(simd: S, pairs: [&[[f32; 4]; 2]; 4]) -> [f32x16<S>; 2] {
    if S::f32s::LEN == WIDE {
        let [a, b, c, d] = each!(of in [0, 1, 2, 3] => f32x8::from_slice(simd, pairs[of].as_flattened()).split());
        return [joined([a.0, b.0, c.0, d.0]), joined([a.1, b.1, c.1, d.1])];
    }
    each!(column in [0, 1] => joined(each!(of in [0, 1, 2, 3] => f32x4::load_array_ref(simd, &pairs[of][column]))))
}

/// Unpacks 8-bit texels into red, green, blue and alpha, as floats from 0 to 255.
#[inline(always)]
pub(super) fn codes<S: Simd>(texels: S::u32s) -> [S::f32s; 4] {
    each!(shift in [0, 8, 16, 24] => ((texels >> shift) & 255).bitcast::<S::i32s>().to_float::<S::f32s>())
}

/// Returns the texels at sixteen indices, each with its right neighbour.
///
/// # Panics
///
/// Panics if a texel or its right neighbour is out of bounds.
#[inline(always)]
#[expect(unsafe_code, reason = "one bounds check for sixteen reads instead of sixteen")]
fn neighbours_at<S: Simd>(simd: S, texels: &[[f32; 4]], index: &[u32; WIDE]) -> [[[f32; 4]; 2]; WIDE] {
    // Lengths are below 2³², because texture sizes are limited.
    let last = texels.len().saturating_sub(1) as u32;
    assert!(u32x16::load_array_ref(simd, index).simd_lt(last).all_true(), "all texels are within the texture");
    each!(lane in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => {
        // SAFETY: `index[lane]` is less than the index of the last texel, as asserted above. This texel and the next
        // one therefore lie within the slice, and an array has the alignment of its items.
        unsafe { texels.as_ptr().add(index[lane] as usize).cast::<[[f32; 4]; 2]>().read() }
    })
}
