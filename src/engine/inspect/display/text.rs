//! Text form of display settings, such as `range=0.25..0.5,map=magma,reversed,channels=rg`. Default values are omitted.

use std::str::FromStr;

use super::{ColorMap, Display};
use crate::inspect::range::{RangeFit, Rule};
use crate::inspect::view::Range;
use crate::measure::region::PixelRegion;
use crate::pipeline::settings::Choice as _;

/// Letters of the red, green and blue channels in the text form.
const CHANNELS: [char; 3] = ['r', 'g', 'b'];

impl Display {
    /// Returns the settings as text, empty for the default. Parsing the text restores the same settings.
    pub fn text(&self) -> String {
        let mut parts = Vec::new();
        match self.rule {
            Rule::Natural => {}
            Rule::Sticky(RangeFit::All) => parts.push("range=all".to_owned()),
            Rule::Sticky(RangeFit::Most) => parts.push("range=most".to_owned()),
            Rule::Sticky(RangeFit::Within(PixelRegion { left, top, right, bottom })) => {
                parts.push(format!("range={left}:{top}:{right}:{bottom}"));
            }
            Rule::Fixed(Range { low, high }) => parts.push(format!("range={low}..{high}")),
        }
        parts.extend(self.map.map(|map| format!("map={}", map.id())));
        parts.extend(self.reversed.then(|| "reversed".to_owned()));
        if self.channels != [true; 3] {
            let shown = CHANNELS.iter().zip(self.channels).filter(|(_, shown)| *shown).map(|(letter, _)| *letter);
            parts.push(format!("channels={}", shown.collect::<String>()));
        }
        parts.join(",")
    }
}

impl FromStr for Display {
    type Err = String;

    /// Parses the output of [`Display::text`], with its parts in any order. The error lists the valid parts.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut display = Self::default();
        for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            match part.split_once('=') {
                None if part == "reversed" => display.reversed = true,
                Some(("range", range)) => display.rule = rule(range)?,
                Some(("map", map)) => display.map = Some(color_map(map)?),
                Some(("channels", letters)) => display.channels = channels(letters)?,
                _ => return Err(format!("`{part}` is not one of range=…, map=…, reversed and channels=…")),
            }
        }
        Ok(display)
    }
}

fn rule(text: &str) -> Result<Rule, String> {
    let bad = || {
        format!(
            "`{text}` is not a range; use all, most, two numbers such as 0.25..0.5, or left:top:right:bottom of a \
             rectangle in px"
        )
    };
    match text {
        "all" => return Ok(Rule::Sticky(RangeFit::All)),
        "most" => return Ok(Rule::Sticky(RangeFit::Most)),
        _ => {}
    }
    if let Some((low, high)) = text.split_once("..") {
        let number = |text: &str| text.trim().parse::<f32>().ok().filter(|number| number.is_finite()).ok_or_else(bad);
        let (low, high) = (number(low)?, number(high)?);
        return if low <= high { Ok(Rule::Fixed(Range { low, high })) } else { Err(bad()) };
    }
    let sides: Option<Vec<u32>> = text.split(':').map(|side| side.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[left, top, right, bottom]) => {
            Ok(Rule::Sticky(RangeFit::Within(PixelRegion { left, top, right, bottom })))
        }
        _ => Err(bad()),
    }
}

fn color_map(text: &str) -> Result<ColorMap, String> {
    let known = || ColorMap::ALL.iter().map(|map| map.id()).collect::<Vec<_>>().join(", ");
    let map = ColorMap::ALL.iter().copied().find(|map| map.id() == text);
    map.ok_or_else(|| format!("`{text}` is not a colour map; use one of {}", known()))
}

fn channels(letters: &str) -> Result<[bool; 3], String> {
    match letters.chars().find(|letter| !CHANNELS.contains(letter)) {
        Some(letter) => Err(format!("`{letter}` is not a channel; use r, g or b")),
        None => Ok(CHANNELS.map(|letter| letters.contains(letter))),
    }
}

impl From<Display> for String {
    fn from(display: Display) -> Self {
        display.text()
    }
}

impl TryFrom<String> for Display {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive_a_round_trip_through_text_bit_for_bit() {
        let region = PixelRegion { left: 1, top: 2, right: 30, bottom: 40 };
        let fixed = |low: f32, high: f32| Rule::Fixed(Range { low, high });
        let rules = [
            Rule::Natural,
            Rule::Sticky(RangeFit::All),
            Rule::Sticky(RangeFit::Most),
            Rule::Sticky(RangeFit::Within(region)),
            fixed(-0.0, 1.0 / 3.0),
            fixed(-f32::MAX, f32::MIN_POSITIVE / 2.0),
        ];
        let maps = || [None].into_iter().chain(ColorMap::ALL.iter().copied().map(Some));
        for (rule, map) in rules.into_iter().flat_map(|rule| maps().map(move |map| (rule, map))) {
            for bits in 0..16_u8 {
                let channels = [0, 1, 2].map(|bit| bits >> bit & 1 == 1);
                let display = Display { rule, map, reversed: bits >> 3 == 1, channels };
                let read: Display = display.text().parse().unwrap();
                assert_eq!(read, display, "{}", display.text());
                assert_eq!(read.text(), display.text());
            }
        }
        assert_eq!(Display::default().text(), "");
    }

    #[test]
    fn invalid_text_is_rejected_with_the_valid_forms() {
        for (text, reported) in [
            ("map=rainbow", "turbo"),
            ("range=2..1", "two numbers"),
            ("range=0..inf", "two numbers"),
            ("range=1:2:3", "rectangle"),
            ("channels=rx", "`x` is not a channel"),
            ("bright", "reversed"),
        ] {
            let error = text.parse::<Display>().unwrap_err();
            assert!(error.contains(reported), "{text}: {error}");
        }
    }
}
