//! NVIDIA Image Scaling (NVScaler): a separable six-tap filter, blended with sharpening filters along detected edges.
//!
//! The implementation follows the description and the tables of the NVIDIA Image Scaling SDK 1.0.3 (2022):
//!
//! 1. At each sample, four gradients tell the strength of edges at 0°, 45°, 90° and 135°. They are the weights of the
//!    directional filters, interpolated bilinearly at the output pixel.
//! 2. A directional filter interpolates linearly along the edge, and by six taps across it. It adds an unsharp mask,
//!    which is weaker on bright pixels and where it would ring. The rest of the weight goes to a separable filter.
//! 3. All filters work on luma. The colour is interpolated bilinearly and moved to the filtered luma.
//!
//! Alpha, which the SDK leaves to the application, is interpolated bilinearly. Values are sRGB codes, as required.

mod coefficients;
mod kernel;
mod rows;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use kernel::{DIRECTIONS, Patch, RunPhase, Sharpness, lerp, luma};
use rows::{BEFORE, LUMA, Rows, SampleRow};

use super::choice::MAX_SHARPENING;
use super::fsr::SCALES;
use super::runs::{Run, RunTable};
use super::{Anchor, FilterSpace, Offers, Sampling, Tap, UpscaleInputs, Upscaler, Upscaling, bands};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Edge-adaptive scaling with directional sharpening.
pub(crate) static NIS: Nis = Nis;

/// [`Upscaler`] implementation of [`NIS`].
pub(crate) struct Nis;

/// Number of samples around an output pixel along each axis.
const TAPS: usize = coefficients::TAPS;

impl Upscaler for Nis {
    fn id(&self) -> &'static str {
        "nis"
    }

    fn name(&self) -> &'static str {
        "NIS"
    }

    fn help(&self) -> &'static str {
        "Six taps along rows and columns, and along detected edges in four directions, with an unsharp mask that spares \
         bright pixels and one-sided contrast. Good on straight edges at multiples of 45°. Works on luma: colours are \
         only bilinear, so edges between colours of equal luma blur; texture may be taken for edges. Source: NVIDIA \
         Image Scaling SDK 1.0.3, NVScaler (2022)."
    }

    fn artefacts(&self) -> &'static str {
        "edges between colours of equal luma blur, texture is taken for edges"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: SCALES,
            anchors: &[Anchor::Centre, Anchor::Corner],
            lights: &[FilterSpace::Bytes],
            deringing: false,
            sharpening: true,
            history: false,
        }
    }

    fn alters_samples(&self) -> bool {
        true
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        fill(Lanes::best(), how, drawn.color, full);
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Rgba8 {
        let (cell, phase) = (how.lattice().place(y).cell, RunPhase::new(how.lattice(), x, y));
        let mut rows = Rows::new(drawn.color);
        on_lanes!(Lanes::best(), simd => {
            rows.advance(simd, cell);
            RunInputs::new(&rows, cell, Run { phase: &phase, offset: 0 }).pixels(simd, &sharpness(how))[0]
        })
    }

    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Vec<Tap> {
        let [column, row] = [x, y].map(|at| how.lattice().place(at).cell);
        let inside = |at: i32, length: u32| at.clamp(0, length as i32 - 1) as u32;
        let weights = weights(drawn.color, &RunPhase::new(how.lattice(), x, y), row);
        let mut sums: BTreeMap<(u32, u32), f32> = BTreeMap::new();
        for (down, weights) in (row - BEFORE..).zip(weights) {
            for (across, weight) in (column - BEFORE..).zip(weights) {
                let sample = (inside(down, drawn.color.height()), inside(across, drawn.color.width()));
                *sums.entry(sample).or_default() += weight;
            }
        }
        let tap = |((row, column), weight)| {
            let (x, y) = how.grid().pixel(column, row);
            Tap { x, y, weight }
        };
        sums.into_iter().map(tap).collect()
    }
}

/// Returns the weights of the samples around the first pixel of a run in the row of cells `cell`, row by row. Without
/// sharpening the filter is linear, so its response to an impulse is the weight of the sample.
fn weights(drawn: &Image<Rgba8>, phase: &RunPhase, cell: i32) -> [[f32; TAPS]; TAPS] {
    let mut rows = Rows::new(drawn);
    on_lanes!(Lanes::best(), simd => {
        rows.advance(simd, cell);
        let edges = RunInputs::new(&rows, cell, Run { phase, offset: 0 }).edges(simd);
        std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let mut impulse = [[f32x16::splat(simd, 0.0); TAPS]; TAPS];
                impulse[row][column] = f32x16::splat(simd, 1.0);
                luma(simd, &impulse, phase, edges, &Sharpness::NONE).to_array()[0]
            })
        })
    })
}

/// Returns the sharpness of the directional filters.
fn sharpness(how: Upscaling) -> Sharpness {
    Sharpness::new(how.sharpening() as f32 / MAX_SHARPENING as f32)
}

