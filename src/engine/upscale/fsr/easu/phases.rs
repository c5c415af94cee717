//! Samples and distances of a run of output pixels.

use super::{Distances, Spot};
use crate::math::lanes::*;
use crate::upscale::fsr::words::rounded;
use crate::upscale::lattice::Lattice;
use crate::upscale::runs::{RunCells, RunTable};

/// Data of a run of [`WIDE`] pixels.
pub(in super::super) struct RunPhase {
    pub(super) cells: RunCells,
    /// Horizontal positions of the pixels between the samples; see [`Spot`].
    x: [f32; WIDE],
    pub(super) distances: WideDistances,
}

/// Runs of all phases of a lattice.
pub(in super::super) type Phases = RunTable<RunPhase>;

/// Prepares the runs of a lattice for the given lanes.
pub(in super::super) fn phases(lanes: Lanes, lattice: Lattice) -> Phases {
    RunTable::new(lanes, lattice, |x, y| on_lanes!(lanes, simd => RunPhase::new(simd, lattice, x, y)))
}

impl RunPhase {
    /// Prepares the run whose first pixel is (x, y).
    fn new<S: Simd>(simd: S, lattice: Lattice, x: u32, y: u32) -> Self {
        let row = lattice.place(y).phase;
        let spots: [Spot; WIDE] =
            std::array::from_fn(|pixel| Spot::new(lattice, lattice.place(x + pixel as u32).phase, row));
        Self {
            cells: RunCells::new(lattice, x),
            x: spots.map(|spot| spot.x),
            distances: WideDistances::new(simd, &spots.map(Distances::new)),
        }
    }

    /// Interpolates horizontally between vertically interpolated values, as in [`Spot::mix`].
    #[inline(always)]
    pub(super) fn mixed<S: Simd>(&self, simd: S, row: &[f32], offset: isize) -> f32x16<S> {
        let (left, right) = (self.cells.pick(simd, row, offset), self.cells.pick(simd, row, offset + 1));
        let x = f32x16::load_array_ref(simd, &self.x);
        left * (f32x16::splat(simd, 1.0) - x) + right * x
    }
}

/// Offsets of the samples from each of 16 pixels, in the pixel order that [`rounded`] produces; see [`Distances`].
pub(super) struct WideDistances {
    pub(super) xx: [[i16; WIDE]; 4],
    pub(super) yy: [[i16; WIDE]; 4],
    pub(super) xy: [[i16; WIDE]; 12],
}

impl WideDistances {
    fn new<S: Simd>(simd: S, pixels: &[Distances; WIDE]) -> Self {
        let ordered = |of: &dyn Fn(&Distances) -> i16| {
            let mut words = [0; WIDE];
            let floats = pixels.each_ref().map(|distances| f32::from(of(distances)));
            rounded(f32x16::load_array(simd, floats)).store_array(&mut words);
            words
        };
        Self {
            xx: std::array::from_fn(|column| ordered(&|distances| distances.xx[column])),
            yy: std::array::from_fn(|row| ordered(&|distances| distances.yy[row])),
            xy: std::array::from_fn(|place| ordered(&|distances| distances.xy[place])),
        }
    }
}
