//! Triangle data that tile shading reads, in the order in which lanes load it.

use super::bins::TriangleKey;
use super::geometry::PackedSurface;
use super::setup::EdgeFunctions;
use crate::math::fixed::SUBPIXELS;
use crate::math::lanes::*;

/// Four numbers that are loaded together.
pub(super) type Quad = [f32; 4];

/// Triangle data for one tile.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct Record {
    pub(super) quads: [Quad; Self::QUADS],
}

impl Record {
    /// Quad of a, b and c of the first edge and the doubled area, as the low 32 bits of integers.
    const FIRST_EDGE: usize = 0;
    /// Quad of a, b and c of the second edge, likewise, and the relative 1/w of the first vertex as a float.
    const SECOND_EDGE: usize = 1;
    /// Quad of the relative 1/w of the other vertices, and the texture coordinates of the first.
    const INV_W_AND_UV: usize = 2;
    /// Quad of the changes of u from the first vertex to each of the others, and of those of v.
    const UV_DELTAS: usize = 3;
    /// Quad of the light at the first vertex, and its changes to each of the others.
    const LIGHT: usize = 4;
    const QUADS: usize = 5;

    /// Returns a, b and c of the first two edges, and the doubled area: low 32 bits.
    #[inline(always)]
    pub(super) fn integer_edges(&self) -> ([i32; 3], [i32; 3], i32) {
        let [a0, b0, c0, area] = self.quads[Self::FIRST_EDGE].map(|bits| bits.to_bits() as i32);
        let [a1, b1, c1, _] = self.quads[Self::SECOND_EDGE].map(|bits| bits.to_bits() as i32);
        ([a0, b0, c0], [a1, b1, c1], area)
    }

    /// Fills the records of eight triangles: two edges (a, b, c) and the doubled area as low 32 bits, and the vertices'
    /// 1/w, light and texture coordinates. `divides_by_w` has a bit for each triangle whose attributes are divided by
    /// w.
    #[inline(always)]
    pub(super) fn fill_eight<S: Simd>(
        simd: S,
        records: &mut [Self; LANES],
        edges: [[i32x8<S>; 3]; 2],
        doubled_area: i32x8<S>,
        corners: [[F32<S>; 4]; 3],
        divides_by_w: u64,
    ) {
        let ([a0, b0, c0], [a1, b1, c1]) =
            (each!(v in [0, 1, 2] => edges[0][v].bitcast()), each!(v in [0, 1, 2] => edges[1][v].bitcast()));
        let inv_w = each!(corner in [0, 1, 2] => corners[corner][0]);
        let [r0, r1, r2] = relative_inv_w(simd, inv_w, divides_by_w);
        let along = each!(value in [1, 2, 3] => {
            let [a, b, c] = each!(corner in [0, 1, 2] => corners[corner][value]);
            [a, b - a, c - a]
        });
        let [[light, dl1, dl2], [u, du1, du2], [v, dv1, dv2]] = along;
        let zero = F32::splat(simd, 0.0);
        let quads = [
            (Self::FIRST_EDGE, [a0, b0, c0, doubled_area.bitcast()]),
            (Self::SECOND_EDGE, [a1, b1, c1, r0]),
            (Self::INV_W_AND_UV, [r1, r2, u, v]),
            (Self::UV_DELTAS, [du1, du2, dv1, dv2]),
            (Self::LIGHT, [light, dl1, dl2, zero]),
        ];
        for (quad, columns) in quads {
            let rows = rows_of_quads(columns);
            for lane in 0..LANES {
                rows[lane].store_array(&mut records[lane].quads[quad]);
            }
        }
    }
}

/// Returns [`crate::pipeline::viewport::relative_inv_w`] of eight triangles; 1 for triangles without a bit.
#[inline(always)]
fn relative_inv_w<S: Simd>(simd: S, inv_w: [F32<S>; 3], divides_by_w: u64) -> [F32<S>; 3] {
    let largest = inv_w[0].max(inv_w[1]).max(inv_w[2]);
    let divides = mask32x8::from_bitmask(simd, divides_by_w);
    each!(i in [0, 1, 2] => divides.select((inv_w[i] / largest).max(f32::MIN_POSITIVE), F32::splat(simd, 1.0)))
}

/// Further triangle data that shading reads, normals and colours, in frames with a draw that needs it.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct SurfaceRecord {
    pub(super) quads: [Quad; Self::QUADS],
}

