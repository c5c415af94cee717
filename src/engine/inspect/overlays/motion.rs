//! Overlay of motion vectors as lines from the pixels of a grid to where their surfaces were in the preceding frame.

use super::sheet::{PixelKind, Sheet, SheetLegend, Total};
use super::{Overlay, OverlayContext};
use crate::image::Image;
use crate::pipeline::wireframe::line_pixels;

/// Distance between the pixels whose vectors are drawn, in px of the full picture.
const SPACING_PX: usize = 16;

const KINDS: [PixelKind; 2] = [
    PixelKind { name: "motion since the preceding frame", color: [255, 208, 64, 255], striped: false },
    PixelKind { name: "disoccluded", color: [255, 90, 70, 255], striped: false },
];

/// Draws the vectors of the drawn pixels on a grid. Disoccluded pixels have a colour of their own.
pub(super) fn vectors(context: &OverlayContext<'_>) -> Sheet {
    let OverlayContext { scene, recipe, frame, .. } = context;
    let size = frame.image().size();
    let Some(motion) = frame.motion(scene, recipe) else {
        let why = if frame.before.is_none() { "scene and camera are still" } else { "the depth test is off" };
        return Sheet::absent(Overlay::Motion, size, why);
    };
    let scale = [size.0 as f32 / frame.raster.width as f32, size.1 as f32 / frame.raster.height as f32];
    let mut values = Image::filled(size.0, size.1, f32::NAN);
    let (mut lines, mut longest, mut disoccluded) = (Vec::new(), 0.0_f32, 0_u32);
    let every = |length: u32| (SPACING_PX as u32 / 2..length).step_by(SPACING_PX);
    for (x, y) in every(size.1).flat_map(|y| every(size.0).map(move |x| (x, y))) {
        let Some((column, row)) = frame.sample_at(x, y) else { continue };
        let at = frame.drawn.grid.pixel(column, row);
        let vector = motion.vector_px(at.0, at.1);
        let end = [x as f32 + 0.5 + vector[0] * scale[0], y as f32 + 0.5 + vector[1] * scale[1]];
        let is_disoccluded = motion.is_disoccluded(at.0, at.1);
        disoccluded += u32::from(is_disoccluded);
        if vector == [0.0; 2] || end.iter().any(|px| !px.is_finite()) {
            continue;
        }
        longest = longest.max((end[0] - x as f32 - 0.5).hypot(end[1] - y as f32 - 0.5));
        let start = [x as f32 + 0.5, y as f32 + 0.5];
        let ends = [start, end].map(|[x, y]| (f64::from(x), f64::from(y)));
        let kind = if is_disoccluded { 1.0 } else { 0.0 };
        line_pixels(ends[0], ends[1], size).for_each(|(x, y)| values.set(x, y, kind));
        lines.push([start, end]);
    }
    let totals = vec![
        Total { name: "vectors", number: lines.len() as f64, unit: "" },
        Total { name: "longest", number: (f64::from(longest) * 100.0).round() / 100.0, unit: "px" },
        Total { name: "disoccluded", number: disoccluded.into(), unit: "" },
    ];
    Sheet { lines, ..Sheet::new(Overlay::Motion, values, SheetLegend::Kinds(&KINDS), totals) }
}
