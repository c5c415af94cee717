//! Shading of a tile: groups samples that can be shaded together.
//!
//! Blocks and rows that show a single triangle are shaded as a whole. All other rows are processed in pairs. Samples
//! whose triangles have equivalent shaders are shaded together, each with the data of its own triangle.

use std::ops::AddAssign;

use super::canvas::Canvas;
use super::kernel::shade_uniform;
use super::layout::{BLOCK, Block, TileSize};
use super::pass::TilePass;
use super::patch::{ALL, Patch};
use super::pending::{LargeTriangle, MixedSamples, Pending, RowPair, SampleTargets};
use super::record::{BinEntry, ShadedTriangle};
use super::sample_positions::SamplePositions;
use super::setup::EdgeFunctions;
use super::shade_jittered::shade_jittered;
use super::shader::DrawShader;
use super::slot::Slot;
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;

/// Shading work: number of samples shaded and of texels read.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShadingWork {
    pub(super) samples: u64,
    pub(super) texels: u64,
}

impl ShadingWork {
    #[inline(always)]
    pub(super) fn add(&mut self, shader: &DrawShader<'_>, samples: usize) {
        self.samples += samples as u64;
        self.texels += samples as u64 * shader.texels_per_sample;
    }
}

impl AddAssign for ShadingWork {
    fn add_assign(&mut self, more: Self) {
        self.samples += more.samples;
        self.texels += more.texels;
    }
}

/// Returns the slot that sixteen samples share; `None` if their slots differ.
#[inline(always)]
fn uniform_slot<S: Simd>(slots: u32x16<S>) -> Option<Slot> {
    let first = slots[0];
    (slots.simd_eq(first).to_bitmask() == 0xFFFF).then_some(Slot(first))
}

/// State of the shading of one tile.
pub(super) struct ShadingJob<'a, L> {
    pub(super) pass: TilePass<'a, L>,
    pending: &'a mut Pending,
    pub(super) canvas: Canvas<'a>,
    /// Whether samples of all triangles can be shaded together.
    pub(super) alike: bool,
    /// Cache of edge functions in f64, for triangles whose edge values exceed 32 bits or that no SIMD kernel can shade.
    exact: Vec<(Slot, EdgeFunctions)>,
    /// Triangles whose edge values exceed 32 bits, among those of the samples that are shaded together.
    pub(super) large: Vec<LargeTriangle>,
    pub(super) shaded: ShadingWork,
}

impl<'a, L: SamplePositions> ShadingJob<'a, L> {
    pub(super) fn new(pass: TilePass<'a, L>, pending: &'a mut Pending, canvas: Canvas<'a>) -> Self {
        Self {
            pass,
            pending,
            canvas,
            alike: pass.frame.are_all_alike(),
            exact: Vec::new(),
            large: Vec::new(),
            shaded: ShadingWork::default(),
        }
    }

    /// Shades all visible samples of a tile. Returns the number of samples shaded and texels read.
    #[inline(always)]
    pub(super) fn shade_tile<S: Simd>(mut self, simd: S, tile: &Tile) -> ShadingWork {
        let TileSize { columns, rows } = self.canvas.picture.size;
        let blocks = columns.div_ceil(BLOCK);
        for by in 0..rows.div_ceil(BLOCK) {
            let (first, end) = (by * BLOCK, ((by + 1) * BLOCK).min(rows));
            let mut bx = 0;
            while bx < blocks {
                let owner = tile.owner(Block { column: bx, row: by });
                let mut next = bx + 1;
                // Adjacent blocks of one triangle are shaded together, because they share most of the work.
                while owner.is_some() && next < blocks && tile.owner(Block { column: next, row: by }) == owner {
                    next += 1;
                }
                let column = bx * BLOCK;
                let count = (columns - column).min((next - bx) * BLOCK);
                let patch = Patch { column, count, first, end, mine: ALL };
                match owner {
                    Some(slot) => self.one_triangle(simd, slot, &patch),
                    None => self.rows(simd, tile, &patch),
                }
                bx = next;
            }
        }
        self.finish(simd)
    }

