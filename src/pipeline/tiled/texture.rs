//! Texture reads for eight samples: [`crate::pipeline::sample::Sampler`] on lanes, bit for bit.

use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::math::lanes::*;
use crate::pipeline::sample::Sampler;
use crate::pipeline::settings::{Address, ColorSpace, Filter};
use crate::scene::Texture;

/// The two texels around a coordinate along one axis, and the weight of the second one.
struct Neighbours<S: Simd> {
    first: i32x8<S>,
    second: i32x8<S>,
    weight: F32<S>,
}

/// The four texels around each of eight places, and how near the place is to the right and to the lower ones.
pub(super) struct Taps<S: Simd> {
    index: [u32x8<S>; 4],
    right: F32<S>,
    down: F32<S>,
}

/// [`Taps`] in memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StoredTaps {
    index: [[u32; LANES]; 4],
    right: [f32; LANES],
    down: [f32; LANES],
}

impl<S: Simd> Taps<S> {
    #[inline(always)]
    pub(super) fn store(self, out: &mut StoredTaps) {
        for tap in 0..4 {
            self.index[tap].store_array(&mut out.index[tap]);
        }
        self.right.store_array(&mut out.right);
        self.down.store_array(&mut out.down);
    }
}

/// A texture with how it is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextureReader<'a> {
    texels: &'a [Rgba8],
    /// Rows that go on with their first texel once more, where that is how they are read; else empty.
    wrapped: &'a [u32],
    /// Numbers from one row to the next in what is read.
    stride: i32,
    size: (u32, u32),
    sampler: Sampler,
    space: ColorSpace,
}

impl<'a> TextureReader<'a> {
    pub(super) fn new(texture: &'a Texture, sampler: Sampler, space: ColorSpace) -> Self {
        let image = texture.image();
        let pairs = sampler.filter == Filter::Bilinear && sampler.address == Address::Repeat;
        let (wrapped, stride) = if pairs { (texture.wrapped(), image.width() + 1) } else { (&[][..], image.width()) };
        Self { texels: image.pixels(), wrapped, stride: stride as i32, size: image.size(), sampler, space }
    }

    /// Which texels are read at eight places (v down). Told apart from reading them, so that many reads can be under way.
    #[inline(always)]
    pub(super) fn locate<S: Simd>(&self, simd: S, u: F32<S>, v: F32<S>) -> Taps<S> {
        let (width, height) = self.size;
        let Sampler { filter, address, .. } = self.sampler;
        match filter {
            Filter::Point => {
                let x = nearest(simd, bring_into_unit(simd, u, address), width);
                let y = nearest(simd, bring_into_unit(simd, v, address), height);
                let only = self.index(x, y);
                let zero = F32::splat(simd, 0.0);
                Taps { index: [only; 4], right: zero, down: zero }
            }
            Filter::Bilinear => {
                let x = neighbours(simd, u, width, address);
                let y = neighbours(simd, v, height, address);
                let index = each!((x, y) in [
                    (x.first, y.first),
                    (x.second, y.first),
                    (x.first, y.second),
                    (x.second, y.second),
                ] => self.index(x, y));
                Taps { index, right: x.weight, down: y.weight }
            }
        }
    }

    /// Red, green and blue from texels, in the numbers of the colour space.
    #[inline(always)]
    pub(super) fn read<S: Simd>(&self, simd: S, taps: &StoredTaps) -> [F32<S>; 3] {
        if self.sampler.filter == Filter::Point {
            let values = self.values(simd, self.fetch(simd, &taps.index[0]));
            return each!(channel in [0, 1, 2] => values[channel] * self.sampler.scale);
        }
        let (right, down) = (F32::load_array(simd, taps.right), F32::load_array(simd, taps.down));
        let one = F32::splat(simd, 1.0);
        let (left, up) = (one - right, one - down);
        let weights = [left * up, right * up, left * down, right * down];
        let texels = if self.wrapped.is_empty() {
            each!(tap in [0, 1, 2, 3] => self.fetch(simd, &taps.index[tap]))
        } else {
            let (a, b) = self.fetch_pairs(simd, &taps.index[0]);
            let (c, d) = self.fetch_pairs(simd, &taps.index[2]);
            [a, b, c, d]
        };
        let values = each!(tap in [0, 1, 2, 3] => self.values(simd, texels[tap]));
        each!(channel in [0, 1, 2] => {
            let sum = values[0][channel] * weights[0]
                + values[1][channel] * weights[1]
                + values[2][channel] * weights[2]
                + values[3][channel] * weights[3];
            sum * self.sampler.scale
        })
    }

