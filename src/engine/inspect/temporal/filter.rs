//! Filter that reads the history of a pixel, as taps and with the arithmetic of the upscaler.

use arrayvec::ArrayVec;

use crate::upscale::{HistoryTaps, PastColor, Upscaling, whole_and_fraction};

/// Three numbers of a colour in the space in which an upscaler blends.
pub(super) type BlendColor = [f32; 3];

/// Way in which the pixels of an axis are combined.
#[derive(Clone, Copy, PartialEq)]
enum Combination {
    /// a + (b − a) · weight of b.
    Linear,
    /// Sum of the products.
    Sum,
}

/// Pixels of the history along one axis, with their weights.
struct AxisTaps {
    taps: ArrayVec<(u32, f32), 4>,
    combination: Combination,
    is_clamped: bool,
}

impl AxisTaps {
    fn single(position_px: f32) -> Self {
        let taps = ArrayVec::from_iter([(position_px as u32, 1.0)]);
        Self { taps, combination: Combination::Sum, is_clamped: false }
    }

    fn new(position_px: f32, length: u32, filter: impl Fn(f32) -> HistoryTaps) -> Self {
        let (first, t) = whole_and_fraction(position_px);
        let inside = |at: i64| at.clamp(0, i64::from(length) - 1) as u32;
        let taps = |from: i64, weights: &[f32]| {
            (first + from..).zip(weights).map(|(at, weight)| (inside(at), *weight)).collect::<ArrayVec<_, 4>>()
        };
        let (taps, combination, is_clamped) = match filter(t) {
            HistoryTaps::Linear(t) => (taps(0, &[1.0 - t, t]), Combination::Linear, false),
            HistoryTaps::Two(weights) => (taps(0, &weights), Combination::Sum, false),
            HistoryTaps::Four(weights) => (taps(-1, &weights), Combination::Sum, false),
            HistoryTaps::FourClamped(weights) => (taps(-1, &weights), Combination::Sum, true),
        };
        Self { taps, combination, is_clamped }
    }

    fn combine(&self, values: &[BlendColor]) -> BlendColor {
        let weighted = |channel: usize| {
            let products = values.iter().zip(&self.taps).map(|(value, (_, weight))| value[channel] * weight);
            products.reduce(|sum, product| sum + product).unwrap_or_default()
        };
        match (self.combination, values, self.taps.as_slice()) {
            (Combination::Linear, [a, b], [_, (_, t)]) => std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t),
            _ => std::array::from_fn(weighted),
        }
    }

    /// Returns the two pixels on either side of the position.
    fn nearest(&self) -> impl Iterator<Item = u32> {
        self.taps.iter().skip(1).take(2).map(|(at, _)| *at)
    }
}

/// Filter that reads the history of one pixel.
pub(super) struct PastFilter {
    columns: AxisTaps,
    rows: AxisTaps,
}

impl PastFilter {
    /// Returns the filter of a history of `width` × `height` px. In a still view, it is the pixel itself.
    pub(super) fn new(how: Upscaling, past: &PastColor, (width, height): (u32, u32), is_still: bool) -> Self {
        let [x, y] = past.position_px;
        if is_still {
            return Self { columns: AxisTaps::single(x), rows: AxisTaps::single(y) };
        }
        let filter = |t| how.upscaler().history_taps(how, t);
        Self { columns: AxisTaps::new(x, width, filter), rows: AxisTaps::new(y, height, filter) }
    }

    /// Returns column, row and weight of the pixels. A pixel at the border may occur several times.
    pub(super) fn taps(&self) -> impl Iterator<Item = ((u32, u32), f64)> {
        self.rows.taps.iter().flat_map(|(y, vertical)| {
            let row = self.columns.taps.iter();
            row.map(|(x, horizontal)| ((*x, *y), f64::from(*horizontal) * f64::from(*vertical)))
        })
    }

    /// Returns the filtered colour, bit-identical to the one that the upscaler reads.
    pub(super) fn read(&self, color: impl Fn((u32, u32)) -> BlendColor) -> BlendColor {
        let row = |y: u32| {
            let colors: ArrayVec<_, 4> = self.columns.taps.iter().map(|(x, _)| color((*x, y))).collect();
            self.columns.combine(&colors)
        };
        let rows: ArrayVec<_, 4> = self.rows.taps.iter().map(|(y, _)| row(*y)).collect();
        let mut filtered = self.rows.combine(&rows);
        if self.columns.is_clamped {
            let (mut least, mut greatest) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
            for (x, y) in self.rows.nearest().flat_map(|y| self.columns.nearest().map(move |x| (x, y))) {
                let near = color((x, y));
                least = std::array::from_fn(|i| least[i].min(near[i]));
                greatest = std::array::from_fn(|i| greatest[i].max(near[i]));
            }
            filtered = std::array::from_fn(|i| filtered[i].max(least[i]).min(greatest[i]));
        }
        filtered
    }
}
