//! Mapping of a quantity to display colours: range, colour map, channels. The quantity itself never changes.

mod text;

use serde::{Deserialize, Serialize};

use super::buffers::{Buffer, BufferChannels, Buffers};
use super::range::{RangeFit, Rule, channels};
use super::view::NOT_DRAWN;
use super::view::{self, Range, Value, fault_color};
use crate::chain::Frame;
use crate::image::color::quantize;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::shade::id_color;

choice! {
    /// A colour gradient onto which numbers within a range are mapped.
    pub ColorMap {
        Viridis = "viridis", "Viridis", "From dark blue over green to yellow, perceptually uniform, safe for colour-blind users.";
        Cividis = "cividis", "Cividis", "From dark blue to yellow: looks nearly the same with and without colour blindness.";
        Magma = "magma", "Magma", "From black over purple to light yellow, perceptually uniform.";
        Turbo = "turbo", "Turbo", "A rainbow with smooth brightness: shows fine differences, but is not perceptually uniform.";
        Grey = "grey", "Grey", "From black to white.";
        Diverging = "diverging", "± (orange, white, purple)", "Zero is white, negative values orange, positive ones purple; the range is symmetric around zero.";
    }
}

/// Colour of NaN values in every colour map.
pub(crate) const NOT_A_NUMBER: Rgba8 = [255, 0, 190, 255];

impl ColorMap {
    /// Returns the colour at `position`, which is clamped to [0, 1]; returns [`NOT_A_NUMBER`] for NaN.
    pub(crate) fn color(self, position: f32) -> Rgba8 {
        if position.is_nan() {
            return NOT_A_NUMBER;
        }
        let at = f64::from(position.clamp(0.0, 1.0));
        let gradient = match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Cividis => colorous::CIVIDIS,
            Self::Magma => colorous::MAGMA,
            Self::Turbo => colorous::TURBO,
            Self::Diverging => colorous::PURPLE_ORANGE,
            Self::Grey => {
                let grey = (at * 255.0).round() as u8;
                return [grey, grey, grey, 255];
            }
        };
        // `PURPLE_ORANGE` begins with purple, but this colour map begins with orange.
        let at = if self == Self::Diverging { 1.0 - at } else { at };
        let [r, g, b] = gradient.eval_continuous(at).as_array();
        [r, g, b, 255]
    }
}

/// Settings for displaying a quantity as colours: range, colour map and channels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Display {
    /// Rule that determines the low and high ends of the displayed range.
    pub rule: Rule,
    /// Colour map; `None` for the default map of the displayed quantity.
    pub map: Option<ColorMap>,
    /// Whether the colour map is reversed.
    pub reversed: bool,
    /// Whether each of red, green and blue (or each of the three weights) is shown; a single shown channel appears as
    /// grey.
    pub channels: [bool; 3],
}

impl Default for Display {
    fn default() -> Self {
        Self { rule: Rule::Natural, map: None, reversed: false, channels: [true; 3] }
    }
}

/// Kind of values in a displayed picture, which determines the labels and controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ValueKind {
    /// Red, green and blue as 8-bit codes.
    Colors,
    /// Barycentric weights of the three corners of a triangle.
    Weights,
    /// One number or count, displayed with a colour map.
    Numbers,
    /// Triangle ids, which have no range.
    Names,
}

impl ValueKind {
    /// Returns the kind of a buffer's values.
    pub fn of(buffer: Buffer) -> Self {
        match buffer.channels() {
            BufferChannels::Color(_) => Self::Colors,
            BufferChannels::Weights(_) => Self::Weights,
            BufferChannels::Triangle(_) => Self::Names,
            BufferChannels::Number(_) | BufferChannels::Count(_) => Self::Numbers,
        }
    }

