//! Clips for research on temporal upscaling: the low-resolution inputs of every frame, and its converged reference.
//!
//! A frame gives two OpenEXR files. The input has the drawn samples: colour in linear light, distance, motion since the
//! preceding frame and disocclusion. The reference is the mean of many samples of every pixel of the full picture. An
//! index in JSON describes all frames, with the jitter, the camera and the SHA-256 of every file. Equal plans give equal
//! bytes on any machine.

use std::fmt::Write as _;
use std::io;
use std::sync::Arc;

use glam::DMat4;
use serde::Serialize;
use sha2::{Digest as _, Sha256};

use crate::chain::{Frame, KeepDepth, PrecedingView, Recipe, RenderInputs, Renderer};
use crate::image::Image;
use crate::image::color::Tables;
use crate::image::picture::{Channel, DataWindow, Picture, Samples, encode_exr};
use crate::inspect::buffer_file::render_attributes;
use crate::measure::reference::ProgressiveRender;
use crate::measure::shot::Shot;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, camera_file};

/// Version of the index, which changes if an older reader would misread it.
const VERSION: u32 = 1;

/// Scene, settings and length of a clip.
#[derive(Clone, Debug)]
pub struct ClipPlan {
    /// Scene and camera of every frame.
    pub shot: Shot,
    /// Recipe, whose upscaler determines the size and the jitter of the inputs.
    pub recipe: Recipe,
    /// Size of the references, in pixels.
    pub viewport: Viewport,
    /// Number of frames in the clip.
    pub frames: u32,
    /// Number of samples per pixel of the references.
    pub samples: u32,
}

/// One of the files that make up a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipFile {
    /// File name, without folder.
    pub name: String,
    /// Bytes of the file.
    pub bytes: Vec<u8>,
}

/// Index of a clip, written as JSON.
#[derive(Debug, Serialize)]
struct Index<'a> {
    rasterscope_clip: u32,
    command: &'a str,
    scene: &'a str,
    size_px: [u32; 2],
    upscaler: String,
    frames_per_second: f64,
    samples_per_pixel: u32,
    frames: &'a [FrameEntry],
}

/// Frame in the index of a clip.
#[derive(Debug, Serialize)]
struct FrameEntry {
    number: u32,
    time_s: f64,
    input_size_px: [u32; 2],
    /// Position of the samples minus the centre of their pixels, in pixels of the input.
    jitter_px: [f64; 2],
    #[serde(with = "camera_file")]
    camera: Camera,
    /// Matrix from world space to the clip space of the full picture, without jitter, column by column.
    clip_from_world: [f64; 16],
    input: FileEntry,
    reference: FileEntry,
}

#[derive(Debug, Serialize)]
struct FileEntry {
    file: String,
    sha256: String,
}

impl FileEntry {
    fn of(file: &ClipFile) -> Self {
        let mut sha256 = String::new();
        for byte in Sha256::digest(&file.bytes) {
            // Writing to a string does not fail.
            let _ = write!(sha256, "{byte:02x}");
        }
        Self { file: file.name.clone(), sha256 }
    }
}

/// Clip that is being drawn, frame by frame.
#[derive(Debug)]
pub struct Clip {
    plan: ClipPlan,
    renderer: Renderer,
    before: Option<PrecedingView>,
    entries: Vec<FrameEntry>,
}

impl Clip {
    /// Prepares a clip; draws nothing yet.
    pub fn new(plan: ClipPlan) -> Self {
        Self { plan, renderer: Renderer::default(), before: None, entries: Vec::new() }
    }

    /// Draws the next frame and returns its two files, or `None` after the last frame.
    ///
    /// # Errors
    /// Returns an error if a file cannot be encoded.
    pub fn next_frame(&mut self) -> io::Result<Option<[ClipFile; 2]>> {
        let number = self.entries.len() as u32;
        if number >= self.plan.frames {
            return Ok(None);
        }
        let (scene, camera) = self.plan.shot.view(number.into());
        let (recipe, viewport) = (self.plan.recipe, self.plan.viewport);
        let mut frame = self
            .renderer
            .render(RenderInputs { scene: &scene, camera: &camera, recipe: &recipe, viewport }, KeepDepth::No);
        // The first frame has no motion, as if the preceding frame were equal.
        let view = PrecedingView { scene: Arc::clone(&scene), camera };
        frame.before = Some(self.before.replace(view.clone()).unwrap_or(view));
        let attributes = render_attributes(&recipe, &frame, "");
        let input = ClipFile {
            name: format!("{number:04}.input.exr"),
            bytes: encode_exr(input(&scene, &recipe, &frame), &attributes)?,
        };
        let mut reference = ProgressiveRender::new(&scene, &camera, &recipe, viewport, self.plan.samples);
        while reference.step() {}
        let reference = ClipFile {
            name: format!("{number:04}.reference.exr"),
            bytes: encode_exr(colors(&reference.linear()), &attributes)?,
        };
        self.entries.push(FrameEntry {
            number,
            time_s: self.plan.shot.time_s(number.into()),
            input_size_px: [frame.raster.width, frame.raster.height],
            jitter_px: frame.jitter_px(&recipe),
            camera,
            clip_from_world: clip_from_world(&camera, &recipe, viewport).to_cols_array(),
            input: FileEntry::of(&input),
            reference: FileEntry::of(&reference),
        });
        self.renderer.recycle(frame);
        Ok(Some([input, reference]))
    }

