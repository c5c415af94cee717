//! Shots: scene and camera of every frame of a clip, and a renderer whose frames depend only on their numbers.

use std::sync::Arc;

use crate::chain::{Frame, KeepDepth, PrecedingView, Recipe, RenderInputs, Renderer, SavedHistory};
use crate::pipeline::settings::DepthTest;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, CameraPath, Scene};

/// Motion of a camera over the frames of a shot.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraMotion {
    /// Every frame has the same view.
    Still,
    /// The camera follows a path over time.
    Path(CameraPath),
    /// The camera orbits its target by an angle per frame.
    Orbit {
        /// Angle between two frames, in degrees.
        degrees_per_frame: f32,
    },
}

impl CameraMotion {
    /// Returns the motion along a path, or none without a path.
    pub fn along(path: Option<CameraPath>) -> Self {
        path.map_or(Self::Still, Self::Path)
    }

    /// Whether the view of the camera determines the views of the frames. Key views of a path replace it.
    fn reads_camera(&self) -> bool {
        !matches!(self, Self::Path(path) if path.keys().is_some())
    }
}

/// Frame with a given time, in which an orbiting camera has its own view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShotOrigin {
    /// Number of the frame.
    pub number: i64,
    /// Time of the frame in seconds.
    pub time_s: f64,
}

/// Scene and camera in motion, at a frame rate.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Scene, in any pose; without a frame rate, in the pose of all frames.
    pub scene: Arc<Scene>,
    /// Home view of the camera path; view of the origin of an orbit; view of all frames if the camera is still.
    pub camera: Camera,
    /// Motion of the camera.
    pub motion: CameraMotion,
    /// Number of frames per second; 0 keeps the scene in its pose.
    pub frames_per_second: f64,
    /// Frame from which times and angles are counted.
    pub origin: ShotOrigin,
}

impl Shot {
    /// Returns a shot whose frame k shows the time k / `frames_per_second`, with a camera along a path or at rest.
    pub fn from_start(scene: Arc<Scene>, camera: Camera, motion: CameraMotion, frames_per_second: f64) -> Self {
        Self { scene, camera, motion, frames_per_second, origin: ShotOrigin::default() }
    }

    /// Returns the time of a frame in seconds. Frames before the clip have negative numbers.
    pub fn time_s(&self, number: i64) -> f64 {
        if self.frames_per_second == 0.0 {
            return self.origin.time_s;
        }
        self.origin.time_s + number.saturating_sub(self.origin.number) as f64 / self.frames_per_second
    }

    /// Returns the camera of a frame.
    pub fn camera_of(&self, number: i64) -> Camera {
        match &self.motion {
            CameraMotion::Still => self.camera,
            CameraMotion::Path(path) => path.at(&self.camera, self.time_s(number)),
            CameraMotion::Orbit { degrees_per_frame } => {
                let mut camera = self.camera;
                let frames = number.saturating_sub(self.origin.number);
                if *degrees_per_frame != 0.0 && frames != 0 {
                    camera.orbit((degrees_per_frame * frames as f32).to_radians(), 0.0);
                }
                camera
            }
        }
    }

    /// Returns the scene and the camera of a frame.
    pub fn view(&self, number: i64) -> (Arc<Scene>, Camera) {
        let scene =
            if self.frames_per_second == 0.0 { Arc::clone(&self.scene) } else { self.scene.at(self.time_s(number)) };
        (scene, self.camera_of(number))
    }

    /// Whether both shots have the same frames.
    pub fn is_same(&self, other: &Self) -> bool {
        let is_same_scene = Arc::ptr_eq(&self.scene, &other.scene)
            || self.frames_per_second != 0.0 && self.scene.is_pose_of(&other.scene);
        is_same_scene
            && (self.camera == other.camera || !self.motion.reads_camera())
            && self.motion == other.motion
            && self.frames_per_second == other.frames_per_second
            && self.origin == other.origin
    }
}

