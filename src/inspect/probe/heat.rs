//! A result as a picture: bright where something changed, and a dim grey one of the scene elsewhere.

use super::ProbeResult;
use crate::image::color::luma;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// The respect in which pixels are compared.
    Heat {
        Owner = "owner", "Owner", "In how many runs another triangle won the pixel.";
        Depth = "depth", "Depth", "In how many runs another depth was stored, be it by one step.";
        Color = "color", "Colour", "In how many runs the colour was another.";
    }
}

/// The darkest part of the map is left out, so that a single change is seen on the dim picture.
const LEAST_POSITION: f64 = 0.25;

/// How bright the picture of the scene is behind the changes.
const DIM: f32 = 0.4;

/// Colour of a position on the map, from nearly none of the runs at 0 to those of the pixel that changed most often at 1.
pub fn map_color(position: f32) -> Rgba8 {
    let position = LEAST_POSITION + (1.0 - LEAST_POSITION) * f64::from(position.clamp(0.0, 1.0));
    let [r, g, b] = colorous::INFERNO.eval_continuous(position).as_array();
    [r, g, b, 255]
}

/// The picture, and the number of runs that the brightest colour stands for: that of the pixel that changed most often.
/// `None` where there is nothing to compare.
pub fn picture(result: &ProbeResult, heat: Heat) -> Option<(Image<Rgba8>, u16)> {
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
