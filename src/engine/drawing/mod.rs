//! Vector drawings: shapes with real-valued coordinates, which can be enlarged without stair-stepping.
//!
//! A [`Drawing`] is written as SVG ([`svg`]) or PDF ([`pdf`]), or rendered to a [`bitmap`] of any size; [`mod@file`]
//! selects the format by the file name extension.

pub(crate) mod svg;

pub(crate) mod pdf;

pub(crate) mod bitmap;

pub mod file;

use glam::DVec2;

/// Opaque colour as sRGB codes: red, green and blue.
pub(crate) type Rgb = [u8; 3];

/// Colour and width of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour of the line.
    pub(crate) color: Rgb,
    /// Width of the line, in units of the drawing.
    pub(crate) width: f64,
}

/// Shape of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Closed polygon, filled by the even-odd rule, with an optional outline.
    Polygon {
        /// Corners, in units of the drawing.
        corners: Vec<DVec2>,
        /// Fill colour, or `None` for no fill.
        fill: Option<Rgb>,
        /// Outline, or `None` for no outline.
        stroke: Option<Stroke>,
    },
    /// Straight line with round caps.
    Line {
        /// Start point, in units of the drawing.
        from: DVec2,
        /// End point, in units of the drawing.
        to: DVec2,
        /// Colour and width of the line.
        stroke: Stroke,
    },
    /// Ellipse with axes parallel to x and y.
    Ellipse {
        /// Centre of the ellipse, in units of the drawing.
        center: DVec2,
        /// Semi-axes along x and y, in units of the drawing.
        radii: DVec2,
        /// Fill colour, or `None` for no fill.
        fill: Option<Rgb>,
        /// Outline, or `None` for no outline.
        stroke: Option<Stroke>,
    },
    /// Line of text centred on a point. Omitted from bitmaps.
    Text {
        /// Centre of the text, in units of the drawing.
        at: DVec2,
        /// Characters of the line, without line breaks.
        text: String,
        /// Colour of the text.
        color: Rgb,
        /// Font size, in units of the drawing.
        size: f64,
    },
    /// Regions that share boundaries without overlap, drawn without visible seams.
    Partition(Vec<PartitionRegion>),
}

/// Region of a [`Shape::Partition`], filled by the even-odd rule.
#[derive(Clone, Debug, PartialEq)]
pub struct PartitionRegion {
    /// Closed contours: outer boundaries of the region, and boundaries of its holes.
    pub(crate) contours: Vec<Vec<DVec2>>,
    /// Fill colour of the region.
    pub(crate) fill: Rgb,
}

/// Line widths for drawing a partition in a vector format, one per pass over its regions, in units of the drawing.
///
/// Viewers anti-alias one polygon after the other, so the background shows through where two polygons meet. If two
/// polygons cover half of a pixel each, the second covers half of the background that the first left visible, and a
/// quarter of the background remains. A first pass with lines wider than a pixel covers all of the background with the
/// colours of nearby regions. Between regions of equal colour, the result is exactly that colour. The wide lines are
/// for views scaled down to a tenth of the size, the narrow lines for all other views. The last two passes have no
/// lines, so that no region extends into another. After them, a sixteenth of the line colour remains where two regions
/// meet.
pub(crate) const SEAM_WIDTHS: [f64; 4] = [30.0, 3.0, 0.0, 0.0];

/// Vector drawing: shapes over a background. x points right and y down, both from 0 to `size`.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height in units of the drawing, both greater than 0.
    pub size: DVec2,
    /// Background colour, below all shapes.
    pub background: Rgb,
    /// Shapes in drawing order: later ones cover earlier ones.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// Returns the number of shapes, counting each region of a partition as one.
    pub fn shape_count(&self) -> usize {
        let count = |shape: &Shape| if let Shape::Partition(regions) = shape { regions.len() } else { 1 };
        self.shapes.iter().map(count).sum()
    }

    /// Adds a filled square with its top left corner at (x, y), in units of the drawing.
    pub fn square(&mut self, x: f64, y: f64, side: f64, fill: Rgb) {
        let corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].map(DVec2::from);
        self.shapes.push(Shape::Polygon { corners: corners.to_vec(), fill: Some(fill), stroke: None });
    }
}

#[cfg(test)]
mod tests;
