//! Pictures as drawing commands: shapes with places in real numbers, that can be enlarged without stairs.
//!
//! A [`Drawing`] is written as SVG ([`svg`]) or PDF ([`pdf`]), or turned into a [`bitmap`] of any size; [`file`] picks the
//! format by the name of a file.

pub mod svg;

pub mod pdf;

pub mod bitmap;

pub mod file;

use glam::DVec2;

/// A colour, sRGB.
pub type Rgb = [u8; 3];

/// A line's colour and its width in units of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: Rgb,
    /// Its width.
    pub width: f64,
}

/// A shape; later ones lie over earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A closed polygon, filled by the even-odd rule, and its outline.
    Polygon {
        /// Its corners.
        corners: Vec<DVec2>,
        /// Colour of the inside.
        fill: Option<Rgb>,
        /// The outline.
        stroke: Option<Stroke>,
    },
    /// A straight line with round ends.
    Line {
        /// Its first end.
        from: DVec2,
        /// Its second end.
        to: DVec2,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// An ellipse with upright axes.
    Ellipse {
        /// Its middle.
        center: DVec2,
        /// Its half axes.
        radii: DVec2,
        /// Colour of the inside.
        fill: Option<Rgb>,
        /// The outline.
        stroke: Option<Stroke>,
    },
    /// Words, centred; bitmaps are without them.
    Text {
        /// The middle of the letters.
        at: DVec2,
        /// The words.
        text: String,
        /// Their colour.
        color: Rgb,
        /// Height of the font.
        size: f64,
    },
    /// Polygons that share their boundaries without overlap, drawn without seams: see [`Region`].
    Partition(Vec<Region>),
}

/// An area of a [`Shape::Partition`], filled by the even-odd rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Closed boundaries, outer ones and those of holes.
    pub contours: Vec<Vec<DVec2>>,
    /// Colour of the inside.
    pub fill: Rgb,
}

/// Widths of the lines around the regions of a partition, each time that a vector format draws it, in units of the drawing.
///
/// Viewers smooth the edges of one polygon after the other, and what lies below shines through where two of them meet: of two
/// that cover half of a pixel each, the second covers half of what the first left, and a quarter stays. A first drawing with
/// lines wider than a pixel covers all that is below with colours of regions close by: in the same colour as the regions
/// themselves if those do not differ. The wide lines serve views reduced to a tenth, the narrow ones all others. The last
/// drawings have no lines, so that no region reaches into another; the second of them leaves a sixteenth of the lines where two
/// regions meet.
pub(crate) const SEAM_WIDTHS: [f64; 4] = [30.0, 3.0, 0.0, 0.0];

/// A picture of shapes: x to the right, y down, from 0 to its size.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height, both greater than 0.
    pub size: DVec2,
    /// What lies below all shapes.
    pub background: Rgb,
    /// The shapes, from below to above.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// Returns the number of shapes, with each region of a partition as one.
    pub fn shape_count(&self) -> usize {
        let count = |shape: &Shape| if let Shape::Partition(regions) = shape { regions.len() } else { 1 };
        self.shapes.iter().map(count).sum()
    }

    /// A square of a grid, filled.
    pub fn square(&mut self, x: f64, y: f64, side: f64, fill: Rgb) {
        let corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].map(DVec2::from);
        self.shapes.push(Shape::Polygon { corners: corners.to_vec(), fill: Some(fill), stroke: None });
    }
}

#[cfg(test)]
mod tests;
