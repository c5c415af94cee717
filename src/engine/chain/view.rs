//! Inputs for drawing a view: size and camera of the rasterized picture, and the upscaler's inputs other than colours.

use std::sync::Arc;

use rayon::prelude::*;

use super::Recipe;
use super::pool::BufferPool;
use crate::math::lanes::Lanes;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::{FrameBefore, FrameMotion, FrameView, MotionVectors};
use crate::pipeline::plan::transparency;
use crate::pipeline::prepare;
use crate::pipeline::settings::{DepthTest, Settings, Shading};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Instance, Scene, Transparency};
use crate::upscale::{CENTRE, FrameInputs, History, Sampling};

/// Returns the sampling of the frame that follows `past`, and the position of the sample within each pixel, in pixels
/// from the pixel's top left corner.
pub(super) fn sampling_after(past: Option<&History>, recipe: &Recipe) -> (Sampling, [f64; 2]) {
    let upscaler = recipe.upscaler.upscaler();
    if upscaler.reads().history && gbuffer_recipe(recipe).is_none() {
        // Without a G-buffer there is no history, and samples without history lie at the centres.
        return (upscaler.sampling(recipe.upscaler), CENTRE);
    }
    let frames = past.map_or(0, |past| past.frames.wrapping_add(1));
    upscaler.frame_sampling(recipe.upscaler, frames)
}

/// Returns the recipe for drawing the ids and depths of the G-buffer; `None` unless the upscaler reads a G-buffer and the
/// depth test is on.
pub(super) fn gbuffer_recipe(recipe: &Recipe) -> Option<Recipe> {
    let reads = recipe.upscaler.upscaler().reads().gbuffer;
    ids_recipe(recipe).filter(|_| reads)
}

/// Returns the recipe for drawing the exact triangle id and the depth of every pixel; `None` if the depth test is off.
pub(super) fn ids_recipe(recipe: &Recipe) -> Option<Recipe> {
    let pipeline = Settings { shading: Shading::TriangleId, exact_ids: true, ..recipe.pipeline };
    (recipe.pipeline.depth_test != DepthTest::Off).then_some(Recipe { pipeline, ..Recipe::default() })
}

/// View whose surfaces are drawn, at the centres of the rasterized pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceView<'a> {
    pub(super) scene: &'a Scene,
    /// Camera of the frame, before the jitter shifts it.
    pub(super) camera: &'a Camera,
    /// Size of the full picture.
    pub(super) viewport: Viewport,
    pub(super) sampling: Sampling,
}

impl SurfaceView<'_> {
    /// Returns a camera with the size and the sub-view of the rasterized picture, without jitter.
    pub(super) fn raster_camera(&self, camera: &Camera) -> Camera {
        raster_camera(camera, self.sampling, self.viewport, CENTRE)
    }

    /// Returns the number of pixels of the full picture per rasterized pixel, along each axis.
    fn scale(&self) -> f32 {
        match self.sampling {
            Sampling::Grid(_) => 1.0,
            Sampling::Lattice(lattice) => lattice.scale.value() as f32,
        }
    }
}

/// Visible surfaces of a frame, and their motion since the preceding frame.
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    pub(super) sampling: Sampling,
    /// Size of the full picture.
    pub(super) viewport: Viewport,
    pub(super) gbuffer: Arc<GBuffer>,
    /// `None` if there is no preceding frame, or if camera and scene are still.
    pub(super) motion: Option<Arc<MotionVectors>>,
    /// Reactivity of every instance, as [`FrameInputs::reactivity`] describes it.
    pub(super) reactivity: Option<Arc<[f32]>>,
}

impl Surfaces {
    /// Adds the reactivity of the instances of a scene, if the upscaler of the recipe reads it.
    pub(super) fn with_reactivity(self, scene: &Scene, recipe: &Recipe) -> Self {
        Self { reactivity: reactivity(scene, recipe), ..self }
    }

    /// Returns the inputs of an upscaler other than colours.
    pub(super) fn inputs<'a>(&'a self, past: Option<&'a History>) -> FrameInputs<'a> {
        FrameInputs {
            size: (self.viewport.width, self.viewport.height),
            sampling: self.sampling,
            gbuffer: &self.gbuffer,
            motion: self.motion.as_deref(),
            history: past,
            reactivity: self.reactivity.as_deref(),
        }
    }
}

