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
}

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
    /// A square of a grid, filled.
    pub fn square(&mut self, x: f64, y: f64, side: f64, fill: Rgb) {
        let corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].map(DVec2::from);
        self.shapes.push(Shape::Polygon { corners: corners.to_vec(), fill: Some(fill), stroke: None });
    }
}

#[cfg(test)]
mod tests;
