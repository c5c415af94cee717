//! The one entry for window, command line, reports and tests: a scene, a view and a [`Recipe`] give a [`Frame`].

pub mod samples;

use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::antialias::post;
use crate::antialias::resolve::Mean;
use crate::antialias::settings::{Antialiasing, MOST_STRENGTH, PostFilter, widened};
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::observe::Observer;
use crate::pipeline::plan::DrawPlan;
use crate::pipeline::settings::{Choice as _, DepthTest, Execution, Settings, Shading};
use crate::pipeline::tiled::{self, TiledReport};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{Extent, Geometry, Until, draw, prepare, wireframe};
use crate::scene::{Camera, Scene};
use crate::upscale::{self, Drawn, History, Offers, Sampling, Scale, Seen, Surfaces, Upscaler, Upscaling};

/// Everything that decides how a scene is drawn: plain data, edited by panels, parsed from the command line, swept by
/// reports. Equal recipe and equal scene give an equal frame, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Recipe {
    /// How it is executed: the picture is the same.
    pub execution: Execution,
    /// The pipeline's decisions.
    #[serde(flatten)]
    pub pipeline: Settings,
    /// How the pixels that are drawn are sampled.
    pub antialias: Antialiasing,
    /// Which pixels are drawn, and how the others are filled in.
    pub upscaler: Upscaling,
    /// What is done with the finished picture.
    pub post: PostFilter,
    /// Whether the edges of all drawn triangles are laid over the picture.
    pub wireframe: bool,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            execution: Execution::Tiled,
            pipeline: Settings::default(),
            antialias: Antialiasing::default(),
            upscaler: Upscaling::NATIVE,
            post: PostFilter::default(),
            wireframe: false,
        }
    }
}

/// What settings of the upscaler begin with.
const UPSCALER_KEYS: &str = "upscaler.";

/// The one that decides what the others may be.
const METHOD_KEY: &str = "upscaler.method";

/// Why a `key=value` does not change a recipe.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SetError {
    /// There is no `=`.
    #[error("`{0}` is not of the form key=value")]
    NotAPair(String),
    /// No such key.
    #[error("`{key}` is no setting; the settings are {known}")]
    UnknownKey {
        /// What was asked for.
        key: String,
        /// What there is.
        known: String,
    },
    /// The key does not take this value.
    #[error("{key}: {reason}")]
    BadValue {
        /// The setting.
        key: String,
        /// What it takes.
        reason: String,
    },
}

impl Recipe {
    /// Changes one setting by its dotted key, as in `light.direction=0.4,0.7,0.6`. Keys and values may be written with
    /// `-` or `_`. On error nothing changes.
    pub fn set(&mut self, assignment: &str) -> Result<(), SetError> {
        let (_, value) = assignment.split_once('=').ok_or_else(|| SetError::NotAPair(assignment.to_owned()))?;
        let key = key_of(assignment);
        let mut tree = json(self);
        let pointer = format!("/{}", key.replace('.', "/"));
        let leaf = tree.pointer_mut(&pointer).filter(|leaf| !leaf.is_object()).ok_or_else(|| {
            let known: Vec<_> = Self::keys().into_iter().map(|(key, _)| key).collect();
            SetError::UnknownKey { key: key.clone(), known: known.join(", ") }
        })?;
        let bad = |reason: String| SetError::BadValue { key: key.clone(), reason };
        let wanted = parse_like(leaf, value.trim()).map_err(bad)?;
        *leaf = wanted.clone();
        let changed: Self = serde_json::from_value(tree).map_err(|e| bad(e.to_string()))?;
        changed.check().map_err(bad)?;
        if json(&changed).pointer(&pointer) != Some(&wanted) {
            let method = changed.upscaler.method();
            return Err(bad(format!("`{method}` offers {}", offered(&key, &[changed.upscaler.upscaler()]))));
        }
        *self = changed;
        Ok(())
    }

    /// Changes several settings, in any order: methods come before what they may offer.
    /// On error nothing changes.
    pub fn set_all(&mut self, assignments: &[impl AsRef<str>]) -> Result<(), SetError> {
        let mut changed = *self;
        let depends = |assignment: &&str| {
            let key = key_of(assignment);
            key.starts_with(UPSCALER_KEYS) && key != METHOD_KEY
        };
        let all = || assignments.iter().map(AsRef::as_ref);
        for assignment in all().filter(|a| !depends(a)).chain(all().filter(depends)) {
            changed.set(assignment)?;
        }
        *self = changed;
        Ok(())
    }

    /// All dotted keys, each with the values that it takes, in words.
    pub fn keys() -> Vec<(String, String)> {
        let mut keys = Vec::new();
        collect_keys(&json(&Self::default()), "", &mut keys);
        keys
    }

    /// Why these numbers cannot be drawn with: ranges that types do not express.
    pub fn check(&self) -> Result<(), String> {
        let light = &self.pipeline.light;
        if !light.direction.is_finite() || light.direction == glam::Vec3::ZERO {
            return Err("the direction must be finite and not zero".to_owned());
        }
        if !(0.0..=1.0).contains(&light.ambient) {
            return Err(format!("the ambient share must lie in 0…1, not {}", light.ambient));
        }
        let checker = &self.pipeline.checker;
        if !checker.squares.is_finite() || !checker.even.is_finite() || !checker.odd.is_finite() {
            return Err("numbers must be finite".to_owned());
        }
        self.post.check()
    }
}

/// The dotted key of an assignment.
fn key_of(assignment: &str) -> String {
    assignment.split('=').next().unwrap_or_default().trim().replace('-', "_")
}

