//! Resolve: averages the samples of each pixel, in linear light or in sRGB codes.

use rayon::prelude::*;

use crate::image::color::{CodeValues, Tables};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::settings::ColorSpace;
use crate::pipeline::tiled::{Picks, Sums};

/// Accumulator for the mean of the samples of every pixel. The order in which samples are added affects only the last
/// bits.
#[derive(Clone, Debug)]
pub(crate) struct Mean {
    size: (u32, u32),
    /// Sums of sixteen pixels each; empty until the first pictures are added.
    sums: Vec<Sums>,
    samples: u32,
    light: ColorSpace,
}

impl Mean {
    /// Returns an empty accumulator for a picture of `size` px.
    pub(crate) fn new(size: (u32, u32), light: ColorSpace) -> Self {
        Self { size, sums: Vec::new(), samples: 0, light }
    }

    /// Adds one sample for every pixel from each of the pictures. Several at once take less time, because the sums are
    /// read and written only once.
    pub(crate) fn add(&mut self, pictures: &[Image<Rgba8>]) {
        let pixels = self.size.0 as usize * self.size.1 as usize;
        self.sums.resize(pixels.div_ceil(WIDE), [[0.0; WIDE]; 3]);
        let (lanes, numbers) = (Lanes::best(), numbers(self.light));
        self.sums.par_chunks_mut(TOGETHER).enumerate().for_each(|(chunk, sums)| {
            on_lanes!(lanes, simd => {
                for (sixteen, sums) in (chunk * TOGETHER..).zip(sums) {
                    let before = loaded(simd, sums);
                    store(with_samples(simd, before, pictures, sixteen, numbers), sums);
                }
            });
        });
        self.samples += pictures.len() as u32;
    }

    /// Returns the number of samples added per pixel.
    pub(crate) fn samples(&self) -> u32 {
        self.samples
    }

    /// Returns the mean of every pixel in linear light. The accumulator must average linear light.
    pub(crate) fn linear(&self) -> Image<[f32; 3]> {
        assert_eq!(self.light, ColorSpace::Linear);
        let (width, height) = self.size;
        Image::from_fn(width, height, |x, y| {
            let pixel = y as usize * width as usize + x as usize;
            match self.sums.get(pixel / WIDE) {
                Some(sums) => [0, 1, 2].map(|channel| sums[channel][pixel % WIDE] / self.samples.max(1) as f32),
                None => [0.0; 3],
            }
        })
    }

    /// Returns the picture of the mean colours of the added samples and of one more from each of `last`, with opaque
    /// alpha. Reuses the buffer of `spare`.
    pub(crate) fn picture(&self, last: &[Image<Rgba8>], spare: Option<Image<Rgba8>>) -> Image<Rgba8> {
        let mut picture = Image::reusing(spare, self.size.0, self.size.1, [0; 4]);
        let (lanes, light, samples) = (Lanes::best(), self.light, self.samples + last.len() as u32);
        picture.pixels_mut().par_chunks_mut(TOGETHER * WIDE).enumerate().for_each(|(chunk, pixels)| {
            on_lanes!(lanes, simd => {
                for (sixteen, out) in (chunk * TOGETHER..).zip(pixels.chunks_mut(WIDE)) {
                    let before = self.sums.get(sixteen).unwrap_or(&[[0.0; WIDE]; 3]);
                    let sums = with_samples(simd, loaded(simd, before), last, sixteen, numbers(light));
                    store_in(out, &finished_lanes(simd, sums, samples, light));
                }
            });
        });
        picture
    }
}

/// Number of groups of sixteen pixels per parallel task: few enough for all threads to have work.
const TOGETHER: usize = 256;

/// Returns the sums of sixteen pixels plus one sample per pixel from each picture. `sixteen` is the index of the group.
#[inline(always)]
fn with_samples<S: Simd>(
    simd: S,
    mut sums: [f32x16<S>; 3],
    pictures: &[Image<Rgba8>],
    sixteen: usize,
    numbers: &CodeValues,
) -> [f32x16<S>; 3] {
    for picture in pictures {
        let pixels = picture.pixels();
        let own = sixteen * WIDE..((sixteen + 1) * WIDE).min(pixels.len());
        sums = added(simd, sums, padded(&pixels[own], [0; 4]), numbers);
    }
    sums
}

#[inline(always)]
fn loaded<S: Simd>(simd: S, sums: &Sums) -> [f32x16<S>; 3] {
    each!(channel in [0, 1, 2] => f32x16::load_array_ref(simd, &sums[channel]))
}

#[inline(always)]
fn store<S: Simd>(values: [f32x16<S>; 3], sums: &mut Sums) {
    for channel in 0..3 {
        values[channel].store_array(&mut sums[channel]);
    }
}

