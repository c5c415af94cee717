//! Blending of the samples of a frame with its history, pixel by pixel. A pixel's four numbers are one SIMD vector.

use super::super::history::whole_and_fraction;
use super::super::lattice::ThreeSamples;
use super::super::sample_rows::DecodedRows;
use super::super::ycocg::{Quad, YCoCg};
use super::super::{
    HistoryStep, Lattice, Motion, PastColor, Rejection, Reprojected, Scale, Tap, UpscaleInputs, Upscaling,
};
use super::{HistoryFilter, HistoryOptions, MOVING_WEIGHT, Rectification, jitter, jitter_positions};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::gbuffer::NearestSearch;

/// Column and row of a pixel.
type PixelAt = (u32, u32);

/// Sharpness of the Gaussian that weights samples by their squared distance from the pixel, in output pixels. It
/// approximates a Blackman-Harris window of width 3.3 (Karis, 2014).
const SHARPNESS: f64 = 2.29;

/// Samples along one axis that contribute to an output column or row: three adjacent ones, clamped to the image.
#[derive(Clone, Copy, Debug)]
struct AxisSamples {
    index: [u32; 3],
    /// Weight of each sample; 1 for a sample at the centre of the pixel.
    weight: [f32; 3],
    /// Sum of the weights.
    total: f32,
}

/// Frame to upscale, with its history.
pub(super) struct TaaFrame<'a> {
    options: HistoryOptions,
    colors: YCoCg,
    drawn: &'a UpscaleInputs<'a>,
    size: (u32, u32),
    columns: Vec<AxisSamples>,
    rows: Vec<AxisSamples>,
    history: Option<(Motion<'a>, &'a Image<Quad>)>,
    /// Limit of the accumulated weight of the history.
    most_weight: f32,
    /// Whether every jitter position has been drawn since the view became still; the image then no longer changes.
    is_settled: bool,
}

/// Three vertically adjacent samples: their weighted sum and their statistics.
#[derive(Clone, Copy)]
struct Column<S: Simd> {
    weighted: f32x4<S>,
    least: f32x4<S>,
    greatest: f32x4<S>,
    sum: f32x4<S>,
    squares: f32x4<S>,
}

/// Statistics of the 3 × 3 samples around a pixel, and their weighted mean.
struct Samples<S: Simd> {
    present: f32x4<S>,
    /// Weight of the mean, relative to 1 for a sample at the centre of the pixel; at most 1.
    confidence: f32,
    least: f32x4<S>,
    greatest: f32x4<S>,
    sum: f32x4<S>,
    squares: f32x4<S>,
}

/// Blending of a pixel with its history.
struct Blend<S: Simd> {
    present: f32x4<S>,
    past: Result<Past<S>, Rejection>,
    /// Share of this frame, in [0, 1].
    share: f32,
    /// Accumulated weight of the pixel for the next frame.
    weight: f32,
}

/// History of a pixel.
struct Past<S: Simd> {
    before: Reprojected,
    read: f32x4<S>,
    rectified: f32x4<S>,
}

