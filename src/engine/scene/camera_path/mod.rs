//! Camera paths: views over time, given by key views in a file or by a preset.

mod file;
mod presets;

use std::path::Path;

use glam::DVec3;

use super::{Camera, Projection, SceneError};
use presets::Preset;

/// Motion of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath(Motion);

#[derive(Clone, Debug, PartialEq)]
enum Motion {
    /// Function of the home view and the time.
    Preset(Preset),
    /// Key views in ascending order of their times; at least one.
    Keys(Vec<KeyView>),
}

/// View of a camera path at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyView {
    /// Time in seconds, at least 0.
    pub time_s: f64,
    /// View at this time.
    pub camera: Camera,
}

/// Key views in serialised structures, for `#[serde(with = "key_views")]`, in the form of files.
pub(crate) mod key_views {
    pub(crate) use super::file::{ascending_keys as deserialize, serialize_keys as serialize};
}

impl CameraPath {
    /// Returns the names of the presets.
    pub fn presets() -> impl Iterator<Item = &'static str> {
        Preset::ALL.iter().map(|preset| preset.name())
    }

    /// Returns the preset with this name; `None` if there is none.
    pub fn preset(name: &str) -> Option<Self> {
        let preset = Preset::ALL.iter().find(|preset| preset.name() == name)?;
        Some(Self(Motion::Preset(*preset)))
    }

    /// Reads a path from a JSON file such as `{"version": 1, "keys": [{"time_s": 0, "camera": {…}}, …]}`, with cameras
    /// as in camera files.
    ///
    /// # Errors
    /// Returns an error with file and line if the file is unreadable or malformed, if its version is unknown, if times
    /// do not ascend, or if perspective and orthographic views are mixed.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        file::read(path).map(|keys| Self(Motion::Keys(keys)))
    }

    /// Whether a file looks like a camera path rather than another JSON file, so that [`Self::read`] explains its errors.
    pub fn is_file(path: &Path) -> bool {
        file::has_keys(path)
    }

    /// Returns the key views; `None` for a preset.
    pub fn keys(&self) -> Option<&[KeyView]> {
        match &self.0 {
            Motion::Preset(_) => None,
            Motion::Keys(keys) => Some(keys),
        }
    }

    /// Creates a path through key views in ascending order of their times.
    ///
    /// # Errors
    /// Returns the reason if there is no key view, if a time is negative or does not ascend, if a camera is invalid, or if
    /// perspective and orthographic views are mixed.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::scene::{Camera, CameraPath, KeyView};
    ///
    /// let camera = Camera::look_at(glam::Vec3::Z, glam::Vec3::ZERO);
    /// let keys = [0.0, 2.0].map(|time_s| KeyView { time_s, camera });
    /// assert_eq!(CameraPath::through(keys.to_vec()).unwrap().duration_s(), 2.0);
    /// assert!(CameraPath::through(Vec::new()).is_err());
    /// ```
    pub fn through(keys: Vec<KeyView>) -> Result<Self, String> {
        if keys.is_empty() {
            return Err("a path has at least one key view".to_owned());
        }
        let mut before = None;
        for key in &keys {
            key.camera.check()?;
            file::check(key.time_s, &key.camera, before.replace(*key))?;
        }
        Ok(Self(Motion::Keys(keys)))
    }

    /// Encodes the path as a JSON file that [`Self::read`] restores bit for bit. Returns `None` for a preset.
    ///
    /// # Errors
    /// Returns an error if a number has no representation in JSON.
    pub fn encode(&self) -> serde_json::Result<Option<Vec<u8>>> {
        match &self.0 {
            Motion::Preset(_) => Ok(None),
            Motion::Keys(keys) => file::encode(keys).map(Some),
        }
    }

    /// Returns the length of the path in seconds. Presets repeat after it; at the end of a file, the camera stops.
    pub fn duration_s(&self) -> f64 {
        match &self.0 {
            Motion::Preset(preset) => preset.duration_s(),
            Motion::Keys(keys) => keys.last().map_or(0.0, |key| key.time_s),
        }
    }

    /// Returns the view at a time in seconds. `home` is the view that presets move; key views replace it.
    ///
    /// Before its first key view and after its last one, the path has that view. A time that is not finite gives the
    /// view at time 0.
    pub fn at(&self, home: &Camera, time_s: f64) -> Camera {
        let time_s = if time_s.is_finite() { time_s } else { 0.0 };
        match &self.0 {
            Motion::Preset(preset) => preset.at(home, time_s),
            Motion::Keys(keys) => between_keys(keys, time_s).unwrap_or(*home),
        }
    }
}

