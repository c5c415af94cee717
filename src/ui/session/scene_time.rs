//! Time of an animated scene: the shown frame, and playback.
//!
//! The scene on screen is posed at frame number / frames per second. Playback skips no frame: it goes on when the frame
//! is on screen, so that every frame has the preceding one as its history. For a frame that is reached in another way,
//! [`crate::ui::engine::replay`] draws the preceding frames first.

use std::sync::Arc;

use super::Session;
use super::feature::Feature;
use super::window_task::WindowTask;
use crate::measure::shot::{CameraMotion, Shot, ShotFrame};
use crate::scene::{Camera, Scene};
use crate::ui::engine::replay::ReplayProgress;

/// Selectable frame rates, in frames per second.
pub(crate) const FRAME_RATES: [u32; 5] = [10, 24, 25, 30, 60];

/// Selectable playback speeds, relative to real time.
pub(crate) const SPEEDS: [f32; 5] = [0.1, 0.25, 0.5, 1.0, 2.0];

/// Playback of an animated scene.
#[derive(Debug)]
pub(crate) struct SceneTime {
    /// Number of frames per second of the scene.
    pub(crate) frames_per_second: u32,
    /// Whether the scene is being played.
    pub(crate) is_playing: bool,
    /// Playback speed, relative to real time.
    pub(crate) speed: f32,
    /// Whether playback starts again at the end of the motion. Otherwise, it stops.
    pub(crate) loops: bool,
    /// Elapsed fraction of the shown frame's time, in [0, 1].
    due: f32,
    /// Progress of drawing the frames before the shown one; `None` if that takes less than a second.
    pub(crate) replay: Option<ReplayProgress>,
}

impl Default for SceneTime {
    fn default() -> Self {
        Self { frames_per_second: 30, is_playing: false, speed: 1.0, loops: true, due: 0.0, replay: None }
    }
}

/// Change of the scene's time that the user requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SceneTimeChange {
    /// Shows this frame and pauses.
    Go(i64),
    /// Shows the frame after this number of frames and pauses.
    Step(i64),
    /// Plays from the shown frame, or pauses.
    TogglePlay,
    /// Sets the playback speed, relative to real time.
    Speed(f32),
    /// Sets the number of frames per second, and keeps the time as nearly as possible.
    FrameRate(u32),
    /// Sets whether playback starts again at the end.
    Loop(bool),
    /// Advances playback by this many seconds.
    Tick(f32),
    /// Stops drawing the frames before the shown one, which keeps the history of the frames shown.
    CancelReplay,
}

impl Feature for SceneTime {
    type Change = SceneTimeChange;

    fn apply(session: &mut Session, change: SceneTimeChange) -> Option<WindowTask> {
        let (frame, count) = (session.scene_frame(), session.scene_frame_count()?);
        let is_shown = session.shows_wanted_time();
        let time = &mut session.features.scene_time;
        let mut wanted = frame;
        match change {
            SceneTimeChange::Go(number) => (wanted, time.is_playing) = (number, false),
            SceneTimeChange::Step(frames) => (wanted, time.is_playing) = (frame.saturating_add(frames), false),
            SceneTimeChange::TogglePlay => (time.is_playing, time.due) = (!time.is_playing, 0.0),
            SceneTimeChange::Speed(speed) => time.speed = speed,
            SceneTimeChange::FrameRate(rate) => {
                let time_s = frame as f64 / f64::from(time.frames_per_second);
                time.frames_per_second = rate.max(1);
                wanted = (time_s * f64::from(time.frames_per_second)).round() as i64;
                // The pose differs even if the number is the same.
                session.show_scene_frame(wanted);
                return None;
            }
            SceneTimeChange::Loop(loops) => time.loops = loops,
            SceneTimeChange::CancelReplay => {
                time.replay = None;
                return Some(WindowTask::CancelReplay);
            }
            SceneTimeChange::Tick(seconds) => {
                time.due = (time.due + seconds * time.speed * time.frames_per_second as f32).min(1.0);
                if time.due >= 1.0 && is_shown {
                    time.due = 0.0;
                    wanted += 1;
                    time.is_playing &= time.loops || wanted < count;
                }
            }
        }
        if wanted != frame {
            session.show_scene_frame(wanted.rem_euclid(count));
        }
        None
    }

    fn leave_scene(&mut self) {
        (self.is_playing, self.due) = (false, 0.0);
    }
}

impl Session {
    /// Returns the number of the frame that is shown, counted from time 0.
    pub(crate) fn scene_frame(&self) -> i64 {
        (self.shown_time_s() * f64::from(self.features.scene_time.frames_per_second)).round() as i64
    }

    /// Returns the number of frames of one loop of the scene's motion, or of the recorded camera path if it is longer, at
    /// least 1; `None` for a still scene without a path.
    pub(crate) fn scene_frame_count(&self) -> Option<i64> {
        let frames =
            |duration_s: f64| (duration_s * f64::from(self.features.scene_time.frames_per_second)).round() as i64;
        let of_scene = self.scene.animation.as_ref().map(|motion| frames(motion.duration_s()).max(1));
        // A loop of the scene ends before its first pose appears again, a path ends with its last view.
        let of_path = self.features.camera_path.duration_s().map(|duration_s| frames(duration_s) + 1);
        of_scene.max(of_path)
    }

    /// Shows the time of a frame.
    fn show_scene_frame(&mut self, frame: i64) {
        self.show_time(self.time_of_frame_s(frame));
    }

    fn time_of_frame_s(&self, frame: i64) -> f64 {
        frame as f64 / f64::from(self.features.scene_time.frames_per_second)
    }

    /// Returns the shown frame of the scene's motion, seen by the camera along the recorded path if it follows that, else by
    /// a camera at rest. Returns `None` if neither the scene nor the camera moves.
    pub(in crate::ui) fn shot_frame(&self) -> Option<ShotFrame> {
        let (camera, time_s) = (self.state.camera, self.shown_time_s());
        let path = self.features.camera_path.followed();
        let path = path.filter(|path| path.duration_s() > 0.0 && path.at(&camera, time_s) == camera);
        if self.scene.animation.is_none() && path.is_none() {
            return None;
        }
        let frames_per_second = self.features.scene_time.frames_per_second.into();
        let shot = Shot::from_start(Arc::clone(&self.scene), camera, CameraMotion::along(path), frames_per_second);
        Some(ShotFrame { shot, number: self.scene_frame() })
    }

    /// Whether the pictures on screen show the scene at the current time.
    fn shows_wanted_time(&self) -> bool {
        let is_shown =
            |scene: &Arc<Scene>, camera: &Camera| Arc::ptr_eq(scene, &self.scene) && *camera == self.state.camera;
        let is_compared = !self.features.comparison.is_on()
            || self.features.comparison.compared.as_ref().is_some_and(|compared| {
                let tiles = compared.tiles.len() == compared.request.recipes.len();
                tiles && is_shown(&compared.request.scene, &compared.request.camera)
            });
        is_compared && self.view.as_ref().is_some_and(|view| is_shown(&view.request.scene, &view.request.camera))
    }
}
