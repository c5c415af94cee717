//! Shots: scene and camera of every frame of a clip.

use std::sync::Arc;

use crate::scene::{Camera, CameraPath, Scene};

/// Scene and camera in motion, at a frame rate. Frame k shows the time k / frames per second.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Scene, in any pose.
    pub scene: Arc<Scene>,
    /// Home view of the camera path; the view of all frames without a path.
    pub camera: Camera,
    /// Camera path, if the camera moves.
    pub path: Option<CameraPath>,
    /// Number of frames per second, greater than 0.
    pub frames_per_second: f64,
}

impl Shot {
    /// Returns the time of a frame in seconds. Frames before the clip have negative numbers.
    pub fn time_s(&self, number: i64) -> f64 {
        number as f64 / self.frames_per_second
    }

    /// Returns the scene and the camera of a frame.
    pub fn view(&self, number: i64) -> (Arc<Scene>, Camera) {
        let time_s = self.time_s(number);
        let camera = self.path.as_ref().map_or(self.camera, |path| path.at(&self.camera, time_s));
        (self.scene.at(time_s), camera)
    }
}
