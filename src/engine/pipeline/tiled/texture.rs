//! SIMD texture reads for sixteen samples. Results equal those of [`crate::pipeline::sample::Sampler`] bit for bit.

use super::axis::{TexelAxis, apply_address_mode, below_repeated, nearest, neighbours};
use super::gather::{Taps, gather, quads};
use crate::math::lanes::*;
use crate::math::prefetch::prefetch;
use crate::pipeline::footprint::MipFilter;
use crate::pipeline::sample::{ALPHA_SCALE, Sampler};
use crate::pipeline::settings::{AddressMode, ColorSpace, Settings, TexelFilter};
use crate::scene::{LevelLocation, Texture};

/// Memory layout of the texels that a sample reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Layout {
    /// One texel per sample.
    Single,
    /// Four texels per sample, at four separate indices.
    Four,
    /// One quad of 2 × 2 adjacent texels per sample, in a repeating texture.
    Quads,
    /// One quad per sample, in a repeating texture whose width and height are powers of two.
    PowerOfTwoQuads,
}

/// Texture and sampler, prepared for SIMD reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextureReader<'a> {
    pub(super) layout: Layout,
    /// 8-bit RGBA texels, of all levels if the texture is mip-mapped. Empty if filtering is done in linear light.
    texels: TexelRows<'a, u32>,
    /// Texels in linear light, of all levels if the texture is mip-mapped. Empty unless filtering is done in linear
    /// light.
    linear: TexelRows<'a, [f32; 4]>,
    /// Location of each mip level in the texel array; empty without mip-mapping.
    pub(super) levels: &'a [LevelLocation],
    /// Distance between adjacent rows, in texels.
    stride: i32,
    size: (u32, u32),
    /// Width and height of the texture in texels, as floats.
    pub(super) extent: [f32; 2],
    pub(super) sampler: Sampler,
    /// Number added to the level of detail.
    pub(super) mip_bias: f32,
    /// Maximum number of probes per sample; 1 unless the filter is anisotropic.
    pub(super) max_probes: u32,
    /// Whether texels are read with hardware gather instructions.
    pub(super) gathers: bool,
}

/// Rows of texels, padded with one extra texel at the end of each row and one extra row after the last.
#[derive(Clone, Copy, Debug)]
struct TexelRows<'a, T> {
    all: &'a [T],
    /// Texels from the second row on, so that a texel's lower neighbour has the same index in this slice.
    below: &'a [T],
}

impl<'a, T> TexelRows<'a, T> {
    fn new(all: &'a [T], stride: usize) -> Self {
        Self { all, below: all.get(stride..).unwrap_or_default() }
    }
}

/// Images that eight samples read, one per lane: the texture itself or one of its mip levels.
pub(super) struct Images<S: Simd> {
    /// Index of the first texel of each image in the texel array.
    pub(super) first: i32x8<S>,
    /// Width and height of each image.
    pub(super) axes: [TexelAxis<S>; 2],
}

impl<'a> TextureReader<'a> {
    pub(super) fn new(texture: &'a Texture, sampler: Sampler, settings: &Settings) -> Self {
        let size @ (width, height) = texture.image().size();
        let layout = match (sampler.filter, sampler.address) {
            (TexelFilter::Point, _) => Layout::Single,
            (_, AddressMode::Clamp | AddressMode::Mirror) => Layout::Four,
            (_, AddressMode::Repeat) if width.is_power_of_two() && height.is_power_of_two() => Layout::PowerOfTwoQuads,
            (_, AddressMode::Repeat) => Layout::Quads,
        };
        let (texels, linear, levels): (&[_], &[_], &[_]) = match (sampler.filter, settings.color_space) {
            (TexelFilter::Trilinear | TexelFilter::Anisotropic, ColorSpace::Bytes) => {
                (&texture.levels().texels, &[], &texture.levels().locations)
            }
            (TexelFilter::Trilinear | TexelFilter::Anisotropic, ColorSpace::Linear) => {
                (&[], &texture.levels_linear().texels, &texture.levels_linear().locations)
            }
            (TexelFilter::Point | TexelFilter::Bilinear, ColorSpace::Bytes) => (texture.wrapped(), &[], &[]),
            (TexelFilter::Point | TexelFilter::Bilinear, ColorSpace::Linear) => (&[], texture.wrapped_linear(), &[]),
        };
        let extent = [width as f32, height as f32];
        let stride = width as usize + 1;
        let (texels, linear) = (TexelRows::new(texels, stride), TexelRows::new(linear, stride));
        Self {
            layout,
            texels,
            linear,
            levels,
            stride: stride as i32,
            size,
            extent,
            sampler,
            mip_bias: settings.mip_bias,
            max_probes: MipFilter::new(settings).map_or(1, |filter| filter.max_probes),
            gathers: gathers_are_fast(),
        }
    }

