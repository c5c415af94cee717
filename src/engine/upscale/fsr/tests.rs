use super::*;
use crate::pipeline::settings::Choice as _;

fn how(scale: Scale, anchor: Anchor, sharpening: u32) -> Upscaling {
    Upscaling::new("fsr1", scale).unwrap().with_anchor(anchor).with_sharpening(sharpening)
}

fn noise(width: u32, height: u32) -> Image<Rgba8> {
    let mut random = fastrand::Rng::with_seed(23);
    Image::from_fn(width, height, |_, _| {
        std::array::from_fn(|_| if random.bool() { random.u8(..) } else { 255 * random.u8(..2) })
    })
}

fn filled(lanes: Lanes, how: Upscaling, drawn: &Image<Rgba8>, size: (u32, u32)) -> Image<Rgba8> {
    let mut full = Image::filled(size.0, size.1, [1, 2, 3, 4]);
    fill(lanes, how, drawn, &mut full);
    full
}

/// Computes one pixel with the steps and symbols of the publication, in f64.
fn published(drawn: &Image<Rgba8>, scale: f64, (x, y): (u32, u32)) -> [f64; 3] {
    let (px, py) = ((f64::from(x) + 0.5) / scale - 0.5, (f64::from(y) + 0.5) / scale - 0.5);
    let (fx, fy) = (px.floor() as i64, py.floor() as i64);
    let (px, py) = (px - px.floor(), py - py.floor());
    let color = |x: i64, y: i64| {
        let [r, g, b, _] = drawn.at_clamped(fx + x, fy + y);
        [r, g, b].map(|code| f64::from(code) / 255.0)
    };
    let luma = |x, y| color(x, y)[1] + 0.5 * (color(x, y)[0] + color(x, y)[2]);
    let (mut dir_x, mut dir_y, mut len) = (0.0, 0.0, 0.0);
    for (x, y, w) in
        [(0, 0, (1.0 - px) * (1.0 - py)), (1, 0, px * (1.0 - py)), (0, 1, (1.0 - px) * py), (1, 1, px * py)]
    {
        let c = luma(x, y);
        for (a, b, is_x) in [(luma(x - 1, y), luma(x + 1, y), true), (luma(x, y - 1), luma(x, y + 1), false)] {
            let most = (b - c).abs().max((c - a).abs());
            let straight = if most > 0.0 { ((b - a).abs() / most).clamp(0.0, 1.0) } else { 0.0 };
            len += w * straight * straight;
            *(if is_x { &mut dir_x } else { &mut dir_y }) += w * (b - a);
        }
    }
    let r: f64 = dir_x * dir_x + dir_y * dir_y;
    let (dx, dy) = if r < 1.0 / 32768.0 { (1.0, 0.0) } else { (dir_x / r.sqrt(), dir_y / r.sqrt()) };
    let len = (len / 2.0) * (len / 2.0);
    let stretch = (dx * dx + dy * dy) / dx.abs().max(dy.abs());
    let (sx, sy) = (1.0 + (stretch - 1.0) * len, 1.0 - 0.5 * len);
    let lobe = 0.5 + (0.21 - 0.5) * len;
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for y in -1..=2 {
        for x in -1..=2 {
            if (x == -1 || x == 2) && (y == -1 || y == 2) {
                continue;
            }
            let (ox, oy) = (x as f64 - px, y as f64 - py);
            let (vx, vy) = ((ox * dx + oy * dy) * sx, (-ox * dy + oy * dx) * sy);
            let q = (vx * vx + vy * vy).min(1.0 / lobe);
            let w = (25.0 / 16.0 * (0.4 * q - 1.0).powi(2) - 9.0 / 16.0) * (lobe * q - 1.0).powi(2);
            for (sum, value) in sum.iter_mut().zip(color(x, y)) {
                *sum += w * value;
            }
            total += w;
        }
    }
    std::array::from_fn(|channel| {
        let inner = [color(0, 0), color(1, 0), color(0, 1), color(1, 1)].map(|color| color[channel]);
        let least = inner.into_iter().fold(1.0, f64::min);
        255.0 * (sum[channel] / total).clamp(least, inner.into_iter().fold(0.0, f64::max))
    })
}

