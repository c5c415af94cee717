//! From few drawn samples to a full picture.
//!
//! In: the samples that were drawn, packed as [`Upscaling::sampling`] says. Out: the whole picture, of any size from 1 × 1
//! on. Samples lie on pixels of the full picture, which then come out unchanged unless a method smooths on purpose, or
//! between them, as [`Lattice`] says.
//!
//! Methods filter sRGB codes, as most programs do, or linear light, which is physically right but rings darker at
//! edges. A picture is the same bit for bit whatever the number of threads and whatever the processor.
//! [`Upscaler::taps`] tells what a pixel is made of, and [`Upscaler::pixel`] makes it alone by the same arithmetic.
//!
//! Each method is one file and one entry of [`ALL`]; menus, command line, tests and reports read the registry.

use serde::Serialize;

use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

mod accumulation;
mod bands;
mod bicubic;
mod bilinear;
mod checkerboard;
mod choice;
mod cubic;
mod fsr;
mod history;
mod lanczos;
#[cfg(target_arch = "x86_64")]
mod lanes;
mod lattice;
mod native;
mod nearest;
#[cfg(target_arch = "x86_64")]
mod nearest_avx2;
mod scale;
mod separable;

pub use accumulation::ACCUMULATION;
pub use bicubic::BICUBIC;
pub use bilinear::BILINEAR;
pub use checkerboard::{CHECKERBOARD, CHECKERBOARD_EDGES, CHECKERBOARD_SURFACES, CHECKERBOARD_TEMPORAL};
pub use choice::{Light, Upscaling};
pub use cubic::{CATMULL_ROM, MITCHELL};
pub use fsr::FSR1;
pub use history::{Before, History, Motion, Seen, Surfaces};
pub use lanczos::{LANCZOS2, LANCZOS3};
pub use lattice::{Anchor, Lattice, Place};
pub use native::NATIVE;
pub use nearest::NEAREST;
pub use scale::Scale;

/// A method that fills in the pixels that were not drawn.
pub trait Upscaler: Sync {
    /// Word by which recipes and the command line name it; kebab case.
    fn id(&self) -> &'static str;

    /// What a person calls it.
    fn name(&self) -> &'static str;

    /// A few sentences: what it does, where it is good, which artefact it makes, and the source.
    fn help(&self) -> &'static str;

    /// What can be chosen about it. Everywhere below, `how` is a choice of this method.
    fn offers(&self) -> Offers;

    /// What it reads besides the colours that were drawn.
    fn reads(&self) -> Reads {
        Reads { surfaces: false, past: false }
    }

    /// After how many frames of a view that stands still the picture changes no more.
    fn settles_after(&self, _how: Upscaling) -> u32 {
        1
    }

    /// What must be drawn. Of a method that reads the past: when there is none.
    fn sampling(&self, how: Upscaling) -> Sampling;

    /// What must be drawn when so many frames came before without a break, and where in their pixels the samples lie, px from
    /// their corner.
    fn sampling_of(&self, how: Upscaling, _frames: u32) -> (Sampling, [f64; 2]) {
        (self.sampling(how), CENTRE)
    }

