//! What is drawn into: packed colour and, if needed, packed depth.

use super::depth::clear_value;
use super::grid::SampleGrid;
use super::settings::{DepthTest, Settings};
use crate::image::{Image, Rgba8};

/// The packed picture of a [`SampleGrid`], or a rectangle of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Framebuffer {
    /// Which pixels are drawn.
    pub grid: SampleGrid,
    /// Packed column and row of the first sample held; (0, 0) unless only a part is drawn.
    pub origin: (u32, u32),
    /// Colours (sRGB codes).
    pub color: Image<Rgba8>,
    /// Stored depth; `None` when the depth test is off, which needs none.
    pub depth: Option<Image<f32>>,
    /// What stored depth starts from.
    pub clear_depth: f32,
}

impl Framebuffer {
    /// A cleared framebuffer for a full picture of `width` × `height` px.
    pub fn new(grid: SampleGrid, width: u32, height: u32, background: [u8; 3], settings: &Settings) -> Self {
        Self::cleared(grid, (0, 0), grid.packed_size(width, height), background, settings)
    }

    /// A cleared framebuffer that holds nothing but one sample.
    pub fn one_sample(grid: SampleGrid, sample: (u32, u32), background: [u8; 3], settings: &Settings) -> Self {
        Self::cleared(grid, sample, (1, 1), background, settings)
    }

    fn cleared(
        grid: SampleGrid,
        origin: (u32, u32),
        (width, height): (u32, u32),
        [r, g, b]: [u8; 3],
        settings: &Settings,
    ) -> Self {
        let clear_depth = clear_value(settings);
        let depth = (settings.depth_test != DepthTest::Off).then(|| Image::filled(width, height, clear_depth));
        Self { grid, origin, color: Image::filled(width, height, [r, g, b, 255]), depth, clear_depth }
    }
}
