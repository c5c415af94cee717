//! A triangle as one tile sees it: edge functions and depth from the tile's first sample on.

use super::geometry::Vertex;
use super::lattice::{Lattice, TILE};
use super::record::{Record, Slot};
use crate::math::lanes::*;
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

/// Position of the first sample of a tile, in grid steps, and its column and row in the packed picture.
pub(super) type Origin = ([f64; 2], [f32; 2]);

/// Edge functions of a triangle, each belonging to the corner opposite: e(x, y) = a·x + b·y + c, in units of 1/2¹⁶ px², for
/// (x, y) in grid steps from an origin. All are whole numbers below 2⁵³, so f64 holds them and their sums exactly.
#[derive(Clone, Copy, Debug, Default)]
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

    /// Values at an offset from the origin, in grid steps.
    pub(super) fn at(&self, place: [i32; 2]) -> [f64; 3] {
        let [x, y] = place.map(f64::from);
        each!(i in [0, 1, 2] => self.a[i] * x + self.b[i] * y + self.c[i])
    }

    /// The first of some places of a pixel that the triangle covers, of which there must be one. Places are given by their offsets
    /// from the pixel's centre, which is given from the origin on, as is what is found.
    pub(super) fn first_covered(&self, [x, y]: [i32; 2], offsets: &[[i32; 2]], rule: FillRule) -> [i32; 2] {
        let inside = self.inside(rule);
        let covers = |place: &[i32; 2]| self.at(*place).iter().zip(inside).all(|(value, least)| *value >= least);
        let moved = |[right, down]: &[i32; 2]| [x + right, y + down];
        offsets.iter().map(moved).find(covers).unwrap_or([x, y])
    }

    /// The least value of each that is inside: 0 where the fill rule gives the edge to the triangle, else 1.
    #[inline(always)]
    pub(super) fn inside(&self, rule: FillRule) -> [f64; 3] {
        each!(i in [0, 1, 2] => {
            let owned = Inward::new(self.a[i], self.b[i]).owned(rule);
            f64::from(u8::from(!owned))
        })
    }
}

