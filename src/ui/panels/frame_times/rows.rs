//! Rows of the panel “Frame time”: one for each method and scale, with the statistics of its frame times.

use std::cmp::Ordering;

use crate::measure::timing::{Summary, summarize};
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::timings::RowOrder;
use crate::ui::session::timings::request::MethodError;
use crate::upscale::Upscaling;

/// Upscaler with its frame times and its error.
#[derive(Clone, Debug)]
pub(super) struct MethodRow {
    /// Upscaler with its options.
    pub(super) upscaling: Upscaling,
    /// Frame times in milliseconds, oldest first.
    pub(super) times_ms: Vec<f64>,
    /// Statistics of the frame times.
    pub(super) summary: Summary,
    /// Measured error; `None` before it is measured.
    pub(super) error: Option<MethodError>,
    /// Median time of native rendering divided by the median of this row; `None` without times of native rendering.
    pub(super) speedup: Option<f64>,
    /// Whether the time differs from that of native rendering by no more than the noise.
    pub(super) native_within_noise: bool,
}

impl MethodRow {
    /// Returns the mean FLIP error over the frames in motion; `None` before it is measured.
    pub(super) fn flip(&self) -> Option<f64> {
        self.error.map(|error| error.motion.mean.flip)
    }

    /// Returns the accessible name of the row, such as “Lanczos 2 ×2: 1.62 ms”.
    pub(super) fn name(&self) -> String {
        format!("{}: {}", self.upscaling.label(), format::ms(self.summary.median))
    }
}

/// Returns a row for every upscaler with recorded frame times, in the order of the menus.
pub(super) fn collect(session: &Session) -> Vec<MethodRow> {
    let timings = &session.features.timings;
    let summarized = timings.series().into_iter().filter_map(|(upscaling, times_ms)| {
        let summary = summarize(&times_ms)?;
        Some(MethodRow {
            upscaling,
            times_ms,
            summary,
            error: timings.error(upscaling).filter(|_| timings.has_measurement()),
            speedup: None,
            native_within_noise: timings.is_within_noise_of_native(upscaling),
        })
    });
    let mut rows: Vec<_> = summarized.collect();
    let native_ms = rows.iter().find(|row| row.upscaling.is_native()).map(|row| row.summary.median);
    for row in &mut rows {
        row.speedup = native_ms.map(|native_ms| native_ms / row.summary.median.max(f64::MIN_POSITIVE));
    }
    rows
}

/// Sorts rows in place. Rows that are equal in `order` have the order of the menus.
pub(super) fn sort(rows: &mut [MethodRow], order: RowOrder) {
    let error = |row: &MethodRow| row.flip().unwrap_or(f64::INFINITY);
    rows.sort_by(|a, b| {
        let primary = match order {
            RowOrder::Time => a.summary.median.total_cmp(&b.summary.median),
            RowOrder::Error => error(a).total_cmp(&error(b)),
            RowOrder::Method => Ordering::Equal,
        };
        primary.then(a.upscaling.cmp(&b.upscaling))
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::measure::against::figures;
    use crate::measure::motion::MotionError;

    fn row(method: &str, scale: f64, ms: f64, brightness: Option<u8>) -> MethodRow {
        let picture = |code| Image::filled(8, 8, [code, code, code, 255]);
        let error = |code| {
            let still = figures(&picture(code), &picture(0)).unwrap().0;
            MethodError { still, motion: MotionError::of(&[still]).unwrap() }
        };
        MethodRow {
            upscaling: Upscaling::new(method, scale).unwrap(),
            times_ms: vec![ms],
            summary: summarize(&[ms]).unwrap(),
            error: brightness.map(error),
            speedup: None,
            native_within_noise: false,
        }
    }

    #[test]
    fn rows_are_sorted_by_time_error_or_method() {
        let mut rows = [
            row("lanczos2", 2.0, 1.6, Some(20)),
            row("nearest", 4.0, 0.7, None),
            row("lanczos2", 1.5, 2.6, Some(10)),
            row("nearest", 2.0, 1.1, Some(60)),
            row("native", 1.0, 5.0, Some(0)),
        ];
        let mut sorted = |order| {
            sort(&mut rows, order);
            rows.iter().map(|row| row.upscaling.label()).collect::<Vec<_>>()
        };
        let by_method = ["Native", "Nearest ×2", "Nearest ×4", "Lanczos 2 ×1.5", "Lanczos 2 ×2"];
        assert_eq!(sorted(RowOrder::Method), by_method);
        let by_time = ["Nearest ×4", "Nearest ×2", "Lanczos 2 ×2", "Lanczos 2 ×1.5", "Native"];
        assert_eq!(sorted(RowOrder::Time), by_time);
        let by_error = ["Native", "Lanczos 2 ×1.5", "Lanczos 2 ×2", "Nearest ×2", "Nearest ×4"];
        assert_eq!(sorted(RowOrder::Error), by_error);
    }
}
