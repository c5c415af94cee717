//! Setup of one drawing: our inputs with the changes of some faults.

use std::sync::Arc;

use rasterscope_engine::antialias::settings::{Antialiasing, PostFilter, PostFilterKind};
use rasterscope_engine::chain::{KeepDepth, Recipe, RenderInputs, Renderer};
use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::pipeline::background::Background;
use rasterscope_engine::pipeline::settings::Shading;
use rasterscope_engine::pipeline::viewport::Viewport;
use rasterscope_engine::scene::{Camera, Scene, SubView};
use rasterscope_engine::upscale::Upscaling;

use crate::agreement::Rounding;
use crate::buffers::{BufferTarget, NO_ID, OurBuffers};
use crate::window::Window;

/// Everything that determines a drawing: scene, camera, recipe, size, and changes of the finished picture.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Scene to draw.
    pub scene: Arc<Scene>,
    /// View of the scene.
    pub camera: Camera,
    /// Settings of the pipeline.
    pub recipe: Recipe,
    /// Size of the picture, in pixels.
    pub viewport: Viewport,
    /// Changes of the finished picture, in the order in which they are applied.
    pub(crate) output: Vec<OutputChange>,
    /// Rounding of colours to codes.
    pub(crate) rounding: Rounding,
    /// Colour that the finished picture shows where nothing is drawn, as sRGB codes; `None` if it follows from the
    /// recipe.
    pub(crate) background: Option<[u8; 3]>,
}

/// Change of the finished picture.
#[derive(Clone, Copy, Debug)]
pub(crate) enum OutputChange {
    /// Rows in reverse order.
    FlipRows,
    /// Columns in reverse order.
    FlipColumns,
    /// Function of the colour of a pixel.
    Pixel(PixelChange),
}

/// Function of the colour of a pixel, with its inverse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelChange {
    /// Returns the changed colour.
    pub(crate) apply: fn(Rgba8) -> Rgba8,
    /// Returns the colour that is changed to this one, or nearly so.
    pub(crate) undo: fn(Rgba8) -> Rgba8,
}

/// Returns a scene to be edited. It loses its motion, because poses would not have the edits.
pub(crate) fn edit(scene: &mut Arc<Scene>) -> &mut Scene {
    let scene = Arc::make_mut(scene);
    scene.animation = None;
    scene
}

impl Setup {
    /// Returns the setup of a correct drawing of `viewport` size.
    pub fn new(scene: Arc<Scene>, camera: Camera, recipe: Recipe, viewport: Viewport) -> Self {
        Self { scene, camera, recipe, viewport, output: Vec::new(), rounding: Rounding::Nearest, background: None }
    }

    /// Returns the camera's sub-view for changes. If it has none yet, it is the whole picture.
    pub(crate) fn sub_view_mut(&mut self) -> &mut SubView {
        let whole = SubView { aspect: self.viewport.aspect(), scale: [1.0; 2], shift: [0.0; 2] };
        self.camera.sub_view.get_or_insert(whole)
    }

    /// Draws the picture, including the changes of the finished picture.
    pub fn draw(&self, renderer: &mut Renderer) -> Image<Rgba8> {
        self.draw_window(renderer, Window::whole(self.viewport))
    }

    /// Draws a window of the picture, including the changes of the finished picture.
    pub(crate) fn draw_window(&self, renderer: &mut Renderer, window: Window) -> Image<Rgba8> {
        // Filters and upscalers read pixels beside the window.
        let reads_around = self.recipe.post.filter != PostFilterKind::None || self.recipe.upscaler != Upscaling::NATIVE;
        let shown = if reads_around { window.extended(self.viewport) } else { window };
        let (camera, viewport) = self.view_of(self.source(shown));
        let frame = renderer.render(
            RenderInputs { scene: &self.scene, camera: &camera, recipe: &self.recipe_with_background(), viewport },
            KeepDepth::No,
        );
        let mut picture = frame.image().clone();
        renderer.recycle(frame);
        for change in &self.output {
            picture = change.apply(picture);
        }
        if shown == window { picture } else { window.within(shown).of(&picture) }
    }

