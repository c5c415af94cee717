//! Final colours of queued samples: surface colour × texture × light, encoded and written to the picture.

use super::mipmap::LevelTaps;
use super::patch::ALL;
use super::queue::{FilledRows, QueuedPair, QueuedRow};
use super::shader::{DrawShader, LightSource, ShadingPlan, TEXELS_AROUND, with_known_plan};
use super::texels;
use super::texture::TextureReader;
use crate::image::Rgba8;
use crate::image::color::{Tables, scaled_to_codes};
use crate::math::lanes::*;
use crate::pipeline::formulas::blended;
use crate::pipeline::settings::ColorSpace;

/// Finishes pairs of rows in sRGB codes, without mip-mapping and blending. Whether texels are gathered by hardware is
/// decided before the loop.
#[inline(always)]
pub(super) fn finish_codes<S: Simd>(simd: S, shader: &DrawShader<'_>, rows: FilledRows<'_>, pixels: &mut [Rgba8]) {
    let plan = ShadingPlan { mipmapped: false, blended: false, ..shader.plan.of_space(ColorSpace::Bytes) };
    let shader = &{ *shader };
    with_known_plan!([LAMBERT, GOURAUD], plan, plan => match shader.texture {
        Some(texture) if texture.gathers => {
            let texture = texture.that_gathers(true);
            Finisher { shader, texture: Some(&texture), plan: *plan }.finish_all(simd, rows, pixels);
        }
        Some(texture) => {
            let texture = texture.that_gathers(false);
            Finisher { shader, texture: Some(&texture), plan: *plan }.finish_all(simd, rows, pixels);
        }
        None => Finisher { shader, texture: None, plan: *plan }.finish_all(simd, rows, pixels),
    });
}

/// Finishes pairs of rows in linear light, without mip-mapping and blending. Not inlined, so that the code for sRGB codes
/// stays small.
#[inline(never)]
pub(super) fn finish_light<S: Simd>(simd: S, shader: &DrawShader<'_>, rows: FilledRows<'_>, pixels: &mut [Rgba8]) {
    simd.vectorize(
        #[inline(always)]
        || {
            let plan = ShadingPlan { mipmapped: false, blended: false, ..shader.plan.of_space(ColorSpace::Linear) };
            let shader = &{ *shader };
            with_known_plan!([LAMBERT, GOURAUD], plan, plan => Finisher::new(shader, *plan).finish_all(simd, rows, pixels));
        },
    );
}

/// Finishes pairs of rows of a blended draw.
#[inline(never)]
pub(super) fn finish_blended<S: Simd>(simd: S, shader: &DrawShader<'_>, rows: FilledRows<'_>, pixels: &mut [Rgba8]) {
    simd.vectorize(
        #[inline(always)]
        || {
            let plan = ShadingPlan { mipmapped: false, blended: true, ..shader.plan };
            Finisher::new(shader, plan).finish_all(simd, rows, pixels);
        },
    );
}

/// Finishes pairs of rows of a mip-mapped draw. Returns the number of texels read from coarser mip levels.
#[inline(never)]
pub(super) fn finish_mipmapped<S: Simd>(
    simd: S,
    shader: &DrawShader<'_>,
    rows: FilledRows<'_>,
    pixels: &mut [Rgba8],
) -> u64 {
    simd.vectorize(
        #[inline(always)]
        || {
            let (shader, of_one_level) = (&{ *shader }, ShadingPlan { mipmapped: false, ..shader.plan });
            with_known_plan!([LAMBERT, GOURAUD], of_one_level, plan => {
                let finisher = Finisher::new(shader, ShadingPlan { mipmapped: true, ..*plan });
                for ((pair, fine), coarse) in rows.pairs.iter().zip(rows.taps).zip(rows.coarse) {
                    finisher.finish(simd, pair, LevelTaps { fine, coarse: Some(coarse) }, pixels);
                }
            });
            // The anisotropic filter counts the texels of both levels with the samples.
            if shader.texture.is_none_or(|texture| texture.is_anisotropic()) {
                return 0;
            }
            let reading = rows.pairs.iter().zip(rows.coarse).filter(|(_, coarse)| coarse.is_read);
            reading.map(|(pair, _)| pair.rows.iter().map(|row| u64::from(row.written())).sum::<u64>()).sum::<u64>()
                * TEXELS_AROUND
        },
    )
}