    /// Returns the reader with hardware gathers enabled or disabled.
    #[inline(always)]
    pub(super) fn that_gathers(self, gathers: bool) -> Self {
        Self { gathers, ..self }
    }

    /// Returns the memory address of the texels, which identifies the texture.
    pub(super) fn address(&self) -> usize {
        if self.mixes_light() { self.linear.all.as_ptr().addr() } else { self.texels.all.as_ptr().addr() }
    }

    /// Returns `true` if samples may take several probes.
    #[inline(always)]
    pub(super) fn is_anisotropic(&self) -> bool {
        self.max_probes > 1
    }

    /// Returns `true` if texels are filtered in linear light.
    #[inline(always)]
    pub(super) fn mixes_light(&self) -> bool {
        !self.linear.all.is_empty()
    }

    /// Computes the indices and bilinear weights of the texels that sixteen samples read. `v` points down.
    ///
    /// This is separate from reading the texels, so that many cache misses overlap.
    #[inline(always)]
    pub(super) fn locate<S: Simd>(&self, simd: S, layout: Layout, [u, v]: [f32x16<S>; 2], taps: &mut Taps) {
        if layout == Layout::PowerOfTwoQuads {
            self.locate_power_of_two(simd, [u, v], taps);
            return;
        }
        self.locate_all(simd, layout, [u, v], taps);
    }

    #[inline(always)]
    fn locate_all<S: Simd>(&self, simd: S, layout: Layout, [u, v]: [f32x16<S>; 2], taps: &mut Taps) {
        let (u, v) = (u.split(), v.split());
        for (uv, first) in [([u.0, v.0], 0), ([u.1, v.1], LANES)] {
            if layout == Layout::Single {
                self.locate_nearest(simd, uv, taps, first);
                continue;
            }
            let images = Images {
                first: i32x8::splat(simd, 0),
                axes: [TexelAxis::splat(simd, self.size.0), TexelAxis::splat(simd, self.size.1)],
            };
            self.locate_eight(simd, layout, &images, uv, taps, first);
        }
    }

    /// Locates texels for coordinates outside the range of the fast path. Not inlined, so that it does not slow down
    /// the common case.
    #[cold]
    #[inline(never)]
    fn locate_unusual<S: Simd>(&self, simd: S, uv: [f32x16<S>; 2], taps: &mut Taps) {
        simd.vectorize(
            #[inline(always)]
            || self.locate_all(simd, Layout::Quads, uv, taps),
        );
    }

    #[inline(always)]
    fn locate_power_of_two<S: Simd>(&self, simd: S, [u, v]: [f32x16<S>; 2], taps: &mut Taps) {
        let (width, height) = self.size;
        let [x, y] = each!((u, extent) in [(u, self.extent[0]), (v, self.extent[1])] => u * extent);
        let Some([(x, right), (y, down)]) = below_repeated([x, y]) else {
            self.locate_unusual(simd, [u, v], taps);
            return;
        };
        self.place(x & (width as i32 - 1), y & (height as i32 - 1))
            .bitcast::<u32x16<S>>()
            .store_array(&mut taps.index[0]);
        right.store_array(&mut taps.right);
        down.store_array(&mut taps.down);
    }

    /// Returns the indices of texels given by column and row, in a texture whose width and height are powers of two.
    #[inline(always)]
    pub(super) fn place<S: Simd>(&self, x: i32x16<S>, y: i32x16<S>) -> i32x16<S> {
        // The stride is a power of two plus one: a shift and an addition are faster than a multiplication.
        (y << self.size.0.trailing_zeros()) + (y + x)
    }

    /// Locates the nearest texel of eight of the sixteen samples, starting at sample `first`.
    #[inline(always)]
    fn locate_nearest<S: Simd>(&self, simd: S, [u, v]: [F32<S>; 2], taps: &mut Taps, first: usize) {
        let Sampler { address, .. } = self.sampler;
        let x = nearest(simd, apply_address_mode(simd, u, address), self.size.0);
        let y = nearest(simd, apply_address_mode(simd, v, address), self.size.1);
        (y * self.stride + x).bitcast::<u32x8<S>>().store_slice(&mut taps.index[0][first..first + LANES]);
    }

