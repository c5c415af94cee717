//! Heat map of a probe's findings: bright colours on changed pixels, and a dim grey picture of the scene elsewhere.

use super::{Heat, ProbeFindings};
use crate::image::color::luma;
use crate::image::{Image, Rgba8};

/// Colour-map position of the smallest count, in [0, 1]. Excluding the darkest part of the map keeps a single change
/// visible on the dim picture.
const MIN_POSITION: f64 = 0.25;

/// Brightness factor of the grey picture of the scene, which is shown on unchanged pixels.
const DIM: f32 = 0.4;

/// Returns the heat-map colour of a pixel. `position` is the number of runs in which the pixel changed, as a fraction
/// of the maximum over all pixels.
pub fn map_color(position: f32) -> Rgba8 {
    let position = MIN_POSITION + (1.0 - MIN_POSITION) * f64::from(position.clamp(0.0, 1.0));
    let [r, g, b] = colorous::INFERNO.eval_continuous(position).as_array();
    [r, g, b, 255]
}

/// Returns the heat map, and the number of runs that its brightest colour represents: the maximum over all pixels.
/// Returns `None` if the aspect was not compared.
pub fn picture(findings: &ProbeFindings, heat: Heat) -> Option<(Image<Rgba8>, u16)> {
    let counts = findings.counts(heat)?;
    let most = counts.pixels().iter().copied().max().unwrap_or(0);
    let pixel = |x, y| match counts.at(x, y) {
        0 => {
            let grey = (luma(findings.picture.at(x, y)) * DIM) as u8;
            [grey, grey, grey, 255]
        }
        count => map_color(f32::from(count) / f32::from(most.max(1))),
    };
    Some((Image::from_fn(counts.width(), counts.height(), pixel), most))
}