fn json(recipe: &Recipe) -> Value {
    // A recipe holds nothing that JSON cannot: string keys, finite or null numbers, words.
    serde_json::to_value(recipe).unwrap_or(Value::Null)
}

/// `text` as a JSON value of the same kind as `like`.
fn parse_like(like: &Value, text: &str) -> Result<Value, String> {
    let number = |t: &str| {
        t.trim().parse::<f32>().ok().filter(|n| n.is_finite()).ok_or_else(|| format!("`{t}` is not a number"))
    };
    match like {
        Value::Bool(_) => match text {
            "true" | "on" | "yes" => Ok(true.into()),
            "false" | "off" | "no" => Ok(false.into()),
            _ => Err(format!("`{text}` is neither true nor false")),
        },
        Value::Number(n) if n.is_u64() => {
            text.parse::<u32>().map(Value::from).map_err(|_| format!("`{text}` is not a whole number"))
        }
        Value::Number(_) => number(text).map(Value::from),
        Value::Array(items) => {
            let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
            let inner: Result<[f32; 9], _> = numbers.as_slice().try_into();
            match inner {
                _ if numbers.len() == items.len() => Ok(numbers.into()),
                Ok(inner) if items.len() == widened(inner).len() => Ok(widened(inner).to_vec().into()),
                _ => Err(format!("{} numbers with commas between are needed, not `{text}`", items.len())),
            }
        }
        _ => Ok(text.replace('_', "-").into()),
    }
}

fn collect_keys(tree: &Value, prefix: &str, keys: &mut Vec<(String, String)>) {
    let Value::Object(fields) = tree else {
        keys.push((prefix.to_owned(), describe_values(prefix, tree)));
        return;
    };
    for (name, value) in fields {
        let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        collect_keys(value, &key, keys);
    }
}

/// What a key takes: ranges as [`Recipe::check`] has them; words asked of the parser itself by giving it one that cannot exist.
fn describe_values(key: &str, value: &Value) -> String {
    match value {
        _ if key.starts_with(UPSCALER_KEYS) && key != METHOD_KEY => {
            format!("{}, where the method offers a choice", offered(key, upscale::ALL))
        }
        Value::Bool(_) => "true, false".to_owned(),
        Value::Number(_) if key == "light.ambient" => "number, 0…1".to_owned(),
        Value::Number(_) if key == "post.strength" => format!("number, 0…{MOST_STRENGTH}"),
        Value::Number(number) if number.is_u64() => "whole number".to_owned(),
        Value::Number(_) => "number".to_owned(),
        Value::Array(_) if key == "post.mask" => "9 or 25 numbers with commas between, row by row".to_owned(),
        Value::Array(_) if key == "light.direction" => "3 numbers with commas between, not all of them 0".to_owned(),
        Value::Array(items) => format!("{} numbers with commas between", items.len()),
        _ => {
            let complaint = Recipe::default().set(&format!("{key}=?")).err().map(|e| e.to_string()).unwrap_or_default();
            let words: Vec<_> = complaint.split('`').skip(1).step_by(2).filter(|w| *w != "?").collect();
            words.join(", ")
        }
    }
}

/// What some methods offer for a setting of the upscaler. Those without a choice count only if none has one.
fn offered(key: &str, methods: &[&dyn Upscaler]) -> String {
    let words = |offers: Offers| -> Vec<String> {
        match key.trim_start_matches(UPSCALER_KEYS) {
            "scale" => offers.scales.iter().map(Scale::to_string).collect(),
            "anchor" => offers.anchors.iter().map(|anchor| anchor.id().to_owned()).collect(),
            "light" => offers.lights.iter().map(|light| light.id().to_owned()).collect(),
            "deringing" if offers.deringing => vec!["false".to_owned(), "true".to_owned()],
            "sharpening" if offers.sharpening => vec!["0…100 %".to_owned()],
            "sharpening" => vec!["0".to_owned()],
            _ => vec!["false".to_owned()],
        }
    };
    let all: Vec<_> = methods.iter().map(|method| words(method.offers())).collect();
    let choices = all.iter().filter(|words| words.len() > 1 || methods.len() == 1);
    let mut known: Vec<String> = Vec::new();
    for word in choices.flatten() {
        if !known.contains(word) {
            known.push(word.clone());
        }
    }
    known.join(", ")
}

/// Wall-clock time of each part of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameTimes {
    /// Plan to cull.
    pub geometry: Duration,
    /// Rasterize to shade.
    pub pixels: Duration,
    /// Filling in what was not drawn, filtering, and laying lines over it.
    pub upscale: Duration,
    /// Everything.
    pub total: Duration,
}

/// A finished frame and what it was made from.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The full picture where it is not what was drawn itself.
    finished: Option<Image<Rgba8>>,
    /// The full picture before filter and lines.
    unfiltered: Unfiltered,
    /// What was really drawn: colours of all samples, depths of the centres of pixels.
    pub drawn: Framebuffer,
    /// How the pixels that were drawn were sampled.
    pub antialias: Antialiasing,
    /// The view.
    pub camera: Camera,
    /// What every pixel shows, if the upscaler reads it and depths are kept.
    pub surfaces: Option<Surfaces>,
    /// The frame before, if the upscaler reads it and there is one.
    pub past: Option<Arc<History>>,
    /// The triangles that were rasterized.
    pub geometry: LazyGeometry,
    /// One plan per instance.
    pub plans: Vec<DrawPlan>,
    /// Size of the full picture.
    pub viewport: Viewport,
    /// Size of the picture that `geometry` and `drawn` are of: the full one, or a smaller one of the same view.
    pub raster: Viewport,
    /// What of the full picture was drawn.
    pub sampling: Sampling,
    /// The triangles of the full picture, where lines over it need them and `geometry` is of a smaller one.
    outlines: Option<TriangleList>,
    /// How it was drawn.
    pub execution: Execution,
    /// Where the time went.
    pub times: FrameTimes,
    /// What was counted while it was drawn tile by tile.
    pub tiled: Option<TiledReport>,
}

