use std::collections::BTreeSet;

use super::*;

fn noise(random: &mut fastrand::Rng, width: u32, height: u32) -> Image<Rgba8> {
    // Extreme values half of the time: they make cubics overshoot.
    Image::from_fn(width, height, |_, _| {
        std::array::from_fn(|_| if random.bool() { random.u8(..) } else { 255 * random.u8(..2) })
    })
}

/// Simulates the rasterizer: copies the drawn pixels of `full`, and fills packed pixels without a sample with an
/// arbitrary colour. A lower-resolution image copies nearby pixels of `full`.
fn draw(full: &Image<Rgba8>, how: Upscaling) -> Image<Rgba8> {
    let (raster_width, raster_height) = how.sampling().raster_size(full.width(), full.height());
    let (width, height) = how.grid().packed_size(raster_width, raster_height);
    Image::from_fn(width, height, |column, row| match how.sampling() {
        Sampling::Grid(grid) => {
            let (x, y) = grid.pixel(column, row);
            full.get(x, y).unwrap_or([255, 0, 173, 1])
        }
        Sampling::Lattice(lattice) => {
            let [x, y] = [column, row].map(|index| lattice.position_px(index) as i64);
            full.at_clamped(x, y)
        }
    })
}

/// Returns every upscaler with every combination of its options.
fn everything() -> impl Iterator<Item = Upscaling> {
    Upscaling::every().flat_map(|how| {
        let offers = how.upscaler().offers();
        let lit = offers
            .anchors
            .iter()
            .flat_map(move |anchor| offers.lights.iter().map(move |light| how.with_anchor(*anchor).with_light(*light)));
        lit.flat_map(move |how| {
            let ringing = if offers.deringing { &[false, true][..] } else { &[false] };
            let sharpening = if offers.sharpening { &[0, 70][..] } else { &[0] };
            let chosen = ringing.iter().map(move |deringing| how.with_deringing(*deringing));
            chosen.flat_map(|how| sharpening.iter().map(move |percent| how.with_sharpening(*percent)))
        })
    })
}

/// Calls `check` for every upscaler, combination of options and small image size, with the upscaled image, the native
/// image and the drawn samples.
fn for_every_method_and_size(mut check: impl FnMut(Upscaling, &Image<Rgba8>, &Image<Rgba8>, &UpscaleInputs<'_>)) {
    let mut random = fastrand::Rng::with_seed(17);
    for (width, height) in [(1, 1), (2, 1), (1, 2), (3, 2), (4, 4), (5, 9), (7, 6), (12, 5), (13, 8)] {
        let native = noise(&mut random, width, height);
        for how in everything() {
            let color = draw(&native, how);
            let drawn = UpscaleInputs::from(&color);
            let full = how.upscale(&drawn, width, height);
            assert_eq!(full.size(), (width, height), "{}", how.label());
            check(how, &full, &native, &drawn);
        }
    }
}

fn places(image: &Image<Rgba8>) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (width, height) = image.size();
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

#[test]
fn a_sample_stands_for_the_pixel_that_it_lies_in() {
    for how in everything() {
        for full @ (width, height) in [(1, 1), (5, 9), (12, 5), (33, 20)] {
            let sampling = how.sampling();
            let raster = sampling.raster_size(width, height);
            let sample_at = |(x, y)| match sampling {
                Sampling::Grid(grid) => grid.sample_at(x, y),
                Sampling::Lattice(lattice) => Some((lattice.nearest(x, raster.0), lattice.nearest(y, raster.1))),
            };
            for sample in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).filter_map(sample_at) {
                let pixel = sampling.pixel(sample, full);
                assert_eq!(sample_at(pixel), Some(sample), "{} {full:?} {pixel:?}", how.label());
            }
        }
    }
}

#[test]
fn previous_contents_of_the_image_do_not_matter() {
    for_every_method_and_size(|how, full, _, drawn| {
        let mut again = Image::filled(full.width(), full.height(), [7, 77, 177, 3]);
        how.upscaler().upscale(how, drawn, &mut again);
        assert_eq!(again, *full, "{}", how.label());
    });
}

