//! FXAA-class post filter: smooths the edges of a finished picture.
//!
//! After T. Lottes, "FXAA" (NVIDIA, 2009) and the white paper of FXAA 3.11. Contrast is measured in 8-bit luma of sRGB
//! codes, as FXAA 3.11 stores it in the alpha channel. Where the contrast is large enough:
//!
//! 1. second differences of luma decide whether the edge is horizontal or vertical, and first differences decide which
//!    neighbour lies across it;
//! 2. the boundary between the pixel and that neighbour is followed in both directions until the luma along it changes;
//! 3. a straight line between the two endpoints cuts into the pixels on one side of the edge: each of them is blended
//!    with its neighbour across the edge, weighted by the fraction of the pixel that the line cuts off;
//! 4. the blend weight is at least a minimum that grows with the difference between a pixel and its eight neighbours.

mod edges;

use std::cell::RefCell;

use rayon::prelude::*;

use self::edges::Neighbourhood;
use super::luma::{BLOCK, fill_luma};
use crate::image::color::{CodeValues, Tables};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Minimum contrast for an edge, in 8-bit luma codes. Contrast is the difference between the brightest and the darkest
/// luma of a pixel and its four neighbours.
const MIN_CONTRAST: i16 = 8;

/// Minimum contrast for an edge as a fraction of the brightest luma around the pixel, given as a right shift: 3 means
/// 2⁻³.
const MIN_CONTRAST_SHIFT: u32 = 3;

/// Maximum blend weight. An isolated pixel reaches it, such as a white pixel on a black background.
const SUBPIXEL: f32 = 0.75;

/// Minimum blend weight. Pixels with a smaller weight stay unchanged. At 1920 × 1080 px, 20 % of the edge pixels have a
/// smaller weight in the scene `chess`, and 46 % in `stained-glass`.
const MIN_SHARE: f32 = 1.0 / 256.0;

/// Maximum distance, in pixels, over which an edge is followed in each direction from a pixel. The edge ends where the
/// mean luma of the two pixels on both sides of it has changed by a quarter of the luma difference across the edge.
pub(crate) const SEARCH_PX: u32 = 16;

/// Number of additional rows and columns of luma on each side of a band of rows. The edge search reads luma up to this
/// distance from a pixel.
const MARGIN: usize = SEARCH_PX as usize;

/// Number of bands of rows per thread. It is small, because each band computes the luma of [`MARGIN`] rows above and
/// below it, which the adjacent bands compute, too.
const BANDS_PER_THREAD: usize = 4;

thread_local! {
    /// Buffer for the luma of a band of rows. Reusing the buffer for the next picture avoids page faults.
    static LUMA: RefCell<Vec<i16>> = RefCell::default();
}

/// Filters a picture, blending in linear light if `linear` is `true`, else in sRGB codes. Reuses `memory` for the
/// result.
pub(crate) fn apply(picture: &Image<Rgba8>, linear: bool, memory: Option<Image<Rgba8>>) -> Image<Rgba8> {
    apply_on(Lanes::best(), picture, linear, memory)
}

fn apply_on(lanes: Lanes, picture: &Image<Rgba8>, linear: bool, memory: Option<Image<Rgba8>>) -> Image<Rgba8> {
    let (width, height) = picture.size();
    let mut result = Image::reusing(memory, width, height, [0; 4]);
    let rows = (height as usize).div_ceil(BANDS_PER_THREAD * rayon::current_num_threads()).max(1);
    let bands = result.pixels_mut().par_chunks_mut((width as usize * rows).max(1));
    bands.enumerate().for_each(|(index, band)| {
        LUMA.with_borrow_mut(
            |luma| on_lanes!(lanes, simd => fill_band(simd, FxaaInput { picture, linear }, luma, index * rows, band)),
        );
    });
    result
}

/// Picture to filter, and the colour space for blending.
#[derive(Clone, Copy)]
struct FxaaInput<'a> {
    picture: &'a Image<Rgba8>,
    /// Whether colours are blended in linear light rather than in sRGB codes.
    linear: bool,
}

