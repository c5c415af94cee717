//! Triangles that are seen through: cut out where texels say so, or blended over what lies behind.
//!
//! Cut-out triangles are drawn among the opaque ones, as what is cut out neither hides nor stores anything. Blended ones come
//! over the shaded tile, from far to near. Both are shaded on lanes, two rows at a time, if there is code on lanes for their
//! shading, else sample by sample by the classic way's own functions.

use super::Frame;
use super::kernel::Band;
use super::lattice::TILE;
use super::locations::Locations;
use super::queue::{Queue, flush};
use super::record::{Entrant, Entrants, Slot, Subject};
use super::setup::Setup;
use super::shade::Shaded;
use super::tested::{TestedRows, TestedSample, keep_tested, shade_tested};
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::interpolate::{Fragment, interpolate};
use crate::pipeline::mean_distance;
use crate::pipeline::raster::Sample;
use crate::pipeline::viewport::ScreenTriangle;

impl Frame<'_> {
    /// A sample as the classic way interpolates it.
    pub(super) fn fragment(
        &self,
        triangle: &ScreenTriangle,
        draw: usize,
        tile: (usize, usize),
        (column, row): (usize, usize),
        edges: [f64; 3],
    ) -> Fragment {
        let (column, row) = ((tile.0 * TILE + column) as u32, (tile.1 * TILE + row) as u32);
        let (x, y) = self.grid.pixel(column, row);
        interpolate(triangle, Sample { column, row, x, y, edges }, self.shader(draw).shader.attributes())
    }

    /// Draws a cut-out triangle into a tile.
    #[inline(always)]
    pub(super) fn draw_what_is_there<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl Locations),
        triangle: &Setup,
        (entrants, place): (&Entrants, (usize, usize)),
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        let subject = entrants.subject(triangle.slot);
        let Subject { key, draw, .. } = subject;
        if self.shader(draw).on_lanes {
            let keep = |tested: &TestedRows| keep_tested(simd, self, &subject, tested);
            tile.draw_kept(simd, triangle, locations, &self.rules, owner, keep);
            return;
        }
        let (whole, shader) = (self.screen_triangle(key, draw), &self.shader(draw).shader);
        tile.draw_kept(simd, triangle, locations, &self.rules, owner, |tested| {
            let is_there = |sample: &TestedSample| {
                !shader.cuts_out(&self.fragment(&whole, draw, place, sample.place, sample.edges))
            };
            tested.samples().filter(is_there).fold(0, |kept, sample| kept | sample.bit)
        });
    }

    /// Some triangles of a tile, given in the order in which they were submitted, in that in which they are blended.
    pub(super) fn by_distance(&self, entrants: &Entrants, blended: &[Slot]) -> Vec<(Slot, ScreenTriangle)> {
        let measured = |slot: &Slot| {
            let Entrant { key, draw } = entrants.get(*slot);
            let triangle = self.screen_triangle(key, draw as usize);
            (mean_distance(&self.scale, &triangle), *slot, triangle)
        };
        let mut sorted: Vec<_> = blended.iter().map(measured).collect();
        sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
        sorted.into_iter().map(|(_, slot, triangle)| (slot, triangle)).collect()
    }

    /// Blends some triangles of a tile, given in the order in which they were submitted, over its colours: the rows of the
    /// packed picture that start with the tile's first one. Says how much that was.
    pub(super) fn blend<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl Locations),
        (entrants, blended): (&Entrants, &[Slot]),
        place: (usize, usize),
        queue: &mut Queue,
        colors: &mut [Rgba8],
    ) -> Shaded {
        let owner = self.owner(entrants, locations.lattice(), place);
        let mut band = Band { pixels: colors, width: self.packed.0 as usize };
        let (columns, rows) = band.size(place);
        let left = place.0 * TILE;
        let mut shaded = Shaded::default();
        for (slot, triangle) in self.by_distance(entrants, blended) {
            let Some(setup) = owner(slot) else { continue };
            let subject = entrants.subject(slot);
            let Subject { draw, .. } = subject;
            let shader = self.shader(draw);
            let mut samples = 0;
            // What is blended hides nothing: none is kept.
            if shader.on_lanes {
                tile.draw_kept(simd, &setup, locations, &self.rules, &owner, |tested| {
                    samples += shade_tested(simd, self, &subject, (place, tested), queue, &mut band);
                    0
                });
                // The next triangle may lie over this one.
                flush(simd, self, queue, band.pixels);
                shaded.add(shader, samples);
                shaded.texels += std::mem::take(&mut queue.coarse_texels);
                continue;
            }
            tile.draw_kept(simd, &setup, locations, &self.rules, &owner, |tested| {
                for TestedSample { place: at @ (column, row), edges, .. } in tested.samples() {
                    if column < columns && row < rows {
                        let fragment = self.fragment(&triangle, draw, place, at, edges);
                        let pixel = &mut band.pixels[row * band.width + left + column];
                        *pixel = shader.shader.blend(&fragment, &triangle, *pixel);
                        samples += 1;
                    }
                }
                0
            });
            shaded.add(shader, samples);
        }
        shaded
    }
}