/// Returns the mean colour of one pixel's samples, equal to the result of [`Mean`].
pub(crate) fn mean(samples: &[Rgba8], light: ColorSpace) -> Rgba8 {
    let (mut sum, numbers) = ([0.0; 3], numbers(light));
    samples.iter().for_each(|color| add(&mut sum, *color, numbers));
    finished(sum, samples.len() as u32, light)
}

/// Computes the mean colours of pixels with SIMD, sixteen pixels at a time. The results equal those of [`mean`].
/// `picks` holds indices into `colors`: for each group of sixteen pixels, one [`Picks`] per sample.
pub(crate) fn means(lanes: Lanes, colors: &[Rgba8], picks: &[Picks], light: ColorSpace, out: &mut [Rgba8]) {
    let sixteens = out.len().div_ceil(WIDE);
    if sixteens == 0 {
        return;
    }
    let samples = picks.len() / sixteens;
    for (out, picks) in out.chunks_mut(WIDE).zip(picks.chunks(samples)) {
        let means = on_lanes!(lanes, simd => means_of_sixteen(simd, colors, picks, light));
        out.copy_from_slice(&means[..out.len()]);
    }
}

#[inline(always)]
fn means_of_sixteen<S: Simd>(simd: S, colors: &[Rgba8], picks: &[Picks], light: ColorSpace) -> [Rgba8; WIDE] {
    let (mut sums, numbers) = ([f32x16::splat(simd, 0.0); 3], numbers(light));
    for picks in picks {
        let mut sampled = [[0; 4]; WIDE];
        for (color, pick) in sampled.iter_mut().zip(picks) {
            *color = colors[*pick as usize];
        }
        sums = added(simd, sums, sampled, numbers);
    }
    finished_lanes(simd, sums, picks.len() as u32, light)
}

/// Adds one sample per pixel to `sums` with SIMD. Each element of `sums` holds the sums of sixteen pixels. After the
/// last sample, [`means_of_sums`] gives the same colours as [`mean`].
pub(crate) fn add_samples(lanes: Lanes, colors: &[Rgba8], light: ColorSpace, sums: &mut [Sums]) {
    on_lanes!(lanes, simd => {
        for (colors, sums) in colors.chunks(WIDE).zip(sums) {
            store(added(simd, loaded(simd, sums), padded(colors, [0; 4]), numbers(light)), sums);
        }
    });
}

/// Computes the mean colours of pixels with SIMD, from sums of `samples` samples each. The results equal those of
/// [`mean`].
pub(crate) fn means_of_sums(lanes: Lanes, sums: &[Sums], samples: u32, light: ColorSpace, out: &mut [Rgba8]) {
    on_lanes!(lanes, simd => {
        for (out, sums) in out.chunks_mut(WIDE).zip(sums) {
            store_in(out, &finished_lanes(simd, loaded(simd, sums), samples, light));
        }
    });
}

/// Adds one sample per pixel to the sums of sixteen pixels. [`add`] does the same for one pixel.
#[inline(always)]
fn added<S: Simd>(simd: S, sums: [f32x16<S>; 3], colors: [Rgba8; WIDE], numbers: &CodeValues) -> [f32x16<S>; 3] {
    let words = u8x64::from_slice(simd, colors.as_flattened()).bitcast::<u32x16<S>>();
    let values = numbers.of_pixels(simd, words);
    each!(channel in [0, 1, 2] => sums[channel] + values[channel])
}

/// Returns the mean colours of sixteen pixels from their sums. [`finished`] does the same for one pixel.
#[inline(always)]
fn finished_lanes<S: Simd>(simd: S, sums: [f32x16<S>; 3], samples: u32, light: ColorSpace) -> [Rgba8; WIDE] {
    let mean = each!(channel in [0, 1, 2] => sums[channel] / samples.max(1) as f32);
    let codes = match light {
        ColorSpace::Linear => Tables::get().encode_pixels(simd, mean),
        ColorSpace::Bytes => {
            let [r, g, b] = each!(channel in [0, 1, 2] => whole_part(mean[channel] + 0.5));
            r | g << 8 | b << 16
        }
    };
    (codes | 0xFF00_0000).to_array().map(u32::to_le_bytes)
}

fn numbers(light: ColorSpace) -> &'static CodeValues {
    match light {
        ColorSpace::Linear => &Tables::get().linear_of_code,
        ColorSpace::Bytes => &Tables::get().code,
    }
}

fn add(sum: &mut [f32; 3], color: Rgba8, numbers: &CodeValues) {
    for (sum, code) in sum.iter_mut().zip(color) {
        *sum += numbers.values[code as usize];
    }
}

