use super::coefficients::{scale, unsharp};
use super::*;
use crate::pipeline::settings::Choice as _;
use crate::upscale::Scale;
use crate::upscale::lattice::LatticePosition;

fn how(scale: Scale, anchor: Anchor, sharpening: u32) -> Upscaling {
    Upscaling::new("nis", scale).unwrap().with_anchor(anchor).with_sharpening(sharpening)
}

/// Returns noise, extremes and smooth areas crossed by edges.
fn picture(width: u32, height: u32) -> Image<Rgba8> {
    let mut random = fastrand::Rng::with_seed(41);
    Image::from_fn(width, height, |x, y| match (x / 7 + y / 7) % 3 {
        0 => std::array::from_fn(|_| if random.bool() { random.u8(..) } else { 255 * random.u8(..2) }),
        1 if x % 7 > y % 7 => [200, 180, 90, 255],
        1 => [20, 30, 60, 128],
        _ => [(8 * x) as u8, 100, (9 * y) as u8, 255],
    })
}

fn mixed(from: f64, to: f64, at: f64) -> f64 {
    from * (1.0 - at) + to * at
}

/// Computes the weights of the directions 0°, 90°, 45° and 135° at sample (x, y) with the published steps, in f64.
fn published_edges(luma: &dyn Fn(i64, i64) -> f64, x: i64, y: i64) -> [f64; 4] {
    let p = |row: i64, column: i64| luma(x + column - 1, y + row - 1);
    let g0 = (p(0, 0) + p(0, 1) + p(0, 2) - p(2, 0) - p(2, 1) - p(2, 2)).abs();
    let g45 = (p(1, 0) + p(0, 0) + p(0, 1) - p(2, 1) - p(2, 2) - p(1, 2)).abs();
    let g90 = (p(0, 0) + p(1, 0) + p(2, 0) - p(0, 2) - p(1, 2) - p(2, 2)).abs();
    let g135 = (p(1, 0) + p(2, 0) + p(2, 1) - p(0, 1) - p(0, 2) - p(1, 2)).abs();
    let found =
        |most: f64, least: f64, other: f64| most > least * 2.0 * 1127.0 / 1024.0 && most > 0.0625 && most > other;
    let straight = found(g0.max(g90), g0.min(g90), g45.min(g135));
    let slanted = found(g45.max(g135), g45.min(g135), g0.min(g90));
    let share = g0.max(g90) / (g0.max(g90) + g45.max(g135));
    let (one, other) = match (straight, slanted) {
        (true, true) => (share, 1.0 - share),
        (true, false) => (1.0, 0.0),
        (false, true) => (0.0, 1.0),
        (false, false) => (0.0, 0.0),
    };
    let first = |is_first: bool, weight: f64| if is_first { [weight, 0.0] } else { [0.0, weight] };
    let ([w0, w90], [w45, w135]) = (first(g0 >= g90, one), first(g45 >= g135, other));
    [w0, w90, w45, w135]
}

/// Filters six values across an edge with the published steps, in f64; `slider` is the sharpness from 0 to 1.
fn published_filter(values: [f64; 6], phase: usize, slider: f64) -> f64 {
    let dot = |table: [f32; 6]| -> f64 { values.iter().zip(table).map(|(value, by)| value * f64::from(by)).sum() };
    let by = slider - 0.5;
    let (most, least) = if by >= 0.0 { (1.25, 1.25) } else { (1.75, 1.0) };
    let strength = ((0.4 + by * least * 1.2).max(0.0), 1.6 + by * most * 1.8);
    let limit = ((0.14 + by * least * 0.32).max(0.1), 0.5 + by * least * 0.6);
    let luma = dot(scale(phase as u32));
    let ramp = 1.0 - ((luma - 0.45) / 0.45).clamp(0.0, 1.0);
    let limit = mixed(limit.0, limit.1, ramp) * luma;
    let mask = (dot(unsharp(phase as u32)) * mixed(strength.0, strength.1, ramp)).max(-limit).min(limit);
    let window = if phase <= 32 { &values[..5] } else { &values[1..] };
    let contrast = |part: &[f64]| {
        part.iter().fold(0.0, |most: f64, v| most.max(*v)) - part.iter().fold(9.0, |least: f64, v| least.min(*v))
    };
    let (before, after) = (contrast(&window[..3]), contrast(&window[2..]));
    let ratio = before.max(after) / (before.min(after) + 1.0 / 255.0);
    luma + mask * (1.0 - ((ratio - 2.0) / 8.0).clamp(0.0, 1.0))
}

/// Samples a diagonal at steps of half a diagonal, in f64. `at(along, across)` returns the sample at a position in half
/// diagonals, both even or both odd; `across` in [0, 1] is the position between them.
fn diagonal(at: impl Fn(i64, i64) -> f64, across: f64) -> [f64; 7] {
    std::array::from_fn(|step| {
        let along = step as i64;
        let (low, high) = if along % 2 == 1 {
            (-1, 1)
        } else if across >= 0.5 {
            (0, 2)
        } else {
            (-2, 0)
        };
        // Samples across the diagonal lie two half diagonals apart, around ½.
        let share = (2.0 * across - 1.0 - low as f64) / 2.0;
        mixed(at(along, low), at(along, high), share)
    })
}

