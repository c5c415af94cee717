//! Traversal of an image for separable interpolation, along rows first and then along columns.
//!
//! Each row of samples is upscaled horizontally (*widened*) once and kept in a ring buffer of as many rows as the
//! kernel has taps. The output rows between two rows of samples form a *cell* and are computed in one sweep. Every
//! widened row is therefore read once per cell instead of once per output row. Bands of rows are independent; their
//! boundaries do not affect the result.

use std::array;

use crate::image::{Image, Rgba8};
use crate::upscale::bands;
use crate::upscale::lattice::{Lattice, LatticePosition};

/// Maximum number of taps along an axis.
pub(in crate::upscale) const MAX_TAPS: usize = 6;

/// Arithmetic of the horizontal and the vertical pass of an interpolation.
pub(super) trait Pass: Sync {
    /// A row of samples, upscaled horizontally.
    type Row: Default;

    /// Number of taps along an axis: even, at most [`MAX_TAPS`].
    const TAPS: usize;

    /// Upscales a row of samples horizontally. Overwrites `wide`, which may hold any values.
    fn widen(&self, samples: &[Rgba8], wide: &mut Self::Row);

    /// Computes the contiguous output rows between two rows of samples, one per entry of `phases`, from the
    /// [`Pass::TAPS`] nearest horizontally upscaled rows.
    fn mix(&self, around: &[&Self::Row], phases: &[u32], rows: &mut [Rgba8]);
}

/// Fills an image from samples; there must be at least one sample unless the image is empty.
pub(super) fn fill<P: Pass>(pass: &P, drawn: &Image<Rgba8>, lattice: Lattice, full: &mut Image<Rgba8>) {
    bands::fill(full, lattice.scale, |first, count, band| {
        let places: Vec<_> = lattice.places_from(first).take(count).collect();
        fill_band(pass, drawn, &places, band);
    });
}

/// Fills a band of rows at the given positions on the lattice.
fn fill_band<P: Pass>(pass: &P, drawn: &Image<Rgba8>, places: &[LatticePosition], mut band: &mut [Rgba8]) {
    let (before, taps) = (P::TAPS as i32 / 2 - 1, P::TAPS as i32);
    let last_sample = drawn.height() as i32 - 1;
    let width = band.len() / places.len();
    let phases: Vec<_> = places.iter().map(|place| place.phase).collect();
    let mut ring: [P::Row; MAX_TAPS] = array::from_fn(|_| P::Row::default());
    let mut next = places[0].cell - before;
    let mut done = 0;
    for cell in places.chunk_by(|a, b| a.cell == b.cell) {
        let top = cell[0].cell - before;
        while next < top + taps {
            let samples = drawn.row(next.clamp(0, last_sample) as u32);
            pass.widen(samples, &mut ring[next.rem_euclid(taps) as usize]);
            next += 1;
        }
        let around: [&P::Row; MAX_TAPS] = array::from_fn(|tap| &ring[(top + tap as i32).rem_euclid(taps) as usize]);
        let (rows, rest) = band.split_at_mut(cell.len() * width);
        pass.mix(&around[..P::TAPS], &phases[done..done + cell.len()], rows);
        done += cell.len();
        band = rest;
    }
}

/// Computes one pixel of row `y`; `pass` must be set up for the column of this pixel only.
pub(super) fn pixel<P: Pass>(pass: &P, drawn: &Image<Rgba8>, lattice: Lattice, y: u32) -> Rgba8 {
    let place = lattice.place(y);
    let top = place.cell - (P::TAPS as i32 / 2 - 1);
    let mut rows: [P::Row; MAX_TAPS] = array::from_fn(|_| P::Row::default());
    for (at, row) in (top..).zip(rows.iter_mut().take(P::TAPS)) {
        pass.widen(drawn.row(at.clamp(0, drawn.height() as i32 - 1) as u32), row);
    }
    let mut pixel = [[0; 4]];
    pass.mix(&rows.each_ref()[..P::TAPS], &[place.phase], &mut pixel);
    pixel[0]
}
