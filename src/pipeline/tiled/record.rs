//! What the tiles' shading reads of a triangle, in the order in which lanes load it.

use super::bins::Key;
use super::geometry::Surface;
use super::setup::Edges;
use crate::math::fixed::SUBPIXELS;
use crate::math::lanes::*;

/// Four numbers that are loaded together.
pub(super) type Quad = [f32; 4];

/// A triangle as one tile sees it.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct Record {
    pub(super) quads: [Quad; Self::QUADS],
}

impl Record {
    /// a, b and c of the first edge and the doubled area, as the low 32 bits of integers.
    const FIRST_EDGE: usize = 0;
    /// The same of the second edge, and the relative 1/w of the first corner as a float.
    const SECOND_EDGE: usize = 1;
    /// The relative 1/w of the other corners, and the texture coordinates of the first.
    const INV_W_AND_UV: usize = 2;
    /// What u changes by from the first corner to each of the others, and the same of v.
    const UV_DELTAS: usize = 3;
    /// Light at the first corner, and what it changes by to each of the others.
    const LIGHT: usize = 4;
    const QUADS: usize = 5;

    /// a, b and c of the first two edges, and the doubled area: low 32 bits.
    #[inline(always)]
    pub(super) fn integer_edges(&self) -> ([i32; 3], [i32; 3], i32) {
        let [a0, b0, c0, area] = self.quads[Self::FIRST_EDGE].map(|bits| bits.to_bits() as i32);
        let [a1, b1, c1, _] = self.quads[Self::SECOND_EDGE].map(|bits| bits.to_bits() as i32);
        ([a0, b0, c0], [a1, b1, c1], area)
    }

    /// Fills the records of eight triangles: two edges (a, b, c) and the doubled area as low 32 bits, and the corners' 1/w,
    /// light and texture coordinates. A bit for each triangle says whether its attributes are divided by w.
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

/// As [`crate::pipeline::viewport::relative_inv_w`]; 1 where there is no bit.
#[inline(always)]
fn relative_inv_w<S: Simd>(simd: S, inv_w: [F32<S>; 3], divides_by_w: u64) -> [F32<S>; 3] {
    let largest = inv_w[0].max(inv_w[1]).max(inv_w[2]);
    let divides = mask32x8::from_bitmask(simd, divides_by_w);
    each!(i in [0, 1, 2] => divides.select((inv_w[i] / largest).max(f32::MIN_POSITIVE), F32::splat(simd, 1.0)))
}

/// What shading reads of a triangle's corners besides, where a draw of the frame asks for it.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct SurfaceRecord {
    pub(super) quads: [Quad; Self::QUADS],
}

impl SurfaceRecord {
    /// The components of the normal at the first corner, and what they change by to each of the others.
    const NORMAL: usize = 0;
    /// The same of the channels of the colour.
    const COLOR: usize = 3;
    const QUADS: usize = 6;

    /// Fills the normals or the colours of the records of eight triangles.
    #[inline(always)]
    pub(super) fn fill_eight<S: Simd>(
        simd: S,
        records: &mut [Self; LANES],
        triangles: &[[&Surface; 3]; LANES],
        part: Part,
    ) {
        let (first_number, first_quad) = match part {
            Part::Normal => (Surface::NORMAL[0], Self::NORMAL),
            Part::Color => (Surface::COLOR[0], Self::COLOR),
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

/// What a [`SurfaceRecord`] is made of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    Normal,
    Color,
}

/// One triangle that samples are shaded for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subject<'a> {
    pub(super) one: One<'a>,
    pub(super) key: Key,
    /// Position in the list of draws.
    pub(super) draw: usize,
    /// Its edges, if 32 bits don't hold their values, or its samples are not shaded on lanes.
    pub(super) edges: Option<&'a Edges>,
}

/// An attribute at the first corner, and what it changes by from there to each of the others.
#[derive(Clone, Copy)]
pub(super) struct Attribute<S: Simd>(f32x16<S>, f32x16<S>, f32x16<S>);

impl<S: Simd> Attribute<S> {
    /// At samples with these weights of the second and the third corner.
    #[inline(always)]
    pub(super) fn at(self, weights: [f32x16<S>; 2]) -> f32x16<S> {
        self.0 + self.1 * weights[0] + self.2 * weights[1]
    }

