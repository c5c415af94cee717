//! Sequence of a frame, for both executions: samples, resolve, surfaces, upscaling, post filter.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::executor::{Executed, Executor, Pass, Purpose};
use super::finish::{Finished, finish};
use super::pool::BufferPool;
use super::view::{
    SurfaceView, Surfaces, gbuffer_recipe, outlines, raster_camera, raster_viewport, sampling_after, surfaces,
};
use super::{Frame, FrameTimes, KeepDepth, Recipe, samples};
use crate::antialias::resolve::Mean;
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;
use crate::pipeline::area::DrawnArea;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::{History, Sampling, UpscaleInputs};

/// Inputs of one frame, before it is drawn.
pub(super) struct FrameRequest<'a> {
    pub(super) scene: &'a Scene,
    pub(super) camera: &'a Camera,
    pub(super) recipe: &'a Recipe,
    /// Size of the full picture.
    pub(super) viewport: Viewport,
    pub(super) keep_depth: KeepDepth,
    /// Preceding frame with the same recipe and size, of a pose of the same scene.
    pub(super) past: Option<Arc<History>>,
    /// Instruction set for work outside the passes.
    pub(super) lanes: Lanes,
}

impl FrameRequest<'_> {
    /// Draws the samples with an executor, and makes the finished picture from them.
    pub(super) fn draw<E: Executor>(self, mut executor: E, pool: &mut BufferPool) -> Frame {
        let begun = Instant::now();
        let samples = FrameSamples::new(&self);
        let (drawn, resolve) = samples.draw(&mut executor, pool);
        let surfaces_begun = Instant::now();
        let surfaces = samples.surfaces(&mut executor, pool);
        let drawn_at = Instant::now();
        let Executed { geometry, plans, times: passes, tiled } = executor.finish(&samples.pass(Purpose::Frame));
        let Self { scene, camera, recipe, viewport, past, .. } = &self;
        let outlines = outlines(scene, camera, recipe, *viewport);
        let frame = surfaces.as_ref().map(|shown| shown.inputs(past.as_deref()));
        let inputs = UpscaleInputs { color: &drawn.color, frame };
        let Finished { picture, unfiltered, history, transfer, post } =
            finish(recipe, &inputs, *viewport, pool, || outlines.as_ref().unwrap_or_else(|| &geometry.get().triangles));
        let times = FrameTimes {
            geometry: passes.geometry,
            pixels: passes.pixels,
            resolve,
            surfaces: drawn_at - surfaces_begun,
            transfer,
            upscale: drawn_at.elapsed().saturating_sub(post),
            post,
            total: begun.elapsed(),
        };
        Frame {
            finished: picture,
            unfiltered,
            upscaler_history: history,
            drawn,
            antialias: recipe.antialias,
            camera: **camera,
            surfaces,
            before: None,
            geometry,
            plans,
            viewport: *viewport,
            raster: samples.area.raster,
            sampling: samples.sampling,
            outlines,
            execution: E::EXECUTION,
            times,
            tiled,
            history: past.clone(),
        }
    }
}

/// Samples that a frame draws.
struct FrameSamples<'a> {
    request: &'a FrameRequest<'a>,
    sampling: Sampling,
    /// Position of the samples in their pixels, in pixels from the top left corner.
    place: [f64; 2],
    area: DrawnArea,
}

impl<'a> FrameSamples<'a> {
    fn new(request: &'a FrameRequest<'a>) -> Self {
        let (sampling, place) = sampling_after(request.past.as_deref(), request.recipe);
        let area = DrawnArea { grid: sampling.grid(), raster: raster_viewport(sampling, request.viewport) };
        Self { request, sampling, place, area }
    }

    /// Returns the pass that samples the pixels where the upscaler wants them.
    fn pass(&self, purpose: Purpose) -> Pass<'_> {
        self.pass_at(self.place, purpose)
    }

    /// Returns the pass that samples the pixels at a position, in pixels from their top left corner.
    fn pass_at(&self, place: [f64; 2], purpose: Purpose) -> Pass<'_> {
        let FrameRequest { scene, camera, recipe, viewport, keep_depth, .. } = *self.request;
        Pass {
            purpose,
            scene,
            camera: raster_camera(camera, self.sampling, viewport, place),
            recipe,
            area: self.area,
            keep_depth: if purpose == Purpose::Frame { keep_depth } else { KeepDepth::No },
        }
    }

    /// Draws what the upscaler reads besides colours: the surfaces of all rasterized pixels, without jitter.
    fn surfaces<E: Executor>(&self, executor: &mut E, pool: &mut BufferPool) -> Option<Surfaces> {
        let FrameRequest { scene, camera, viewport, lanes, .. } = *self.request;
        let recipe = gbuffer_recipe(self.request.recipe)?;
        let view = SurfaceView { scene, camera, viewport, sampling: self.sampling };
        let surfaces = surfaces(self.request.past.as_deref(), view, lanes, pool, |pool| {
            let pass = Pass {
                purpose: Purpose::Surfaces,
                scene,
                camera: view.raster_camera(camera),
                recipe: &recipe,
                area: DrawnArea::full(self.area.raster),
                keep_depth: KeepDepth::Yes,
            };
            executor.draw(&pass, pool)
        })?;
        Some(surfaces.with_reactivity(scene, self.request.recipe))
    }

    /// Draws the samples, and returns them with the time spent on averaging.
    fn draw<E: Executor>(&self, executor: &mut E, pool: &mut BufferPool) -> (Framebuffer, Duration) {
        let FrameRequest { recipe, keep_depth, .. } = *self.request;
        let places = samples::passes(recipe.antialias);
        let Some((first, others)) = places.split_first() else {
            return (executor.draw(&self.pass(Purpose::Frame), pool), Duration::ZERO);
        };
        // Only for its depths: the passes give the colours.
        let centres = (keep_depth == KeepDepth::Yes).then(|| executor.draw(&self.pass(Purpose::Frame), pool));
        let mut average = Average::new(recipe, self.area.packed_size());
        let mut first = executor.draw(&self.pass_at(*first, Purpose::Supersample), pool);
        average.add(std::mem::take(&mut first.color), pool);
        for place in others {
            average.add(executor.draw(&self.pass_at(*place, Purpose::Supersample), pool).color, pool);
        }
        let mut drawn = centres.unwrap_or(first);
        let (mean, resolve) = average.finish(pool);
        pool.give_codes(std::mem::replace(&mut drawn.color, mean));
        (drawn, resolve)
    }
}

