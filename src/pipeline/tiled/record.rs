//! What the tiles' shading reads of a triangle, in the order in which lanes load it.

use super::Frame;
use super::bins::Key;
use super::geometry::{Surface, Vertex};
use super::setup::{Corner, Edges};
use crate::math::lanes::*;

/// Four numbers that are loaded together.
type Quad = [f32; 4];

/// A triangle as one tile sees it, made when the first of its samples there is shaded.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub(super) struct Record {
    quads: [Quad; Self::QUADS],
    pub(super) edges: Edges,
    pub(super) key: Key,
    /// Position in the list of draws.
    pub(super) draw: usize,
    /// Edge values at covered samples lie below 2³¹, so that 32 bits hold them whatever their terms are.
    pub(super) fits_i32: bool,
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
    /// The same of the components of the normal.
    const NORMAL: usize = 5;
    /// The same of the channels of the colour.
    const COLOR: usize = 8;
    const QUADS: usize = 11;

    /// Becomes that of a triangle of a tile at `origin`, in place, as it is large. Without area it stays as it is, which is said.
    #[inline(always)]
    fn fill(&mut self, frame: &Frame<'_>, key: Key, draw: usize, origin: [f64; 2]) -> bool {
        let corners = frame.corners(key, draw);
        let Some(edges) = Edges::new(&corners, origin) else { return false };
        let [a, b, c] = frame.records(key, draw);
        let [r0, r1, r2] = if frame.shader(draw).divides_by_w { relative_inv_w(&corners) } else { [1.0; 3] };
        let vertices = [a.0, b.0, c.0];
        let along = |place: usize| {
            let [a, b, c] = vertices.map(|vertex| vertex.numbers[place]);
            [a, b - a, c - a]
        };
        let ([u, du1, du2], [v, dv1, dv2]) = (along(Vertex::UV[0]), along(Vertex::UV[1]));
        let [light, dl1, dl2] = along(Vertex::LIGHT);
        let quads = &mut self.quads;
        quads[Self::FIRST_EDGE] = [edges.a[0], edges.b[0], edges.c[0], edges.doubled_area].map(low_bits);
        let [a1, b1, c1] = [edges.a[1], edges.b[1], edges.c[1]].map(low_bits);
        quads[Self::SECOND_EDGE] = [a1, b1, c1, r0];
        quads[Self::INV_W_AND_UV] = [r1, r2, u, v];
        quads[Self::UV_DELTAS] = [du1, du2, dv1, dv2];
        quads[Self::LIGHT] = [light, dl1, dl2, 0.0];
        if let (Some(a), Some(b), Some(c)) = (a.1, b.1, c.1) {
            let along = |place: usize| {
                let [a, b, c] = [a, b, c].map(|surface: &Surface| surface.numbers[place]);
                [a, b - a, c - a, 0.0]
            };
            for axis in 0..3 {
                quads[Self::NORMAL + axis] = along(Surface::NORMAL[axis]);
                quads[Self::COLOR + axis] = along(Surface::COLOR[axis]);
            }
        }
        (self.key, self.draw) = (key, draw);
        self.fits_i32 = edges.doubled_area <= f64::from(i32::MAX);
        self.edges = edges;
        true
    }
}

impl Record {
    /// a, b and c of the first two edges, and the doubled area: low 32 bits.
    #[inline(always)]
    pub(super) fn integer_edges(&self) -> ([i32; 3], [i32; 3], i32) {
        let [a0, b0, c0, area] = self.quads[Self::FIRST_EDGE].map(|bits| bits.to_bits() as i32);
        let [a1, b1, c1, _] = self.quads[Self::SECOND_EDGE].map(|bits| bits.to_bits() as i32);
        ([a0, b0, c0], [a1, b1, c1], area)
    }
}

/// The low 32 bits of a whole number between ±2⁵¹. Corners keep to ±2²⁴ steps of each other, so all terms of edges are.
#[inline(always)]
fn low_bits(number: f64) -> f32 {
    /// Added to such a number, it leaves it in the low bits of the sum.
    const SHIFT: f64 = ((1_u64 << 52) + (1_u64 << 51)) as f64;
    f32::from_bits((number + SHIFT).to_bits() as u32)
}

/// As [`crate::pipeline::viewport::relative_inv_w`].
#[inline(always)]
fn relative_inv_w(corners: &[Corner; 3]) -> [f32; 3] {
    let inv_w = corners.map(|corner| corner.inv_w);
    let largest = inv_w[0].max(inv_w[1]).max(inv_w[2]);
    inv_w.map(|i| (i / largest).max(f32::MIN_POSITIVE))
}

/// An attribute at the first corner, and what it changes by from there to each of the others.
#[derive(Clone, Copy)]
pub(super) struct Attribute<S: Simd>(F32<S>, F32<S>, F32<S>);

impl<S: Simd> Attribute<S> {
    /// At samples with these weights of the second and the third corner.
    #[inline(always)]
    pub(super) fn at(self, weights: [F32<S>; 2]) -> F32<S> {
        self.0 + self.1 * weights[0] + self.2 * weights[1]
    }
}

