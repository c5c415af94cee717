//! Range of values that a colour map spans: fitted to the values, or set by hand.

use serde::{Deserialize, Serialize};

use super::view::{Range, Value};
use crate::measure::region::PixelRegion;

/// Fraction of the values that [`RangeFit::Most`] excludes at each end.
const EXCLUDED_FRACTION: f64 = 0.01;

/// Set of values to which the range of a colour map is fitted. Pixels without a value, such as a cleared depth, are
/// ignored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RangeFit {
    /// All values of the picture, from minimum to maximum.
    All,
    /// All values of the picture between the 1st and the 99th percentile.
    Most,
    /// Values within a rectangle, from minimum to maximum.
    Within(PixelRegion),
}

/// Rule that determines the range of a colour map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Rule {
    /// Default range of the displayed quantity: counts from 0, colours from 0 to 255, others from minimum to maximum.
    #[default]
    Natural,
    /// Range that is fitted again to every picture.
    Sticky(RangeFit),
    /// Range set by hand.
    Fixed(Range),
}

/// Returns the numbers of a pixel, one per channel: three for colours and weights, one for numbers and counts, none for
/// other values.
pub(crate) fn channels(value: Value) -> impl Iterator<Item = f32> {
    let (numbers, count) = match value {
        Value::NotDrawn | Value::Nothing | Value::Triangle(_) => ([0.0; 3], 0),
        Value::Number(number) => ([number, 0.0, 0.0], 1),
        Value::Count(count) => ([count as f32, 0.0, 0.0], 1),
        Value::Color([r, g, b, _]) => ([r, g, b].map(f32::from), 3),
        Value::Weights(weights) => (weights, 3),
    };
    numbers.into_iter().take(count)
}

impl RangeFit {
    /// Returns the range of the values that this fit includes, in a picture of `size` pixels; `None` without a finite
    /// value. For values with several channels, only the `chosen` channels count.
    pub fn range(self, size: (u32, u32), chosen: [bool; 3], value: impl Fn(u32, u32) -> Value) -> Option<Range> {
        let all = PixelRegion { left: 0, top: 0, right: size.0, bottom: size.1 };
        let region = if let Self::Within(region) = self { region } else { all };
        let values = pixels(region, size).flat_map(|(x, y)| {
            let value = value(x, y);
            let several = matches!(value, Value::Color(_) | Value::Weights(_));
            channels(value).enumerate().filter(move |(i, _)| !several || chosen[*i]).map(|(_, v)| v)
        });
        match self {
            Self::All | Self::Within(_) => Range::fit(values),
            Self::Most => between_quantiles(values.filter(|v| v.is_finite()).collect()),
        }
    }
}

/// Returns the pixels of a rectangle that lie within a picture, in reading order.
pub(crate) fn pixels(region: PixelRegion, (width, height): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let columns = region.left..region.right.min(width);
    (region.top..region.bottom.min(height)).flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// Returns the range that excludes the fraction [`EXCLUDED_FRACTION`] of the values at each end (nearest-rank method).
fn between_quantiles(mut values: Vec<f32>) -> Option<Range> {
    let last = values.len().checked_sub(1)?;
    let rank = (last as f64 * EXCLUDED_FRACTION) as usize;
    let (_, low, _) = values.select_nth_unstable_by(rank, f32::total_cmp);
    let low = *low;
    let (_, high, _) = values.select_nth_unstable_by(last - rank, f32::total_cmp);
    Some(Range { low, high: *high })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_percent_of_the_values_is_excluded_at_each_end() {
        // 0 … 200 in scrambled order: two values are excluded at each end.
        let value = |x: u32, y: u32| Value::Number(((x + 3 * y) * 76 % 201) as f32);
        let fit = |fit: RangeFit| fit.range((201, 1), [true; 3], value);
        assert_eq!(fit(RangeFit::All), Some(Range { low: 0.0, high: 200.0 }));
        assert_eq!(fit(RangeFit::Most), Some(Range { low: 2.0, high: 198.0 }));
    }

    #[test]
    fn only_pixels_with_a_value_inside_the_rectangle_are_fitted() {
        let value = |x: u32, y: u32| if x == 2 { Value::Nothing } else { Value::Number((10 * x + y) as f32) };
        let within = PixelRegion { left: 1, top: 1, right: 3, bottom: 99 };
        let fit = |region| RangeFit::Within(region).range((5, 4), [true; 3], value);
        assert_eq!(fit(within), Some(Range { low: 11.0, high: 13.0 }));
        assert_eq!(fit(PixelRegion { left: 2, ..within }), None);
    }

    #[test]
    fn disabled_channels_are_not_fitted() {
        let value = |x: u32, _: u32| Value::Color([x as u8, 100 + x as u8, 250, 0]);
        let fit = |chosen| RangeFit::All.range((10, 1), chosen, value);
        assert_eq!(fit([true, true, false]), Some(Range { low: 0.0, high: 109.0 }));
        assert_eq!(fit([false, true, false]), Some(Range { low: 100.0, high: 109.0 }));
        let one = RangeFit::All.range((3, 1), [false, true, true], |x, _| Value::Number(x as f32));
        assert_eq!(one, Some(Range { low: 0.0, high: 2.0 }), "a single channel has no switch");
    }
}