    /// Returns the index of the frames drawn so far. `command` describes how the clip was made.
    ///
    /// # Errors
    /// Returns an error if a number has no representation in JSON.
    pub fn index(&self, command: &str) -> serde_json::Result<ClipFile> {
        let Viewport { width, height } = self.plan.viewport;
        let index = Index {
            rasterscope_clip: VERSION,
            command,
            scene: &self.plan.shot.scene.name,
            size_px: [width, height],
            upscaler: self.plan.recipe.upscaler.label(),
            frames_per_second: self.plan.shot.frames_per_second,
            samples_per_pixel: self.plan.samples,
            frames: &self.entries,
        };
        Ok(ClipFile { name: "clip.json".to_owned(), bytes: serde_json::to_vec_pretty(&index)? })
    }
}

fn clip_from_world(camera: &Camera, recipe: &Recipe, viewport: Viewport) -> DMat4 {
    camera.clip_from_world_f64(viewport.aspect(), recipe.pipeline.depth_format.mapping())
}

/// Returns the channels of an input: colour, distance, motion in pixels of the input, and disocclusion.
fn input(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Picture {
    let linear = &Tables::get().linear_of_code.values;
    let colors = frame.drawn.color.map(|[r, g, b, _]| [r, g, b].map(|code| linear[usize::from(code)]));
    let mut channels = rgb(&colors);
    if let Some(motion) = frame.motion(scene, recipe) {
        let mut add = |name: &str, value: &dyn Fn(u32, u32) -> f32| {
            let (width, height) = colors.size();
            let values = Image::from_fn(width, height, |column, row| {
                let (x, y) = frame.drawn.grid.pixel(column, row);
                value(x, y)
            });
            channels.push(channel(name, values));
        };
        add("Z", &|x, y| if motion.shows_surface(x, y) { motion.distance(x, y) } else { f32::INFINITY });
        add("motion.X", &|x, y| motion.vector_px(x, y)[0]);
        add("motion.Y", &|x, y| motion.vector_px(x, y)[1]);
        add("disocclusion", &|x, y| f32::from(u8::from(motion.is_disoccluded(x, y))));
    }
    Picture::new("OpenEXR", colors.size(), channels)
}

fn colors(colors: &Image<[f32; 3]>) -> Picture {
    Picture::new("OpenEXR", colors.size(), rgb(colors))
}

fn rgb(colors: &Image<[f32; 3]>) -> Vec<Channel> {
    ["R", "G", "B"].into_iter().zip(0..).map(|(name, index)| channel(name, colors.map(|color| color[index]))).collect()
}

fn channel(name: &str, values: Image<f32>) -> Channel {
    let (width, height) = values.size();
    Channel::new(name.to_owned(), Samples::F32(values.into_pixels()), DataWindow { left: 0, top: 0, width, height })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::shot::CameraMotion;
    use crate::scene::{CameraPath, builtin};
    use crate::upscale::Upscaling;

    fn plan(frames: u32) -> ClipPlan {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        ClipPlan {
            shot: Shot::from_start(
                Arc::clone(&scene),
                scene.home,
                CameraMotion::along(CameraPath::preset("turntable")),
                30.0,
            ),
            recipe: Recipe { upscaler: Upscaling::new("taa", 2).unwrap(), ..Recipe::default() },
            viewport: Viewport { width: 48, height: 28 },
            frames,
            samples: 4,
        }
    }

    fn files(plan: ClipPlan) -> Vec<ClipFile> {
        let mut clip = Clip::new(plan);
        let mut files = Vec::new();
        while let Some(frame) = clip.next_frame().unwrap() {
            files.extend(frame);
        }
        files.push(clip.index("test").unwrap());
        files
    }

    #[test]
    fn equal_plans_give_equal_bytes_and_hashes_fit_the_files() {
        let (first, second) = (files(plan(3)), files(plan(3)));
        assert_eq!(first, second);
        let index: serde_json::Value = serde_json::from_slice(&first[6].bytes).unwrap();
        for (frame, number) in first[..6].chunks(2).zip(0..) {
            for (file, kind) in frame.iter().zip(["input", "reference"]) {
                let entry = &index["frames"][number][kind];
                assert_eq!(entry["file"], file.name);
                let digest: String = Sha256::digest(&file.bytes).iter().map(|byte| format!("{byte:02x}")).collect();
                assert_eq!(entry["sha256"], digest);
            }
            assert_eq!(index["frames"][number]["input_size_px"], serde_json::json!([24, 14]));
        }
        let longer = files(plan(4));
        assert_eq!(first[..6], longer[..6], "a frame does not depend on the number of frames");
        assert_ne!(first[2].bytes, first[0].bytes);
    }

    #[test]
    fn the_first_frame_is_still_and_the_next_one_moves() {
        let first_px = |file: &ClipFile| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(&file.name);
            std::fs::write(&path, &file.bytes).unwrap();
            let picture = Picture::read(&path).unwrap();
            let channel = picture.channels().iter().find(|channel| channel.name == "motion.X").unwrap();
            let (width, height) = picture.size();
            let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            pixels.map(|(x, y)| channel.sample(x, y).unwrap().value().abs()).fold(0.0, f64::max)
        };
        let files = files(plan(2));
        assert_eq!(first_px(&files[0]), 0.0);
        // A turntable in 8 s at 30 frames per second turns by 1.5° per frame, or about half a pixel of the input.
        assert!((0.1..3.0).contains(&first_px(&files[2])), "{}", first_px(&files[2]));
    }
}
