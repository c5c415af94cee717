//! Smoothing the edges of a finished picture: an FXAA-class filter.
//!
//! After T. Lottes, "FXAA" (NVIDIA, 2009), in its later form that follows edges to their ends. Brightness is luma of sRGB
//! codes, as the eye sees contrast. Where it changes enough:
//!
//! 1. the second differences say whether the edge lies along the row or along the column, the first ones on which side;
//! 2. on the line between the two pixels the edge is followed both ways until the brightness there changes;
//! 3. a slanted line from end to end passes the pixel at some distance: that much the pixel takes of its neighbour across
//!    the edge, if it lies on the side that the line cuts into;
//! 4. a pixel that stands out from its eight neighbours takes at least a share by how much it does.

use rayon::prelude::*;

use crate::image::color::{Tables, luma};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Least contrast around a pixel that counts as an edge, in codes: below, nobody sees stairs.
const LEAST_CONTRAST: f32 = 8.0;

/// Least contrast as a share of the brightest pixel around.
const LEAST_SHARE: f32 = 0.125;

/// How much a pixel that stands alone takes of its neighbour at most.
const SUBPIXEL: f32 = 0.75;

/// Pixels that an edge is followed each way.
pub const SEARCH_PX: u32 = 16;

/// Change along an edge that ends it, as a share of the contrast across.
const END_SHARE: f32 = 0.25;

/// Rows that are filtered together: their brightness, with that of the rows around, stays in the second-level cache.
const BAND_ROWS: u32 = 64;

/// Pixels beside a row of brightness, each way: what a search or a block of sixteen reads beyond the borders.
const MARGIN: usize = 2 * WIDE;

/// Filters a picture, mixing in linear light or in codes. The result is written into `memory` where there is any.
pub fn apply(picture: &Image<Rgba8>, linear: bool, memory: Option<Image<Rgba8>>) -> Image<Rgba8> {
    apply_on(Lanes::best(), picture, linear, memory)
}

fn apply_on(lanes: Lanes, picture: &Image<Rgba8>, linear: bool, memory: Option<Image<Rgba8>>) -> Image<Rgba8> {
    let (width, height) = picture.size();
    let mut result = Image::reusing(memory, width, height, [0; 4]);
    let bands = result.pixels_mut().par_chunks_mut((width * BAND_ROWS).max(1) as usize);
    bands.zip((0..height).into_par_iter().step_by(BAND_ROWS as usize)).for_each_init(
        Vec::new,
        |lumas, (rows, first)| {
            on_lanes!(lanes, simd => {
                let band = Band::new(simd, picture, first, lumas);
                for (row, y) in rows.chunks_exact_mut(width as usize).zip(first..) {
                    band.filter_row(simd, y, linear, row);
                }
            });
        },
    );
    result
}

/// Some rows of a picture and their brightness, continued beyond the borders of the picture.
struct Band<'a> {
    picture: &'a Image<Rgba8>,
    lumas: &'a [f32],
    /// Numbers from row to row.
    stride: usize,
    /// Row of the picture that the first row of `lumas` is beside.
    first: i64,
}

/// Sixteen neighbouring pixels, each as the centre of its edge.
struct Edges {
    /// A bit for each pixel whose edge lies along the row.
    level: u32,
    /// A bit for each whose edge is shared with the pixel above or to the left.
    towards_before: u32,
    /// A bit for each that is darker than the line between the two sides.
    below_edge: u32,
    gradient: [f32; WIDE],
    edge: [f32; WIDE],
    /// Share of the neighbour that a pixel takes for standing out.
    alone: [f32; WIDE],
}

impl<'a> Band<'a> {
    /// Computes the brightness of [`BAND_ROWS`] rows from `first` on, and of those around that a search reads.
    #[inline(always)]
    fn new<S: Simd>(simd: S, picture: &'a Image<Rgba8>, first: u32, lumas: &'a mut Vec<f32>) -> Self {
        let (width, height) = picture.size();
        let stride = (width as usize).next_multiple_of(WIDE) + 2 * MARGIN;
        let around = i64::from(SEARCH_PX) + 1;
        let (top, bottom) = (i64::from(first) - around, i64::from((first + BAND_ROWS).min(height)) + around);
        lumas.resize(stride * (bottom - top) as usize, 0.0);
        for (lumas, y) in lumas.chunks_exact_mut(stride).zip(top..bottom) {
            let row = picture.row(y.clamp(0, i64::from(height) - 1) as u32);
            let (blocks, rest) = row.as_chunks::<WIDE>();
            let within = &mut lumas[MARGIN..];
            for (block, lumas) in blocks.iter().zip(within.as_chunks_mut::<WIDE>().0) {
                luma_of_sixteen(simd, block).store_array(lumas);
            }
            for (pixel, luma_of_pixel) in rest.iter().zip(&mut within[blocks.len() * WIDE..]) {
                *luma_of_pixel = luma(*pixel);
            }
            let (left, right) = (lumas[MARGIN], lumas[MARGIN + row.len() - 1]);
            lumas[..MARGIN].fill(left);
            lumas[MARGIN + row.len()..].fill(right);
        }
        Self { picture, lumas, stride, first: top }
    }

