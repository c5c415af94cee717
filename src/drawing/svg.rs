//! Drawings as SVG 1.1.

use svg::Document;
use svg::node::element::{Ellipse, Line, Polygon, Rectangle, Text};

use super::{Drawing, Rgb, Shape, Stroke};

/// Pixels on screen per unit, as viewers first show it.
const PIXELS_PER_UNIT: f64 = 1.0;

/// The text of an SVG file that fills `scale` pixels per unit when it is first shown.
pub fn text(drawing: &Drawing, scale: f64) -> String {
    let (width, height) = (drawing.size.x, drawing.size.y);
    let ground = Rectangle::new().set("width", width).set("height", height).set("fill", code(drawing.background));
    let document = Document::new()
        .set("viewBox", (0, 0, width, height))
        .set("width", width * scale * PIXELS_PER_UNIT)
        .set("height", height * scale * PIXELS_PER_UNIT)
        .add(ground);
    drawing.shapes.iter().fold(document, with).to_string()
}

fn with(document: Document, shape: &Shape) -> Document {
    match shape {
        Shape::Polygon { corners, fill, stroke } => {
            let points: Vec<_> =
                corners.iter().map(|corner| format!("{},{}", short(corner.x), short(corner.y))).collect();
            let polygon = Polygon::new().set("points", points.join(" ")).set("fill-rule", "evenodd");
            document.add(
                polygon
                    .set("fill", fill.map_or("none".to_owned(), code))
                    .set("stroke", stroke.map_or("none".to_owned(), |stroke| code(stroke.color)))
                    .set("stroke-width", stroke.map_or(0.0, |stroke| stroke.width))
                    .set("stroke-linejoin", "round"),
            )
        }
        Shape::Line { from, to, stroke: Stroke { color, width } } => document.add(
            Line::new()
                .set("x1", short(from.x))
                .set("y1", short(from.y))
                .set("x2", short(to.x))
                .set("y2", short(to.y))
                .set("stroke", code(*color))
                .set("stroke-width", *width)
                .set("stroke-linecap", "round"),
        ),
        Shape::Ellipse { center, radii, fill, stroke } => document.add(
            Ellipse::new()
                .set("cx", short(center.x))
                .set("cy", short(center.y))
                .set("rx", short(radii.x))
                .set("ry", short(radii.y))
                .set("fill", fill.map_or("none".to_owned(), code))
                .set("stroke", stroke.map_or("none".to_owned(), |stroke| code(stroke.color)))
                .set("stroke-width", stroke.map_or(0.0, |stroke| stroke.width)),
        ),
        Shape::Text { at, text, color, size } => document.add(
            Text::new(text.as_str())
                .set("x", short(at.x))
                .set("y", short(at.y))
                .set("font-family", "sans-serif")
                .set("font-size", *size)
                .set("text-anchor", "middle")
                .set("dominant-baseline", "central")
                .set("fill", code(*color)),
        ),
    }
}

fn code([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// A coordinate with as many digits as any screen or printer can use.
fn short(value: f64) -> f64 {
    const STEPS_PER_UNIT: f64 = 10_000.0;
    (value * STEPS_PER_UNIT).round() / STEPS_PER_UNIT
}