/// Frame of a shot.
#[derive(Clone, Debug)]
pub struct ShotFrame {
    /// Shot that the frame belongs to.
    pub shot: Shot,
    /// Number of the frame; negative before the clip.
    pub number: i64,
}

impl ShotFrame {
    /// Whether both are the same frame of the same shot.
    pub fn is_same(&self, other: &Self) -> bool {
        self.number == other.number && self.shot.is_same(&other.shot)
    }

    /// Returns the number of the frame if it has a history with a recipe; `None` also before frame 0.
    pub fn number_with_history(&self, recipe: &Recipe) -> Option<u32> {
        let has_history = recipe.upscaler.upscaler().reads().history && recipe.pipeline.depth_test != DepthTest::Off;
        u32::try_from(self.number).ok().filter(|_| has_history)
    }

    /// Whether the frame shows a pose of the scene of the shot, as seen by a camera. A time between two frames belongs to
    /// no frame.
    pub fn shows(&self, pose: &Scene, camera: &Camera) -> bool {
        let is_at_time = pose.animation.is_none() || pose.time_s() == self.shot.time_s(self.number);
        is_at_time && self.shot.camera_of(self.number) == *camera
    }

    /// Returns the view of the preceding frame.
    pub fn before(&self) -> PrecedingView {
        let (scene, camera) = self.shot.view(self.number.saturating_sub(1));
        PrecedingView { scene, camera }
    }
}

/// Inputs that determine the frames of a [`ShotRenderer`], together with their numbers.
#[derive(Clone, Debug)]
pub struct ShotInputs {
    /// Scene and camera in motion.
    pub shot: Shot,
    /// Recipe of all frames.
    pub recipe: Recipe,
    /// Size of all frames, in pixels.
    pub viewport: Viewport,
}

impl ShotInputs {
    /// Whether both have the same frames.
    pub fn is_same(&self, other: &Self) -> bool {
        (self.recipe, self.viewport) == (other.recipe, other.viewport) && self.shot.is_same(&other.shot)
    }
}

/// Renderer of the frames of a shot with one recipe. A frame has the history of all frames from frame 0 on, so that it
/// depends only on its number. Frame 0 has no history.
#[derive(Debug)]
pub struct ShotRenderer {
    inputs: ShotInputs,
    renderer: Renderer,
    /// Number of the frame that continues the history of the renderer.
    next: u32,
}

impl ShotRenderer {
    /// Prepares to draw frames; draws nothing yet.
    pub fn new(inputs: ShotInputs) -> Self {
        Self::reusing(inputs, Renderer::default())
    }

    /// Prepares to draw frames with the buffers of a renderer, whose history is discarded.
    pub fn reusing(inputs: ShotInputs, mut renderer: Renderer) -> Self {
        renderer.forget_history();
        Self { inputs, renderer, next: 0 }
    }

    /// Returns the inputs that determine the frames.
    pub fn inputs(&self) -> &ShotInputs {
        &self.inputs
    }

    /// Returns the number of frames that the history holds.
    pub fn history_frames(&self) -> u32 {
        self.next
    }

    /// Returns the history of the frames drawn so far; `None` if there is none.
    pub fn history(&self) -> Option<SavedHistory> {
        self.renderer.history()
    }

    /// Continues from a history of `frames` frames, which a renderer with the same inputs has returned.
    pub fn restore_history(&mut self, frames: u32, history: SavedHistory) {
        self.renderer.restore_history(history);
        self.next = frames;
    }

    /// Draws one frame that is missing from the history of frame `number`. Returns `false` if none is missing, as for
    /// every frame of an upscaler that reads no history.
    pub fn warm_up(&mut self, number: u32) -> bool {
        if !self.inputs.recipe.upscaler.upscaler().reads().history {
            return false;
        }
        if self.next > number {
            self.renderer.forget_history();
            self.next = 0;
        }
        if self.next == number {
            return false;
        }
        let frame = self.render(self.next, KeepDepth::No);
        self.renderer.recycle(frame);
        true
    }

