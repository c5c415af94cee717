//! Upscaling: computes a full image from fewer samples than it has pixels.
//!
//! The input is the drawn samples, packed as [`Upscaling::sampling`] specifies. The output is the whole image, of any
//! size from 1 × 1. Samples lie on pixels of the full image or between them, as [`Lattice`] specifies. Samples on
//! pixels are kept unchanged unless the upscaler deliberately smooths.
//!
//! Upscalers filter sRGB-encoded values, as most programs do, or linear light, which is physically correct but makes
//! dark edges ring more. Images are bit-identical for any number of threads and on any processor. [`Upscaler::taps`]
//! lists the samples of a pixel, and [`Upscaler::pixel`] computes a single pixel with the same arithmetic.
//!
//! [`all`] returns the registry, which menus, command line, tests and reports read: the constant list [`BUILT_IN`],
//! followed by the upscalers that a program adds with [`register`].

use std::time::Duration;

use serde::Serialize;

use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

mod bands;
mod choice;
mod history;
mod history_options;
mod jitter;
#[cfg(target_arch = "x86_64")]
mod lanes;
mod lattice;
#[cfg(target_arch = "x86_64")]
mod nearest_avx2;
mod planes;
pub mod process;
mod quads;
mod registry;
mod row_parts;
mod runs;
mod sample_rows;
mod scale;
mod separable;
mod spares;
mod statistics;
mod ycocg;

/// Declares [`BUILT_IN`]: for each module, its upscalers.
///
/// The macro also declares the modules, so that an upscaler is added by one line. `cargo fmt` does not see modules that a
/// macro declares; `.ci/run` formats them by their files.
macro_rules! built_in {
    ($($($upscaler:ident),+ in mod $module:ident;)+) => {
        $(mod $module;)+

        /// The built-in upscalers, in menu order.
        pub static BUILT_IN: &[&dyn Upscaler] = &[$($(&$module::$upscaler),+),+];
    };
}

built_in! {
    NATIVE in mod native;
    CHECKERBOARD, CHECKERBOARD_EDGES, CHECKERBOARD_SURFACES, CHECKERBOARD_TEMPORAL in mod checkerboard;
    NEAREST in mod nearest;
    BILINEAR in mod bilinear;
    BICUBIC in mod bicubic;
    CATMULL_ROM, MITCHELL in mod cubic;
    LANCZOS2, LANCZOS3 in mod lanczos;
    EWA_LANCZOS in mod ewa;
    FSR1 in mod fsr;
    NIS in mod nis;
    ACCUMULATION in mod accumulation;
    TAA in mod taa;
    FSR2 in mod fsr2;
    SGSR2 in mod sgsr2;
}

pub use choice::FilterSpace;
pub(crate) use choice::MAX_SHARPENING;
pub use choice::Upscaling;
pub use history::Accumulated;
pub use history::BlendSpace;
pub(crate) use history::FrameInputs;
pub(crate) use history::History;
pub use history::HistoryStep;
pub use history::HistorySteps;
pub use history::HistoryTaps;
pub(crate) use history::Motion;
pub use history::PastColor;
pub use history::Rejection;
pub(crate) use history::Reprojected;
pub(crate) use history::whole_and_fraction;
pub use history_options::HistoryFilter;
pub use history_options::HistoryOptions;
pub use history_options::Rectification;
pub use jitter::Jitter;
pub use lattice::Anchor;
pub(crate) use lattice::Lattice;
pub use registry::RegisterError;
pub use registry::all;
pub use registry::register;
pub use registry::register_boxed;
pub use scale::Scale;

/// An upscaler, which fills in the pixels that were not drawn.
pub trait Upscaler: Sync {
    /// Returns the id used in recipes and on the command line, in kebab case.
    fn id(&self) -> &'static str;

    /// Returns the display name of the upscaler.
    fn name(&self) -> &'static str;

    /// Returns a short description: algorithm, strengths, artefacts and source.
    fn help(&self) -> &'static str;

