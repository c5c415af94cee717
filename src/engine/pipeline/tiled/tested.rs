//! Samples of a triangle that passed the depth test but are not yet stored, eight in each of two adjacent rows.

use super::TiledFrame;
use super::canvas::Canvas;
use super::edge_number::EdgeNumber as _;
use super::gather::Taps;
use super::kernel::{interpolate_pair, locate_texels};
use super::layout::{SamplePlace, TileSize};
use super::mipmap::{CoarseTaps, LevelTaps, LevelTapsMut};
use super::patch::{ALL, Patch};
use super::pending::{RowPair, SampleTargets as _};
use super::queue::{Reserved, ReservedPair};
use super::record::{ShadedTriangle, TriangleSource as _};
use super::setup::{EdgeFunctions, Setup};
use super::shader::PlannedShader;
use super::weights::{AttributeWeights, corner_weights};
use crate::math::lanes::*;

/// Returns the indices of the set bits among the lowest [`WIDE`], in ascending order.
pub(super) fn set_bits(bits: u64) -> impl Iterator<Item = usize> {
    (0..WIDE).filter(move |bit| bits >> bit & 1 != 0)
}

/// Results of the depth test for eight samples in each of two adjacent rows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TestedRows {
    /// Place of the first sample in the upper row.
    pub(super) place: SamplePlace,
    /// Edge values, indexed by row, edge and lane.
    pub(super) edges: [[[f64; LANES]; 3]; 2],
    /// Bit mask of the samples that passed. The bits of the lower row begin at bit [`LANES`].
    pub(super) passed: u64,
}

/// Sample that passed the depth test.
#[derive(Clone, Copy, Debug)]
pub(super) struct TestedSample {
    /// Bit of the sample in [`TestedRows::passed`].
    pub(super) bit: u64,
    pub(super) place: SamplePlace,
    pub(super) edges: [f64; 3],
}

impl TestedRows {
    /// Returns an iterator over the samples that passed.
    pub(super) fn samples(&self) -> impl Iterator<Item = TestedSample> {
        let SamplePlace { column, row } = self.place;
        set_bits(self.passed).map(move |i| {
            let (lane, below) = (i % LANES, i / LANES);
            TestedSample {
                bit: 1 << i,
                place: SamplePlace { column: column + lane, row: row + below },
                edges: self.edges[below].map(|values| values[lane]),
            }
        })
    }

    /// Returns the bit mask of the samples that passed and lie within the picture.
    pub(super) fn within(&self, TileSize { columns, rows }: TileSize) -> u64 {
        let SamplePlace { column, row: first } = self.place;
        let of_row = (1 << columns.saturating_sub(column).min(LANES)) - 1;
        let inside =
            (0..2).filter(|below| first + below < rows).fold(0, |bits, below| bits | of_row << (below * LANES));
        self.passed & inside
    }

    /// Returns the samples with edge values at their shading positions. The shading position in a pixel is the first of
    /// the candidates `places` that the triangle covers.
    ///
    /// `sample` is the position of the tested samples in their pixels, and must be among `places`. All positions are
    /// offsets from the pixel centre, in steps of 1/256 px.
    #[inline(never)]
    pub(super) fn at_first_covered<S: Simd>(
        &self,
        simd: S,
        triangle: &Setup,
        sample: [i32; 2],
        places: &[[i32; 2]],
    ) -> Self {
        simd.vectorize(
            #[inline(always)]
            || {
                let (mut moved, EdgeFunctions { a, b, .. }) = (*self, triangle.edges);
                let least_inside = triangle.inside_thresholds(simd);
                for (below, edges) in moved.edges.iter_mut().enumerate() {
                    let e = each!(i in [0, 1, 2] => F64::load_array_ref(simd, &edges[i]));
                    let (mut found, mut open) = (e, self.passed >> (below * LANES) & u64::from(ALL));
                    for place in places {
                        if open == 0 {
                            break;
                        }
                        let [right, down] = each!(axis in [0, 1] => f64::from(place[axis] - sample[axis]));
                        let e = each!(i in [0, 1, 2] => e[i] + (right * a[i] + down * b[i]));
                        let covered = open & f64::inside_bits(e, least_inside);
                        let here = mask64x8::from_bitmask(simd, covered);
                        found = each!(i in [0, 1, 2] => here.select(e[i], found[i]));
                        open &= !covered;
                    }
                    *edges = each!(i in [0, 1, 2] => found[i].to_array());
                }
                moved
            },
        )
    }

