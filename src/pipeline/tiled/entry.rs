//! Which triangles enter a tile, and how they are set up.

use super::Frame;
use super::batch::Batch;
use super::geometry::{Surface, Vertex};
use super::lattice::BLOCK;
use super::record::{Entrant, Entrants, Part, Slot, SurfaceRecord};
use super::setup::Origin;
use crate::math::lanes::*;
use crate::math::prefetch::prefetch;

/// Batches of triangles of a tile whose corners are looked for together.
pub(super) const BATCHES: usize = 4;

/// Triangles of so many batches.
pub(super) const GROUP: usize = BATCHES * LANES;

impl Frame<'_> {
    /// Lists the triangles of a tile.
    #[inline(always)]
    pub(super) fn let_enter(&self, number: usize, entrants: &mut Entrants) {
        entrants.clear();
        let mut draw = 0;
        for chunk in self.chunks {
            let mut keys = chunk.keys(number);
            while let [first, more @ ..] = keys {
                if !self.is_of_draw(*first, draw) {
                    draw = self.draw_of(*first);
                }
                let more = more.iter().take_while(|key| self.is_of_draw(**key, draw)).count();
                let (own, others) = keys.split_at(1 + more);
                entrants.extend(own, draw);
                keys = others;
            }
        }
    }

    /// Sets up a group of triangles of a tile before the first of them is drawn, as results come late, and says by bits which
    /// of each eight may have a sample in the tile, and which of those have edge values of more than 32 bits.
    #[inline(always)]
    pub(super) fn set_up_group<S: Simd>(
        &self,
        simd: S,
        entrants: &mut Entrants,
        batches: &mut [Batch; BATCHES],
        group: usize,
        origin: Origin,
    ) -> ([u64; BATCHES], [u64; BATCHES]) {
        let nowhere = Vertex::default();
        let (mut triangles, mut divides_by_w) = ([[&nowhere; 3]; GROUP], 0);
        self.find_vertices(entrants, group, &mut triangles, &mut divides_by_w);
        let (mut alive, mut large) = ([0; BATCHES], [0; BATCHES]);
        for (number, triangles) in triangles.as_chunks::<LANES>().0.iter().enumerate() {
            let first = group + number * LANES;
            let count = entrants.len().saturating_sub(first).min(LANES);
            if count == 0 {
                break;
            }
            let Some(records) = entrants.eight_records(first) else { break };
            (alive[number], large[number]) = batches[number].set_up(
                simd,
                triangles,
                (records, divides_by_w >> (number * LANES)),
                self.settings.fill_rule,
                &self.scale,
                &self.lattice,
                origin,
            );
            alive[number] &= u64::from(u32::MAX) >> (u32::BITS as usize - count);
            if alive[number] != 0 && !self.arrays.surfaces.is_empty() {
                self.fill_surfaces(simd, entrants, first, count);
            }
        }
        (alive, large)
    }

    /// Finds the corners of a group of triangles of a tile, and a bit for each that is divided by w. They lie all over the
    /// memory: all indices are asked for before the first is read, and then all vertices.
    #[inline(always)]
    fn find_vertices<'a>(
        &'a self,
        entrants: &Entrants,
        group: usize,
        triangles: &mut [[&'a Vertex; 3]; GROUP],
        divides_by_w: &mut u64,
    ) {
        let entrants = entrants.group(group, GROUP);
        let by_draw = || entrants.chunk_by(|one, next| one.draw == next.draw);
        for own in by_draw() {
            let draw = &self.draws[own[0].draw as usize];
            for entrant in own.iter().filter(|entrant| entrant.key.as_piece().is_none()) {
                draw.prefetch(entrant.key.0);
            }
        }
        let mut found = 0;
        for own in by_draw() {
            let draw = own[0].draw as usize;
            for (triangle, entrant) in triangles[found..].iter_mut().zip(own) {
                *triangle = self.vertices(entrant.key, draw);
                for vertex in triangle {
                    prefetch(std::slice::from_ref(*vertex), 0);
                }
            }
            if self.shader(draw).divides_by_w {
                *divides_by_w |= u64::from(u32::MAX >> (GROUP - own.len())) << found;
            }
            found += own.len();
        }
    }

    /// Records what shading reads besides of some triangles of a tile from `first` on, eight at most.
    #[inline(always)]
    fn fill_surfaces<S: Simd>(&self, simd: S, entrants: &mut Entrants, first: usize, count: usize) {
        let nothing = Surface::default();
        let mut triangles = [[&nothing; 3]; LANES];
        for (lane, triangle) in triangles.iter_mut().enumerate().take(count) {
            let Entrant { key, draw, .. } = entrants.get(Slot::new(first + lane, false));
            let [a, b, c] = self.records(key, draw as usize);
            if let (Some(a), Some(b), Some(c)) = (a.1, b.1, c.1) {
                *triangle = [a, b, c];
            }
        }
        let Some(records) = entrants.eight_surfaces(first) else { return };
        fill_parts(simd, records, &triangles, self.reads_normals, self.reads_colors);
    }
}

/// Triangles of a tile from which on bounds of its blocks are not worth their keep, unless they are large.
const CROWDED: usize = 96;

/// Columns, or rows, from which on a triangle is large: it reaches over more than two blocks.
const LARGE: i32 = 2 * BLOCK as i32;

/// Whether a tile of so many triangles keeps bounds of its blocks, by the first of them that were set up, of which those count that
/// have a bit.
#[inline(always)]
pub(super) fn keeps_bounds(triangles: usize, first: &[Batch; BATCHES], alive: &[u64; BATCHES]) -> bool {
    let large = || first.iter().zip(alive).map(|(batch, alive)| batch.count_large(*alive, LARGE)).sum::<u32>();
    triangles < CROWDED || 2 * large() > alive.iter().map(|alive| alive.count_ones()).sum()
}

/// The parts of eight records that are read.
#[inline(never)]
fn fill_parts<S: Simd>(
    simd: S,
    records: &mut [SurfaceRecord; LANES],
    triangles: &[[&Surface; 3]; LANES],
    normals: bool,
    colors: bool,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            if normals {
                SurfaceRecord::fill_eight(simd, records, triangles, Part::Normal);
            }
            if colors {
                SurfaceRecord::fill_eight(simd, records, triangles, Part::Color);
            }
        },
    );
}