    /// What it changes by where the weights change by these.
    #[inline(always)]
    pub(super) fn change(self, weights: [f32x16<S>; 2]) -> f32x16<S> {
        self.1 * weights[0] + self.2 * weights[1]
    }
}

/// Where sixteen samples have what is read of their triangles from.
pub(super) trait Source: Copy {
    /// Of the first sample, and of each that comes so many after it, texels are asked for before they are read, as they may lie far
    /// apart. None if that takes longer than to wait for them.
    const PREFETCH_STEP: Option<usize>;

    /// Four numbers of the [`Record`] of each sample's triangle.
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4];

    /// Four numbers of the [`SurfaceRecord`] of each sample's triangle.
    fn surface_quad<S: Simd>(self, simd: S, quad: usize) -> [f32x16<S>; 4];

    /// a, b and c of the first two edges of triangles whose values 32 bits hold, and the doubled areas.
    #[inline(always)]
    fn integer_edges<S: Simd>(self, simd: S) -> ([[i32x16<S>; 3]; 2], i32x16<S>) {
        let (first, second) = (self.quad(simd, Record::FIRST_EDGE), self.quad(simd, Record::SECOND_EDGE));
        let edges = each!(quad in [first, second] => each!(v in [0, 1, 2] => quad[v].bitcast::<i32x16<S>>()));
        (edges, first[3].bitcast::<i32x16<S>>())
    }

    /// Edge values of such triangles at offsets from the tile's first sample. They are right where a triangle covers its sample;
    /// elsewhere they may be any.
    #[inline(always)]
    fn edge_values<S: Simd>(self, simd: S, [x, y]: [i32x16<S>; 2]) -> [i32x16<S>; 3] {
        let (edges, area) = self.integer_edges(simd);
        let [first, second] = each!([a, b, c] in [edges[0], edges[1]] => a * x + b * y + c);
        [first, second, area - first - second]
    }

    /// 1/w of the corners relative to the largest.
    #[inline(always)]
    fn relative_inv_w<S: Simd>(self, simd: S) -> [f32x16<S>; 3] {
        let [_, _, _, r0] = self.quad(simd, Record::SECOND_EDGE);
        let [r1, r2, ..] = self.quad(simd, Record::INV_W_AND_UV);
        [r0, r1, r2]
    }

    /// What edge values change by in a pixel to the right, and in one downwards.
    #[inline(always)]
    fn edge_slopes<S: Simd>(self, simd: S) -> [[f32x16<S>; 3]; 2] {
        let (first, second) = (self.quad(simd, Record::FIRST_EDGE), self.quad(simd, Record::SECOND_EDGE));
        each!(axis in [0, 1] => {
            let [first, second] = each!(quad in [first, second] => quad[axis].bitcast::<i32x16<S>>());
            let third = i32x16::splat(simd, 0) - first - second;
            each!(slope in [first, second, third] => slope.to_float::<f32x16<S>>() * SUBPIXELS as f32)
        })
    }

    /// Texture coordinates.
    #[inline(always)]
    fn uv<S: Simd>(self, simd: S) -> [Attribute<S>; 2] {
        let [_, _, u, v] = self.quad(simd, Record::INV_W_AND_UV);
        let [du1, du2, dv1, dv2] = self.quad(simd, Record::UV_DELTAS);
        [Attribute(u, du1, du2), Attribute(v, dv1, dv2)]
    }

    /// Light.
    #[inline(always)]
    fn light<S: Simd>(self, simd: S) -> Attribute<S> {
        let [base, first, second, _] = self.quad(simd, Record::LIGHT);
        Attribute(base, first, second)
    }

    /// Normal.
    #[inline(always)]
    fn normal<S: Simd>(self, simd: S) -> [Attribute<S>; 3] {
        each!(axis in [0, 1, 2] => self.surface_attribute(simd, SurfaceRecord::NORMAL + axis))
    }

    /// Colour.
    #[inline(always)]
    fn color<S: Simd>(self, simd: S) -> [Attribute<S>; 3] {
        each!(channel in [0, 1, 2] => self.surface_attribute(simd, SurfaceRecord::COLOR + channel))
    }

    /// An attribute of the surface.
    #[inline(always)]
    fn surface_attribute<S: Simd>(self, simd: S, quad: usize) -> Attribute<S> {
        let [base, first, second, _] = self.surface_quad(simd, quad);
        Attribute(base, first, second)
    }
}

/// All samples are of one triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct One<'a> {
    pub(super) record: &'a Record,
    surface: &'a SurfaceRecord,
}

impl Source for One<'_> {
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

/// Each sample is of a triangle of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Many<'a> {
    records: [&'a Record; WIDE],
    entrants: &'a Entrants,
    slots: &'a [u32; WIDE],
}