    /// Returns the display names of the channels, such as “R”.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Colors => &["R", "G", "B"],
            Self::Weights => &["λ0", "λ1", "λ2"],
            Self::Numbers => &["value"],
            Self::Names => &[],
        }
    }

    /// Returns the default range for values of this kind; `None` if it depends on the values.
    fn natural(self) -> Option<Range> {
        match self {
            Self::Colors => Some(Range { low: 0.0, high: 255.0 }),
            Self::Weights => Some(Range { low: 0.0, high: 1.0 }),
            Self::Numbers | Self::Names => None,
        }
    }
}

impl Display {
    /// Returns the display range of a buffer of a frame; `None` if the buffer has no range.
    pub fn range(&self, buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>) -> Option<Range> {
        let value = |x: u32, y: u32| view::value(buffer, frame, buffers, x, y);
        let natural = || view::range(buffer, frame, buffers);
        self.range_of(ValueKind::of(buffer), frame.image().size(), natural, value)
    }

    /// Returns the display range of a picture whose values are of the given kind. `natural` returns the default range
    /// of numbers; if it returns `None`, the range is fitted to all values.
    pub fn range_of(
        &self,
        kind: ValueKind,
        size: (u32, u32),
        natural: impl Fn() -> Option<Range>,
        value: impl Fn(u32, u32) -> Value,
    ) -> Option<Range> {
        match self.rule {
            _ if kind == ValueKind::Names => None,
            Rule::Fixed(range) => Some(range),
            Rule::Sticky(fit) => fit.range(size, self.channels, value).or_else(|| kind.natural()),
            Rule::Natural => {
                kind.natural().or_else(natural).or_else(|| RangeFit::All.range(size, self.channels, value))
            }
        }
    }

    /// Returns the position of a number on the colour map, in [0, 1]; NaN for NaN.
    pub(crate) fn position(&self, range: Range, number: f32) -> f32 {
        if number.is_nan() {
            return number;
        }
        let position = if self.map == Some(ColorMap::Diverging) {
            let reach = range.low.abs().max(range.high.abs());
            Range { low: -reach, high: reach }.position(number)
        } else {
            range.position(number)
        };
        if self.reversed { 1.0 - position } else { position }
    }

    /// Returns the display colour of a number. `buffer`, if given, determines the default colour map.
    pub fn number_color(&self, buffer: Option<Buffer>, range: Range, number: f32) -> Rgba8 {
        let position = self.position(range, number);
        match (self.map, buffer) {
            _ if position.is_nan() => NOT_A_NUMBER,
            (Some(map), _) => map.color(position),
            (None, Some(buffer)) => view::map_color(buffer, position),
            (None, None) => view::magnitude_color(position),
        }
    }

    /// Returns the colour of the legend at `share`, a position in [0, 1] from the low to the high end of the range.
    pub fn legend_color(&self, buffer: Option<Buffer>, range: Range, share: f32) -> Rgba8 {
        // Interpolates without computing `high - low`, which may overflow to infinity.
        self.number_color(buffer, range, range.low * (1.0 - share) + range.high * share)
    }

    /// Maps three channel values to a colour. Each channel rises from black at the low end of the range to full
    /// brightness at the high end. Hidden channels are black; a single shown channel is grey.
    fn tone(&self, range: Range, numbers: [f32; 3]) -> Rgba8 {
        if numbers.iter().zip(self.channels).any(|(number, shown)| shown && number.is_nan()) {
            return NOT_A_NUMBER;
        }
        let [r, g, b] = numbers.map(|number| quantize(range.position(number)));
        match self.channels {
            [true, false, false] => [r, r, r, 255],
            [false, true, false] => [g, g, g, 255],
            [false, false, true] => [b, b, b, 255],
            [red, green, blue] => [r * u8::from(red), g * u8::from(green), b * u8::from(blue), 255],
        }
    }

    /// Returns the display colour of a value.
    fn color(&self, buffer: Option<Buffer>, range: Range, value: Value) -> Rgba8 {
        match value {
            Value::NotDrawn | Value::Nothing => NOT_DRAWN,
            Value::Number(number) => self.number_color(buffer, range, number),
            Value::Count(count) => self.number_color(buffer, range, count as f32),
            Value::Color([r, g, b, _]) => self.tone(range, [r, g, b].map(f32::from)),
            Value::Weights(weights) => self.tone(range, weights),
            Value::Triangle(id) => id_color(id),
        }
    }

