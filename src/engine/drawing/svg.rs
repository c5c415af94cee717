//! Drawings as SVG 1.1.

use glam::DVec2;
use svg::node::element::{ClipPath, Definitions, Ellipse, Group, Line, Path, Polygon, Rectangle, Text, Use};
use svg::{Document, Node};

use super::{Drawing, PartitionRegion, Rgb, SEAM_WIDTHS, Shape, Stroke};

/// Screen pixels per unit of the drawing at a scale of 1, before the user zooms.
const PIXELS_PER_UNIT: f64 = 1.0;

/// Id of the clip path that limits partitions to the page, because their wide lines extend beyond it.
const PAGE: &str = "page";

/// Returns the text of an SVG file that viewers first show with `scale` pixels per unit.
pub(crate) fn text(drawing: &Drawing, scale: f64) -> String {
    let (width, height) = (drawing.size.x, drawing.size.y);
    let page = || Rectangle::new().set("width", width).set("height", height);
    let has_partition = drawing.shapes.iter().any(|shape| matches!(shape, Shape::Partition(_)));
    let mut document = Document::new()
        .set("viewBox", (0, 0, width, height))
        .set("width", width * scale * PIXELS_PER_UNIT)
        .set("height", height * scale * PIXELS_PER_UNIT)
        .add(page().set("fill", code(drawing.background)));
    if has_partition {
        let page = ClipPath::new().set("id", PAGE).add(page());
        document = document.set("xmlns:xlink", "http://www.w3.org/1999/xlink").add(page);
    }
    drawing.shapes.iter().enumerate().for_each(|shape| append(&mut document, shape));
    document.to_string()
}

/// Returns the elements of shapes as a group. `attributes` are those of its element, such as an id.
pub(crate) fn group(shapes: &[Shape], attributes: &[(&str, String)]) -> String {
    let mut group = Group::new();
    attributes.iter().for_each(|(name, value)| group.assign(*name, value.as_str()));
    shapes.iter().enumerate().for_each(|shape| append(&mut group, shape));
    group.to_string()
}

fn append(parent: &mut impl Node, (number, shape): (usize, &Shape)) {
    match shape {
        Shape::Polygon { corners, fill, stroke } => {
            let points: Vec<_> =
                corners.iter().map(|corner| format!("{},{}", short(corner.x), short(corner.y))).collect();
            let polygon = Polygon::new().set("points", points.join(" ")).set("fill-rule", "evenodd");
            parent.append(
                polygon
                    .set("fill", fill.map_or("none".to_owned(), code))
                    .set("stroke", stroke.map_or("none".to_owned(), |stroke| code(stroke.color)))
                    .set("stroke-width", stroke.map_or(0.0, |stroke| stroke.width))
                    .set("stroke-linejoin", "round"),
            );
        }
        Shape::Line { from, to, stroke: Stroke { color, width } } => parent.append(
            Line::new()
                .set("x1", short(from.x))
                .set("y1", short(from.y))
                .set("x2", short(to.x))
                .set("y2", short(to.y))
                .set("stroke", code(*color))
                .set("stroke-width", *width)
                .set("stroke-linecap", "round"),
        ),
        Shape::Ellipse { center, radii, fill, stroke } => parent.append(
            Ellipse::new()
                .set("cx", short(center.x))
                .set("cy", short(center.y))
                .set("rx", short(radii.x))
                .set("ry", short(radii.y))
                .set("fill", fill.map_or("none".to_owned(), code))
                .set("stroke", stroke.map_or("none".to_owned(), |stroke| code(stroke.color)))
                .set("stroke-width", stroke.map_or(0.0, |stroke| stroke.width)),
        ),
        Shape::Partition(regions) => {
            let id = format!("regions-{number}");
            let all = Group::new().set("id", id.as_str()).set("fill-rule", "evenodd").set("stroke-linejoin", "round");
            let all = regions.iter().fold(all, |group, region| group.add(area(region)));
            let drawn = |width: f64| Use::new().set("xlink:href", format!("#{id}")).set("stroke-width", width);
            let within_page = Group::new().set("clip-path", format!("url(#{PAGE})"));
            let times = SEAM_WIDTHS.into_iter().fold(within_page, |group, width| group.add(drawn(width)));
            parent.append(Definitions::new().add(all));
            parent.append(times);
        }
        Shape::Text { at, text, color, size } => parent.append(
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

/// Returns the path element of a region. The element has no line width of its own; it inherits the width from the `use`
/// element that draws it.
fn area(PartitionRegion { contours, fill }: &PartitionRegion) -> Path {
    let mut data = String::new();
    for contour in contours {
        for (number, DVec2 { x, y }) in contour.iter().enumerate() {
            // Coordinate pairs after the first `M` are implicit line commands.
            let before = if number == 0 { "M" } else { " " };
            data.push_str(&format!("{before}{},{}", short(*x), short(*y)));
        }
        data.push('Z');
    }
    Path::new().set("d", data).set("fill", code(*fill)).set("stroke", code(*fill))
}

fn code([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Rounds a coordinate to 1/10 000 unit, which is finer than any screen or printer can reproduce.
fn short(value: f64) -> f64 {
    const STEPS_PER_UNIT: f64 = 10_000.0;
    (value * STEPS_PER_UNIT).round() / STEPS_PER_UNIT
}
