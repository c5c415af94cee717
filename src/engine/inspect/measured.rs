//! Histogram and statistics of each channel of a displayed quantity, over the picture and over a rectangle.

use super::histogram::Histogram;
use super::range::{channels, pixels};
use super::statistics::Statistics;
use super::view::{Range, Value};
use crate::image::picture::{Layer, Picture};
use crate::measure::region::PixelRegion;

/// Number of bins of a histogram. In the widest histogram strip, a bin is about three points (logical pixels) wide.
pub(crate) const BINS: usize = 256;

/// Statistics and histograms of a picture of values.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureStatistics {
    /// Statistics of each channel over the whole picture.
    pub whole: Vec<Statistics>,
    /// Selected rectangle, if any, and the statistics of each channel within it.
    pub part: Option<(PixelRegion, Vec<Statistics>)>,
    /// Histogram of each channel over the whole picture, all with the same range. Empty if no range was requested and
    /// no value is finite.
    pub histograms: Vec<Histogram>,
    /// Range of the finite values of all channels; `None` if no value is finite.
    pub extent: Option<Range>,
}

/// Computes the statistics and histograms of a picture of `size` pixels with `count` channels. Histograms span `axis`,
/// or the range of all values if it is `None`. Pixels without a value are ignored.
pub fn measure(
    size: (u32, u32),
    count: usize,
    axis: Option<Range>,
    region: Option<PixelRegion>,
    value: impl Fn(u32, u32) -> Value,
) -> PictureStatistics {
    let all = PixelRegion { left: 0, top: 0, right: size.0, bottom: size.1 };
    let statistics = |region: PixelRegion| {
        let mut statistics = vec![Statistics::default(); count];
        for (x, y) in pixels(region, size) {
            for (channel, number) in statistics.iter_mut().zip(channels(value(x, y))) {
                channel.add(number);
            }
        }
        statistics
    };
    let whole = statistics(all);
    let ends = whole.iter().filter(|channel| channel.finite > 0).flat_map(|channel| [channel.min, channel.max]);
    let extent = Range::fit(ends);
    let mut histograms = Vec::new();
    if let Some(axis) = axis.or(extent) {
        histograms = vec![Histogram::of([], axis, BINS); count];
        for (x, y) in pixels(all, size) {
            for (histogram, number) in histograms.iter_mut().zip(channels(value(x, y))) {
                histogram.add(number);
            }
        }
    }
    PictureStatistics { part: region.map(|region| (region, statistics(region))), whole, histograms, extent }
}

/// Computes the statistics and histograms of the stored values of a picture file's layer: one channel, or red, green and
/// blue. Integer colours are on a scale on which white is 255.
pub fn measure_layer(picture: &Picture, layer: &Layer) -> PictureStatistics {
    let count = picture.channels_of(layer).count().min(3);
    let count = if count == 3 { 3 } else { 1 };
    measure(picture.size(), count, None, None, |x, y| {
        let values = picture.value(layer, x, y).map(|value| value as f32);
        if count == 3 { Value::Weights(values) } else { Value::Number(values[0]) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_measured_separately_and_pixels_without_a_value_are_ignored() {
        let value = |x: u32, y: u32| {
            if x == 0 { Value::Nothing } else { Value::Weights([x as f32, -(y as f32), f32::NAN]) }
        };
        let region = PixelRegion { left: 2, top: 1, right: 4, bottom: 2 };
        let measured = measure((5, 3), 3, None, Some(region), value);
        let [first, second, third] = measured.whole[..] else { panic!("three channels") };
        assert_eq!((first.finite, first.min, first.max), (12, 1.0, 4.0));
        assert!((first.mean - 2.5).abs() < 1e-12);
        assert_eq!((second.min, second.max), (-2.0, 0.0));
        assert_eq!((third.finite, third.nan), (0, 12));
        assert_eq!(measured.extent, Some(Range { low: -2.0, high: 4.0 }));
        let (_, part) = measured.part.unwrap();
        assert_eq!((part[0].finite, part[0].mean, part[1].mean), (2, 2.5, -1.0));
        for histogram in &measured.histograms[..2] {
            assert_eq!(histogram.bins.iter().sum::<u64>(), 12);
        }
    }

    #[test]
    fn a_picture_without_values_has_no_histogram() {
        let measured = measure((4, 4), 1, None, None, |_, _| Value::Nothing);
        assert!(measured.histograms.is_empty() && measured.extent.is_none());
        assert_eq!(measured.whole[0].count(), 0);
    }
}
