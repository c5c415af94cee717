//! The walk over a picture that is interpolated along rows first and then along columns.
//!
//! Rows of samples are widened once each and kept in a ring of as many as the weights reach. All output rows between one
//! row of samples and the next, a *cell*, are made in one sweep, so that every widened row is read once per cell and not
//! once per output row. Bands of rows are independent; where one begins changes nothing in the result.

use std::array;

use crate::image::{Image, Rgba8};
use crate::upscale::bands;
use crate::upscale::lattice::Lattice;

/// Most samples along an axis that a pixel is made of.
pub(in crate::upscale) const MAX_TAPS: usize = 6;

/// The arithmetic of the two passes.
pub(super) trait Pass: Sync {
    /// A row of samples, widened to pixels.
    type Row: Default;

    /// Samples along an axis that a pixel is made of: even, at most [`MAX_TAPS`].
    const TAPS: usize;

    /// Widens a row of samples, overwriting `wide`, which holds anything.
    fn widen(&self, samples: &[Rgba8], wide: &mut Self::Row);

    /// Makes the rows of one cell, or some of them: `phases.len()` rows without a gap, from the [`Pass::TAPS`] widened
    /// ones around.
    fn mix(&self, around: &[&Self::Row], phases: &[u32], rows: &mut [Rgba8]);
}

/// Fills a picture from samples, which are at least one in each direction unless the picture is empty.
pub(super) fn fill<P: Pass>(pass: &P, drawn: &Image<Rgba8>, lattice: Lattice, full: &mut Image<Rgba8>) {
    bands::fill(full, lattice.scale, |first, count, band| fill_band(pass, drawn, lattice, first, count, band));
}

/// Fills the `count` rows from row `first` on.
fn fill_band<P: Pass>(
    pass: &P,
    drawn: &Image<Rgba8>,
    lattice: Lattice,
    first: u32,
    count: usize,
    mut band: &mut [Rgba8],
) {
    let (before, taps) = (P::TAPS as i32 / 2 - 1, P::TAPS as i32);
    let last_sample = drawn.height() as i32 - 1;
    let width = band.len() / count;
    let places: Vec<_> = lattice.places_from(first).take(count).collect();
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

/// One pixel of row `y`, by a pass that has its column alone.
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
