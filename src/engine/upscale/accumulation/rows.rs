//! SIMD version of [`FrameContext::pixel`] for whole rows, with bit-identical results.
//!
//! A row is processed in blocks of 16 pixels. Each sample of this frame is decoded once. In a still view, history is
//! read at the same pixel; otherwise it is gathered at the reprojected positions.

use super::{FrameContext, INTERPOLATED, JITTER_POSITIONS};
use crate::image::color::CodeValues;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::motion::MotionVectors;
use crate::upscale::history::PastPlaces;
use crate::upscale::planes::SampleLanes;
use crate::upscale::quads::{Quad, columns, store, window, with_spare};
use crate::upscale::row_parts::{OutputRow, RowBlock};
use crate::upscale::{FilterSpace, Scale, bands};

/// Value for pixels without history, marked by a negative sample count.
const NO_HISTORY: Quad = [0.0, 0.0, 0.0, -1.0];

/// Position of an output column or row among the samples of this frame.
#[derive(Clone, Copy)]
struct AxisPosition {
    /// Indices of the samples before and after the column or row, clamped to the image.
    between: [u32; 2],
    /// Interpolation weight of the second sample, in [0, 1).
    on: f32,
    /// Index of the sample that lies inside the column or row, if any.
    own: Option<u32>,
    /// One plus the index of the lattice position nearest to the column or row. It is 0 if that position lies before
    /// the first sample.
    nearest: usize,
    /// Index of the pixel of the G-buffer that is nearest to the column or row.
    surface: u32,
}

/// Computes the full image, and in `memory` the history for the next frame.
pub(super) fn fill(lanes: Lanes, now: &FrameContext<'_>, full: &mut Image<Rgba8>, memory: &mut Image<Quad>) {
    let (width, height) = full.size();
    let samples = now.drawn.color.size();
    let columns: Vec<_> = (0..width).map(|x| now.axis(0, x, samples.0)).collect();
    let frame = RowContext {
        now,
        nearest: with_spare(&columns, |column| column.nearest as u32),
        surfaces: with_spare(&columns, |column| column.surface),
        columns,
        rows: (0..height).map(|y| now.axis(1, y, samples.1)).collect(),
    };
    bands::fill_both(full, memory, |first, full, memory| {
        let mut scratch = RowScratch::new(width as usize, samples.0 as usize);
        for row in OutputRow::split_band(first, width as usize, full, memory) {
            on_lanes!(lanes, simd => frame.row(simd, &mut scratch, row));
        }
    });
}

impl FrameContext<'_> {
    /// Returns the position of output column or row `at` among the `samples` samples of this frame.
    fn axis(&self, axis: usize, at: u32, samples: u32) -> AxisPosition {
        let (cell, on) = self.lattice.coordinate(self.place[axis], at);
        let inside = |index: i64| index.clamp(0, i64::from(samples) - 1) as u32;
        let nearest = cell + i64::from(on > 0.5);
        AxisPosition {
            between: [inside(cell), inside(cell + 1)],
            on,
            own: self.own(cell, on, samples),
            nearest: (nearest + 1).max(0) as usize,
            surface: self.lattice.nearest(at, samples),
        }
    }
}

/// Number of bytes loaded at a time.
const BYTES: usize = 4 * WIDE;

/// Loads bytes from index `at` on; bytes past the end are zero.
#[inline(always)]
fn bytes<S: Simd>(simd: S, of: &[u8], at: usize) -> u8x64<S> {
    match of[at..].first_chunk::<BYTES>() {
        Some(codes) => u8x64::load_array_ref(simd, codes),
        None => {
            let mut codes = [0; BYTES];
            codes[..of.len() - at].copy_from_slice(&of[at..]);
            u8x64::load_array(simd, codes)
        }
    }
}

#[inline(always)]
fn store_bytes<S: Simd>(codes: u8x64<S>, to: &mut [u8], at: usize) {
    codes.store_slice(&mut to[at..at + BYTES]);
}

