//! Shading a tile: which samples belong together.
//!
//! Blocks and rows that one triangle covers are shaded as such; of other rows, the samples whose triangles are shaded alike
//! are taken together, each with its own triangle: those of two rows, where all triangles of the frame are.

use super::Frame;
use super::kernel::{ALL, Band, Patch, Queue, flush, shade_gathered, shade_uniform};
use super::lattice::{BLOCK, BLOCKS, TILE};
use super::record::{Entrant, Entrants, Slot, Subject};
use super::setup::Edges;
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
    pub(super) entrants: &'a Entrants,
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
    let mut job = Job {
        frame,
        entrants,
        queue,
        origin: frame.lattice.origin(place),
        alike: frame.are_all_alike() && !entrants.any_large(),
        exact: None,
        band: Band { pixels, width },
        shaded: Shaded::default(),
    };
    for by in 0..height.div_ceil(BLOCK) {
        for bx in 0..columns.div_ceil(BLOCK) {
            let column = bx * BLOCK;
            let (first, end) = (by * BLOCK, ((by + 1) * BLOCK).min(height));
            let whole = Patch { tile: place, column, count: (columns - column).min(BLOCK), first, end, mine: ALL };
            if let Some(slot) = tile.owner(by * BLOCKS + bx) {
                job.one_triangle(simd, slot, &whole);
            } else {
                job.rows(simd, tile, &whole);
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
    entrants: &'a Entrants,
    queue: &'a mut Queue,
    /// Position of the tile's first sample, in grid steps.
    origin: [f64; 2],
    /// All samples can be shaded together, whatever triangles they are of.
    alike: bool,
    /// The edges of the last triangle that 32 bits were not enough for, or that is not shaded on lanes.
    exact: Option<(Slot, Edges)>,
    band: Band<'a>,
    shaded: Shaded,
}

impl Job<'_> {
    /// A block that is not of one triangle.
    #[inline(always)]
    fn rows<S: Simd>(&mut self, simd: S, tile: &Tile, block: &Patch) {
        let mut row = block.first;
        while row < block.end {
            let slots = tile.slots(block.column, row);
            let mut next = row + 1;
            if let Some(slot) = uniform_slot(simd, slots) {
                while next < block.end && uniform_slot(simd, tile.slots(block.column, next)) == Some(slot) {
                    next += 1;
                }
                self.one_triangle(simd, slot, &Patch { first: row, end: next, ..*block });
            } else if self.alike {
                let below = (next < block.end).then(|| tile.slots(block.column, next));
                let below = below.filter(|below| uniform_slot(simd, below).is_none());
                self.mixed_rows(simd, [Some(slots), below], &Patch { first: row, end: next, ..*block });
                next += usize::from(below.is_some());
            } else {
                self.mixed_row(simd, slots, &Patch { first: row, end: next, ..*block });
            }
            row = next;
        }
    }

    /// Rows of samples that all belong to one triangle, or to none.
    #[inline(always)]
    fn one_triangle<S: Simd>(&mut self, simd: S, slot: Slot, patch: &Patch) {
        if slot == Slot::NONE {
            return;
        }
        let Entrant { key, draw, .. } = self.entrants.get(slot);
        let (draw, one) = (draw as usize, self.entrants.one(slot));
        let shader = self.frame.shader(draw);
        self.shaded.add(shader, patch.count * (patch.end - patch.first));
        if let Some(color) = shader.shader.flat_color(self.frame.id_of(key), self.frame.draws[draw].instance) {
            self.fill(patch, color);
            return;
        }
        if !shader.on_lanes || self.entrants.is_large(slot) {
            if self.exact.is_none_or(|(last, _)| last != slot) {
                // Triangles without area are never seen.
                self.exact = Edges::new(&self.frame.corners(key, draw), self.origin).map(|edges| (slot, edges));
            }
        } else {
            let subject = Subject { one, key, draw, edges: None };
            return shade_uniform(simd, self.frame, &subject, patch, self.queue, &mut self.band);
        }
        let edges = self.exact.as_ref().map(|(_, edges)| edges);
        shade_uniform(simd, self.frame, &Subject { one, key, draw, edges }, patch, self.queue, &mut self.band);
    }

    /// One colour for the samples of some rows that are shaded.
    fn fill(&mut self, patch: &Patch, color: Rgba8) {
        for row in patch.first..patch.end {
            let row = self.band.row(patch, row);
            if patch.mine == ALL {
                row.fill(color);
                continue;
            }
            for (lane, pixel) in row.iter_mut().enumerate() {
                *pixel = if patch.mine >> lane & 1 != 0 { color } else { *pixel };
            }
        }
    }

    /// Samples of one or two rows that belong to triangles that are all shaded alike, or to none.
    #[inline(always)]
    fn mixed_rows<S: Simd>(&mut self, simd: S, rows: [Option<&[u32]>; 2], patch: &Patch) {
        let mut slots = [0; WIDE];
        let mut mine = [0; 2];
        for (half, row) in rows.iter().enumerate() {
            let Some(row) = row else { continue };
            let of_row = u32x8::from_slice(simd, row);
            let seen = of_row.simd_ne(Slot::NONE.0);
            seen.select(of_row, u32x8::splat(simd, 0)).store_slice(&mut slots[half * LANES..][..LANES]);
            mine[half] = seen.to_bitmask() as u32;
        }
        let within = ALL >> (LANES - patch.count);
        let samples = (mine[0] & within).count_ones() + (mine[1] & within).count_ones();
        self.shaded.add(&self.frame.shaders[0], samples as usize);
        let place = (patch, patch.first, mine);
        shade_gathered(simd, self.frame, 0, (self.entrants, &slots), place, self.queue, &mut self.band);
    }

    /// A row of samples that belong to different triangles, which may be shaded differently.
    #[inline(always)]
    fn mixed_row<S: Simd>(&mut self, simd: S, slots: &[u32], patch: &Patch) {
        let mut open: u32 = 0;
        for (lane, slot) in slots.iter().enumerate().take(patch.count) {
            open |= u32::from(*slot != Slot::NONE.0) << lane;
        }
        while open != 0 {
            let first = open.trailing_zeros() as usize;
            let leader = Slot(slots[first]);
            let draw = self.entrants.get(leader).draw as usize;
            let (shader, number) = (self.frame.shader(draw), self.frame.shader_of_draw[draw]);
            let alone = !shader.on_lanes || self.entrants.is_large(leader);
            let mut together = [leader.0; WIDE];
            let mut mine = 0;
            for lane in (first..patch.count).filter(|lane| open >> lane & 1 != 0) {
                let slot = Slot(slots[lane]);
                if slot == leader {
                    mine |= 1 << lane;
                } else if !alone && !self.entrants.is_large(slot) {
                    let draw = self.entrants.get(slot).draw as usize;
                    if self.frame.shader_of_draw[draw] == number {
                        together[lane] = slot.0;
                        mine |= 1 << lane;
                    }
                }
            }
            open &= !mine;
            if alone {
                let before = self.shaded;
                self.one_triangle(simd, leader, &Patch { mine, ..*patch });
                self.shaded = before;
            } else {
                let place = (patch, patch.first, [mine, 0]);
                shade_gathered(simd, self.frame, number, (self.entrants, &together), place, self.queue, &mut self.band);
            }
            self.shaded.add(shader, mine.count_ones() as usize);
        }
    }
}