/// Shader, texture and plan with which the colours of queued samples are finished. Callers pass local copies of shader and
/// texture: the compiler then knows that stores to the picture cannot change them, and loads them once per loop.
struct Finisher<'a> {
    shader: &'a DrawShader<'a>,
    /// Texture of the shader.
    texture: Option<&'a TextureReader<'a>>,
    plan: ShadingPlan,
}

impl<'a> Finisher<'a> {
    /// Returns the finisher for a shader with its own texture.
    #[inline(always)]
    fn new(shader: &'a DrawShader<'a>, plan: ShadingPlan) -> Self {
        Self { shader, texture: shader.texture.as_ref(), plan }
    }

    /// Finishes pairs of rows without mip-mapping.
    #[inline(always)]
    fn finish_all<S: Simd>(&self, simd: S, rows: FilledRows<'_>, pixels: &mut [Rgba8]) {
        for (pair, fine) in rows.pairs.iter().zip(rows.taps) {
            self.finish(simd, pair, LevelTaps { fine, coarse: None }, pixels);
        }
    }

    /// Computes surface colour × texture × light for a pair of rows, and writes the encoded pixels.
    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, pair: &QueuedPair, taps: LevelTaps<'_>, pixels: &mut [Rgba8]) {
        let Self { shader, texture, plan } = *self;
        let mut codes = [0; WIDE];
        if plan.blended {
            let (upper, lower) = codes.split_at_mut(LANES);
            read_row(&pair.rows[0], pixels, upper);
            read_row(&pair.rows[1], pixels, lower);
        }
        match plan.space {
            ColorSpace::Bytes => {
                // Processes as many samples at a time as a register holds. If registers are narrow, the data of all
                // sixteen samples does not fit into them.
                for start in (0..WIDE).step_by(LANES.max(S::f32s::LEN)) {
                    let rows = start..start + LANES.max(S::f32s::LEN);
                    for first in rows.clone().step_by(S::f32s::LEN) {
                        let codes = &mut codes[first..first + S::u32s::LEN];
                        let mut color = self.surface_color::<S, S::f32s>(simd, pair, first);
                        if let (Some(texture), Some(layout)) = (texture, plan.texture) {
                            color = textured(plan, color, texture.filtered_bytes(simd, layout, taps, first));
                        }
                        color = lit(simd, plan, color, pair, first);
                        if plan.blended {
                            let below = texels::codes::<S>(S::u32s::from_slice(simd, codes));
                            let scale = shader.shader.sampler().scale;
                            color = over(simd, color, each!(channel in [0, 1, 2] => below[channel] * scale));
                        }
                        pack(simd, color).store_slice(codes);
                    }
                    for first in rows.step_by(LANES) {
                        let codes = u32x8::from_slice(simd, &codes[first..first + LANES]);
                        write_row(simd, codes, &pair.rows[first / LANES], pixels);
                    }
                }
            }
            ColorSpace::Linear => {
                let mut color = self.surface_color::<S, f32x16<S>>(simd, pair, 0);
                if let (Some(texture), Some(layout)) = (texture, plan.texture) {
                    color = textured(plan, color, texture.filtered_linear(simd, layout, taps));
                }
                color = lit(simd, plan, color, pair, 0);
                if plan.blended {
                    let below = u32x16::load_array(simd, codes);
                    color = over(simd, color, Tables::get().linear_of_code.of_pixels(simd, below));
                }
                encode(simd, color).store_array(&mut codes);
                for (row, codes) in pair.rows.iter().zip(codes.chunks_exact(LANES)) {
                    write_row(simd, u32x8::from_slice(simd, codes), row, pixels);
                }
            }
        }
    }

    /// Returns the surface colours and opacities of the samples starting at `first`. They are not yet multiplied by the
    /// texture.
    #[inline(always)]
    fn surface_color<S: Simd, F: SimdFloat<S, Element = f32>>(
        &self,
        simd: S,
        pair: &QueuedPair,
        first: usize,
    ) -> [F; 4] {
        let Self { shader, plan, .. } = *self;
        let alpha = F::splat(simd, shader.shader.opacity());
        let [r, g, b] = if plan.colored {
            each!(channel in [0, 1, 2] => F::from_slice(simd, &pair.color[channel][first..first + F::LEN]))
        } else {
            let diffuse = shader.shader.diffuse.to_array();
            each!(channel in [0, 1, 2] => F::splat(simd, diffuse[channel]))
        };
        [r, g, b, alpha]
    }
}

