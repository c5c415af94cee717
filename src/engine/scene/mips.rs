//! Mip levels: each has half the side lengths of the previous one (rounded down, at least 1), until one texel remains
//! (Williams, "Pyramidal Parametrics", 1983).
//!
//! Every texel of a level is the mean of the area that it covers in the previous level. If a side is odd, the border of
//! that area cuts through texels of the previous level. Such a texel is weighted by the fraction of it that lies
//! inside. Each level is computed from the unrounded values of the previous one. Colours are weighted by alpha, so
//! invisible texels do not tint visible ones. Below full size, texels with alpha 0 take the colour of the next smaller
//! level, so that filtering does not blend in the colours of invisible texels (the push phase of Gortler et al., "The
//! Lumigraph", 1996).

use crate::image::color::{Tables, quantize};
use crate::image::{Image, Rgba8};

/// Offsets of the mip levels of a texture in a shared array of texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MipOffsets {
    /// Index of the first texel of each level, from largest to smallest. Entries from `count` on repeat the last level.
    pub(crate) first: [u32; 32],
    /// Number of levels, from 1 to 31.
    pub(crate) count: u32,
}

impl MipOffsets {
    /// Offset of a single level.
    pub(crate) const SINGLE: Self = Self { first: [0; 32], count: 1 };
}

/// Texels of all mip levels of a texture in one array.
///
/// The full-size level is at the top, with the first smaller level below it. The other levels are stacked beside the
/// first smaller level if there is room, or else below it. All rows have the same stride. Each row ends with a copy of
/// its first texel, and each level with a copy of its first row.
#[derive(Clone, Debug)]
pub(crate) struct Levels<T> {
    /// Texels, including unused gaps between the levels.
    pub(crate) texels: Box<[T]>,
    /// Offsets of the levels in the texels.
    pub(crate) offsets: MipOffsets,
}

impl<T: Copy + Default> Levels<T> {
    /// Creates the levels from images, ordered from largest to smallest. `value` converts each texel.
    pub(super) fn new<'a>(images: impl Iterator<Item = &'a Image<Rgba8>>, value: impl Fn(Rgba8) -> T) -> Self {
        let images: Vec<_> = images.collect();
        let sizes: Vec<_> =
            images.iter().map(|image| [image.width() as usize + 1, image.height() as usize + 1]).collect();
        let corners = level_origins(&sizes);
        let stride = sizes[0][0];
        let rows = corners.iter().zip(&sizes).map(|([_, row], [_, height])| row + height).max().unwrap_or(0);
        let mut texels = vec![T::default(); rows * stride].into_boxed_slice();
        for ((image, [column, row]), [width, height]) in images.iter().zip(&corners).zip(&sizes) {
            let mut values = with_wrapped_border(image, &value);
            for row in texels.chunks_exact_mut(stride).skip(*row).take(*height) {
                for (texel, value) in row[*column..column + width].iter_mut().zip(&mut values) {
                    *texel = value;
                }
            }
        }
        let offset = |[column, row]: [usize; 2]| (row * stride + column) as u32;
        // Sides are below 2³¹ texels, so there are at most 31 levels, and the last entry always repeats the smallest one.
        let smallest = corners.len() - 1;
        let first = std::array::from_fn(|level| offset(corners[level.min(smallest)]));
        Self { texels, offsets: MipOffsets { first, count: corners.len() as u32 } }
    }

    /// Returns the heap memory used by the levels, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.texels)
    }
}

/// Returns the column and row of each level's first texel in the array. `sizes` holds the width and height of each
/// level, including the copies at its borders.
fn level_origins(sizes: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let [across, first, second] = [0, 1, 2].map(|level| sizes.get(level).map_or(0, |[width, _]| *width));
    let has_room = first + second <= across;
    let (mut column, mut row) = (0, 0);
    let corner = |(level, [width, height]): (usize, &[usize; 2])| {
        if level == 2 && has_room {
            (column, row) = (across - width, sizes[0][1]);
        }
        let corner = [column, row];
        row += height;
        corner
    };
    sizes.iter().enumerate().map(corner).collect()
}

/// Returns the texels of an image, converted by `value`. Each row is followed by its first texel, and the last row by
/// the first row.
pub(super) fn with_wrapped_border<T>(image: &Image<Rgba8>, value: impl Fn(Rgba8) -> T) -> impl Iterator<Item = T> {
    let rows = (0..image.height()).chain([0]).map(|y| image.row(y));
    rows.flat_map(|row| row.iter().chain(row.first())).map(move |texel| value(*texel))
}

/// Premultiplied colour and alpha of a texel, each in [0, 1].
type Texel = [f32; 4];

