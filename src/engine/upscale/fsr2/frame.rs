//! A frame to upscale, and its results for single pixels.

use super::super::history::DilatedVectors;
use super::super::jitter::Continuation;
use super::super::sample_rows::DecodedRows;
use super::super::ycocg::YCoCg;
use super::super::{Accumulated, Motion, UpscaleInputs, Upscaling};
use super::jitter_of;
use super::kernel::{AxisSamples, ColumnLanes};
use super::locks::Contrast;
use super::reactive::{self, ReactiveRow};
use super::surroundings::Surroundings;

/// Frame to upscale, with its history.
pub(super) struct Fsr2Frame<'a> {
    pub(super) colors: YCoCg,
    pub(super) contrast: Contrast,
    pub(super) drawn: &'a UpscaleInputs<'a>,
    pub(super) size: (u32, u32),
    /// Upscaling factor per axis.
    pub(super) scale: f32,
    /// Number of jitter positions.
    pub(super) positions: u32,
    pub(super) columns: Vec<AxisSamples>,
    pub(super) column_lanes: ColumnLanes,
    pub(super) rows: Vec<AxisSamples>,
    pub(super) history: Option<(Motion<'a>, &'a Accumulated)>,
    /// Reactivity of every instance, in [0, 1]; `None` if it is 0 or does not matter.
    pub(super) reactivity: Option<&'a [f32]>,
    /// Whether every jitter position has been drawn since the view became still; the image then no longer changes.
    pub(super) is_settled: bool,
}

/// Buffers for the rows of a band.
pub(super) struct RowScratch {
    pub(super) samples: DecodedRows,
    pub(super) surroundings: Surroundings,
    /// `None` if there is no G-buffer.
    pub(super) vectors: Option<DilatedVectors>,
    /// `None` if reactivity does not matter.
    pub(super) reactive: Option<ReactiveRow>,
}

impl<'a> Fsr2Frame<'a> {
    pub(super) fn new(how: Upscaling, drawn: &'a UpscaleInputs<'a>, size: (u32, u32)) -> Self {
        let scale = how.scale();
        let jitter = jitter_of(scale);
        let (Continuation { place, history, is_settled }, samples) =
            (Continuation::new(drawn, jitter), drawn.color.size());
        let axis = |place: f64, length: u32, samples: u32| {
            let all = (0..length).map(|at| AxisSamples::new(how.lattice(), place, at, samples));
            all.collect::<Vec<_>>()
        };
        let columns = axis(place[0], size.0, samples.0);
        let colors = YCoCg::new(how.light());
        Self {
            colors,
            contrast: Contrast::of(colors),
            drawn,
            size,
            scale: scale.value() as f32,
            positions: jitter.positions(),
            column_lanes: ColumnLanes::new(&columns),
            columns,
            rows: axis(place[1], size.1, samples.1),
            history,
            reactivity: reactive::reactivity(drawn.frame),
            is_settled,
        }
    }

    pub(super) fn scratch(&self) -> RowScratch {
        let samples = self.drawn.color.width();
        RowScratch {
            samples: DecodedRows::new(samples),
            surroundings: Surroundings::new(samples),
            vectors: self.drawn.frame.as_ref().map(DilatedVectors::new),
            reactive: self.drawn.frame.as_ref().filter(|_| self.reactivity.is_some()).map(ReactiveRow::new),
        }
    }

    /// Returns the samples around a pixel and their weights in its present colour, which sum to 1. Samples at the border
    /// may occur several times.
    pub(super) fn sample_weights(&self, at @ (x, y): (u32, u32)) -> impl Iterator<Item = ((u32, u32), f32)> {
        let (columns, rows) = (self.columns[x as usize].index, self.rows[y as usize].index);
        let weights = self.pixel(at, &mut self.scratch()).weights;
        let row = move |(row, weights): (u32, [f32; 3])| {
            columns.into_iter().zip(weights).map(move |(column, weight)| ((column, row), weight))
        };
        rows.into_iter().zip(weights).flat_map(row)
    }
}
