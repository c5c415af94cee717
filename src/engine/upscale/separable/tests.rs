use super::*;
use crate::upscale::BUILT_IN;
use crate::upscale::bicubic::BICUBIC;
use crate::upscale::bilinear::BILINEAR;
use crate::upscale::cubic::{CATMULL_ROM, MITCHELL};

/// Returns the built-in upscalers that are defined by weights alone.
fn methods() -> Vec<&'static Separable> {
    let separable = BUILT_IN.iter().filter_map(|upscaler| upscaler.as_separable()?.downcast_ref());
    let methods: Vec<&Separable> = separable.collect();
    assert!(methods.len() >= 6, "only {} methods", methods.len());
    methods
}

/// Returns an image of noise, extremes and flat runs, which provoke overshoot and accumulated rounding errors.
fn picture(random: &mut fastrand::Rng, width: u32, height: u32) -> Image<Rgba8> {
    Image::from_fn(width, height, |x, y| match (x / 4 + y / 4) % 3 {
        0 => std::array::from_fn(|_| random.u8(..)),
        1 => std::array::from_fn(|_| 255 * random.u8(..2)),
        _ => [random.u8(..2), 128 + random.u8(..2), 255 - random.u8(..2), 255],
    })
}

fn choices() -> impl Iterator<Item = (&'static Separable, Upscaling)> {
    methods().into_iter().flat_map(|method| {
        SCALES.iter().flat_map(move |scale| {
            let how = Upscaling::new(method.id, *scale);
            Anchor::ALL.iter().filter_map(move |anchor| Some((method, how?.with_anchor(*anchor))))
        })
    })
}

/// Returns the position of an output pixel along one axis, in samples, computed with the common resizing formula for
/// each anchor.
fn place(how: Upscaling, at: u32) -> f64 {
    match how.anchor() {
        Anchor::Corner => f64::from(at) / how.scale().value(),
        Anchor::Centre => (f64::from(at) + 0.5) / how.scale().value() - 0.5,
    }
}

/// Returns sample indices and normalised weights along one axis.
fn weights(kernel: fn(f64) -> f64, at: f64, samples: u32) -> Vec<(u32, f64)> {
    let first = at.floor() as i64 - 3;
    let all: Vec<_> = (first..first + 8).map(|index| (index, kernel((at - index as f64).abs()))).collect();
    let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
    all.into_iter().map(|(index, weight)| (index.clamp(0, i64::from(samples) - 1) as u32, weight / sum)).collect()
}

/// Computes the exact result in f64 over all samples; `value` converts 8-bit values to the filtering colour space.
fn reference(
    kernel: fn(f64) -> f64,
    how: Upscaling,
    drawn: &Image<Rgba8>,
    (width, height): (u32, u32),
    value: impl Fn(u8, usize) -> f64,
) -> Image<[f64; 4]> {
    Image::from_fn(width, height, |x, y| {
        let across = weights(kernel, place(how, x), drawn.width());
        let down = weights(kernel, place(how, y), drawn.height());
        let terms = down.iter().flat_map(|(row, v)| across.iter().map(move |(column, u)| (*column, *row, u * v)));
        let mut sum = [0.0; 4];
        for (column, row, weight) in terms {
            let sample = drawn.at(column, row);
            for (channel, sum) in sum.iter_mut().enumerate() {
                *sum += weight * value(sample[channel], channel);
            }
        }
        sum
    })
}

/// Image sizes in samples, whose rows end at various positions within a block; the last size spans several bands.
const SIZES: [(u32, u32); 7] = [(1, 1), (2, 1), (1, 3), (5, 4), (9, 7), (17, 6), (6, 61)];

/// Calls `check` for every upscaler and combination of options, with random samples and an output size that sometimes
/// cuts the last block.
fn for_all(mut check: impl FnMut(&Separable, Upscaling, &Image<Rgba8>, (u32, u32))) {
    let mut random = fastrand::Rng::with_seed(5);
    for (method, how) in choices() {
        for (index, (columns, rows)) in SIZES.into_iter().enumerate() {
            let drawn = picture(&mut random, columns, rows);
            let [width, height] = [columns, rows].map(|samples| {
                let longest = (f64::from(samples) * how.scale().value()) as u32;
                longest - u32::from(index % 2 == 1 && how.lattice().samples(longest - 1) == samples)
            });
            if how.lattice().samples(width) == columns && how.lattice().samples(height) == rows {
                check(method, how, &drawn, (width, height));
            }
        }
    }
}

