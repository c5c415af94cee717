use super::kernel::{history_weights, lanczos2};
use super::*;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::MotionVectors;
use crate::upscale::history::tests::frames;
use crate::upscale::test_sequence::TestSequence;
use crate::upscale::{FrameInputs, History};

/// Returns FSR 2 at every scale, in both colour spaces.
fn every() -> impl Iterator<Item = Upscaling> {
    let offers = FSR2.offers();
    let lit = |scale| offers.lights.iter().map(move |light| how(scale).with_light(*light));
    offers.scales.iter().flat_map(move |scale| lit(*scale))
}

fn how(scale: Scale) -> Upscaling {
    Upscaling::new("fsr2", scale).unwrap()
}

/// Published kernel, written out: an approximation of the radial Lanczos kernel with two lobes.
fn published(distance: f64) -> f64 {
    let squared = (distance * distance).min(4.0);
    let wave = 25.0 / 16.0 * (2.0 / 5.0 * squared - 1.0).powi(2) - (25.0 / 16.0 - 1.0);
    wave * (squared / 4.0 - 1.0).powi(2)
}

#[test]
fn rows_are_bit_identical_to_single_pixels() {
    let mut random = fastrand::Rng::with_seed(8);
    let size = (75, 9);
    for how in every() {
        let (columns, rows) = (how.lattice().samples(size.0), how.lattice().samples(size.1));
        let color = Image::from_fn(columns, rows, |_, _| std::array::from_fn(|_| random.u8(..)));
        for (number, frames) in frames(how, size, 7).into_iter().enumerate() {
            let drawn = UpscaleInputs { color: &color, frame: Some(frames.seen()) };
            let frame = Fsr2Frame::new(how, &drawn, size);
            let sharpened = how.with_sharpening(60).upscale(&drawn, size.0, size.1);
            for lanes in Lanes::all() {
                let mut full = Image::filled(size.0, size.1, [1, 2, 3, 4]);
                let mut memory = Accumulated::with_locks_reusing(None, size);
                fill(lanes, how, &drawn, &mut full, &mut memory);
                let locks = memory.locks.unwrap();
                // Every pixel is compared in some of the frames.
                let pixels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
                for (x, y) in pixels.skip(number % 5).step_by(5) {
                    let row =
                        (full.at(x, y), memory.color.at(x, y).map(f32::to_bits), locks.at(x, y).map(f32::to_bits));
                    let pixel = frame.pixel((x, y), &mut frame.scratch());
                    let bits = (pixel.codes, pixel.color.map(f32::to_bits), pixel.lock.map(f32::to_bits));
                    assert_eq!(row, bits, "({x}, {y}) {} {}", how.label(), lanes.name());
                    assert_eq!(pixel.codes.first_chunk(), Some(&pixel.step.codes()), "({x}, {y}) {}", how.label());
                    if y % 4 == 0 {
                        let alone = FSR2.pixel(how.with_sharpening(60), &drawn, size, (x, y));
                        assert_eq!(sharpened.at(x, y), alone, "({x}, {y}) {}, sharpened", how.label());
                    }
                }
            }
        }
    }
}

#[test]
fn the_kernel_is_the_published_one_and_near_lanczos() {
    for step in 0..=2500 {
        let distance = f64::from(step) / 1000.0;
        let squared = (distance * distance) as f32;
        let [found, ..] = on_lanes!(Lanes::baseline(), simd => lanczos2(f32x16::splat(simd, squared)).to_array());
        assert!((f64::from(found) - published(distance)).abs() < 1e-5, "{distance}: {found}");
        let sinc = |x: f64| if x == 0.0 { 1.0 } else { (std::f64::consts::PI * x).sin() / (std::f64::consts::PI * x) };
        let lanczos = if distance < 2.0 { sinc(distance) * sinc(distance / 2.0) } else { 0.0 };
        assert!((f64::from(found) - lanczos).abs() < 0.05, "{distance}: {found} {lanczos}");
    }
    for step in 0..100 {
        let t = f64::from(step) / 100.0;
        let weights = on_lanes!(Lanes::baseline(), simd => {
            history_weights(f32x16::splat(simd, t as f32)).map(|weights| weights.to_array()[0])
        });
        let expected = [1.0 + t, t, 1.0 - t, 2.0 - t].map(published);
        let sum: f64 = expected.iter().sum();
        for (found, expected) in weights.iter().zip(expected) {
            assert!((f64::from(*found) - expected / sum).abs() < 1e-5, "{t}: {weights:?}");
        }
    }
}