    /// Position of a pixel's brightness.
    #[inline(always)]
    fn place(&self, x: usize, y: u32) -> usize {
        (i64::from(y) - self.first) as usize * self.stride + MARGIN + x
    }

    /// Filters a row of the picture.
    #[inline(always)]
    fn filter_row<S: Simd>(&self, simd: S, y: u32, linear: bool, row: &mut [Rgba8]) {
        row.copy_from_slice(self.picture.row(y));
        let tables = Tables::get();
        for (x, block) in (0..).step_by(WIDE).zip(row.chunks_mut(WIDE)) {
            let place = self.place(x, y);
            let mut found = self.contrasts(simd, place) & ((1_u32 << block.len()) - 1);
            if found == 0 {
                continue;
            }
            let edges = self.edges(simd, place);
            while found != 0 {
                let lane = found.trailing_zeros() as usize;
                found &= found - 1;
                let (is_level, side) =
                    (edges.level >> lane & 1 != 0, 1 - 2 * (edges.towards_before >> lane & 1) as i64);
                let share = self.share(simd, &edges, place, lane);
                if share > 0.0 {
                    let (dx, dy) = if is_level { (0, side) } else { (side, 0) };
                    let other = self.picture.at_clamped((x + lane) as i64 + dx, i64::from(y) + dy);
                    block[lane] = mix(tables, block[lane], other, share, linear);
                }
            }
        }
    }

    #[inline(always)]
    fn sixteen<S: Simd>(&self, simd: S, place: usize) -> f32x16<S> {
        f32x16::from_slice(simd, &self.lumas[place..place + WIDE])
    }

    /// Returns a bit for each of sixteen pixels around which brightness changes enough.
    #[inline(always)]
    fn contrasts<S: Simd>(&self, simd: S, place: usize) -> u32 {
        let [middle, n, s, w, e] = each!(at in
            [place, place - self.stride, place + self.stride, place - 1, place + 1] => self.sixteen(simd, at));
        let brightest = n.max(s).max(w).max(e).max(middle);
        let contrast = brightest - n.min(s).min(w).min(e).min(middle);
        contrast.simd_ge((brightest * LEAST_SHARE).max(LEAST_CONTRAST)).to_bitmask() as u32
    }

    /// Finds direction, side and height of the edges of sixteen pixels; without meaning where there is too little contrast.
    #[inline(always)]
    fn edges<S: Simd>(&self, simd: S, place: usize) -> Edges {
        let [above, below] = [place - self.stride, place + self.stride];
        let [nw, n, ne] = each!(place in [above - 1, above, above + 1] => self.sixteen(simd, place));
        let [w, middle, e] = each!(at in [place - 1, place, place + 1] => self.sixteen(simd, at));
        let [sw, s, se] = each!(place in [below - 1, below, below + 1] => self.sixteen(simd, place));
        let along_row = bend(n, middle, s) * 2.0 + bend(nw, w, sw) + bend(ne, e, se);
        let along_column = bend(w, middle, e) * 2.0 + bend(nw, n, ne) + bend(sw, s, se);
        let is_level = along_row.simd_ge(along_column);
        let (before, after) = (is_level.select(n, w), is_level.select(s, e));
        let towards_before = (before - middle).abs().simd_ge((after - middle).abs());
        let beyond = towards_before.select(before, after);
        let edge = (middle + beyond) * 0.5;
        let contrast = n.max(s).max(w).max(e).max(middle) - n.min(s).min(w).min(e).min(middle);
        let around = ((n + s + w + e) * 2.0 + nw + ne + sw + se) / 12.0;
        let stands_out = ((around - middle).abs() / contrast).min(1.0);
        let smooth = stands_out * stands_out * (f32x16::splat(simd, 3.0) - stands_out * 2.0);
        Edges {
            level: is_level.to_bitmask() as u32,
            towards_before: towards_before.to_bitmask() as u32,
            below_edge: middle.simd_lt(edge).to_bitmask() as u32,
            gradient: (beyond - middle).abs().to_array(),
            edge: edge.to_array(),
            alone: (smooth * smooth * SUBPIXEL).to_array(),
        }
    }