impl<'a> TaaFrame<'a> {
    pub(super) fn new(how: Upscaling, drawn: &'a UpscaleInputs<'a>, size: (u32, u32)) -> Self {
        let scale = how.scale();
        let place = drawn.frame.map_or(super::super::CENTRE, |seen| jitter(scale, seen.frames()));
        let history: Option<(Motion<'_>, _)> =
            drawn.frame.and_then(|seen| Some((seen.reprojection()?, &seen.history?.accumulated.as_ref()?.color)));
        let still = history.as_ref().filter(|(motion, _)| motion.is_still());
        let positions = jitter_positions(scale);
        let samples = drawn.color.size();
        let axis = |place: f64, length: u32, samples: u32| {
            (0..length).map(|at| AxisSamples::new(how.lattice(), place, at, samples)).collect()
        };
        Self {
            options: how.history(),
            colors: YCoCg::new(how.light()),
            drawn,
            size,
            columns: axis(place[0], size.0, samples.0),
            rows: axis(place[1], size.1, samples.1),
            history,
            most_weight: if still.is_some() { (positions - 1) as f32 } else { MOVING_WEIGHT },
            is_settled: still.is_some_and(|(motion, _)| motion.history.still_frames >= positions),
        }
    }

    pub(super) fn decoded_rows(&self) -> DecodedRows {
        DecodedRows::new(self.drawn.color.width())
    }

    /// Computes a row of the picture and of the history for the next frame.
    #[inline(always)]
    pub(super) fn row<S: Simd>(
        &self,
        simd: S,
        y: u32,
        decoded: &mut DecodedRows,
        (row, memory): (&mut [Rgba8], &mut [Quad]),
    ) {
        let rows = self.rows[y as usize];
        for index in rows.index {
            decoded.fill(index, |codes| self.colors.decoded(codes), self.drawn.color);
        }
        let [above, at, below] = rows.index.map(|index| decoded.row(index));
        let decoded = [above, at, below];
        // Neighbouring pixels share columns: only the last of three is new, if any.
        let mut held = self.columns[0].index;
        let mut columns = each!(place in [0, 1, 2] => Column::of_rows(simd, decoded, held[place], rows.weight));
        let mut nearest = self.nearest_columns(y);
        for (x, (pixel, memory)) in (0..).zip(row.iter_mut().zip(memory)) {
            let wanted = self.columns[x as usize].index;
            if wanted != held {
                columns = if wanted[0] == held[1] && wanted[1] == held[2] {
                    [columns[1], columns[2], Column::of_rows(simd, decoded, wanted[2], rows.weight)]
                } else {
                    each!(place in [0, 1, 2] => Column::of_rows(simd, decoded, wanted[place], rows.weight))
                };
                held = wanted;
            }
            let by = nearest.as_mut().map_or((x, y), |nearest| nearest.of(x));
            (*pixel, *memory) = self.blended(simd, (x, y), by, columns);
        }
    }

    /// Computes one pixel of the picture and of the history for the next frame.
    #[inline(always)]
    pub(super) fn pixel<S: Simd>(&self, simd: S, at: (u32, u32)) -> (Rgba8, Quad) {
        self.blended(simd, at, self.nearest(at), self.columns_around(simd, at))
    }

    /// Returns how one pixel is blended with its history.
    #[inline(always)]
    pub(super) fn step<S: Simd>(&self, simd: S, at: (u32, u32)) -> HistoryStep {
        let color = |quad: f32x4<S>| quad.to_array().first_chunk().copied().unwrap_or_default();
        let blend = self.blend(simd, at, self.nearest(at), self.columns_around(simd, at));
        let past = |past: Past<S>| PastColor {
            position_px: past.before.place,
            read: color(past.read),
            rectified: color(past.rectified),
        };
        HistoryStep {
            space: self.colors.space(),
            present: color(blend.present),
            share: blend.share,
            past: blend.past.map(past),
        }
    }

    /// Returns the three columns of samples around a pixel.
    #[inline(always)]
    fn columns_around<S: Simd>(&self, simd: S, (x, y): PixelAt) -> [Column<S>; 3] {
        let (columns, rows) = (self.columns[x as usize], self.rows[y as usize]);
        each!(column in [0, 1, 2] => Column::new(
            each!(row in [0, 1, 2] => {
                let codes = self.drawn.color.at(columns.index[column], rows.index[row]);
                f32x4::load_array(simd, self.colors.decoded(codes))
            }),
            rows.weight,
        ))
    }

    /// Returns the colour of a pixel and its history for the next frame.
    #[inline(always)]
    fn blended<S: Simd>(&self, simd: S, at: PixelAt, by: PixelAt, columns: [Column<S>; 3]) -> (Rgba8, Quad) {
        let blend = self.blend(simd, at, by, columns);
        let color = match blend.past {
            Ok(Past { rectified, .. }) => rectified + (blend.present - rectified) * blend.share,
            Err(_) => blend.present,
        };
        let color @ [y, co, cg, _] = color.to_array();
        let [.., alpha] = blend.present.to_array();
        (self.colors.encoded(color, alpha), [y, co, cg, blend.weight])
    }

    /// Returns how the samples around a pixel are blended with its history, which the vector of pixel `by` leads to.
    #[inline(always)]
    fn blend<S: Simd>(&self, simd: S, at: PixelAt, by: PixelAt, columns: [Column<S>; 3]) -> Blend<S> {
        let around = Samples::new(columns, &self.columns[at.0 as usize], &self.rows[at.1 as usize]);
        let Samples { present, confidence, .. } = around;
        let history = self.history.as_ref().ok_or(Rejection::FirstFrame);
        let (before, memory) = match history.and_then(|(motion, memory)| Ok((motion.reproject_by(at, by)?, memory))) {
            Ok(found) => found,
            Err(rejection) => return Blend { present, past: Err(rejection), share: 1.0, weight: confidence },
        };
        let read = self.read(simd, memory, &before);
        let [.., weight] = read.to_array();
        let weight = weight.max(0.0).min(self.most_weight);
        let rectified = if before.is_still { read } else { around.rectified(simd, read, self.options.rectification) };
        let mut share = if self.is_settled { 0.0 } else { confidence / (weight + confidence) };
        if self.options.luminance_weighting {
            let [now, then] = [present, rectified].map(|color| self.luminance_weight(color.to_array()[0]));
            share = share * now / (share * now + (1.0 - share) * then);
        }
        Blend { present, past: Ok(Past { before, read, rectified }), share, weight: weight + confidence }
    }

    /// Returns the weight of a colour of luminance `y`: 1 / (1 + y), with y in [0, 1].
    fn luminance_weight(&self, y: f32) -> f32 {
        let white = self.colors.white();
        white / (white + y.max(0.0))
    }

    /// Returns the pixel with the nearest surface among the 3 × 3 around a pixel, or the pixel itself in a still view.
    fn nearest(&self, (x, y): PixelAt) -> PixelAt {
        self.nearest_columns(y).map_or((x, y), |mut columns| columns.of(x))
    }

    /// Returns the search for the nearest surfaces around the pixels of a row; `None` in a still view.
    #[inline(always)]
    fn nearest_columns(&self, y: u32) -> Option<NearestSearch<'_>> {
        self.history.as_ref()?.0.vectors?;
        Some(NearestSearch::new(&self.drawn.frame?.gbuffer.distance, y))
    }