#[test]
fn samples_are_weighted_by_their_distances() {
    let size = (24, 18);
    for how in every() {
        let step = how.scale().value();
        let mut sequence = TestSequence::new(how, size, None);
        for frame in 0..6 {
            let color = sequence.samples(|_| 99);
            let drawn = UpscaleInputs { color: &color, frame: Some(sequence.inputs(None)) };
            let place = jitter_of(how.scale()).place(frame);
            for at in [(8, 8), (9, 8), (10, 9), (11, 7)] {
                let weight = sequence
                    .history
                    .as_ref()
                    .map_or(0.0, |past| f64::from(past.accumulated.as_ref().unwrap().color.at(at.0, at.1)[3]));
                let narrowing = (1.0 + (step - 1.0) * ((weight - 0.5) / 3.0).clamp(0.0, 1.0)).min(1.99);
                let taps = FSR2.taps(how, &drawn, size, at);
                let offset =
                    |index: u32, place: f64, at: u32| (f64::from(index) + place) - (f64::from(at) + 0.5) / step;
                let expected: Vec<f64> = taps
                    .iter()
                    .map(|tap| {
                        published(offset(tap.x, place[0], at.0).hypot(offset(tap.y, place[1], at.1)) * narrowing)
                    })
                    .collect();
                let sum: f64 = expected.iter().sum();
                assert_eq!(taps.len(), 9);
                if sum < 0.06 {
                    continue;
                }
                for (tap, expected) in taps.iter().zip(expected) {
                    let error = (f64::from(tap.weight) - expected / sum).abs();
                    assert!(error < 1e-4, "{} frame {frame} {at:?}: {tap:?} {}", how.label(), expected / sum);
                }
            }
            sequence.frame(|_| 99);
        }
    }
}

#[test]
fn a_picture_of_one_colour_stays_so_in_all_frames() {
    for how in every() {
        for is_moving in [false, true] {
            let mut sequence = TestSequence::new(how.with_sharpening(40), (20, 11), None);
            sequence.motion_px = is_moving.then_some(0.0);
            for frame in 0..8 {
                let picture = sequence.frame(|_| 87);
                assert!(picture.pixels().iter().all(|codes| *codes == [87, 87, 87, 255]), "{} {frame}", how.label());
            }
        }
    }
}

#[test]
fn disoccluded_pixels_show_the_present_only() {
    let size = (24, 10);
    for how in every() {
        let mut sequence = TestSequence::new(how, size, None);
        for _ in 0..3 {
            sequence.frame(|_| 200);
        }
        let color = sequence.samples(|[x, _]| if x < 11.0 { 30 } else { 90 });
        let vectors = sequence.vectors(0);
        let frame = sequence.inputs(Some(&vectors));
        let hidden = how.upscale(&UpscaleInputs { color: &color, frame: Some(frame) }, size.0, size.1);
        let empty = sequence.history.clone().map(|past| History { accumulated: None, ..past });
        let frame = FrameInputs { history: empty.as_ref(), ..frame };
        let alone = how.upscale(&UpscaleInputs { color: &color, frame: Some(frame) }, size.0, size.1);
        assert_eq!(hidden, alone, "{}", how.label());
        assert!(hidden.pixels().iter().all(|[r, ..]| (30..=90).contains(r)), "{}", how.label());
    }
}

