//! Alpha-tested and blended triangles with multisampling.
//!
//! A triangle has one fragment per pixel, as without transparency. A fragment that fails the alpha test is discarded in
//! all samples of the pixel. A blended fragment is blended over the colour of each sample separately. Tiles with
//! blended triangles therefore keep the colours of all samples until the last of these triangles is drawn. A fragment
//! is recomputed for each sample in which it is visible: with sixteen at a time, this is faster than looking up a
//! stored result.

use super::canvas::Canvas;
use super::lattice::TileLattice;
use super::layout::{SamplePlace, TILE, TILE_SAMPLES, TileSize};
use super::mixed::MixedPixels;
use super::multisample::{MeanOfSamples, Picks, PlaneTiles, SamplePlanes};
use super::pass::TilePass;
use super::setup::Setup;
use super::shade::ShadingWork;
use super::slot::Slot;
use super::sorted::{BlendedTriangle, SortedFragment, SortedFragments};
use super::target::{ColorRows, TileRows};
use super::tested::shade_tested;
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::settings::BlendingOrder;

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

    /// Fills the sample colours with those of the picture and of the mixed pixels of a tile.
    fn begin(&mut self, planes: &SamplePlanes<'_>, mixed: &MixedPixels, canvas: &mut Canvas<'_>) {
        let Self { colors, .. } = self;
        colors.resize(planes.samples.offsets.len() * TILE_SAMPLES, canvas.frame.background);
        for sample in colors.chunks_exact_mut(TILE_SAMPLES) {
            for (row, below) in sample.chunks_exact_mut(TILE).zip(canvas.picture.rows()) {
                row[..below.len()].copy_from_slice(below);
            }
        }
        mixed.spread(colors);
    }

    /// Blends the blended triangles of a tile over its picture, in which the opaque triangles are already shaded.
    /// Returns the number of samples shaded and texels read.
    #[inline(always)]
    pub(super) fn blend<S: Simd>(
        &mut self,
        simd: S,
        mut planes: PlaneTiles<'_>,
        mixed: &MixedPixels,
        canvas: &mut Canvas<'_>,
    ) -> ShadingWork {
        self.begin(planes.planes, mixed, canvas);
        let frame = canvas.frame;
        let triangles = frame.in_order(planes.bin, &self.blended);
        let shaded = if frame.settings.blending.order == BlendingOrder::Exact {
            self.blend_sorted(simd, &mut planes, &triangles, canvas)
        } else {
            self.blend_in_order(simd, &mut planes, &triangles, canvas)
        };
        self.resolve(planes.planes.samples.mean, &mut canvas.picture);
        shaded
    }

    /// Blends the triangles of a tile over the colours of all samples, one after the other. Returns the number of
    /// samples shaded and texels read.
    #[inline(always)]
    fn blend_in_order<S: Simd>(
        &mut self,
        simd: S,
        PlaneTiles { planes, tiles, bin }: &mut PlaneTiles<'_>,
        triangles: &[BlendedTriangle<'_>],
        canvas: &mut Canvas<'_>,
    ) -> ShadingWork {
        let (mut shaded, frame, size) = (ShadingWork::default(), canvas.frame, canvas.picture.size);
        // Treats the tiles of all samples as one tall tile, so that the queue need not be flushed between samples.
        let tall = TileSize { columns: TILE, rows: self.colors.len() / TILE };
        let picture = TileRows { values: &mut self.colors[..], stride: TILE, left: 0, size: tall };
        let mut canvas = Canvas { picture, ..canvas.reborrow() };
        for BlendedTriangle { slot, draw, classic } in triangles {
            let (subject, shader) = (bin.subject(*slot), frame.shader(*draw));
            let mut samples = 0;
            for (number, (tile, lattice)) in tiles.iter_mut().zip(&planes.lattices).enumerate() {
                let pass = TilePass::new(frame, bin, lattice);
                let Some(setup) = pass.set_up(*slot) else { continue };
                tile.draw_kept(simd, &setup, &pass, |tested| {
                    let mut tested = tested.at_first_covered(simd, &setup, lattice.offset(), &planes.shading_places);
                    tested.passed = tested.within(size);
                    samples += if shader.on_lanes {
                        tested.place.row += number * TILE;
                        shade_tested(simd, &subject, &tested, &mut canvas)
                    } else {
                        let values = &mut canvas.picture.values[number * TILE_SAMPLES..];
                        let mut below = TileRows { values, stride: TILE, left: 0, size };
                        classic.blend_samples(&tested, &mut below)
                    };
                    // Blended samples do not occlude anything, so none is stored.
                    0
                });
            }
            // The next triangle may overlap this one, so all its pixels must be written first.
            shaded.texels += canvas.finish(simd);
            shaded.add(shader, samples);
        }
        shaded
    }

    /// Blends the triangles of a tile over the colours of all samples, with fragments sorted by depth in each sample.
    /// Returns the number of samples shaded and texels read.
    fn blend_sorted<S: Simd>(
        &mut self,
        simd: S,
        PlaneTiles { planes, tiles, bin }: &mut PlaneTiles<'_>,
        triangles: &[BlendedTriangle<'_>],
        canvas: &Canvas<'_>,
    ) -> ShadingWork {
        let (frame, size) = (canvas.frame, canvas.picture.size);
        let (mut shaded, mut list) = (ShadingWork::default(), SortedFragments::new(frame.settings, triangles));
        for (number, BlendedTriangle { slot, draw, .. }) in triangles.iter().enumerate() {
            let before = list.len();
            for (sample, (tile, lattice)) in tiles.iter_mut().zip(&planes.lattices).enumerate() {
                let pass = TilePass::new(frame, bin, lattice);
                let Some(setup) = pass.set_up(*slot) else { continue };
                tile.draw_kept(simd, &setup, &pass, |tested| {
                    let mut shading = tested.at_first_covered(simd, &setup, lattice.offset(), &planes.shading_places);
                    shading.passed = shading.within(size);
                    list.add(number, sample * TILE_SAMPLES, tested, &shading);
                    // Blended fragments do not occlude anything, so none is stored.
                    0
                });
            }
            shaded.add(frame.shader(*draw), list.len() - before);
        }
        for SortedFragment { at, triangle, edges, .. } in list.sorted() {
            let (place, classic) = (SamplePlace::of(at % TILE_SAMPLES), &triangles[triangle].classic);
            classic.blend(&classic.fragment(place, edges), &mut self.colors[at]);
        }
        shaded
    }
}

impl TilePass<'_, &TileLattice> {
    /// Draws an alpha-tested triangle into the tile of one sample. The lattice of the pass is that of the sample.
    #[inline(always)]
    pub(super) fn draw_alpha_tested_sample<S: Simd>(
        &self,
        simd: S,
        planes: &SamplePlanes<'_>,
        tile: &mut Tile,
        triangle: &Setup,
    ) {
        let keep = self.alpha_test(simd, triangle.slot);
        tile.draw_kept(simd, triangle, self, |tested| {
            keep(&tested.at_first_covered(simd, triangle, self.locations.offset(), &planes.shading_places))
        });
    }
}