/// Computes the mip levels below the full-size image, from largest to smallest; none for a single texel. Averages
/// linear light if `linear` is `true`, otherwise sRGB codes.
pub(super) fn mip_levels(image: &Image<Rgba8>, linear: bool) -> Vec<Image<Rgba8>> {
    let tables = Tables::get();
    let value = |code: u8| if linear { tables.linear_of_code.values[code as usize] } else { f32::from(code) / 255.0 };
    let mut last = image.map(|[r, g, b, a]| {
        let alpha = f32::from(a) / 255.0;
        [value(r) * alpha, value(g) * alpha, value(b) * alpha, alpha]
    });
    let encode = |value: f32| if linear { tables.encode(value) } else { quantize(value) };
    let mut means = Vec::new();
    while last.width() > 1 || last.height() > 1 {
        last = halved(&last);
        means.push(last.clone());
    }
    // The smallest level comes first, because texels with alpha 0 take the colour of the next smaller level.
    let mut colors: Option<Image<[f32; 3]>> = None;
    let mut copies: Vec<_> = means
        .iter()
        .rev()
        .map(|mean| {
            let color = Image::from_fn(mean.width(), mean.height(), |x, y| {
                let [r, g, b, alpha] = mean.at(x, y);
                if alpha > 0.0 {
                    return [r / alpha, g / alpha, b / alpha];
                }
                let below = |at: u32, to: u32, from: u32| (at * to / from).min(to - 1);
                colors.as_ref().map_or([0.0; 3], |smaller| {
                    smaller.at(below(x, smaller.width(), mean.width()), below(y, smaller.height(), mean.height()))
                })
            });
            let copy = Image::from_fn(mean.width(), mean.height(), |x, y| {
                let ([r, g, b], [_, _, _, alpha]) = (color.at(x, y), mean.at(x, y));
                [encode(r), encode(g), encode(b), quantize(alpha)]
            });
            colors = Some(color);
            copy
        })
        .collect();
    copies.reverse();
    copies
}

fn halved(image: &Image<Texel>) -> Image<Texel> {
    let (width, height) = (half(image.width()), half(image.height()));
    Image::from_fn(width, height, |x, y| {
        let mut sum = [0.0; 4];
        for (row, down) in covered(y, height, image.height()) {
            for (column, across) in covered(x, width, image.width()) {
                for (sum, value) in sum.iter_mut().zip(image.at(column, row)) {
                    *sum += value * across * down;
                }
            }
        }
        sum
    })
}

fn half(length: u32) -> u32 {
    (length / 2).max(1)
}

