//! Pictures from files with their exact samples: channels of 8, 16 or 32 bits, integers or floats, in named layers.
//!
//! Reading never quantises a sample. Integer samples of colours are sRGB codes; float samples are linear light. Colour
//! profiles, gamma chunks and chromaticities are ignored.

pub(super) mod exr;

pub(super) mod formats;

pub(super) mod pfm;

pub(super) mod standard;

use std::fmt;

use half::f16;

use super::color::{self, Tables};
use super::{Image, Rgba8};

pub(crate) use exr::write::{RenderAttributes, encode as encode_exr};
pub use formats::{names as format_names, suffixes};

/// Largest 8-bit code, to which the codes of all integer samples are scaled.
const MAX_CODE: f64 = 255.0;

/// Samples of one channel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Samples {
    /// 8-bit unsigned integers.
    U8(Vec<u8>),
    /// 16-bit unsigned integers.
    U16(Vec<u16>),
    /// 32-bit unsigned integers, usually ids.
    U32(Vec<u32>),
    /// 16-bit floats.
    F16(Vec<f16>),
    /// 32-bit floats.
    F32(Vec<f32>),
}

impl Samples {
    fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::F16(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    fn at(&self, index: usize) -> Sample {
        match self {
            Self::U8(values) => Sample::U8(values[index]),
            Self::U16(values) => Sample::U16(values[index]),
            Self::U32(values) => Sample::U32(values[index]),
            Self::F16(values) => Sample::F16(values[index]),
            Self::F32(values) => Sample::F32(values[index]),
        }
    }

    /// Returns the type of the samples, such as `16-bit float`.
    fn kind(&self) -> &'static str {
        match self {
            Self::U8(_) => "8-bit integer",
            Self::U16(_) => "16-bit integer",
            Self::U32(_) => "32-bit integer",
            Self::F16(_) => "16-bit float",
            Self::F32(_) => "32-bit float",
        }
    }

    fn is_float(&self) -> bool {
        matches!(self, Self::F16(_) | Self::F32(_))
    }
}

/// Value of one channel at one pixel, exactly as the file stores it. [`fmt::Display`] writes the shortest decimal number
/// that identifies the value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    /// 8-bit unsigned integer.
    U8(u8),
    /// 16-bit unsigned integer.
    U16(u16),
    /// 32-bit unsigned integer.
    U32(u32),
    /// 16-bit float.
    F16(f16),
    /// 32-bit float.
    F32(f32),
}

impl Sample {
    /// Returns the value as an `f64`, which represents every sample exactly.
    pub fn value(self) -> f64 {
        match self {
            Self::U8(value) => value.into(),
            Self::U16(value) => value.into(),
            Self::U32(value) => value.into(),
            Self::F16(value) => value.into(),
            Self::F32(value) => value.into(),
        }
    }

    /// Returns the value on the scale of metrics: 8-bit integers as they are, 16-bit integers divided by 257, so that
    /// white is 255, and other samples as they are.
    fn scaled(self) -> f64 {
        match self {
            Self::U16(value) => f64::from(value) / 257.0,
            other => other.value(),
        }
    }
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::U8(value) => value.fmt(f),
            Self::U16(value) => value.fmt(f),
            Self::U32(value) => value.fmt(f),
            Self::F16(value) => value.to_f32().fmt(f),
            Self::F32(value) => value.fmt(f),
        }
    }
}

/// Rectangle of a channel's samples in the picture. It may extend beyond the picture or cover only a part of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DataWindow {
    /// Column of the first sample, relative to the picture's first column.
    pub(crate) left: i32,
    /// Row of the first sample, relative to the picture's first row.
    pub(crate) top: i32,
    /// Width in pixels.
    pub(crate) width: u32,
    /// Height in pixels.
    pub(crate) height: u32,
}

/// Channel of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name with the name of the layer, such as `R` or `diffuse.R`.
    pub name: String,
    samples: Samples,
    window: DataWindow,
}

impl Channel {
    /// Creates a channel. Panics if the number of samples is not the number of pixels in the window.
    pub(crate) fn new(name: String, samples: Samples, window: DataWindow) -> Self {
        assert_eq!(samples.len(), window.width as usize * window.height as usize, "sample count of {name}");
        Self { name, samples, window }
    }