    /// Shades the pending samples and flushes the queue. Returns the number of samples shaded and texels read in the
    /// tile.
    #[inline(always)]
    pub(super) fn finish<S: Simd>(mut self, simd: S) -> ShadingWork {
        self.pending.shade(simd, self.pass.bin, &mut self.canvas);
        self.shaded.texels += self.canvas.finish(simd);
        self.shaded
    }

    /// Shades a block that shows more than one triangle, two rows at a time.
    #[inline(always)]
    fn rows<S: Simd>(&mut self, simd: S, tile: &Tile, block: &Patch) {
        let mut row = block.first;
        while row < block.end {
            let slots = tile.slots_of_two_rows(simd, block.column, row);
            let mut next = row + 2;
            if let Some(slot) = uniform_slot(slots) {
                while next < block.end && uniform_slot(tile.slots_of_two_rows(simd, block.column, next)) == Some(slot) {
                    next += 2;
                }
                self.one_triangle(simd, slot, &Patch { first: row, end: next.min(block.end), ..*block });
            } else {
                self.mixed_rows(simd, slots, &Patch { first: row, end: next.min(block.end), ..*block });
            }
            row = next;
        }
    }

    /// Shades rows of samples that all belong to one triangle. Does nothing if they show the background.
    #[inline(always)]
    fn one_triangle<S: Simd>(&mut self, simd: S, slot: Slot, patch: &Patch) {
        if slot == Slot::NONE {
            return;
        }
        let TilePass { frame, bin, locations, .. } = self.pass;
        let subject @ ShadedTriangle { key, draw, .. } = bin.subject(slot);
        let shader = frame.shader(draw);
        self.shaded.add(shader, patch.count * (patch.end - patch.first));
        if let Some(color) = shader.shader.flat_color(frame.id_of(key), frame.draws[draw].instance) {
            self.fill(patch, color);
            return;
        }
        let edges = (!shader.on_lanes || slot.is_large()).then(|| self.exact_edges(slot)).flatten();
        let subject = ShadedTriangle { edges: edges.as_ref(), ..subject };
        if L::ON_LATTICE {
            shade_uniform(simd, &subject, patch, &mut self.canvas);
        } else {
            shade_jittered(simd, &subject, patch, locations, &mut self.canvas);
        }
    }

    /// Returns the edge functions of a triangle in f64; `None` if it has no area, in which case it is never visible.
    pub(super) fn exact_edges(&mut self, slot: Slot) -> Option<EdgeFunctions> {
        // Searches from the back, because most requests are for the same triangle as the previous request.
        if let Some((_, edges)) = self.exact.iter().rev().find(|(known, _)| *known == slot) {
            return Some(*edges);
        }
        let TilePass { frame, bin, .. } = self.pass;
        let BinEntry { key, draw } = bin.get(slot);
        let origin = frame.lattice.origin(bin.place);
        let (edges, _) = EdgeFunctions::new(&frame.corners(key, draw as usize), origin.position)?;
        self.exact.push((slot, edges));
        Some(edges)
    }

    /// Fills the samples that a patch selects with one colour.
    fn fill(&mut self, patch: &Patch, color: Rgba8) {
        for row in patch.first..patch.end {
            let row = self.canvas.picture.row(patch, row);
            if patch.mine == ALL {
                row.fill(color);
                continue;
            }
            for (lane, pixel) in row.iter_mut().enumerate() {
                *pixel = if patch.mine >> lane & 1 != 0 { color } else { *pixel };
            }
        }
    }

