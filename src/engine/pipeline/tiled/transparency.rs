//! Transparency: alpha-tested and blended triangles.
//!
//! Alpha-tested triangles are drawn together with the opaque ones, because samples that fail the alpha test are simply
//! not stored. Blended triangles are drawn over the shaded tile, in the order that the settings select. Both are shaded
//! with SIMD, two rows at a time, if a kernel supports their shading. Otherwise the code of the classic path shades
//! them sample by sample. Fragments that are sorted individually are always blended by the classic path's code.

use super::TiledFrame;
use super::lattice::TILE;
use super::queue::{Queue, flush};
use super::record::{BinEntry, ShadedTriangle, Slot, TileBin};
use super::sample_positions::SamplePositions;
use super::setup::Setup;
use super::shade::ShadingWork;
use super::shader::DrawShader;
use super::sorted::{SortedFragment, SortedFragments};
use super::target::ColorRows;
use super::tested::{TestedRows, TestedSample, keep_tested, shade_tested};
use super::tile::Tile;
use crate::math::lanes::*;
use crate::pipeline::interpolate::{Fragment, interpolate};
use crate::pipeline::mean_distance;
use crate::pipeline::raster::RasterSample;
use crate::pipeline::settings::BlendingOrder;
use crate::pipeline::viewport::ScreenTriangle;