/// Mean of supersampling passes.
struct Average {
    mean: Mean,
    /// Colours of the passes that are not yet in `mean`.
    drawn: Vec<Image<Rgba8>>,
    /// Time spent on averaging, without the passes themselves.
    time: Duration,
}

impl Average {
    /// Number of supersampling passes that are averaged at once.
    const TOGETHER: usize = 4;

    fn new(recipe: &Recipe, size: (u32, u32)) -> Self {
        Self { mean: Mean::new(size, recipe.antialias.light), drawn: Vec::new(), time: Duration::ZERO }
    }

    fn add(&mut self, pass: Image<Rgba8>, pool: &mut BufferPool) {
        if self.drawn.len() == Self::TOGETHER {
            let begun = Instant::now();
            self.mean.add(&self.drawn);
            self.time += begun.elapsed();
            self.drawn.drain(..).for_each(|drawn| pool.give_codes(drawn));
        }
        self.drawn.push(pass);
    }

    fn finish(self, pool: &mut BufferPool) -> (Image<Rgba8>, Duration) {
        let spare = self.drawn.first().and_then(|drawn| pool.codes(drawn.size()));
        let begun = Instant::now();
        let picture = self.mean.picture(&self.drawn, spare);
        let time = self.time + begun.elapsed();
        self.drawn.into_iter().for_each(|drawn| pool.give_codes(drawn));
        (picture, time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antialias::settings::{AntialiasMethod, Antialiasing};
    use crate::chain::frame::LazyGeometry;
    use crate::pipeline::Geometry;
    use crate::pipeline::settings::Execution;
    use crate::scene::builtin;

    const PASS: Duration = Duration::from_millis(2);

    /// Executor whose passes take [`PASS`], and which counts those of every purpose.
    #[derive(Default)]
    struct Sleeping(Vec<Purpose>);

    impl Executor for &mut Sleeping {
        const EXECUTION: Execution = Execution::Classic;

        fn draw(&mut self, pass: &Pass<'_>, _: &mut BufferPool) -> Framebuffer {
            self.0.push(pass.purpose);
            std::thread::sleep(PASS);
            let (width, height) = pass.area.packed_size();
            Framebuffer::new(pass.area.grid, width, height, [9; 3], &pass.recipe.pipeline)
        }

        fn finish(self, _: &Pass<'_>) -> Executed {
            let geometry = LazyGeometry::made(Geometry::default());
            Executed { geometry, plans: Arc::default(), times: Default::default(), tiled: None }
        }
    }

    #[test]
    fn only_passes_that_something_reads_are_drawn_and_averaging_excludes_them() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let of = |recipe: &Recipe, keep_depth| {
            let mut executor = Sleeping::default();
            let viewport = Viewport { width: 4, height: 4 };
            let lanes = Lanes::best();
            let request =
                FrameRequest { scene: &scene, camera: &scene.home, recipe, viewport, keep_depth, past: None, lanes };
            let frame = request.draw(&mut executor, &mut BufferPool::default());
            let passes = PASS * executor.0.len() as u32;
            assert!(frame.times.resolve + passes <= frame.times.total, "disjoint");
            assert_eq!(*frame.image(), Image::filled(4, 4, [9, 9, 9, 255]));
            let of = |purpose| executor.0.iter().filter(|drawn| **drawn == purpose).count();
            [of(Purpose::Frame), of(Purpose::Supersample), of(Purpose::Surfaces)]
        };
        let antialias = Antialiasing { method: AntialiasMethod::Regular, ..Antialiasing::default() };
        let samples = antialias.samples.count() as usize;
        let smooth = Recipe { antialias, ..Recipe::default() };
        assert_eq!(of(&Recipe::default(), KeepDepth::No), [1, 0, 0]);
        assert_eq!(of(&smooth, KeepDepth::No), [0, samples, 0]);
        assert_eq!(of(&smooth, KeepDepth::Yes), [1, samples, 0]);
    }
}
