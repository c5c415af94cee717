//! Gathering and setup of the triangles in a tile's bin.

use super::TiledFrame;
use super::batch::{BatchVertices, GROUP, TriangleGroup};
use super::layout::TilePlace;
use super::packed::{PackedSurface, PackedVertex};
use super::record::{BinEntry, SurfacePart, SurfaceRecord, TileBin};
use super::setup::SetupContext;
use super::slot::Slot;
use crate::math::lanes::*;
use crate::math::prefetch::prefetch;

impl TiledFrame<'_> {
    /// Collects the triangles of a tile from all chunks into a bin.
    #[inline(always)]
    pub(super) fn gather_bin(&self, place: TilePlace, entrants: &mut TileBin) {
        entrants.begin(place);
        let mut draw = 0;
        for chunk in self.chunks {
            let mut keys = chunk.keys(place.number);
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

    /// Returns the setup of the triangles in a tile, on the lattice of the frame.
    #[inline(always)]
    pub(super) fn tile_setup(&self, place: TilePlace) -> TileSetup<'_> {
        let context = SetupContext {
            rule: self.settings.fill_rule,
            scale: &self.scale,
            lattice: &self.lattice,
            origin: self.lattice.origin(place),
        };
        TileSetup { frame: self, context }
    }

    /// Looks up the vertices of a group of a tile's triangles, and sets a bit in `divides_by_w` for each triangle with
    /// perspective division.
    ///
    /// Vertices are scattered in memory. All vertex indices are therefore prefetched before the first is read, and each
    /// vertex is prefetched as soon as its index is known.
    #[inline(always)]
    fn find_vertices<'a>(
        &'a self,
        entrants: &TileBin,
        group: usize,
        triangles: &mut [[&'a PackedVertex; 3]; GROUP],
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

    /// Fills the surface records (normals and colours) of up to eight triangles of a tile, starting at index `first`.
    #[inline(always)]
    fn fill_surfaces<S: Simd>(&self, simd: S, entrants: &mut TileBin, first: usize, count: usize) {
        let nothing = PackedSurface::default();
        let mut triangles = [[&nothing; 3]; LANES];
        for (lane, triangle) in triangles.iter_mut().enumerate().take(count) {
            let BinEntry { key, draw, .. } = entrants.get(Slot::new(first + lane, false));
            let [a, b, c] = self.records(key, draw as usize);
            if let (Some(a), Some(b), Some(c)) = (a.1, b.1, c.1) {
                *triangle = [a, b, c];
            }
        }
        let Some(records) = entrants.eight_surfaces(first) else { return };
        fill_parts(simd, records, &triangles, self.reads_normals, self.reads_colors);
    }
}

/// Setup of the triangles in a tile.
pub(super) struct TileSetup<'a> {
    frame: &'a TiledFrame<'a>,
    pub(super) context: SetupContext<'a>,
}

impl TileSetup<'_> {
    /// Sets up a group of a tile's triangles, starting at index `first`, before the first of them is drawn. This hides
    /// the latency of the setup.
    #[inline(always)]
    pub(super) fn set_up_group<S: Simd>(&self, simd: S, entrants: &mut TileBin, first: usize, out: &mut TriangleGroup) {
        let Self { frame, context } = self;
        let nowhere = PackedVertex::default();
        let (mut triangles, mut divides_by_w) = ([[&nowhere; 3]; GROUP], 0);
        frame.find_vertices(entrants, first, &mut triangles, &mut divides_by_w);
        let TriangleGroup { first: place, batches, alive, large } = out;
        (*place, *alive, *large) = (first, Default::default(), Default::default());
        for (number, triangles) in triangles.as_chunks::<LANES>().0.iter().enumerate() {
            let first = first + number * LANES;
            let count = entrants.len().saturating_sub(first).min(LANES);
            if count == 0 {
                break;
            }
            let Some(records) = entrants.eight_records(first) else { break };
            let vertices = BatchVertices { triangles, divides_by_w: divides_by_w >> (number * LANES) };
            (alive[number], large[number]) = batches[number].set_up(simd, vertices, records, context);
            alive[number] &= u64::from(u32::MAX) >> (u32::BITS as usize - count);
            if alive[number] != 0 && !frame.arrays.surfaces.is_empty() {
                frame.fill_surfaces(simd, entrants, first, count);
            }
        }
    }
}

/// Fills the normals of eight surface records if the frame reads normals, and the colours if it reads colours.
#[inline(never)]
fn fill_parts<S: Simd>(
    simd: S,
    records: &mut [SurfaceRecord; LANES],
    triangles: &[[&PackedSurface; 3]; LANES],
    normals: bool,
    colors: bool,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            if normals {
                SurfaceRecord::fill_eight(simd, records, triangles, SurfacePart::Normal);
            }
            if colors {
                SurfaceRecord::fill_eight(simd, records, triangles, SurfacePart::Color);
            }
        },
    );
}