    /// Draws a frame, after those that are missing from its history.
    pub fn draw(&mut self, number: u32, keep_depth: KeepDepth) -> Frame {
        while self.warm_up(number) {}
        let mut frame = self.render(number, keep_depth);
        frame.before = Some(ShotFrame { shot: self.inputs.shot.clone(), number: number.into() }.before());
        frame
    }

    /// Takes back the buffers of a frame that is no longer needed, for reuse.
    pub fn recycle(&mut self, frame: Frame) {
        self.renderer.recycle(frame);
    }

    /// Returns the renderer, which holds the history of the frame drawn last.
    pub fn into_renderer(self) -> Renderer {
        self.renderer
    }

    fn render(&mut self, number: u32, keep_depth: KeepDepth) -> Frame {
        let ShotInputs { shot, recipe, viewport } = &self.inputs;
        let (scene, camera) = shot.view(number.into());
        self.next = number + 1;
        self.renderer.render(RenderInputs { scene: &scene, camera: &camera, recipe, viewport: *viewport }, keep_depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 40, height: 24 };

    fn turning(scene: Arc<Scene>) -> Shot {
        let camera = scene.home;
        Shot::from_start(scene, camera, CameraMotion::along(CameraPath::preset("turntable")), 30.0)
    }

    #[test]
    fn an_orbit_and_its_times_end_at_the_origin() {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let (camera, motion) = (scene.home, CameraMotion::Orbit { degrees_per_frame: 2.0 });
        let origin = ShotOrigin { number: 3, time_s: 0.5 };
        let shot = Shot { scene, camera, motion, frames_per_second: 20.0, origin };
        let mut earlier = camera;
        earlier.orbit(-4.0_f32.to_radians(), 0.0);
        assert_eq!((shot.camera_of(3), shot.camera_of(1)), (camera, earlier));
        assert_eq!((shot.time_s(3), shot.view(1).0.time_s()), (0.5, 0.5 - 2.0 / 20.0));
        let posed = Shot { frames_per_second: 0.0, ..shot };
        assert!(Arc::ptr_eq(&posed.view(1).0, &posed.scene));
    }

    #[test]
    fn frames_are_those_of_consecutive_drawing_in_any_order() {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let shot = turning(scene);
        for upscaler in [Upscaling::new("taa", 2).unwrap(), Upscaling::new("bilinear", 2).unwrap()] {
            let recipe = Recipe { upscaler, ..Recipe::default() };
            let mut renderer = Renderer::default();
            let consecutive: Vec<_> = (0..4)
                .map(|number| {
                    let (scene, camera) = shot.view(number);
                    renderer
                        .render(
                            RenderInputs { scene: &scene, camera: &camera, recipe: &recipe, viewport: SIZE },
                            KeepDepth::No,
                        )
                        .image()
                        .clone()
                })
                .collect();
            let mut jumping = ShotRenderer::new(ShotInputs { shot: shot.clone(), recipe, viewport: SIZE });
            for number in [3, 1, 2, 0, 0] {
                let frame = jumping.draw(number, KeepDepth::No);
                assert!(*frame.image() == consecutive[number as usize], "{} frame {number}", upscaler.label());
                let before = frame.before.as_ref().unwrap();
                assert_eq!(before.camera, shot.camera_of(i64::from(number) - 1));
            }
        }
    }

    #[test]
    fn a_frame_shows_its_own_pose_and_camera_only() {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let shot = turning(scene);
        let frame = ShotFrame { shot: shot.clone(), number: 2 };
        let (pose, camera) = shot.view(2);
        assert!(frame.shows(&pose, &camera) && !frame.shows(&pose, &shot.view(1).1));
        assert!(!frame.shows(&shot.scene.at(0.07), &camera));
        let next = ShotFrame { number: 3, ..frame.clone() };
        let slower = ShotFrame { shot: Shot { frames_per_second: 24.0, ..shot }, number: 2 };
        assert!(frame.is_same(&frame.clone()) && !frame.is_same(&next) && !frame.is_same(&slower));
    }
}