/// Multiplies surface colours by texels. Skips the multiplication of the colours if the surface is white.
#[inline(always)]
fn textured<S: Simd, F: SimdFloat<S>>(plan: ShadingPlan, [r, g, b, alpha]: [F; 4], texel: [F; 4]) -> [F; 4] {
    let white = !plan.tinted && !plan.colored;
    let [red, green, blue] =
        if white { [texel[0], texel[1], texel[2]] } else { [r * texel[0], g * texel[1], b * texel[2]] };
    [red, green, blue, alpha * texel[3]]
}

/// Multiplies colours by the light at the samples starting at `first`. Alpha is unchanged.
#[inline(always)]
fn lit<S: Simd, F: SimdFloat<S, Element = f32>>(
    simd: S,
    plan: ShadingPlan,
    color: [F; 4],
    pair: &QueuedPair,
    first: usize,
) -> [F; 4] {
    if plan.light == LightSource::None {
        return color;
    }
    let ([r, g, b, alpha], light) = (color, F::from_slice(simd, &pair.light[first..first + F::LEN]));
    [r * light, g * light, b * light, alpha]
}

/// Blends colours over the colours in `below`, weighted by alpha.
#[inline(always)]
fn over<S: Simd, F: SimdFloat<S, Element = f32>>(simd: S, [r, g, b, alpha]: [F; 4], below: [F; 3]) -> [F; 4] {
    let one = F::splat(simd, 1.0);
    let [red, green, blue] =
        each!((color, below) in [(r, below[0]), (g, below[1]), (b, below[2])] => blended(one, color, below, alpha));
    [red, green, blue, alpha]
}

/// Reads the 8-bit RGBA colours of up to eight pixels that lie within the picture. Does nothing if none of these pixels
/// will be written.
fn read_row(row: &QueuedRow, pixels: &[Rgba8], codes: &mut [u32]) {
    if row.mine == 0 {
        return;
    }
    for (code, pixel) in codes.iter_mut().zip(&pixels[row.pixels()]) {
        *code = u32::from_le_bytes(*pixel);
    }
}

#[inline(always)]
fn write_row<S: Simd>(simd: S, codes: u32x8<S>, row: &QueuedRow, pixels: &mut [Rgba8]) {
    if u32::from(row.mine) == ALL {
        let bytes = pixels[row.start as usize..][..LANES].as_flattened_mut();
        codes.bitcast::<u8x32<S>>().store_slice(bytes);
        return;
    }
    if row.mine == 0 {
        return;
    }
    let out = &mut pixels[row.pixels()];
    let Ok(out) = <&mut [Rgba8; LANES]>::try_from(&mut *out) else {
        let codes = codes.to_array();
        for (lane, pixel) in out.iter_mut().enumerate().filter(|(lane, _)| row.mine >> lane & 1 != 0) {
            *pixel = codes[lane].to_le_bytes();
        }
        return;
    };
    let bytes = out.as_flattened_mut();
    let there = u8x32::from_slice(simd, bytes).bitcast::<u32x8<S>>();
    let codes = mask32x8::from_bitmask(simd, row.mine.into()).select(codes, there);
    codes.bitcast::<u8x32<S>>().store_slice(bytes);
}