/// Where eight samples have their triangles from.
pub(super) trait Source: Copy {
    /// Four numbers of each sample's triangle.
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [F32<S>; 4];

    /// 1/w of the corners relative to the largest.
    #[inline(always)]
    fn relative_inv_w<S: Simd>(self, simd: S) -> [F32<S>; 3] {
        let [_, _, _, r0] = self.quad(simd, Record::SECOND_EDGE);
        let [r1, r2, ..] = self.quad(simd, Record::INV_W_AND_UV);
        [r0, r1, r2]
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
        self.attribute(simd, Record::LIGHT)
    }

    /// Normal.
    #[inline(always)]
    fn normal<S: Simd>(self, simd: S) -> [Attribute<S>; 3] {
        each!(axis in [0, 1, 2] => self.attribute(simd, Record::NORMAL + axis))
    }

    /// Colour.
    #[inline(always)]
    fn color<S: Simd>(self, simd: S) -> [Attribute<S>; 3] {
        each!(channel in [0, 1, 2] => self.attribute(simd, Record::COLOR + channel))
    }

    /// An attribute that has a quad of its own.
    #[inline(always)]
    fn attribute<S: Simd>(self, simd: S, quad: usize) -> Attribute<S> {
        let [base, first, second, _] = self.quad(simd, quad);
        Attribute(base, first, second)
    }
}

/// All samples are of one triangle.
impl Source for &Record {
    #[inline(always)]
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [F32<S>; 4] {
        each!(i in [0, 1, 2, 3] => F32::splat(simd, self.quads[quad][i]))
    }
}

/// Each sample is of a triangle of its own.
impl Source for [&Record; LANES] {
    #[inline(always)]
    fn quad<S: Simd>(self, simd: S, quad: usize) -> [F32<S>; 4] {
        transpose_quads(each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => f32x4::load_array_ref(simd, &self[i].quads[quad])))
    }
}

/// Edge values of eight triangles, all of which [`Record::fits_i32`], at offsets from the tile's first sample. They are right
/// where a triangle covers its sample; elsewhere they may be any.
#[inline(always)]
pub(super) fn edge_values<S: Simd>(simd: S, records: [&Record; LANES], x: i32x8<S>, y: i32x8<S>) -> [i32x8<S>; 3] {
    let [a0, b0, c0, area] =
        each!(v in [0, 1, 2, 3] => records.quad(simd, Record::FIRST_EDGE)[v].bitcast::<i32x8<S>>());
    let [a1, b1, c1] = each!(v in [0, 1, 2] => records.quad(simd, Record::SECOND_EDGE)[v].bitcast::<i32x8<S>>());
    let first = a0 * x + b0 * y + c0;
    let second = a1 * x + b1 * y + c1;
    [first, second, area - first - second]
}

/// A triangle that a tile was asked to draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entrant {
    pub(super) key: Key,
    /// Position in the list of draws.
    pub(super) draw: u32,
    /// Position of its record, if that was made.
    record: u32,
}

/// Names an [`Entrant`] of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(pub(super) u32);

impl Slot {
    /// No triangle: the background.
    pub(super) const NONE: Self = Self(u32::MAX);
}

/// The triangles that a tile was asked to draw, in their order.
#[derive(Clone, Debug, Default)]
pub(super) struct Entrants {
    list: Vec<Entrant>,
    /// Those that are in use, and some that were.
    records: Vec<Record>,
    used: usize,
}

impl Entrants {
    const NO_RECORD: u32 = u32::MAX;

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.used = 0;
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.list.capacity() * size_of::<Entrant>() + self.records.capacity() * size_of::<Record>()
    }

    /// Adds one.
    #[inline(always)]
    pub(super) fn push(&mut self, key: Key, draw: usize) {
        self.list.push(Entrant { key, draw: draw as u32, record: Self::NO_RECORD });
    }

    /// How many there are; the next one's slot.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// One of them.
    #[inline(always)]
    pub(super) fn get(&self, slot: Slot) -> Entrant {
        self.list[slot.0 as usize]
    }

    /// Makes sure that a triangle's record is there, and says where. Triangles without area get none, and are never seen.
    #[inline(always)]
    pub(super) fn make_record<S: Simd>(
        &mut self,
        simd: S,
        frame: &Frame<'_>,
        slot: Slot,
        origin: [f64; 2],
    ) -> Option<u32> {
        let entrant = &mut self.list[slot.0 as usize];
        if entrant.record == Self::NO_RECORD {
            if self.records.len() == self.used {
                self.records.push(Record::default());
            }
            let record = &mut self.records[self.used];
            let Entrant { key, draw, .. } = *entrant;
            let is_filled = simd.vectorize(
                #[inline(always)]
                || record.fill(frame, key, draw as usize, origin),
            );
            if !is_filled {
                return None;
            }
            entrant.record = self.used as u32;
            self.used += 1;
        }
        Some(entrant.record)
    }

    /// A record that [`Entrants::make_record`] made.
    #[inline(always)]
    pub(super) fn record(&self, position: u32) -> &Record {
        &self.records[position as usize]
    }
}