/// Computes the colour of a pixel with the published steps, in f64. Phases are rational: `at` output pixels correspond
/// to `at` · 1 / scale samples.
fn published(drawn: &Image<Rgba8>, how: Upscaling, (x, y): (u32, u32)) -> [f64; 3] {
    let color = |x: i64, y: i64| drawn.at_clamped(x, y).map(f64::from);
    let luma = |x: i64, y: i64| {
        let [r, g, b, _] = color(x, y);
        (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255.0
    };
    let [(cx, px), (cy, py)] = [x, y].map(|at| {
        let LatticePosition { cell, phase } = how.lattice().place(at);
        (i64::from(cell), phase)
    });
    let steps = how.lattice().phases();
    let (fx, fy) = (f64::from(px) / f64::from(steps), f64::from(py) / f64::from(steps));
    let discrete = |phase: u32| (64 * (phase % steps) / steps) as usize;
    let p = |row: i64, column: i64| luma(cx + column - 2, cy + row - 2);
    let six = |value: &dyn Fn(i64) -> f64| -> [f64; 6] { std::array::from_fn(|tap| value(tap as i64)) };
    let plain = |values: [f64; 6], phase: usize| -> f64 {
        values.iter().zip(scale(phase as u32)).map(|(value, by)| value * f64::from(by)).sum()
    };
    let normal = plain(six(&|column| plain(six(&|row| p(row, column)), discrete(py))), discrete(px));
    let slider = f64::from(how.sharpening()) / 100.0;
    let along_x = published_filter(six(&|row| mixed(p(row, 2), p(row, 3), fx)), discrete(py), slider);
    let along_y = published_filter(six(&|column| mixed(p(2, column), p(3, column), fy)), discrete(px), slider);
    // A step along the rising filter leads down and to the right, one across it up and to the right.
    let rising = diagonal(|along, across| p(1 + (along - across) / 2, 1 + (along + across) / 2), 0.5 + 0.5 * (fx - fy));
    // A step along the falling filter leads up and to the right, one across it down and to the right.
    let falling = diagonal(|along, across| p(4 + (across - along) / 2, 1 + (along + across) / 2), 0.5 * (fx + fy));
    let shifted = |values: [f64; 7], by: bool| six(&|tap| values[tap as usize + usize::from(by)]);
    let at_45 = published_filter(shifted(rising, px + py >= steps), discrete(px + py), slider);
    let at_135 = published_filter(shifted(falling, px >= py), discrete(steps + px - py), slider);
    let corner = |column, row| published_edges(&luma, cx + column, cy + row);
    let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
    let weights: [f64; 4] = std::array::from_fn(|k| {
        mixed(mixed(corners[0][k], corners[1][k], fx), mixed(corners[2][k], corners[3][k], fx), fy)
    });
    let directed: f64 = weights.iter().zip([along_x, along_y, at_45, at_135]).map(|(by, value)| by * value).sum();
    let filtered = directed + normal * (1.0 - weights.iter().sum::<f64>());
    let bilinear = |k: usize| {
        let at = |column, row| color(cx + column, cy + row)[k];
        mixed(mixed(at(0, 0), at(1, 0), fx), mixed(at(0, 1), at(1, 1), fx), fy)
    };
    let change = 255.0 * filtered - (0.2126 * bilinear(0) + 0.7152 * bilinear(1) + 0.0722 * bilinear(2));
    [0, 1, 2].map(|k| (bilinear(k) + change).clamp(0.0, 255.0))
}

#[test]
fn pixels_agree_with_the_published_steps() {
    let drawn = picture(23, 25);
    for (scale, anchor, sharpening) in [
        (Scale::TWO, Anchor::Centre, 50),
        (Scale::ONE_AND_A_HALF, Anchor::Corner, 0),
        (Scale::ONE_AND_SEVEN_TENTHS, Anchor::Centre, 100),
    ] {
        let how = how(scale, anchor, sharpening);
        let [width, height] = [23.0, 25.0].map(|samples: f64| (samples * scale.value()) as u32);
        let full = how.upscale(&UpscaleInputs::from(&drawn), width, height);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            for (code, exact) in full.at(x, y).into_iter().zip(published(&drawn, how, (x, y))) {
                assert!((f64::from(code) - exact).abs() < 0.52, "{} ({x}, {y}): {code}, not {exact}", how.label());
            }
        }
    }
}

#[test]
fn an_edge_in_each_direction_has_its_filter() {
    let luma_of = |is_bright: bool| if is_bright { 0.8 } else { 0.2 };
    let is_bright: [fn(i64, i64) -> bool; 4] = [|_, y| y > 0, |x, _| x > 0, |x, y| x + y > 0, |x, y| x > y];
    for (direction, is_bright) in is_bright.into_iter().enumerate() {
        let around = [-1, 0, 1].map(|y| [-1, 0, 1].map(|x| luma_of(is_bright(x, y))));
        let weights = on_lanes!(Lanes::best(), simd => {
            kernel::edges(simd, around.map(|row| row.map(|luma| f32x16::splat(simd, luma)))).map(|by| by.to_array()[0])
        });
        let most = (0..4).max_by(|a, b| weights[*a].total_cmp(&weights[*b]));
        assert_eq!(most, Some(direction));
    }
}

#[test]
fn wide_lanes_and_single_pixels_agree_bit_for_bit() {
    let drawn = picture(29, 40);
    for (scale, anchor) in SCALES.iter().flat_map(|scale| Anchor::ALL.iter().map(move |anchor| (*scale, *anchor))) {
        let how = how(scale, anchor, 60);
        let [width, height] = [29.0, 40.0].map(|samples: f64| (samples * scale.value()) as u32);
        let mut pictures = Lanes::all().map(|lanes| {
            let mut full = Image::filled(width, height, [1, 2, 3, 4]);
            fill(lanes, how, &drawn, &mut full);
            full
        });
        let best = pictures.next().unwrap();
        assert!(pictures.all(|other| other == best), "{}", how.label());
        for (x, y) in (0..height).step_by(5).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let alone = NIS.pixel(how, &UpscaleInputs::from(&drawn), (width, height), (x, y));
            assert_eq!(best.at(x, y), alone, "{} ({x}, {y})", how.label());
        }
    }
}
