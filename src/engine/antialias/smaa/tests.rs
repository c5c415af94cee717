use super::*;

/// Returns a picture that is white below the line y = (x + ½) / `run` + 6 and black above, from the colours of pixel
/// centres or, if `by_area` is `true`, from the areas of pixels.
fn slanted(run: u32, by_area: bool) -> Image<Rgba8> {
    below_line(1.0 / f64::from(run), 6.0 + 0.5 / f64::from(run), by_area)
}

/// Returns a picture that is white below the line y = `slope` x + `start` and black above, from the colours of pixel
/// centres or, if `by_area` is `true`, from the areas of pixels.
fn below_line(slope: f64, start: f64, by_area: bool) -> Image<Rgba8> {
    Image::from_fn(90, 40, |x, y| {
        // Distance of the pixel's centre below the line at a position from 0 to 1 across the pixel.
        let inside = |at: f64| f64::from(y) + 0.5 - (f64::from(x) + at) * slope - start;
        let covered = |step: u32| (inside((f64::from(step) + 0.5) / 64.0) + 0.5).clamp(0.0, 1.0);
        let share =
            if by_area { (0..64).map(covered).sum::<f64>() / 64.0 } else { f64::from(u8::from(inside(0.5) > 0.0)) };
        [(share * 255.0).round() as u8; 4]
    })
}

/// Returns a picture filtered in sRGB codes without the diagonal patterns.
fn without_diagonals(picture: &Image<Rgba8>) -> Image<Rgba8> {
    let (lanes, mut cuts) = (Lanes::best(), BandCuts::default());
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    cuts.top.clear(width, height + 1);
    cuts.left.clear(width, height);
    let mut edges = Edges::default();
    edges.find(lanes, picture);
    let mut band = Band { picture, edges: &edges, first: 0, cuts: &mut cuts };
    band.cut_along_lines(0..height);
    let mut result = picture.clone();
    band.blend(Blender::new(lanes, picture, false), result.pixels_mut());
    result
}

/// Returns the mean difference of the red codes of two pictures of the same size, except near their border.
fn mean_difference(one: &Image<Rgba8>, other: &Image<Rgba8>) -> f64 {
    let (width, height) = one.size();
    let inner = (12..height - 12).flat_map(|y| (12..width - 12).map(move |x| (x, y)));
    let differences = inner.map(|(x, y)| f64::from(one.at(x, y)[0].abs_diff(other.at(x, y)[0])));
    differences.sum::<f64>() / f64::from((width - 24) * (height - 24))
}

fn noise(width: u32, height: u32) -> Image<Rgba8> {
    let mut random = fastrand::Rng::with_seed(11);
    Image::from_fn(width, height, |x, y| match (x / 9 + y / 6) % 3 {
        0 => [random.u8(..), random.u8(..), random.u8(..), 255],
        1 => [(x * 5) as u8, 90, 30, 255],
        _ => [230, 200, (y * 3) as u8, 40],
    })
}

fn flipped(picture: &Image<Rgba8>, [across, down]: [bool; 2]) -> Image<Rgba8> {
    let (width, height) = picture.size();
    Image::from_fn(width, height, |x, y| {
        picture.at(if across { width - 1 - x } else { x }, if down { height - 1 - y } else { y })
    })
}

#[test]
fn stairs_of_a_slanted_edge_become_the_covered_area() {
    // An odd run puts the middle of each step on a pixel centre, so the smoothed edge is the line itself.
    for run in [3, 5, 9, 15] {
        let (smoothed, truth) = (apply(&slanted(run, false), false, None), slanted(run, true));
        // Beyond one step from the border, every step has both ends.
        for (x, y) in (0..40).flat_map(|y| (2 * run..90 - 2 * run).map(move |x| (x, y))) {
            let (code, exact) = (smoothed.at(x, y)[0], truth.at(x, y)[0]);
            assert!(code.abs_diff(exact) <= 1, "1 / {run} ({x}, {y}): {code}, not {exact}");
        }
    }
}