#[test]
fn a_single_pixel_equals_that_of_the_whole_image() {
    for_every_method_and_size(|how, full, _, drawn| {
        for at in places(full) {
            let alone = how.upscaler().pixel(how, drawn, full.size(), at);
            assert_eq!(full.at(at.0, at.1), alone, "{} {:?} {at:?}", how.label(), full.size());
        }
    });
}

#[test]
fn a_pixel_needs_no_other_samples_than_its_taps() {
    for_every_method_and_size(|how, full, _, drawn| {
        // Every pixel of small images, and a third of those of others.
        for at in places(full).step_by(if full.width() < 5 { 1 } else { 3 }) {
            let taps = how.upscaler().taps(how, drawn, full.size(), at);
            let needed = |column, row| {
                let (x, y) = how.grid().pixel(column, row);
                taps.iter().any(|tap| (tap.x, tap.y) == (x, y))
            };
            let (columns, rows) = drawn.color.size();
            let sparse = Image::from_fn(columns, rows, |column, row| {
                if needed(column, row) { drawn.color.at(column, row) } else { [255, 0, 173, 1] }
            });
            let alone = how.upscaler().pixel(how, &UpscaleInputs::from(&sparse), full.size(), at);
            assert_eq!(full.at(at.0, at.1), alone, "{} {:?} {at:?}", how.label(), full.size());
        }
    });
}

#[test]
fn every_pixel_is_the_sum_of_its_taps_but_for_rounding() {
    for_every_method_and_size(|how, full, _, drawn| {
        if how.light() == FilterSpace::Linear
            || how.deringing()
            || ["fsr1", "nis", "fsr2", "sgsr2"].contains(&how.method())
        {
            return;
        }
        let sampled = |tap: &Tap| how.grid().sample_at(tap.x, tap.y).map(|(column, row)| drawn.color.at(column, row));
        for (x, y) in places(full) {
            let taps = how.upscaler().taps(how, drawn, full.size(), (x, y));
            let context = || format!("{} {:?} ({x}, {y}): {taps:?}", how.label(), full.size());
            for channel in 0..4 {
                let terms = taps.iter().filter_map(|tap| Some((tap.weight, sampled(tap)?[channel])));
                let sum: f64 = terms.map(|(weight, code)| f64::from(weight) * f64::from(code)).sum();
                let error = (f64::from(full.at(x, y)[channel]) - sum.clamp(0.0, 255.0)).abs();
                assert!(error <= 0.6, "{}: {sum} in channel {channel}", context());
            }
            assert!((taps.iter().map(|t| f64::from(t.weight)).sum::<f64>() - 1.0).abs() < 1e-6, "{}", context());
            for (i, tap) in taps.iter().enumerate() {
                assert!(sampled(tap).is_some(), "not drawn: {}", context());
                assert!(taps[..i].iter().all(|t| (t.x, t.y) != (tap.x, tap.y)), "twice: {}", context());
            }
        }
    });
}

#[test]
fn drawn_pixels_come_out_unchanged_unless_the_upscaler_alters_them() {
    let mut altering = BTreeSet::new();
    for_every_method_and_size(|how, full, native, _| {
        let Sampling::Grid(grid) = how.sampling() else { return };
        for (x, y) in places(full).filter(|(x, y)| grid.sample_at(*x, *y).is_some()) {
            if how.upscaler().alters_samples() {
                altering.extend((full.at(x, y) != native.at(x, y)).then(|| how.method()));
            } else {
                assert_eq!(full.at(x, y), native.at(x, y), "{} {:?} ({x}, {y})", how.label(), full.size());
            }
        }
    });
    let declared = BUILT_IN.iter().filter(|upscaler| upscaler.alters_samples()).map(|upscaler| upscaler.id());
    assert_eq!(altering, declared.collect());
}