/// State shared by all rows of an image.
struct RowContext<'a> {
    now: &'a FrameContext<'a>,
    columns: Vec<AxisPosition>,
    /// [`AxisPosition::nearest`] and [`AxisPosition::surface`] of all columns. Those of sixteen can be loaded from every
    /// column.
    nearest: Vec<u32>,
    surfaces: Vec<u32>,
    rows: Vec<AxisPosition>,
}

/// Scratch buffers for an output row.
struct RowScratch {
    /// Colour of each output pixel from this frame's samples alone; `counts_for` holds the weight of that colour in the
    /// accumulation.
    present: Vec<Quad>,
    counts_for: Vec<f32>,
    /// Decoded sample rows above and below the output row; `light_of` holds the indices of these rows.
    light: [Vec<Quad>; 2],
    light_of: [Option<u32>; 2],
    /// Per-channel minimum and maximum of three vertically adjacent samples, with the border columns repeated.
    codes: [Vec<u8>; 2],
    /// Decoded minimum and maximum of the 3 × 3 neighbourhood for red, green and blue, indexed by
    /// [`AxisPosition::nearest`].
    bounds: [[Vec<f32>; 3]; 2],
    /// Motion vectors of a row of surfaces, with its index. Those of surfaces that the previous frame does not show are
    /// NaN.
    vectors: [Vec<f32>; 2],
    vectors_of: Option<u32>,
}

impl RowScratch {
    fn new(width: usize, samples: usize) -> Self {
        let width = width.next_multiple_of(WIDE);
        Self {
            present: vec![[0.0; 4]; width],
            counts_for: vec![1.0; width],
            light: [0, 1].map(|_| vec![[0.0; 4]; samples]),
            light_of: [None; 2],
            codes: [0, 1].map(|_| vec![0; (4 * (samples + 4)).next_multiple_of(BYTES) + BYTES]),
            bounds: [0; 2].map(|_| [0; 3].map(|_| vec![0.0; samples + 2 + WIDE])),
            vectors: [0; 2].map(|_| vec![0.0; samples + WIDE]),
            vectors_of: None,
        }
    }
}

/// Output colours of 16 pixels, and their history for the next frame.
struct OutputBlock<'a> {
    pixels: &'a mut [Rgba8; WIDE],
    history: &'a mut [Quad; WIDE],
}

