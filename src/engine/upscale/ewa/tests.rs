use super::kernel::tests::published;
use super::*;
use crate::upscale::Scale;

fn noise(width: u32, height: u32) -> Image<Rgba8> {
    let mut random = fastrand::Rng::with_seed(31);
    Image::from_fn(width, height, |_, _| {
        std::array::from_fn(|_| if random.bool() { random.u8(..) } else { 255 * random.u8(..2) })
    })
}

/// Computes a pixel in f64 from the distances of all samples nearby.
fn reference(how: Upscaling, drawn: &Image<Rgba8>, (x, y): (u32, u32)) -> [f64; 4] {
    let [x, y] = [x, y].map(|at| match how.anchor() {
        Anchor::Corner => f64::from(at) / how.scale().value(),
        Anchor::Centre => (f64::from(at) + 0.5) / how.scale().value() - 0.5,
    });
    let (mut sum, mut total) = ([0.0; 4], 0.0);
    for row in y as i64 - 6..y as i64 + 7 {
        for column in x as i64 - 6..x as i64 + 7 {
            let weight = published((column as f64 - x).hypot(row as f64 - y));
            let sample = drawn.at_clamped(column, row);
            sum.iter_mut().zip(sample).for_each(|(sum, code)| *sum += weight * f64::from(code));
            total += weight;
        }
    }
    sum.map(|sum| (sum / total).clamp(0.0, 255.0))
}

#[test]
fn pixels_agree_with_the_published_kernel() {
    let drawn = noise(8, 9);
    for (scale, anchor) in [(1.3, Anchor::Centre), (1.7, Anchor::Corner), (2.0, Anchor::Centre), (3.0, Anchor::Corner)]
    {
        let how = Upscaling::new("ewa-lanczos", Scale::from(scale)).unwrap().with_anchor(anchor);
        let full = how.upscale(&UpscaleInputs::from(&drawn), (8.0 * scale) as u32, (9.0 * scale) as u32);
        for (x, y) in (0..full.height()).flat_map(|y| (0..full.width()).map(move |x| (x, y))) {
            for (code, exact) in full.at(x, y).into_iter().zip(reference(how, &drawn, (x, y))) {
                assert!((f64::from(code) - exact).abs() < 0.65, "{} ({x}, {y}): {code}, not {exact}", how.label());
            }
        }
    }
}

#[test]
fn wide_lanes_and_single_pixels_agree_bit_for_bit() {
    let drawn = noise(13, 35);
    for scale in [Scale::ONE_AND_THREE_TENTHS, Scale::TWO] {
        for (anchor, deringing) in [(Anchor::Corner, false), (Anchor::Centre, true)] {
            let how = Upscaling::new("ewa-lanczos", scale).unwrap().with_anchor(anchor).with_deringing(deringing);
            let [width, height] = [13.0, 35.0].map(|samples: f64| (samples * scale.value()) as u32);
            let alone = Image::from_fn(width, height, |x, y| {
                EWA_LANCZOS.pixel(how, &UpscaleInputs::from(&drawn), (width, height), (x, y))
            });
            for lanes in Lanes::all() {
                let mut full = Image::filled(width, height, [1, 2, 3, 4]);
                fill(lanes, how, &drawn, &mut full);
                assert!(full == alone, "{} {}", how.label(), lanes.name());
            }
        }
    }
}

#[test]
fn deringing_keeps_an_edge_within_its_two_sides() {
    let edge = Image::from_fn(16, 16, |x, y| if 3 * x + 2 * y < 40 { [40; 4] } else { [200; 4] });
    let how = Upscaling::new("ewa-lanczos", Scale::TWO).unwrap();
    let range = |how: Upscaling| {
        let full = how.upscale(&UpscaleInputs::from(&edge), 32, 32);
        let codes = full.pixels().iter().map(|pixel| pixel[0]);
        (codes.clone().min(), codes.max())
    };
    let (least, greatest) = range(how);
    assert!(least < Some(35) && greatest > Some(205), "the plain filter rings: {least:?} {greatest:?}");
    assert_eq!(range(how.with_deringing(true)), (Some(40), Some(200)));
}