impl Frame {
    /// The full picture.
    pub fn image(&self) -> &Image<Rgba8> {
        self.finished.as_ref().unwrap_or(&self.drawn.color)
    }

    /// The full picture before it was filtered and lines were laid over it; the same where neither was done.
    pub fn unfiltered(&self) -> &Image<Rgba8> {
        match &self.unfiltered {
            Unfiltered::Finished => self.image(),
            Unfiltered::Drawn => &self.drawn.color,
            Unfiltered::Kept(picture) => picture,
        }
    }

    /// Colours drawn, with all else that the upscaler may read.
    pub fn as_drawn<'a>(&'a self, color: &'a Image<Rgba8>) -> Drawn<'a> {
        Drawn { color, seen: seen(self.surfaces.as_ref(), &self.camera, self.past.as_deref()) }
    }

    /// The camera that saw what was really drawn: that of the view, unless fewer pixels were drawn or samples lie elsewhere.
    pub fn drawn_by(&self, recipe: &Recipe) -> Camera {
        let (sampling, place) = sampling_after(self.past.as_deref(), recipe);
        camera_of(&self.camera, sampling, self.viewport, place)
    }

    /// Whether the next frame of the same view may be better, as the upscaler knows more by then.
    pub fn wants_another(&self, recipe: &Recipe) -> bool {
        let before = self.past.as_ref().filter(|past| past.camera == self.camera).map_or(0, |past| past.still);
        self.surfaces.is_some() && before + 1 < recipe.upscaler.upscaler().settles_after(recipe.upscaler)
    }

    /// What the next frame may read of this one, if the upscaler reads the past.
    fn history(&self, recipe: &Recipe) -> Option<History> {
        let (how, upscaler) = (recipe.upscaler, recipe.upscaler.upscaler());
        let surfaces = self.surfaces.clone().filter(|_| upscaler.reads().past)?;
        let size = (self.viewport.width, self.viewport.height);
        let still = self.past.as_ref().filter(|past| past.camera == self.camera).map_or(0, |past| past.still);
        Some(History {
            picture: self.unfiltered().clone(),
            memory: upscaler.memory(how, &self.as_drawn(&self.drawn.color), size),
            surfaces,
            camera: self.camera,
            frames: self.past.as_ref().map_or(0, |past| past.frames.wrapping_add(1)),
            still: still + 1,
        })
    }

    /// Share of the picture's pixels that were drawn, in [0, 1].
    pub fn drawn_share(&self) -> f64 {
        let Viewport { width, height } = self.viewport;
        self.drawn_pixels() as f64 / (f64::from(width) * f64::from(height))
    }

    /// How many samples were drawn.
    pub fn drawn_pixels(&self) -> u64 {
        self.drawn.grid.drawn_pixels(self.raster.width, self.raster.height)
    }

    /// Whether a pixel of the full picture was drawn itself.
    pub fn is_drawn(&self, x: u32, y: u32) -> bool {
        matches!(self.sampling, Sampling::Grid(grid) if grid.sample_at(x, y).is_some())
    }

    /// The packed sample that stands for a pixel of the full picture: its own if it was drawn, the nearest if samples lie
    /// between pixels, else none.
    pub fn sample_at(&self, x: u32, y: u32) -> Option<(u32, u32)> {
        match self.sampling {
            Sampling::Grid(grid) => grid.sample_at(x, y),
            Sampling::Lattice(lattice) => {
                Some((lattice.nearest(x, self.raster.width), lattice.nearest(y, self.raster.height)))
            }
        }
    }

    /// The triangles that were rasterized, on the full picture; none if the frame was drawn smaller and without lines.
    pub fn outlines(&self) -> &[ScreenTriangle] {
        match self.sampling {
            Sampling::Grid(_) => &self.geometry.triangles,
            Sampling::Lattice(_) => self.outlines.as_deref().unwrap_or_default(),
        }
    }

    /// Triangles, and pieces of cut ones, that were rasterized.
    pub fn rasterized(&self) -> usize {
        self.tiled.as_ref().map_or_else(|| self.geometry.triangles.len(), |report| report.counts.rasterized as usize)
    }

    /// The view that was drawn: the frame's own, or one moved to where the samples lie. `recipe` is the frame's.
    pub fn drawn_from(&self, recipe: &Recipe) -> Camera {
        let (_, place) = sampling_after(self.past.as_deref(), recipe);
        camera_of(&self.camera, self.sampling, self.viewport, place)
    }

    /// What depths of the frame mean.
    pub fn depth_scale(&self) -> &DepthScale {
        &self.drawn.depth_scale
    }

    /// Draws the list of triangles once more, after it was changed, with one sample for each pixel.
    pub fn redraw(&mut self, scene: &Scene, recipe: &Recipe) {
        let drawn = redraw(scene, recipe, self, Until::Shade, &mut ());
        *self = self.at_moment(recipe, drawn, Geometry::clone(&self.geometry));
    }