/// Returns the surfaces of a view. Reuses the G-buffer of the preceding frame if camera and scene are still. Otherwise
/// converts the result of `draw`, a framebuffer with exact triangle ids and depths of all rasterized pixels. Reuses buffers
/// of the pool.
pub(super) fn surfaces(
    past: Option<&History>,
    view: SurfaceView<'_>,
    lanes: Lanes,
    pool: &mut BufferPool,
    draw: impl FnOnce(&mut BufferPool) -> Framebuffer,
) -> Option<Surfaces> {
    /// Number of depths converted per parallel task.
    const TOGETHER: usize = 1 << 14;
    let SurfaceView { scene, camera, viewport, sampling } = view;
    let of = |gbuffer, motion| Surfaces { sampling, viewport, gbuffer, motion, reactivity: None };
    if let Some(past) = past.filter(|past| past.shows(FrameView { scene, camera })) {
        return Some(of(Arc::clone(&past.surfaces), None));
    }
    let Framebuffer { color: mut object, depth, depth_scale: scale, .. } = draw(pool);
    let mut distance = depth?;
    distance.pixels_mut().par_chunks_mut(TOGETHER).for_each(|depths| scale.replace_by_distances(lanes, depths));
    let (camera, camera_before) = (view.raster_camera(camera), past.map(|past| view.raster_camera(&past.camera)));
    let before = past
        .zip(camera_before.as_ref())
        .map(|(past, camera)| FrameBefore { view: FrameView { scene: &past.scene, camera }, gbuffer: &past.surfaces });
    let spare = before.and_then(|_| pool.vectors());
    let motion = FrameMotion::new(FrameView { scene, camera: &camera }, before, object.size()).scaled(view.scale());
    let motion = motion.resolve(lanes, &mut object, &distance, spare);
    Some(of(Arc::new(GBuffer { object, distance }), motion.map(Arc::new)))
}

/// Greatest reactivity of a surface; AMD's documentation of FSR 2 recommends about 0.9.
const MOST_REACTIVITY: f32 = 0.9;

/// Returns the reactivity of every instance for the upscaler of a recipe: the opacity of blended surfaces, and the maximum
/// for alpha-tested ones, whose holes show other surfaces. Returns `None` if the upscaler does not read it, or if every
/// surface is opaque.
pub(super) fn reactivity(scene: &Scene, recipe: &Recipe) -> Option<Arc<[f32]>> {
    if !recipe.upscaler.upscaler().reads_reactive_mask() {
        return None;
    }
    let of_instance = |instance: &Instance| match transparency(&scene.library, instance, recipe.pipeline.shading) {
        Transparency::Opaque => 0.0,
        Transparency::AlphaTested => MOST_REACTIVITY,
        Transparency::Blended => scene.library.material(instance.material).opacity.min(MOST_REACTIVITY),
    };
    let all: Arc<[f32]> = scene.instances.iter().map(of_instance).collect();
    all.iter().any(|reactivity| *reactivity > 0.0).then_some(all)
}

/// Returns the size, in pixels, of the picture that is rasterized before upscaling.
pub(super) fn raster_viewport(sampling: Sampling, Viewport { width, height }: Viewport) -> Viewport {
    let (width, height) = sampling.raster_size(width, height);
    Viewport { width, height }
}

/// Returns the camera of the picture that is rasterized before upscaling. The sample of each rasterized pixel lies at
/// `place`, in pixels from the pixel's top left corner.
pub(super) fn raster_camera(camera: &Camera, sampling: Sampling, viewport: Viewport, place: [f64; 2]) -> Camera {
    jittered_camera(camera, sampling, viewport, place).unwrap_or(*camera)
}

/// Returns the triangles of the full picture if the wireframe needs them and the rasterized picture is smaller, else
/// `None`.
pub(super) fn outlines(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Option<TriangleList> {
    let drawn_smaller = matches!(recipe.upscaler.sampling(), Sampling::Lattice(_));
    (recipe.wireframe && drawn_smaller).then(|| prepare(scene, camera, &recipe.pipeline, viewport, &mut ()).triangles)
}

/// Returns the camera with a sub-view that puts the sample of each rasterized pixel at `place`, or `None` if no
/// sub-view is needed. `place` is in pixels from the pixel's top left corner.
fn jittered_camera(camera: &Camera, sampling: Sampling, viewport: Viewport, place: [f64; 2]) -> Option<Camera> {
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