#[test]
fn diagonals_halve_the_error_of_edges_near_45_degrees() {
    for slope in [0.75, 0.8, 0.875, 1.1, 1.2] {
        for signed in [slope, -slope] {
            let mut errors = [0.0; 2];
            for start in (0..8).map(|eighth| 20.0 - 45.0 * signed + f64::from(eighth) / 8.0) {
                let [aliased, truth] = [false, true].map(|by_area| below_line(signed, start, by_area));
                let filtered = [without_diagonals(&aliased), apply(&aliased, false, None)];
                for (sum, filtered) in errors.iter_mut().zip(filtered) {
                    *sum += mean_difference(&filtered, &truth);
                }
            }
            assert!(errors[1] < 0.5 * errors[0], "{signed}: {errors:?}");
        }
    }
}

#[test]
fn corners_are_rounded_a_quarter_as_much_as_steps() {
    // The lines end at the corner, and at a step of one pixel. Their other ends are too far away.
    let corner = Image::from_fn(60, 50, |x, y| if x >= 20 && y >= 15 { [255; 4] } else { [0, 0, 0, 255] });
    let step = Image::from_fn(60, 50, |x, y| if y >= 15 + u32::from(x < 20) { [255; 4] } else { [0, 0, 0, 255] });
    let [corner, step] = [corner, step].map(|picture| 255.0 - f64::from(apply(&picture, false, None).at(20, 15)[0]));
    assert!(step > 100.0 && (corner - 0.25 * step).abs() <= 0.75, "{corner} {step}");
}

#[test]
fn plain_pictures_soft_slopes_and_level_edges_stay() {
    let plain = Image::filled(70, 7, [3, 200, 90, 17]);
    let slope = Image::from_fn(40, 9, |x, _| [(x * 3) as u8, (x * 3) as u8, (x * 3) as u8, 255]);
    let level = Image::from_fn(100, 12, |_, y| if y < 6 { [0, 0, 0, 255] } else { [255; 4] });
    let one = Image::filled(1, 1, [9, 99, 199, 255]);
    for picture in [plain, slope, level, one] {
        assert_eq!(apply(&picture, true, None), picture);
    }
}

#[test]
fn single_pixels_stay_sharper_than_with_fxaa() {
    for [pixel, around] in [[255, 0], [0, 255], [200, 90]] {
        let picture = Image::from_fn(32, 32, |x, y| [if (x, y) == (16, 16) { pixel } else { around }; 4]);
        let changed = |filtered: Image<Rgba8>| filtered.at(16, 16)[0].abs_diff(pixel);
        let [smaa, fxaa] = [apply, crate::antialias::fxaa::apply].map(|apply| changed(apply(&picture, false, None)));
        assert!(smaa < fxaa, "{pixel} in {around}: {smaa} {fxaa}");
    }
}

/// Returns the greatest difference of red codes between the filtered picture and the mirrored result of the mirrored
/// picture.
fn difference_when_flipped(picture: &Image<Rgba8>, flips: [bool; 2]) -> u8 {
    let smoothed = apply(picture, false, None);
    let other = flipped(&apply(&flipped(picture, flips), false, None), flips);
    greatest_difference(&smoothed, &other)
}

/// Returns the greatest difference of red codes between the filtered picture and the transposed result of the transposed
/// picture.
fn difference_when_turned(picture: &Image<Rgba8>) -> u8 {
    let turned = |picture: &Image<Rgba8>| Image::from_fn(picture.height(), picture.width(), |x, y| picture.at(y, x));
    let other = turned(&apply(&turned(picture), false, None));
    greatest_difference(&apply(picture, false, None), &other)
}

fn greatest_difference(one: &Image<Rgba8>, other: &Image<Rgba8>) -> u8 {
    one.pixels().iter().zip(other.pixels()).map(|(one, other)| one[0].abs_diff(other[0])).max().unwrap()
}