    /// The frame as it was at an earlier moment: `drawn` is what was drawn by then, with one sample for each pixel, and
    /// `geometry` has the triangles that were drawn.
    pub fn at_moment(&self, recipe: &Recipe, drawn: Framebuffer, geometry: Geometry) -> Self {
        let Finished { picture, unfiltered } = {
            let triangles = || self.outlines.as_ref().unwrap_or(&geometry.triangles);
            finish(recipe, &self.as_drawn(&drawn.color), self.viewport, triangles)
        };
        Self {
            finished: picture,
            unfiltered,
            drawn,
            antialias: Antialiasing::default(),
            camera: self.camera,
            surfaces: self.surfaces.clone(),
            past: self.past.clone(),
            geometry: LazyGeometry::made(geometry),
            plans: self.plans.clone(),
            viewport: self.viewport,
            raster: self.raster,
            sampling: self.sampling,
            outlines: self.outlines.clone(),
            execution: Execution::Classic,
            times: self.times,
            tiled: None,
        }
    }
}

/// The geometry of a frame, made when it is first asked for: what was drawn tile by tile needed none in this form.
#[derive(Clone)]
pub struct LazyGeometry {
    made: OnceLock<Geometry>,
    make: Arc<dyn Fn() -> Geometry + Send + Sync>,
}

impl LazyGeometry {
    fn made(geometry: Geometry) -> Self {
        Self { made: geometry.into(), make: Arc::new(Geometry::default) }
    }
}

impl fmt::Debug for LazyGeometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("LazyGeometry").field(&self.made).finish()
    }
}

impl Deref for LazyGeometry {
    type Target = Geometry;

    fn deref(&self) -> &Geometry {
        self.made.get_or_init(|| (self.make)())
    }
}

impl DerefMut for LazyGeometry {
    fn deref_mut(&mut self) -> &mut Geometry {
        let made = self.made.take().unwrap_or_else(|| (self.make)());
        self.made = made.into();
        self.made.get_mut().expect("it was put there a line above")
    }
}

/// Draws one frame of `viewport`'s size the classic way, watched by `observer`; of several samples for each pixel only that
/// of its centre is. Cannot fail: a scene is always renderable.
pub fn run<O: Observer>(
    scene: &Scene,
    camera: &Camera,
    recipe: &Recipe,
    viewport: Viewport,
    observer: &mut O,
) -> Frame {
    run_after(None, scene, camera, recipe, viewport, observer)
}

/// [`run`] after another frame of the same scene and recipe.
fn run_after<O: Observer>(
    past: Option<Arc<History>>,
    scene: &Scene,
    camera: &Camera,
    recipe: &Recipe,
    viewport: Viewport,
    observer: &mut O,
) -> Frame {
    let start = Instant::now();
    let (sampling, place) = sampling_after(past.as_deref(), recipe);
    let raster = raster_of(sampling, viewport);
    let seen_by = camera_of(camera, sampling, viewport, place);
    let geometry = prepare(scene, &seen_by, &recipe.pipeline, raster, observer);
    let geometry_done = Instant::now();

    let grid = sampling.grid();
    let mut drawn = draw_pixels(scene, recipe, &geometry, (grid, raster), Until::Shade, observer);
    let smooth = if recipe.antialias.is_per_pixel() {
        Some(samples::per_pixel(scene, &geometry, recipe, (grid, raster)))
    } else {
        mean_of_passes(recipe, (grid, raster), |place, _| {
            let seen = camera_of(camera, sampling, viewport, place);
            let geometry = prepare(scene, &seen, &recipe.pipeline, raster, &mut ());
            draw_pixels(scene, recipe, &geometry, (grid, raster), Until::Shade, &mut ()).color
        })
    };
    drawn.color = smooth.unwrap_or(drawn.color);
    let surfaces = shown_in_full(recipe).and_then(|shown| {
        let geometry = prepare(scene, camera, &shown.pipeline, viewport, &mut ());
        surfaces(draw_pixels(scene, &shown, &geometry, (SampleGrid::FULL, viewport), Until::Shade, &mut ()))
    });
    let drawn_at = Instant::now();

    let outlines = outlines(scene, camera, recipe, viewport);
    let known = Drawn { color: &drawn.color, seen: seen(surfaces.as_ref(), camera, past.as_deref()) };
    let Finished { picture, unfiltered } =
        finish(recipe, &known, viewport, || outlines.as_ref().unwrap_or(&geometry.triangles));
    let times = FrameTimes {
        geometry: geometry_done - start,
        pixels: drawn_at - geometry_done,
        upscale: drawn_at.elapsed(),
        total: start.elapsed(),
    };
    Frame {
        finished: picture,
        unfiltered,
        drawn,
        antialias: recipe.antialias,
        camera: *camera,
        surfaces,
        past,
        plans: geometry.plans.clone(),
        geometry: LazyGeometry::made(geometry),
        viewport,
        raster,
        sampling,
        outlines,
        execution: Execution::Classic,
        times,
        tiled: None,
    }
}

/// The mean of the passes of a recipe that `pass` draws, in memory that is no longer needed; nothing without
/// passes.
fn mean_of_passes(
    recipe: &Recipe,
    (grid, raster): (SampleGrid, Viewport),
    mut pass: impl FnMut([f64; 2], Option<Image<Rgba8>>) -> Image<Rgba8>,
) -> Option<Image<Rgba8>> {
    let (width, height) = grid.packed_size(raster.width, raster.height);
    let (mut mean, mut spare) = (None, None);
    for place in samples::passes(recipe.antialias) {
        let picture = pass(place, spare.take());
        mean.get_or_insert_with(|| Mean::new(width, height, recipe.antialias.light)).add(&picture);
        spare = Some(picture);
    }
    mean.map(|mean| mean.picture())
}