/// Upscales samples into an image. The result does not depend on `lanes`.
fn fill(lanes: Lanes, how: Upscaling, drawn: &Image<Rgba8>, full: &mut Image<Rgba8>) {
    let (lattice, width) = (how.lattice(), full.width() as usize);
    let table = RunTable::new(lanes, lattice, |x, y| RunPhase::new(lattice, x, y));
    let job = FillJob { table, sharpness: sharpness(how) };
    bands::fill(full, lattice.scale, |first, _, band| {
        let mut rows = Rows::new(drawn);
        for (row, y) in band.chunks_exact_mut(width).zip(first..) {
            on_lanes!(lanes, simd => job.fill_row(simd, &mut rows, y, row));
        }
    });
}

/// Inputs of an image to fill, shared by its bands.
struct FillJob {
    table: RunTable<RunPhase>,
    sharpness: Sharpness,
}

impl FillJob {
    /// Fills output row `y`.
    #[inline(always)]
    fn fill_row<S: Simd>(&self, simd: S, rows: &mut Rows<'_>, y: u32, row: &mut [Rgba8]) {
        let cell = self.table.lattice.place(y).cell;
        rows.advance(simd, cell);
        let mut runs = self.table.runs(0, y);
        for pixels in row.chunks_mut(WIDE) {
            let run = RunInputs::new(rows, cell, runs.advance()).pixels(simd, &self.sharpness);
            pixels.copy_from_slice(&run[..pixels.len()]);
        }
    }
}

/// Rows around a run of output pixels.
struct RunInputs<'a> {
    samples: [&'a SampleRow; TAPS],
    edges: [&'a [Vec<f32>; DIRECTIONS]; 2],
    run: Run<'a, RunPhase>,
}

impl<'a> RunInputs<'a> {
    #[inline(always)]
    fn new(rows: &'a Rows<'_>, cell: i32, run: Run<'a, RunPhase>) -> Self {
        Self { samples: rows.around(cell), edges: rows.edges(cell), run }
    }

    /// Interpolates bilinearly between the values at the four nearest samples: above left and right, below left and
    /// right.
    #[inline(always)]
    fn bilinear<S: Simd>(&self, simd: S, [a, b, c, d]: [f32x16<S>; 4]) -> f32x16<S> {
        let x = f32x16::load_array_ref(simd, &self.run.phase.x);
        lerp(lerp(a, b, x), lerp(c, d, x), f32x16::splat(simd, self.run.phase.y))
    }

    /// Returns the weights of the directional filters.
    #[inline(always)]
    fn edges<S: Simd>(&self, simd: S) -> [f32x16<S>; DIRECTIONS] {
        each!(direction in [0, 1, 2, 3] => {
            let nearest = each!((row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] => {
                self.run.phase.cells.pick(simd, &self.edges[row][direction], self.run.offset + column)
            });
            self.bilinear(simd, nearest)
        })
    }

    /// Returns the luma of the samples around the pixels.
    #[inline(always)]
    fn patch<S: Simd>(&self, simd: S) -> Patch<S> {
        each!(row in [0, 1, 2, 3, 4, 5] => {
            each!(column in [-2, -1, 0, 1, 2, 3] => {
                self.run.phase.cells.pick(simd, &self.samples[row].luma, self.run.offset + column)
            })
        })
    }

    /// Returns bilinearly interpolated colours: red, green, blue and alpha codes.
    #[inline(always)]
    fn color<S: Simd>(&self, simd: S) -> [f32x16<S>; 4] {
        let nearest = each!((row, column) in [(2, 0), (2, 1), (3, 0), (3, 1)] => {
            let [low, high] = each!(half in [0, 1] => {
                self.run.phase.cells.pick_words(simd, half, &self.samples[row].packed, self.run.offset + column)
            });
            low.combine(high)
        });
        each!(channel in [0_u32, 1, 2, 3] => {
            self.bilinear(simd, each!(corner in [0, 1, 2, 3] => float_of((nearest[corner] >> (8 * channel)) & 255)))
        })
    }

    /// Computes the pixels of the run.
    #[inline(always)]
    fn pixels<S: Simd>(&self, simd: S, sharpness: &Sharpness) -> [Rgba8; WIDE] {
        let luma = luma(simd, &self.patch(simd), self.run.phase, self.edges(simd), sharpness);
        let [red, green, blue, alpha] = self.color(simd);
        let change = luma * 255.0 - (red * LUMA[0] + green * LUMA[1] + blue * LUMA[2]);
        let [red, green, blue, alpha] =
            each!(value in [red + change, green + change, blue + change, alpha] => code_of(value));
        (red | green << 8 | blue << 16 | alpha << 24).to_array().map(u32::to_le_bytes)
    }
}

/// Clamps values to [0, 255] and rounds them to integers, ties to even.
#[inline(always)]
fn code_of<S: Simd>(value: f32x16<S>) -> u32x16<S> {
    /// 2²³: adding it to a float rounds the float to an integer, which is then the low byte of the bit pattern.
    const WHOLE: f32 = (1 << 23) as f32;
    (value.max(0.0).min(255.0) + WHOLE).bitcast::<u32x16<S>>() & 255
}