/// A triangle within a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup {
    pub(super) slot: Slot,
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
        slot: Slot,
        corners: &[Corner; 3],
        rule: FillRule,
        scale: &DepthScale,
        lattice: &Lattice,
        (origin, first): Origin,
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
        let inside = edges.inside(rule);
        let depths = each!(i in [0, 1, 2] => corners[i].depth);
        let (least, rises) = scale.terms(depths, edges.doubled_area);
        Some(Self {
            slot,
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

/// Eight triangles that are set up together.
#[derive(Clone, Debug, Default)]
#[repr(align(32))]
pub(super) struct Batch {
    a: [[f64; LANES]; 3],
    b: [[f64; LANES]; 3],
    c: [[f64; LANES]; 3],
    doubled_area: [f64; LANES],
    inside: [[f64; LANES]; 3],
    least: [f64; LANES],
    greatest: [f64; LANES],
    rises: [[f64; LANES]; 3],
    inv_w: [[f64; LANES]; 3],
    columns: [[i32; LANES]; 2],
    rows: [[i32; LANES]; 2],
    /// The least and the greatest coordinate along each axis, in grid steps; only known if pixels have several samples.
    boxes: [[[f32; LANES]; 2]; 2],
}

impl Batch {
    /// Sets up eight triangles by their corners as [`Setup::new`] does, fills their records, and says by bits which of them
    /// may have a sample in the tile, and which of those have edge values of more than 32 bits at samples of pixels that they
    /// cover another sample of.
    #[inline(never)]
    #[expect(
        clippy::too_many_arguments,
        reason = "eight triangles, their records, and what is the same for all triangles"
    )]
    pub(super) fn set_up<S: Simd>(
        &mut self,
        simd: S,
        triangles: &[[&Vertex; 3]; LANES],
        (records, divides_by_w): (&mut [Record; LANES], u64),
        rule: FillRule,
        scale: &DepthScale,
        lattice: &Lattice,
        (origin, first): Origin,
    ) -> (u64, u64) {
        simd.vectorize(
            #[inline(always)]
            || {
                let vertices = each!(corner in [0, 1, 2] => {
                    each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => triangles[lane][corner])
                });
                let corners = each!(corner in [0, 1, 2] => Vertex::positions_and_depths(simd, &vertices[corner]));
                let boxes = each!(axis in [0, 1] => {
                    let [a, b, c] = each!(i in [0, 1, 2] => corners[i].0[axis]);
                    [a.min(b).min(c), a.max(b).max(c)]
                });
                let mut alive = ranges_lanes(simd, boxes, lattice, first, [&mut self.columns, &mut self.rows]);
                let p =
                    each!(i in [0, 1, 2] => each!(axis in [0, 1] => widen(simd, corners[i].0[axis]) - origin[axis]));
                let area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
                alive &= area.simd_ne(0.0).to_bitmask();
                if alive == 0 {
                    return (0, 0);
                }
                let turned = area.simd_lt(0.0);
                let doubled_area = area.abs();
                doubled_area.store_array(&mut self.doubled_area);
                let zero_and_one = [F64::splat(simd, 0.0), F64::splat(simd, 1.0)];
                for (i, (from, to)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
                    let (a, b) = (p[from][1] - p[to][1], p[to][0] - p[from][0]);
                    let (a, b) = (turned.select(-a, a), turned.select(-b, b));
                    a.store_array(&mut self.a[i]);
                    b.store_array(&mut self.b[i]);
                    (-(a * p[from][0] + b * p[from][1])).store_array(&mut self.c[i]);
                    least_inside(zero_and_one, a, b, rule).store_array(&mut self.inside[i]);
                }
                let depths = each!(i in [0, 1, 2] => corners[i].1);
                let least = depths[0].min(depths[1]).min(depths[2]);
                least.store_array(&mut self.least);
                depths[0].max(depths[1]).max(depths[2]).store_array(&mut self.greatest);
                for i in 0..3 {
                    let rise = depths[i] - least;
                    let rise = if scale.is_linear_in_space() { rise } else { rise / doubled_area };
                    rise.store_array(&mut self.rises[i]);
                    if scale.is_linear_in_space() {
                        for (out, corners) in self.inv_w[i].iter_mut().zip(triangles) {
                            *out = corners[i].inv_w().into();
                        }
                    }
                }
                let edges = integer_edges(simd, each!(i in [0, 1, 2] => corners[i].0), origin, turned.to_bitmask());
                let attributes = each!(corner in [0, 1, 2] => Vertex::attributes(simd, &vertices[corner]));
                let (first_two, doubled_area_i32) = edges;
                Record::fill_eight(simd, records, first_two, doubled_area_i32, attributes, divides_by_w);
                let mut greatest_value = doubled_area;
                if lattice.extent() > 0.0 {
                    for i in 0..3 {
                        let [a, b] = each!(of in [&self.a, &self.b] => F64::load_array_ref(simd, &of[i]).abs());
                        greatest_value = greatest_value.max(doubled_area + (a + b) * lattice.extent());
                    }
                    self.boxes = each!(axis in [0, 1] => each!(end in [0, 1] => boxes[axis][end].to_array()));
                }
                (alive, alive & greatest_value.simd_gt(f64::from(i32::MAX)).to_bitmask())
            },
        )
    }

    /// The same triangles for the samples of another lattice, that are moved from those of the first one, and bits of those
    /// which may have one in the tile. What differs is where edges and boxes stand.
    #[inline(always)]
    pub(super) fn moved<S: Simd>(&self, simd: S, lattice: &Lattice, first: [f32; 2]) -> (u64, MovedBatch<'_>) {
        let boxes = each!(axis in [0, 1] => each!(end in [0, 1] => F32::load_array_ref(simd, &self.boxes[axis][end])));
        let [mut columns, mut rows] = [[[0; LANES]; 2]; 2];
        let alive = ranges_lanes(simd, boxes, lattice, first, [&mut columns, &mut rows]);
        let [right, down] = lattice.offset().map(f64::from);
        let c = each!(i in [0, 1, 2] => {
            let [a, b, c] = each!(of in [&self.a, &self.b, &self.c] => F64::load_array_ref(simd, &of[i]));
            (a * right + b * down + c).to_array()
        });
        (alive, MovedBatch { batch: self, c, columns, rows })
    }

    /// One of the triangles.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize, slot: Slot) -> Setup {
        let of = |values: &[[f64; LANES]; 3]| [values[0][lane], values[1][lane], values[2][lane]];
        Setup {
            slot,
            edges: Edges { a: of(&self.a), b: of(&self.b), c: of(&self.c), doubled_area: self.doubled_area[lane] },
            inside: of(&self.inside),
            least: self.least[lane],
            rises: of(&self.rises),
            greatest: self.greatest[lane],
            inv_w: of(&self.inv_w),
            columns: range_of(&self.columns, lane),
            rows: range_of(&self.rows, lane),
        }
    }
}