    /// Eight texels and their neighbours to the right in a repeated texture.
    #[inline(always)]
    fn fetch_pairs<S: Simd>(&self, simd: S, index: &[u32; LANES]) -> (u32x8<S>, u32x8<S>) {
        let mut pairs = [0_u32; 2 * LANES];
        for lane in 0..LANES {
            let pair = self.wrapped.get(index[lane] as usize..).and_then(<[u32]>::first_chunk::<2>);
            // Every texel has a neighbour in memory.
            [pairs[2 * lane], pairs[2 * lane + 1]] = *pair.unwrap_or(&[0; 2]);
        }
        let (low, high) = pairs.split_at(LANES);
        u32x8::from_slice(simd, low).deinterleave(u32x8::from_slice(simd, high))
    }

    #[inline(always)]
    fn index<S: Simd>(&self, x: i32x8<S>, y: i32x8<S>) -> u32x8<S> {
        (y * self.stride + x).bitcast()
    }

    /// Eight texels, each packed into one number.
    #[inline(always)]
    fn fetch<S: Simd>(&self, simd: S, index: &[u32; LANES]) -> u32x8<S> {
        let mut texels = [0; LANES];
        for lane in 0..LANES {
            texels[lane] = u32::from_le_bytes(self.texels[index[lane] as usize]);
        }
        u32x8::load_array(simd, texels)
    }

    /// The numbers that texels are mixed in.
    #[inline(always)]
    fn values<S: Simd>(&self, simd: S, texels: u32x8<S>) -> [F32<S>; 3] {
        let codes = each!(shift in [0, 8, 16] => (texels >> shift) & 255);
        match self.space {
            ColorSpace::Bytes => {
                each!(c in [0, 1, 2] => codes[c].bitcast::<i32x8<S>>().to_float::<F32<S>>())
            }
            ColorSpace::Linear => {
                let table = &Tables::get().linear_of_code;
                each!(channel in [0, 1, 2] => {
                    let codes = codes[channel].to_array();
                    let mut values = [0.0; LANES];
                    for lane in 0..LANES {
                        values[lane] = table[usize::from(codes[lane] as u8)];
                    }
                    F32::load_array(simd, values)
                })
            }
        }
    }
}

#[inline(always)]
fn bring_into_unit<S: Simd>(simd: S, u: F32<S>, address: Address) -> F64<S> {
    let unit = match address {
        Address::Clamp => return widen(simd, u.max(0.0).min(1.0)),
        Address::Repeat => widen(simd, u) - widen(simd, u.floor()),
        Address::Mirror => {
            let period = widen(simd, u) - widen(simd, (u * 0.5).floor()) * 2.0;
            period.simd_gt(1.0).select(F64::splat(simd, 2.0) - period, period)
        }
    };
    unit.is_nan().select(F64::splat(simd, 0.0), unit)
}

#[inline(always)]
fn nearest<S: Simd>(simd: S, unit: F64<S>, size: u32) -> i32x8<S> {
    let place = (unit * f64::from(size)).trunc().min(f64::from(size - 1));
    narrow(simd, place).to_int()
}

#[inline(always)]
fn neighbours<S: Simd>(simd: S, u: F32<S>, size: u32, address: Address) -> Neighbours<S> {
    let (below, weight) = if address == Address::Repeat
        && size.is_power_of_two()
        && (u.simd_ge(0.0) & u.simd_lt(ALL_INTEGERS)).to_bitmask() == 0xFF
    {
        below_exact(u, size)
    } else {
        let position = bring_into_unit(simd, u, address) * f64::from(size) - 0.5;
        let below = position.floor();
        (narrow(simd, below), narrow(simd, position - below))
    };
    let below: i32x8<S> = below.to_int();
    let (first, second) = (below, below + 1);
    let last = size as i32 - 1;
    let (before, after) = match address {
        Address::Repeat => (last, 0),
        Address::Clamp | Address::Mirror => (0, last),
    };
    Neighbours {
        first: first.simd_lt(0).select(i32x8::splat(simd, before), first),
        second: second.simd_gt(last).select(i32x8::splat(simd, after), second),
        weight,
    }
}

/// From here on every float is a whole number.
const ALL_INTEGERS: f32 = 8_388_608.0;

/// The texel centre at or before a repeated coordinate, and the way from it, for coordinates that are not negative and a
/// size that is a power of two: then every step is exact in f32 but the last sum, which rounds what f64 rounds at its end.
#[inline(always)]
fn below_exact<S: Simd>(u: F32<S>, size: u32) -> (F32<S>, F32<S>) {
    let position = (u - u.floor()) * size as f32;
    let texel = position.floor();
    let within = position - texel;
    let second_half = within.simd_ge(0.5);
    (second_half.select(texel, texel - 1.0), second_half.select(within - 0.5, within + 0.5))
}
