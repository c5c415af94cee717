//! Anti-aliasing with several samples per pixel: supersampling in passes, and per-pixel sampling.
//!
//! If all pixels have their samples at the same positions, each sample is drawn in a pass of its own. Each pass draws
//! the whole picture with one sample per pixel, and shifts the projection by a fraction of a pixel. If positions differ
//! from pixel to pixel, or if shading does not run per sample, the classic execution draws triangles one by one into
//! rows of samples. The tiled execution has kernels of its own for these methods.

use std::sync::Arc;

use rayon::prelude::*;

use super::executor::DrawnArea;
use super::view::{raster_camera, raster_viewport};
use super::{Frame, KeepDepth, Recipe, Renderer};
use crate::antialias::pattern::{Pattern, jitter, jittered_positions};
use crate::antialias::resolve::{self, Mean};
use crate::antialias::settings::{AntialiasMethod, Antialiasing};
use crate::image::{Image, Rgba8};
use crate::math::fixed::snap;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::multisample::{self, CandidatePositions, ShadingRate};
use crate::pipeline::raster::Scissor;
use crate::pipeline::settings::{ColorSpace, TexelFilter as TextureFilter};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{Extent, Geometry, LastStage, draw, prepare};
use crate::scene::{Camera, Scene};
use crate::upscale::{CENTRE, Sampling};

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
        let size = (raster.width, raster.height);
        let cleared = Framebuffer::of_rows(grid, size, first..last + 1, scene.background, &recipe.pipeline);
        let extent = Extent { triangles: 0..geometry.triangles.len(), scissor };
        let frames = sampled(scene, geometry, recipe, &extent, (&places, cleared));
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
fn candidates(antialias: Antialiasing) -> Vec<Vec<[f32; 2]>> {
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

/// Draws all samples of the pixels in the scissor rectangle of `extent`. Returns one framebuffer per sample position;
/// each starts as a copy of `cleared`.
fn sampled(
    scene: &Scene,
    geometry: &Geometry,
    recipe: &Recipe,
    extent: &Extent,
    (candidates, cleared): (&[Vec<[f32; 2]>], Framebuffer),
) -> Vec<Framebuffer> {
    let Antialiasing { method, seed, .. } = recipe.antialias;
    let chosen = |(x, y): (u32, u32), sample: usize| jitter(x, y, sample as u32, seed);
    let rate = if method == AntialiasMethod::Multisample { ShadingRate::Pixel } else { ShadingRate::Sample };
    let mut frames = vec![cleared; candidates.len()];
    let places = CandidatePositions { candidates, chosen: &chosen };
    multisample::draw(scene, geometry, &recipe.pipeline, extent, (places, rate), &mut frames);
    frames
}

/// Draws the given pixels of a frame again and returns the samples of each, in drawing order. There is one sample per
/// pixel unless the frame is anti-aliased. Pixels that were not drawn have no samples.
pub(crate) fn replay(scene: &Scene, recipe: &Recipe, frame: &Frame, pixels: &[(u32, u32)]) -> Vec<Vec<Rgba8>> {
    let Frame { antialias, sampling, viewport, camera, .. } = frame;
    if antialias.is_off() {
        return replay_pass(scene, recipe, frame, frame.geometry(), pixels)
            .into_iter()
            .map(|s| s.into_iter().collect())
            .collect();
    }
    if antialias.is_per_pixel() {
        return pixels.iter().map(|pixel| replay_pixel(scene, recipe, frame, *pixel)).collect();
    }
    let passes: Vec<Vec<Option<Rgba8>>> = passes(*antialias)
        .into_par_iter()
        .map(|offset| {
            let seen = raster_camera(camera, *sampling, *viewport, offset);
            let geometry = prepare(scene, &seen, &recipe.pipeline, raster_viewport(*sampling, *viewport), &mut ());
            replay_pass(scene, recipe, frame, &geometry, pixels)
        })
        .collect();
    (0..pixels.len()).map(|pixel| passes.iter().filter_map(|pass| pass[pixel]).collect()).collect()
}

/// Draws one sample of each given pixel again, from the triangles in `geometry`. Returns the colour of each pixel, or
/// `None` for a pixel that was not drawn.
fn replay_pass(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    geometry: &Geometry,
    pixels: &[(u32, u32)],
) -> Vec<Option<Rgba8>> {
    let grid = frame.drawn.grid;
    let color = |&(x, y): &(u32, u32)| {
        let sample = grid.sample_at(x, y)?;
        let mut one = Framebuffer::one_sample(grid, sample, scene.background, &recipe.pipeline);
        let extent = Extent { triangles: 0..geometry.triangles.len(), scissor: Scissor::pixel(x, y) };
        draw(scene, geometry, &recipe.pipeline, &extent, LastStage::Shade, &mut one, &mut ());
        Some(one.color.at(0, 0))
    };
    pixels.iter().map(color).collect()
}

/// Draws all samples of one pixel again, for a per-pixel method. Returns an empty list if the pixel was not drawn.
fn replay_pixel(scene: &Scene, recipe: &Recipe, frame: &Frame, (x, y): (u32, u32)) -> Vec<Rgba8> {
    let Some(sample) = frame.drawn.grid.sample_at(x, y) else { return Vec::new() };
    let cleared = Framebuffer::one_sample(frame.drawn.grid, sample, scene.background, &recipe.pipeline);
    let extent = Extent { triangles: 0..frame.geometry().triangles.len(), scissor: Scissor::pixel(x, y) };
    let places = candidates(frame.antialias);
    let frames = sampled(scene, frame.geometry(), recipe, &extent, (&places, cleared));
    frames.iter().map(|frame| frame.color.at(0, 0)).collect()
}

/// Returns the sample positions in a drawn pixel, in pixels from its top left corner, in the order of [`replay`].
pub(crate) fn places(antialias: Antialiasing, (x, y): (u32, u32)) -> Vec<[f64; 2]> {
    antialias.pattern().offsets(x, y)
}

/// Progressive rendering that adds one sample per pixel at a time, so that a caller can show progress and stop. Samples
/// follow the low-discrepancy pattern; a single sample lies at the pixel's centre. The samples are averaged in linear
/// light.
#[derive(Debug)]
pub struct ProgressiveRender {
    scene: Arc<Scene>,
    camera: Camera,
    recipe: Recipe,
    viewport: Viewport,
    places: Vec<[f64; 2]>,
    mean: Mean,
    renderer: Renderer,
}

impl ProgressiveRender {
    /// Starts rendering with only the pipeline settings of the recipe: without upscaler, filter, wireframe and
    /// mip-mapping.
    pub(crate) fn new(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, viewport: Viewport, samples: u32) -> Self {
        let mut bare = Recipe { pipeline: recipe.pipeline, execution: recipe.execution, ..Recipe::default() };
        if bare.pipeline.filter.reads_mip_levels() {
            bare.pipeline.filter = TextureFilter::Bilinear;
        }
        Self {
            scene: Arc::clone(scene),
            camera: *camera,
            recipe: bare,
            viewport,
            places: Pattern::LowDiscrepancy { count: samples }.offsets(0, 0),
            mean: Mean::new(viewport.width, viewport.height, ColorSpace::Linear),
            renderer: Renderer::default(),
        }
    }

    /// Draws the next sample of every pixel; returns `false` if none is left.
    pub fn step(&mut self) -> bool {
        let Some(place) = self.places.get(self.mean.samples() as usize) else { return false };
        let seen = raster_camera(&self.camera, Sampling::Grid(SampleGrid::FULL), self.viewport, *place);
        let frame = self.renderer.render(&self.scene, &seen, &self.recipe, self.viewport, KeepDepth::No);
        self.mean.add(frame.image());
        self.renderer.recycle(frame);
        true
    }

    /// Returns the mean of the samples drawn so far, in linear light.
    pub fn linear(&self) -> Image<[f32; 3]> {
        self.mean.linear()
    }

    /// Returns the mean of the samples drawn so far.
    pub fn picture(&self) -> Image<Rgba8> {
        self.mean.picture()
    }
}

/// Returns the camera with a sub-view that puts the sample of each rasterized pixel at `place`, or `None` if no
/// sub-view is needed. `place` is in pixels from the pixel's top left corner.
pub(super) fn jittered_camera(
    camera: &Camera,
    sampling: Sampling,
    viewport: Viewport,
    place: [f64; 2],
) -> Option<Camera> {
    let moved = |step: f64| [0, 1].map(|axis| (place[axis] - CENTRE[axis]) * step);
    let (step, [x, y]) = match sampling {
        Sampling::Grid(_) if place == CENTRE => return None,
        Sampling::Grid(_) => (1.0, moved(1.0)),
        Sampling::Lattice(lattice) => {
            let step = lattice.scale.value();
            (step, moved(step).map(|by| by + lattice.origin_px()))
        }
    };
    let window = raster_viewport(sampling, viewport).window(viewport, step, [x, y]);
    let sub_view = camera.sub_view.map_or(window, |own| own.followed_by(window));
    Some(Camera { sub_view: Some(sub_view), ..*camera })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::antialias::area::triangle_area;
    use crate::antialias::settings::SampleCount;
    use crate::chain::run;
    use crate::pipeline::settings::{Choice as _, Shading};
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