/// The triangles of a batch as another sample sees them.
#[derive(Debug)]
#[repr(align(32))]
pub(super) struct MovedBatch<'a> {
    batch: &'a Batch,
    c: [[f64; LANES]; 3],
    columns: [[i32; LANES]; 2],
    rows: [[i32; LANES]; 2],
}

impl MovedBatch<'_> {
    /// One of the triangles.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize, slot: Slot) -> Setup {
        let mut triangle = self.batch.triangle(lane, slot);
        triangle.edges.c = [self.c[0][lane], self.c[1][lane], self.c[2][lane]];
        triangle.columns = range_of(&self.columns, lane);
        triangle.rows = range_of(&self.rows, lane);
        triangle
    }
}

/// First and last column or row of one of eight triangles.
#[inline(always)]
fn range_of(ranges: &[[i32; LANES]; 2], lane: usize) -> [usize; 2] {
    [ranges[0][lane] as usize, ranges[1][lane] as usize]
}

/// Finds the first and last columns and rows of the samples in a tile that eight triangles may cover, by the triangles' boxes in
/// grid steps. Gives bits of those that have any.
#[inline(always)]
fn ranges_lanes<S: Simd>(
    simd: S,
    boxes: [[F32<S>; 2]; 2],
    lattice: &Lattice,
    first: [f32; 2],
    ranges: [&mut [[i32; LANES]; 2]; 2],
) -> u64 {
    let mut alive = u64::MAX;
    for (axis, out) in ranges.into_iter().enumerate() {
        let [from, to] = lattice.range_lanes(simd, axis, boxes[axis][0], boxes[axis][1]);
        let (from, to) = ((from - first[axis]).max(0.0), (to - first[axis]).min((TILE - 1) as f32));
        alive &= from.simd_le(to).to_bitmask();
        from.to_int::<i32x8<S>>().store_array(&mut out[0]);
        to.to_int::<i32x8<S>>().store_array(&mut out[1]);
    }
    alive
}

/// a, b and c of the first two edges of eight triangles, and their doubled areas, by positions in grid steps: low 32 bits.
#[inline(always)]
fn integer_edges<S: Simd>(
    simd: S,
    corners: [[F32<S>; 2]; 3],
    origin: [f64; 2],
    turned: u64,
) -> ([[i32x8<S>; 3]; 2], i32x8<S>) {
    let p =
        each!(i in [0, 1, 2] => each!(axis in [0, 1] => corners[i][axis].to_int::<i32x8<S>>() - origin[axis] as i32));
    let turned = mask32x8::from_bitmask(simd, turned);
    let edges = each!((from, to) in [(1, 2), (2, 0)] => {
        let (from, to) = (p[from], p[to]);
        let (a, b) = (from[1] - to[1], to[0] - from[0]);
        let (a, b) = (turned.select(-a, a), turned.select(-b, b));
        [a, b, -(a * from[0] + b * from[1])]
    });
    let area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
    (edges, turned.select(-area, area))
}

/// Zero where the rule gives the edge to the triangle, else one: [`Inward::owned`] for as many edges as there are lanes.
#[inline(always)]
pub(super) fn least_inside<S: Simd, V: SimdBase<S>>([zero, one]: [V; 2], a: V, b: V, rule: FillRule) -> V {
    let upright = a.simd_eq(zero);
    let owned = match rule {
        FillRule::TopLeft => a.simd_gt(zero) | (upright & b.simd_gt(zero)),
        FillRule::TopRight => a.simd_lt(zero) | (upright & b.simd_gt(zero)),
        FillRule::BottomLeft => a.simd_gt(zero) | (upright & b.simd_lt(zero)),
        FillRule::BottomRight => a.simd_lt(zero) | (upright & b.simd_lt(zero)),
        FillRule::Inclusive => return zero,
        FillRule::Exclusive => return one,
    };
    owned.select(zero, one)
}
