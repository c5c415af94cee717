//! Blending of pixels with their neighbours across edges, sixteen pixels at a time.

use crate::image::color::Tables;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Areas that neighbours cover of a pixel, as fractions of the pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Covered {
    pub(super) left: f32,
    pub(super) right: f32,
    pub(super) above: f32,
    pub(super) below: f32,
}

/// Blends pixels of a picture into consecutive rows of its result. Pixels wait until there are sixteen of them.
pub(super) struct Blender<'a> {
    lanes: Lanes,
    picture: &'a Image<Rgba8>,
    /// Whether colours are blended in linear light rather than in sRGB codes.
    linear: bool,
    waiting: Group,
}

/// Pixels to blend together.
#[derive(Default)]
struct Group {
    /// Number of pixels. Lanes from here on hold pixels of an earlier group or the first pixel of the picture.
    count: usize,
    /// Indices of the pixels in the picture.
    indices: [usize; WIDE],
    left: [f32; WIDE],
    right: [f32; WIDE],
    above: [f32; WIDE],
    below: [f32; WIDE],
}

impl<'a> Blender<'a> {
    /// Returns a blender of a picture, which has at least one pixel.
    pub(super) fn new(lanes: Lanes, picture: &'a Image<Rgba8>, linear: bool) -> Self {
        Self { lanes, picture, linear, waiting: Group::default() }
    }

    /// Adds pixel number `index` of the picture. `result` starts at pixel number `first`.
    #[inline(always)]
    pub(super) fn add(&mut self, index: usize, covered: Covered, first: usize, result: &mut [Rgba8]) {
        let Covered { left, right, above, below } = covered;
        let lane = self.waiting.count;
        let group = &mut self.waiting;
        (group.indices[lane], group.left[lane], group.right[lane]) = (index, left, right);
        (group.above[lane], group.below[lane]) = (above, below);
        group.count += 1;
        if group.count == WIDE {
            self.finish(first, result);
        }
    }

    /// Blends the pixels that wait. `result` starts at pixel number `first`.
    #[inline(never)]
    pub(super) fn finish(&mut self, first: usize, result: &mut [Rgba8]) {
        let blended = on_lanes!(self.lanes, simd => self.waiting.blended(simd, self.picture, self.linear));
        for (index, pixel) in self.waiting.indices.iter().zip(blended).take(self.waiting.count) {
            result[index - first] = pixel.to_le_bytes();
        }
        self.waiting.count = 0;
    }
}

impl Group {
    /// Returns the pixels, as little-endian words, blended along the axis on which they are covered most.
    #[inline(always)]
    fn blended<S: Simd>(&self, simd: S, picture: &Image<Rgba8>, linear: bool) -> [u32; WIDE] {
        let zero = f32x16::splat(simd, 0.0);
        let areas = [&self.left, &self.right, &self.above, &self.below];
        let [left, right, above, below] = {
            let [left, right, above, below] = areas;
            each!(areas in [left, right, above, below] => f32x16::load_array(simd, *areas))
        };
        let is_across = left.max(right).simd_gt(above.max(below));
        let shares = [is_across.select(left, above), is_across.select(right, below)];
        let sum = shares[0] + shares[1];
        let weights = each!(share in [shares[0], shares[1]] => sum.simd_gt(zero).select(share * share / sum, zero));
        let [own, before, after] = {
            let words = self.words(picture, is_across.to_bitmask() as u32);
            each!(words in [words[0], words[1], words[2]] => u32x16::load_array(simd, words))
        };
        let tables = Tables::get();
        let values = if linear { &tables.linear_of_code } else { &tables.code };
        let alpha = own & 0xFF00_0000;
        let [own, before, after] = each!(words in [own, before, after] => values.of_pixels(simd, words));
        let blended = each!(channel in [0, 1, 2] => {
            let [own, before, after] = each!(values in [own, before, after] => values[channel]);
            own + ((before - own) * weights[0] + (after - own) * weights[1])
        });
        let codes = if linear {
            tables.encode_pixels(simd, blended)
        } else {
            let [r, g, b] = each!(channel in [0, 1, 2] => whole_part(blended[channel] + 0.5));
            r | g << 8 | b << 16
        };
        (alpha | codes).to_array()
    }

    /// Returns the pixels and their neighbours before and after them, as little-endian words. The neighbours are beside
    /// the pixel where `is_across` has a bit, else above and below it.
    #[inline(always)]
    fn words(&self, picture: &Image<Rgba8>, is_across: u32) -> [[u32; WIDE]; 3] {
        let (width, pixels) = (picture.width() as usize, picture.pixels());
        let mut words = [[0; WIDE]; 3];
        for (lane, index) in self.indices.into_iter().enumerate() {
            let step = if is_across >> lane & 1 != 0 { 1 } else { width };
            // Neighbours with a share exist: no edge separates the picture from its continuation.
            let [own, before, after] = [index, index.wrapping_sub(step), index + step]
                .map(|index| u32::from_le_bytes(pixels.get(index).copied().unwrap_or_default()));
            (words[0][lane], words[1][lane], words[2][lane]) = (own, before, after);
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blends a pixel in scalar code: the reference for the SIMD code.
    fn blended(picture: &Image<Rgba8>, linear: bool, index: usize, covered: Covered) -> Rgba8 {
        let Covered { left, right, above, below } = covered;
        let is_across = left.max(right) > above.max(below);
        let (step, shares) = if is_across { (1, [left, right]) } else { (picture.width(), [above, below]) };
        let sum = shares[0] + shares[1];
        let weights = shares.map(|share| if sum > 0.0 { share * share / sum } else { 0.0 });
        let tables = Tables::get();
        std::array::from_fn(|channel| {
            let value = |index: usize| {
                let code = picture.pixels()[index][channel];
                if linear { tables.linear_of_code.values[code as usize] } else { f32::from(code) }
            };
            let own = value(index);
            let [before, after] = [index - step as usize, index + step as usize].map(value);
            let blended = own + ((before - own) * weights[0] + (after - own) * weights[1]);
            match (channel, linear) {
                (3, _) => picture.pixels()[index][3],
                (_, true) => tables.encode(blended),
                (_, false) => (blended + 0.5) as u8,
            }
        })
    }

    #[test]
    fn groups_match_single_pixels() {
        let mut random = fastrand::Rng::with_seed(8);
        let picture = Image::from_fn(20, 9, |_, _| std::array::from_fn(|_| random.u8(..)));
        for (lanes, linear) in Lanes::all().flat_map(|lanes| [(lanes, false), (lanes, true)]) {
            // Rows 3 to 6, so that neighbours lie outside the result. Three groups, of which the last is not full.
            let mut result = picture.pixels()[60..140].to_vec();
            let mut blender = Blender::new(lanes, &picture, linear);
            let mut expected = result.clone();
            for index in (60..140).step_by(2).chain([61]) {
                let mut area = || [0.0, 0.5, random.f32()][random.usize(..3)];
                let covered = Covered { left: area(), right: area(), above: area(), below: area() };
                blender.add(index, covered, 60, &mut result);
                expected[index - 60] = blended(&picture, linear, index, covered);
            }
            blender.finish(60, &mut result);
            assert_eq!(result, expected, "{} {linear}", lanes.name());
        }
    }
}
