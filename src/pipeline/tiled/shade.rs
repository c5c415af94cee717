//! Shading a tile: which samples belong together.
//!
//! Blocks and rows that one triangle covers are shaded as such; of other rows, the samples whose triangles are shaded alike
//! are taken together, each with its own triangle.

use super::Frame;
use super::kernel::{ALL, Band, Patch, Queue, flush, shade_gathered, shade_uniform};
use super::lattice::{BLOCK, BLOCKS, TILE};
use super::record::{Entrants, Slot};
use super::shader::DrawShader;
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;

/// How much shading a tile was.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shaded {
    pub(super) samples: u64,
    pub(super) texels: u64,
}

impl Shaded {
    #[inline(always)]
    fn add(&mut self, shader: &DrawShader<'_>, samples: usize) {
        self.samples += samples as u64;
        self.texels += samples as u64 * shader.texels_per_sample;
    }
}

/// A tile of the picture that is shaded, and the memory for it.
pub(super) struct Canvas<'a> {
    pub(super) tile: &'a Tile,
    pub(super) entrants: &'a mut Entrants,
    pub(super) queue: &'a mut Queue,
    /// Column and row among the tiles.
    pub(super) place: (usize, usize),
    /// The rows of the packed picture that start with the tile's first one.
    pub(super) pixels: &'a mut [Rgba8],
}

/// Shades the samples of a tile.
#[inline(always)]
pub(super) fn shade_tile<S: Simd>(simd: S, frame: &Frame<'_>, canvas: Canvas<'_>) -> Shaded {
    let Canvas { tile, entrants, queue, place, pixels } = canvas;
    let width = frame.packed.0 as usize;
    let (columns, height) = ((width - place.0 * TILE).min(TILE), pixels.len() / width);
    let origin = frame.lattice.origin(place);
    let mut job = Job { frame, entrants, queue, origin, band: Band { pixels, width }, shaded: Shaded::default() };
    for by in 0..height.div_ceil(BLOCK) {
        for bx in 0..columns.div_ceil(BLOCK) {
            let column = bx * BLOCK;
            let (first, end) = (by * BLOCK, ((by + 1) * BLOCK).min(height));
            let whole = Patch { tile: place, column, count: (columns - column).min(BLOCK), first, end, mine: ALL };
            if let Some(slot) = tile.owner(by * BLOCKS + bx) {
                job.one_triangle(simd, slot, &whole);
                continue;
            }
            let mut row = first;
            while row < end {
                let Some(slot) = uniform_slot(simd, tile.slots(column, row)) else {
                    job.mixed_row(simd, tile.slots(column, row), &Patch { first: row, end: row + 1, ..whole });
                    row += 1;
                    continue;
                };
                let mut next = row + 1;
                while next < end && uniform_slot(simd, tile.slots(column, next)) == Some(slot) {
                    next += 1;
                }
                job.one_triangle(simd, slot, &Patch { first: row, end: next, ..whole });
                row = next;
            }
        }
    }
    flush(simd, frame, job.queue, job.band.pixels);
    job.shaded
}

/// The triangle of all eight samples, if it is one.
#[inline(always)]
fn uniform_slot<S: Simd>(simd: S, slots: &[u32]) -> Option<Slot> {
    let first = slots[0];
    let same = u32x8::from_slice(simd, slots).simd_eq(first);
    (same.to_bitmask() == 0xFF).then_some(Slot(first))
}

/// The shading of a tile.
struct Job<'a> {
    frame: &'a Frame<'a>,
    entrants: &'a mut Entrants,
    queue: &'a mut Queue,
    /// Position of the tile's first sample, in grid steps.
    origin: [f64; 2],
    band: Band<'a>,
    shaded: Shaded,
}

impl Job<'_> {
    /// Rows of samples that all belong to one triangle, or to none.
    #[inline(always)]
    fn one_triangle<S: Simd>(&mut self, simd: S, slot: Slot, patch: &Patch) {
        if slot == Slot::NONE {
            for row in patch.first..patch.end {
                self.band.row(patch, row).fill(self.frame.background);
            }
        } else if let Some(position) = self.entrants.make_record(simd, self.frame, slot, self.origin) {
            let record = self.entrants.record(position);
            self.shaded.add(self.frame.shader(record.draw), patch.count * (patch.end - patch.first));
            shade_uniform(simd, self.frame, record, patch, self.queue, &mut self.band);
        }
    }

    /// A row of samples that belong to different triangles.
    #[inline(always)]
    fn mixed_row<S: Simd>(&mut self, simd: S, slots: &[u32], patch: &Patch) {
        let Self { frame, entrants, queue, origin, band, shaded } = self;
        let row = patch.first;
        let mut open: u32 = 0;
        let mut positions = [0_u32; LANES];
        for (lane, pixel) in band.row(patch, row).iter_mut().enumerate() {
            if slots[lane] == Slot::NONE.0 {
                *pixel = frame.background;
            } else if lane > 0 && slots[lane] == slots[lane - 1] {
                positions[lane] = positions[lane - 1];
                open |= (open & 1 << (lane - 1)) << 1;
            } else if let Some(position) = entrants.make_record(simd, frame, Slot(slots[lane]), *origin) {
                positions[lane] = position;
                open |= 1 << lane;
            }
        }
        while open != 0 {
            let first = open.trailing_zeros() as usize;
            let leader = entrants.record(positions[first]);
            let (shader, number) = (frame.shader(leader.draw), frame.shader_of_draw[leader.draw]);
            let alone = !shader.on_lanes || !leader.fits_i32;
            let mut records = [leader; LANES];
            let mut mine = 0;
            for lane in (first..patch.count).filter(|lane| open >> lane & 1 != 0) {
                if positions[lane] == positions[first] {
                    mine |= 1 << lane;
                } else if !alone {
                    let record = entrants.record(positions[lane]);
                    if record.fits_i32 && frame.shader_of_draw[record.draw] == number {
                        records[lane] = record;
                        mine |= 1 << lane;
                    }
                }
            }
            open &= !mine;
            shaded.add(shader, mine.count_ones() as usize);
            if alone {
                shade_uniform(simd, frame, leader, &Patch { mine, ..*patch }, queue, band);
            } else {
                shade_gathered(simd, frame, number, &records, &Patch { mine, ..*patch }, queue, band);
            }
        }
    }
}
