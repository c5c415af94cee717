//! Anti-aliasing with several samples per pixel: supersampling in passes, and per-pixel sampling.
//!
//! If all pixels have their samples at the same positions, each sample is drawn in a pass of its own. Each pass draws
//! the whole picture with one sample per pixel, and shifts the projection by a fraction of a pixel. If positions differ
//! from pixel to pixel, or if shading does not run per sample, the classic execution draws triangles one by one into
//! rows of samples. The tiled execution has kernels of its own for these methods.

use rayon::prelude::*;

use super::Recipe;
use crate::antialias::pattern::{jitter, jittered_positions};
use crate::antialias::resolve;
use crate::antialias::settings::{AntialiasMethod, Antialiasing};
use crate::image::{Image, Rgba8};
use crate::math::fixed::snap;
use crate::pipeline::area::DrawnArea;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::multisample::{self, CandidatePositions, ShadingRate};
use crate::pipeline::raster::Scissor;
use crate::pipeline::{DrawCall, Extent, Geometry};
use crate::scene::Scene;
use crate::upscale::CENTRE;

/// Returns the sample position of each pass, in pixels from the pixel's top left corner. The list is empty if the
/// method has no passes.
pub(super) fn passes(antialias: Antialiasing) -> Vec<[f64; 2]> {
    if antialias.has_passes() { antialias.pattern().offsets(0, 0) } else { Vec::new() }
}

/// Number of framebuffer rows that are sampled together, small enough for their samples to fit into the caches.
const ROWS: u32 = 8;

/// Draws the picture of a per-pixel method (see [`Antialiasing::is_per_pixel`]) and resolves its samples.
pub(super) fn per_pixel(scene: &Scene, geometry: &Geometry, recipe: &Recipe, area: DrawnArea) -> Image<Rgba8> {
    let (DrawnArea { grid, raster }, (columns, rows)) = (area, area.packed_size());
    let mut picture = Image::filled(columns, rows, [0; 4]);
    let places = candidates(recipe.antialias);
    let bands = picture.pixels_mut().par_chunks_mut((columns * ROWS) as usize);
    bands.zip((0..rows).into_par_iter().step_by(ROWS as usize)).for_each(|(band, first)| {
        let last = (first + ROWS).min(rows) - 1;
        let scissor = Scissor {
            top: grid.pixel(0, first).1,
            bottom: grid.pixel(0, last).1 + 1,
            ..Scissor::full(raster.width, raster.height)
        };
        let cleared = Framebuffer::of_rows(area, first..last + 1, scene.background, &recipe.pipeline);
        let extent = Extent { triangles: 0..geometry.triangles.len(), scissor };
        let call = DrawCall::new(scene, geometry, &recipe.pipeline, &extent);
        let frames = sampled(call, recipe.antialias, &places, cleared);
        let mut samples = Vec::with_capacity(frames.len());
        for (place, pixel) in band.iter_mut().enumerate() {
            samples.clear();
            samples.extend(frames.iter().map(|frame| frame.color.pixels()[place]));
            *pixel = resolve::mean(&samples, recipe.antialias.light);
        }
    });
    picture
}

/// Returns the candidate positions of each sample of a pixel, in pixels from the pixel's centre.
pub(super) fn candidates(antialias: Antialiasing) -> Vec<Vec<[f32; 2]>> {
    let from_centre = |[x, y]: [f64; 2]| [(x - CENTRE[0]) as f32, (y - CENTRE[1]) as f32];
    let places = match antialias.method {
        AntialiasMethod::Jittered => jittered_positions(antialias.samples.side()),
        _ => antialias.pattern().offsets(0, 0).into_iter().map(|place| vec![place]).collect(),
    };
    places.into_iter().map(|places| places.into_iter().map(from_centre).collect()).collect()
}

/// Returns the candidate positions of each sample of a pixel, in grid steps of 1/256 px from the pixel's centre. The
/// list is empty unless the method is a per-pixel method.
pub(crate) fn places_on_grid(antialias: Antialiasing) -> Vec<Vec<[i32; 2]>> {
    if !antialias.is_per_pixel() {
        return Vec::new();
    }
    let on_grid = |places: Vec<[f32; 2]>| places.into_iter().map(|place| place.map(|px| snap(px) as i32)).collect();
    candidates(antialias).into_iter().map(on_grid).collect()
}

/// Draws all samples of the pixels in the scissor rectangle of the call. `candidates` are the candidate positions of each
/// sample. Returns one framebuffer per sample; each starts as a copy of `cleared`.
pub(super) fn sampled(
    call: DrawCall<'_>,
    antialias: Antialiasing,
    candidates: &[Vec<[f32; 2]>],
    cleared: Framebuffer,
) -> Vec<Framebuffer> {
    let Antialiasing { method, seed, .. } = antialias;
    let chosen = |(x, y): (u32, u32), sample: usize| jitter(x, y, sample as u32, seed);
    let rate = if method == AntialiasMethod::Multisample { ShadingRate::Pixel } else { ShadingRate::Sample };
    let mut frames = vec![cleared; candidates.len()];
    let places = CandidatePositions { candidates, chosen: &chosen };
    multisample::draw(call, places, rate, &mut frames);
    frames
}