    /// Shades two rows of samples that belong to different triangles or to the background. The second row may be
    /// missing.
    #[inline(always)]
    fn mixed_rows<S: Simd>(&mut self, simd: S, slots: u32x16<S>, patch: &Patch) {
        let within = ALL >> (LANES - patch.count);
        let within = if patch.end > patch.first + 1 { within | within << LANES } else { within };
        let TilePass { frame, bin, locations, .. } = self.pass;
        let targets = RowPair { patch, locations };
        let seen = slots.simd_ne(Slot::NONE.0);
        let slots = &seen.select(slots, u32x16::splat(simd, 0)).to_array();
        let mut open = seen.to_bitmask() as u32 & within;
        if self.alike {
            self.together(simd, MixedSamples { shader: 0, slots, mine: open, targets });
            return;
        }
        while open != 0 {
            let leader = Slot(slots[open.trailing_zeros() as usize]);
            let draw = bin.get(leader).draw as usize;
            let (shader, number) = (frame.shader(draw), frame.shader_of_draw[draw]);
            let mine =
                if shader.on_lanes { self.shaded_by(number, open, slots) } else { open & same(simd, slots, leader) };
            open &= !mine;
            if shader.on_lanes {
                self.together(simd, MixedSamples { shader: number, slots, mine, targets });
                continue;
            }
            for (half, mine) in halves_of(mine).into_iter().enumerate().filter(|(_, mine)| *mine != 0) {
                let (before, row) = (self.shaded, patch.first + half);
                self.one_triangle(simd, leader, &Patch { first: row, end: row + 1, mine, ..*patch });
                self.shaded = before;
                self.shaded.add(shader, mine.count_ones() as usize);
            }
        }
    }

    /// Adds samples to the pending samples of their shader.
    #[inline(always)]
    pub(super) fn together<S: Simd>(&mut self, simd: S, samples: MixedSamples<'_, impl SampleTargets>) {
        let MixedSamples { shader, slots, mine, .. } = samples;
        self.shaded.add(&self.pass.frame.shaders[shader], mine.count_ones() as usize);
        self.find_large(simd, mine, slots);
        if self.pending.is_full(shader) {
            self.pending.shade(simd, self.pass.bin, &mut self.canvas);
        }
        self.pending.push(simd, samples, &self.large, &self.canvas.picture);
    }

    /// Returns the bit mask of the samples in `open` that use the shader with index `shader`.
    pub(super) fn shaded_by(&self, shader: usize, mut open: u32, slots: &[u32; WIDE]) -> u32 {
        let mut mine = 0;
        while open != 0 {
            let lane = open.trailing_zeros() as usize;
            open &= open - 1;
            let draw = self.pass.bin.get(Slot(slots[lane])).draw as usize;
            mine |= u32::from(self.pass.frame.shader_of_draw[draw] == shader) << lane;
        }
        mine
    }

    /// Finds the triangles whose edge values exceed 32 bits, among the triangles of the samples selected by `mine`.
    #[inline(always)]
    pub(super) fn find_large<S: Simd>(&mut self, simd: S, mut mine: u32, slots: &[u32; WIDE]) {
        self.large.clear();
        mine &= (u32x16::load_array_ref(simd, slots) & Slot::LARGE).simd_ne(0).to_bitmask() as u32;
        while mine != 0 {
            let slot = Slot(slots[mine.trailing_zeros() as usize]);
            let lanes = mine & same(simd, slots, slot);
            mine &= !lanes;
            if let Some(edges) = self.exact_edges(slot) {
                self.large.push(LargeTriangle { lanes, edges });
            }
        }
    }
}

/// Returns the bit mask of the samples that belong to the triangle of a slot.
#[inline(always)]
fn same<S: Simd>(simd: S, slots: &[u32; WIDE], slot: Slot) -> u32 {
    u32x16::load_array_ref(simd, slots).simd_eq(slot.0).to_bitmask() as u32
}

/// Splits a bit mask of sixteen samples into the masks of the first and the second row of eight.
fn halves_of(lanes: u32) -> [u32; 2] {
    [lanes & ALL, lanes >> LANES]
}
