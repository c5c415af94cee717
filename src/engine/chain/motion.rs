//! Motion data of a picture: vectors, disocclusion and distances, drawn on demand.

use super::executor::Drawing;
use super::view::{ids_recipe, raster_camera, sampling_after};
use super::{Frame, Recipe};
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;
use crate::pipeline::area::DrawnArea;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::{FrameBefore, FrameMotion, FrameView, MotionVectors};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{LastStage, prepare};
use crate::scene::{Camera, Scene};
use crate::upscale::CENTRE;

/// Motion of every pixel of a picture since the preceding frame.
#[derive(Clone, Debug)]
pub struct MotionBuffers {
    vectors: MotionVectors,
    surfaces: GBuffer,
}

impl MotionBuffers {
    /// Draws the ids and depths of two views, and computes the motion from `before` to `now` in a picture of the
    /// viewport's size. Both scenes must be poses of the same scene. Returns `None` if the depth test is off.
    pub fn between(now: FrameView<'_>, before: FrameView<'_>, recipe: &Recipe, viewport: Viewport) -> Option<Self> {
        let (ids, distance) = ids_and_distances(now, recipe, viewport)?;
        let (mut object, distance_before) = ids_and_distances(before, recipe, viewport)?;
        let (size, lanes) = (ids.size(), Lanes::best());
        FrameMotion::new(before, None, size).resolve(lanes, &mut object, &distance_before, None);
        let gbuffer = GBuffer { object, distance: distance_before };
        let motion = FrameMotion::new(now, Some(FrameBefore { view: before, gbuffer: &gbuffer }), size);
        let mut object = ids;
        let vectors = motion.resolve(lanes, &mut object, &distance, None)?;
        Some(Self { vectors, surfaces: GBuffer { object, distance } })
    }

    /// Returns the position in the preceding frame minus the position in this one, in pixels to the right and downwards.
    /// The background moves as if it were infinitely far away. Not finite if the point was in the plane of the eye.
    pub fn vector_px(&self, x: u32, y: u32) -> [f32; 2] {
        [self.vectors.across_px.at(x, y), self.vectors.down_px.at(x, y)]
    }

    /// Whether the preceding frame does not show the surface point: it was hidden, outside the picture or behind the eye.
    pub fn is_disoccluded(&self, x: u32, y: u32) -> bool {
        self.vectors.visible.at(x, y) != MotionVectors::VISIBLE
    }

    /// Returns the distance along the view axis, in world units. Without a surface, it is infinite or the distance of the
    /// far plane.
    pub fn distance(&self, x: u32, y: u32) -> f32 {
        self.surfaces.distance.at(x, y)
    }

    /// Whether the pixel shows a surface.
    pub fn shows_surface(&self, x: u32, y: u32) -> bool {
        self.surfaces.object.at(x, y) != GBuffer::NO_OBJECT
    }
}

impl Frame {
    /// Returns the position of the drawn samples minus the centre of their pixels, in rasterized pixels. `recipe` must be
    /// the recipe of the frame.
    pub fn jitter_px(&self, recipe: &Recipe) -> [f64; 2] {
        let (_, place) = sampling_after(self.history.as_deref(), recipe);
        [place[0] - CENTRE[0], place[1] - CENTRE[1]]
    }

    /// Computes the motion of every rasterized pixel since [`Frame::before`], without jitter. `scene` must be the scene of
    /// the frame and `recipe` its recipe. Returns `None` if no view precedes or the depth test is off.
    pub fn motion(&self, scene: &Scene, recipe: &Recipe) -> Option<MotionBuffers> {
        let [now, then] = self.motion_cameras(recipe)?;
        let before = FrameView { scene: &self.before.as_ref()?.scene, camera: &then };
        MotionBuffers::between(FrameView { scene, camera: &now }, before, recipe, self.raster)
    }
}

impl Frame {
    /// Returns the cameras of this view and of [`Frame::before`], with the jitter of this frame, which therefore does not
    /// appear as motion. `recipe` must be the recipe of the frame. Returns `None` if no view precedes.
    pub(crate) fn motion_cameras(&self, recipe: &Recipe) -> Option<[Camera; 2]> {
        let before = self.before.as_ref()?;
        let (_, place) = sampling_after(self.history.as_deref(), recipe);
        let jittered = |camera| raster_camera(camera, self.sampling, self.viewport, place);
        Some([&self.camera, &before.camera].map(jittered))
    }

