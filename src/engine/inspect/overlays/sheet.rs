//! Result of one overlay for one frame: its value at every pixel, the legend of its colours, and its totals.

use super::Overlay;
use crate::image::{Image, Rgba8};
use crate::inspect::display::ColorMap;
use crate::inspect::view::Range;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::wireframe::line_color;

/// A kind of pixel in the legend of an overlay. Its index in the legend is the value of its pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelKind {
    /// Display name of the kind, shown in the legend.
    pub name: &'static str,
    /// Colour of pixels of the kind, in sRGB codes.
    pub color: Rgba8,
    /// Whether pixels of the kind are striped, so that the picture below remains readable.
    pub(crate) striped: bool,
}

/// Mapping of an overlay's numbers to colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorScale {
    /// Range of numbers that the colour map spans.
    pub(crate) range: Range,
    /// Whether the scale is logarithmic.
    pub(crate) logarithmic: bool,
    /// Colour map of the scale.
    pub(crate) map: ColorMap,
    /// Whether the colour map is reversed.
    pub(crate) reversed: bool,
    /// Unit displayed after numbers.
    pub(crate) unit: &'static str,
}

impl ColorScale {
    /// Returns the position of a number on the colour map, in [0, 1].
    pub(crate) fn position(&self, number: f32) -> f32 {
        let position = if self.logarithmic {
            let Range { low, high } = self.range;
            Range { low: low.ln(), high: high.ln() }.position(number.max(low).ln())
        } else {
            self.range.position(number)
        };
        if self.reversed { 1.0 - position } else { position }
    }

    /// Returns the number at a position along the scale. Position 0 is the low end of the range and 1 is the high end,
    /// even if the colour map is reversed.
    pub fn number_at(&self, share: f32) -> f32 {
        let Range { low, high } = self.range;
        if self.logarithmic { (low.ln() + (high.ln() - low.ln()) * share).exp() } else { low + (high - low) * share }
    }

    /// Returns the colour of a number on the scale.
    pub fn color(&self, number: f32) -> Rgba8 {
        self.map.color(self.position(number))
    }
}

/// Legend of an overlay's colours.
#[derive(Clone, Debug, PartialEq)]
pub enum SheetLegend {
    /// Lines that contrast with the picture below, light on dark and dark on light.
    Lines,
    /// Kinds of pixels, each with its own colour.
    Kinds(&'static [PixelKind]),
    /// Numbers on a colour scale.
    Scale(ColorScale),
}

/// A total of an overlay's values over the whole picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Total {
    /// Display name of the total.
    pub name: &'static str,
    /// Value of the total, in `unit`.
    pub number: f64,
    /// Unit displayed after `number`; may be empty.
    pub unit: &'static str,
}

/// Result of computing an overlay for a frame.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Overlay that the sheet shows.
    pub overlay: Overlay,
    /// Value at each pixel of the full picture: a number, the index of a kind, or 1 on a line; NaN if there is none.
    pub(crate) values: Image<f32>,
    /// Count of each kind at each pixel of the full picture. Empty unless a pixel can have several kinds; such a pixel
    /// shows the most frequent one.
    pub(crate) counts: Vec<Image<f32>>,
    /// Legend of the colours.
    pub key: SheetLegend,
    /// Totals of the overlay over all drawn samples.
    pub totals: Vec<Total>,
    /// Lines in px, for overlays that consist of lines: three edges per triangle, or normals.
    pub lines: Vec<[[f32; 2]; 2]>,
    /// Length of normals as a fraction of the diagonal of the scene's bounding box; `None` for other overlays.
    pub(crate) length: Option<f32>,
    /// Reason why the sheet has no values; `None` if it has values.
    pub absence: Option<String>,
}

/// Period of the stripes along both axes, in px.
const STRIPES: u32 = 6;

/// Relative opacity of the gaps between stripes. It is above 0, so that a single pixel is always visible.
const GAP_STRENGTH: f32 = 0.3;

impl Sheet {
    /// Creates a sheet with values, a legend and totals.
    pub(super) fn new(overlay: Overlay, values: Image<f32>, key: SheetLegend, totals: Vec<Total>) -> Self {
        Self { overlay, values, counts: Vec::new(), key, totals, lines: Vec::new(), length: None, absence: None }
    }

    /// Creates a sheet without values, with the reason for their absence.
    pub(super) fn absent(overlay: Overlay, (width, height): (u32, u32), why: impl Into<String>) -> Self {
        let values = Image::filled(width, height, f32::NAN);
        Self { absence: Some(why.into()), ..Self::new(overlay, values, SheetLegend::Lines, Vec::new()) }
    }