    /// Computes interpolation weights. Samples that did not pass get the weights at the first vertex, because weights
    /// computed from their edge values may be infinite or NaN.
    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, subject: &ShadedTriangle<'_>) -> AttributeWeights<S> {
        let e = each!(i in [0, 1, 2] => {
            let [upper, lower] = each!(row in [0, 1] => narrow(simd, F64::load_array_ref(simd, &self.edges[row][i])));
            upper.combine(lower)
        });
        corner_weights(simd, e, subject.one.relative_inv_w(simd)).of_some(simd, self.passed as u32)
    }
}

/// Adds the samples that passed to the shading queue. Returns their number. A SIMD kernel must support the shader.
#[inline(never)]
pub(super) fn shade_tested<S: Simd>(
    simd: S,
    subject: &ShadedTriangle<'_>,
    tested: &TestedRows,
    canvas: &mut Canvas<'_>,
) -> usize {
    simd.vectorize(
        #[inline(always)]
        || {
            let (size, SamplePlace { column, row: first }) = (canvas.picture.size, tested.place);
            let mine = tested.within(size) as u32;
            if mine == 0 {
                return 0;
            }
            let count = (size.columns - column).min(LANES);
            let patch = Patch { column, count, first, end: first + 2, mine };
            let frame = canvas.frame;
            let rows = RowPair { patch: &patch, locations: &frame.lattice }.rows(mine, &canvas.picture);
            let number = frame.shader_of_draw[subject.draw];
            let Reserved { pairs: [pair], taps: [fine], coarse } = canvas.reserve(simd, number, 1) else { return 0 };
            pair.rows = rows;
            let (shader, weights) = (&frame.shaders[number], tested.weights(simd, subject));
            let planned = PlannedShader { shader, plan: &shader.plan };
            let taps = LevelTapsMut { fine, coarse: coarse.first_mut() };
            interpolate_pair(simd, planned, subject.one, weights, ReservedPair { pair, taps });
            mine.count_ones() as usize
        },
    )
}

/// Returns the bit mask of the samples that passed the depth test and also pass the alpha test. A SIMD kernel must
/// support the shader.
#[inline(never)]
pub(super) fn keep_tested<S: Simd>(
    simd: S,
    frame: &TiledFrame<'_>,
    subject: &ShadedTriangle<'_>,
    tested: &TestedRows,
) -> u64 {
    simd.vectorize(
        #[inline(always)]
        || {
            let shader = frame.shader(subject.draw);
            let cutoff = shader.shader.alpha_cutoff();
            let (Some(texture), Some(layout)) = (&shader.texture, shader.plan.texture) else {
                return if shader.shader.opacity() < cutoff { 0 } else { tested.passed };
            };
            let (mut taps, mut coarse) = (Taps::default(), shader.plan.mipmapped.then(CoarseTaps::default));
            let weights = tested.weights(simd, subject);
            let planned = PlannedShader { shader, plan: &shader.plan };
            let out = LevelTapsMut { fine: &mut taps, coarse: coarse.as_mut() };
            locate_texels(simd, planned, subject.one, weights, out);
            let taps = LevelTaps { fine: &taps, coarse: coarse.as_ref() };
            let alpha = texture.filtered_alpha(simd, layout, taps) * shader.shader.opacity();
            let failed = alpha.simd_lt(cutoff).to_bitmask();
            tested.passed & !failed
        },
    )
}
