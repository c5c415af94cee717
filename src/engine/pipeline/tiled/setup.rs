//! Setup of a triangle in one tile: edge functions and depth terms relative to the tile's first sample.

use super::edge_number::EdgeNumber;
use super::lattice::{TileLattice, TileOrigin};
use super::layout::TILE;
use super::packed::PackedVertex;
use super::slot::Slot;
use crate::math::fixed::SUBPIXELS;
use crate::math::lanes::*;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::raster::fill_rule::EdgeOwner;
use crate::pipeline::raster::inward::Inward;
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::pipeline::settings::FillRule;

/// Vertex of a triangle, snapped to the subpixel grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct SnappedVertex {
    /// Snapped position in steps of 1/256 px.
    pub(super) position: [f64; 2],
    /// Depth in [0, 1], before quantisation.
    pub(super) depth: f64,
    /// Reciprocal of clip-space w.
    pub(super) inv_w: f32,
}

impl SnappedVertex {
    /// Returns the snapped position in pixels.
    #[inline(always)]
    pub(super) fn position_px(&self) -> [f64; 2] {
        self.position.map(|steps| steps / SUBPIXELS as f64)
    }
}

impl From<&PackedVertex> for SnappedVertex {
    #[inline(always)]
    fn from(vertex: &PackedVertex) -> Self {
        let [x, y] = vertex.position();
        Self { position: [x.into(), y.into()], depth: vertex.depth(), inv_w: vertex.inv_w() }
    }
}

impl From<&ScreenVertex> for SnappedVertex {
    fn from(vertex: &ScreenVertex) -> Self {
        Self { position: [vertex.x.into(), vertex.y.into()], depth: vertex.depth, inv_w: vertex.inv_w }
    }
}

/// Data that the setup of all triangles in a tile shares.
#[derive(Clone, Copy, Debug)]
pub(super) struct SetupContext<'a> {
    pub(super) rule: FillRule,
    pub(super) scale: &'a DepthScale,
    pub(super) lattice: &'a TileLattice,
    /// Place of the tile's first sample on the lattice.
    pub(super) origin: TileOrigin,
}

/// Candidate shading positions of a triangle in a pixel, in order of preference.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadingCandidates<'a> {
    /// Candidates, as offsets from the pixel centre in steps of 1/256 px.
    pub(super) offsets: &'a [[i32; 2]],
    /// Fill rule, which decides whether the triangle covers a candidate on one of its edges.
    pub(super) rule: FillRule,
}

/// Edge functions of a triangle, each belonging to the opposite vertex: e(x, y) = a·x + b·y + c.
///
/// x and y are in steps of 1/256 px from an origin, and e is in units of 1/2¹⁶ px². Edges in f64 are in the order of
/// the vertices. Their values are integers below 2⁵³, so f64 holds them and their sums exactly. Edges in i32 may begin
/// with another vertex: see [`EdgeNumber::LAST_HAS_MIN_DEPTH`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EdgeFunctions<E = f64> {
    pub(super) a: [E; 3],
    pub(super) b: [E; 3],
    pub(super) c: [E; 3],
}

impl EdgeFunctions {
    /// Returns the edge functions of a triangle and its doubled area, which is positive; `None` if it has no area.
    #[inline(always)]
    pub(super) fn new(corners: &[SnappedVertex; 3], origin: [f64; 2]) -> Option<(Self, f64)> {
        let p = each!(i in [0, 1, 2] => [corners[i].position[0] - origin[0], corners[i].position[1] - origin[1]]);
        let area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
        if area == 0.0 {
            return None;
        }
        let sign = area.signum();
        let (mut a, mut b, mut c) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let (from, to) = ((i + 1) % 3, (i + 2) % 3);
            a[i] = (p[from][1] - p[to][1]) * sign;
            b[i] = (p[to][0] - p[from][0]) * sign;
            c[i] = -(a[i] * p[from][0] + b[i] * p[from][1]);
        }
        Some((Self { a, b, c }, area.abs()))
    }

    /// Returns the edge values at an offset from the origin, in steps of 1/256 px.
    pub(super) fn at(&self, place: [i32; 2]) -> [f64; 3] {
        let [x, y] = place.map(f64::from);
        each!(i in [0, 1, 2] => self.a[i] * x + self.b[i] * y + self.c[i])
    }

    /// Returns the first candidate position in a pixel that the triangle covers. The triangle must cover at least one
    /// candidate.
    ///
    /// The pixel centre (x, y) and the result are relative to the origin, in steps of 1/256 px.
    pub(super) fn first_covered(
        &self,
        [x, y]: [i32; 2],
        ShadingCandidates { offsets, rule }: ShadingCandidates<'_>,
    ) -> [i32; 2] {
        let inside = self.inside(rule);
        let covers = |place: &[i32; 2]| self.at(*place).iter().zip(inside).all(|(value, least)| *value >= least);
        let moved = |[right, down]: &[i32; 2]| [x + right, y + down];
        offsets.iter().map(moved).find(covers).unwrap_or([x, y])
    }

    /// Returns the inside threshold of each edge, the least edge value that counts as inside: 0 if the fill rule
    /// assigns the edge to the triangle, otherwise 1.
    #[inline(always)]
    pub(super) fn inside(&self, rule: FillRule) -> [f64; 3] {
        each!(i in [0, 1, 2] => {
            let owned = Inward::new(self.a[i], self.b[i]).owned(rule);
            f64::from(u8::from(!owned))
        })
    }
}

