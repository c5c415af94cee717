//! Filter that reads the history of a pixel, as taps and with the arithmetic of the upscaler.

use arrayvec::ArrayVec;

use crate::upscale::{HistoryTaps, PastColor, Upscaling, whole_and_fraction};

/// Three numbers of a colour in the space in which an upscaler blends.
pub(super) type BlendColor = [f32; 3];

/// Order in which the pixels are combined.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    /// a + (b − a) · weight of b, first along the rows.
    Linear,
    /// Sums of products, first along the columns.
    Sums,
    /// Like [`Order::Sums`], and the result is clamped to the range of the nearest 2 × 2 pixels.
    ClampedSums,
}

/// Pixels of the history along one axis, with their weights.
struct AxisTaps {
    taps: ArrayVec<(u32, f32), 4>,
    order: Order,
}

impl AxisTaps {
    fn single(position_px: f32) -> Self {
        Self { taps: ArrayVec::from_iter([(position_px as u32, 1.0)]), order: Order::Linear }
    }

    fn new(position_px: f32, length: u32, filter: impl Fn(f32) -> HistoryTaps) -> Self {
        let (first, t) = whole_and_fraction(position_px);
        let inside = |at: i64| at.clamp(0, i64::from(length) - 1) as u32;
        let taps = |from: i64, weights: &[f32]| {
            (first + from..).zip(weights).map(|(at, weight)| (inside(at), *weight)).collect::<ArrayVec<_, 4>>()
        };
        let (taps, order) = match filter(t) {
            HistoryTaps::Linear(t) => (taps(0, &[1.0 - t, t]), Order::Linear),
            HistoryTaps::Four(weights) => (taps(-1, &weights), Order::Sums),
            HistoryTaps::FourClamped(weights) => (taps(-1, &weights), Order::ClampedSums),
        };
        Self { taps, order }
    }

    fn interpolated(&self, values: &[BlendColor]) -> BlendColor {
        match (values, self.taps.as_slice()) {
            ([a, b], [_, (_, t)]) => std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t),
            _ => values.first().copied().unwrap_or_default(),
        }
    }

    fn products(&self, values: &[BlendColor]) -> ArrayVec<BlendColor, 4> {
        values.iter().zip(&self.taps).map(|(value, (_, weight))| value.map(|number| number * weight)).collect()
    }

    /// Returns the two pixels on either side of the position.
    fn nearest(&self) -> impl Iterator<Item = u32> {
        self.taps.iter().skip(1).take(2).map(|(at, _)| *at)
    }
}

fn sum(a: BlendColor, b: BlendColor) -> BlendColor {
    std::array::from_fn(|i| a[i] + b[i])
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
        if self.columns.order == Order::Linear {
            let row = |y: u32| {
                let colors: ArrayVec<_, 4> = self.columns.taps.iter().map(|(x, _)| color((*x, y))).collect();
                self.columns.interpolated(&colors)
            };
            let rows: ArrayVec<_, 4> = self.rows.taps.iter().map(|(y, _)| row(*y)).collect();
            return self.rows.interpolated(&rows);
        }
        let column = |x: u32| {
            let colors: ArrayVec<_, 4> = self.rows.taps.iter().map(|(y, _)| color((x, *y))).collect();
            self.rows.products(&colors).into_iter().reduce(sum).unwrap_or_default()
        };
        let columns: ArrayVec<_, 4> = self.columns.taps.iter().map(|(x, _)| column(*x)).collect();
        let filtered = match self.columns.products(&columns).as_slice() {
            [a, b, c, d] => sum(sum(*a, *c), sum(*b, *d)),
            _ => [0.0; 3],
        };
        if self.columns.order == Order::ClampedSums { self.clamped(filtered, color) } else { filtered }
    }

    /// Clamps a colour to the range of the nearest 2 × 2 pixels.
    fn clamped(&self, filtered: BlendColor, color: impl Fn((u32, u32)) -> BlendColor) -> BlendColor {
        let (mut least, mut greatest) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for (x, y) in self.rows.nearest().flat_map(|y| self.columns.nearest().map(move |x| (x, y))) {
            let near = color((x, y));
            least = std::array::from_fn(|i| least[i].min(near[i]));
            greatest = std::array::from_fn(|i| greatest[i].max(near[i]));
        }
        std::array::from_fn(|i| filtered[i].max(least[i]).min(greatest[i]))
    }
}