/// Quantises colours like [`crate::image::color::quantize`], and packs them into opaque pixels.
#[inline(always)]
fn pack<S: Simd>(simd: S, [r, g, b, _]: [S::f32s; 4]) -> S::u32s {
    let scaled = each!(channel in [r, g, b] => scaled_to_codes(channel));
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = simd.level().as_avx512() {
        let scaled = each!(c in [0, 1, 2] => f32x16::from_slice(avx512, scaled[c].as_slice()).into());
        let codes: u32x16<_> = x86::sixteen_opaque(avx512, scaled).simd_into(avx512);
        return S::u32s::from_slice(simd, codes.as_slice());
    }
    #[cfg(target_arch = "x86_64")]
    if S::f32s::LEN == LANES
        && let Some(avx2) = simd.level().as_avx2()
    {
        let scaled = each!(c in [0, 1, 2] => f32x8::from_slice(avx2, scaled[c].as_slice()).into());
        let codes: u32x8<_> = x86::opaque(avx2, scaled).simd_into(avx2);
        return S::u32s::from_slice(simd, codes.as_slice());
    }
    let [r, g, b] = each!(c in [0, 1, 2] => {
        scaled[c].max(0.0).min(S::f32s::splat(simd, 255.0)).to_int::<S::i32s>().bitcast::<S::u32s>()
    });
    r | g << 8 | b << 16 | 0xFF00_0000
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    use crate::math::lanes::each;

    kernel! {
        /// Truncates red, green and blue toward zero, clamps them to [0, 255] and packs them into eight opaque pixels.
        #[inline]
        pub(super) fn opaque(avx2: Avx2, channels: [__m256; 3]) -> __m256i {
            let largest = _mm256_set1_ps(255.0);
            // This operand order preserves NaN, which converts to the least integer and then saturates to 0.
            let [r, g, b] = each!(c in [0, 1, 2] => _mm256_cvttps_epi32(_mm256_min_ps(largest, channels[c])));
            let (red_green, blue_alpha) =
                (_mm256_packs_epi32(r, g), _mm256_packs_epi32(b, _mm256_set1_epi32(255)));
            let in_turn = _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15));
            _mm256_shuffle_epi8(_mm256_packus_epi16(red_green, blue_alpha), in_turn)
        }
    }

    kernel! {
        /// Truncates red, green and blue toward zero, clamps them to [0, 255] and packs them into sixteen opaque
        /// pixels.
        #[inline]
        pub(super) fn sixteen_opaque(avx512: Avx512, channels: [__m512; 3]) -> __m512i {
            let largest = _mm512_set1_ps(255.0);
            let [r, g, b] = each!(c in [0, 1, 2] => _mm512_cvttps_epi32(_mm512_min_ps(largest, channels[c])));
            let (red_green, blue_alpha) =
                (_mm512_packs_epi32(r, g), _mm512_packs_epi32(b, _mm512_set1_epi32(255)));
            let in_turn = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15));
            _mm512_shuffle_epi8(_mm512_packus_epi16(red_green, blue_alpha), in_turn)
        }
    }
}

/// Encodes colours in linear light as sRGB, and packs them into opaque pixels.
#[inline(always)]
fn encode<S: Simd>(simd: S, [r, g, b, _]: [f32x16<S>; 4]) -> u32x16<S> {
    Tables::get().encode_pixels(simd, [r, g, b]) | 0xFF00_0000
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::color::quantize;

    #[test]
    fn packed_colors_equal_quantized_colors() {
        let mut random = fastrand::Rng::with_seed(5);
        let unusual = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, -0.0, 1.0, -0.002, 1.002, 0.998];
        let mut channel = || match random.usize(..3) {
            0 => unusual[random.usize(..unusual.len())],
            1 => (f32::from(random.u8(..)) + 0.5) / 255.0,
            _ => random.f32() * 1.5 - 0.25,
        };
        for _ in 0..1000 {
            let color: [[f32; WIDE]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| channel()));
            for lanes in Lanes::all() {
                let codes = on_lanes!(lanes, simd => {
                    #[inline(always)]
                    fn packed<S: Simd>(simd: S, color: &[[f32; WIDE]; 4]) -> Vec<u32> {
                        let first = each!(c in [0, 1, 2, 3] => S::f32s::from_slice(simd, &color[c][..S::f32s::LEN]));
                        pack(simd, first).as_slice().to_vec()
                    }
                    packed(simd, &color)
                });
                for (lane, code) in codes.iter().enumerate() {
                    let expected = [0, 1, 2].map(|c| quantize(color[c][lane]));
                    assert_eq!(code.to_le_bytes(), [expected[0], expected[1], expected[2], 255], "by {}", lanes.name());
                }
            }
        }
    }
}
