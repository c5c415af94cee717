//! Triangles of a tile in the layout of the classic (scalar) path, whose code shades them sample by sample.

use super::TiledFrame;
use super::bins::TriangleKey;
use super::layout::{SamplePlace, TilePlace};
use super::patch::Patch;
use super::target::ColorRows;
use super::tested::{TestedRows, TestedSample};
use crate::image::Rgba8;
use crate::math::lanes::LANES;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::interpolate::{Fragment, interpolate};
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::shade::Shader;

/// Triangle of a tile for the code of the classic path, with its shader.
pub(super) struct ClassicTriangle<'a> {
    pub(super) triangle: ScreenTriangle,
    shader: &'a Shader<'a>,
    grid: SampleGrid,
    tile: TilePlace,
}

impl TiledFrame<'_> {
    /// Returns a triangle of a tile for the code of the classic path. `draw` is the index of its draw.
    pub(super) fn classic(&self, key: TriangleKey, draw: usize, tile: TilePlace) -> ClassicTriangle<'_> {
        let shader = &self.shader(draw).shader;
        ClassicTriangle { triangle: self.screen_triangle(key, draw), shader, grid: self.grid, tile }
    }
}

impl ClassicTriangle<'_> {
    /// Interpolates the attributes of a sample, given its edge values.
    #[inline(always)]
    pub(super) fn fragment(&self, place: SamplePlace, edges: [f64; 3]) -> Fragment {
        let (column, row) = self.tile.packed(place);
        let (x, y) = self.grid.pixel(column, row);
        interpolate(&self.triangle, RasterSample { column, row, x, y, edges }, self.shader.attributes())
    }

    /// Returns `true` if a sample fails the alpha test.
    pub(super) fn fails_alpha_test(&self, sample: &TestedSample) -> bool {
        self.shader.fails_alpha_test(&self.fragment(sample.place, sample.edges))
    }

    /// Returns the colour of a fragment.
    #[inline(always)]
    pub(super) fn shade(&self, fragment: &Fragment) -> Rgba8 {
        self.shader.shade(fragment, &self.triangle)
    }

    /// Blends a fragment over a colour.
    pub(super) fn blend(&self, fragment: &Fragment, below: &mut Rgba8) {
        *below = self.shader.blend(fragment, &self.triangle, *below);
    }

    /// Shades the samples that a patch selects in one of its rows. `edges` are their edge values, indexed by edge and
    /// lane. Not inlined into SIMD code, where it would spill registers.
    #[inline(never)]
    pub(super) fn shade_row(&self, patch: &Patch, row: usize, edges: &[[f64; LANES]; 3], out: &mut [Rgba8]) {
        for (lane, pixel) in out.iter_mut().enumerate().filter(|(lane, _)| patch.mine >> lane & 1 != 0) {
            *pixel =
                self.shade(&self.fragment(SamplePlace { column: patch.column + lane, row }, edges.map(|e| e[lane])));
        }
    }

    /// Blends the samples that passed over the colours in `below`. Returns their number.
    pub(super) fn blend_samples(&self, tested: &TestedRows, below: &mut ColorRows<'_>) -> usize {
        for TestedSample { place, edges, .. } in tested.samples() {
            self.blend(&self.fragment(place, edges), below.at(place));
        }
        tested.passed.count_ones() as usize
    }
}
