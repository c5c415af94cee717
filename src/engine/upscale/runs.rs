//! Runs of adjacent output pixels, whose samples and weights repeat with the lattice.
//!
//! Eight output pixels lie in at most eight adjacent cells. A value per pixel is therefore loaded with its neighbours and
//! permuted to the pixels.

use super::Lattice;
use crate::math::lanes::*;

/// Number of border samples that a row has on each side, at least.
pub(super) const MARGIN: usize = WIDE;

/// Number of values that a row holds after its last sample, at least: runs at the right border read beyond it.
pub(super) const BEYOND: usize = 4 * WIDE;

/// Returns the index of a sample in a row with margins.
pub(super) fn column_of(cell: i32) -> usize {
    (cell + MARGIN as i32) as usize
}

/// Cells that contain eight adjacent output pixels.
#[derive(Clone, Copy)]
struct CellsOfEight {
    /// Index of the first of these cells in a row with margins, in the first period of runs.
    first: usize,
    /// Cell of each pixel, relative to the first one: at most 7.
    places: [u32; LANES],
}

impl CellsOfEight {
    /// Returns the cells of the pixels from column `at` on.
    fn new(lattice: Lattice, at: u32) -> Self {
        let first = lattice.place(at).cell;
        let places = std::array::from_fn(|pixel| (lattice.place(at + pixel as u32).cell - first) as u32);
        Self { first: column_of(first), places }
    }
}

/// Cells that contain a run of [`WIDE`] output pixels.
#[derive(Clone, Copy)]
pub(super) struct RunCells([CellsOfEight; 2]);

impl RunCells {
    /// Returns the cells of the run that starts at column `x`.
    pub(super) fn new(lattice: Lattice, x: u32) -> Self {
        Self([0, LANES as u32].map(|half| CellsOfEight::new(lattice, x + half)))
    }

    /// Returns the index of the first cell in a row with margins.
    #[inline(always)]
    pub(super) fn first(&self) -> usize {
        self.0[0].first
    }

    /// Returns a word for each of the eight pixels of a half: that of its cell, moved by `offset` columns.
    #[inline(always)]
    pub(super) fn pick_words<S: Simd>(&self, simd: S, half: usize, row: &[u32], offset: isize) -> u32x8<S> {
        let CellsOfEight { first, places } = &self.0[half];
        permuted(u32x8::from_slice(simd, &row[first.wrapping_add_signed(offset)..][..LANES]), places)
    }

    /// Returns a float for each pixel: that of its cell, moved by `offset` columns.
    #[inline(always)]
    pub(super) fn pick<S: Simd>(&self, simd: S, row: &[f32], offset: isize) -> f32x16<S> {
        let [low, high]: [f32x8<S>; 2] = each!(half in [0, 1] => {
            let CellsOfEight { first, places } = &self.0[half];
            permuted(f32x8::from_slice(simd, &row[first.wrapping_add_signed(offset)..][..LANES]).bitcast(), places).bitcast()
        });
        low.combine(high)
    }
}

/// Data of all runs of a lattice, prepared for given lanes. As many runs as a period of the lattice has pixels form a
/// period of runs.
pub(super) struct RunTable<T> {
    pub(super) lanes: Lanes,
    pub(super) lattice: Lattice,
    pixels: usize,
    /// Number of samples in a period of runs.
    samples: isize,
    /// Data of the runs, for each row of a period of the lattice.
    all: Vec<T>,
}

impl<T> RunTable<T> {
    /// Creates the table; `run` returns the data of the run that starts at a column and a row.
    pub(super) fn new(lanes: Lanes, lattice: Lattice, run: impl Fn(u32, u32) -> T) -> Self {
        let (pixels, samples) = lattice.scale.ratio();
        let places = (0..pixels).flat_map(|y| (0..pixels).map(move |run| (run * WIDE as u32, y)));
        let all = places.map(|(x, y)| run(x, y)).collect();
        Self { lanes, lattice, pixels: pixels as usize, samples: samples as isize * WIDE as isize, all }
    }

    /// Returns the runs of output row `y`, from column `from` on, which must be a multiple of [`WIDE`].
    pub(super) fn runs(&self, from: usize, y: u32) -> Runs<'_, T> {
        let period = &self.all[y as usize % self.pixels * self.pixels..][..self.pixels];
        let run = from / WIDE;
        Runs {
            period,
            samples: self.samples,
            next: run % self.pixels,
            offset: (run / self.pixels) as isize * self.samples,
        }
    }
}

/// Iterates over the runs of an output row.
pub(super) struct Runs<'a, T> {
    period: &'a [T],
    samples: isize,
    /// Index of the next run in its period.
    next: usize,
    /// Number of samples before this period.
    offset: isize,
}

/// A run of an output row.
pub(super) struct Run<'a, T> {
    /// Prepared phase of the run.
    pub(super) phase: &'a T,
    /// Number of samples before the period of the run.
    pub(super) offset: isize,
}

impl<'a, T> Runs<'a, T> {
    /// Returns the next run.
    #[inline(always)]
    pub(super) fn advance(&mut self) -> Run<'a, T> {
        let run = Run { phase: &self.period[self.next], offset: self.offset };
        self.next += 1;
        if self.next == self.period.len() {
            (self.next, self.offset) = (0, self.offset + self.samples);
        }
        run
    }
}

/// Returns the words at the given places, each less than [`LANES`].
#[inline(always)]
fn permuted<S: Simd>(words: u32x8<S>, places: &[u32; LANES]) -> u32x8<S> {
    let simd = words.simd;
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let words = u32x8::load_array(avx2, words.to_array());
        let words: u32x8<_> =
            x86::permuted(avx2, words.into(), u32x8::load_array_ref(avx2, places).into()).simd_into(avx2);
        return u32x8::load_array(simd, words.to_array());
    }
    let (words, mut permuted) = (words.to_array(), [0; LANES]);
    for lane in 0..LANES {
        permuted[lane] = words[places[lane] as usize % LANES];
    }
    u32x8::load_array(simd, permuted)
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::kernel;

    kernel! {
        #[inline]
        pub(super) fn permuted(avx2: Avx2, words: __m256i, places: __m256i) -> __m256i {
            _mm256_permutevar8x32_epi32(words, places)
        }
    }
}