#[test]
fn locks_keep_thin_lines_that_rectification_would_fade() {
    // A dark line of 0.4 pixels: many frames have no sample on it.
    let line = |[x, _]: [f64; 2]| if (10.3..10.7).contains(&x) { 20 } else { 180 };
    for scale in [Scale::TWO, Scale::THREE] {
        let how = how(scale);
        let frames = jitter_of(scale).positions();
        let [locked, unlocked] = [true, false].map(|has_locks| {
            let mut sequence = TestSequence::new(how, (24, 9), None);
            sequence.motion_px = Some(0.0);
            let mut contrast = 0.0;
            for frame in 0..2 * frames {
                let picture = sequence.frame(line);
                if !has_locks && let Some(past) = &mut sequence.history {
                    past.accumulated.as_mut().unwrap().locks = None;
                }
                if frame >= frames {
                    // All rows: how many samples hit the line depends on the row's position among the samples.
                    let rows = (0..9).map(|y| f64::from(180 - picture.at(10, y)[0].min(180)));
                    contrast += rows.sum::<f64>() / (9.0 * f64::from(frames));
                }
            }
            contrast
        });
        assert!(locked > 20.0 && unlocked < 2.0, "×{scale}: {locked} {unlocked}");
    }
}

/// Returns the share of the present and the stored lock of a pixel after frames with a reactivity, which ends with the last
/// frame. The scene moves.
fn blending_of(reactivity: f32, at: (u32, u32), code: impl Fn([f64; 2]) -> u8) -> (f64, f32) {
    let mut sequence = TestSequence::new(how(Scale::TWO), (24, 9), None);
    sequence.motion_px = Some(0.0);
    for _ in 0..70 {
        sequence.frame(&code);
    }
    sequence.reactivity = reactivity;
    let (color, vectors, table) = (sequence.samples(&code), sequence.vectors(MotionVectors::VISIBLE), [reactivity]);
    let frame = FrameInputs { reactivity: Some(&table), ..sequence.inputs(Some(&vectors)) };
    let drawn = UpscaleInputs { color: &color, frame: Some(frame) };
    let share = FSR2.history_steps(how(Scale::TWO), &drawn)(at).unwrap().share;
    sequence.frame(&code);
    let locks = sequence.history.unwrap().accumulated.unwrap().locks.unwrap();
    (share.into(), locks.at(at.0, at.1)[0])
}

#[test]
fn the_limit_of_the_weight_and_locks_shrink_with_the_reactivity() {
    let (at, line) = ((10, 4), |[x, _]: [f64; 2]| if (10.3..10.7).contains(&x) { 20 } else { 180 });
    let (usual, lock) = blending_of(0.0, at, line);
    assert!(lock > 0.1 && usual < 0.2, "{lock} {usual}");
    for reactivity in [0.3, 0.9] {
        let (share, reactive_lock) = blending_of(reactivity, at, line);
        // f / (L + f) with the limit L of the accumulated weight, which the pixel has reached, becomes f / (k L + f).
        let kept = 1.0 - f64::from(reactivity);
        let expected = 1.0 / (1.0 + kept * (1.0 / usual - 1.0));
        assert!((share - expected).abs() < 1e-5, "{reactivity}: {share} {expected}");
        let expired = 1.0 / f64::from(jitter_of(Scale::TWO).positions());
        let expected = ((f64::from(lock) + expired) * kept - expired).max(0.0);
        assert!((f64::from(reactive_lock) - expected).abs() < 1e-5, "{reactivity}: {reactive_lock} {expected}");
    }
}