impl TiledFrame<'_> {
    /// Interpolates the attributes of one sample with the code of the classic (scalar) path.
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
        interpolate(triangle, RasterSample { column, row, x, y, edges }, self.shader(draw).shader.attributes())
    }

    /// Draws an alpha-tested triangle into a tile.
    #[inline(always)]
    pub(super) fn draw_alpha_tested<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl SamplePositions),
        triangle: &Setup,
        (entrants, place): (&TileBin, (usize, usize)),
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        let keep = self.alpha_test(simd, entrants.subject(triangle.slot), place);
        tile.draw_kept(simd, triangle, locations, &self.rules, owner, keep);
    }

    /// Returns a function that performs the alpha test of a triangle. It receives samples that passed the depth test
    /// and returns the bit mask of those to keep.
    pub(super) fn alpha_test<'a, S: Simd>(
        &'a self,
        simd: S,
        subject: ShadedTriangle<'a>,
        place: (usize, usize),
    ) -> impl Fn(&TestedRows) -> u64 + 'a {
        let ShadedTriangle { key, draw, .. } = subject;
        let DrawShader { shader, on_lanes, .. } = self.shader(draw);
        let whole = (!on_lanes).then(|| self.screen_triangle(key, draw));
        move |tested| {
            let Some(whole) = &whole else { return keep_tested(simd, self, &subject, tested) };
            let is_there = |sample: &TestedSample| {
                !shader.fails_alpha_test(&self.fragment(whole, draw, place, sample.place, sample.edges))
            };
            tested.samples().filter(is_there).fold(0, |kept, sample| kept | sample.bit)
        }
    }

    /// Returns the blended triangles of a tile in blending order. `blended` is in submission order, which is kept
    /// unless the settings sort whole triangles by distance.
    pub(super) fn in_order(&self, entrants: &TileBin, blended: &[Slot]) -> Vec<(Slot, ScreenTriangle)> {
        let measured = |slot: &Slot| {
            let BinEntry { key, draw } = entrants.get(*slot);
            let triangle = self.screen_triangle(key, draw as usize);
            (mean_distance(&self.scale, &triangle), *slot, triangle)
        };
        let mut sorted: Vec<_> = blended.iter().map(measured).collect();
        if self.settings.blending.order == BlendingOrder::Triangles {
            sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
        }
        sorted.into_iter().map(|(_, slot, triangle)| (slot, triangle)).collect()
    }

    /// Blends the blended triangles of a tile, given in submission order, over its picture. Returns the number of
    /// samples shaded and texels read.
    pub(super) fn blend<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl SamplePositions),
        (entrants, blended): (&TileBin, &[Slot]),
        place: (usize, usize),
        queue: &mut Queue,
        picture: &mut ColorRows<'_>,
    ) -> ShadingWork {
        let triangles = self.in_order(entrants, blended);
        if self.settings.blending.order == BlendingOrder::Exact {
            return self.blend_sorted(simd, (tile, locations), (entrants, &triangles), place, picture);
        }
        let owner = self.owner(entrants, locations.lattice(), place);
        let mut shaded = ShadingWork::default();
        for (slot, triangle) in triangles {
            let Some(setup) = owner(slot) else { continue };
            let subject = entrants.subject(slot);
            let shader = self.shader(subject.draw);
            let mut samples = 0;
            // Blended samples do not occlude anything, so none is stored.
            if shader.on_lanes {
                tile.draw_kept(simd, &setup, locations, &self.rules, &owner, |tested| {
                    samples += shade_tested(simd, self, &subject, (place, tested), queue, picture);
                    0
                });
                // The next triangle may overlap this one, so all its pixels must be written first.
                flush(simd, self, queue, picture.values);
                shaded.add(shader, samples);
                shaded.texels += std::mem::take(&mut queue.coarse_texels);
                continue;
            }
            tile.draw_kept(simd, &setup, locations, &self.rules, &owner, |tested| {
                let tested = TestedRows { passed: tested.within(picture.size), ..*tested };
                samples += self.blend_one_by_one((&triangle, subject.draw), (place, &tested), picture);
                0
            });
            shaded.add(shader, samples);
        }
        shaded
    }

    /// Blends triangles of a tile over its picture, with all fragments sorted by depth. Returns the number of samples
    /// shaded and texels read.
    fn blend_sorted<S: Simd>(
        &self,
        simd: S,
        (tile, locations): (&mut Tile, impl SamplePositions),
        (entrants, triangles): (&TileBin, &[(Slot, ScreenTriangle)]),
        place: (usize, usize),
        picture: &mut ColorRows<'_>,
    ) -> ShadingWork {
        let owner = self.owner(entrants, locations.lattice(), place);
        let (mut shaded, mut list) = (ShadingWork::default(), SortedFragments::default());
        for (number, (slot, triangle)) in triangles.iter().enumerate() {
            let Some(setup) = owner(*slot) else { continue };
            let before = list.len();
            // Blended fragments do not occlude anything, so none is stored.
            tile.draw_kept(simd, &setup, locations, &self.rules, &owner, |tested| {
                let within = TestedRows { passed: tested.within(picture.size), ..*tested };
                list.add(self.settings, (triangle, number), (0, &within), &within);
                0
            });
            let subject = entrants.subject(*slot);
            shaded.add(self.shader(subject.draw), list.len() - before);
        }
        let draws: Vec<_> = triangles.iter().map(|(slot, _)| entrants.subject(*slot).draw).collect();
        for SortedFragment { at, triangle, edges, .. } in list.sorted() {
            let (column, row) = (at % TILE, at / TILE);
            let pixel = &mut picture.values[row * picture.stride + picture.left + column];
            let (of, draw) = (&triangles[triangle].1, draws[triangle]);
            let fragment = self.fragment(of, draw, place, (column, row), edges);
            *pixel = self.shader(draw).shader.blend(&fragment, of, *pixel);
        }
        shaded
    }

    /// Blends the samples that passed over the colours in `below`, one by one, with the code of the classic path.
    /// Returns their number.
    pub(super) fn blend_one_by_one(
        &self,
        (triangle, draw): (&ScreenTriangle, usize),
        (place, tested): ((usize, usize), &TestedRows),
        below: &mut ColorRows<'_>,
    ) -> usize {
        let shader = &self.shader(draw).shader;
        for TestedSample { place: at @ (column, row), edges, .. } in tested.samples() {
            let pixel = &mut below.values[row * below.stride + below.left + column];
            *pixel = shader.blend(&self.fragment(triangle, draw, place, at, edges), triangle, *pixel);
        }
        tested.passed.count_ones() as usize
    }
}
