//! Inspection state as one value: scene, view, recipe, displayed quantity, and inspected pixel.
//!
//! Bookmarks and the inspection history store this state. Its text form is a command line of this program, which a
//! person can read, edit, and run to draw the same picture.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::buffers::Buffer;
use super::display::Display;
use super::fields::assignments;
use super::intermediate::Intermediate;
use super::overlays::OverlayLayer;
use super::stages::Stage;
use crate::chain::Recipe;
use crate::disk::stored_path;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, camera_file};
use crate::text::shell_line;

/// Complete state of an inspection, which can be restored later.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InspectionState {
    /// Inspected scene: the id of a built-in scene, or the path of a file.
    #[serde(with = "stored_path")]
    pub scene: PathBuf,
    /// Whether the scene is mirrored in z. `camera` views the mirrored scene.
    pub mirrored: bool,
    /// Time of the pose of an animated scene, in seconds; finite.
    #[serde(default)]
    pub time_s: f64,
    /// Camera of the view.
    pub camera: Camera,
    /// Recipe for drawing the frame.
    pub recipe: Recipe,
    /// Size of the picture in px; `None` for the size of the canvas.
    pub picture: Option<(u32, u32)>,
    /// Displayed buffer, if neither a stage nor an intermediate value is displayed.
    pub buffer: Buffer,
    /// Displayed pipeline stage; `None` if none is displayed.
    pub stage: Option<Stage>,
    /// Displayed intermediate value, if no stage is displayed.
    #[serde(default)]
    pub number: Option<Intermediate>,
    /// Range, colour map and channels of the display.
    #[serde(default)]
    pub display: Display,
    /// Overlays of the picture, from bottom to top.
    #[serde(default)]
    pub overlays: Vec<OverlayLayer>,
    /// Number of rasterized triangles to draw; `None` for all.
    pub triangles: Option<usize>,
    /// Number of drawn fragments of the last triangle; `None` if all of them are drawn.
    #[serde(default)]
    pub fragments: Option<usize>,
    /// Inspected pixel: column and row in the full picture.
    pub pixel: Option<(u32, u32)>,
}

impl InspectionState {
    /// Returns an error if this state cannot be restored, for example if stored data is damaged or from another
    /// version.
    pub fn check(&self) -> Result<(), String> {
        self.recipe.check()?;
        self.camera.check()?;
        if !self.time_s.is_finite() {
            return Err(format!("the time of the scene must be finite, not {}", self.time_s));
        }
        self.picture.map_or(Ok(()), |(width, height)| Viewport { width, height }.check())
    }

    /// Returns the command line that restores this state in the window, with words quoted where a shell requires it.
    pub fn command_line(&self) -> String {
        self.command_line_of("window", &[])
    }

    /// Returns the command line that runs a command of the program with this state and further options, with words
    /// quoted where a shell requires it.
    pub fn command_line_of(&self, command: &str, options: &[&str]) -> String {
        let scene = self.scene.to_string_lossy();
        // The prefix `./` prevents a path from being parsed as an option.
        let scene = if scene.starts_with('-') { format!("./{scene}") } else { scene.into_owned() };
        let mut words = vec!["rasterscope".to_owned(), command.to_owned(), scene];
        words.extend(self.mirrored.then(|| "--mirror-z".to_owned()));
        let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
        if self.time_s != 0.0 {
            option("time", self.time_s.to_string());
        }
        option("camera", camera_file::text(&self.camera));
        if let Some(process) = self.recipe.upscaler.upscaler().process() {
            option("upscaler-process", process.to_owned());
        }
        for assignment in assignments(&self.recipe) {
            option("set", assignment);
        }
        if let Some((width, height)) = self.picture {
            option("picture", format!("{width}x{height}"));
        }
        match (self.stage, self.number) {
            (Some(stage), _) => option("stage", stage.id().to_owned()),
            (None, Some(number)) => option("buffer", number.id().to_owned()),
            (None, None) if self.buffer != Buffer::Color => option("buffer", self.buffer.id().to_owned()),
            (None, None) => {}
        }
        if self.display != Display::default() {
            option("look", self.display.text());
        }
        for layer in &self.overlays {
            option("overlay", layer.text());
        }
        if let Some(limit) = self.triangles {
            option("triangles", limit.to_string());
            if let Some(fragments) = self.fragments {
                option("fragments", fragments.to_string());
            }
        }
        if let Some((x, y)) = self.pixel {
            option("at", format!("{x},{y}"));
        }
        words.extend(options.iter().map(|option| (*option).to_owned()));
        shell_line(&words)
    }

    /// Returns a short description of the state, such as "pixel 12, 34, Depth".
    pub fn words(&self) -> String {
        let shown = match (self.stage, self.number) {
            (Some(stage), _) => Some(stage.name()),
            (None, Some(number)) => Some(number.name()),
            (None, None) => (self.buffer != Buffer::Color).then(|| self.buffer.name()),
        };
        let pixel = self.pixel.map(|(x, y)| format!("pixel {x}, {y}"));
        let parts: Vec<_> = pixel.into_iter().chain(shown.map(str::to_owned)).collect();
        if parts.is_empty() { "the picture".to_owned() } else { parts.join(", ") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    fn place() -> InspectionState {
        InspectionState {
            scene: "triangle".into(),
            mirrored: false,
            time_s: 0.0,
            camera: builtin::by_id("triangle").unwrap().build().home,
            recipe: Recipe::default(),
            picture: None,
            buffer: Buffer::Color,
            stage: None,
            number: None,
            display: Display::default(),
            overlays: Vec::new(),
            triangles: None,
            fragments: None,
            pixel: None,
        }
    }

    #[test]
    fn the_command_line_contains_only_differences_from_the_defaults() {
        let mut place = place();
        let line = place.command_line();
        assert!(line.starts_with("rasterscope window triangle --camera '{\"eye\":["), "{line}");
        assert_eq!(line.matches(" --").count(), 1, "{line}");
        place.recipe.set("culling=none").unwrap();
        (place.pixel, place.buffer, place.triangles) = (Some((3, 4)), Buffer::Depth, Some(7));
        (place.picture, place.mirrored, place.fragments) = (Some((320, 200)), true, Some(8));
        place.time_s = 0.1;
        place.display = "map=magma,reversed".parse().unwrap();
        place.overlays = vec!["facing=0.25".parse().unwrap(), "wireframe".parse().unwrap()];
        let line = place.command_line();
        for part in [
            "--mirror-z --time 0.1 --camera ",
            "--set culling=none",
            "--picture 320x200",
            "--buffer depth --look map=magma,reversed --overlay facing=0.25 --overlay wireframe",
            "--triangles 7 --fragments 8",
            "--at 3,4",
        ] {
            assert!(line.contains(part), "{part} in {line}");
        }
    }

    #[test]
    fn a_state_that_cannot_be_drawn_is_rejected() {
        let mut place = place();
        assert_eq!(place.check(), Ok(()));
        place.picture = Some((1 << 20, 1 << 20));
        assert!(place.check().is_err());
        (place.picture, place.time_s) = (None, f64::INFINITY);
        assert!(place.check().is_err());
        (place.time_s, place.camera.near) = (0.0, f32::NAN);
        assert!(place.check().is_err());
    }
}