impl SurfaceRecord {
    /// First of three quads: each has a component of the normal at the first vertex, and its changes to each of the
    /// others.
    const NORMAL: usize = 0;
    /// First of three quads: each has a channel of the colour, likewise.
    const COLOR: usize = 3;
    const QUADS: usize = 6;

    /// Fills the normals or the colours of the records of eight triangles.
    #[inline(always)]
    pub(super) fn fill_eight<S: Simd>(
        simd: S,
        records: &mut [Self; LANES],
        triangles: &[[&PackedSurface; 3]; LANES],
        part: SurfacePart,
    ) {
        let (first_number, first_quad) = match part {
            SurfacePart::Normal => (PackedSurface::NORMAL[0], Self::NORMAL),
            SurfacePart::Color => (PackedSurface::COLOR[0], Self::COLOR),
        };
        let corners = each!(corner in [0, 1, 2] => transpose_quads(each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
            f32x4::from_slice(simd, &triangles[lane][corner].numbers[first_number..][..LANES / 2])
        })));
        let [first, second, third] = corners;
        for (axis, ((a, b), c)) in first.into_iter().zip(second).zip(third).take(3).enumerate() {
            let rows = rows_of_quads([a, b - a, c - a, F32::splat(simd, 0.0)]);
            for lane in 0..LANES {
                rows[lane].store_array(&mut records[lane].quads[first_quad + axis]);
            }
        }
    }
}

/// Part of a [`SurfaceRecord`].
#[derive(Clone, Copy, Debug)]
pub(super) enum SurfacePart {
    Normal,
    Color,
}

/// One triangle for which samples are shaded.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadedTriangle<'a> {
    pub(super) one: One<'a>,
    pub(super) key: TriangleKey,
    /// Index in the list of draws.
    pub(super) draw: usize,
    /// Edges as doubles, if edge values exceed 32 bits or the samples are not shaded on lanes.
    pub(super) edges: Option<&'a EdgeFunctions>,
}

/// An attribute at the first vertex, and its changes to each of the others.
#[derive(Clone, Copy)]
pub(super) struct Attribute<S: Simd>(f32x16<S>, f32x16<S>, f32x16<S>);

impl<S: Simd> Attribute<S> {
    /// Returns the attribute at samples with these weights of the second and the third vertex.
    #[inline(always)]
    pub(super) fn at(self, weights: [f32x16<S>; 2]) -> f32x16<S> {
        self.0 + self.1 * weights[0] + self.2 * weights[1]
    }

    /// Returns the change of the attribute for a change of the weights.
    #[inline(always)]
    pub(super) fn change(self, weights: [f32x16<S>; 2]) -> f32x16<S> {
        self.1 * weights[0] + self.2 * weights[1]
    }
}

/// Source of the triangle data for 16 samples.
pub(super) trait TriangleSource: Copy {
    /// Step between the samples whose texels are prefetched, from the first sample on, as texels may lie far apart.
    /// `None` if prefetches take longer than the cache misses that they avoid.
    const PREFETCH_STEP: Option<usize>;