/// Returns the view of a path at a time; `None` if there are no key views.
fn between_keys(keys: &[KeyView], time_s: f64) -> Option<Camera> {
    let before = keys.partition_point(|key| key.time_s <= time_s).saturating_sub(1);
    let (from, to) = (keys.get(before)?, keys.get(before + 1));
    let Some(to) = to.filter(|_| time_s > from.time_s) else { return Some(from.camera) };
    let span = Span {
        earlier: before.checked_sub(1).and_then(|earlier| keys.get(earlier)),
        from,
        to,
        later: keys.get(before + 2),
        share: (time_s - from.time_s) / (to.time_s - from.time_s),
    };
    let camera = span.camera();
    // Eye and target of very different views may meet between them.
    Some(if camera.check().is_ok() { camera } else { from.camera })
}

/// Two neighbouring key views, the key views around them, and a fraction of the way between them.
struct Span<'a> {
    earlier: Option<&'a KeyView>,
    from: &'a KeyView,
    to: &'a KeyView,
    later: Option<&'a KeyView>,
    share: f64,
}

impl Span<'_> {
    fn camera(&self) -> Camera {
        let [from, to] = [self.from.camera, self.to.camera];
        let projection = match (from.projection, to.projection) {
            (Projection::Perspective { fov_y: a }, Projection::Perspective { fov_y: b }) => {
                Projection::Perspective { fov_y: self.linear(a, b) }
            }
            (Projection::Orthographic { height: a }, Projection::Orthographic { height: b }) => {
                Projection::Orthographic { height: self.linear(a, b) }
            }
            // Rejected when a file is read.
            (other, _) => other,
        };
        Camera {
            eye: self.smooth(|camera| camera.eye.as_dvec3()).as_vec3(),
            target: self.smooth(|camera| camera.target.as_dvec3()).as_vec3(),
            up: self.smooth(|camera| camera.up.as_dvec3().normalize_or(DVec3::Y)).normalize_or(DVec3::Y).as_vec3(),
            projection,
            near: self.linear(from.near, to.near),
            far: self.linear(from.far, to.far),
            sub_view: None,
        }
    }

    fn linear(&self, from: f32, to: f32) -> f32 {
        (f64::from(from) * (1.0 - self.share) + f64::from(to) * self.share) as f32
    }

    /// Interpolates a vector by the Catmull–Rom spline for key frames at unequal times: a cubic Hermite spline whose
    /// tangent at a key is the slope between its neighbours (Catmull and Rom, "A Class of Local Interpolating Splines",
    /// 1974).
    fn smooth(&self, vector: impl Fn(&Camera) -> DVec3) -> DVec3 {
        let slope =
            |from: &KeyView, to: &KeyView| (vector(&to.camera) - vector(&from.camera)) / (to.time_s - from.time_s);
        let length_s = self.to.time_s - self.from.time_s;
        let tangent = slope(self.earlier.unwrap_or(self.from), self.to) * length_s;
        let next_tangent = slope(self.from, self.later.unwrap_or(self.to)) * length_s;
        let (t, square, cube) = (self.share, self.share.powi(2), self.share.powi(3));
        vector(&self.from.camera) * (2.0 * cube - 3.0 * square + 1.0)
            + tangent * (cube - 2.0 * square + t)
            + vector(&self.to.camera) * (3.0 * square - 2.0 * cube)
            + next_tangent * (cube - square)
    }
}

#[cfg(test)]
mod tests;