    /// Returns the type of the samples, such as `16-bit float`.
    pub fn kind(&self) -> &'static str {
        self.samples.kind()
    }

    /// Returns the sample at a pixel of the picture, or `None` outside the data window.
    pub fn sample(&self, x: u32, y: u32) -> Option<Sample> {
        let DataWindow { left, top, width, height } = self.window;
        let (column, row) = (i64::from(x) - i64::from(left), i64::from(y) - i64::from(top));
        let is_inside = (0..i64::from(width)).contains(&column) && (0..i64::from(height)).contains(&row);
        is_inside.then(|| self.samples.at(row as usize * width as usize + column as usize))
    }

    fn is_data_window_whole(&self, (width, height): (u32, u32)) -> bool {
        self.window == DataWindow { left: 0, top: 0, width, height }
    }
}

/// Channels of a picture that are shown and compared together: the colour channels of a layer, or one other channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layer {
    /// Name: the name of the layer in the file, or the names of the channels if the file does not name the layer.
    pub name: String,
    /// Indices of the channels: one of grey, three of red, green and blue, or one of other data.
    channels: Vec<usize>,
    /// Index of the channel of opacity.
    alpha: Option<usize>,
    /// Whether the channels are colours, in contrast to data such as depths and ids.
    pub is_color: bool,
}

/// Picture from a file, with the exact samples of every channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    format: &'static str,
    width: u32,
    height: u32,
    channels: Vec<Channel>,
    layers: Vec<Layer>,
}

impl Picture {
    /// Creates a picture of `size` pixels from the channels of a file in the format named `format`. Panics if there is
    /// no channel.
    pub(crate) fn new(format: &'static str, (width, height): (u32, u32), channels: Vec<Channel>) -> Self {
        assert!(!channels.is_empty(), "a picture without channels");
        let layers = layers(&channels);
        Self { format, width, height, channels, layers }
    }

    /// Creates a picture of the red, green and blue codes of an image. Panics if the image is empty.
    pub fn of_codes(image: &Image<Rgba8>) -> Self {
        let (width, height) = image.size();
        let window = DataWindow { left: 0, top: 0, width, height };
        let channel = |(index, name): (usize, &str)| {
            let codes = image.pixels().iter().map(|pixel| pixel[index]).collect();
            Channel::new(name.to_owned(), Samples::U8(codes), window)
        };
        Self::new("drawing", image.size(), ["R", "G", "B"].into_iter().enumerate().map(channel).collect())
    }