/// Draws frames as recipes say, on all threads where they allow it, and keeps memory from frame to frame.
#[derive(Debug)]
pub struct Renderer {
    memory: tiled::Memory,
    lanes: Lanes,
    /// A picture that is no longer needed.
    spare: Option<Image<Rgba8>>,
    /// Depths that are no longer needed.
    spare_depth: Option<Image<f32>>,
    /// The last frame, if its upscaler reads the past.
    past: Option<Past>,
}

/// A frame that the next one may read, and what that must have in common with it.
#[derive(Debug)]
struct Past {
    scene: Arc<Scene>,
    recipe: Recipe,
    viewport: Viewport,
    history: Arc<History>,
}

impl Default for Renderer {
    fn default() -> Self {
        Self { memory: tiled::Memory::default(), lanes: Lanes::best(), spare: None, spare_depth: None, past: None }
    }
}

/// Whether a frame keeps its depths for others to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepDepth {
    /// It does.
    Yes,
    /// They are used and forgotten.
    No,
}

impl Renderer {
    /// One that computes on these lanes.
    pub fn on(lanes: Lanes) -> Self {
        Self { lanes, ..Self::default() }
    }

    /// Draws one frame of `viewport`'s size, on the threads of the present rayon pool.
    pub fn render(
        &mut self,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
        keep_depth: KeepDepth,
    ) -> Frame {
        let same = |past: &Past| Arc::ptr_eq(&past.scene, scene) && past.recipe == *recipe && past.viewport == viewport;
        let past = self.past.take().filter(same).map(|past| past.history);
        let mut frame = if execution(scene, recipe).0 == Execution::Classic {
            run_after(past, scene, camera, recipe, viewport, &mut ())
        } else {
            self.render_tiled(past, scene, camera, recipe, viewport, keep_depth)
        };
        let finished = Instant::now();
        self.past = frame.history(recipe).map(|history| Past {
            scene: Arc::clone(scene),
            recipe: *recipe,
            viewport,
            history: Arc::new(history),
        });
        let remembering = finished.elapsed();
        frame.times.upscale += remembering;
        frame.times.total += remembering;
        frame
    }

    /// Draws a view until further frames of it would be the same: one frame, unless the upscaler reads the past.
    pub fn render_settled(
        &mut self,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
    ) -> Frame {
        let mut frame = self.render(scene, camera, recipe, viewport, KeepDepth::Yes);
        while frame.wants_another(recipe) {
            frame = self.render(scene, camera, recipe, viewport, KeepDepth::Yes);
        }
        frame
    }

    fn render_tiled(
        &mut self,
        past: Option<Arc<History>>,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
        keep_depth: KeepDepth,
    ) -> Frame {
        let start = Instant::now();
        let settings = &recipe.pipeline;
        let (sampling, place) = sampling_after(past.as_deref(), recipe);
        let raster = raster_of(sampling, viewport);
        let seen_by = camera_of(camera, sampling, viewport, place);
        let grid = sampling.grid();
        let geometry = {
            let (scene, settings) = (Arc::clone(scene), *settings);
            let make = Arc::new(move || prepare(&scene, &seen_by, &settings, raster, &mut ()));
            LazyGeometry { made: OnceLock::new(), make }
        };
        // The centres of pixels are drawn for their colours, or for their depths, or not at all.
        let mut centres = (recipe.antialias.is_off() || keep_depth == KeepDepth::Yes).then(|| {
            let memory = (self.spare.take(), self.spare_depth.take().filter(|_| keep_depth == KeepDepth::Yes));
            self.draw_tiled(scene, &seen_by, settings, (grid, raster), memory, keep_depth)
        });
        let smooth = mean_of_passes(recipe, (grid, raster), |place, spare| {
            let seen = camera_of(camera, sampling, viewport, place);
            let memory = (spare.or_else(|| self.spare.take()), None);
            let (mut drawn, report) = self.draw_tiled(scene, &seen, settings, (grid, raster), memory, KeepDepth::No);
            let color = std::mem::replace(&mut drawn.color, Image::filled(0, 0, [0; 4]));
            centres.get_or_insert((drawn, report));
            color
        });
        let (mut drawn, report) = centres
            .unwrap_or_else(|| self.draw_tiled(scene, &seen_by, settings, (grid, raster), (None, None), keep_depth));
        if let Some(smooth) = smooth {
            self.spare = Some(std::mem::replace(&mut drawn.color, smooth));
        }
        let surfaces = shown_in_full(recipe).and_then(|shown| {
            let area = (SampleGrid::FULL, viewport);
            let (shown, _) = self.draw_tiled(scene, camera, &shown.pipeline, area, (None, None), KeepDepth::Yes);
            surfaces(shown)
        });
        let drawn_at = Instant::now();
        let outlines = outlines(scene, camera, recipe, viewport);
        let known = Drawn { color: &drawn.color, seen: seen(surfaces.as_ref(), camera, past.as_deref()) };
        let Finished { picture, unfiltered } =
            finish(recipe, &known, viewport, || outlines.as_ref().unwrap_or_else(|| &geometry.triangles));
        let front = report.times.transform + report.times.cull;
        let times = FrameTimes {
            geometry: front,
            pixels: (drawn_at - start).saturating_sub(front),
            upscale: drawn_at.elapsed(),
            total: start.elapsed(),
        };
        Frame {
            finished: picture,
            unfiltered,
            drawn,
            antialias: recipe.antialias,
            camera: *camera,
            surfaces,
            past,
            geometry,
            plans: report.plans.clone(),
            viewport,
            raster,
            sampling,
            outlines,
            execution: Execution::Tiled,
            times,
            tiled: Some(report),
        }
    }