/// Filters the rows of `band`, which starts at row `first` of the picture. Computes luma only [`MARGIN`] rows ahead of
/// the row that is being filtered, so all rows in use stay in the L2 cache.
#[inline(always)]
fn fill_band<S: Simd>(simd: S, source: FxaaInput<'_>, luma: &mut Vec<i16>, first: usize, band: &mut [Rgba8]) {
    let picture = source.picture;
    let (width, last) = (picture.width() as usize, picture.height() as usize - 1);
    let stride = width.next_multiple_of(BLOCK) + 2 * MARGIN;
    luma.resize((band.len() / width + 2 * MARGIN) * stride, 0);
    let row_at = |row: usize| picture.row((first + row).saturating_sub(MARGIN).min(last) as u32);
    for (row, luma) in luma.chunks_exact_mut(stride).take(2 * MARGIN).enumerate() {
        fill_luma(simd, row_at(row), MARGIN, luma);
    }
    for (row, result) in band.chunks_exact_mut(width).enumerate() {
        let ahead = row + 2 * MARGIN;
        fill_luma(simd, row_at(ahead), MARGIN, &mut luma[ahead * stride..][..stride]);
        result.copy_from_slice(picture.row((first + row) as u32));
        let edges = Neighbourhood { luma, stride, place: (row + MARGIN) * stride + MARGIN };
        filter_row(simd, source, &edges, (first + row) * width, result);
    }
}

/// Filters one row in place. On entry, `row` holds the unfiltered pixels; `start` is the index, in the picture, of the
/// first of these pixels.
#[inline(always)]
fn filter_row<S: Simd>(
    simd: S,
    FxaaInput { picture, linear }: FxaaInput<'_>,
    row_luma: &Neighbourhood<'_>,
    start: usize,
    row: &mut [Rgba8],
) {
    let (tables, width) = (Tables::get(), row.len());
    for (x, block) in (0..).step_by(BLOCK).zip(row.chunks_mut(BLOCK)) {
        let luma = Neighbourhood { place: row_luma.place + x, ..*row_luma };
        let within = mask16x32::from_bitmask(simd, (1 << block.len()) - 1);
        let found = luma.contrasts(simd) & within;
        if !found.any_true() {
            continue;
        }
        let blends = luma.blends(simd, found);
        let mut left = blends.found;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let across = if blends.horizontal >> lane & 1 != 0 { width } else { 1 };
            let own = start + x + lane;
            // `other` never lies outside the picture: the margins repeat the border pixels, so the gradient across the
            // border is 0, and pixels with gradient 0 are not in `blends.found`.
            let other = if blends.towards_before >> lane & 1 != 0 { own - across } else { own + across };
            block[lane] = mix(tables, block[lane], picture.pixels()[other], blends.shares[lane], linear);
        }
    }
}

