//! Decoded rows of samples, shared by the output rows that read them.

use super::ycocg::Quad;
use crate::image::{Image, Rgba8};

/// Three adjacent decoded sample rows, with the index of the row that each holds.
pub(super) struct DecodedRows {
    rows: [(Option<u32>, Vec<Quad>); 3],
}

impl DecodedRows {
    /// Returns the buffer for rows of `width` samples, which holds none yet.
    pub(super) fn new(width: u32) -> Self {
        Self { rows: [0, 1, 2].map(|_| (None, vec![[0.0; 4]; width as usize])) }
    }

    /// Makes sure that sample row `index` is decoded.
    #[inline(always)]
    pub(super) fn fill(&mut self, index: u32, decode: impl Fn(Rgba8) -> Quad, samples: &Image<Rgba8>) {
        let (held, row) = &mut self.rows[index as usize % 3];
        if *held != Some(index) {
            for (quad, codes) in row.iter_mut().zip(samples.row(index)) {
                *quad = decode(*codes);
            }
            *held = Some(index);
        }
    }

    pub(super) fn row(&self, index: u32) -> &[Quad] {
        &self.rows[index as usize % 3].1
    }
}