    /// Draws one sample for each pixel tile by tile, into memory that is no longer needed.
    fn draw_tiled(
        &mut self,
        scene: &Scene,
        seen: &Camera,
        settings: &Settings,
        (grid, raster): (SampleGrid, Viewport),
        memory: (Option<Image<Rgba8>>, Option<Image<f32>>),
        keep_depth: KeepDepth,
    ) -> (Framebuffer, TiledReport) {
        let keep = keep_depth == KeepDepth::Yes;
        let mut drawn = Framebuffer::reusing(grid, raster, memory, settings, keep);
        drawn.depth_scale = DepthScale::new(settings.depth_format, seen);
        let report = tiled::draw(scene, seen, settings, raster, &mut drawn, &mut self.memory, self.lanes);
        (drawn, report)
    }

    /// Takes the memory of a frame that nobody looks at any more.
    pub fn recycle(&mut self, frame: Frame) {
        self.spare = Some(frame.drawn.color);
        self.spare_depth = frame.drawn.depth.or(self.spare_depth.take());
    }

    /// Bytes held from frame to frame.
    pub fn bytes(&self) -> usize {
        self.memory.bytes()
            + self.spare.as_ref().map_or(0, Image::bytes)
            + self.spare_depth.as_ref().map_or(0, Image::bytes)
    }
}

/// How a recipe is executed on a scene, and why not otherwise where it asks for otherwise.
pub fn execution(scene: &Scene, recipe: &Recipe) -> (Execution, Option<&'static str>) {
    match recipe.execution {
        Execution::Classic => (Execution::Classic, None),
        Execution::Tiled if recipe.antialias.is_per_pixel() => {
            (Execution::Classic, Some("this anti-aliasing draws its samples one triangle after the other"))
        }
        Execution::Tiled => match tiled::obstacle(scene, &recipe.pipeline) {
            None => (Execution::Tiled, None),
            why => (Execution::Classic, why),
        },
    }
}

/// What is drawn after another frame, and where in their pixels the samples lie.
fn sampling_after(past: Option<&History>, recipe: &Recipe) -> (Sampling, [f64; 2]) {
    let frames = past.map_or(0, |past| past.frames.wrapping_add(1));
    recipe.upscaler.upscaler().sampling_of(recipe.upscaler, frames)
}

/// The recipe that finds which object every pixel shows, if the upscaler reads that and depths are kept.
fn shown_in_full(recipe: &Recipe) -> Option<Recipe> {
    let reads = recipe.upscaler.upscaler().reads().surfaces && recipe.pipeline.depth_test != DepthTest::Off;
    let pipeline = Settings { shading: Shading::ObjectId, ..recipe.pipeline };
    reads.then_some(Recipe { pipeline, ..Recipe::default() })
}

/// What a picture of objects with its depths shows.
fn surfaces(shown: Framebuffer) -> Option<Surfaces> {
    let scale = shown.depth_scale;
    let distance = shown.depth?.map(|stored| scale.distance_of(stored) as f32);
    Some(Surfaces { object: shown.color, distance })
}

/// What the upscaler may read besides colours.
fn seen<'a>(surfaces: Option<&'a Surfaces>, camera: &'a Camera, past: Option<&'a History>) -> Option<Seen<'a>> {
    surfaces.map(|surfaces| Seen { surfaces, camera, past })
}

/// Size of the picture that is really drawn.
fn raster_of(sampling: Sampling, Viewport { width, height }: Viewport) -> Viewport {
    let (width, height) = sampling.raster_size(width, height);
    Viewport { width, height }
}

/// The camera that sees the picture that is really drawn, with samples at `place` in its pixels.
fn camera_of(camera: &Camera, sampling: Sampling, viewport: Viewport, place: [f64; 2]) -> Camera {
    samples::moved_window(camera, sampling, viewport, place).unwrap_or(*camera)
}

/// The triangles of the full picture, where lines over it need them and what is drawn is a smaller one.
fn outlines(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Option<TriangleList> {
    let drawn_smaller = matches!(recipe.upscaler.sampling(), Sampling::Lattice(_));
    (recipe.wireframe && drawn_smaller).then(|| prepare(scene, camera, &recipe.pipeline, viewport, &mut ()).triangles)
}

/// The full picture before filter and lines: never held twice.
#[derive(Clone, Debug)]
enum Unfiltered {
    /// The finished one, as nothing came over it.
    Finished,
    /// What was drawn.
    Drawn,
    /// Neither of both.
    Kept(Image<Rgba8>),
}

/// A full picture, none if that is what was drawn, and the same before filter and lines.
struct Finished {
    picture: Option<Image<Rgba8>>,
    unfiltered: Unfiltered,
}

/// The full picture from what was drawn.
fn finish<'a>(
    recipe: &Recipe,
    drawn: &Drawn<'_>,
    viewport: Viewport,
    triangles: impl Fn() -> &'a TriangleList,
) -> Finished {
    let Viewport { width, height } = viewport;
    let upscaled = (!recipe.upscaler.is_native()).then(|| recipe.upscaler.upscale(drawn, width, height));
    let filtered = post::apply(&recipe.post, upscaled.as_ref().unwrap_or(drawn.color));
    if filtered.is_none() && !recipe.wireframe {
        return Finished { picture: upscaled, unfiltered: Unfiltered::Finished };
    }
    let mut picture = filtered.unwrap_or_else(|| upscaled.as_ref().unwrap_or(drawn.color).clone());
    if recipe.wireframe {
        wireframe::overlay(triangles(), &mut picture);
    }
    Finished { picture: Some(picture), unfiltered: upscaled.map_or(Unfiltered::Drawn, Unfiltered::Kept) }
}