fn finished(sum: [f32; 3], samples: u32, light: ColorSpace) -> Rgba8 {
    let [r, g, b] = sum.map(|sum| {
        let mean = sum / samples.max(1) as f32;
        match light {
            ColorSpace::Linear => Tables::get().encode(mean),
            ColorSpace::Bytes => (mean + 0.5) as u8,
        }
    });
    [r, g, b, 255]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antialias::settings::SampleCount;
    use crate::pipeline::settings::Choice as _;

    #[test]
    fn equal_samples_stay_as_they_are() {
        for (light, samples) in
            ColorSpace::ALL.iter().flat_map(|light| SampleCount::ALL.iter().map(move |s| (*light, *s)))
        {
            for code in 0..=255 {
                let color = [code, 255 - code, 7, 255];
                assert_eq!(mean(&vec![color; samples.count() as usize], light), color, "{samples:?} {light:?}");
            }
        }
    }

    #[test]
    fn sixteen_means_at_a_time_are_those_one_by_one() {
        let mut random = fastrand::Rng::with_seed(12);
        let colors: Vec<Rgba8> = (0..300).map(|_| [random.u8(..), random.u8(..), random.u8(..), 255]).collect();
        for (light, pixels) in
            ColorSpace::ALL.iter().flat_map(|light| [0_usize, 1, 16, 37].map(|pixels| (*light, pixels)))
        {
            for samples in [1, 4, 16, 64] {
                let picks: Vec<Picks> = (0..samples * pixels.div_ceil(WIDE))
                    .map(|_| std::array::from_fn(|_| random.u32(0..colors.len() as u32)))
                    .collect();
                let of_pixel = |pixel: usize| -> Vec<Rgba8> {
                    let picks = picks[pixel / WIDE * samples..][..samples].iter();
                    picks.map(|picks| colors[picks[pixel % WIDE] as usize]).collect()
                };
                let expected: Vec<Rgba8> = (0..pixels).map(|pixel| mean(&of_pixel(pixel), light)).collect();
                for lanes in Lanes::all() {
                    let mut found = vec![[0; 4]; pixels];
                    means(lanes, &colors, &picks, light, &mut found);
                    assert_eq!(found, expected, "{} {light:?} {samples}", lanes.name());
                }
            }
        }
    }

    #[test]
    fn sums_of_sixteen_become_the_means_of_their_pixels() {
        let mut random = fastrand::Rng::with_seed(13);
        for (light, pixels, samples) in ColorSpace::ALL.iter().flat_map(|light| {
            [(0_usize, 4), (1, 256), (16, 16), (37, 64)].map(|(pixels, samples)| (*light, pixels, samples))
        }) {
            let drawn: Vec<Vec<Rgba8>> = (0..samples)
                .map(|_| (0..pixels).map(|_| [random.u8(..), random.u8(..), random.u8(..), 255]).collect())
                .collect();
            let of_pixel = |pixel: usize| -> Vec<Rgba8> { drawn.iter().map(|sample| sample[pixel]).collect() };
            let expected: Vec<Rgba8> = (0..pixels).map(|pixel| mean(&of_pixel(pixel), light)).collect();
            for lanes in Lanes::all() {
                let mut sums: Vec<Sums> = vec![[[0.0; WIDE]; 3]; pixels.div_ceil(WIDE)];
                drawn.iter().for_each(|sample| add_samples(lanes, sample, light, &mut sums));
                let mut found = vec![[0; 4]; pixels];
                means_of_sums(lanes, &sums, samples, light, &mut found);
                assert_eq!(found, expected, "{} {light:?} {samples}", lanes.name());
            }
        }
    }

    #[test]
    fn half_black_half_white_is_half_the_light_or_half_the_code() {
        let samples = [[0, 0, 0, 255], [255; 4]];
        assert_eq!(mean(&samples, ColorSpace::Linear), [188, 188, 188, 255]);
        assert_eq!(mean(&samples, ColorSpace::Bytes), [128, 128, 128, 255]);
    }

    #[test]
    fn a_picture_is_the_mean_of_each_pixel() {
        let mut random = fastrand::Rng::with_seed(3);
        let size = (97, 53);
        let pictures: Vec<_> =
            (0..5).map(|_| Image::from_fn(size.0, size.1, |_, _| [random.u8(..), random.u8(..), 1, 255])).collect();
        for (light, added) in ColorSpace::ALL.iter().flat_map(|light| [0, 1, 4, 5].map(|added| (*light, added))) {
            let mut all = Mean::new(size, light);
            all.add(&pictures[..added / 2]);
            all.add(&pictures[added / 2..added]);
            let picture = all.picture(&pictures[added..], None);
            for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
                let samples: Vec<_> = pictures.iter().map(|picture| picture.at(x, y)).collect();
                assert_eq!(picture.at(x, y), mean(&samples, light));
            }
        }
    }
}
