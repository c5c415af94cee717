//! Setup of one drawing: our inputs with the changes of some faults.

use std::sync::Arc;

use rasterscope_engine::chain::{KeepDepth, Recipe, Renderer};
use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::pipeline::viewport::Viewport;
use rasterscope_engine::scene::{Camera, Scene, SubView};

use crate::fault::{Change, Fault};

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
}

/// Change of the finished picture.
#[derive(Clone, Copy, Debug)]
pub(crate) enum OutputChange {
    /// Rows in reverse order.
    FlipRows,
    /// Columns in reverse order.
    FlipColumns,
    /// Function of the colour of a pixel.
    Pixel(fn(Rgba8) -> Rgba8),
}

/// Rounding of colours to 8-bit codes, as it shows in differences from our codes, which are rounded to nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Rounding {
    /// The nearest code: equal to ours.
    Nearest,
    /// The next lower code: in half of all pixels one less than ours.
    Down,
    /// The next higher code: in half of all pixels one more than ours.
    Up,
}

impl Setup {
    /// Returns the setup of a correct drawing of `viewport` size.
    pub fn new(scene: Arc<Scene>, camera: Camera, recipe: Recipe, viewport: Viewport) -> Self {
        Self { scene, camera, recipe, viewport, output: Vec::new(), rounding: Rounding::Nearest }
    }

    /// Returns the setup with the faults added, in the given order.
    pub fn with<'a>(&self, faults: impl IntoIterator<Item = &'a Fault>) -> Self {
        let mut changed = self.clone();
        for fault in faults {
            changed.add(fault);
        }
        changed
    }

    fn add(&mut self, fault: &Fault) {
        match fault.change {
            // The assignments are constants, and a test sets each of them.
            Change::Settings(assignments) => drop(self.recipe.set_all(assignments)),
            Change::Setup(change) => change(self),
            Change::Output(change) => self.output.push(change),
            Change::Rounding(rounding) => self.rounding = rounding,
        }
    }

    /// Returns the camera's sub-view for changes. If it has none yet, it is the whole picture.
    pub(crate) fn sub_view_mut(&mut self) -> &mut SubView {
        let whole = SubView { aspect: self.viewport.aspect(), scale: [1.0; 2], shift: [0.0; 2] };
        self.camera.sub_view.get_or_insert(whole)
    }

    /// Draws the picture, including the changes of the finished picture.
    pub fn draw(&self, renderer: &mut Renderer) -> Image<Rgba8> {
        let frame = renderer.render(&self.scene, &self.camera, &self.recipe, self.viewport, KeepDepth::No);
        let mut picture = frame.image().clone();
        renderer.recycle(frame);
        for change in &self.output {
            picture = change.apply(picture);
        }
        picture
    }

    /// Moves the values of a buffer of this view to the pixels at which the finished picture shows them.
    pub(crate) fn placed<T: Copy>(&self, buffer: Image<T>) -> Image<T> {
        self.output.iter().fold(buffer, |buffer, change| change.place(buffer))
    }
}

impl OutputChange {
    fn apply(self, picture: Image<Rgba8>) -> Image<Rgba8> {
        match self {
            Self::Pixel(change) => picture.map(change),
            Self::FlipRows | Self::FlipColumns => self.place(picture),
        }
    }

    fn place<T: Copy>(self, buffer: Image<T>) -> Image<T> {
        let (width, height) = buffer.size();
        match self {
            Self::FlipRows => Image::from_fn(width, height, |x, y| buffer.at(x, height - 1 - y)),
            Self::FlipColumns => Image::from_fn(width, height, |x, y| buffer.at(width - 1 - x, y)),
            Self::Pixel(_) => buffer,
        }
    }
}