/// Returns the sample positions in a drawn pixel, in pixels from its top left corner, in the order of
/// [`replay`](super::replay::replay).
pub(crate) fn places(antialias: Antialiasing, (x, y): (u32, u32)) -> Vec<[f64; 2]> {
    antialias.pattern().offsets(x, y)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::antialias::area::triangle_area;
    use crate::antialias::settings::SampleCount;
    use crate::chain::run;
    use crate::pipeline::settings::{Choice as _, ColorSpace, Shading};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 61, height: 47 };

    /// Returns the root mean square error of a triangle's anti-aliased coverage relative to its exact area, over the
    /// pixels that its edges cross.
    fn coverage_error(antialias: Antialiasing) -> f64 {
        let scene = builtin::by_id("triangle").unwrap().build();
        let mut recipe = Recipe { antialias, ..Recipe::default() };
        recipe.pipeline.shading = Shading::TriangleId;
        let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
        let triangle = frame.geometry().triangles[0];
        let corners = triangle.snapped_px().map(|[x, y]| DVec2::new(x.into(), y.into()));
        let inside = f64::from(crate::pipeline::shade::id_color(triangle.id)[0]);
        let outside = f64::from(scene.background[0]);
        let mut squares = Vec::new();
        for (x, y, area) in triangle_area(corners, SIZE.width, SIZE.height).filter(|(.., area)| *area < 1.0) {
            let share = (f64::from(frame.image().at(x, y)[0]) - outside) / (inside - outside);
            squares.push((share - area).powi(2));
        }
        assert!(squares.len() > 50);
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }

    #[test]
    fn every_method_comes_closer_to_the_area_with_every_sample() {
        let of = |method, samples| Antialiasing { method, samples, light: ColorSpace::Bytes, seed: 3 };
        let none = coverage_error(Antialiasing::default());
        for method in AntialiasMethod::ALL.iter().copied().filter(|method| *method != AntialiasMethod::None) {
            let errors = SampleCount::ALL.iter().map(|samples| coverage_error(of(method, *samples)));
            let errors: Vec<_> =
                if method == AntialiasMethod::RotatedGrid { errors.take(1).collect() } else { errors.collect() };
            assert!(errors[0] < none / 1.8, "{method:?}: {none} {errors:?}");
            assert!(errors.windows(2).all(|pair| pair[1] < pair[0] / 1.5), "{method:?}: {errors:?}");
            // One step of an 8-bit code corresponds to a few thousandths of the coverage.
            assert!(errors.len() == 1 || errors[3] < 0.02, "{method:?}: {errors:?}");
        }
    }

    #[test]
    fn the_recursive_pattern_draws_the_regular_picture_but_for_rounding() {
        let scene = builtin::by_id("chess").unwrap().build();
        let of = |method| {
            let antialias = Antialiasing { method, samples: SampleCount::Sixteen, ..Antialiasing::default() };
            run(&scene, &scene.home, &Recipe { antialias, ..Recipe::default() }, SIZE, &mut ()).image().clone()
        };
        let (regular, recursive) = (of(AntialiasMethod::Regular), of(AntialiasMethod::Recursive));
        let codes = regular.pixels().as_flattened().iter().zip(recursive.pixels().as_flattened());
        assert!(codes.into_iter().all(|(a, b)| a.abs_diff(*b) <= 1));
    }

    #[test]
    fn the_centre_is_the_mean_of_multisamples_which_are_not_on_a_line() {
        for samples in SampleCount::ALL {
            let antialias =
                Antialiasing { method: AntialiasMethod::Multisample, samples: *samples, ..Antialiasing::default() };
            let offsets = places_on_grid(antialias).concat();
            assert_eq!(offsets.len(), samples.count() as usize);
            assert_eq!(offsets.iter().fold([0; 2], |sum, offset| [sum[0] + offset[0], sum[1] + offset[1]]), [0; 2]);
            let [first, second] = [offsets[1], offsets[2]].map(|o| [o[0] - offsets[0][0], o[1] - offsets[0][1]]);
            assert_ne!(first[0] * second[1], first[1] * second[0]);
        }
    }

    #[test]
    fn multisampling_leaves_the_inside_of_triangles_alone() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let antialias = Antialiasing {
            method: AntialiasMethod::Multisample,
            samples: SampleCount::Sixteen,
            ..Antialiasing::default()
        };
        let draw = |recipe: &Recipe| run(&scene, &scene.home, recipe, SIZE, &mut ());
        let (plain, smooth) = (draw(&Recipe::default()), draw(&Recipe { antialias, ..Recipe::default() }));
        let corners = plain.geometry().triangles[0].snapped_px().map(|[x, y]| DVec2::new(x.into(), y.into()));
        let covered: Vec<_> = triangle_area(corners, SIZE.width, SIZE.height).collect();
        let whole: Vec<_> = covered.iter().filter(|(.., area)| *area > 1.0 - 1e-9).collect();
        assert!(whole.len() > 200);
        assert!(whole.iter().all(|(x, y, _)| plain.image().at(*x, *y) == smooth.image().at(*x, *y)));
        assert_ne!(plain.image(), smooth.image());
    }
}
