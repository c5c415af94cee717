//! Frames of an analytic picture, for the tests of upscalers with history.

use std::sync::Arc;

use super::{FrameInputs, History, UpscaleInputs, Upscaling};
use crate::image::{Image, Rgba8};
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::MotionVectors;
use crate::scene::Scene;

/// Sequence of frames that an upscaler draws of an analytic grey picture on a flat surface.
pub(super) struct TestSequence {
    how: Upscaling,
    size: (u32, u32),
    scene: Arc<Scene>,
    surfaces: Arc<GBuffer>,
    /// Motion of the picture per frame in pixels, to the right; `None` in a still view. With 0, the view counts as
    /// changing, although nothing moves.
    pub(super) motion_px: Option<f32>,
    /// Reactivity of the surface, in [0, 1].
    pub(super) reactivity: f32,
    pub(super) history: Option<History>,
}

impl TestSequence {
    pub(super) fn new(how: Upscaling, size @ (width, height): (u32, u32), motion_px: Option<f32>) -> Self {
        let (columns, rows) = (how.lattice().samples(width), how.lattice().samples(height));
        let object = Image::filled(columns, rows, [0; 4]);
        let surfaces = Arc::new(GBuffer { object, distance: Image::filled(columns, rows, 1.0) });
        let scene = Arc::new(crate::scene::builtin::ALL[0].build());
        Self { how, size, scene, surfaces, motion_px, reactivity: 0.0, history: None }
    }

    /// Returns the vectors of the picture, with this visibility of all pixels.
    pub(super) fn vectors(&self, visible: u8) -> MotionVectors {
        let (width, height) = self.surfaces.object.size();
        MotionVectors {
            across_px: Image::filled(width, height, -self.motion_px.unwrap_or(0.0)),
            down_px: Image::filled(width, height, 0.0),
            visible: Image::filled(width, height, visible),
        }
    }

    /// Returns the inputs of the next frame besides its colours, without reactivity.
    pub(super) fn inputs<'a>(&'a self, motion: Option<&'a MotionVectors>) -> FrameInputs<'a> {
        FrameInputs {
            size: self.size,
            sampling: self.how.sampling(),
            gbuffer: &self.surfaces,
            motion,
            history: self.history.as_ref(),
            reactivity: None,
        }
    }

    /// Returns the number of earlier frames.
    fn number(&self) -> u32 {
        self.history.as_ref().map_or(0, |past| past.frames + 1)
    }

    /// Draws one sample per lattice position, at the jitter position of the next frame. `code` is the code at a position
    /// on the surface, in pixels.
    pub(super) fn samples(&self, code: impl Fn([f64; 2]) -> u8) -> Image<Rgba8> {
        let (_, place) = self.how.upscaler().frame_sampling(self.how, self.number());
        let lattice = self.how.lattice();
        let moved = f64::from(self.motion_px.unwrap_or(0.0)) * f64::from(self.number());
        let position = |index: u32, place: f64| (f64::from(index) + place) * lattice.scale.value();
        Image::from_fn(lattice.samples(self.size.0), lattice.samples(self.size.1), |x, y| {
            let code = code([position(x, place[0]) - moved, position(y, place[1])]);
            [code, code, code, 255]
        })
    }

    /// Draws the next frame.
    pub(super) fn frame(&mut self, code: impl Fn([f64; 2]) -> u8) -> Image<Rgba8> {
        let color = self.samples(code);
        let vectors = self.vectors(MotionVectors::VISIBLE);
        let is_moving = self.motion_px.is_some();
        let motion = (is_moving && self.history.is_some()).then_some(&vectors);
        let reactivity = [self.reactivity];
        let reactivity = (self.reactivity > 0.0).then_some(&reactivity[..]);
        let frame = FrameInputs { reactivity, ..self.inputs(motion) };
        let mut full = Image::filled(self.size.0, self.size.1, [0; 4]);
        let drawn = UpscaleInputs { color: &color, frame: Some(frame) };
        let accumulated = self.how.upscaler().upscale_with_history(self.how, &drawn, &mut full, None).history;
        let past = self.history.take();
        let still_frames = if is_moving { 0 } else { past.as_ref().map_or(0, |past| past.still_frames) };
        self.history = Some(History {
            picture: None,
            accumulated,
            surfaces: Arc::clone(&self.surfaces),
            scene: Arc::clone(&self.scene),
            camera: self.scene.home,
            frames: past.map_or(0, |past| past.frames + 1),
            still_frames: still_frames + 1,
        });
        full
    }
}