    /// Overwrites a picture, from samples packed as [`Upscaler::sampling`] says for its size; may panic if they are packed
    /// otherwise.
    fn upscale(&self, how: Upscaling, drawn: &Drawn<'_>, full: &mut Image<Rgba8>);

    /// Pixel `at` of the picture of `size` px that [`Upscaler::upscale`] makes, from no other samples than
    /// [`Upscaler::taps`] names.
    fn pixel(&self, how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8;

    /// The samples that pixel `at` is made of: each once; one without weight counts by rounding alone. Weights sum to one; the weighted
    /// sum of codes or light, clamped, is the pixel but for rounding, and but for what the method does besides weighing.
    fn taps(&self, how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap>;

    /// Where in the frame before a part of pixel `at` comes from, which is no tap; nowhere for most.
    fn remembers(&self, _how: Upscaling, _drawn: &Drawn<'_>, _size: (u32, u32), _at: (u32, u32)) -> Option<Before> {
        None
    }

    /// [`Upscaler::upscale`], and what the next frame is to remember besides the picture: nothing for most. May write that into
    /// memory that is no longer needed.
    fn upscale_and_remember(
        &self,
        how: Upscaling,
        drawn: &Drawn<'_>,
        full: &mut Image<Rgba8>,
        _memory: Option<Image<[f32; 4]>>,
    ) -> Option<Image<[f32; 4]>> {
        self.upscale(how, drawn, full);
        None
    }
}

/// The middle of a pixel, from its corner.
pub const CENTRE: [f64; 2] = [0.5; 2];

/// What a method reads besides the colours that were drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reads {
    /// Which surface every pixel shows.
    pub surfaces: bool,
    /// The frame before; only with surfaces.
    pub past: bool,
}

/// What can be chosen about a method: of each the first is the default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offers {
    /// Enlargements per axis, smallest first; one alone if there is none to choose.
    pub scales: &'static [Scale],
    /// Where samples may lie in their blocks.
    pub anchors: &'static [Anchor],
    /// What may be filtered.
    pub lights: &'static [Light],
    /// Whether overshoot can be cut off.
    pub deringing: bool,
    /// Whether the result can be sharpened.
    pub sharpening: bool,
}

/// What is drawn for an upscaler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Pixels of the full picture.
    Grid(SampleGrid),
    /// A smaller picture of the same view.
    Lattice(Lattice),
}

impl Sampling {
    /// The samples of a lattice: pixels of the full picture where they lie on such.
    pub fn of_lattice(lattice: Lattice) -> Self {
        match (lattice.anchor, lattice.scale.whole()) {
            (Anchor::Corner, Some(step)) => Self::Grid(SampleGrid::Block { step }),
            _ => Self::Lattice(lattice),
        }
    }

    /// The grid that is drawn, of the full picture or the smaller one.
    pub fn grid(self) -> SampleGrid {
        match self {
            Self::Grid(grid) => grid,
            Self::Lattice(_) => SampleGrid::FULL,
        }
    }

    /// Size of the picture that [`Sampling::grid`] is a grid of, px, for a full picture of `width` × `height` px.
    pub fn raster_size(self, width: u32, height: u32) -> (u32, u32) {
        match self {
            Self::Grid(_) => (width, height),
            Self::Lattice(lattice) => (lattice.samples(width), lattice.samples(height)),
        }
    }

    /// Where a packed sample, given by column and row, lies in the full picture, px.
    pub fn position_px(self, (column, row): (u32, u32)) -> (f64, f64) {
        match self {
            Self::Grid(grid) => {
                let (x, y) = grid.pixel(column, row);
                (f64::from(x) + 0.5, f64::from(y) + 0.5)
            }
            Self::Lattice(lattice) => (lattice.position_px(column), lattice.position_px(row)),
        }
    }

    /// The pixel of a full picture of `width` × `height` px that a packed sample lies in, or the one nearest to it.
    pub fn pixel(self, sample: (u32, u32), (width, height): (u32, u32)) -> (u32, u32) {
        let (x, y) = self.position_px(sample);
        ((x as u32).min(width - 1), (y as u32).min(height - 1))
    }
}

/// What was drawn.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<'a> {
    /// Colours, packed.
    pub color: &'a Image<Rgba8>,
    /// What else is known, if the method reads it and there is any.
    pub seen: Option<Seen<'a>>,
}

impl<'a> From<&'a Image<Rgba8>> for Drawn<'a> {
    fn from(color: &'a Image<Rgba8>) -> Self {
        Self { color, seen: None }
    }
}

/// One drawn sample and its share in an output pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tap {
    /// Column in the picture that was drawn: the full one, or the smaller one of a [`Lattice`].
    pub x: u32,
    /// Row there.
    pub y: u32,
    /// Its share; negative ones sharpen.
    pub weight: f32,
}

/// All methods, in the order in which menus list them.
pub static ALL: &[&dyn Upscaler] = &[
    &NATIVE,
    &CHECKERBOARD,
    &CHECKERBOARD_EDGES,
    &CHECKERBOARD_SURFACES,
    &CHECKERBOARD_TEMPORAL,
    &NEAREST,
    &BILINEAR,
    &BICUBIC,
    &CATMULL_ROM,
    &MITCHELL,
    &LANCZOS2,
    &LANCZOS3,
    &FSR1,
    &ACCUMULATION,
];

#[cfg(test)]
mod tests;