#[test]
fn enlarging_agrees_with_the_published_steps() {
    let drawn = noise(40, 31);
    for scale in SCALES {
        let size = ((40.0 * scale.value()) as u32, (31.0 * scale.value()) as u32);
        let full = filled(Lanes::best(), how(*scale, Anchor::Centre, 0), &drawn, size);
        let (mut all, mut nearest) = (0, 0);
        for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
            let exact = published(&drawn, scale.value(), (x, y));
            for (code, exact) in full.at(x, y).into_iter().zip(exact) {
                let error = (f64::from(code) - exact).abs();
                assert!(error < 0.75, "×{scale} ({x}, {y}): {code}, not {exact}: more than rounding explains");
                (all, nearest) = (all + 1, nearest + usize::from(error <= 0.5));
            }
        }
        assert!(nearest * 100 > all * 97, "×{scale}: only {nearest} of {all} codes are exactly rounded");
    }
}

/// Sharpens with the publication's formula, in f64.
fn sharpened(cross: [Rgba8; 5], strength: f64) -> [f64; 3] {
    let channels: [[f64; 5]; 3] = std::array::from_fn(|channel| cross.map(|color| f64::from(color[channel]) / 255.0));
    let lobe = channels.iter().map(|[above, left, own, right, below]| {
        let around = [above, left, right, below].map(|value| *value);
        let (least, greatest) = (around.into_iter().fold(1.0, f64::min), around.into_iter().fold(0.0, f64::max));
        let to_black = if greatest > 0.0 { least.min(*own) / (4.0 * greatest) } else { 0.0 };
        let to_white = if least < 1.0 { (1.0 - greatest.max(*own)) / (4.0 - 4.0 * least) } else { 0.0 };
        -to_black.min(to_white)
    });
    let lobe = lobe.fold(-3.0 / 16.0, f64::max) * strength;
    channels.map(|[above, left, own, right, below]| {
        255.0 * ((lobe * (above + left + right + below) + own) / (4.0 * lobe + 1.0)).clamp(0.0, 1.0)
    })
}

#[test]
fn sharpening_agrees_with_the_published_formula() {
    let mut random = fastrand::Rng::with_seed(7);
    for round in 0..20_000 {
        // Similar neighbours give strong lobes.
        let (base, range) = (random.u8(..), if round % 2 == 0 { 12 } else { 255 });
        let cross = std::array::from_fn(|_| std::array::from_fn(|_| base.saturating_add(random.u8(..range))));
        for strength in [0.0, 0.3, 1.0] {
            let exact = sharpened(cross, strength);
            for (code, exact) in rcas::pixel(cross, strength as f32).into_iter().zip(exact) {
                assert!((f64::from(code) - exact).abs() < 0.55, "{cross:?} by {strength}: {code}, not {exact}");
            }
        }
    }
}

#[test]
fn wide_lanes_agree_with_plain_code_bit_for_bit() {
    // The last size spans more than one strip and is opaque.
    for (width, height) in [(1, 1), (2, 3), (9, 5), (23, 7), (11, 70)] {
        let mut drawn = noise(width, height);
        if height == 70 {
            drawn.pixels_mut().iter_mut().for_each(|pixel| pixel[3] = 255);
        }
        for anchor in Anchor::ALL {
            for (scale, sharpening) in SCALES.iter().map(|scale| (*scale, 0)).chain([(Scale::TWO, 80)]) {
                let how = how(scale, *anchor, sharpening);
                let size = ((f64::from(width) * scale.value()) as u32, (f64::from(height) * scale.value()) as u32);
                let plain = filled(Lanes::baseline(), how, &drawn, size);
                for lanes in Lanes::all() {
                    assert!(filled(lanes, how, &drawn, size) == plain, "{} {size:?} {}", how.label(), lanes.name());
                }
            }
        }
    }
}