    /// Returns a quad of the [`Record`] of each sample's triangle.
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4];

    /// Returns a quad of the [`SurfaceRecord`] of each sample's triangle.
    fn surface_quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4];

    /// Returns a, b and c of the first two edges and the doubled areas, for triangles whose edge values fit into 32
    /// bits.
    #[inline(always)]
    fn integer_edges<S: Simd>(self, simd: S) -> ([[i32x16<S>; 3]; 2], i32x16<S>) {
        let (first, second) = (self.quad(simd, Record::FIRST_EDGE), self.quad(simd, Record::SECOND_EDGE));
        let edges = each!(quad in [first, second] => each!(v in [0, 1, 2] => quad[v].bitcast::<i32x16<S>>()));
        (edges, first[3].bitcast::<i32x16<S>>())
    }

    /// Returns the edge values of triangles whose edge values fit into 32 bits, at offsets from the tile's first
    /// sample, in grid steps. Valid only where a triangle covers its sample.
    #[inline(always)]
    fn edge_values<S: Simd>(self, simd: S, [x, y]: [i32x16<S>; 2]) -> [i32x16<S>; 3] {
        let (edges, area) = self.integer_edges(simd);
        let [first, second] = each!([a, b, c] in [edges[0], edges[1]] => a * x + b * y + c);
        [first, second, area - first - second]
    }

    /// Returns 1/w of the vertices relative to the largest.
    #[inline(always)]
    fn relative_inv_w<S: Simd>(self, simd: S) -> [f32x16<S>; 3] {
        let [_, _, _, r0] = self.quad(simd, Record::SECOND_EDGE);
        let [r1, r2, ..] = self.quad(simd, Record::INV_W_AND_UV);
        [r0, r1, r2]
    }

    /// Returns the change of the edge values per pixel to the right, and per pixel down.
    #[inline(always)]
    fn edge_slopes<S: Simd>(self, simd: S) -> [[f32x16<S>; 3]; 2] {
        let (first, second) = (self.quad(simd, Record::FIRST_EDGE), self.quad(simd, Record::SECOND_EDGE));
        each!(axis in [0, 1] => {
            let [first, second] = each!(quad in [first, second] => quad[axis].bitcast::<i32x16<S>>());
            let third = i32x16::splat(simd, 0) - first - second;
            each!(slope in [first, second, third] => slope.to_float::<f32x16<S>>() * SUBPIXELS as f32)
        })
    }

    /// Returns the texture coordinates, v down.
    #[inline(always)]
    fn uv<S: Simd>(self, simd: S) -> [Attribute<S>; 2] {
        let [_, _, u, v] = self.quad(simd, Record::INV_W_AND_UV);
        let [du1, du2, dv1, dv2] = self.quad(simd, Record::UV_DELTAS);
        [Attribute(u, du1, du2), Attribute(v, dv1, dv2)]
    }

    /// Returns the light of Gouraud shading.
    #[inline(always)]
    fn light<S: Simd>(self, simd: S) -> Attribute<S> {
        let [base, first, second, _] = self.quad(simd, Record::LIGHT);
        Attribute(base, first, second)
    }

    /// Returns the world-space normal, by component.
    #[inline(always)]
    fn normal<S: Simd>(self, simd: S) -> [Attribute<S>; 3] {
        each!(axis in [0, 1, 2] => self.surface_attribute(simd, SurfaceRecord::NORMAL + axis))
    }

    /// Returns the vertex colour, by channel.
    #[inline(always)]
    fn color<S: Simd>(self, simd: S) -> [Attribute<S>; 3] {
        each!(channel in [0, 1, 2] => self.surface_attribute(simd, SurfaceRecord::COLOR + channel))
    }

    /// Returns the attribute in a quad of the [`SurfaceRecord`].
    #[inline(always)]
    fn surface_attribute<S: Simd>(self, simd: S, quad: usize) -> Attribute<S> {
        let [base, first, second, _] = self.surface_quad(simd, quad);
        Attribute(base, first, second)
    }
}

/// Source of samples that all belong to one triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct One<'a> {
    pub(super) record: &'a Record,
    surface: &'a SurfaceRecord,
}

impl TriangleSource for One<'_> {
    const PREFETCH_STEP: Option<usize> = None;

    #[inline(always)]
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4] {
        each!(i in [0, 1, 2, 3] => f32x16::splat(simd, self.record.quads[quad][i]))
    }

    #[inline(always)]
    fn surface_quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4] {
        each!(i in [0, 1, 2, 3] => f32x16::splat(simd, self.surface.quads[quad][i]))
    }
}

/// Source of samples that each belong to a triangle of their own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Many<'a> {
    records: [&'a Record; WIDE],
    bin: &'a TileBin,
    slots: &'a [u32; WIDE],
}

impl TriangleSource for Many<'_> {
    const PREFETCH_STEP: Option<usize> = Some(1);

    #[inline(always)]
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4] {
        transpose_wide(each!(i in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => {
            f32x4::load_array_ref(simd, &self.records[i].quads[quad])
        }))
    }

    #[inline(always)]
    fn surface_quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4] {
        transpose_wide(each!(i in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => {
            f32x4::load_array_ref(simd, &self.bin.surface(Slot(self.slots[i])).quads[quad])
        }))
    }
}

/// A triangle in a tile's bin.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinEntry {
    pub(super) key: TriangleKey,
    /// Index in the list of draws.
    pub(super) draw: u32,
}

/// Index of an [`BinEntry`] of a tile, with a bit for edge values that exceed 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(pub(super) u32);