    /// Renders a buffer as a full picture. With default settings, calls [`view::picture`].
    pub fn picture(
        &self,
        buffer: Buffer,
        frame: &Frame,
        buffers: Option<&Buffers>,
        range: Option<Range>,
    ) -> Image<Rgba8> {
        if *self == Self::default() {
            return view::picture(buffer, frame, buffers, range);
        }
        let value = |x, y| view::value(buffer, frame, buffers, x, y);
        let mut image = self.picture_of(Some(buffer), frame.image().size(), range, value);
        let hits = buffers.and_then(|buffers| buffers.hits.as_ref()).filter(|_| buffer == Buffer::Hits);
        for fault in hits.iter().flat_map(|hits| &hits.faults) {
            image.set(fault.x, fault.y, fault_color(fault.kind));
        }
        image
    }

    /// Renders a picture of values. `buffer`, if given, determines the default colour map.
    pub fn picture_of(
        &self,
        buffer: Option<Buffer>,
        (width, height): (u32, u32),
        range: Option<Range>,
        value: impl Fn(u32, u32) -> Value,
    ) -> Image<Rgba8> {
        let range = range.unwrap_or(Range { low: 0.0, high: 1.0 });
        Image::from_fn(width, height, |x, y| self.color(buffer, range, value(x, y)))
    }
}