#[test]
fn sharpened_images_equal_single_pixels_for_all_strips_and_lanes() {
    let drawn = noise(22, 50);
    for (scale, size) in
        [(Scale::ONE_AND_A_HALF, (33, 75)), (Scale::ONE_AND_SEVEN_TENTHS, (37, 85)), (Scale::TWO, (44, 100))]
    {
        let how = how(scale, Anchor::Centre, 80);
        let full = filled(Lanes::best(), how, &drawn, size);
        for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
            let alone = FSR1.pixel(how, &UpscaleInputs::from(&drawn), size, (x, y));
            assert_eq!(full.at(x, y), alone, "×{scale} ({x}, {y})");
        }
    }
}

/// Returns an image of noise, interrupted by columns and rows of a single colour.
fn partly_plain(width: u32, height: u32) -> Image<Rgba8> {
    let noise = noise(width, height);
    Image::from_fn(width, height, |x, y| if x % 90 < 40 || y % 7 < 3 { [30, 200, 90, 255] } else { noise.at(x, y) })
}

#[test]
fn rows_of_many_tiles_equal_single_pixels_even_after_a_wider_image() {
    // The first is wider than a tile, and leaves buffers longer than the second needs.
    for (drawn, rows) in [(partly_plain(300, 12), 9..14), (noise(20, 12), 0..24), (noise(300, 12), 23..24)] {
        for (scale, sharpening) in SCALES.iter().map(|scale| (*scale, 0)).chain([(Scale::TWO, 80)]) {
            let how = how(scale, Anchor::Centre, sharpening);
            let [width, height] = [drawn.width(), drawn.height()].map(|side| (f64::from(side) * scale.value()) as u32);
            let rows = rows.start.min(height - 1)..rows.end.min(height);
            for lanes in Lanes::all() {
                let full = filled(lanes, how, &drawn, (width, height));
                for (x, y) in rows.clone().flat_map(|y| (0..width).map(move |x| (x, y))) {
                    let alone = FSR1.pixel(how, &UpscaleInputs::from(&drawn), (width, height), (x, y));
                    assert_eq!(full.at(x, y), alone, "{} ({x}, {y}) {}", how.label(), lanes.name());
                }
            }
        }
    }
}

#[test]
fn sharpening_makes_no_new_extremes_of_the_scale_and_keeps_plain_colours() {
    // At the ends of the range, the limits of the lobe divide by zero.
    for color in [[0, 0, 0, 255], [255; 4], [0, 255, 128, 7]] {
        assert_eq!(rcas::pixel([color; 5], 1.0), color);
    }
    let grey = |code: u8| [code, code, code, 255];
    let edge = [grey(100), grey(100), grey(140), grey(140), grey(140)];
    assert!(rcas::pixel(edge, 1.0)[0] > 150, "the bright side of an edge becomes brighter");
    assert_eq!(rcas::pixel(edge, 0.0), grey(140));
    // Limits: −100 / (4 · 140) = −0.179 to black, (255 − 140) / (4 · 100 − 4 · 255) = −0.185 to white. The weaker one
    // applies.
    let lobe: f64 = -100.0 / 560.0;
    let exact = (lobe * 480.0 + 140.0) / (4.0 * lobe + 1.0);
    assert!((f64::from(rcas::pixel(edge, 1.0)[0]) - exact).abs() < 0.51, "{exact}");
}

#[test]
fn transposing_the_samples_transposes_the_image() {
    let drawn = noise(9, 9);
    let turned = Image::from_fn(9, 9, |x, y| drawn.at(y, x));
    let how = how(Scale::TWO, Anchor::Centre, 0);
    let (full, other) = (filled(Lanes::best(), how, &drawn, (18, 18)), filled(Lanes::best(), how, &turned, (18, 18)));
    for (x, y) in (0..18).flat_map(|y| (0..18).map(move |x| (x, y))) {
        for (a, b) in full.at(x, y).into_iter().zip(other.at(y, x)) {
            assert!(a.abs_diff(b) <= 1, "({x}, {y}): sums in another order, rounded");
        }
    }
}
