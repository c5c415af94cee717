//! Parsers for command-line arguments.

use std::ffi::OsStr;
use std::ops::Range;

use crate::inspect::overlays::{Overlay, OverlayLayer};
use crate::pipeline::settings::Choice;
use crate::pipeline::viewport::Viewport;
use crate::scene::UpAxis;
use crate::scene::obj::TrMeaning;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, Command};

/// Number of frames above which the range of a sequence is refused.
const MAX_FRAMES: u32 = 1_000_000;

/// Parses a size such as `1280x720`.
pub(crate) fn size(text: &str) -> Result<Viewport, String> {
    let (width, height) = pair(text, &['x', 'X', '×']).ok_or("expected a size in pixels, such as 1280x720")?;
    let size = Viewport { width, height };
    size.check()?;
    Ok(size)
}

/// Parses a finite angle in degrees.
pub(crate) fn degrees(text: &str) -> Result<f32, String> {
    let finite = text.trim().parse().ok().filter(|angle: &f32| angle.is_finite());
    finite.ok_or_else(|| "expected an angle in degrees, such as 0.5".to_owned())
}

/// Parses a finite time in seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let finite = text.trim().parse().ok().filter(|time_s: &f64| time_s.is_finite());
    finite.ok_or_else(|| "expected a time in seconds, such as 1.5".to_owned())
}

/// Parses a number of frames per second.
pub(crate) fn frames_per_second(text: &str) -> Result<f64, String> {
    let valid = text.trim().parse().ok().filter(|rate: &f64| (0.001..=10_000.0).contains(rate));
    valid.ok_or_else(|| "expected a number of frames per second from 0.001 to 10000, such as 30".to_owned())
}

/// Parses the numbers of frames: a count such as `48`, or a range such as `12..24` without its end.
pub(crate) fn frames(text: &str) -> Result<Range<u32>, String> {
    let range = match text.split_once("..") {
        Some((first, end)) => first.trim().parse().ok().zip(end.trim().parse().ok()).map(|(first, end)| first..end),
        None => text.trim().parse().ok().map(|count| 0..count),
    };
    let valid = range.filter(|frames| !frames.is_empty() && frames.end <= MAX_FRAMES);
    valid.ok_or_else(|| {
        format!("expected a number of frames such as 48, or a range such as 12..24, with at most {MAX_FRAMES} frames")
    })
}

/// Parses a pixel such as `640,360`: column and row.
pub(crate) fn pixel(text: &str) -> Result<(u32, u32), String> {
    pair(text, &[',']).ok_or_else(|| "expected a pixel as column,row, counted from 0, such as 640,360".to_owned())
}

fn pair(text: &str, separators: &[char]) -> Option<(u32, u32)> {
    let (first, second) = text.split_once(separators)?;
    Some((first.trim().parse().ok()?, second.trim().parse().ok()?))
}

/// Returns a parser for the values of `C`; the help text lists each with its description.
pub(crate) fn choice<C: Choice + Send + Sync>() -> impl TypedValueParser<Value = C> {
    PossibleValuesParser::new(possible_values::<C>()).try_map(|id| named::<C>(&id).ok_or("unknown value"))
}

/// Axis that points up in the home view of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Up {
    /// Axis guessed from the model.
    Auto,
    /// Axis given by the user.
    Axis(UpAxis),
}

/// Returns the parser for the axis that points up.
pub(crate) fn up() -> impl TypedValueParser<Value = Up> {
    PossibleValuesParser::new(["auto", "y", "z"]).map(|id| match id.as_str() {
        "y" => Up::Axis(UpAxis::Y),
        "z" => Up::Axis(UpAxis::Z),
        _ => Up::Auto,
    })
}

/// Returns the parser for the meaning of `Tr` in material libraries: transparency, opacity, or guessed from the file.
pub(crate) fn tr() -> impl TypedValueParser<Value = TrMeaning> {
    PossibleValuesParser::new(["auto", "transparency", "opacity"]).map(|id| match id.as_str() {
        "transparency" => TrMeaning::Transparency,
        "opacity" => TrMeaning::Opacity,
        _ => TrMeaning::Auto,
    })
}

/// Returns a parser for an overlay and its opacity; the help text lists all overlays.
pub(crate) fn layer() -> impl TypedValueParser<Value = OverlayLayer> {
    LayerParser
}

#[derive(Clone)]
struct LayerParser;

impl TypedValueParser for LayerParser {
    type Value = OverlayLayer;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<OverlayLayer, clap::Error> {
        let parse = |text: &str| text.parse::<OverlayLayer>();
        TypedValueParser::parse_ref(&parse, command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(possible_values::<Overlay>()))
    }
}

/// Returns a parser for the values of `A` and `B`, which must not share an id.
pub(crate) fn either<A: Choice + Send + Sync, B: Choice + Send + Sync>() -> impl TypedValueParser<Value = Either<A, B>>
{
    let values = possible_values::<A>().chain(possible_values::<B>());
    PossibleValuesParser::new(values).try_map(|id| {
        let first = named::<A>(&id).map(Either::First);
        first.or_else(|| named::<B>(&id).map(Either::Second)).ok_or("unknown value")
    })
}

/// Value of one of two types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Either<A, B> {
    /// Value of the first type.
    First(A),
    /// Value of the second type.
    Second(B),
}

fn possible_values<C: Choice>() -> impl Iterator<Item = PossibleValue> {
    C::ALL.iter().map(|choice| PossibleValue::new(choice.id()).help(choice.help()))
}

fn named<C: Choice>(id: &str) -> Option<C> {
    C::ALL.iter().copied().find(|choice| choice.id() == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_within_bounds_are_accepted() {
        for (text, width, height) in [("1x1", 1, 1), ("1280X720", 1280, 720), ("16384×2048", 16_384, 2048)] {
            assert_eq!(size(text), Ok(Viewport { width, height }));
        }
    }

    #[test]
    fn sizes_out_of_bounds_are_refused() {
        for text in ["", "1280", "0x10", "10x0", "-1x5", "16385x1", "16384x16384", "1.5x2", "99999999999x1"] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
