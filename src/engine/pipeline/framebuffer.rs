//! Framebuffer: colours and, if needed, depths of the drawn pixels.

use std::ops::Range;

use super::area::DrawnArea;
use super::depth::{DepthScale, clear_value};
use super::grid::SampleGrid;
use super::settings::{DepthTest, Settings};
use crate::image::{Image, Rgba8};

/// Colours and depths of the pixels that a [`SampleGrid`] selects, packed without gaps. A framebuffer may also hold
/// only a rectangle of the packed picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Framebuffer {
    /// Grid that selects the drawn pixels.
    pub grid: SampleGrid,
    /// Column and row, in the packed picture, of the first sample that the framebuffer holds; (0, 0) unless it holds
    /// only a part of the picture.
    pub(crate) origin: (u32, u32),
    /// Colour of each sample, as sRGB codes.
    pub color: Image<Rgba8>,
    /// Stored depth of each sample; `None` if depths are not stored.
    pub depth: Option<Image<f32>>,
    /// Clear value of the depth buffer.
    pub clear_depth: f32,
    /// Mapping between distances and stored depths.
    pub(crate) depth_scale: DepthScale,
}

/// Whether the depth buffer of a frame is kept after drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepDepth {
    /// The depths are kept with the frame.
    Yes,
    /// The depths may be discarded after their last use in drawing.
    No,
}

impl Framebuffer {
    /// Returns a cleared framebuffer for a full picture of `width` × `height` px. `background` is the scene's
    /// background colour, as sRGB codes; the settings may replace it.
    pub(crate) fn new(grid: SampleGrid, width: u32, height: u32, background: [u8; 3], settings: &Settings) -> Self {
        Self::cleared(grid, grid.packed_size(width, height), background, settings)
    }

    /// Returns a cleared framebuffer that holds a single sample.
    pub(crate) fn one_sample(grid: SampleGrid, sample: (u32, u32), background: [u8; 3], settings: &Settings) -> Self {
        Self { origin: sample, ..Self::cleared(grid, (1, 1), background, settings) }
    }

    /// Returns a cleared framebuffer for the rows `rows` of the packed picture of an area.
    pub(crate) fn of_rows(area: DrawnArea, rows: Range<u32>, background: [u8; 3], settings: &Settings) -> Self {
        let (columns, _) = area.packed_size();
        let size = (columns, rows.end - rows.start);
        Self { origin: (0, rows.start), ..Self::cleared(area.grid, size, background, settings) }
    }

    /// Returns a cleared framebuffer that holds samples of the packed picture from the first one on.
    fn cleared(grid: SampleGrid, (width, height): (u32, u32), background: [u8; 3], settings: &Settings) -> Self {
        let clear_depth = clear_value(settings);
        let depth = (settings.depth_test != DepthTest::Off).then(|| Image::filled(width, height, clear_depth));
        let color = Image::filled(width, height, settings.clear_color(background));
        Self { grid, origin: (0, 0), color, depth, clear_depth, depth_scale: DepthScale::default() }
    }

    /// Returns an uncleared framebuffer that reuses existing buffers. Their old content remains, so callers must
    /// overwrite all of it.
    pub(crate) fn reusing(area: DrawnArea, memory: UsedImages, settings: &Settings, keep_depth: KeepDepth) -> Self {
        let (width, height) = area.packed_size();
        let needs_depth = keep_depth == KeepDepth::Yes && settings.depth_test != DepthTest::Off;
        Self {
            grid: area.grid,
            origin: (0, 0),
            color: Image::reusing(memory.color, width, height, [0; 4]),
            depth: needs_depth.then(|| Image::reusing(memory.depth, width, height, 0.0)),
            clear_depth: clear_value(settings),
            depth_scale: DepthScale::default(),
        }
    }
}

/// Images of earlier framebuffers, whose memory is used again.
#[derive(Debug)]
pub(crate) struct UsedImages {
    pub(crate) color: Option<Image<Rgba8>>,
    pub(crate) depth: Option<Image<f32>>,
}
