//! Drawings as bitmaps: every shape is filled as a polygon with 4 × 4 samples per pixel.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::{Drawing, Rgb, Shape, Stroke};
use crate::flat2d::polygon::{Corners, Filling, InsideRule, SamplePoint, fill};
use crate::image::{Image, Rgba8};

/// Samples of a pixel each way.
const SAMPLES: u32 = 4;

/// Corners of the polygon that stands for an ellipse.
const CORNERS: u32 = 96;

/// Sides of the polygon that stands for the half circle at the end of a line.
const CAP_SIDES: u32 = 8;

/// A bitmap with `scale` pixels per unit, at least one pixel. Words are left out: there is no font here.
pub fn bitmap(drawing: &Drawing, scale: f64) -> Image<Rgba8> {
    let [width, height] = [drawing.size.x, drawing.size.y].map(|side| (side * scale).round().max(1.0) as u32);
    let [r, g, b] = drawing.background;
    let mut image = Image::filled(width, height, [r, g, b, 255]);
    for shape in &drawing.shapes {
        match shape {
            Shape::Polygon { corners, fill, stroke } => {
                closed(&mut image, std::slice::from_ref(corners), corners, (*fill, *stroke), scale);
            }
            Shape::Line { from, to, stroke } => line(&mut image, *from, *to, *stroke, scale),
            Shape::Ellipse { center, radii, fill, stroke } => {
                let at = |i: u32| *center + *radii * DVec2::from_angle(f64::from(i) / f64::from(CORNERS) * TAU);
                let corners: Vec<_> = (0..CORNERS).map(at).collect();
                closed(&mut image, std::slice::from_ref(&corners), &corners, (*fill, *stroke), scale);
            }
            Shape::Text { .. } => {}
        }
    }
    image
}

fn closed(
    image: &mut Image<Rgba8>,
    contours: &[Vec<DVec2>],
    outline: &[DVec2],
    (inside, stroke): (Option<Rgb>, Option<Stroke>),
    scale: f64,
) {
    if let Some(color) = inside {
        cover(image, contours, color, scale);
    }
    if let Some(stroke) = stroke {
        let sides = outline.iter().zip(outline.iter().cycle().skip(1));
        sides.for_each(|(from, to)| line(image, *from, *to, stroke, scale));
    }
}

/// A line with round ends, of half circles as wide as it is.
fn line(image: &mut Image<Rgba8>, from: DVec2, to: DVec2, Stroke { color, width }: Stroke, scale: f64) {
    let along = (to - from).try_normalize().unwrap_or(DVec2::X) * width / 2.0;
    let cap = |end: DVec2, outwards: DVec2| {
        let turn = |side: u32| DVec2::from_angle(f64::from(side) / f64::from(CAP_SIDES) * PI - FRAC_PI_2);
        (0..=CAP_SIDES).map(move |side| end + outwards.rotate(turn(side)))
    };
    cover(image, &[cap(to, along).chain(cap(from, -along)).collect()], color, scale);
}

/// Mixes a colour into the pixels by the share of their samples that lie inside.
fn cover(image: &mut Image<Rgba8>, contours: &[Vec<DVec2>], color: Rgb, scale: f64) {
    let scaled = |corner: &DVec2| *corner * scale * f64::from(SAMPLES);
    let contours: Vec<Vec<_>> = contours.iter().map(|contour| contour.iter().map(scaled).collect()).collect();
    let (width, height) = (image.width() * SAMPLES, image.height() * SAMPLES);
    let filling =
        Filling { rule: InsideRule::EvenOdd, corners: Corners::AsGiven, sample: SamplePoint::Center, width, height };
    let mut counts = vec![0_u32; image.width() as usize];
    let mut row = None;
    for span in fill(&contours, filling) {
        if row.is_some_and(|row| row != span.y / SAMPLES) {
            mix(image, row.unwrap_or(0), &mut counts, color);
        }
        row = Some(span.y / SAMPLES);
        for x in span.x0 / SAMPLES..span.x1.div_ceil(SAMPLES) {
            let inside = span.x1.min((x + 1) * SAMPLES) - span.x0.max(x * SAMPLES);
            counts[x as usize] += inside;
        }
    }
    if let Some(row) = row {
        mix(image, row, &mut counts, color);
    }
}

/// Mixes one row, and clears its counts.
fn mix(image: &mut Image<Rgba8>, row: u32, counts: &mut [u32], color: Rgb) {
    const WHOLE: u32 = SAMPLES * SAMPLES;
    for (x, count) in counts.iter_mut().enumerate().filter(|(_, count)| **count > 0) {
        let below = image.at(x as u32, row);
        let mixed = |channel: usize| {
            ((u32::from(below[channel]) * (WHOLE - *count) + u32::from(color[channel]) * *count + WHOLE / 2) / WHOLE)
                as u8
        };
        image.set(x as u32, row, [mixed(0), mixed(1), mixed(2), 255]);
        *count = 0;
    }
}
