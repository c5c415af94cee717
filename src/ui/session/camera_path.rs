//! Camera path recorded in the window: key views at times of the scene, which the strip below the picture plays.
//!
//! A still scene has no time of its own; while it has a path, the path gives it one.

use super::feature::Feature;
use super::window_task::WindowTask;
use super::{Session, Severity};
use crate::inspect::project::StoredPath;
use crate::scene::{CameraPath, KeyView};

/// Time from the last key view to one that is appended, in seconds.
const STEP_S: f64 = 2.0;

/// Largest difference of two times that count as the same, in seconds.
const SAME_S: f64 = 1e-6;

/// Recorded key views, and whether the camera follows them.
#[derive(Debug)]
pub(crate) struct RecordedPath {
    /// Key views in ascending order of their times, all with perspective or all with orthographic projection.
    pub(crate) keys: Vec<KeyView>,
    /// Whether the camera follows the path when the time changes.
    pub(crate) follows: bool,
    /// Shown time of a still scene, in seconds.
    time_s: f64,
}

impl Default for RecordedPath {
    fn default() -> Self {
        Self { keys: Vec::new(), follows: true, time_s: 0.0 }
    }
}

/// Change of the recorded path that the user requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CameraPathChange {
    /// Adds the view at the shown time, or after the last key view if there is already one at that time.
    Add,
    /// Removes the last key view at or before the shown time.
    Remove,
    /// Removes all key views.
    Clear,
    /// Sets whether the camera follows the path.
    Follow(bool),
}

impl RecordedPath {
    /// Returns the path; `None` without a key view.
    pub(crate) fn path(&self) -> Option<CameraPath> {
        CameraPath::through(self.keys.clone()).ok()
    }

    /// Returns the path if the camera follows it.
    pub(crate) fn followed(&self) -> Option<CameraPath> {
        self.path().filter(|_| self.follows)
    }

    /// Returns the length of the path in seconds; `None` without a key view.
    pub(crate) fn duration_s(&self) -> Option<f64> {
        self.keys.last().map(|key| key.time_s)
    }

    /// Returns the path for a project; `None` without a key view.
    pub(in crate::ui) fn stored(&self) -> Option<StoredPath> {
        let Self { keys, follows, time_s } = self;
        (!keys.is_empty()).then(|| StoredPath { keys: keys.clone(), follows: *follows, time_s: *time_s })
    }

    /// Replaces the path by that of a project.
    pub(in crate::ui) fn restore(&mut self, stored: &StoredPath) {
        *self = Self { keys: stored.keys.clone(), follows: stored.follows, time_s: stored.time_s };
    }

    /// Returns the index of the last key view at or before a time in seconds.
    fn index_before(&self, time_s: f64) -> Option<usize> {
        self.keys.partition_point(|key| key.time_s <= time_s + SAME_S).checked_sub(1)
    }

    /// Returns the key views with a further one, and its time: `key.time_s`, or some time after the last key view if there
    /// is already one at that time.
    fn with(&self, key: KeyView) -> (Vec<KeyView>, f64) {
        let mut keys = self.keys.clone();
        let before = self.index_before(key.time_s);
        let is_taken = before.is_some_and(|index| key.time_s - keys[index].time_s <= SAME_S);
        let (place, time_s) = match (is_taken, keys.last()) {
            (true, Some(last)) => (keys.len(), last.time_s + STEP_S),
            _ => (before.map_or(0, |index| index + 1), key.time_s),
        };
        keys.insert(place, KeyView { time_s, ..key });
        (keys, time_s)
    }
}

impl Feature for RecordedPath {
    type Change = CameraPathChange;

    fn apply(session: &mut Session, change: CameraPathChange) -> Option<WindowTask> {
        let time_s = session.shown_time_s();
        let path = &mut session.features.camera_path;
        match change {
            CameraPathChange::Add => session.add_key_view(),
            CameraPathChange::Remove => {
                if let Some(index) = path.index_before(time_s) {
                    path.keys.remove(index);
                }
            }
            CameraPathChange::Clear => path.keys.clear(),
            CameraPathChange::Follow(follows) => path.follows = follows,
        }
        None
    }

    fn leave_scene(&mut self) {
        *self = Self { follows: self.follows, ..Self::default() };
    }
}

impl Session {
    /// Returns the shown time in seconds: that of the scene's pose, or of the camera path if the scene is still.
    pub(crate) fn shown_time_s(&self) -> f64 {
        if self.scene.animation.is_some() { self.scene.time_s() } else { self.features.camera_path.time_s }
    }

    /// Shows a time in seconds: poses the scene, and moves the camera if it follows the recorded path.
    pub(super) fn show_time(&mut self, time_s: f64) {
        self.scene = self.scene.at(time_s);
        self.features.camera_path.time_s = time_s;
        if let Some(path) = self.features.camera_path.followed() {
            self.state.camera = path.at(&self.state.camera, time_s);
        }
    }

    /// Replaces the recorded path by one from a file, and shows its beginning.
    pub(in crate::ui) fn open_camera_path(&mut self, path: &CameraPath) {
        let Some(keys) = path.keys() else { return };
        self.features.camera_path = RecordedPath { keys: keys.to_vec(), ..RecordedPath::default() };
        self.features.scene_time.is_playing = false;
        self.show_time(0.0);
        let text = match keys {
            [_] => "Opened a camera path with 1 key view".to_owned(),
            keys => format!("Opened a camera path with {} key views", keys.len()),
        };
        self.report(Severity::Info, text);
    }

    /// Adds the view to the recorded path, and shows its time without changing the view.
    fn add_key_view(&mut self) {
        let key = KeyView { time_s: self.shown_time_s(), camera: self.state.camera };
        let (keys, time_s) = self.features.camera_path.with(key);
        match CameraPath::through(keys.clone()) {
            Ok(_) => {
                self.features.camera_path.keys = keys;
                self.show_time(time_s);
                self.report(Severity::Info, format!("Added a key view at {time_s:.2} s"));
            }
            Err(reason) => self.report(Severity::Error, format!("Cannot add this key view: {reason}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::Camera;

    #[test]
    fn key_views_are_inserted_at_their_time_or_appended_if_it_is_taken() {
        let mut recorded = RecordedPath::default();
        for (time_s, stored_s) in [(0.0, 0.0), (0.0, 2.0), (2.0, 4.0), (3.0, 3.0), (2.0, 6.0)] {
            let (keys, time_s) = recorded.with(KeyView { time_s, camera: Camera::look_at(Vec3::Z, Vec3::ZERO) });
            assert_eq!(time_s, stored_s);
            recorded.keys = keys;
            assert!(recorded.path().is_some());
        }
        assert_eq!(recorded.keys.iter().map(|key| key.time_s).collect::<Vec<_>>(), [0.0, 2.0, 3.0, 4.0, 6.0]);
        assert_eq!(
            [-1.0, 0.0, 2.9, 9.0].map(|time_s| recorded.index_before(time_s)),
            [None, Some(0), Some(1), Some(4)]
        );
    }
}