    /// Returns the name of the file's format, such as `OpenEXR`.
    pub fn format(&self) -> &'static str {
        self.format
    }

    /// Returns the width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Returns all channels, in the order of the file.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Returns the layers, colours first. There is at least one.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Returns the channels of a layer, with opacity last.
    pub fn channels_of<'a>(&'a self, layer: &'a Layer) -> impl Iterator<Item = &'a Channel> {
        layer.channels.iter().chain(&layer.alpha).map(|index| &self.channels[*index])
    }

    /// Returns whether the samples of a layer are floats, which are linear light if the layer is a colour.
    pub fn is_float(&self, layer: &Layer) -> bool {
        layer.channels.iter().any(|index| self.channels[*index].samples.is_float())
    }

    /// Returns the values of a layer at a pixel: red, green and blue, or one value three times. Integers of colours are on
    /// a scale on which white is 255; all other values are those of the file. Values outside the data window are 0.
    pub fn value(&self, layer: &Layer, x: u32, y: u32) -> [f64; 3] {
        let sample = |index: usize| self.channels[index].sample(x, y);
        let scaled = |index: usize| sample(index).map_or(0.0, Sample::scaled);
        match &layer.channels[..] {
            [r, g, b] => [scaled(*r), scaled(*g), scaled(*b)],
            [one] if layer.is_color => [scaled(*one); 3],
            others => [sample(others[0]).map_or(0.0, Sample::value); 3],
        }
    }

    /// Returns the opacity of a layer at a pixel, from 0 to 1.
    fn opacity(&self, layer: &Layer, x: u32, y: u32) -> f64 {
        let Some(channel) = layer.alpha.map(|index| &self.channels[index]) else { return 1.0 };
        let sample = channel.sample(x, y).map_or(0.0, Sample::scaled);
        if channel.samples.is_float() { sample } else { sample / MAX_CODE }
    }

    /// Returns the first layer as sRGB codes with straight alpha. Integer samples are rounded to 8 bits; linear light is
    /// encoded after clamping to [0, 1].
    pub(crate) fn to_rgba8(&self) -> Image<Rgba8> {
        let layer = &self.layers[0];
        let is_linear = self.is_float(layer);
        let tables = Tables::get();
        Image::from_fn(self.width, self.height, |x, y| {
            let code = |value: f64| match is_linear {
                true => tables.encode(value as f32),
                false => color::quantize((value / MAX_CODE) as f32),
            };
            let [r, g, b] = self.value(layer, x, y).map(code);
            [r, g, b, color::quantize(self.opacity(layer, x, y) as f32)]
        })
    }

    /// Returns the format, size and channels in words, such as `PNG, 64 × 36 px, R G B (8-bit integer)`.
    pub fn description(&self) -> String {
        let mut kinds: Vec<(&str, Vec<&str>)> = Vec::new();
        for channel in &self.channels {
            match kinds.iter_mut().find(|(kind, _)| *kind == channel.kind()) {
                Some((_, names)) => names.push(&channel.name),
                None => kinds.push((channel.kind(), vec![&channel.name])),
            }
        }
        let kinds: Vec<_> = kinds.iter().map(|(kind, names)| format!("{} ({kind})", names.join(" "))).collect();
        let size = self.size();
        let window = self.channels.iter().find(|channel| !channel.is_data_window_whole(size));
        let window = window.map_or_else(String::new, |Channel { window, .. }| {
            let DataWindow { left, top, width, height } = window;
            format!(", data window {width} × {height} px at {left}, {top}")
        });
        format!("{}, {} × {} px, {}{window}", self.format, size.0, size.1, kinds.join(", "))
    }
}

/// Groups channels into layers: the channels R, G and B, or Y without X, of each layer of the file with their alpha, and
/// every other channel by itself. Colours come first.
fn layers(channels: &[Channel]) -> Vec<Layer> {
    let split = |channel: &'_ Channel| match channel.name.rfind('.') {
        Some(dot) => (channel.name[..dot].to_owned(), channel.name[dot + 1..].to_owned()),
        None => (String::new(), channel.name.clone()),
    };
    let names: Vec<(String, String)> = channels.iter().map(split).collect();
    let mut prefixes: Vec<&str> = Vec::new();
    for (prefix, _) in &names {
        if !prefixes.contains(&prefix.as_str()) {
            prefixes.push(prefix);
        }
    }
    prefixes.sort_by_key(|prefix| !prefix.is_empty());
    let (mut colors, mut others) = (Vec::new(), Vec::new());
    for prefix in prefixes {
        let find = |wanted: &str| {
            let is_it = |(of, name): &(String, String)| of == prefix && name.eq_ignore_ascii_case(wanted);
            // Colours of different windows or types cannot be shown together.
            names.iter().position(is_it).filter(|index| !matches!(channels[*index].samples, Samples::U32(_)))
        };
        let color = [find("R"), find("G"), find("B")].into_iter().collect::<Option<Vec<_>>>();
        // Besides X, Y is a coordinate and not a luminance.
        let luminance = || find("Y").filter(|_| find("X").is_none());
        let color = color.or_else(|| luminance().map(|grey| vec![grey]));
        let alpha = find("A").filter(|_| color.is_some());
        let members: Vec<usize> = color.iter().flatten().copied().chain(alpha).collect();
        if let Some(color) = color {
            let own: String = members.iter().map(|index| names[*index].1.as_str()).collect();
            let name = if prefix.is_empty() { own } else { prefix.to_owned() };
            colors.push(Layer { name, channels: color, alpha, is_color: true });
        }
        for (index, (of, _)) in names.iter().enumerate() {
            if of == prefix && !members.contains(&index) {
                let name = channels[index].name.clone();
                others.push(Layer { name, channels: vec![index], alpha: None, is_color: false });
            }
        }
    }
    colors.into_iter().chain(others).collect()
}

#[cfg(test)]
mod tests;