impl Source for Many<'_> {
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
            f32x4::load_array_ref(simd, &self.entrants.surface(Slot(self.slots[i])).quads[quad])
        }))
    }
}

/// A triangle that a tile was asked to draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entrant {
    pub(super) key: Key,
    /// Position in the list of draws.
    pub(super) draw: u32,
}

/// Names an [`Entrant`] of a tile, and tells whether 32 bits hold its edge values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(pub(super) u32);

impl Slot {
    /// No triangle: the background.
    pub(super) const NONE: Self = Self(u32::MAX);
    /// The bit of triangles with edge values of more than 32 bits.
    pub(super) const LARGE: u32 = 1 << 31;

    #[inline(always)]
    pub(super) fn new(place: usize, is_large: bool) -> Self {
        Self(place as u32 | if is_large { Self::LARGE } else { 0 })
    }

    /// Position in the list of entrants.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        (self.0 & !Self::LARGE) as usize
    }

    /// Whether edge values have more than 32 bits.
    #[inline(always)]
    pub(super) fn is_large(self) -> bool {
        self.0 & Self::LARGE != 0
    }
}

/// The triangles that a tile was asked to draw, in their order, with what shading reads of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Entrants {
    list: Vec<Entrant>,
    /// One for each triangle, and some that are not in use.
    records: Vec<Record>,
    /// The same, in frames that read them.
    surfaces: Vec<SurfaceRecord>,
}

impl Entrants {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.list.clear();
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.list.capacity() * size_of::<Entrant>()
            + self.records.capacity() * size_of::<Record>()
            + self.surfaces.capacity() * size_of::<SurfaceRecord>()
    }

    /// Adds some of one draw.
    #[inline(always)]
    pub(super) fn extend(&mut self, keys: &[Key], draw: usize) {
        self.list.extend(keys.iter().map(|key| Entrant { key: *key, draw: draw as u32 }));
    }

    /// The record of one triangle.
    #[inline(always)]
    pub(super) fn record(&self, slot: Slot) -> &Record {
        &self.records[slot.place()]
    }

    /// The record of one triangle's surface; of zeros in frames that read none.
    #[inline(always)]
    pub(super) fn surface(&self, slot: Slot) -> &SurfaceRecord {
        self.surfaces.get(slot.place()).unwrap_or(const { &SurfaceRecord { quads: [[0.0; 4]; SurfaceRecord::QUADS] } })
    }

    /// How many there are; the next one's slot.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// One of them.
    #[inline(always)]
    pub(super) fn get(&self, slot: Slot) -> Entrant {
        self.list[slot.place()]
    }

    /// Some of them, from `first` on.
    #[inline(always)]
    pub(super) fn group(&self, first: usize, most: usize) -> &[Entrant] {
        &self.list[first..(first + most).min(self.list.len())]
    }

    /// The records of eight triangles from `first` on, to be filled.
    #[inline(always)]
    pub(super) fn eight_records(&mut self, first: usize) -> Option<&mut [Record; LANES]> {
        eight(&mut self.records, first)
    }

    /// The same of what else is read.
    #[inline(always)]
    pub(super) fn eight_surfaces(&mut self, first: usize) -> Option<&mut [SurfaceRecord; LANES]> {
        eight(&mut self.surfaces, first)
    }

    /// A triangle whose samples are found by its edges elsewhere.
    #[inline(always)]
    pub(super) fn subject(&self, slot: Slot) -> Subject<'_> {
        let Entrant { key, draw } = self.get(slot);
        Subject { one: self.one(slot), key, draw: draw as usize, edges: None }
    }

    /// What is read of one triangle.
    #[inline(always)]
    pub(super) fn one(&self, slot: Slot) -> One<'_> {
        One { record: self.record(slot), surface: self.surface(slot) }
    }

    /// What is read of sixteen triangles.
    #[inline(always)]
    pub(super) fn many<'a>(&'a self, slots: &'a [u32; WIDE]) -> Many<'a> {
        let records = each!(i in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => self.record(Slot(slots[i])));
        Many { records, entrants: self, slots }
    }
}

/// Eight items from `first` on of a list that grows to hold them.
#[inline(always)]
fn eight<T: Clone + Default>(list: &mut Vec<T>, first: usize) -> Option<&mut [T; LANES]> {
    if list.len() < first + LANES {
        list.resize(first + LANES, T::default());
    }
    list[first..].first_chunk_mut()
}
