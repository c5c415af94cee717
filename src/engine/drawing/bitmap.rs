//! Drawings as bitmaps: every shape except text is filled as a polygon, with 4 × 4 samples per pixel.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::{Drawing, PartitionRegion, Rgb, Shape, Stroke};
use crate::flat2d::PixelSpan;
use crate::flat2d::polygon::{Corners, FillParameters, InsideRule, SamplePoint, fill};
use crate::image::{Image, Rgba8};

/// Number of samples per pixel along each axis.
const SAMPLES: u32 = 4;

/// Number of samples per pixel.
const WHOLE: u32 = SAMPLES * SAMPLES;

/// Number of corners of the polygon that approximates an ellipse.
const CORNERS: u32 = 96;

/// Number of sides of the polygon that approximates the round cap at an endpoint of a line.
const CAP_SIDES: u32 = 8;

/// Renders a drawing as a bitmap with `scale` pixels per unit, at least one pixel wide and high. Text is omitted,
/// because no font is available.
pub(crate) fn bitmap(drawing: &Drawing, scale: f64) -> Image<Rgba8> {
    let [width, height] = [drawing.size.x, drawing.size.y].map(|side| (side * scale).round().max(1.0) as u32);
    let [r, g, b] = drawing.background;
    let mut image = Image::filled(width, height, [r, g, b, 255]);
    for shape in &drawing.shapes {
        match shape {
            Shape::Polygon { corners, fill, stroke } => {
                closed(&mut image, corners, *fill, *stroke, scale);
            }
            Shape::Line { from, to, stroke } => line(&mut image, *from, *to, *stroke, scale),
            Shape::Ellipse { center, radii, fill, stroke } => {
                let at = |i: u32| *center + *radii * DVec2::from_angle(f64::from(i) / f64::from(CORNERS) * TAU);
                let corners: Vec<_> = (0..CORNERS).map(at).collect();
                closed(&mut image, &corners, *fill, *stroke, scale);
            }
            Shape::Text { .. } => {}
            Shape::Partition(regions) => partition(&mut image, regions, scale),
        }
    }
    image
}

/// Draws a polygon, with or without a fill colour and a stroke.
fn closed(image: &mut Image<Rgba8>, corners: &[DVec2], fill: Option<Rgb>, stroke: Option<Stroke>, scale: f64) {
    if let Some(color) = fill {
        cover(image, &[corners], color, scale);
    }
    if let Some(stroke) = stroke {
        let sides = corners.iter().zip(corners.iter().cycle().skip(1));
        sides.for_each(|(from, to)| line(image, *from, *to, stroke, scale));
    }
}

/// Draws a line with round caps: half circles whose diameter is the line width.
fn line(image: &mut Image<Rgba8>, from: DVec2, to: DVec2, Stroke { color, width }: Stroke, scale: f64) {
    let along = (to - from).try_normalize().unwrap_or(DVec2::X) * width / 2.0;
    let cap = |end: DVec2, outwards: DVec2| {
        let turn = |side: u32| DVec2::from_angle(f64::from(side) / f64::from(CAP_SIDES) * PI - FRAC_PI_2);
        (0..=CAP_SIDES).map(move |side| end + outwards.rotate(turn(side)))
    };
    let outline: Vec<_> = cap(to, along).chain(cap(from, -along)).collect();
    cover(image, &[&outline], color, scale);
}

/// Returns the spans of samples inside the contours, by the even-odd rule. Spans are in units of samples, [`SAMPLES`]
/// per pixel and axis.
fn samples_inside<C: AsRef<[DVec2]>>(
    contours: &[C],
    (width, height): (u32, u32),
    scale: f64,
) -> impl Iterator<Item = PixelSpan> + use<C> {
    let scaled = |corner: &DVec2| *corner * scale * f64::from(SAMPLES);
    let contours: Vec<Vec<_>> = contours.iter().map(|contour| contour.as_ref().iter().map(scaled).collect()).collect();
    let (width, height) = (width * SAMPLES, height * SAMPLES);
    let filling = FillParameters {
        rule: InsideRule::EvenOdd,
        corners: Corners::AsGiven,
        sample: SamplePoint::Center,
        width,
        height,
    };
    fill(&contours, filling)
}

/// Returns the pixel columns that a span of samples overlaps. Each column comes with the number of its samples that lie
/// in the span.
fn counts_of(span: PixelSpan) -> impl Iterator<Item = (usize, u32)> {
    let pixels = span.x0 / SAMPLES..span.x1.div_ceil(SAMPLES);
    pixels.map(move |x| (x as usize, span.x1.min((x + 1) * SAMPLES) - span.x0.max(x * SAMPLES)))
}

/// Draws the regions of a partition. Each pixel becomes the mean of the regions' colours, weighted by the fraction of
/// its samples in each region. Every sample lies in at most one region, so the background never shows between adjacent
/// regions, in any order of the regions.
fn partition(image: &mut Image<Rgba8>, regions: &[PartitionRegion], scale: f64) {
    let width = image.width() as usize;
    let mut sums = vec![([0_u32; 3], 0_u32); image.pixels().len()];
    for PartitionRegion { contours, fill } in regions {
        for span in samples_inside(contours, image.size(), scale) {
            for (x, inside) in counts_of(span) {
                let (codes, count) = &mut sums[(span.y / SAMPLES) as usize * width + x];
                codes.iter_mut().zip(fill).for_each(|(sum, code)| *sum += u32::from(*code) * inside);
                *count += inside;
            }
        }
    }
    for (pixel, (codes, count)) in image.pixels_mut().iter_mut().zip(sums) {
        let below = WHOLE.saturating_sub(count);
        for (channel, sum) in codes.into_iter().enumerate() {
            let sum = sum + u32::from(pixel[channel]) * below;
            pixel[channel] = ((sum + (count + below) / 2) / (count + below)) as u8;
        }
    }
}

/// Blends a colour into each pixel, weighted by the fraction of its samples inside the contours.
fn cover(image: &mut Image<Rgba8>, contours: &[&[DVec2]], color: Rgb, scale: f64) {
    let samples = samples_inside(contours, image.size(), scale);
    let mut counts = vec![0_u32; image.width() as usize];
    let mut row = None;
    for span in samples {
        if row.is_some_and(|row| row != span.y / SAMPLES) {
            mix(image, row.unwrap_or(0), &mut counts, color);
        }
        row = Some(span.y / SAMPLES);
        counts_of(span).for_each(|(x, inside)| counts[x] += inside);
    }
    if let Some(row) = row {
        mix(image, row, &mut counts, color);
    }
}

/// Blends a colour into each pixel of a row, weighted by the number of covered samples that `counts` holds for the
/// pixel. Then clears `counts`.
fn mix(image: &mut Image<Rgba8>, row: u32, counts: &mut [u32], color: Rgb) {
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
