use std::sync::Arc;

use super::*;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::MotionVectors;
use crate::pipeline::settings::Choice as _;
use crate::upscale::history::tests::frames;
use crate::upscale::{Accumulated, FrameInputs, History, HistoryOptions, Rectification};

/// Returns TAA with every combination of options at every scale.
fn every() -> Vec<Upscaling> {
    let mut all = Vec::new();
    for scale in TAA.offers().scales {
        for rectification in Rectification::ALL {
            for (filter, light) in HistoryFilter::ALL.iter().zip(TAA.offers().lights) {
                let options = HistoryOptions {
                    rectification: *rectification,
                    filter: *filter,
                    luminance_weighting: *filter == HistoryFilter::Bilinear,
                };
                all.push(Upscaling::new("taa", *scale).unwrap().with_light(*light).with_history(options));
            }
        }
    }
    all
}

#[test]
fn rows_are_bit_identical_to_single_pixels() {
    let mut random = fastrand::Rng::with_seed(8);
    let size = (75, 9);
    for (number, how) in every().into_iter().enumerate() {
        let (columns, rows) = (how.lattice().samples(size.0), how.lattice().samples(size.1));
        let color = Image::from_fn(columns, rows, |_, _| std::array::from_fn(|_| random.u8(..)));
        for frames in frames(how, size, 7) {
            let drawn = UpscaleInputs { color: &color, frame: Some(frames.seen()) };
            let frame = TaaFrame::new(how, &drawn, size);
            for lanes in Lanes::all() {
                let mut full = Image::filled(size.0, size.1, [1, 2, 3, 4]);
                let mut memory = Image::filled(size.0, size.1, [-7.0; 4]);
                fill(lanes, how, &drawn, &mut full, &mut memory);
                // Every pixel is compared with some of the options.
                let pixels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
                for at in pixels.skip(number % 7).step_by(7) {
                    let pixel = frame.pixel(at, &mut frame.scratch());
                    let bits = [pixel.memory, memory.at(at.0, at.1)].map(|quad| quad.map(f32::to_bits));
                    let context = || format!("{at:?} {} {}", how.label(), lanes.name());
                    assert_eq!((full.at(at.0, at.1), bits[1]), (pixel.codes, bits[0]), "{}", context());
                    assert_eq!(pixel.codes.first_chunk(), Some(&pixel.step.codes()), "{}", context());
                }
            }
        }
    }
}

/// Picture of one frame: a grey step edge at a column, seen through jittered samples.
fn edge(how: Upscaling, size: (u32, u32), frame: u32, column: f64) -> Image<Rgba8> {
    let (lattice, [place, _]) = (how.lattice(), jitter_of(how.scale()).place(frame));
    Image::from_fn(lattice.samples(size.0), lattice.samples(size.1), |x, _| {
        let x_px = (f64::from(x) + place) * lattice.scale.value();
        if x_px < column { [40, 40, 40, 255] } else { [220, 220, 220, 255] }
    })
}

#[test]
fn rectification_removes_ghosts_and_nothing_else_does() {
    let size = (24, 6);
    let surfaces = GBuffer { object: Image::filled(24, 6, [0; 4]), distance: Image::filled(24, 6, 1.0) };
    let vectors = MotionVectors {
        across_px: Image::filled(24, 6, 0.0),
        down_px: Image::filled(24, 6, 0.0),
        visible: Image::filled(24, 6, MotionVectors::VISIBLE),
    };
    let scene = Arc::new(crate::scene::builtin::ALL[0].build());
    for rectification in Rectification::ALL {
        let options = HistoryOptions { rectification: *rectification, ..HistoryOptions::DEFAULT };
        let how = Upscaling::new("taa", 1).unwrap().with_history(options);
        // The light area covered columns 4 to 24 in the history, and covers columns 18 to 24 now.
        let history = History {
            picture: None,
            accumulated: Some(Accumulated {
                color: Image::from_fn(24, 6, |x, _| [if x < 4 { 0.02 } else { 0.7 }, 0.0, 0.0, 9.0]),
                locks: None,
            }),
            surfaces: Arc::new(surfaces.clone()),
            camera: scene.home,
            scene: Arc::clone(&scene),
            frames: 3,
            still_frames: 1,
        };
        let color = edge(how, size, 4, 18.0);
        let frame = FrameInputs {
            size,
            sampling: how.sampling(),
            gbuffer: &surfaces,
            motion: Some(&vectors),
            history: Some(&history),
            reactivity: None,
        };
        let drawn = UpscaleInputs { color: &color, frame: Some(frame) };
        let [r, ..] = TAA.pixel(how, &drawn, size, (10, 3));
        let is_ghost = r > 41;
        assert_eq!(is_ghost, *rectification == Rectification::None, "{rectification:?}: {r}");
    }
}

#[test]
fn catmull_rom_reproduces_its_spline() {
    // A cubic through four values, written out: p(t) of Catmull and Rom for values at −1, 0, 1 and 2.
    let values = [3.0_f64, -1.0, 4.0, 1.5];
    for step in 0..=10 {
        let t = f64::from(step) / 10.0;
        let [a, b, c, d] = values;
        let expected = 0.5
            * (2.0 * b
                + (c - a) * t
                + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
                + (3.0 * b - a - 3.0 * c + d) * t * t * t);
        let weights = on_lanes!(Lanes::best(), simd => {
            rows::catmull_rom(f32x16::splat(simd, t as f32)).map(|weights| weights.to_array()[0])
        });
        let found: f64 = weights.iter().zip(values).map(|(weight, value)| f64::from(*weight) * value).sum();
        assert!((found - expected).abs() < 1e-5, "{t}: {found} {expected}");
    }
}