/// Returns whether a value lies below the range, and whether it lies above it. One channel above the range is enough
/// for the value to lie above. One weight below the range is also enough for weights to lie below, but a colour lies
/// below only if all its channels do. The colour codes 0 and 255 always count as outside the range, because they may be
/// clipped.
pub(crate) fn beyond(value: Value, range: Range) -> (bool, bool) {
    let is_code = matches!(value, Value::Color(_));
    let below = |v: f32| v < range.low || is_code && v <= 0.0;
    let above = |v: f32| v > range.high || is_code && v >= 255.0;
    // One channel at zero is a saturated colour; all channels at zero are black.
    let black =
        if is_code { channels(value).all(below) && channels(value).count() > 0 } else { channels(value).any(below) };
    (black, channels(value).any(above))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Recipe, run};
    use crate::inspect::capture;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    fn frame() -> (Frame, Buffers) {
        let scene = builtin::by_id("interpenetrating").unwrap().build();
        let recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, Viewport { width: 48, height: 36 }, &mut ());
        let buffers = capture(&scene, &recipe, &frame);
        (frame, buffers)
    }

    #[test]
    fn default_settings_show_what_the_plain_picture_shows() {
        let (frame, buffers) = frame();
        // With an explicit map, `picture` does not call `view::picture`.
        let explicit = Display { map: Some(ColorMap::Viridis), ..Display::default() };
        for buffer in Buffer::ALL.iter().copied().filter(|buffer| *buffer != Buffer::Hits) {
            let range = Display::default().range(buffer, &frame, Some(&buffers));
            let plain = Display::default().picture(buffer, &frame, Some(&buffers), range);
            assert_eq!(explicit.picture(buffer, &frame, Some(&buffers), range), plain, "{buffer:?}");
        }
    }

    #[test]
    fn a_range_changes_colours_but_not_values() {
        let (frame, buffers) = frame();
        let values = |buffer| {
            let at = |x, y| view::value(buffer, &frame, Some(&buffers), x, y);
            Image::from_fn(48, 36, at)
        };
        let before = values(Buffer::Depth);
        let natural = Display::default().range(Buffer::Depth, &frame, Some(&buffers)).unwrap();
        let middle = (natural.low + natural.high) / 2.0;
        let narrow = Range { low: middle, high: middle + (natural.high - middle) / 2.0 };
        let display = Display { rule: Rule::Fixed(narrow), ..Display::default() };
        let range = display.range(Buffer::Depth, &frame, Some(&buffers));
        assert_eq!(range, Some(narrow));
        let picture = display.picture(Buffer::Depth, &frame, Some(&buffers), range);
        assert_eq!(values(Buffer::Depth), before);
        for (pixel, value) in picture.pixels().iter().zip(before.pixels()) {
            match value {
                Value::Number(number) if *number <= narrow.low => assert_eq!(*pixel, ColorMap::Viridis.color(0.0)),
                Value::Number(number) if *number >= narrow.high => assert_eq!(*pixel, ColorMap::Viridis.color(1.0)),
                Value::Number(_) => assert_ne!(*pixel, NOT_DRAWN),
                _ => assert_eq!(*pixel, NOT_DRAWN),
            }
        }
    }

    #[test]
    fn one_channel_alone_is_grey_and_channels_that_are_off_are_black() {
        let range = Range { low: 0.0, high: 255.0 };
        let shown = |channels| {
            let display = Display { channels, ..Display::default() };
            display.picture_of(None, (1, 1), Some(range), |_, _| Value::Color([10, 20, 30, 255])).at(0, 0)
        };
        assert_eq!(shown([false, true, false]), [20, 20, 20, 255]);
        assert_eq!(shown([true, false, true]), [10, 0, 30, 255]);
        assert_eq!(shown([true; 3]), [10, 20, 30, 255]);
    }

    #[test]
    fn a_map_of_signed_numbers_has_zero_in_the_middle() {
        let display = Display { map: Some(ColorMap::Diverging), ..Display::default() };
        let range = Range { low: -1.0, high: 4.0 };
        assert_eq!(display.position(range, 0.0), 0.5);
        assert_eq!(display.position(range, 4.0), 1.0);
        assert_eq!(display.position(range, -4.0), 0.0);
        let reversed = Display { reversed: true, ..display };
        assert_eq!(reversed.position(range, 4.0), 0.0);
        assert_eq!(display.number_color(Some(Buffer::Depth), range, f32::NAN), NOT_A_NUMBER);
        let [[r, _, b, _], middle, [red, _, blue, _]] = [0.0, 0.5, 1.0].map(|at| ColorMap::Diverging.color(at));
        assert!(r > b && red < blue, "orange is below and purple above");
        assert!(middle[..3].iter().all(|code| *code > 230), "{middle:?}");
    }

    #[test]
    fn the_legend_has_the_colours_of_the_pixels_even_if_all_values_are_equal() {
        for map in [None, Some(ColorMap::Viridis), Some(ColorMap::Diverging)] {
            let display = Display { map, ..Display::default() };
            for (low, high) in [(2.0, 2.0), (0.0, 0.0), (-2.0, 4.0)] {
                let range = Range { low, high };
                for (share, number) in [(0.0, low), (0.5, (low + high) / 2.0), (1.0, high)] {
                    let pixel = display.picture_of(None, (1, 1), Some(range), |_, _| Value::Number(number)).at(0, 0);
                    assert_eq!(display.legend_color(None, range, share), pixel, "{map:?} {range:?} {share}");
                }
            }
        }
    }

    #[test]
    fn codes_count_as_outside_at_their_ends_and_numbers_only_outside_the_range() {
        let codes = Range { low: 0.0, high: 255.0 };
        assert_eq!(beyond(Value::Color([0, 3, 255, 255]), codes), (false, true));
        assert_eq!(beyond(Value::Color([0, 0, 0, 255]), codes), (true, false));
        let unit = Range { low: 0.0, high: 1.0 };
        assert_eq!(beyond(Value::Weights([0.0, 0.0, 1.0]), unit), (false, false));
        assert_eq!(beyond(Value::Weights([-1e-9, 0.5, 1.1]), unit), (true, true));
        assert_eq!(beyond(Value::Nothing, unit), (false, false));
    }
}
