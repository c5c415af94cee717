//! Triangles that are seen through: cut out where texels say so, or blended over what lies behind.
//!
//! Both ask texels sample by sample, by the classic way's own functions. Cut-out triangles are drawn among the opaque ones,
//! as what is cut out neither hides nor stores anything. Blended ones come over the shaded tile, from far to near.

use super::Frame;
use super::bins::Key;
use super::lattice::TILE;
use super::locations::Locations;
use super::record::{Entrant, Entrants, Slot};
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::interpolate::{Fragment, interpolate};
use crate::pipeline::mean_distance;
use crate::pipeline::raster::Sample;
use crate::pipeline::viewport::ScreenTriangle;

/// Numbers of the bits that are set.
pub(super) fn set_bits(bits: u64) -> impl Iterator<Item = usize> {
    (0..LANES).filter(move |lane| bits >> lane & 1 != 0)
}

impl Frame<'_> {
    /// One of eight samples of a row as the classic way interpolates it.
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

    /// Which of eight samples of a row of a cut-out triangle are there.
    pub(super) fn keeper(
        &self,
        key: Key,
        draw: usize,
        tile: (usize, usize),
    ) -> impl Fn(&[[f64; LANES]; 3], (usize, usize), u64) -> u64 {
        let triangle = self.screen_triangle(key, draw);
        let shader = &self.shader(draw).shader;
        move |edges, (column, row), passed| {
            let is_there = |lane: &usize| {
                let edges = edges.map(|e| e[*lane]);
                !shader.cuts_out(&self.fragment(&triangle, draw, tile, (column + lane, row), edges))
            };
            set_bits(passed).filter(is_there).fold(0, |kept, lane| kept | 1 << lane)
        }
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
    /// packed picture that start with the tile's first one. Gives the number of samples.
    pub(super) fn blend<S: Simd>(
        &self,
        simd: S,
        tile: &mut Tile,
        locations: impl Locations,
        (entrants, blended): (&Entrants, &[Slot]),
        place: (usize, usize),
        colors: &mut [Rgba8],
    ) -> u64 {
        let owner = self.owner(entrants, locations.lattice(), place);
        let (width, height) = (self.packed.0 as usize, colors.len() / self.packed.0 as usize);
        let left = place.0 * TILE;
        let mut samples = 0;
        for (slot, triangle) in self.by_distance(entrants, blended) {
            let Some(setup) = owner(slot) else { continue };
            let draw = entrants.get(slot).draw as usize;
            let shader = &self.shader(draw).shader;
            tile.draw_kept(simd, &setup, locations, &self.rules, &owner, |edges, (column, row), passed| {
                for lane in set_bits(passed) {
                    let column = column + lane;
                    if left + column < width && row < height {
                        let fragment = self.fragment(&triangle, draw, place, (column, row), edges.map(|e| e[lane]));
                        let pixel = &mut colors[row * width + left + column];
                        *pixel = shader.blend(&fragment, &triangle, *pixel);
                        samples += 1;
                    }
                }
                // What is blended hides nothing.
                0
            });
        }
        samples
    }
}
