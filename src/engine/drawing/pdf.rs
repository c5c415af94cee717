//! Drawings as a one-page PDF.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::DVec2;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish as _, Name, Pdf, Rect, Ref, Str};

use super::{Drawing, PartitionRegion, Rgb, SEAM_WIDTHS, Shape, Stroke};

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const FONT: Ref = Ref::new(5);
const FONT_NAME: Name<'_> = Name(b"F1");

/// Object number of the first form XObject. The constants above use the smaller numbers.
const FIRST_FORM: i32 = 6;

/// Distance between an endpoint of a cubic Bézier curve and the adjacent control point, relative to the radius, if four
/// curves approximate a circle. With 4/3 · (√2 − 1), the middle of each curve lies on the circle.
const QUARTER: f64 = 0.552_284_749_8;

/// Returns the bytes of a PDF file whose page has `scale` points (1/72 inch) per unit.
pub(crate) fn bytes(drawing: &Drawing, scale: f64) -> Vec<u8> {
    let [width, height] = [drawing.size.x, drawing.size.y].map(|side| (side * scale) as f32);
    let mut content = Content::new();
    // The y axis of a PDF page points up.
    content.transform([scale as f32, 0.0, 0.0, -scale as f32, 0.0, height]);
    content.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
    fill_color(&mut content, drawing.background);
    content.rect(0.0, 0.0, drawing.size.x as f32, drawing.size.y as f32).fill_nonzero();
    let mut forms = Vec::new();
    drawing.shapes.iter().for_each(|shape| add(&mut content, &mut forms, shape));

    let mut pdf = Pdf::new();
    pdf.catalog(CATALOG).pages(PAGES);
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let mut page = pdf.page(PAGE);
    page.media_box(Rect::new(0.0, 0.0, width, height)).parent(PAGES).contents(CONTENT);
    let mut resources = page.resources();
    resources.fonts().pair(FONT_NAME, FONT);
    if !forms.is_empty() {
        let mut objects = resources.x_objects();
        for form in 0..forms.len() {
            objects.pair(Name(form_name(form).as_bytes()), form_ref(form));
        }
    }
    resources.finish();
    page.finish();
    pdf.type1_font(FONT).base_font(Name(b"Helvetica")).encoding_predefined(Name(b"WinAnsiEncoding"));
    pdf.stream(CONTENT, &compressed(content)).filter(Filter::FlateDecode);
    let bounds = Rect::new(0.0, 0.0, drawing.size.x as f32, drawing.size.y as f32);
    for (number, form) in forms.into_iter().enumerate() {
        let data = compressed(form);
        let mut object = pdf.form_xobject(form_ref(number), &data);
        object.bbox(bounds).filter(Filter::FlateDecode);
    }
    pdf.finish()
}

/// Returns the operators of a content stream in the zlib format, as the filter `FlateDecode` reads it.
fn compressed(content: Content) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(&content.finish()).and_then(|()| encoder.finish()).expect("writing to memory does not fail")
}

/// Returns the resource name by which the page draws a form XObject.
fn form_name(form: usize) -> String {
    format!("X{form}")
}

fn form_ref(form: usize) -> Ref {
    Ref::new(FIRST_FORM + form as i32)
}

/// Adds a shape to the page content, and adds the form XObjects that the shape needs to `forms`.
fn add(content: &mut Content, forms: &mut Vec<Content>, shape: &Shape) {
    match shape {
        Shape::Polygon { corners, fill, stroke } => {
            colors(content, *fill, *stroke);
            path(content, corners);
            content.close_path();
            paint(content, *fill, *stroke);
        }
        Shape::Line { from, to, stroke } => {
            colors(content, None, Some(*stroke));
            path(content, &[*from, *to]);
            paint(content, None, Some(*stroke));
        }
        Shape::Ellipse { center, radii, fill, stroke } => {
            colors(content, *fill, *stroke);
            ellipse(content, *center, *radii);
            paint(content, *fill, *stroke);
        }
        Shape::Partition(regions) => {
            let first = forms.len();
            forms.extend([areas(regions, true), areas(regions, false)]);
            for width in SEAM_WIDTHS {
                let form = if width > 0.0 { first } else { first + 1 };
                content.set_line_width(width as f32).x_object(Name(form_name(form).as_bytes()));
            }
        }
        Shape::Text { at, text, color, size } => letters(content, *at, text, *color, *size),
    }
}