/// Draws the triangles of a frame once more into a framebuffer of their own, as far as `until` says. `recipe` may differ
/// from the frame's own in what concerns samples only: depth test and shading, not geometry. What the frame cuts out
/// stays cut out, and what it blends comes last and leaves no depth.
pub fn redraw<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    until: Until,
    observer: &mut O,
) -> Framebuffer {
    let area = (frame.sampling.grid(), frame.raster);
    draw_pixels(scene, recipe, &frame.geometry, area, until, observer)
}

/// The geometry stages of a frame once more, watched: all triangles, even if the frame's own list was cut short. `recipe`
/// may differ from the frame's own in anything but the upscaler.
pub fn prepare_again<O: Observer>(scene: &Scene, recipe: &Recipe, frame: &Frame, observer: &mut O) -> Geometry {
    let (_, place) = sampling_after(frame.past.as_deref(), recipe);
    let seen_by = camera_of(&frame.camera, frame.sampling, frame.viewport, place);
    prepare(scene, &seen_by, &recipe.pipeline, frame.raster, observer)
}

fn draw_pixels<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    geometry: &Geometry,
    (grid, viewport): (SampleGrid, Viewport),
    until: Until,
    observer: &mut O,
) -> Framebuffer {
    let (Viewport { width, height }, settings) = (viewport, &recipe.pipeline);
    let mut drawn = Framebuffer::new(grid, width, height, scene.background, settings);
    draw(scene, geometry, settings, &Extent::all(geometry, viewport), until, &mut drawn, observer);
    drawn.depth_scale = geometry.depth_scale;
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::{Culling, Shading};

    #[test]
    fn settings_are_reached_by_dotted_keys_in_either_case() {
        let mut recipe = Recipe::default();
        for assignment in [
            "shading=gouraud",
            "culling=none",
            "color-space=bytes",
            "light.direction=1,2,3",
            "light.ambient=0.5",
            "fill_rule=top_left",
        ] {
            recipe.set(assignment).unwrap();
        }
        assert_eq!(recipe.pipeline.shading, Shading::Gouraud);
        assert_eq!(recipe.pipeline.culling, Culling::None);
        assert_eq!(recipe.pipeline.light.direction, glam::Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(recipe.pipeline.light.ambient, 0.5);
    }

    #[test]
    fn wrong_settings_are_named_and_change_nothing() {
        let mut recipe = Recipe::default();
        for (assignment, word) in [
            ("shading", "key=value"),
            ("shadign=gouraud", "fill_rule"),
            ("shading=phong", "lambert"),
            ("light=1", "light.direction"),
            ("light.direction=1,2", "3 numbers"),
            ("light.direction=0,0,0", "zero"),
            ("light.ambient=2", "0…1"),
            ("wireframe=maybe", "true"),
            ("upscaler.method=dlss", "native"),
            ("upscaler.scale=3", "offers"),
        ] {
            let message = recipe.set(assignment).unwrap_err().to_string();
            assert!(message.contains(word), "{assignment}: {message}");
        }
        assert_eq!(recipe, Recipe::default());
    }

    #[test]
    fn an_enlargement_may_stand_before_its_method() {
        let mut recipe = Recipe::default();
        recipe.set_all(&["upscaler.scale=4", "upscaler.method=bicubic"]).unwrap();
        assert_eq!((recipe.upscaler.method(), recipe.upscaler.scale()), ("bicubic", Scale::FOUR));
        let before = recipe;
        assert!(recipe.set_all(&["wireframe=true", "Upscaler.scale=2"]).is_err(), "keys are in lower case");
        assert!(recipe.set_all(&["wireframe=true", "upscaler.scale=5"]).is_err());
        assert_eq!(recipe, before);
    }

    fn frames(method: &str, scale: u32, cameras: &[Camera], scene: &Arc<Scene>, execution: Execution) -> Vec<Frame> {
        let upscaler = Upscaling::new(method, scale).unwrap();
        let recipe = Recipe { upscaler, execution, ..Recipe::default() };
        let mut renderer = Renderer::default();
        cameras.iter().map(|camera| renderer.render(scene, camera, &recipe, SIZE, KeepDepth::Yes)).collect()
    }

    const SIZE: Viewport = Viewport { width: 131, height: 77 };

    fn scene(id: &str) -> Arc<Scene> {
        Arc::new(crate::scene::builtin::by_id(id).unwrap().build())
    }

    fn native(scene: &Scene, camera: &Camera) -> Frame {
        run(scene, camera, &Recipe::default(), SIZE, &mut ())
    }

    fn squared_error(a: &Image<Rgba8>, b: &Image<Rgba8>) -> f64 {
        let codes = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
        codes.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum()
    }

    #[test]
    fn a_temporal_checkerboard_is_native_in_the_second_still_frame() {
        for id in ["chess", "cubes", "near-plane", "interpenetrating"] {
            let scene = scene(id);
            for execution in Execution::ALL {
                let still = [scene.home; 4];
                let drawn = frames("checkerboard-temporal", 1, &still, &scene, *execution);
                let native = native(&scene, &scene.home);
                assert_ne!(drawn[0].image(), native.image(), "{id}");
                for frame in &drawn[1..] {
                    assert_eq!(frame.image(), native.image(), "{id} {execution:?}");
                    assert!(frame.drawn_share() < 0.51);
                }
                let recipe =
                    Recipe { upscaler: Upscaling::new("checkerboard-temporal", 1).unwrap(), ..Recipe::default() };
                assert_eq!(
                    drawn.iter().map(|f| f.wants_another(&recipe)).collect::<Vec<_>>(),
                    [true, false, false, false]
                );
            }
        }
    }

    #[test]
    fn in_motion_the_frame_before_helps_more_than_neighbours() {
        let scene = scene("chess");
        let mut cameras = [scene.home; 6];
        for (step, camera) in cameras.iter_mut().enumerate() {
            camera.orbit(0.004 * step as f32, 0.0);
        }
        let last = |method| {
            let frame = frames(method, 1, &cameras, &scene, Execution::Tiled).pop().unwrap();
            squared_error(frame.image(), native(&scene, &cameras[5]).image())
        };
        let [plain, surfaces, temporal] = ["checkerboard", "checkerboard-surfaces", "checkerboard-temporal"].map(last);
        assert!(surfaces < plain, "{surfaces} {plain}");
        assert!(temporal < surfaces, "{temporal} {surfaces}");
    }

    #[test]
    fn every_pixel_of_a_frame_with_a_past_is_replayed() {
        let scene = scene("cubes");
        let mut cameras = [scene.home; 3];
        cameras[2].orbit(0.03, 0.01);
        for (method, scale) in [("checkerboard-temporal", 1), ("accumulation", 1), ("accumulation", 2)] {
            let recipe = Recipe { upscaler: Upscaling::new(method, scale).unwrap(), ..Recipe::default() };
            let size = Viewport { width: 37, height: 29 };
            let mut renderer = Renderer::default();
            for camera in &cameras {
                let frame = renderer.render(&scene, camera, &recipe, size, KeepDepth::Yes);
                let how = recipe.upscaler;
                for (x, y) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y))) {
                    let taps = how.upscaler().taps(
                        how,
                        &frame.as_drawn(&frame.drawn.color),
                        (size.width, size.height),
                        (x, y),
                    );
                    let pixels: Vec<_> = taps.iter().map(|tap| (tap.x, tap.y)).collect();
                    let mut known =
                        Image::filled(frame.drawn.color.width(), frame.drawn.color.height(), [255, 0, 173, 1]);
                    for (samples, at) in samples::replay(&scene, &recipe, &frame, &pixels).iter().zip(&pixels) {
                        let (column, row) = frame.drawn.grid.sample_at(at.0, at.1).unwrap();
                        known.set(column, row, samples[0]);
                    }
                    let alone = how.upscaler().pixel(how, &frame.as_drawn(&known), (size.width, size.height), (x, y));
                    assert_eq!(alone, frame.image().at(x, y), "{method} ({x}, {y}) {taps:?}");
                    assert!((taps.iter().map(|tap| tap.weight).sum::<f32>() - 1.0).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn accumulation_comes_to_the_mean_of_its_samples() {
        let scene = scene("chess");
        let drawn = frames("accumulation", 1, &[scene.home; 16], &scene, Execution::Tiled);
        let antialias = Antialiasing {
            method: crate::antialias::settings::Method::LowDiscrepancy,
            samples: crate::antialias::settings::Samples::Sixteen,
            ..Antialiasing::default()
        };
        let smooth = run(&scene, &scene.home, &Recipe { antialias, ..Recipe::default() }, SIZE, &mut ());
        let codes = drawn[15].image().pixels().as_flattened().iter().zip(smooth.image().pixels().as_flattened());
        assert!(codes.into_iter().all(|(a, b)| a.abs_diff(*b) <= 1));
        let errors: Vec<_> = drawn.iter().map(|frame| squared_error(frame.image(), smooth.image())).collect();
        assert!(errors[7] < errors[0] / 4.0 && errors[15] < errors[7] / 4.0, "{errors:?}");
    }

    #[test]
    fn enlarged_accumulation_regains_what_one_frame_has_not() {
        let scene = scene("chess");
        let drawn = frames("accumulation", 2, &[scene.home; 16], &scene, Execution::Tiled);
        let native = native(&scene, &scene.home);
        let errors: Vec<_> = drawn.iter().map(|frame| squared_error(frame.image(), native.image())).collect();
        assert!(errors[15] < errors[0] / 2.0, "{errors:?}");
    }

    #[test]
    fn another_scene_recipe_or_size_has_no_past() {
        let scene = scene("cubes");
        let recipe = Recipe { upscaler: Upscaling::new("checkerboard-temporal", 1).unwrap(), ..Recipe::default() };
        let mut renderer = Renderer::default();
        let mut draw = |scene: &Arc<Scene>, recipe: &Recipe, size| {
            renderer.render(scene, &scene.home, recipe, size, KeepDepth::Yes).past.is_some()
        };
        let lines = Recipe { wireframe: true, ..recipe };
        let smaller = Viewport { width: 40, height: 30 };
        let twin = Arc::new((*scene).clone());
        assert!(!draw(&scene, &recipe, SIZE) && draw(&scene, &recipe, SIZE));
        assert!(!draw(&twin, &recipe, SIZE) && !draw(&twin, &lines, SIZE) && !draw(&twin, &lines, smaller));
    }

    #[test]
    fn every_key_tells_its_values_and_recipes_survive_json() {
        for (key, values) in Recipe::keys() {
            assert!(!values.is_empty(), "{key}");
        }
        let text = serde_json::to_string(&Recipe::default()).unwrap();
        assert_eq!(serde_json::from_str::<Recipe>(&text).unwrap(), Recipe::default());
    }
}