/// Returns `own` · (1 − `share`) + `other` · `share` with the alpha of `own`, computed in linear light if `linear` is
/// `true`, else in sRGB codes.
#[inline(always)]
fn mix(tables: &Tables, own: Rgba8, other: Rgba8, share: f32, linear: bool) -> Rgba8 {
    let mut result = own;
    for ((code, own), other) in result.iter_mut().zip(own).zip(other).take(3) {
        let between = |values: &CodeValues| {
            let (own, other) = (values.values[own as usize], values.values[other as usize]);
            own + (other - own) * share
        };
        *code =
            if linear { tables.encode(between(&tables.linear_of_code)) } else { (between(&tables.code) + 0.5) as u8 };
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luma([r, g, b, _]: Rgba8) -> i32 {
        (54 * i32::from(r) + 183 * i32::from(g) + 19 * i32::from(b) + 128) / 256
    }

    /// Filters one pixel in scalar code: the reference for the SIMD code.
    fn filtered(picture: &Image<Rgba8>, lumas: &Image<i32>, at: (i64, i64), linear: bool) -> Rgba8 {
        let own = picture.at_clamped(at.0, at.1);
        match blend(lumas, at) {
            Some(([dx, dy], share)) if share >= MIN_SHARE => {
                mix(Tables::get(), own, picture.at_clamped(at.0 + dx, at.1 + dy), share, linear)
            }
            _ => own,
        }
    }

    /// Returns the offset of the neighbour that a pixel is blended with, and the blend weight; `None` if there is no
    /// edge.
    fn blend(lumas: &Image<i32>, (x, y): (i64, i64)) -> Option<([i64; 2], f32)> {
        let at = |dx: i64, dy: i64| lumas.at_clamped(x + dx, y + dy);
        let (middle, [n, s, w, e]) = (at(0, 0), [at(0, -1), at(0, 1), at(-1, 0), at(1, 0)]);
        let brightest = n.max(s).max(w).max(e).max(middle);
        let contrast = brightest - n.min(s).min(w).min(e).min(middle);
        if contrast < 8 || contrast * 8 < brightest {
            return None;
        }
        let [nw, ne, sw, se] = [at(-1, -1), at(1, -1), at(-1, 1), at(1, 1)];
        let bend = |before: i32, own: i32, after: i32| (before - 2 * own + after).abs();
        let along_row = 2 * bend(n, middle, s) + bend(nw, w, sw) + bend(ne, e, se);
        let along_column = 2 * bend(w, middle, e) + bend(nw, n, ne) + bend(sw, s, se);
        let is_level = along_row >= along_column;

        let (before, after) = if is_level { (n, s) } else { (w, e) };
        let towards_before = (before - middle).abs() >= (after - middle).abs();
        let (beyond, side) = if towards_before { (before, -1) } else { (after, 1) };
        let gradient = (beyond - middle).abs();
        if gradient == 0 {
            return None;
        }
        let (across, along) = if is_level { ([0, side], [1, 0]) } else { ([side, 0], [0, 1]) };

        let on_edge = |step: i64| {
            let (px, py) = (along[0] * step, along[1] * step);
            at(px, py) + at(px + across[0], py + across[1]) - middle - beyond
        };
        let end = |direction: i64| {
            let ends = |step: &i64| 2 * on_edge(direction * step).abs() >= gradient;
            let step = (1..=i64::from(SEARCH_PX)).find(ends).unwrap_or(i64::from(SEARCH_PX));
            (step as f32, on_edge(direction * step))
        };
        let (back, ahead) = (end(-1), end(1));
        let nearest = if back.0 <= ahead.0 { back } else { ahead };
        // The line cuts into this pixel if, at the nearer endpoint, the luma changes towards that of `beyond`.
        let cuts_in = (nearest.1 < 0) != (middle < beyond);
        let of_line = if cuts_in { (ahead.0 - back.0).abs() / 2.0 / (back.0 + ahead.0) } else { 0.0 };

        let difference = (2 * (n + s + w + e) + nw + ne + sw + se - 12 * middle).abs();
        let stands_out = (difference as f32 / (12 * contrast) as f32).min(1.0);
        let smooth = stands_out * stands_out * (3.0 - 2.0 * stands_out);
        Some((across, of_line.max(smooth * smooth * SUBPIXEL)))
    }

    /// Returns a picture that is black above the line y = slope · x + 6, in pixels, and white below. A pixel has the
    /// colour of its centre or, if `by_area` is `true`, the mean over its area.
    fn slanted(slope: f32, by_area: bool) -> Image<Rgba8> {
        Image::from_fn(48, 24, |x, y| {
            let inside = y as f32 + 0.5 - (slope * (x as f32 + 0.5) + 6.0);
            let share = if by_area { (inside + 0.5).clamp(0.0, 1.0) } else { f32::from(u8::from(inside > 0.0)) };
            let code = (share * 255.0).round() as u8;
            [code, code, code, 255]
        })
    }

    fn error(a: &Image<Rgba8>, b: &Image<Rgba8>) -> f64 {
        let pairs = a.pixels().iter().zip(b.pixels());
        pairs.map(|(a, b)| (f64::from(a[0]) - f64::from(b[0])).powi(2)).sum()
    }

    #[test]
    fn stairs_of_slanted_edges_come_closer_to_the_covered_area() {
        for slope in [0.08, 0.13, 0.2, 0.3] {
            let (stairs, truth) = (slanted(slope, false), slanted(slope, true));
            let smoothed = apply(&stairs, false, None);
            let (before, after) = (error(&stairs, &truth), error(&smoothed, &truth));
            assert!(after < before / 2.0, "slope {slope}: {before} to {after}");
        }
    }

    #[test]
    fn plain_pictures_soft_slopes_and_level_edges_stay() {
        let plain = Image::filled(9, 7, [3, 200, 90, 17]);
        let slope = Image::from_fn(40, 9, |x, _| [(x * 3) as u8, (x * 3) as u8, (x * 3) as u8, 255]);
        let level = Image::from_fn(20, 12, |_, y| if y < 6 { [0, 0, 0, 255] } else { [255; 4] });
        for linear in [false, true] {
            assert_eq!(apply(&plain, linear, None), plain);
            assert_eq!(apply(&slope, linear, None), slope);
            let (after, count) = (apply(&level, linear, None), |image: &Image<Rgba8>| {
                image.pixels().iter().filter(|pixel| !matches!(pixel[0], 0 | 255)).count()
            });
            // The edge spans the picture, so its endpoints are equally far from each pixel, and no line cuts into a
            // pixel. Only the pixels at the edge change a little, because they differ from their neighbours.
            assert!(count(&after) <= 2 * 20, "{linear}");
            assert_eq!(after.row(3), level.row(3));
        }
    }

    #[test]
    fn a_picture_of_one_pixel_stays() {
        let dot = Image::filled(1, 1, [9, 99, 199, 255]);
        assert_eq!(apply(&dot, true, None), dot);
    }

    #[test]
    fn turning_the_picture_turns_the_result() {
        let stairs = slanted(0.2, false);
        let turned = |image: &Image<Rgba8>| Image::from_fn(image.height(), image.width(), |x, y| image.at(y, x));
        // If both directions have equal second differences, the edge counts as horizontal, so a few pixels differ.
        let (one, other) = (apply(&stairs, true, None), turned(&apply(&turned(&stairs), true, None)));
        let same = one.pixels().iter().zip(other.pixels()).filter(|(a, b)| a == b).count();
        assert!(same * 100 >= one.pixels().len() * 98, "{same} of {}", one.pixels().len());
    }

    #[test]
    fn simd_lanes_match_the_scalar_reference() {
        let mut random = fastrand::Rng::with_seed(7);
        for (width, height) in [(1, 1), (2, 70), (15, 9), (16, 16), (17, 131), (70, 5), (101, 66)] {
            let steps = Image::from_fn(width, height, |x, y| {
                let shade = if (x * 3 + y) / 17 % 2 == 0 { 40 } else { 210 };
                [shade, shade / 2, (x * 2) as u8, 255]
            });
            let noise = Image::from_fn(width, height, |_, _| std::array::from_fn(|_| random.u8(..)));
            let blocks = Image::from_fn(width, height, |x, y| [((x / 9 * 71 + y / 13 * 47) % 256) as u8; 4]);
            for (picture, linear) in [steps, noise, blocks].iter().flat_map(|p| [(p, false), (p, true)]) {
                let lumas = picture.map(luma);
                let plain =
                    Image::from_fn(width, height, |x, y| filtered(picture, &lumas, (x.into(), y.into()), linear));
                for lanes in Lanes::all() {
                    let used = Image::filled(width, height, [9; 4]);
                    for memory in [None, Some(used), Some(Image::filled(3, 3, [1; 4]))] {
                        assert_eq!(
                            apply_on(lanes, picture, linear, memory),
                            plain,
                            "{} {width} × {height}",
                            lanes.name()
                        );
                    }
                }
            }
        }
    }
}