    /// Returns the artefacts that distinguish the pictures from native rendering, as a phrase for tables; empty if they are
    /// not known.
    fn artefacts(&self) -> &'static str {
        ""
    }

    /// Returns the available options. In all methods below, `how` must select this upscaler.
    fn offers(&self) -> Offers;

    /// Returns the scale at which the upscaler is used unless another one is selected; the offered scale nearest to it
    /// counts.
    fn default_scale(&self) -> Scale {
        Scale::ONE_AND_A_HALF
    }

    /// Returns the inputs that the upscaler reads besides the drawn colours.
    fn reads(&self) -> Reads {
        Reads { gbuffer: false, history: false }
    }

    /// Whether samples on pixels are smoothed or sharpened, instead of copied unchanged.
    fn alters_samples(&self) -> bool {
        false
    }

    /// Whether the upscaler gives less weight to the history of surfaces that are blended or have holes. It must also read
    /// history.
    fn reads_reactive_mask(&self) -> bool {
        false
    }

    /// Returns the positions of the samples within their areas, one per frame; `None` if the samples stay where
    /// [`Upscaler::sampling`] puts them.
    fn jitter(&self, _how: Upscaling) -> Option<Jitter> {
        None
    }

    /// Returns the number of frames of a still view after which the image no longer changes.
    fn converges_after(&self, how: Upscaling) -> u32 {
        self.jitter(how).map_or(1, Jitter::positions)
    }

    /// Returns the samples to draw. For upscalers with history, these are the samples of the first frame.
    fn sampling(&self, how: Upscaling) -> Sampling;

    /// Returns the samples to draw after `frames` consecutive earlier frames, and their position within a pixel, in
    /// [0, 1]².
    fn frame_sampling(&self, how: Upscaling, frames: u32) -> (Sampling, [f64; 2]) {
        (self.sampling(how), self.jitter(how).map_or(CENTRE, |jitter| jitter.place(frames)))
    }

    /// Upscales the drawn samples into `full`, overwriting it.
    ///
    /// May panic if the samples are not packed as [`Upscaler::sampling`] specifies for the image size.
    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>);

    /// Computes the pixel `at` of an image of `size` px, bit-identical to [`Upscaler::upscale`]. Reads only the samples
    /// that [`Upscaler::taps`] lists.
    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8;

    /// Returns the distinct samples that contribute to pixel `at`, with weights that sum to 1. Samples of zero weight
    /// affect only clamping or rounding. The pixel is the clamped weighted sum in the filtering colour space, apart
    /// from rounding and non-linear steps of the upscaler.
    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap>;

    /// Returns a function that tells how pixels of the frame are blended with their history: `None` for a pixel for which
    /// the upscaler reads no history. History is not a tap.
    fn history_steps<'a>(&'a self, _how: Upscaling, _drawn: &'a UpscaleInputs<'a>) -> HistorySteps<'a> {
        Box::new(|_| None)
    }

    /// Returns the filter that reads the history at fraction `t`, in [0, 1), between two pixels of an axis. Only meaningful
    /// for upscalers with [`Upscaler::history_steps`].
    fn history_taps(&self, _how: Upscaling, t: f32) -> HistoryTaps {
        HistoryTaps::Linear(t)
    }

    /// Whether the whole picture is needed to know a pixel. If so, [`Upscaler::pixel`] and [`Upscaler::taps`] only
    /// approximate the picture of [`Upscaler::upscale`].
    fn is_opaque(&self) -> bool {
        false
    }

    /// Returns the process that upscales, as the option `--upscaler-process` describes it. Returns `None` if the
    /// upscaler runs within this process and transfers nothing; see [`Upscaled::transfer`].
    fn process(&self) -> Option<&str> {
        None
    }

    /// Returns the upscaler for the tests of those that are defined by weights alone; `None` if it is another one.
    #[cfg(test)]
    fn as_separable(&self) -> Option<&dyn std::any::Any> {
        None
    }

    /// Returns the message of the failure since which the upscaler uses a fallback; `None` if it works.
    fn failure(&self) -> Option<String> {
        None
    }

    /// Ends the fallback after a failure, so that the next use tries again. Called when the user chooses the upscaler
    /// explicitly.
    fn retry(&self) {}

    /// Upscales like [`Upscaler::upscale`] and returns the history for the next frame. `_memory` is an older history
    /// whose buffers may be reused.
    fn upscale_with_history(
        &self,
        how: Upscaling,
        drawn: &UpscaleInputs<'_>,
        full: &mut Image<Rgba8>,
        _memory: Option<Accumulated>,
    ) -> Upscaled {
        self.upscale(how, drawn, full);
        Upscaled::default()
    }
}

