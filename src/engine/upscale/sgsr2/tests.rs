use super::kernel::{Axis, Position, Shape};
use super::*;
use crate::upscale::Rejection;
use crate::upscale::history::tests::frames;
use crate::upscale::test_sequence::TestSequence;

fn how(scale: Scale) -> Upscaling {
    Upscaling::new("sgsr2", scale).unwrap()
}

/// Returns SGSR 2 at every scale, in both colour spaces.
fn every() -> impl Iterator<Item = Upscaling> {
    let offers = SGSR2.offers();
    let lit = |scale| offers.lights.iter().map(move |light| how(scale).with_light(*light));
    offers.scales.iter().flat_map(move |scale| lit(*scale))
}

#[test]
fn rows_are_bit_identical_to_single_pixels_and_steps() {
    let mut random = fastrand::Rng::with_seed(8);
    let size = (45, 9);
    for how in every() {
        let (columns, rows) = (how.lattice().samples(size.0), how.lattice().samples(size.1));
        let color = Image::from_fn(columns, rows, |_, _| std::array::from_fn(|_| random.u8(..)));
        for frames in frames(how, size, 7) {
            let drawn = UpscaleInputs { color: &color, frame: Some(frames.seen()) };
            let frame = Sgsr2Frame::new(how, &drawn, size);
            let mut surfaces = frame.surface_rows();
            for lanes in Lanes::all() {
                let mut full = Image::filled(size.0, size.1, [1, 2, 3, 4]);
                let mut memory = Image::filled(size.0, size.1, [-7.0; 4]);
                fill(lanes, how, &drawn, &mut full, &mut memory);
                for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
                    let row = (full.at(x, y), memory.at(x, y).map(f32::to_bits));
                    let pixel = frame.pixel((x, y), &mut surfaces);
                    let context = || format!("({x}, {y}) {} {}", how.label(), lanes.name());
                    assert_eq!(row, (pixel.codes, pixel.memory.map(f32::to_bits)), "{}", context());
                    assert_eq!(row.0.first_chunk(), Some(&pixel.step.codes()), "{}", context());
                }
            }
        }
    }
}

#[test]
fn weights_are_the_published_polynomial_of_the_squared_distance() {
    let how = how(Scale::TWO);
    for place in [[0.5, 0.5], [0.1, 0.7], [0.9, 0.3]] {
        let [columns, rows] = place.map(|place| Axis::new(how.lattice(), place, 24, 12));
        for (at, narrowing) in [((8, 8), 1.0_f32), ((9, 10), 0.7), ((11, 7), 0.25)] {
            let distance = |index: u32, place: f64, at: u32| f64::from(index) + place - (f64::from(at) + 0.5) / 2.0;
            for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
                let (x, y) = (columns.index[at.0][column], rows.index[at.1][row]);
                let squared = distance(x, place[0], at.0 as u32).powi(2) + distance(y, place[1], at.1 as u32).powi(2);
                let end = (squared * f64::from(narrowing)).min(1.0);
                let expected = (end - 1.0).powi(3) * (end - 0.25);
                let found = on_lanes!(Lanes::baseline(), simd => {
                    let position = Position { columns: columns.splat(simd, at.0), rows: rows.splat(simd, at.1) };
                    let shape = Shape { narrowing: f32x16::splat(simd, narrowing), fast: f32x16::splat(simd, 0.0) };
                    position.weight(simd, shape, (row, column)).to_array()[0]
                });
                assert!((f64::from(found) - expected).abs() < 1e-5, "{at:?} {row} {column}: {found} {expected}");
            }
        }
    }
}

/// Returns the root mean square of the differences from the box-filtered picture, two pixels from the border.
fn rms(picture: &Image<Rgba8>, code: impl Fn([f64; 2]) -> u8) -> f64 {
    const STEPS: u32 = 12;
    let offset = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
    let places = || (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| [offset(i), offset(j)]));
    let mean = |x: u32, y: u32| {
        let codes = places().map(|[dx, dy]| f64::from(code([f64::from(x) + dx, f64::from(y) + dy])));
        codes.sum::<f64>() / f64::from(STEPS * STEPS)
    };
    let pixels = (2..picture.height() - 2).flat_map(|y| (2..picture.width() - 2).map(move |x| (x, y)));
    let squares: Vec<f64> = pixels.map(|(x, y)| (f64::from(picture.at(x, y)[0]) - mean(x, y)).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Slanted edge beside fine stripes.
fn detail([x, y]: [f64; 2]) -> u8 {
    let is_light = if x < 16.0 { x + 0.4 * y < 12.0 } else { (x * 0.9 + 0.3 * y).sin() > 0.0 };
    if is_light { 220 } else { 40 }
}

#[test]
fn a_still_view_settles_near_the_mean_of_all_samples() {
    for scale in [Scale::ONE_AND_A_HALF, Scale::TWO, Scale::THREE] {
        let how = how(scale).with_light(FilterSpace::Bytes);
        let mut sequence = TestSequence::new(how, (32, 16), None);
        let drawn: Vec<_> = (0..SGSR2.converges_after(how) + 4).map(|_| sequence.frame(detail)).collect();
        let settled = &drawn[SGSR2.converges_after(how) as usize - 1];
        assert!(drawn.iter().rev().take(5).all(|picture| picture == settled), "×{scale}");
        let (first, last) = (rms(&drawn[0], detail), rms(settled, detail));
        assert!(last < 16.0 && last < first / 2.0, "×{scale}: {last} {first}");
    }
}

#[test]
fn history_improves_moving_edges() {
    let how = how(Scale::TWO).with_light(FilterSpace::Bytes);
    // A quarter of a pixel per frame, and sixteen frames: the picture has moved by whole pixels.
    let edge = |[x, y]: [f64; 2]| if x + 0.4 * y < 12.0 { 220 } else { 40 };
    let mut sequence = TestSequence::new(how, (32, 16), Some(0.25));
    let drawn: Vec<_> = (0..17).map(|_| sequence.frame(edge)).collect();
    let (first, last) = (rms(&drawn[0], edge), rms(&drawn[16], |[x, y]| edge([x - 4.0, y])));
    assert!(last < 0.7 * first, "{last} {first}");
}

#[test]
fn disoccluded_pixels_show_the_present_only() {
    for how in every() {
        let mut sequence = TestSequence::new(how, (24, 10), Some(0.0));
        for _ in 0..3 {
            sequence.frame(|_| 200);
        }
        let color = sequence.samples(|[x, _]| if x < 11.0 { 30 } else { 90 });
        let vectors = sequence.vectors(0);
        let drawn = UpscaleInputs { color: &color, frame: Some(sequence.inputs(Some(&vectors))) };
        let hidden = how.upscale(&drawn, 24, 10);
        // The present may leave the range of the samples by a little.
        assert!(hidden.pixels().iter().all(|[r, ..]| *r <= 120), "{}", how.label());
        let step = SGSR2.history_steps(how, &drawn)((3, 4)).unwrap();
        assert_eq!((step.share, step.past), (1.0, Err(Rejection::Disoccluded)));
    }
}

#[test]
fn a_picture_of_one_colour_stays_so_in_all_frames() {
    for how in every() {
        for motion_px in [None, Some(0.0), Some(1.7)] {
            let mut sequence = TestSequence::new(how, (20, 11), motion_px);
            for frame in 0..8 {
                let picture = sequence.frame(|_| 87);
                assert!(picture.pixels().iter().all(|codes| *codes == [87, 87, 87, 255]), "{} {frame}", how.label());
            }
        }
    }
}