    /// Draws the colours of this view and of [`Frame::before`] without history, anti-aliasing and post filter. Both have
    /// the size and the jitter of the rasterized picture. Returns `None` if no view precedes. The other parameters are as in
    /// [`Frame::motion`].
    pub(crate) fn colors_of_both(&self, scene: &Scene, recipe: &Recipe) -> Option<[Image<Rgba8>; 2]> {
        let (before, [camera, camera_before]) = (self.before.as_ref()?, self.motion_cameras(recipe)?);
        let settings = &recipe.pipeline;
        let color = |scene: &Scene, camera: &Camera| {
            let geometry = prepare(scene, camera, settings, self.raster, &mut ());
            let area = DrawnArea::full(self.raster);
            Drawing { scene, settings, geometry: &geometry, area }.draw(LastStage::Shade, &mut ()).color
        };
        Some([color(scene, &camera), color(&before.scene, &camera_before)])
    }
}

/// Draws the triangle ids and the distances of a view; `None` if the depth test is off.
fn ids_and_distances(view: FrameView<'_>, recipe: &Recipe, viewport: Viewport) -> Option<(Image<Rgba8>, Image<f32>)> {
    let shown = ids_recipe(recipe)?;
    let geometry = prepare(view.scene, view.camera, &shown.pipeline, viewport, &mut ());
    let area = DrawnArea::full(viewport);
    let drawing = Drawing { scene: view.scene, settings: &shown.pipeline, geometry: &geometry, area };
    let drawn = drawing.draw(LastStage::Shade, &mut ());
    let mut distance = drawn.depth?;
    drawn.depth_scale.replace_by_distances(Lanes::best(), distance.pixels_mut());
    Some((drawn.color, distance))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::{KeepDepth, PrecedingView, RenderInputs, Renderer};
    use crate::pipeline::settings::{Choice as _, Execution};
    use crate::scene::builtin;
    use crate::upscale::{Scale, Upscaling};

    const SIZE: Viewport = Viewport { width: 80, height: 45 };

    #[test]
    fn buffers_equal_the_vectors_that_upscalers_read() {
        // At ×1.5 and ×2, samples are cut off at the right and at the bottom.
        const ODD: Viewport = Viewport { width: 81, height: 45 };
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let (first, second) = (scene.at(0.5), scene.at(0.6));
        let mut camera = scene.home;
        camera.orbit(0.02, 0.01);
        for (execution, scale) in
            Execution::ALL.iter().flat_map(|execution| [1.0, 1.5, 2.0].map(|scale| (execution, scale)))
        {
            let upscaler = Upscaling::new("taa", Scale::from(scale)).unwrap();
            let recipe = Recipe { upscaler, execution: *execution, ..Recipe::default() };
            let mut renderer = Renderer::default();
            let _ = renderer.render(
                RenderInputs { scene: &first, camera: &scene.home, recipe: &recipe, viewport: ODD },
                KeepDepth::No,
            );
            let frame = renderer.render(
                RenderInputs { scene: &second, camera: &camera, recipe: &recipe, viewport: ODD },
                KeepDepth::No,
            );
            let cameras = [&camera, &scene.home].map(|camera| raster_camera(camera, frame.sampling, ODD, CENTRE));
            let now = FrameView { scene: &second, camera: &cameras[0] };
            let before = FrameView { scene: &first, camera: &cameras[1] };
            let MotionBuffers { mut vectors, surfaces } =
                MotionBuffers::between(now, before, &recipe, frame.raster).unwrap();
            let drawn = [frame.raster.width, frame.raster.height].map(f64::from);
            assert_eq!(drawn, [81.0, 45.0].map(|length: f64| (length / scale).ceil()), "×{scale}");
            for axis in [&mut vectors.across_px, &mut vectors.down_px] {
                axis.pixels_mut().iter_mut().for_each(|px| *px *= scale as f32);
            }
            let shown = frame.surfaces.as_ref().unwrap();
            assert_eq!(*shown.gbuffer, surfaces, "{execution:?} ×{scale}");
            assert_eq!(**shown.motion.as_ref().unwrap(), vectors, "{execution:?} ×{scale}");
        }
    }

    #[test]
    fn jitter_is_no_motion() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let recipe = Recipe { upscaler: Upscaling::new("taa", 2).unwrap(), ..Recipe::default() };
        let mut renderer = Renderer::default();
        for _ in 0..3 {
            let mut frame = renderer.render(
                RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SIZE },
                KeepDepth::No,
            );
            assert!(frame.motion(&scene, &recipe).is_none());
            frame.before = Some(PrecedingView { scene: Arc::clone(&scene), camera: scene.home });
            let motion = frame.motion(&scene, &recipe).unwrap();
            let pixels = (0..frame.raster.height).flat_map(|y| (0..frame.raster.width).map(move |x| (x, y)));
            assert!(
                pixels.into_iter().all(|(x, y)| motion.vector_px(x, y) == [0.0; 2] && !motion.is_disoccluded(x, y))
            );
        }
    }
}