/// Result of upscaling besides the picture.
#[derive(Clone, Debug, Default)]
pub struct Upscaled {
    /// History for the next frame; `None` if the upscaler stores none.
    pub history: Option<Accumulated>,
    /// Part of the time that was spent on moving pictures to and from another process; zero within this process.
    pub transfer: Duration,
}

/// Centre of a pixel, relative to its top left corner.
pub(crate) const CENTRE: [f64; 2] = [0.5; 2];

/// Inputs that an upscaler reads besides the drawn colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reads {
    /// Whether the upscaler reads the [`GBuffer`](crate::pipeline::gbuffer::GBuffer): the visible surface of every
    /// rasterized pixel.
    pub(crate) gbuffer: bool,
    /// Whether the upscaler reads the previous frame; requires `gbuffer`.
    pub history: bool,
}

/// Options of an upscaler; the first value of each list is the default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offers {
    /// Offered scale factors, which apply to both axes, in ascending order; a single one if there is no choice.
    pub scales: &'static [Scale],
    /// Offered positions of a sample within its block.
    pub anchors: &'static [Anchor],
    /// Offered filtering colour spaces.
    pub lights: &'static [FilterSpace],
    /// Whether the upscaler offers de-ringing.
    pub deringing: bool,
    /// Whether the upscaler offers sharpening.
    pub sharpening: bool,
    /// Whether the upscaler offers [`HistoryOptions`].
    pub history: bool,
}

/// Samples that are drawn for an upscaler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// A subset of the pixels of the full image.
    Grid(SampleGrid),
    /// A lower-resolution image of the same view.
    Lattice(Lattice),
}

impl Sampling {
    /// Returns the samples of a lattice. They are pixels of the full image if the anchor is the corner and the scale is
    /// an integer. Otherwise they are a lower-resolution image.
    pub fn of_lattice(lattice: Lattice) -> Self {
        match (lattice.anchor, lattice.scale.whole()) {
            (Anchor::Corner, Some(step)) => Self::Grid(SampleGrid::Block { step }),
            _ => Self::Lattice(lattice),
        }
    }

    /// Returns the grid of drawn pixels, within the full or the lower-resolution image.
    pub fn grid(self) -> SampleGrid {
        match self {
            Self::Grid(grid) => grid,
            Self::Lattice(_) => SampleGrid::FULL,
        }
    }

    /// Returns the size in pixels of the image that [`Sampling::grid`] refers to, for a full image of `width` ×
    /// `height` px.
    pub(crate) fn raster_size(self, width: u32, height: u32) -> (u32, u32) {
        match self {
            Self::Grid(_) => (width, height),
            Self::Lattice(lattice) => (lattice.samples(width), lattice.samples(height)),
        }
    }

    /// Returns the position in the full image, in pixels, of a packed sample given by column and row.
    pub fn position_px(self, (column, row): (u32, u32)) -> (f64, f64) {
        match self {
            Self::Grid(grid) => {
                let (x, y) = grid.pixel(column, row);
                (f64::from(x) + 0.5, f64::from(y) + 0.5)
            }
            Self::Lattice(lattice) => (lattice.position_px(column), lattice.position_px(row)),
        }
    }

    /// Returns the pixel of a full image of `width` × `height` px that contains a packed sample, or the nearest pixel.
    pub(crate) fn pixel(self, sample: (u32, u32), (width, height): (u32, u32)) -> (u32, u32) {
        let (x, y) = self.position_px(sample);
        ((x as u32).min(width - 1), (y as u32).min(height - 1))
    }
}

/// Inputs of an upscaler: the drawn samples, surfaces and history.
#[derive(Clone, Copy, Debug)]
pub struct UpscaleInputs<'a> {
    /// Colours of the drawn samples, packed as [`Upscaling::sampling`] specifies.
    pub color: &'a Image<Rgba8>,
    /// Surfaces and history, if the upscaler reads them and they are available.
    pub(crate) frame: Option<FrameInputs<'a>>,
}

impl<'a> From<&'a Image<Rgba8>> for UpscaleInputs<'a> {
    fn from(color: &'a Image<Rgba8>) -> Self {
        Self { color, frame: None }
    }
}

/// A drawn sample and its weight in an output pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tap {
    /// Column of the sample in the full image, or in the lower-resolution image of a [`Lattice`].
    pub x: u32,
    /// Row of the sample in the same image.
    pub y: u32,
    /// Weight of the sample; negative weights sharpen.
    pub weight: f32,
}

#[cfg(test)]
mod test_sequence;
#[cfg(test)]
mod tests;