    /// Draws the distances and ids that are needed for comparisons with a target, in a window of the picture. Each pixel
    /// has one sample, and no filter changes it.
    pub(crate) fn draw_buffers(&self, renderer: &mut Renderer, window: Window, target: &BufferTarget) -> OurBuffers {
        let (antialias, upscaler, post) = (Antialiasing::default(), Upscaling::NATIVE, PostFilter::default());
        let mut plain = Recipe { antialias, upscaler, post, ..self.recipe };
        let (camera, viewport) = self.view_of(self.source(window));
        let mut drawn = |recipe: &Recipe| {
            renderer.render(RenderInputs { scene: &self.scene, camera: &camera, recipe, viewport }, KeepDepth::Yes)
        };
        let mut ours = OurBuffers::default();
        if target.has_depths() {
            let frame = drawn(&plain);
            let distance = |depth: f32| match depth == frame.drawn.clear_depth {
                true => f32::INFINITY,
                false => frame.depth_scale().distance_of(depth) as f32,
            };
            let depth = frame.drawn.depth.as_ref();
            let nothing = || Image::filled(viewport.width, viewport.height, f32::INFINITY);
            let distances = depth.map_or_else(nothing, |depth| depth.map(distance));
            ours.distances = self.placed(distances).pixels().to_vec();
        }
        if target.has_ids() {
            let [r, g, b, _] = NO_ID;
            plain.pipeline.background = Background::Color([r, g, b]);
            let mut ids = |shading| {
                plain.pipeline.shading = shading;
                self.placed(drawn(&plain).image().clone()).pixels().to_vec()
            };
            (ours.objects, ours.triangles) = (ids(Shading::ObjectId), ids(Shading::TriangleId));
        }
        ours
    }

    /// Returns the window of the drawing whose pixels the finished picture shows in the given window.
    fn source(&self, window: Window) -> Window {
        self.output.iter().rev().fold(window, |window, change| change.source(window, self.viewport))
    }

    /// Returns the camera and the size of a drawing that shows only a window, before changes of the finished picture.
    fn view_of(&self, window: Window) -> (Camera, Viewport) {
        let Viewport { width, height } = self.viewport;
        let mut part = self.clone();
        if window != Window::whole(self.viewport) {
            let view = part.sub_view_mut();
            let [x, y, columns, rows] = [window.x, window.y, window.width, window.height].map(f64::from);
            let [width, height] = [width, height].map(f64::from);
            let scale = [width / columns, height / rows];
            let shift = [(width - 2.0 * x) / columns - 1.0, 1.0 - (height - 2.0 * y) / rows];
            for axis in [0, 1] {
                view.shift[axis] = (f64::from(view.shift[axis]) * scale[axis] + shift[axis]) as f32;
                view.scale[axis] = (f64::from(view.scale[axis]) * scale[axis]) as f32;
            }
        }
        (part.camera, Viewport { width: window.width, height: window.height })
    }

    /// Returns the recipe with the background that the changes of the finished picture turn into the measured one.
    fn recipe_with_background(&self) -> Recipe {
        let mut recipe = self.recipe;
        if let Some([r, g, b]) = self.background {
            let [r, g, b, _] = self.output.iter().rev().fold([r, g, b, 255], |color, change| change.undo(color));
            recipe.pipeline.background = Background::Color([r, g, b]);
        }
        recipe
    }

    /// Moves the values of a buffer of this view to the pixels at which the finished picture shows them.
    pub(crate) fn placed<T: Copy>(&self, buffer: Image<T>) -> Image<T> {
        self.output.iter().fold(buffer, |buffer, change| change.place(buffer))
    }
}

impl OutputChange {
    fn apply(self, picture: Image<Rgba8>) -> Image<Rgba8> {
        match self {
            Self::Pixel(change) => picture.map(change.apply),
            Self::FlipRows | Self::FlipColumns => self.place(picture),
        }
    }

    /// Returns the colour that becomes the given one.
    fn undo(self, color: Rgba8) -> Rgba8 {
        match self {
            Self::Pixel(change) => (change.undo)(color),
            Self::FlipRows | Self::FlipColumns => color,
        }
    }

    /// Returns the window whose pixels become those of the given window of the picture.
    fn source(self, window: Window, picture: Viewport) -> Window {
        match self {
            Self::FlipRows => Window { y: picture.height - window.y - window.height, ..window },
            Self::FlipColumns => Window { x: picture.width - window.x - window.width, ..window },
            Self::Pixel(_) => window,
        }
    }

    /// Moves values of pixels to where the change moves the pixels.
    pub(crate) fn place<T: Copy>(self, buffer: Image<T>) -> Image<T> {
        let (width, height) = buffer.size();
        match self {
            Self::FlipRows => Image::from_fn(width, height, |x, y| buffer.at(x, height - 1 - y)),
            Self::FlipColumns => Image::from_fn(width, height, |x, y| buffer.at(width - 1 - x, y)),
            Self::Pixel(_) => buffer,
        }
    }
}