    /// Returns the overlay's colour at a pixel and its relative opacity in [0, 1]; `None` without a value. `below` is
    /// the colour of the picture below.
    fn color(&self, x: u32, y: u32, below: Rgba8) -> Option<(Rgba8, f32)> {
        let value = self.values.at(x, y);
        if value.is_nan() {
            return None;
        }
        match &self.key {
            SheetLegend::Lines => Some((line_color(below), 1.0)),
            SheetLegend::Scale(scale) => Some((scale.color(value), 1.0)),
            SheetLegend::Kinds(kinds) => {
                let kind = kinds.get(value as usize)?;
                let in_gap = kind.striped && (x + y) % STRIPES >= STRIPES / 2;
                Some((kind.color, if in_gap { GAP_STRENGTH } else { 1.0 }))
            }
        }
    }

    /// Returns the colour of the lines; `None` if they contrast with the picture below.
    pub fn line_color(&self) -> Option<Rgba8> {
        match &self.key {
            SheetLegend::Kinds([kind]) => Some(kind.color),
            _ => None,
        }
    }

    /// Returns the value at a pixel as text; `None` if the pixel has no value.
    pub fn text(&self, x: u32, y: u32) -> Option<String> {
        let value = self.values.get(x, y).filter(|value| !value.is_nan())?;
        match &self.key {
            SheetLegend::Lines => Some("an edge".to_owned()),
            SheetLegend::Kinds(kinds) if self.counts.is_empty() => {
                kinds.get(value as usize).map(|kind| kind.name.to_owned())
            }
            SheetLegend::Kinds(kinds) => {
                let counted = kinds.iter().zip(&self.counts).map(|(kind, counts)| (kind.name, counts.at(x, y)));
                let words: Vec<_> =
                    counted.filter(|(_, count)| *count > 0.0).map(|(name, count)| format!("{name} {count}")).collect();
                Some(words.join(", "))
            }
            SheetLegend::Scale(scale) => Some(number_with_unit(value, scale.unit)),
        }
    }

    /// Returns the next pixel with a value after `from` in reading order, or the previous one if not `forwards`. Wraps
    /// around at both ends of the picture.
    pub fn next_pixel(&self, from: Option<(u32, u32)>, forwards: bool) -> Option<(u32, u32)> {
        let (width, height) = self.values.size();
        let count = u64::from(width) * u64::from(height);
        let start = from.map(|(x, y)| u64::from(y) * u64::from(width) + u64::from(x));
        let place = |step: u64| match (start, forwards) {
            (Some(start), true) => (start + step) % count,
            (Some(start), false) => (start + count - step) % count,
            (None, true) => step - 1,
            (None, false) => count - step,
        };
        let pixel = |place: u64| ((place % u64::from(width)) as u32, (place / u64::from(width)) as u32);
        (1..=count).map(|step| pixel(place(step))).find(|(x, y)| !self.values.at(*x, *y).is_nan())
    }
}

/// Formats a number with its unit: integers exactly, others with about four significant digits.
fn number_with_unit(value: f32, unit: &str) -> String {
    match value.abs() {
        1.0 => format!("{value} {}", unit.trim_end_matches('s')),
        size if value.fract() == 0.0 && size < 1e7 => format!("{value} {unit}"),
        size if size >= 1000.0 => format!("{value:.0} {unit}"),
        size if size >= 0.01 => format!("{value:.4} {unit}"),
        _ => format!("{value:.3e} {unit}"),
    }
}

/// Composes sheets over a picture, bottom to top, each with an opacity in [0, 1].
pub fn compose<'a>(base: &Image<Rgba8>, layers: impl IntoIterator<Item = (&'a Sheet, f32)>) -> Image<Rgba8> {
    let mut picture = base.clone();
    let (width, height) = picture.size();
    for (sheet, opacity) in layers.into_iter().filter(|(sheet, _)| sheet.values.size() == base.size()) {
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let below = picture.at(x, y);
            if let Some((color, strength)) = sheet.color(x, y, below) {
                picture.set(x, y, mixed(below, color, opacity * strength));
            }
        }
    }
    picture
}

/// Interpolates two colours in sRGB codes, which suits display but not measurement.
fn mixed(below: Rgba8, above: Rgba8, share: f32) -> Rgba8 {
    let mut mixed = below;
    for (code, above) in mixed.iter_mut().zip(above).take(3) {
        *code = (f32::from(*code) + (f32::from(above) - f32::from(*code)) * share.clamp(0.0, 1.0)).round() as u8;
    }
    mixed
}

/// Returns the totals of sheets as comma-separated values.
pub fn csv<'a>(sheets: impl IntoIterator<Item = &'a Sheet>) -> String {
    let mut text = "overlay,total,value,unit\n".to_owned();
    for sheet in sheets {
        for Total { name, number, unit } in &sheet.totals {
            text.push_str(&format!("{},{name},{number},{unit}\n", sheet.overlay.id()));
        }
    }
    text
}