const FLIPS: [[bool; 2]; 3] = [[true, false], [false, true], [true, true]];

#[test]
fn mirroring_the_picture_mirrors_the_result() {
    for run in [3, 6, 20] {
        let stairs = slanted(run, false);
        for flips in FLIPS {
            assert!(difference_when_flipped(&stairs, flips) <= 1, "1 / {run} {flips:?}");
        }
        assert!(difference_when_turned(&stairs) <= 1, "1 / {run} turned");
    }
}

#[test]
fn mirroring_a_diagonal_mirrors_the_result() {
    for slope in [0.75, 0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2, 1.3] {
        let stairs = below_line(slope, 20.1 - 45.0 * slope, false);
        assert!(stairs != apply(&stairs, false, None), "{slope}");
        // The published points of an open end lie one pixel nearer to the other end at the right end.
        for flips in FLIPS {
            assert!(difference_when_flipped(&stairs, flips) <= 2, "{slope} {flips:?}");
        }
    }
}

#[test]
fn long_diagonals_take_a_quarter_from_across_the_edge() {
    let stairs = below_line(1.0, -20.3, false);
    let smoothed = apply(&stairs, false, None);
    for x in 35..45 {
        let [above, below] = [smoothed.at(x, x - 21), smoothed.at(x, x - 20)].map(|pixel| pixel[0]);
        assert_eq!([above, below], [64, 191], "{x}");
    }
}

/// Checks that a pixel of the filtered picture follows from the neighbours within [`REACH_PX`].
fn assert_follows_from_neighbours(picture: &Image<Rgba8>, full: &Image<Rgba8>, [x, y]: [u32; 2]) {
    let side = 2 * REACH_PX + 1;
    let [left, top] = [x, y].map(|at| i64::from(at) - i64::from(REACH_PX));
    let patch =
        Image::from_fn(side, side, |column, row| picture.at_clamped(left + i64::from(column), top + i64::from(row)));
    assert_eq!(full.at(x, y), apply(&patch, true, None).at(REACH_PX, REACH_PX), "({x}, {y})");
}

#[test]
fn neighbours_within_reach_determine_a_pixel() {
    // Long lines, and lines of all lengths.
    let lines =
        Image::from_fn(150, 60, |x, y| if 2 * y > 40 + x / (10 + y / 4) { [20; 4] } else { [220, 220, 220, 255] });
    for picture in [noise(150, 50), lines] {
        let full = apply(&picture, true, None);
        for at in (0..picture.height()).step_by(7).flat_map(|y| (0..150).step_by(13).map(move |x| [x, y])) {
            assert_follows_from_neighbours(&picture, &full, at);
        }
    }
}

#[test]
fn neighbours_within_reach_determine_a_pixel_of_a_diagonal() {
    for slope in [0.95, -1.1] {
        let picture = below_line(slope, 20.0 - 45.0 * slope, false);
        let full = apply(&picture, true, None);
        let changed = (0..40).flat_map(|y| (0..90).map(move |x| [x, y]));
        let changed: Vec<_> = changed.filter(|[x, y]| full.at(*x, *y) != picture.at(*x, *y)).collect();
        assert!(changed.len() > 50, "{}", changed.len());
        for at in changed {
            assert_follows_from_neighbours(&picture, &full, at);
        }
    }
}

#[test]
fn threads_lanes_and_reused_memory_change_nothing() {
    for picture in [noise(131, 97), slanted(7, false), below_line(0.9, -20.0, false)] {
        let plain = apply_on(Lanes::baseline(), &picture, true, None);
        for lanes in Lanes::all() {
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let used = Image::filled(20, 30, [9; 4]);
                // Another picture of the same size, whose edges must be forgotten.
                pool.install(|| apply_on(lanes, &flipped(&picture, [true, true]), true, None));
                let other = pool.install(|| apply_on(lanes, &picture, true, Some(used)));
                assert!(other == plain, "{} {threads}", lanes.name());
            }
        }
    }
}