#[test]
fn reactive_rows_are_bit_identical_to_single_pixels() {
    let mut random = fastrand::Rng::with_seed(5);
    let (size, how) = ((53, 7), how(Scale::TWO));
    let color = Image::from_fn(27, 4, |_, _| std::array::from_fn(|_| random.u8(..)));
    let object = Image::from_fn(27, 4, |_, _| random.u32(0..4).to_le_bytes());
    let distance = Image::from_fn(27, 4, |x, _| 1.0 + x as f32);
    let gbuffer = GBuffer { object, distance };
    for frames in frames(how, size, 7) {
        let frame = FrameInputs { gbuffer: &gbuffer, reactivity: Some(&[0.0, 0.4, 0.9]), ..frames.seen() };
        let drawn = UpscaleInputs { color: &color, frame: Some(frame) };
        let frame = Fsr2Frame::new(how, &drawn, size);
        for lanes in Lanes::all() {
            let mut full = Image::filled(size.0, size.1, [0; 4]);
            let mut memory = Accumulated::with_locks_reusing(None, size);
            fill(lanes, how, &drawn, &mut full, &mut memory);
            for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
                let pixel = frame.pixel((x, y), &mut frame.scratch());
                let color = memory.color.at(x, y).map(f32::to_bits);
                assert_eq!((full.at(x, y), color), (pixel.codes, pixel.color.map(f32::to_bits)), "({x}, {y})");
            }
        }
    }
}

#[test]
fn a_lock_ends_when_its_line_disappears_or_light_changes() {
    let line = |[x, _]: [f64; 2]| if (10.0..11.0).contains(&x) { 20 } else { 180 };
    let mut sequence = TestSequence::new(how(Scale::TWO), (24, 9), None);
    sequence.motion_px = Some(0.0);
    for _ in 0..32 {
        sequence.frame(line);
    }
    let darkness = |picture: &Image<Rgba8>| 180 - i32::from(picture.at(10, 4)[0]);
    assert!(darkness(&sequence.frame(line)) > 60);
    let history = sequence.history.clone();
    let vanished = (0..40).map(|_| darkness(&sequence.frame(|_| 180))).last();
    assert!(vanished < Some(4), "{vanished:?}");
    sequence.history = history;
    let lit = sequence.frame(|_| 250);
    assert!(lit.pixels().iter().all(|[r, ..]| *r > 240), "{:?}", lit.at(10, 4));
}

#[test]
fn a_still_view_settles_near_the_mean_of_all_samples() {
    // A slanted edge beside fine stripes, seen through boxes of one pixel.
    let code = |[x, y]: [f64; 2]| {
        let is_light = if x < 16.0 { x + 0.4 * y < 12.0 } else { (x * 0.9 + 0.3 * y).sin() > 0.0 };
        if is_light { 220 } else { 40 }
    };
    let size = (32, 16);
    let mean = |x: u32, y: u32| {
        let places = (0..256).map(|place| {
            [
                f64::from(x) + f64::from(place % 16) / 16.0 + 1.0 / 32.0,
                f64::from(y) + f64::from(place / 16) / 16.0 + 1.0 / 32.0,
            ]
        });
        places.map(|place| f64::from(code(place))).sum::<f64>() / 256.0
    };
    let rms = |picture: &Image<Rgba8>| {
        let pixels = (1..size.1 - 1).flat_map(|y| (1..size.0 - 1).map(move |x| (x, y)));
        let squares: Vec<f64> = pixels.map(|(x, y)| (f64::from(picture.at(x, y)[0]) - mean(x, y)).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    for (scale, most) in [(Scale::ONE_AND_A_HALF, 14.0), (Scale::TWO, 12.0), (Scale::THREE, 15.0)] {
        let how = how(scale).with_light(FilterSpace::Bytes);
        let mut sequence = TestSequence::new(how, size, None);
        let drawn: Vec<_> = (0..FSR2.converges_after(how) + 8).map(|_| sequence.frame(code)).collect();
        let (settled, first) = (&drawn[FSR2.converges_after(how) as usize - 1], rms(&drawn[0]));
        assert!(drawn.iter().rev().take(9).all(|picture| picture == settled), "×{scale}");
        assert!(rms(settled) < most && rms(settled) < first / 2.0, "×{scale}: {} {first}", rms(settled));
    }
}