fn filled(method: &Separable, level: Level, how: Upscaling, drawn: &Image<Rgba8>, size: (u32, u32)) -> Image<Rgba8> {
    // Arbitrary values, to be overwritten.
    let mut full = Image::filled(size.0, size.1, [77, 1, 2, 3]);
    method.fill(level, how, drawn, &mut full);
    full
}

#[test]
fn results_are_within_one_code_of_exact_arithmetic_and_bilinear_is_exact() {
    for_all(|method, how, drawn, size| {
        let full = filled(method, Level::new(), how, drawn, size);
        let exact = reference(method.published, how, drawn, size, |code, _| f64::from(code));
        // Sums of linear interpolation are fractions with a small denominator, so none lies strictly between a half and
        // the tolerance.
        let tolerance = if method.id == "bilinear" { 0.5 + 1e-9 } else { 0.6 };
        for (code, exact) in full.pixels().as_flattened().iter().zip(exact.pixels().as_flattened()) {
            let exact = exact.clamp(0.0, 255.0);
            assert!((f64::from(*code) - exact).abs() <= tolerance, "{} {size:?}: {code}, not {exact}", how.label());
        }
    });
}

#[test]
fn bilinear_rounds_halves_up() {
    let drawn = Image::from_pixels(2, 1, vec![[0, 10, 254, 255], [1, 13, 255, 255]]);
    let how = Upscaling::new("bilinear", Scale::TWO).unwrap();
    for level in [Level::new(), Level::fallback()] {
        let full = filled(&BILINEAR, level, how, &drawn, (3, 1));
        assert_eq!(full.pixels(), [[0, 10, 254, 255], [1, 12, 255, 255], [1, 13, 255, 255]]);
    }
}

#[test]
fn linear_light_is_within_one_code_of_exact_arithmetic() {
    let decode = |code: u8, channel: usize| {
        let c = f64::from(code) / 255.0;
        let light = if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
        if channel == 3 { c } else { light }
    };
    let encode = |value: f64, channel: usize| {
        let v = value.clamp(0.0, 1.0);
        let code = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        255.0 * if channel == 3 { v } else { code }
    };
    for_all(|method, how, drawn, size| {
        let how = how.with_light(FilterSpace::Linear);
        let full = filled(method, Level::new(), how, drawn, size);
        let exact = reference(method.published, how, drawn, size, decode);
        for (pixel, exact) in full.pixels().iter().zip(exact.pixels()) {
            for channel in 0..4 {
                let exact = encode(exact[channel], channel);
                let code = f64::from(pixel[channel]);
                assert!((code - exact).abs() <= 0.52, "{} {size:?}: {code}, not {exact}", how.label());
            }
        }
    });
}

#[test]
fn wide_lanes_agree_with_plain_code_bit_for_bit() {
    for_all(|method, how, drawn, size| {
        for light in FilterSpace::ALL {
            for deringing in [false, true] {
                let how = how.with_light(*light).with_deringing(deringing);
                let wide = filled(method, Level::new(), how, drawn, size);
                let plain = filled(method, Level::fallback(), how, drawn, size);
                assert!(wide == plain, "{} {size:?}", how.label());
            }
        }
    });
}

