//! Heat map of a probe result: bright colours on changed pixels, and a dim grey picture of the scene elsewhere.

use super::ProbeResult;
use crate::image::color::luma;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Aspect in which the stability probe compares pixels.
    Heat {
        Owner = "owner", "Owner", "Number of runs in which a different triangle won the pixel.";
        Depth = "depth", "Depth", "Number of runs in which a different depth was stored, even by one step.";
        Color = "color", "Colour", "Number of runs in which the colour differed.";
    }
}

/// Start of the used part of the colour map, in [0, 1]. It excludes the darkest part, so that a single change is
/// visible on the dim picture.
const MIN_POSITION: f64 = 0.25;

/// Brightness factor of the grey picture of the scene, which is shown on unchanged pixels.
const DIM: f32 = 0.4;

/// Returns the colour-map colour at `position`: 0 for almost no changed runs, 1 for the pixel that changed most often.
pub(crate) fn map_color(position: f32) -> Rgba8 {
    let position = MIN_POSITION + (1.0 - MIN_POSITION) * f64::from(position.clamp(0.0, 1.0));
    let [r, g, b] = colorous::INFERNO.eval_continuous(position).as_array();
    [r, g, b, 255]
}

/// Returns the heat map, and the number of changed runs that the brightest colour represents: the maximum over all
/// pixels. `None` if the aspect was not compared.
pub(crate) fn picture(result: &ProbeResult, heat: Heat) -> Option<(Image<Rgba8>, u16)> {
    let counts = result.counts(heat)?;
    let most = counts.pixels().iter().copied().max().unwrap_or(0);
    let pixel = |x, y| match counts.at(x, y) {
        0 => {
            let grey = (luma(result.picture.at(x, y)) * DIM) as u8;
            [grey, grey, grey, 255]
        }
        count => map_color(f32::from(count) / f32::from(most.max(1))),
    };
    Some((Image::from_fn(counts.width(), counts.height(), pixel), most))
}
