//! SIMD texture reads for sixteen samples. Results equal those of [`crate::pipeline::sample::Sampler`] bit for bit.

use super::axis::{TexelAxis, apply_address_mode, below_repeated, nearest, neighbours};
use super::gather::Taps;
use crate::math::lanes::*;
use crate::math::prefetch::prefetch;
use crate::pipeline::footprint::MipFilter;
use crate::pipeline::sample::Sampler;
use crate::pipeline::settings::{AddressMode, ColorSpace, Settings, TexelFilter};
use crate::scene::{MipOffsets, Texture};

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
    pub(super) texels: TexelRows<'a, u32>,
    /// Texels in linear light, of all levels if the texture is mip-mapped. Empty unless filtering is done in linear
    /// light.
    pub(super) linear: TexelRows<'a, [f32; 4]>,
    /// Offsets of the mip levels in the texel array; a single one without mip-mapping.
    pub(super) levels: &'a MipOffsets,
    /// Distance between adjacent rows, in texels.
    stride: i32,
    pub(super) size: (u32, u32),
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
pub(super) struct TexelRows<'a, T> {
    pub(super) all: &'a [T],
    /// Texels from the second row on, so that a texel's lower neighbour has the same index in this slice.
    pub(super) below: &'a [T],
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

/// Texture taps of eight samples, one per lane.
pub(super) struct TapsOfEight<S: Simd> {
    /// Indices of the upper left, upper right, lower left and lower right texel.
    index: [i32x8<S>; 4],
    /// Bilinear weights of the right texels, in [0, 1].
    right: F32<S>,
    /// Bilinear weights of the lower texels, in [0, 1].
    down: F32<S>,
}

impl<S: Simd> TapsOfEight<S> {
    /// Stores the taps as those of eight of sixteen samples, starting at sample `first`.
    #[inline(always)]
    pub(super) fn store(self, layout: Layout, taps: &mut Taps, first: usize) {
        let Self { index, right, down } = self;
        let eight = first..first + LANES;
        right.store_slice(&mut taps.right[eight.clone()]);
        down.store_slice(&mut taps.down[eight.clone()]);
        let read = if layout == Layout::Four { index.len() } else { 1 };
        for (tap, place) in index.into_iter().enumerate().take(read) {
            place.bitcast::<u32x8<S>>().store_slice(&mut taps.index[tap][eight.clone()]);
        }
    }
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
        let (texels, linear, levels): (&[_], &[_], _) = match (sampler.filter, settings.color_space) {
            (TexelFilter::Trilinear | TexelFilter::Anisotropic, ColorSpace::Bytes) => {
                (&texture.levels().texels, &[], &texture.levels().offsets)
            }
            (TexelFilter::Trilinear | TexelFilter::Anisotropic, ColorSpace::Linear) => {
                (&[], &texture.levels_linear().texels, &texture.levels_linear().offsets)
            }
            (TexelFilter::Point | TexelFilter::Bilinear, ColorSpace::Bytes) => {
                (texture.wrapped(), &[], &MipOffsets::SINGLE)
            }
            (TexelFilter::Point | TexelFilter::Bilinear, ColorSpace::Linear) => {
                (&[], texture.wrapped_linear(), &MipOffsets::SINGLE)
            }
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
            self.locate_eight(simd, &images, uv).store(layout, taps, first);
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

    /// Locates the four texels that each of eight samples reads in its image.
    #[inline(always)]
    pub(super) fn locate_eight<S: Simd>(&self, simd: S, images: &Images<S>, [u, v]: [F32<S>; 2]) -> TapsOfEight<S> {
        let Sampler { address, .. } = self.sampler;
        let x = neighbours(simd, apply_address_mode(simd, u, address), images.axes[0], address);
        let y = neighbours(simd, apply_address_mode(simd, v, address), images.axes[1], address);
        let [upper, lower] = each!(y in [y.first, y.second] => y * self.stride + images.first);
        TapsOfEight {
            index: [upper + x.first, upper + x.second, lower + x.first, lower + x.second],
            right: x.weight,
            down: y.weight,
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