    /// Returns the share that a pixel takes of its neighbour across the edge.
    #[inline(always)]
    fn share<S: Simd>(&self, simd: S, edges: &Edges, place: usize, lane: usize) -> f32 {
        let (place, edge) = (place + lane, edges.edge[lane]);
        let ends_at = edges.gradient[lane] * END_SHARE;
        let is_level = edges.level >> lane & 1 != 0;
        let towards_before = edges.towards_before >> lane & 1 != 0;
        let across = if is_level { self.stride } else { 1 };
        let beyond = if towards_before { place - across } else { place + across };
        let [back, ahead] = if is_level {
            self.ends_along_row(simd, [place, beyond], edge, ends_at)
        } else {
            [false, true].map(|is_ahead| self.end_along_column([place, beyond], is_ahead, edge, ends_at))
        };
        let nearest = if back.0 <= ahead.0 { back } else { ahead };
        // The line cuts into this pixel if the edge ends towards the other side's brightness.
        let cuts_in = (nearest.1 < 0.0) != (edges.below_edge >> lane & 1 != 0);
        let of_line = if cuts_in { 0.5 - nearest.0 / (back.0 + ahead.0) } else { 0.0 };
        of_line.max(edges.alone[lane])
    }

    /// Follows an edge along the row, both ways: returns how far it reaches and how much brighter it is there. All steps of one
    /// way are compared at once.
    #[inline(always)]
    fn ends_along_row<S: Simd>(&self, simd: S, sides: [usize; 2], edge: f32, ends_at: f32) -> [(f32, f32); 2] {
        let beside = |first: [usize; 2]| (self.sixteen(simd, first[0]) + self.sixteen(simd, first[1])) * 0.5 - edge;
        let back = beside(sides.map(|place| place - WIDE));
        let ahead = beside(sides.map(|place| place + 1));
        let ends = |values: f32x16<S>| values.abs().simd_ge(ends_at).to_bitmask() as u32;
        let (back_ends, ahead_ends) = (ends(back) & 0xFFFF, ends(ahead) & 0xFFFF);
        let back_step = if back_ends == 0 { WIDE } else { back_ends.leading_zeros() as usize - 15 };
        let ahead_step = if ahead_ends == 0 { WIDE } else { ahead_ends.trailing_zeros() as usize + 1 };
        let at = |places: [usize; 2]| (self.lumas[places[0]] + self.lumas[places[1]]) * 0.5 - edge;
        [
            (back_step as f32, at(sides.map(|place| place - back_step))),
            (ahead_step as f32, at(sides.map(|place| place + ahead_step))),
        ]
    }

    /// Follows an edge along the column: returns how far it reaches and how much brighter it is there.
    #[inline(always)]
    fn end_along_column(&self, sides: [usize; 2], is_ahead: bool, edge: f32, ends_at: f32) -> (f32, f32) {
        let stride = if is_ahead { self.stride as isize } else { -(self.stride as isize) };
        let (mut places, mut step) = (sides, 0);
        loop {
            step += 1;
            places = places.map(|place| place.wrapping_add_signed(stride));
            let value = (self.lumas[places[0]] + self.lumas[places[1]]) * 0.5 - edge;
            if step == SEARCH_PX || value.abs() >= ends_at {
                return (step as f32, value);
            }
        }
    }
}

/// [`luma`] of sixteen pixels.
#[inline(always)]
fn luma_of_sixteen<S: Simd>(simd: S, pixels: &[Rgba8; WIDE]) -> f32x16<S> {
    let codes = u32x16::load_array(
        simd,
        each!(i in
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => u32::from_le_bytes(pixels[i])),
    );
    let [r, g, b] = each!(shift in [0, 8, 16] => float_of(codes >> shift & 0xFF));
    r * 0.2126 + g * 0.7152 + b * 0.0722
}

/// Magnitude of the second difference of brightness.
#[inline(always)]
fn bend<S: Simd>(before: f32x16<S>, own: f32x16<S>, after: f32x16<S>) -> f32x16<S> {
    (before - own * 2.0 + after).abs()
}

