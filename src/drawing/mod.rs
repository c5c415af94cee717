//! Pictures as drawing commands: shapes with real-valued coordinates, which can be enlarged without stair-stepping.
//!
//! A [`Drawing`] is written as SVG ([`svg`]) or PDF ([`pdf`]), or drawn into a [`bitmap`] of any size; [`mod@file`] selects
//! the format by the file name.

pub(crate) mod svg;

pub(crate) mod pdf;

pub(crate) mod bitmap;

pub mod file;

use glam::DVec2;

/// Colour, as sRGB codes.
pub(crate) type Rgb = [u8; 3];

/// Colour and width of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour of the line.
    pub(crate) color: Rgb,
    /// Width, in units of the drawing.
    pub(crate) width: f64,
}

/// Shape; later ones are drawn over earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Closed polygon, filled by the even-odd rule, and its outline.
    Polygon {
        /// Corners, in units of the drawing.
        corners: Vec<DVec2>,
        /// Fill colour, if it is filled.
        fill: Option<Rgb>,
        /// Outline, if it has one.
        stroke: Option<Stroke>,
    },
    /// Straight line with round ends.
    Line {
        /// Start point.
        from: DVec2,
        /// End point.
        to: DVec2,
        /// Colour and width.
        stroke: Stroke,
    },
    /// Ellipse with axes parallel to x and y.
    Ellipse {
        /// Centre.
        center: DVec2,
        /// Half axes along x and y.
        radii: DVec2,
        /// Fill colour, if it is filled.
        fill: Option<Rgb>,
        /// Outline, if it has one.
        stroke: Option<Stroke>,
    },
    /// Centred text; left out of bitmaps.
    Text {
        /// Centre of the text.
        at: DVec2,
        /// Characters of the text.
        text: String,
        /// Colour of the text.
        color: Rgb,
        /// Font size, in units of the drawing.
        size: f64,
    },
    /// Polygons that share their boundaries without overlap, drawn without seams: see [`PartitionRegion`].
    Partition(Vec<PartitionRegion>),
}

/// Area of a [`Shape::Partition`], filled by the even-odd rule.
#[derive(Clone, Debug, PartialEq)]
pub struct PartitionRegion {
    /// Closed boundaries: outer ones and those of holes.
    pub(crate) contours: Vec<Vec<DVec2>>,
    /// Fill colour.
    pub(crate) fill: Rgb,
}

/// Widths of the lines around the regions of a partition, one per pass of a vector format over it, in units of the
/// drawing.
///
/// Viewers anti-alias one polygon after the other, so the background shines through where two of them meet. If two
/// polygons cover half of a pixel each, the second covers half of what the first left, and a quarter remains. A first
/// pass with lines wider than a pixel covers all of the background with colours of nearby regions. If those regions
/// have equal colours, this is exactly their colour. The wide lines serve views reduced to a tenth, the narrow ones all
/// others. The last passes have no lines, so that no region reaches into another; the second of them leaves a sixteenth
/// of the lines where two regions meet.
pub(crate) const SEAM_WIDTHS: [f64; 4] = [30.0, 3.0, 0.0, 0.0];

/// Picture made of shapes: x to the right, y down, from 0 to its size.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height in units, both greater than 0.
    pub size: DVec2,
    /// Background colour, below all shapes.
    pub background: Rgb,
    /// Shapes, from bottom to top.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// Returns the number of shapes, counting each region of a partition as one.
    pub(crate) fn shape_count(&self) -> usize {
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
