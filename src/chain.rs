//! The one entry for window, command line, reports and tests: a scene, a view and a [`Recipe`] give a [`Frame`].

use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::observe::Observer;
use crate::pipeline::plan::DrawPlan;
use crate::pipeline::settings::{Choice as _, Execution, Settings};
use crate::pipeline::tiled::{self, TiledReport};
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{Extent, Geometry, Until, draw, prepare, wireframe};
use crate::scene::{Camera, Scene};
use crate::upscale::{self, Drawn, Offers, Sampling, Scale, Upscaler, Upscaling};

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
    /// Which pixels are drawn, and how the others are filled in.
    pub upscaler: Upscaling,
    /// Whether the edges of all drawn triangles are laid over the picture.
    pub wireframe: bool,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            execution: Execution::Tiled,
            pipeline: Settings::default(),
            upscaler: Upscaling::NATIVE,
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
        Ok(())
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
            if numbers.len() == items.len() {
                Ok(numbers.into())
            } else {
                Err(format!("{} numbers with commas between are needed, not `{text}`", items.len()))
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
        Value::Number(_) => "number".to_owned(),
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
    /// Filling in what was not drawn.
    pub upscale: Duration,
    /// Everything.
    pub total: Duration,
}

/// A finished frame and what it was made from.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The full picture where it is not what was drawn itself.
    finished: Option<Image<Rgba8>>,
    /// What was really drawn.
    pub drawn: Framebuffer,
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
    outlines: Option<Vec<ScreenTriangle>>,
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

    /// What depths of the frame mean.
    pub fn depth_scale(&self) -> &DepthScale {
        &self.drawn.depth_scale
    }

    /// Draws the list of triangles once more, after it was changed.
    pub fn redraw(&mut self, scene: &Scene, recipe: &Recipe) {
        self.drawn = redraw(scene, recipe, self, Until::Shade, &mut ());
        let triangles = || self.outlines.as_ref().unwrap_or_else(|| &self.geometry.triangles);
        self.finished = finish(recipe, &self.drawn, self.viewport, triangles);
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

/// Draws one frame of `viewport`'s size the classic way, watched by `observer`. Cannot fail: a scene is always renderable.
pub fn run<O: Observer>(
    scene: &Scene,
    camera: &Camera,
    recipe: &Recipe,
    viewport: Viewport,
    observer: &mut O,
) -> Frame {
    let start = Instant::now();
    let sampling = recipe.upscaler.sampling();
    let raster = raster_of(sampling, viewport);
    let geometry = prepare(scene, &camera_of(camera, sampling, viewport), &recipe.pipeline, raster, observer);
    let geometry_done = Instant::now();

    let drawn = draw_pixels(scene, recipe, &geometry, raster, Until::Shade, observer);
    let drawn_at = Instant::now();

    let outlines = outlines(scene, camera, recipe, viewport);
    let finished = finish(recipe, &drawn, viewport, || outlines.as_ref().unwrap_or(&geometry.triangles));
    let times = FrameTimes {
        geometry: geometry_done - start,
        pixels: drawn_at - geometry_done,
        upscale: drawn_at.elapsed(),
        total: start.elapsed(),
    };
    Frame {
        finished,
        drawn,
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

/// Draws frames as recipes say, on all threads where they allow it, and keeps memory from frame to frame.
#[derive(Debug)]
pub struct Renderer {
    memory: tiled::Memory,
    lanes: Lanes,
    /// A picture that is no longer needed.
    spare: Option<Image<Rgba8>>,
    /// Depths that are no longer needed.
    spare_depth: Option<Image<f32>>,
}

impl Default for Renderer {
    fn default() -> Self {
        Self { memory: tiled::Memory::default(), lanes: Lanes::best(), spare: None, spare_depth: None }
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
        if execution(scene, recipe).0 == Execution::Classic {
            return run(scene, camera, recipe, viewport, &mut ());
        }
        let start = Instant::now();
        let settings = &recipe.pipeline;
        let sampling = recipe.upscaler.sampling();
        let raster = raster_of(sampling, viewport);
        let seen = camera_of(camera, sampling, viewport);
        let geometry = {
            let (scene, settings) = (Arc::clone(scene), *settings);
            let make = Arc::new(move || prepare(&scene, &seen, &settings, raster, &mut ()));
            LazyGeometry { made: OnceLock::new(), make }
        };
        let spare_depth = self.spare_depth.take().filter(|_| keep_depth == KeepDepth::Yes);
        let mut drawn = Framebuffer::reusing(
            recipe.upscaler.grid(),
            raster,
            (self.spare.take(), spare_depth),
            settings,
            keep_depth == KeepDepth::Yes,
        );
        drawn.depth_scale = DepthScale::new(settings.depth_format, &seen);
        let report = tiled::draw(scene, &seen, settings, raster, &mut drawn, &mut self.memory, self.lanes);
        let drawn_at = Instant::now();
        let outlines = outlines(scene, camera, recipe, viewport);
        let finished = finish(recipe, &drawn, viewport, || outlines.as_ref().unwrap_or_else(|| &geometry.triangles));
        let front = report.times.transform + report.times.cull;
        let times = FrameTimes {
            geometry: front,
            pixels: (drawn_at - start).saturating_sub(front),
            upscale: drawn_at.elapsed(),
            total: start.elapsed(),
        };
        Frame {
            finished,
            drawn,
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
        Execution::Tiled => match tiled::obstacle(scene, &recipe.pipeline) {
            None => (Execution::Tiled, None),
            why => (Execution::Classic, why),
        },
    }
}

/// Size of the picture that is really drawn.
fn raster_of(sampling: Sampling, Viewport { width, height }: Viewport) -> Viewport {
    let (width, height) = sampling.raster_size(width, height);
    Viewport { width, height }
}

/// The camera that sees the picture that is really drawn.
fn camera_of(camera: &Camera, sampling: Sampling, viewport: Viewport) -> Camera {
    match sampling {
        Sampling::Grid(_) => *camera,
        Sampling::Lattice(lattice) => {
            let raster = raster_of(sampling, viewport);
            let window = raster.window(viewport, lattice.scale.value(), [lattice.origin_px(); 2]);
            Camera { window: Some(window), ..*camera }
        }
    }
}

/// The triangles of the full picture, where lines over it need them and what is drawn is a smaller one.
fn outlines(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Option<Vec<ScreenTriangle>> {
    let drawn_smaller = matches!(recipe.upscaler.sampling(), Sampling::Lattice(_));
    (recipe.wireframe && drawn_smaller).then(|| prepare(scene, camera, &recipe.pipeline, viewport, &mut ()).triangles)
}

/// The full picture, unless what was drawn is that already.
fn finish<'a>(
    recipe: &Recipe,
    drawn: &Framebuffer,
    viewport: Viewport,
    triangles: impl Fn() -> &'a Vec<ScreenTriangle>,
) -> Option<Image<Rgba8>> {
    let Viewport { width, height } = viewport;
    let upscaled =
        (!recipe.upscaler.is_native()).then(|| recipe.upscaler.upscale(&Drawn::from(&drawn.color), width, height));
    if !recipe.wireframe {
        return upscaled;
    }
    let mut image = upscaled.unwrap_or_else(|| drawn.color.clone());
    wireframe::overlay(triangles(), &mut image);
    Some(image)
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
    draw_pixels(scene, recipe, &frame.geometry, frame.raster, until, observer)
}

fn draw_pixels<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    geometry: &Geometry,
    viewport: Viewport,
    until: Until,
    observer: &mut O,
) -> Framebuffer {
    let (Viewport { width, height }, settings) = (viewport, &recipe.pipeline);
    let mut drawn = Framebuffer::new(recipe.upscaler.grid(), width, height, scene.background, settings);
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

    #[test]
    fn every_key_tells_its_values_and_recipes_survive_json() {
        for (key, values) in Recipe::keys() {
            assert!(!values.is_empty(), "{key}");
        }
        let text = serde_json::to_string(&Recipe::default()).unwrap();
        assert_eq!(serde_json::from_str::<Recipe>(&text).unwrap(), Recipe::default());
    }
}