/// Triangle that is set up for one tile. Vertex data is in the order of the edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup<E = f64> {
    pub(super) slot: Slot,
    pub(super) edges: EdgeFunctions<E>,
    /// Inside threshold of each edge, the least edge value that counts as inside: 0 if the fill rule assigns the edge
    /// to the triangle, otherwise 1.
    pub(super) inside: [E; 3],
    /// Minimum vertex depth, including the depth bias. The depth at a sample is `min_depth` plus the sum of `rises`
    /// times edge values, or times weights if depth is linear in view space.
    pub(super) min_depth: f64,
    /// Factor by which the value (or weight) of each edge is multiplied in that sum.
    pub(super) rises: [f64; 3],
    /// Maximum vertex depth, including the depth bias.
    pub(super) max_depth: f64,
    /// 1/w of the vertices, for depth that is linear in view space.
    pub(super) inv_w: [f64; 3],
    /// First and last column of the tile in which the triangle may cover samples.
    pub(super) columns: [usize; 2],
    /// First and last row of the tile in which the triangle may cover samples.
    pub(super) rows: [usize; 2],
    /// Whether the triangle is known to cover all samples of the tile.
    pub(super) covers_tile: bool,
}

impl<E: EdgeNumber> Setup<E> {
    /// Returns the inside thresholds of the edges, repeated in all lanes.
    #[inline(always)]
    pub(super) fn inside_thresholds<S: Simd>(&self, simd: S) -> [E::Eight<S>; 3] {
        each!(i in [0, 1, 2] => E::repeat(simd, self.inside[i]))
    }
}

impl Setup {
    /// Sets up a triangle in a tile. Returns `None` if its bounding box contains no sample of the tile, or if it has no
    /// area.
    #[inline(always)]
    pub(super) fn new(slot: Slot, corners: &[SnappedVertex; 3], context: &SetupContext<'_>) -> Option<Self> {
        let SetupContext { rule, scale, lattice, origin } = *context;
        let first = origin.packed;
        let [columns, rows] = each!(axis in [0, 1] => {
            let [a, b, c] = each!(i in [0, 1, 2] => corners[i].position[axis] as f32);
            let [from, to] = lattice.range(axis, a.min(b).min(c), a.max(b).max(c));
            [(from - first[axis]).max(0.0), (to - first[axis]).min((TILE - 1) as f32)]
        });
        if columns[0] > columns[1] || rows[0] > rows[1] {
            return None;
        }
        let (edges, doubled_area) = EdgeFunctions::new(corners, origin.position)?;
        let inside = edges.inside(rule);
        let depths = each!(i in [0, 1, 2] => corners[i].depth);
        let (least, rises) = scale.terms(depths, doubled_area);
        let offset = scale.offset(each!(i in [0, 1, 2] => corners[i].position_px()), depths);
        Some(Self {
            slot,
            edges,
            inside,
            min_depth: least + offset,
            rises,
            max_depth: depths[0].max(depths[1]).max(depths[2]) + offset,
            inv_w: each!(i in [0, 1, 2] => corners[i].inv_w.into()),
            columns: [columns[0] as usize, columns[1] as usize],
            rows: [rows[0] as usize, rows[1] as usize],
            covers_tile: false,
        })
    }
}

/// Returns the inside threshold of one edge per lane: zero if the fill rule assigns the edge to the triangle, otherwise
/// one. This is the vectorised form of [`Inward::owned`].
#[inline(always)]
pub(super) fn inside_thresholds<S: Simd, V: SimdBase<S>>([zero, one]: [V; 2], a: V, b: V, rule: FillRule) -> V {
    let (right, down) = match rule.facts().owner {
        EdgeOwner::Side { right, down } => (right, down),
        EdgeOwner::Both => return zero,
        EdgeOwner::Neither => return one,
    };
    let across = if right > 0 { a.simd_gt(zero) } else { a.simd_lt(zero) };
    let along = if down > 0 { b.simd_gt(zero) } else { b.simd_lt(zero) };
    (across | (a.simd_eq(zero) & along)).select(zero, one)
}