#[test]
fn wide_rows_in_linear_light_equal_single_pixels_whichever_rows_are_opaque() {
    let mut levels = vec![Level::new(), Level::fallback()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    let mut random = fastrand::Rng::with_seed(9);
    for (method, how) in choices() {
        for opaque in [|_: u32| true, |row| row % 3 != 0, |_| false] {
            let drawn = Image::from_fn(43, 3, |_, y| {
                let [r, g, b, a] = std::array::from_fn(|_| random.u8(..));
                [r, g, b, if opaque(y) { 255 } else { a }]
            });
            for deringing in [false, true] {
                let how = how.with_light(FilterSpace::Linear).with_deringing(deringing);
                let [width, height] = [43.0, 3.0].map(|samples: f64| (samples * how.scale().value()) as u32);
                let alone = Image::from_fn(width, height, |x, y| pixel_of(method.weights, how, &drawn, (x, y)));
                for level in &levels {
                    let full = filled(method, *level, how, &drawn, (width, height));
                    assert!(full == alone, "{} {level:?}", how.label());
                }
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[test]
fn the_alignment_of_rows_does_not_matter() {
    let Some(avx2) = Level::new().as_avx2() else { return };
    for_all(|method, how, drawn, size| {
        let is_linear = matches!(method.weights, KernelWeights::Linear);
        if is_linear && how.lattice().phases() > exact_avx2::MAX_PHASES {
            return;
        }
        let plain = filled(method, Level::fallback(), how, drawn, size);
        for before in 0..8 {
            let mut wide = Image::filled(size.0, size.1, [77, 1, 2, 3]);
            let lattice = how.lattice();
            match method.weights {
                KernelWeights::Linear => {
                    fill(&exact_avx2::ExactAvx2::new(avx2, lattice, size.0, before), drawn, lattice, &mut wide);
                }
                KernelWeights::Four(weights) => {
                    let phases = phases::<4, 2>(weights, lattice);
                    let pass = fixed_avx2::FixedAvx2::new(avx2, &phases, how, size.0, before);
                    fill(&pass, drawn, lattice, &mut wide);
                }
                KernelWeights::Six(weights) => {
                    let phases = phases::<6, 3>(weights, lattice);
                    let pass = fixed_avx2::FixedAvx2::new(avx2, &phases, how, size.0, before);
                    fill(&pass, drawn, lattice, &mut wide);
                }
            }
            assert!(wide == plain, "{} {size:?} {before}", how.label());
        }
    });
}

#[test]
fn with_deringing_a_pixel_stays_in_the_range_of_the_four_samples_around_it() {
    for_all(|method, how, drawn, size| {
        let how = how.with_deringing(true);
        if !how.deringing() {
            return;
        }
        let full = filled(method, Level::new(), how, drawn, size);
        for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
            let inner = |at: u32| (how.lattice().place(at).cell..).take(2);
            let around = inner(y).flat_map(|row| inner(x).map(move |column| (column, row)));
            let around: Vec<_> = around.map(|(x, y)| drawn.at_clamped(x.into(), y.into())).collect();
            for channel in 0..4 {
                let codes = || around.iter().map(|sample| sample[channel]);
                let range = codes().min().unwrap_or(0)..=codes().max().unwrap_or(255);
                assert!(range.contains(&full.at(x, y)[channel]), "{} {size:?} ({x}, {y})", how.label());
            }
        }
    });
}

/// Returns a polynomial of this degree as a function of the position in samples.
fn polynomial(degree: i32) -> impl Fn(f64) -> f64 {
    move |at: f64| 20.0 + 200.0 * (at / 11.0).powi(degree)
}

#[test]
fn polynomials_are_reproduced_as_far_as_theory_says() {
    for (method, degree) in [(&BILINEAR, 1), (&BICUBIC, 3), (&CATMULL_ROM, 2), (&MITCHELL, 1)] {
        for degree in 0..=degree {
            // In f64, with the weights of the upscaler itself.
            let curve = polynomial(degree);
            for at in 0..40 {
                let lattice = Lattice { scale: Scale::FOUR, anchor: Anchor::Centre };
                let taps = axis_taps(method.weights, lattice, at, 12);
                let place = (f64::from(at) + 0.5) / 4.0 - 0.5;
                if (2.0..9.0).contains(&place) {
                    let sum: f64 = taps.iter().map(|(sample, weight)| weight * curve(f64::from(*sample))).sum();
                    assert!((sum - curve(place)).abs() < 1e-9, "{} of degree {degree} at {place}", method.id);
                }
            }
        }
    }
}
