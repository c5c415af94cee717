//! Alpha-tested and blended triangles with multisampling.
//!
//! A triangle has one fragment per pixel, as without transparency. A fragment that fails the alpha test is discarded in
//! all samples of the pixel. A blended fragment is blended over the colour of each sample separately. Tiles with
//! blended triangles therefore keep the colours of all samples until the last of these triangles is drawn. A fragment
//! is recomputed for each sample in which it is visible: with sixteen at a time, this is faster than looking up a
//! stored result.

use super::TiledFrame;
use super::lattice::{TILE, TILE_SAMPLES, TileLattice};
use super::mixed::MixedPixels;
use super::multisample::{MeanOfSamples, Picks, SamplePlanes};
use super::queue::{Queue, flush};
use super::record::{Slot, TileBin};
use super::setup::Setup;
use super::shade::ShadingWork;
use super::sorted::{SortedFragment, SortedFragments};
use super::target::{ColorRows, TileRows};
use super::tested::shade_tested;
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::settings::BlendingOrder;
use crate::pipeline::viewport::ScreenTriangle;

/// Buffers for blending, reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub(super) struct TransparencyMemory {
    /// Slots of the tile's blended triangles, in submission order.
    pub(super) blended: Vec<Slot>,
    /// Colours of all samples of the tile: all pixels of the first sample, then those of the second, and so on.
    colors: Vec<Rgba8>,
    /// Index in `colors` of each sample's colour, for sixteen pixels: one entry for their first samples, then one for
    /// their second samples, and so on.
    picks: Vec<Picks>,
}

impl TransparencyMemory {
    /// Returns the memory use of the buffers in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.blended.capacity() * size_of::<Slot>()
            + self.colors.capacity() * size_of::<Rgba8>()
            + self.picks.capacity() * size_of::<Picks>()
    }

    /// Resolves the sample colours to the pixels of a tile, and writes them to the picture.
    fn resolve(&mut self, mean: MeanOfSamples<'_>, picture: &mut ColorRows<'_>) {
        let Self { colors, picks, .. } = self;
        for (row, pixels) in picture.rows().enumerate() {
            for (sixteen, out) in pixels.chunks_mut(WIDE).enumerate() {
                let first = row * TILE + sixteen * WIDE;
                let of_sample = |sample| std::array::from_fn(|lane| (sample * TILE_SAMPLES + first + lane) as u32);
                picks.clear();
                picks.extend((0..colors.len() / TILE_SAMPLES).map(of_sample));
                mean(colors, picks, out);
            }
        }
    }
}