/// Returns the drawing commands for all regions, with or without outlines. An outline width of 0 would not remove the
/// outlines, because viewers draw such outlines one pixel wide.
fn areas(regions: &[PartitionRegion], with_lines: bool) -> Content {
    let mut content = Content::new();
    for PartitionRegion { contours, fill } in regions {
        let stroke = with_lines.then_some(*fill);
        fill_color(&mut content, *fill);
        if let Some([red, green, blue]) = stroke.map(|color| color.map(|code| f32::from(code) / 255.0)) {
            content.set_stroke_rgb(red, green, blue);
        }
        for contour in contours {
            path(&mut content, contour);
            content.close_path();
        }
        if with_lines {
            content.fill_even_odd_and_stroke();
        } else {
            content.fill_even_odd();
        }
    }
    content
}

fn path(content: &mut Content, corners: &[DVec2]) {
    for (number, corner) in corners.iter().enumerate() {
        let (x, y) = (corner.x as f32, corner.y as f32);
        if number == 0 {
            content.move_to(x, y);
        } else {
            content.line_to(x, y);
        }
    }
}

fn ellipse(content: &mut Content, center: DVec2, radii: DVec2) {
    let at = |x: f64, y: f64| center + radii * DVec2::new(x, y);
    let start = at(1.0, 0.0);
    content.move_to(start.x as f32, start.y as f32);
    for (x, y) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
        // The next quarter starts 90° further along the ellipse.
        let (next_x, next_y) = (-y, x);
        let first = at(x + QUARTER * next_x, y + QUARTER * next_y);
        let second = at(next_x + QUARTER * x, next_y + QUARTER * y);
        let end = at(next_x, next_y);
        let [ax, ay, bx, by, cx, cy] = [first.x, first.y, second.x, second.y, end.x, end.y].map(|v| v as f32);
        content.cubic_to(ax, ay, bx, by, cx, cy);
    }
    content.close_path();
}

/// Sets the colours and the line width of the next path. PDF does not allow these operators once a path has begun.
fn colors(content: &mut Content, fill: Option<Rgb>, stroke: Option<Stroke>) {
    if let Some(color) = fill {
        fill_color(content, color);
    }
    if let Some(Stroke { color, width }) = stroke {
        let [red, green, blue] = color.map(|code| f32::from(code) / 255.0);
        content.set_stroke_rgb(red, green, blue).set_line_width(width as f32);
    }
}

fn paint(content: &mut Content, fill: Option<Rgb>, stroke: Option<Stroke>) {
    match (fill, stroke) {
        (Some(_), Some(_)) => content.fill_even_odd_and_stroke(),
        (Some(_), None) => content.fill_even_odd(),
        (None, Some(_)) => content.stroke(),
        (None, None) => content.end_path(),
    };
}

fn fill_color(content: &mut Content, color: Rgb) {
    let [red, green, blue] = color.map(|code| f32::from(code) / 255.0);
    content.set_fill_rgb(red, green, blue);
}

/// Draws centred text in Helvetica, which every viewer has. Characters outside Latin-1 are replaced by a question mark.
fn letters(content: &mut Content, at: DVec2, text: &str, color: Rgb, size: f64) {
    /// Width of a digit in Helvetica, relative to the font size.
    const WIDTH: f64 = 0.556;
    const CAPITALS: f64 = 0.718;
    let bytes: Vec<u8> = text.chars().map(letter).collect();
    let start = at + DVec2::new(-WIDTH * bytes.len() as f64 / 2.0, CAPITALS / 2.0) * size;
    fill_color(content, color);
    content.begin_text().set_font(FONT_NAME, size as f32);
    content.set_text_matrix([1.0, 0.0, 0.0, -1.0, start.x as f32, start.y as f32]).show(Str(&bytes)).end_text();
}

fn letter(c: char) -> u8 {
    match c {
        '−' => b'-',
        ' '..='~' | '\u{a0}'..='ÿ' => c as u32 as u8,
        _ => b'?',
    }
}