impl RowContext<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, scratch: &mut RowScratch, OutputRow { y, pixels, history }: OutputRow<'_>) {
        self.present(simd, y, scratch);
        if let Some(vectors) = self.now.history.as_ref().and_then(|(motion, _)| motion.vectors) {
            self.bounds(simd, y, scratch);
            self.vectors(vectors, y, scratch);
        }
        let (pixels, last_pixels) = pixels.as_chunks_mut::<WIDE>();
        let (history, last_history) = history.as_chunks_mut::<WIDE>();
        let mut from = 0;
        for (pixels, history) in pixels.iter_mut().zip(history) {
            self.block(simd, RowBlock { from, y }, scratch, OutputBlock { pixels, history });
            from += WIDE;
        }
        if !last_pixels.is_empty() {
            let (mut pixels, mut history) = ([[0; 4]; WIDE], [[0.0; 4]; WIDE]);
            let block = OutputBlock { pixels: &mut pixels, history: &mut history };
            self.block(simd, RowBlock { from, y }, scratch, block);
            last_pixels.copy_from_slice(&pixels[..last_pixels.len()]);
            last_history.copy_from_slice(&history[..last_history.len()]);
        }
    }

    /// Computes the colour of each pixel in a row from this frame's samples alone: the weighted mean of the samples
    /// that [`FrameContext::present`] selects.
    #[inline(always)]
    fn present<S: Simd>(&self, simd: S, y: u32, scratch: &mut RowScratch) {
        let color = self.now.drawn.color;
        let RowScratch { present, counts_for, light, light_of, .. } = scratch;
        if self.now.lattice.scale == Scale::ONE {
            self.now.decode(simd, color.row(y), present);
            return;
        }
        let row = self.rows[y as usize];
        // Consecutive output rows usually read the same two sample rows, or the lower sample row becomes the upper one.
        if light_of[1] == Some(row.between[0]) {
            light.swap(0, 1);
            light_of.swap(0, 1);
        }
        for (light, (known, row)) in light.iter_mut().zip(light_of.iter_mut().zip(row.between)) {
            if *known != Some(row) {
                self.now.decode(simd, color.row(row), light);
                *known = Some(row);
            }
        }
        let [above, below] = light;
        let own_row = row.own.map(|own| if own == row.between[0] { above.as_slice() } else { below.as_slice() });
        let pixels = present.iter_mut().zip(counts_for).zip(&self.columns);
        for (x, ((pixel, counts_for), column)) in (0..).zip(pixels) {
            if let (Some(light), Some(own)) = (own_row, column.own) {
                (*pixel, *counts_for) = (light[own as usize], 1.0);
                continue;
            }
            *counts_for = INTERPOLATED;
            let [left, right] = column.between.map(|column| column as usize);
            if left == right || row.between[0] == row.between[1] {
                *pixel = self.now.mean(&self.now.present((x, y)).taps);
                continue;
            }
            let mut sum = f32x4::splat(simd, 0.0);
            for (light, vertical) in [(&above, 1.0 - row.on), (&below, row.on)] {
                sum += f32x4::load_array_ref(simd, &light[left]) * ((1.0 - column.on) * vertical);
                sum += f32x4::load_array_ref(simd, &light[right]) * (column.on * vertical);
            }
            sum.store_array(pixel);
        }
    }

    /// Computes the minimum and maximum of 3 × 3 samples, centred on each sample that can be the nearest one to a pixel
    /// of row `y`.
    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S, y: u32, scratch: &mut RowScratch) {
        let color = self.now.drawn.color;
        let (width, height) = (color.width() as usize, color.height() as usize);
        let nearest = self.rows[y as usize].nearest;
        let rows = nearest.saturating_sub(2)..(nearest + 1).min(height);
        let [least, greatest] = &mut scratch.codes;
        let rows = each!(by in [0, 1, 2] => color.row((rows.start + by).min(rows.end - 1) as u32).as_flattened());
        // Two copies of the first column precede it, and two copies of the last column follow it.
        let codes = 4 * width;
        for at in (0..codes).step_by(BYTES) {
            // The last block overlaps the previous one, so that it does not exceed the row.
            let at = at.min(codes.saturating_sub(BYTES));
            let [a, b, c] = each!(row in [0, 1, 2] => bytes(simd, rows[row], at));
            store_bytes(a.min(b).min(c), least, at + 8);
            store_bytes(a.max(b).max(c), greatest, at + 8);
        }
        for of in [&mut *least, &mut *greatest] {
            of.copy_within(8..12, 0);
            of.copy_within(8..12, 4);
            of.copy_within(codes + 4..codes + 8, codes + 8);
            of.copy_within(codes + 4..codes + 8, codes + 12);
        }
        for at in (0..codes + 8).step_by(BYTES) {
            let [a, b, c] = each!(by in [0, 4, 8] => bytes(simd, least, at + by));
            store_bytes(a.min(b).min(c), least, at);
            let [a, b, c] = each!(by in [0, 4, 8] => bytes(simd, greatest, at + by));
            store_bytes(a.max(b).max(c), greatest, at);
        }
        for (codes, bounds) in [least, greatest].into_iter().zip(&mut scratch.bounds) {
            self.now.decode_planes(simd, codes, bounds);
        }
    }

    /// Reads the motion vectors of the surfaces nearest to row `y`.
    fn vectors(&self, of: &MotionVectors, y: u32, scratch: &mut RowScratch) {
        let row = self.rows[y as usize].surface;
        if scratch.vectors_of.replace(row) == Some(row) {
            return;
        }
        let [across_px, down_px] = &mut scratch.vectors;
        for column in 0..of.visible.width() {
            let vector = of.visible_vector((column, row)).unwrap_or([f32::NAN; 2]);
            [across_px[column as usize], down_px[column as usize]] = vector;
        }
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, at: RowBlock, scratch: &RowScratch, output: OutputBlock<'_>) {
        let RowBlock { from, y } = at;
        let OutputBlock { pixels, history } = output;
        let present = columns(simd, &scratch.present.as_chunks().0[from / WIDE]);
        let counts_for = f32x16::load_array_ref(simd, &scratch.counts_for.as_chunks().0[from / WIDE]);
        let Some((motion, past)) = &self.now.history else {
            let [red, green, blue, alpha] = present;
            store([red, green, blue, counts_for], history);
            return self.now.encode(simd, present, alpha, pixels);
        };
        let past = if motion.vectors.is_some() {
            self.gather(simd, past, at, scratch)
        } else {
            let past = &past.row(y)[from..];
            match past.first_chunk::<WIDE>() {
                Some(block) => columns(simd, block),
                None => {
                    let mut block = [NO_HISTORY; WIDE];
                    block[..past.len()].copy_from_slice(past);
                    columns(simd, &block)
                }
            }
        };
        let alpha = present[3];
        let count = past[3];
        let known = count.simd_ge(f32x16::splat(simd, 0.0));
        let count = count.min((JITTER_POSITIONS - 1) as f32);
        let share = if self.now.is_settled { f32x16::splat(simd, 0.0) } else { counts_for / (count + counts_for) };
        let [red, green, blue] = each!(channel in [0, 1, 2] => {
            let (past, now) = (past[channel], present[channel]);
            known.select(past + (now - past) * share, now)
        });
        let mean = [red, green, blue, known.select(count + counts_for, counts_for)];
        store(mean, history);
        self.now.encode(simd, mean, alpha, pixels);
    }

    /// Returns the history of 16 pixels at their reprojected positions, clamped to the range of the 3 × 3 nearest samples of
    /// this frame.
    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, past: &Image<Quad>, at: RowBlock, scratch: &RowScratch) -> [f32x16<S>; 4] {
        let surfaces = SampleLanes::ascending(simd, window(&self.surfaces, at.from));
        let vectors = each!(axis in [0, 1] => surfaces.read(simd, &scratch.vectors[axis]));
        let places = PastPlaces::new(simd, at, vectors, self.now.size);
        let mut block = [NO_HISTORY; WIDE];
        places.read_bilinear(simd, past, &mut block);
        let [red, green, blue, count] = columns(simd, &block);
        let (past, nearest) = ([red, green, blue], SampleLanes::ascending(simd, window(&self.nearest, at.from)));
        let [least, greatest] = each!(bound in [0, 1] => {
            each!(channel in [0, 1, 2] => nearest.read(simd, &scratch.bounds[bound][channel]))
        });
        let [red, green, blue] = each!(i in [0, 1, 2] => past[i].min(greatest[i]).max(least[i]));
        [red, green, blue, count]
    }
}