/// `own` and a share of `other`.
#[inline(always)]
fn mix(tables: &Tables, own: Rgba8, other: Rgba8, share: f32, linear: bool) -> Rgba8 {
    let mut result = own;
    for ((code, own), other) in result.iter_mut().zip(own).zip(other).take(3) {
        let between = |values: &[f32; 256]| {
            let (own, other) = (values[own as usize], values[other as usize]);
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

    /// One pixel, as published: plain code that the lanes must agree with.
    fn filtered(picture: &Image<Rgba8>, lumas: &Image<f32>, at: (i64, i64), linear: bool) -> Rgba8 {
        let own = picture.at_clamped(at.0, at.1);
        match blend(lumas, at) {
            None => own,
            Some(([dx, dy], share)) => mix(Tables::get(), own, picture.at_clamped(at.0 + dx, at.1 + dy), share, linear),
        }
    }

    /// Which neighbour a pixel takes a share of, and how much; none where there is no edge.
    fn blend(lumas: &Image<f32>, (x, y): (i64, i64)) -> Option<([i64; 2], f32)> {
        let at = |dx: i64, dy: i64| lumas.at_clamped(x + dx, y + dy);
        let (middle, [n, s, w, e]) = (at(0, 0), [at(0, -1), at(0, 1), at(-1, 0), at(1, 0)]);
        let brightest = n.max(s).max(w).max(e).max(middle);
        let contrast = brightest - n.min(s).min(w).min(e).min(middle);
        if contrast < LEAST_CONTRAST.max(brightest * LEAST_SHARE) {
            return None;
        }
        let [nw, ne, sw, se] = [at(-1, -1), at(1, -1), at(-1, 1), at(1, 1)];
        let bend = |before: f32, own: f32, after: f32| (before - 2.0 * own + after).abs();
        let along_row = 2.0 * bend(n, middle, s) + bend(nw, w, sw) + bend(ne, e, se);
        let along_column = 2.0 * bend(w, middle, e) + bend(nw, n, ne) + bend(sw, s, se);
        let is_level = along_row >= along_column;

        let (before, after) = if is_level { (n, s) } else { (w, e) };
        let towards_before = (before - middle).abs() >= (after - middle).abs();
        let (beyond, side) = if towards_before { (before, -1) } else { (after, 1) };
        let gradient = (beyond - middle).abs();
        let (across, along) = if is_level { ([0, side], [1, 0]) } else { ([side, 0], [0, 1]) };

        let edge = (middle + beyond) / 2.0;
        let on_edge = |step: i64| {
            let (px, py) = (along[0] * step, along[1] * step);
            (at(px, py) + at(px + across[0], py + across[1])) / 2.0 - edge
        };
        let end = |direction: i64| {
            let ends = |step: &i64| on_edge(direction * step).abs() >= gradient * END_SHARE;
            let step = (1..=i64::from(SEARCH_PX)).find(ends).unwrap_or(i64::from(SEARCH_PX));
            (step as f32, on_edge(direction * step))
        };
        let (back, ahead) = (end(-1), end(1));
        let nearest = if back.0 <= ahead.0 { back } else { ahead };
        // The line cuts into this pixel if the edge ends towards the other side's brightness.
        let cuts_in = (nearest.1 < 0.0) != (middle < edge);
        let of_line = if cuts_in { 0.5 - nearest.0 / (back.0 + ahead.0) } else { 0.0 };

        let around = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
        let stands_out = ((around - middle).abs() / contrast).min(1.0);
        let smooth = stands_out * stands_out * (3.0 - 2.0 * stands_out);
        Some((across, of_line.max(smooth * smooth * SUBPIXEL)))
    }

    /// Black above the line y = slope · x + 6, white below, each pixel by its centre or by the area that is white.
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
            // The edge touches both borders at once, so that nothing slants; only what stands out is softened a little.
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
        // Along the row wins where both directions bend alike, so compare where they differ.
        let (one, other) = (apply(&stairs, true, None), turned(&apply(&turned(&stairs), true, None)));
        let same = one.pixels().iter().zip(other.pixels()).filter(|(a, b)| a == b).count();
        assert!(same * 100 >= one.pixels().len() * 98, "{same} of {}", one.pixels().len());
    }

    #[test]
    fn lanes_filter_as_plain_code_pixel_by_pixel() {
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
