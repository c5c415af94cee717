//! Depths and ids in picture files.

use std::collections::BTreeMap;

use rasterscope_engine::image::Image;
use rasterscope_engine::image::picture::{Channel, Picture, Sample};

/// Names of the channel of depths in files with several channels, in lower case.
const DEPTH_NAMES: [&str; 2] = ["z", "depth"];

/// Reason why a picture has no usable depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnusableDepths {
    /// The picture has colours.
    #[error("it has colours, not depths")]
    Colors,
    /// All pixels have the same depth.
    #[error("all its depths are equal, so nothing can be learned from them")]
    Constant,
}

/// Returns the depths in a picture: the channel named `Z` or `depth`, or else the only channel. A grey picture of equal
/// red, green and blue counts as one channel. Integers are divided by their largest value; pixels outside the data
/// window are NaN.
///
/// # Errors
/// Fails for a picture of colours, and if all depths are equal.
pub fn depths(picture: &Picture) -> Result<Image<f32>, UnusableDepths> {
    let (width, height) = picture.size();
    let is_named = |channel: &&Channel| {
        let name = channel.name.to_lowercase();
        DEPTH_NAMES.contains(&name.rsplit('.').next().unwrap_or_default())
    };
    let named = picture.channels().iter().find(is_named);
    let colors: Vec<_> = picture.channels_of(&picture.layers()[0]).take(3).collect();
    let depth = named.unwrap_or(colors[0]);
    let is_grey =
        || (0..height).all(|y| (0..width).all(|x| colors.iter().all(|c| c.sample(x, y) == depth.sample(x, y))));
    if named.is_none() && colors.len() > 2 && !is_grey() {
        return Err(UnusableDepths::Colors);
    }
    let scaled = |sample: Sample| match sample {
        Sample::U8(code) => f64::from(code) / f64::from(u8::MAX),
        Sample::U16(code) => f64::from(code) / f64::from(u16::MAX),
        Sample::U32(code) => f64::from(code) / f64::from(u32::MAX),
        Sample::F16(_) | Sample::F32(_) => sample.value(),
    };
    let depths = Image::from_fn(width, height, |x, y| depth.sample(x, y).map_or(f64::NAN, scaled) as f32);
    let is_constant = depths.pixels().iter().all(|depth| *depth == depths.at(0, 0));
    if is_constant { Err(UnusableDepths::Constant) } else { Ok(depths) }
}

/// Returns the ids in a picture: a number for each different value, or each different colour, of its first layer.
pub fn ids(picture: &Picture) -> Image<u32> {
    let (width, height) = picture.size();
    let layer = &picture.layers()[0];
    let mut numbers: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    Image::from_fn(width, height, |x, y| {
        let value = picture.value(layer, x, y).map(f64::to_bits);
        let next = numbers.len() as u32;
        *numbers.entry(value).or_insert(next)
    })
}