/// Returns the index and the weight of each source texel that the reduced texel `at` covers along one axis. Along this
/// axis, `from` source texels are reduced to `to` texels.
fn covered(at: u32, to: u32, from: u32) -> impl Iterator<Item = (u32, f32)> {
    let edge = |at: u32| f64::from(at) * f64::from(from) / f64::from(to);
    let (start, end) = (edge(at), edge(at + 1));
    (start as u32..end.ceil() as u32).map(move |texel| {
        let inside = end.min(f64::from(texel) + 1.0) - start.max(f64::from(texel));
        (texel, (inside / (end - start)) as f32)
    })
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use num_traits::{Signed as _, ToPrimitive as _, Zero as _};

    use super::*;

    #[test]
    fn sides_are_halved_down_to_one_texel() {
        let sizes = |width, height| -> Vec<_> {
            mip_levels(&Image::filled(width, height, [9; 4]), true).iter().map(Image::size).collect()
        };
        assert_eq!(sizes(8, 4), [(4, 2), (2, 1), (1, 1)]);
        assert_eq!(sizes(5, 7), [(2, 3), (1, 1)]);
        assert_eq!(sizes(1, 1), []);
    }

    #[test]
    fn plain_textures_stay_plain_and_the_mean_is_kept() {
        let mut random = fastrand::Rng::with_seed(8);
        for (width, height) in [(16, 16), (5, 7), (1, 9), (12, 3)] {
            let plain = Image::filled(width, height, [7, 130, 255, 255]);
            for linear in [false, true] {
                assert!(
                    mip_levels(&plain, linear).iter().all(|copy| copy.pixels().iter().all(|t| *t == plain.at(0, 0)))
                );
            }
            let noise = Image::from_fn(width, height, |_, _| [random.u8(..), 0, 0, 255]);
            let mean = noise.pixels().iter().map(|t| f64::from(t[0])).sum::<f64>() / f64::from(width * height);
            let last = mip_levels(&noise, false).pop().unwrap();
            assert!((f64::from(last.at(0, 0)[0]) - mean).abs() <= 0.51, "{width} × {height}: {mean}");
        }
    }

    #[test]
    fn a_chessboard_averages_to_half_the_light_or_half_the_code() {
        let board = Image::from_fn(4, 4, |x, y| if (x + y) % 2 == 0 { [0, 0, 0, 255] } else { [255; 4] });
        assert_eq!(mip_levels(&board, true)[0].at(1, 1), [188, 188, 188, 255]);
        assert_eq!(mip_levels(&board, false)[0].at(1, 1), [128, 128, 128, 255]);
    }

    #[test]
    fn invisible_texels_do_not_tint_visible_ones() {
        let leaf = Image::from_fn(2, 2, |x, _| if x == 0 { [0, 200, 0, 255] } else { [255, 0, 255, 0] });
        assert_eq!(mip_levels(&leaf, true)[0].at(0, 0), [0, 200, 0, 128]);
    }

    fn ratio(above: u32, below: u32) -> BigRational {
        BigRational::new(above.into(), below.into())
    }

    /// Mip level in exact rational numbers: premultiplied colour and alpha of each texel, row by row.
    struct ExactLevel {
        width: u32,
        height: u32,
        texels: Vec<[BigRational; 4]>,
    }

    impl ExactLevel {
        fn of(image: &Image<Rgba8>, value: impl Fn(u8) -> BigRational) -> Self {
            let texel = |[r, g, b, a]: &Rgba8| {
                let alpha = ratio((*a).into(), 255);
                [value(*r) * &alpha, value(*g) * &alpha, value(*b) * &alpha, alpha]
            };
            Self { width: image.width(), height: image.height(), texels: image.pixels().iter().map(texel).collect() }
        }

        fn at(&self, x: u32, y: u32) -> &[BigRational; 4] {
            &self.texels[(y * self.width + x) as usize]
        }

        /// Returns the next smaller level, with half the side lengths: each texel is the mean over the area that it
        /// covers.
        fn halved(&self) -> Self {
            let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
            // In units of 1 / `to` of a source texel, all edges are integers.
            let overlap = |at: u32, to: u32, from: u32, texel: u32| {
                let (start, end) = ((at * from).max(texel * to), ((at + 1) * from).min((texel + 1) * to));
                ratio(end.saturating_sub(start), from)
            };
            let mut texels = Vec::new();
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let mut sum: [BigRational; 4] = std::array::from_fn(|_| BigRational::zero());
                for (column, row) in (0..self.height).flat_map(|row| (0..self.width).map(move |column| (column, row))) {
                    let share = overlap(x, width, self.width, column) * overlap(y, height, self.height, row);
                    for (sum, value) in sum.iter_mut().zip(self.at(column, row)) {
                        *sum += value * &share;
                    }
                }
                texels.push(sum);
            }
            Self { width, height, texels }
        }
    }

    /// Asserts that a code matches the exact value up to rounding errors of f32. `code_of` converts a value to its code
    /// and must be monotonic.
    fn check(code: u8, exact: &BigRational, code_of: &dyn Fn(f32) -> u8, place: &str) {
        let value = exact.to_f64().unwrap();
        let slack = 4e-7 + 4e-6 * value;
        let (least, most) = (code_of((value - slack) as f32), code_of((value + slack) as f32));
        assert!(least <= code && code <= most, "{place}: {code} for {value}, {least} to {most}");
    }

    #[test]
    fn every_texel_is_the_exact_mean_of_the_visible_texels_below_it() {
        let mut random = fastrand::Rng::with_seed(31);
        for (width, height) in [(8, 8), (7, 5), (1, 6), (9, 2), (3, 3)] {
            for (linear, density) in [(false, 0), (false, 2), (true, 1), (true, 3)] {
                // Many texels have alpha 0; their colours must not appear in any level.
                let image = Image::from_fn(width, height, |_, _| {
                    let alpha = if random.u8(0..4) < density { 0 } else { random.u8(..) };
                    [random.u8(..), random.u8(..), random.u8(..), alpha]
                });
                let tables = Tables::get();
                let value = |code: u8| {
                    if linear {
                        BigRational::from_float(tables.linear_of_code.values[code as usize]).unwrap()
                    } else {
                        ratio(code.into(), 255)
                    }
                };
                let encode = |value: f32| if linear { tables.encode(value) } else { quantize(value) };
                let mut levels = vec![ExactLevel::of(&image, value)];
                for _ in mip_levels(&image, linear) {
                    levels.push(levels[levels.len() - 1].halved());
                }
                let below = |at: u32, from: u32, to: u32| (at * to / from).min(to - 1);
                for (number, copy) in mip_levels(&image, linear).iter().enumerate() {
                    for (x, y) in (0..copy.height()).flat_map(|y| (0..copy.width()).map(move |x| (x, y))) {
                        let (mut level, mut at) = (number + 1, (x, y));
                        let place = format!("{width} × {height}, linear {linear}, level {level}, {at:?}");
                        check(copy.at(x, y)[3], &levels[level].at(x, y)[3], &quantize, &place);
                        // A texel with alpha 0 takes its colour from the first smaller level whose texel at this
                        // position has alpha > 0.
                        while level + 1 < levels.len() && !levels[level].at(at.0, at.1)[3].is_positive() {
                            let (own, next) = (&levels[level], &levels[level + 1]);
                            at = (below(at.0, own.width, next.width), below(at.1, own.height, next.height));
                            level += 1;
                        }
                        let [colors @ .., alpha] = levels[level].at(at.0, at.1);
                        for (code, color) in copy.at(x, y).iter().zip(colors) {
                            let exact =
                                if alpha.is_positive() { color / alpha } else { BigRational::from(BigInt::ZERO) };
                            check(*code, &exact, &encode, &place);
                        }
                    }
                }
            }
        }
    }
}
