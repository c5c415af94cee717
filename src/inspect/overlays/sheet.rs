//! One overlay of one frame: its value at every pixel, what colours stand for, and its totals.

use super::Overlay;
use crate::image::{Image, Rgba8};
use crate::inspect::display::ColorMap;
use crate::inspect::view::Range;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::wireframe::line_color;

/// A kind of pixel that an overlay tells apart. Its number is its place in the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    /// What it is called.
    pub name: &'static str,
    /// Its colour.
    pub color: Rgba8,
    /// Whether it is drawn as stripes, so that the picture below remains readable.
    pub striped: bool,
}

/// Colours for numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The numbers at both ends.
    pub range: Range,
    /// Whether equal factors, not equal steps, are equally far apart.
    pub logarithmic: bool,
    /// The colours.
    pub map: ColorMap,
    /// Whether they run the other way.
    pub reversed: bool,
    /// What is counted or measured, after the number.
    pub unit: &'static str,
}

impl Scale {
    /// Where a number lies between the ends, in [0, 1].
    pub fn position(&self, number: f32) -> f32 {
        let position = if self.logarithmic {
            let Range { low, high } = self.range;
            Range { low: low.ln(), high: high.ln() }.position(number.max(low).ln())
        } else {
            self.range.position(number)
        };
        if self.reversed { 1.0 - position } else { position }
    }

    /// The number at a place between the ends, 0 to 1.
    pub fn number_at(&self, share: f32) -> f32 {
        let Range { low, high } = self.range;
        if self.logarithmic { (low.ln() + (high.ln() - low.ln()) * share).exp() } else { low + (high - low) * share }
    }

    /// The colour of a number.
    pub fn color(&self, number: f32) -> Rgba8 {
        self.map.color(self.position(number))
    }
}

/// What the colours of an overlay stand for.
#[derive(Clone, Debug, PartialEq)]
pub enum Key {
    /// Lines, light or dark against what lies below.
    Lines,
    /// Kinds of pixels.
    Kinds(&'static [Kind]),
    /// Numbers.
    Scale(Scale),
}

/// A total over the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Total {
    /// What it is.
    pub name: &'static str,
    /// How much.
    pub number: f64,
    /// Of what, after the number.
    pub unit: &'static str,
}

/// An overlay of a frame.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Which.
    pub overlay: Overlay,
    /// For each pixel of the full picture a number, or the number of a kind, or 1 on a line; NaN where there is nothing.
    pub values: Image<f32>,
    /// For each kind the number of times that it occurs at each pixel of the full picture, where a pixel has several and
    /// shows the most frequent; else empty.
    pub counts: Vec<Image<f32>>,
    /// What colours stand for.
    pub key: Key,
    /// Totals over all samples that were drawn.
    pub totals: Vec<Total>,
    /// Lines in px, of overlays that are lines: edges, three to a triangle, or normals.
    pub lines: Vec<[[f32; 2]; 2]>,
    /// Length of normals, as a share of the diagonal of the scene's box; `None` for other overlays.
    pub length: Option<f32>,
    /// Why there is nothing to show, if so.
    pub absence: Option<String>,
}

/// Period of stripes, in px across and down.
const STRIPES: u32 = 6;

/// How much of their colour the gaps between stripes have, so that a single pixel is never lost.
const GAP_STRENGTH: f32 = 0.3;

impl Sheet {
    /// One with values and a key.
    pub(super) fn new(overlay: Overlay, values: Image<f32>, key: Key, totals: Vec<Total>) -> Self {
        Self { overlay, values, counts: Vec::new(), key, totals, lines: Vec::new(), length: None, absence: None }
    }

    /// One that has nothing to show.
    pub(super) fn absent(overlay: Overlay, (width, height): (u32, u32), why: impl Into<String>) -> Self {
        let values = Image::filled(width, height, f32::NAN);
        Self { absence: Some(why.into()), ..Self::new(overlay, values, Key::Lines, Vec::new()) }
    }

    /// Colour at a pixel over what lies below, and how much of it there is, in [0, 1]; none where there is nothing.
    fn color(&self, x: u32, y: u32, below: Rgba8) -> Option<(Rgba8, f32)> {
        let value = self.values.at(x, y);
        if value.is_nan() {
            return None;
        }
        match &self.key {
            Key::Lines => Some((line_color(below), 1.0)),
            Key::Scale(scale) => Some((scale.color(value), 1.0)),
            Key::Kinds(kinds) => {
                let kind = kinds.get(value as usize)?;
                let in_gap = kind.striped && (x + y) % STRIPES >= STRIPES / 2;
                Some((kind.color, if in_gap { GAP_STRENGTH } else { 1.0 }))
            }
        }
    }

    /// Colour of its lines; `None` if they are light or dark against what lies below.
    pub fn line_color(&self) -> Option<Rgba8> {
        match &self.key {
            Key::Kinds([kind]) => Some(kind.color),
            _ => None,
        }
    }

    /// The value at a pixel in words; none where there is nothing.
    pub fn text(&self, x: u32, y: u32) -> Option<String> {
        let value = self.values.get(x, y).filter(|value| !value.is_nan())?;
        match &self.key {
            Key::Lines => Some("an edge".to_owned()),
            Key::Kinds(kinds) if self.counts.is_empty() => kinds.get(value as usize).map(|kind| kind.name.to_owned()),
            Key::Kinds(kinds) => {
                let counted = kinds.iter().zip(&self.counts).map(|(kind, counts)| (kind.name, counts.at(x, y)));
                let words: Vec<_> =
                    counted.filter(|(_, count)| *count > 0.0).map(|(name, count)| format!("{name} {count}")).collect();
                Some(words.join(", "))
            }
            Key::Scale(scale) => Some(amount(value, scale.unit)),
        }
    }

    /// The first pixel after another in reading order that shows a value, or the last before it; round the end.
    pub fn beside(&self, from: Option<(u32, u32)>, forwards: bool) -> Option<(u32, u32)> {
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

/// A number with what it counts or measures: whole numbers as they are, others with four digits that count.
fn amount(value: f32, unit: &str) -> String {
    match value.abs() {
        1.0 => format!("{value} {}", unit.trim_end_matches('s')),
        size if value.fract() == 0.0 && size < 1e7 => format!("{value} {unit}"),
        size if size >= 1000.0 => format!("{value:.0} {unit}"),
        size if size >= 0.01 => format!("{value:.4} {unit}"),
        _ => format!("{value:.3e} {unit}"),
    }
}

/// Lays sheets over a picture, the first one first, each with an opacity in [0, 1].
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

/// Codes between two colours: for looking at, not for measuring.
fn mixed(below: Rgba8, above: Rgba8, share: f32) -> Rgba8 {
    let mut mixed = below;
    for (code, above) in mixed.iter_mut().zip(above).take(3) {
        *code = (f32::from(*code) + (f32::from(above) - f32::from(*code)) * share.clamp(0.0, 1.0)).round() as u8;
    }
    mixed
}

/// The totals of sheets as a table with commas.
pub fn csv<'a>(sheets: impl IntoIterator<Item = &'a Sheet>) -> String {
    let mut text = "overlay,total,value,unit\n".to_owned();
    for sheet in sheets {
        for Total { name, number, unit } in &sheet.totals {
            text.push_str(&format!("{},{name},{number},{unit}\n", sheet.overlay.id()));
        }
    }
    text
}
