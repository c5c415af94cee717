//! A triangle as one tile sees it: edge functions and depth from the tile's first sample on.

use super::bins::Key;
use super::geometry::Vertex;
use super::lattice::{Lattice, TILE};
use crate::math::lanes::each;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::raster::numbers::Inward;
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::ScreenVertex;

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Snapped position in grid steps.
    pub(super) position: [f64; 2],
    /// Depth before it is quantised.
    pub(super) depth: f64,
    /// 1/w.
    pub(super) inv_w: f32,
}

impl From<&Vertex> for Corner {
    #[inline(always)]
    fn from(vertex: &Vertex) -> Self {
        let [x, y] = vertex.position();
        Self { position: [x.into(), y.into()], depth: vertex.depth(), inv_w: vertex.inv_w() }
    }
}

impl From<&ScreenVertex> for Corner {
    fn from(vertex: &ScreenVertex) -> Self {
        Self { position: [vertex.x.into(), vertex.y.into()], depth: vertex.depth, inv_w: vertex.inv_w }
    }
}

/// Edge functions of a triangle, each belonging to the corner opposite: e(x, y) = a·x + b·y + c, in units of 1/2¹⁶ px², for
/// (x, y) in grid steps from an origin. All are whole numbers below 2⁵³, so f64 holds them and their sums exactly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edges {
    pub(super) a: [f64; 3],
    pub(super) b: [f64; 3],
    pub(super) c: [f64; 3],
    /// Doubled area, > 0.
    pub(super) doubled_area: f64,
}

impl Edges {
    /// `None` without area.
    #[inline(always)]
    pub(super) fn new(corners: &[Corner; 3], origin: [f64; 2]) -> Option<Self> {
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
        Some(Self { a, b, c, doubled_area: area.abs() })
    }
}

/// A triangle within a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup {
    pub(super) key: Key,
    pub(super) edges: Edges,
    /// The least edge value that is inside: 0 where the fill rule gives the edge to the triangle, else 1.
    pub(super) inside: [f64; 3],
    /// Depth: the least one, and what multiplies edge values (or weights).
    pub(super) least: f64,
    pub(super) rises: [f64; 3],
    /// The greatest depth of a corner.
    pub(super) greatest: f64,
    /// 1/w of the corners, for depths that are linear in space.
    pub(super) inv_w: [f64; 3],
    /// First and last column of samples that may be covered.
    pub(super) columns: [usize; 2],
    /// First and last row.
    pub(super) rows: [usize; 2],
}

impl Setup {
    /// `None` if it has no sample in the tile at `origin`, whose first sample is column `first.0` and row `first.1` of the
    /// packed picture.
    #[inline(always)]
    pub(super) fn new(
        key: Key,
        corners: &[Corner; 3],
        rule: FillRule,
        scale: &DepthScale,
        lattice: &Lattice,
        (origin, first): ([f64; 2], [f32; 2]),
    ) -> Option<Self> {
        let [columns, rows] = each!(axis in [0, 1] => {
            let [a, b, c] = each!(i in [0, 1, 2] => corners[i].position[axis] as f32);
            let [from, to] = lattice.range(axis, a.min(b).min(c), a.max(b).max(c));
            [(from - first[axis]).max(0.0), (to - first[axis]).min((TILE - 1) as f32)]
        });
        if columns[0] > columns[1] || rows[0] > rows[1] {
            return None;
        }
        let edges = Edges::new(corners, origin)?;
        let inside = each!(i in [0, 1, 2] => {
            let owned = Inward::new(edges.a[i], edges.b[i]).owned(rule);
            f64::from(u8::from(!owned))
        });
        let depths = each!(i in [0, 1, 2] => corners[i].depth);
        let (least, rises) = scale.terms(depths, edges.doubled_area);
        Some(Self {
            key,
            edges,
            inside,
            least,
            rises,
            greatest: depths[0].max(depths[1]).max(depths[2]),
            inv_w: each!(i in [0, 1, 2] => corners[i].inv_w.into()),
            columns: [columns[0] as usize, columns[1] as usize],
            rows: [rows[0] as usize, rows[1] as usize],
        })
    }
}