impl TiledFrame<'_> {
    /// Draws an alpha-tested triangle into the tile of one sample. `lattice` is the lattice of that sample.
    #[inline(always)]
    pub(super) fn draw_alpha_tested_sample<S: Simd>(
        &self,
        simd: S,
        planes: &SamplePlanes<'_>,
        (tile, triangle, lattice): (&mut Tile, &Setup, &TileLattice),
        (entrants, place): (&TileBin, (usize, usize)),
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        let keep = self.alpha_test(simd, entrants.subject(triangle.slot), place);
        tile.draw_kept(simd, triangle, lattice, &self.rules, owner, |tested| {
            keep(&tested.at_first_covered(simd, triangle, lattice.offset(), &planes.shading_places))
        });
    }

    /// Blends the blended triangles of a tile over its picture, in which the opaque triangles are already shaded.
    /// Returns the number of samples shaded and texels read.
    #[inline(always)]
    pub(super) fn blend_samples<S: Simd>(
        &self,
        simd: S,
        (planes, tiles): (&SamplePlanes<'_>, &mut [Tile]),
        (entrants, place): (&TileBin, (usize, usize)),
        mixed: &MixedPixels,
        (memory, queue): (&mut TransparencyMemory, &mut Queue),
        picture: &mut ColorRows<'_>,
    ) -> ShadingWork {
        let TransparencyMemory { blended, colors, .. } = memory;
        let size = picture.size;
        colors.resize(planes.samples.offsets.len() * TILE_SAMPLES, self.background);
        for sample in colors.chunks_exact_mut(TILE_SAMPLES) {
            for (row, below) in sample.chunks_exact_mut(TILE).zip(picture.rows()) {
                row[..below.len()].copy_from_slice(below);
            }
        }
        mixed.spread(colors);
        let mut shaded = ShadingWork::default();
        let triangles = self.in_order(entrants, blended);
        if self.settings.blending.order == BlendingOrder::Exact {
            let drawn = (entrants, &*triangles);
            shaded = self.blend_sorted_samples(simd, (planes, tiles), drawn, (place, size), colors);
            memory.resolve(planes.samples.mean, picture);
            return shaded;
        }
        for (slot, triangle) in triangles {
            let subject = entrants.subject(slot);
            let shader = self.shader(subject.draw);
            let mut samples = 0;
            for (number, (tile, lattice)) in tiles.iter_mut().zip(&planes.lattices).enumerate() {
                let owner = self.owner(entrants, lattice, place);
                let Some(setup) = owner(slot) else { continue };
                tile.draw_kept(simd, &setup, lattice, &self.rules, &owner, |tested| {
                    let mut tested = tested.at_first_covered(simd, &setup, lattice.offset(), &planes.shading_places);
                    tested.passed = tested.within(size);
                    samples += if shader.on_lanes {
                        // Treats the tiles of all samples as one tall tile, so that the queue need not be flushed
                        // between samples.
                        tested.place.1 += number * TILE;
                        let size = (TILE, colors.len() / TILE);
                        let mut below = TileRows { values: colors, stride: TILE, left: 0, size };
                        shade_tested(simd, self, &subject, (place, &tested), queue, &mut below)
                    } else {
                        let values = &mut colors[number * TILE_SAMPLES..];
                        let mut below = TileRows { values, stride: TILE, left: 0, size };
                        self.blend_one_by_one((&triangle, subject.draw), (place, &tested), &mut below)
                    };
                    // Blended samples do not occlude anything, so none is stored.
                    0
                });
            }
            // The next triangle may overlap this one, so all its pixels must be written first.
            flush(simd, self, queue, colors);
            shaded.add(shader, samples);
            shaded.texels += std::mem::take(&mut queue.coarse_texels);
        }
        memory.resolve(planes.samples.mean, picture);
        shaded
    }

    /// Blends the triangles of a tile over the colours of all samples, with fragments sorted by depth in each sample.
    /// Returns the number of samples shaded and texels read.
    ///
    /// `place` is the column and row of the tile, and `size` the number of its columns and rows that lie within the
    /// picture.
    fn blend_sorted_samples<S: Simd>(
        &self,
        simd: S,
        (planes, tiles): (&SamplePlanes<'_>, &mut [Tile]),
        (entrants, triangles): (&TileBin, &[(Slot, ScreenTriangle)]),
        (place, size): ((usize, usize), (usize, usize)),
        colors: &mut [Rgba8],
    ) -> ShadingWork {
        let (mut shaded, mut list) = (ShadingWork::default(), SortedFragments::default());
        for (number, (slot, triangle)) in triangles.iter().enumerate() {
            let before = list.len();
            for (sample, (tile, lattice)) in tiles.iter_mut().zip(&planes.lattices).enumerate() {
                let owner = self.owner(entrants, lattice, place);
                let Some(setup) = owner(*slot) else { continue };
                tile.draw_kept(simd, &setup, lattice, &self.rules, &owner, |tested| {
                    let mut shading = tested.at_first_covered(simd, &setup, lattice.offset(), &planes.shading_places);
                    shading.passed = shading.within(size);
                    list.add(self.settings, (triangle, number), (sample * TILE_SAMPLES, tested), &shading);
                    // Blended fragments do not occlude anything, so none is stored.
                    0
                });
            }
            shaded.add(self.shader(entrants.subject(*slot).draw), list.len() - before);
        }
        for SortedFragment { at, triangle, edges, .. } in list.sorted() {
            let (slot, of) = &triangles[triangle];
            let draw = entrants.subject(*slot).draw;
            let pixel = at % TILE_SAMPLES;
            let fragment = self.fragment(of, draw, place, (pixel % TILE, pixel / TILE), edges);
            colors[at] = self.shader(draw).shader.blend(&fragment, of, colors[at]);
        }
        shaded
    }
}