impl FrameContext<'_> {
    /// Decodes samples to the working colour space; alpha stays an 8-bit value.
    #[inline(always)]
    fn decode<S: Simd>(&self, simd: S, samples: &[Rgba8], light: &mut [Quad]) {
        let table = self.table();
        let (runs, rest) = samples.as_chunks::<WIDE>();
        let (wide, narrow) = light.split_at_mut((runs.len() * WIDE).min(light.len()));
        for (light, run) in wide.as_chunks_mut().0.iter_mut().zip(runs) {
            let words = u8x64::from_slice(simd, run.as_flattened()).bitcast::<u32x16<S>>();
            let [red, green, blue] = table.of_pixels(simd, words);
            store([red, green, blue, float_of(words >> 24)], light);
        }
        let values = &table.values;
        for (light, [r, g, b, a]) in narrow.iter_mut().zip(rest) {
            *light = [values[*r as usize], values[*g as usize], values[*b as usize], f32::from(*a)];
        }
    }

    /// Decodes the red, green and blue codes of samples to the working colour space. Decodes up to fifteen more.
    #[inline(always)]
    fn decode_planes<S: Simd>(&self, simd: S, codes: &[u8], planes: &mut [Vec<f32>; 3]) {
        let table = self.table();
        for (from, codes) in (0..planes[0].len() / WIDE * WIDE).step_by(WIDE).zip(codes.as_chunks::<BYTES>().0) {
            let words = u8x64::load_array_ref(simd, codes).bitcast::<u32x16<S>>();
            for (plane, values) in planes.iter_mut().zip(table.of_pixels(simd, words)) {
                values.store_slice(&mut plane[from..from + WIDE]);
            }
        }
    }

    fn table(&self) -> &'static CodeValues {
        match self.light {
            FilterSpace::Linear => &self.tables.linear_of_code,
            FilterSpace::Bytes => &self.tables.code,
        }
    }

    /// Encodes 16 pixels from working-space colours and 8-bit alpha values.
    #[inline(always)]
    fn encode<S: Simd>(&self, simd: S, light: [f32x16<S>; 4], alpha: f32x16<S>, pixels: &mut [Rgba8; WIDE]) {
        let [red, green, blue, _] = light;
        let colors = match self.light {
            FilterSpace::Linear => self.tables.encode_pixels(simd, [red, green, blue]),
            FilterSpace::Bytes => {
                let [red, green, blue] = each!(channel in [red, green, blue] => whole_part(channel + 0.5));
                red | green << 8 | blue << 16
            }
        };
        let words = colors | whole_part(alpha + 0.5) << 24;
        words.bitcast::<u8x64<S>>().store_slice(pixels.as_flattened_mut());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::history::tests::frames;
    use crate::upscale::{UpscaleInputs, Upscaling};

    #[test]
    fn rows_are_bit_identical_to_single_pixels() {
        let mut random = fastrand::Rng::with_seed(8);
        let chosen =
            [(Scale::ONE, FilterSpace::Linear), (Scale::TWO, FilterSpace::Linear), (Scale::TWO, FilterSpace::Bytes)];
        for (scale, light) in chosen {
            let how = Upscaling::new("accumulation", scale).unwrap().with_light(light);
            for (size, number) in [((1, 1), 0), ((5, 3), 4), ((75, 9), 0), ((75, 9), 7), ((64, 6), 13), ((140, 5), 2)] {
                let (columns, rows) = (how.lattice().samples(size.0), how.lattice().samples(size.1));
                let color = Image::from_fn(columns, rows, |_, _| std::array::from_fn(|_| random.u8(..)));
                for frames in frames(how, size, number) {
                    let drawn = UpscaleInputs { color: &color, frame: Some(frames.seen()) };
                    let now = FrameContext::new(how, &drawn, size);
                    for lanes in Lanes::all() {
                        let mut full = Image::filled(size.0, size.1, [1, 2, 3, 4]);
                        let mut memory = Image::filled(size.0, size.1, [-7.0; 4]);
                        fill(lanes, &now, &mut full, &mut memory);
                        for at in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
                            let context = || format!("{} {size:?} {number} {at:?} {}", how.label(), lanes.name());
                            assert_eq!(full.at(at.0, at.1), now.pixel(at), "{}", context());
                            assert_eq!(memory.at(at.0, at.1), now.blend_history(at, &now.present(at)), "{}", context());
                        }
                    }
                }
            }
        }
    }
}
