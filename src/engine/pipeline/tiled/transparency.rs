//! Transparency: alpha-tested and blended triangles.
//!
//! Alpha-tested triangles are drawn together with the opaque ones, because samples that fail the alpha test are simply
//! not stored. Blended triangles are drawn over the shaded tile, in the order that the settings select. Both are shaded
//! with SIMD, two rows at a time, if a kernel supports their shading. Otherwise the code of the classic path shades
//! them sample by sample. Fragments that are sorted individually are always blended by the classic path's code.

use super::TiledFrame;
use super::canvas::Canvas;
use super::layout::SamplePlace;
use super::pass::TilePass;
use super::record::{BinEntry, ShadedTriangle, TileBin};
use super::sample_positions::SamplePositions;
use super::setup::Setup;
use super::shade::ShadingWork;
use super::slot::Slot;
use super::sorted::{BlendedTriangle, SortedFragment, SortedFragments};
use super::target::ColorRows;
use super::tested::{TestedRows, keep_tested, shade_tested};
use super::tile::Tile;
use crate::math::lanes::*;
use crate::pipeline::mean_distance;
use crate::pipeline::settings::BlendingOrder;

impl TiledFrame<'_> {
    /// Returns the blended triangles of a tile in blending order. `blended` is in submission order, which is kept
    /// unless the settings sort whole triangles by distance.
    pub(super) fn in_order(&self, entrants: &TileBin, blended: &[Slot]) -> Vec<BlendedTriangle<'_>> {
        let measured = |slot: &Slot| {
            let BinEntry { key, draw } = entrants.get(*slot);
            let draw = draw as usize;
            let classic = self.classic(key, draw, entrants.place);
            let distance = mean_distance(&self.scale, &classic.triangle);
            (distance, BlendedTriangle { slot: *slot, draw, classic })
        };
        let mut sorted: Vec<_> = blended.iter().map(measured).collect();
        if self.settings.blending.order == BlendingOrder::Triangles {
            sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
        }
        sorted.into_iter().map(|(_, triangle)| triangle).collect()
    }
}

impl<L: SamplePositions> TilePass<'_, L> {
    /// Draws an alpha-tested triangle into a tile.
    #[inline(always)]
    pub(super) fn draw_alpha_tested<S: Simd>(&self, simd: S, tile: &mut Tile, triangle: &Setup) {
        tile.draw_kept(simd, triangle, self, self.alpha_test(simd, triangle.slot));
    }

    /// Returns a function that performs the alpha test of a triangle. It receives samples that passed the depth test
    /// and returns the bit mask of those to keep.
    pub(super) fn alpha_test<S: Simd>(&self, simd: S, slot: Slot) -> impl Fn(&TestedRows) -> u64 {
        let Self { frame, bin, .. } = *self;
        let subject @ ShadedTriangle { key, draw, .. } = bin.subject(slot);
        let whole = (!frame.shader(draw).on_lanes).then(|| frame.classic(key, draw, bin.place));
        move |tested| {
            let Some(whole) = &whole else { return keep_tested(simd, frame, &subject, tested) };
            tested.samples().filter(|sample| !whole.fails_alpha_test(sample)).fold(0, |kept, sample| kept | sample.bit)
        }
    }

    /// Blends the blended triangles of a tile, given in submission order, over its picture. Returns the number of
    /// samples shaded and texels read.
    pub(super) fn blend<S: Simd>(
        &self,
        simd: S,
        tile: &mut Tile,
        blended: &[Slot],
        canvas: &mut Canvas<'_>,
    ) -> ShadingWork {
        let frame = self.frame;
        let triangles = frame.in_order(self.bin, blended);
        if frame.settings.blending.order == BlendingOrder::Exact {
            return self.blend_sorted(simd, tile, &triangles, &mut canvas.picture);
        }
        let mut shaded = ShadingWork::default();
        for BlendedTriangle { slot, draw, classic } in &triangles {
            let Some(setup) = self.set_up(*slot) else { continue };
            let (subject, shader) = (self.bin.subject(*slot), frame.shader(*draw));
            let mut samples = 0;
            // Blended samples do not occlude anything, so none is stored.
            if shader.on_lanes {
                tile.draw_kept(simd, &setup, self, |tested| {
                    samples += shade_tested(simd, &subject, tested, canvas);
                    0
                });
                // The next triangle may overlap this one, so all its pixels must be written first.
                shaded.texels += canvas.finish(simd);
            } else {
                tile.draw_kept(simd, &setup, self, |tested| {
                    let tested = TestedRows { passed: tested.within(canvas.picture.size), ..*tested };
                    samples += classic.blend_samples(&tested, &mut canvas.picture);
                    0
                });
            }
            shaded.add(shader, samples);
        }
        shaded
    }

    /// Blends triangles of a tile over its picture, with all fragments sorted by depth. Returns the number of samples
    /// shaded and texels read.
    fn blend_sorted<S: Simd>(
        &self,
        simd: S,
        tile: &mut Tile,
        triangles: &[BlendedTriangle<'_>],
        picture: &mut ColorRows<'_>,
    ) -> ShadingWork {
        let frame = self.frame;
        let (mut shaded, mut list) = (ShadingWork::default(), SortedFragments::new(frame.settings, triangles));
        for (number, BlendedTriangle { slot, draw, .. }) in triangles.iter().enumerate() {
            let Some(setup) = self.set_up(*slot) else { continue };
            let before = list.len();
            // Blended fragments do not occlude anything, so none is stored.
            tile.draw_kept(simd, &setup, self, |tested| {
                let within = TestedRows { passed: tested.within(picture.size), ..*tested };
                list.add(number, 0, &within, &within);
                0
            });
            shaded.add(frame.shader(*draw), list.len() - before);
        }
        for SortedFragment { at, triangle, edges, .. } in list.sorted() {
            let (place, classic) = (SamplePlace::of(at), &triangles[triangle].classic);
            classic.blend(&classic.fragment(place, edges), picture.at(place));
        }
        shaded
    }
}