    /// Reads the history at a position.
    #[inline(always)]
    fn read<S: Simd>(&self, simd: S, memory: &Image<Quad>, before: &Reprojected) -> f32x4<S> {
        if before.is_still {
            return f32x4::load_array(simd, memory.at(before.place[0] as u32, before.place[1] as u32));
        }
        let [x, y] = before.place;
        let (column, right) = whole_and_fraction(x);
        let (row, down) = whole_and_fraction(y);
        let (last_column, last_row) = (i64::from(self.size.0) - 1, i64::from(self.size.1) - 1);
        if self.options.filter == HistoryFilter::Bilinear {
            let [above, below] = each!(at in [row, row + 1] => {
                let left = self.clamped(simd, memory, (column, at));
                left * (1.0 - right) + self.clamped(simd, memory, (column + 1, at)) * right
            });
            return above * (1.0 - down) + below * down;
        }
        if (1..last_column - 1).contains(&column) && (1..last_row - 1).contains(&row) {
            let first = (row - 1) as usize * self.size.0 as usize + (column - 1) as usize;
            return self.interior(simd, &memory.pixels()[first..], [right, down]);
        }
        let ([a, b, c, d], vertical) = (catmull_rom(right), catmull_rom(down));
        let mut sum = f32x4::splat(simd, 0.0);
        for (number, weight) in (-1..).zip(vertical) {
            let [e, f, g, h] = each!(by in [-1, 0, 1, 2] => self.clamped(simd, memory, (column + by, row + number)));
            sum += (e * a + f * b + g * c + h * d) * weight;
        }
        sum
    }

    /// Reads the pixel of the history at a position, or the nearest pixel.
    #[inline(always)]
    fn clamped<S: Simd>(&self, simd: S, memory: &Image<Quad>, (column, row): (i64, i64)) -> f32x4<S> {
        let column = column.clamp(0, i64::from(self.size.0) - 1) as usize;
        let row = row.clamp(0, i64::from(self.size.1) - 1) as usize;
        f32x4::load_array_ref(simd, &memory.pixels()[row * self.size.0 as usize + column])
    }

    /// Filters 4 × 4 pixels of the history with Catmull-Rom weights; `from` starts with the first of them.
    #[inline(always)]
    fn interior<S: Simd>(&self, simd: S, from: &[Quad], [right, down]: [f32; 2]) -> f32x4<S> {
        let ([a, b, c, d], vertical) = (catmull_rom(right), catmull_rom(down));
        let mut sum = f32x4::splat(simd, 0.0);
        for (row, weight) in from.chunks(self.size.0 as usize).zip(vertical) {
            let Some([first, second, third, fourth]) = row.first_chunk() else { return sum };
            let [e, f, g, h] = each!(quad in [first, second, third, fourth] => f32x4::load_array_ref(simd, quad));
            sum += (e * a + f * b + g * c + h * d) * weight;
        }
        sum
    }

    /// Returns the samples that contribute to a pixel. Those that only rectify the history have weight 0.
    pub(super) fn taps(&self, (x, y): (u32, u32)) -> Vec<Tap> {
        let (columns, rows) = (self.columns[x as usize], self.rows[y as usize]);
        let sum: f32 = columns.weight.iter().sum::<f32>() * rows.weight.iter().sum::<f32>();
        let mut taps: Vec<Tap> = Vec::new();
        for (y, vertical) in rows.index.into_iter().zip(rows.weight) {
            for (x, horizontal) in columns.index.into_iter().zip(columns.weight) {
                let weight = horizontal * vertical / sum;
                match taps.iter_mut().find(|tap| (tap.x, tap.y) == (x, y)) {
                    Some(tap) => tap.weight += weight,
                    None => taps.push(Tap { x, y, weight }),
                }
            }
        }
        taps
    }
}