impl Slot {
    /// No triangle: the background.
    pub(super) const NONE: Self = Self(u32::MAX);
    /// Bit of triangles whose edge values exceed 32 bits.
    pub(super) const LARGE: u32 = 1 << 31;

    #[inline(always)]
    pub(super) fn new(place: usize, is_large: bool) -> Self {
        Self(place as u32 | if is_large { Self::LARGE } else { 0 })
    }

    /// Returns the index in the tile's bin.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        (self.0 & !Self::LARGE) as usize
    }

    /// Whether edge values exceed 32 bits.
    #[inline(always)]
    pub(super) fn is_large(self) -> bool {
        self.0 & Self::LARGE != 0
    }
}

/// A tile's bin: its triangles in order, with the data that shading reads.
#[derive(Clone, Debug, Default)]
pub(super) struct TileBin {
    list: Vec<BinEntry>,
    /// Records, one per triangle, and some unused ones.
    records: Vec<Record>,
    /// Surface records, likewise, in frames that read them.
    surfaces: Vec<SurfaceRecord>,
}

impl TileBin {
    /// Removes all triangles.
    pub(super) fn clear(&mut self) {
        self.list.clear();
    }

    /// Returns the number of bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.list.capacity() * size_of::<BinEntry>()
            + self.records.capacity() * size_of::<Record>()
            + self.surfaces.capacity() * size_of::<SurfaceRecord>()
    }

    /// Appends triangles of one draw.
    #[inline(always)]
    pub(super) fn extend(&mut self, keys: &[TriangleKey], draw: usize) {
        self.list.extend(keys.iter().map(|key| BinEntry { key: *key, draw: draw as u32 }));
    }

    /// Returns the record of a triangle.
    #[inline(always)]
    pub(super) fn record(&self, slot: Slot) -> &Record {
        &self.records[slot.place()]
    }

    /// Returns the surface record of a triangle; zeros in frames that read none.
    #[inline(always)]
    pub(super) fn surface(&self, slot: Slot) -> &SurfaceRecord {
        self.surfaces.get(slot.place()).unwrap_or(const { &SurfaceRecord { quads: [[0.0; 4]; SurfaceRecord::QUADS] } })
    }

    /// Returns the number of triangles.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Returns a triangle of the bin.
    #[inline(always)]
    pub(super) fn get(&self, slot: Slot) -> BinEntry {
        self.list[slot.place()]
    }

    /// Returns up to `most` triangles from `first` on.
    #[inline(always)]
    pub(super) fn group(&self, first: usize, most: usize) -> &[BinEntry] {
        &self.list[first..(first + most).min(self.list.len())]
    }

    /// Returns the records of eight triangles from `first` on, to be filled.
    #[inline(always)]
    pub(super) fn eight_records(&mut self, first: usize) -> Option<&mut [Record; LANES]> {
        eight(&mut self.records, first)
    }

    /// Returns the surface records of eight triangles from `first` on, to be filled.
    #[inline(always)]
    pub(super) fn eight_surfaces(&mut self, first: usize) -> Option<&mut [SurfaceRecord; LANES]> {
        eight(&mut self.surfaces, first)
    }

    /// Returns a triangle to shade samples for, without edges as doubles.
    #[inline(always)]
    pub(super) fn subject(&self, slot: Slot) -> ShadedTriangle<'_> {
        let BinEntry { key, draw } = self.get(slot);
        ShadedTriangle { one: self.one(slot), key, draw: draw as usize, edges: None }
    }

    /// Returns the source of samples of one triangle.
    #[inline(always)]
    pub(super) fn one(&self, slot: Slot) -> One<'_> {
        One { record: self.record(slot), surface: self.surface(slot) }
    }

    /// Returns the source of samples of sixteen triangles.
    #[inline(always)]
    pub(super) fn many<'a>(&'a self, slots: &'a [u32; WIDE]) -> Many<'a> {
        let records = each!(i in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => self.record(Slot(slots[i])));
        Many { records, bin: self, slots }
    }
}

/// Returns eight items from `first` on of a list that grows as needed.
#[inline(always)]
fn eight<T: Clone + Default>(list: &mut Vec<T>, first: usize) -> Option<&mut [T; LANES]> {
    if list.len() < first + LANES {
        list.resize(first + LANES, T::default());
    }
    list[first..].first_chunk_mut()
}