    /// Locates the four texels of eight of the sixteen samples, starting at sample `first`.
    #[inline(always)]
    pub(super) fn locate_eight<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        images: &Images<S>,
        [u, v]: [F32<S>; 2],
        taps: &mut Taps,
        first: usize,
    ) {
        let Sampler { address, .. } = self.sampler;
        let eight = first..first + LANES;
        let x = neighbours(simd, apply_address_mode(simd, u, address), images.axes[0], address);
        let y = neighbours(simd, apply_address_mode(simd, v, address), images.axes[1], address);
        x.weight.store_slice(&mut taps.right[eight.clone()]);
        y.weight.store_slice(&mut taps.down[eight.clone()]);
        let [upper, lower] = each!(y in [y.first, y.second] => y * self.stride + images.first);
        let all = [upper + x.first, upper + x.second, lower + x.first, lower + x.second];
        let read = if layout == Layout::Four { all.len() } else { 1 };
        for (tap, place) in all.into_iter().enumerate().take(read) {
            place.bitcast::<u32x8<S>>().store_slice(&mut taps.index[tap][eight.clone()]);
        }
    }

    /// Prefetches the texels of every `step`th of sixteen samples.
    #[inline(always)]
    pub(super) fn prefetch(&self, taps: &Taps, step: usize) {
        for place in taps.index[0].into_iter().step_by(step) {
            let place = place as usize;
            if self.mixes_light() {
                prefetch(self.linear.all, place);
                prefetch(self.linear.below, place);
            } else {
                prefetch(self.texels.all, place);
                prefetch(self.texels.below, place);
            }
        }
    }

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

#[cfg(test)]
mod tests {
    use super::super::axis::{ALL_INTEGERS, LEAST_BELOW_ZERO};
    use super::*;
    use crate::image::Image;

    /// Returns a random texture coordinate: anywhere, near a texel boundary, or near a limit of the fast paths.
    fn coordinate(random: &mut fastrand::Rng, size: u32) -> f32 {
        let least_below_zero = LEAST_BELOW_ZERO / size as f32;
        let u = match random.u32(..6) {
            0 => random.f32() * 2.0 - 1.0,
            1 => (random.f32() * 2.0 - 1.0) * 50.0,
            2 => random.i32(-4 * size as i32..4 * size as i32) as f32 * 0.5 / size as f32,
            3 => (random.f32() * 2.0 - 1.0) * 4.0 * least_below_zero,
            4 => f32::from_bits(random.u32(..)),
            _ => [0.0, -0.0, -least_below_zero, ALL_INTEGERS / size as f32, -ALL_INTEGERS / size as f32]
                [random.usize(..5)],
        };
        let steps = if random.bool() { random.i32(-3..4) } else { 0 };
        (0..steps.abs()).fold(u, |u, _| if steps < 0 { u.next_down() } else { u.next_up() })
    }

    /// Returns, for each axis, the index of the first texel that a sample reads, and the weight of the next texel as
    /// f32 bits. If the next texel has all the weight, its index is returned instead, with weight 0.
    fn first_with_weight(taps: &Taps, lane: usize, (width, height): (u32, u32)) -> [(u32, u32); 2] {
        let (x, y) = (taps.index[0][lane] % (width + 1), taps.index[0][lane] / (width + 1));
        let along =
            |first, weight: f32, size| if weight == 1.0 { ((first + 1) % size, 0) } else { (first, weight.to_bits()) };
        [along(x, taps.right[lane], width), along(y, taps.down[lane], height)]
    }

    #[test]
    fn power_of_two_path_finds_the_same_texels_as_the_general_path() {
        let mut random = fastrand::Rng::with_seed(3);
        for size in [(1, 1), (2, 64), (1024, 16), (256, 512)] {
            let texture = Texture::new(Image::from_fn(size.0, size.1, |_, _| [0; 4])).expect("it has texels");
            let sampler = Sampler::new(TexelFilter::Bilinear, AddressMode::Repeat, ColorSpace::Bytes);
            let settings = Settings { color_space: ColorSpace::Bytes, ..Settings::default() };
            let reader = TextureReader::new(&texture, sampler, &settings);
            assert_eq!(reader.layout, Layout::PowerOfTwoQuads);
            for round in 0..2000 {
                // Most rounds use coordinates of one kind, so that all paths are taken.
                let [u, v] = [size.0, size.1].map(|size| -> [f32; WIDE] {
                    std::array::from_fn(|_| {
                        loop {
                            let u = coordinate(&mut random, size);
                            let position = u * size as f32;
                            let is_of_kind = match round % 4 {
                                0 => (0.0..ALL_INTEGERS).contains(&position),
                                1 | 2 => position.abs() < ALL_INTEGERS && !(-LEAST_BELOW_ZERO..0.0).contains(&position),
                                _ => true,
                            };
                            if is_of_kind {
                                break u;
                            }
                        }
                    })
                });
                for lanes in Lanes::all() {
                    let [quick, general] = on_lanes!(lanes, simd => {
                        let uv = [f32x16::load_array(simd, u), f32x16::load_array(simd, v)];
                        let (mut quick, mut general) = (Taps::default(), Taps::default());
                        reader.locate_power_of_two(simd, uv, &mut quick);
                        reader.locate_all(simd, Layout::Quads, uv, &mut general);
                        [quick, general]
                    });
                    for lane in 0..WIDE {
                        let [quick, general] = [&quick, &general].map(|taps| first_with_weight(taps, lane, size));
                        assert_eq!(quick, general, "{} {} by {}", u[lane], v[lane], lanes.name());
                    }
                }
            }
        }
    }
}
