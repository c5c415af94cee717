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

/// Filters a picture, mixing in linear light or in codes.
pub fn apply(picture: &Image<Rgba8>, linear: bool) -> Image<Rgba8> {
    let (width, height) = picture.size();
    let lumas = picture.map(luma);
    let mut result = picture.clone();
    result.pixels_mut().par_chunks_mut((width as usize).max(1)).zip(0..height).for_each(|(row, y)| {
        for (pixel, x) in row.iter_mut().zip(0..) {
            *pixel = filtered(picture, &lumas, (x.into(), y.into()), linear);
        }
    });
    result
}

/// One pixel.
fn filtered(picture: &Image<Rgba8>, lumas: &Image<f32>, at: (i64, i64), linear: bool) -> Rgba8 {
    let own = picture.at_clamped(at.0, at.1);
    match blend(lumas, at) {
        None => own,
        Some(([dx, dy], share)) => mix(own, picture.at_clamped(at.0 + dx, at.1 + dy), share, linear),
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

/// `own` and a share of `other`.
fn mix(own: Rgba8, other: Rgba8, share: f32, linear: bool) -> Rgba8 {
    let tables = Tables::get();
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
            let smoothed = apply(&stairs, false);
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
            assert_eq!(apply(&plain, linear), plain);
            assert_eq!(apply(&slope, linear), slope);
            let (after, count) = (apply(&level, linear), |image: &Image<Rgba8>| {
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
        assert_eq!(apply(&dot, true), dot);
    }

    #[test]
    fn turning_the_picture_turns_the_result() {
        let stairs = slanted(0.2, false);
        let turned = |image: &Image<Rgba8>| Image::from_fn(image.height(), image.width(), |x, y| image.at(y, x));
        // Along the row wins where both directions bend alike, so compare where they differ.
        let (one, other) = (apply(&stairs, true), turned(&apply(&turned(&stairs), true)));
        let same = one.pixels().iter().zip(other.pixels()).filter(|(a, b)| a == b).count();
        assert!(same * 100 >= one.pixels().len() * 98, "{same} of {}", one.pixels().len());
    }
}