#[test]
fn a_picture_of_one_colour_stays_so() {
    for how in everything() {
        for colour in [[0; 4], [255; 4], [1, 127, 128, 254], [13, 77, 201, 255]] {
            let native = Image::filled(11, 7, colour);
            let full = how.upscale(&UpscaleInputs::from(&draw(&native, how)), 11, 7);
            assert_eq!(full, native, "{}", how.label());
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let native = noise(&mut fastrand::Rng::with_seed(3), 9, 301);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let three = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    for how in everything() {
        let color = draw(&native, how);
        let full = |pool: &rayon::ThreadPool| pool.install(|| how.upscale(&UpscaleInputs::from(&color), 9, 301));
        assert!(full(&one) == full(&three), "{}", how.label());
    }
}

#[test]
fn an_empty_picture_stays_empty() {
    for how in everything() {
        for (width, height) in [(0, 0), (0, 5), (5, 0)] {
            let drawn = draw(&Image::filled(width, height, [0; 4]), how);
            let full = how.upscale(&UpscaleInputs::from(&drawn), width, height);
            assert_eq!(full.size(), (width, height), "{}", how.label());
        }
    }
}

#[test]
fn the_nearest_offered_scale_is_used_and_options_not_offered_are_dropped() {
    let labels = [("checkerboard", 4), ("bilinear", 1), ("bicubic", 99)]
        .map(|(method, scale)| Upscaling::new(method, Scale::from(scale)).map(Upscaling::label).unwrap_or_default());
    assert_eq!(labels, ["Checkerboard", "Bilinear ×1.3", "Bicubic ×4"]);
    assert_eq!(Upscaling::new("sinc", Scale::TWO), None);
    let chosen = Upscaling::new("lanczos3", Scale::ONE_AND_A_HALF).unwrap();
    let chosen = chosen.with_anchor(Anchor::Centre).with_light(FilterSpace::Linear).with_deringing(true);
    assert_eq!(chosen.label(), "Lanczos 3 ×1.5, centre, linear, de-ringed");
    assert_eq!(chosen.with_method("native"), Some(Upscaling::NATIVE));
    assert_eq!(chosen.with_method("mitchell").unwrap().label(), "Mitchell ×1.5");
}

#[test]
fn native_rendering_gives_way_to_the_default_scale_of_a_method() {
    let labels = ["bilinear", "fsr1", "fsr2", "taa", "accumulation", "checkerboard"]
        .map(|method| Upscaling::NATIVE.with_method(method).map(Upscaling::label).unwrap_or_default());
    assert_eq!(
        labels,
        ["Bilinear ×1.5", "FSR 1 ×1.5", "FSR 2 ×1.5", "TAA ×1", "Temporal accumulation ×1", "Checkerboard"]
    );
    for upscaler in BUILT_IN {
        assert!(upscaler.offers().scales.contains(&Upscaling::NATIVE.with_method(upscaler.id()).unwrap().scale()));
    }
}

#[test]
fn a_choice_round_trips_and_an_unknown_upscaler_lists_the_known_ones() {
    for how in everything() {
        let written = serde_json::to_string(&how).unwrap();
        assert_eq!(serde_json::from_str::<Upscaling>(&written).unwrap(), how, "{written}");
    }
    let short: Upscaling = serde_json::from_str(r#"{"method":"bilinear","scale":2}"#).unwrap();
    assert_eq!(Some(short), Upscaling::new("bilinear", Scale::TWO));
    let error = serde_json::from_str::<Upscaling>(r#"{"method":"dlss","scale":2}"#).unwrap_err().to_string();
    assert!(error.contains("`dlss`") && error.contains("`bicubic`"), "{error}");
}

#[test]
fn ids_are_distinct_and_lead_back_to_their_method() {
    for upscaler in BUILT_IN {
        let choice = Upscaling::new(upscaler.id(), Scale::ONE).map(Upscaling::method);
        assert_eq!(choice, Some(upscaler.id()));
    }
}

#[test]
fn every_built_in_upscaler_names_its_artefacts() {
    for upscaler in BUILT_IN {
        assert!(!upscaler.artefacts().is_empty(), "{}", upscaler.id());
    }
}