/// Returns the weights of four adjacent values for an interpolation at `t` in [0, 1) between the second and the third
/// (Catmull and Rom, “A Class of Local Interpolating Splines”, 1974).
#[inline(always)]
pub(super) fn catmull_rom(t: f32) -> [f32; 4] {
    [
        ((-0.5 * t + 1.0) * t - 0.5) * t,
        (1.5 * t - 2.5) * t * t + 1.0,
        ((-1.5 * t + 2.0) * t + 0.5) * t,
        (0.5 * t - 0.5) * t * t,
    ]
}

impl AxisSamples {
    /// Returns the samples around output column or row `at`, out of `samples` samples of a lattice. They lie at `place`
    /// within their areas.
    fn new(lattice: Lattice, place: f64, at: u32, samples: u32) -> Self {
        let ThreeSamples { index, from_nearest } = lattice.three_around(place, at, samples);
        let weight = [-1.0, 0.0, 1.0].map(|number: f64| {
            if lattice.scale == Scale::ONE {
                return if number == 0.0 { 1.0 } else { 0.0 };
            }
            let distance = (number - f64::from(from_nearest)) * lattice.scale.value();
            (-SHARPNESS * distance * distance).exp() as f32
        });
        Self { index, weight, total: weight.iter().sum() }
    }
}

impl<S: Simd> Column<S> {
    /// Computes column `place` of three decoded rows.
    #[inline(always)]
    fn of_rows(simd: S, rows: [&[Quad]; 3], place: u32, weights: [f32; 3]) -> Self {
        Self::new(each!(row in [0, 1, 2] => f32x4::load_array_ref(simd, &rows[row][place as usize])), weights)
    }

    /// Computes the column of three samples with the vertical weights of a row.
    #[inline(always)]
    fn new([above, at, below]: [f32x4<S>; 3], [a, b, c]: [f32; 3]) -> Self {
        Self {
            weighted: above * a + at * b + below * c,
            least: above.min(at).min(below),
            greatest: above.max(at).max(below),
            sum: above + at + below,
            squares: above * above + at * at + below * below,
        }
    }
}

impl<S: Simd> Samples<S> {
    /// Combines three columns with the horizontal weights of a column and the vertical weights of a row.
    #[inline(always)]
    fn new([left, at, right]: [Column<S>; 3], columns: &AxisSamples, rows: &AxisSamples) -> Self {
        let [a, b, c] = columns.weight;
        let confidence = columns.total * rows.total;
        Self {
            present: (left.weighted * a + at.weighted * b + right.weighted * c) * (1.0 / confidence),
            confidence: confidence.min(1.0),
            least: left.least.min(at.least).min(right.least),
            greatest: left.greatest.max(at.greatest).max(right.greatest),
            sum: left.sum + at.sum + right.sum,
            squares: left.squares + at.squares + right.squares,
        }
    }

    /// Returns the history changed to agree with the samples. The fourth number is not meaningful.
    #[inline(always)]
    fn rectified(&self, simd: S, past: f32x4<S>, by: Rectification) -> f32x4<S> {
        match by {
            Rectification::None => past,
            Rectification::Clamp => past.max(self.least).min(self.greatest),
            Rectification::Clip => {
                clipped(simd, past, (self.least + self.greatest) * 0.5, (self.greatest - self.least) * 0.5)
            }
            Rectification::Variance => {
                let (mean, mean_square) = (self.sum * (1.0 / 9.0), self.squares * (1.0 / 9.0));
                let variance = (mean_square - mean * mean).max(f32x4::splat(simd, 0.0));
                clipped(simd, past, mean, variance.sqrt())
            }
        }
    }
}

/// Moves a colour straight towards the middle of a box until it is inside. `half` is half of the size of the box.
#[inline(always)]
fn clipped<S: Simd>(simd: S, color: f32x4<S>, middle: f32x4<S>, half: f32x4<S>) -> f32x4<S> {
    // Avoids a division by zero in boxes without extent; far below a step of 8-bit codes.
    const LEAST_HALF: f32 = 1e-6;
    let offset = color - middle;
    let [y, co, cg, _] = (offset.abs() / half.max(f32x4::splat(simd, LEAST_HALF))).to_array();
    let farthest = y.max(co).max(cg);
    if farthest > 1.0 { middle + offset * (1.0 / farthest) } else { color }
}
