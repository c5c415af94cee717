//! Culling and binning: which triangles may show, and which tiles each of them touches.
//!
//! Triangles are taken in chunks of their submission order. A chunk culls eight at a time and sorts what is left by tile, so
//! chunks run in parallel, and a tile that walks them in turn meets its triangles in submission order.

use rayon::prelude::*;

use super::geometry::{Arrays, Crossing, Draw, Outcode, Surface, Vertex};
use super::lattice::{Lattice, TILE};
use crate::math::lanes::*;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::plan::Part;
use crate::pipeline::settings::{Culling, Settings};
use crate::pipeline::vertex::Varyings;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{ClipSpaceDraw, Geometry, finish_draw};
use crate::scene::TriangleId;

/// Names a triangle within a frame: its identifier, or, with the highest bit set, a piece that clipping made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Key(pub(super) u32);

impl Key {
    /// No triangle: the background.
    pub(super) const NONE: Self = Self(u32::MAX);
    const PIECE: u32 = 1 << 31;
    /// Bits for the number of a piece within its chunk: a triangle gives at most seven.
    const PIECE_BITS: u32 = 17;

    fn piece(chunk: usize, index: usize) -> Self {
        Self(Self::PIECE | (chunk as u32) << Self::PIECE_BITS | index as u32)
    }

    /// Chunk and position of a piece.
    #[inline(always)]
    pub(super) fn as_piece(self) -> Option<(usize, usize)> {
        let index = self.0 & !Self::PIECE;
        (self.0 & Self::PIECE != 0)
            .then_some(((index >> Self::PIECE_BITS) as usize, (index & ((1 << Self::PIECE_BITS) - 1)) as usize))
    }
}

/// Triangles per chunk: few enough that chunks keep all threads busy, so many that a tile finds its triangles in few places.
/// Seven pieces of each can be numbered with [`Key::PIECE_BITS`].
const CHUNK: usize = 16_384;

/// Most triangles of a frame: chunks must be numbered with the bits that a [`Key`] of a piece has left.
pub(super) const MOST_TRIANGLES: usize = CHUNK * ((1 << (31 - Key::PIECE_BITS)) - 1);

/// Some triangles in submission order, and those of them that may show, by tile.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk {
    /// Positions in the list of draws, each with a range of identifiers.
    parts: Vec<(usize, u32, u32)>,
    survivors: Vec<Survivor>,
    /// For each tile where its keys begin; one more at the end.
    starts: Vec<u32>,
    keys: Vec<Key>,
    /// What clipping made.
    pub(super) pieces: Vec<ScreenTriangle>,
    /// The corners of each piece as lanes read them.
    pub(super) corners: Vec<[(Vertex, Surface); 3]>,
    /// Triangles and pieces that face the right way, whether they have a sample or not.
    pub(super) rasterized: usize,
}

/// A triangle that may show, and the tiles that its box touches: first and last column, first and last row.
#[derive(Clone, Copy, Debug)]
struct Survivor {
    key: Key,
    tiles: [u8; 4],
}

impl Chunk {
    /// Triangles that touch a tile, in submission order.
    #[inline(always)]
    pub(super) fn keys(&self, tile: usize) -> &[Key] {
        &self.keys[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    /// Triangles that may show.
    pub(super) fn kept(&self) -> usize {
        self.survivors.len()
    }

    /// Entries over all tiles.
    pub(super) fn binned(&self) -> usize {
        self.keys.len()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.survivors.capacity() * size_of::<Survivor>()
            + (self.starts.capacity() + self.keys.capacity()) * size_of::<u32>()
            + self.pieces.capacity() * size_of::<ScreenTriangle>()
            + self.corners.capacity() * size_of::<[(Vertex, Surface); 3]>()
    }
}

/// What is the same for all triangles of a frame.
pub(super) struct Binning<'a> {
    pub(super) draws: &'a [Draw<'a>],
    pub(super) arrays: &'a Arrays,
    pub(super) settings: &'a Settings,
    pub(super) viewport: Viewport,
    pub(super) scale: DepthScale,
    pub(super) lattice: Lattice,
    /// Size of the packed picture.
    pub(super) packed: (u32, u32),
    /// Tiles in a row and in a column.
    pub(super) tiles: (usize, usize),
}

impl Binning<'_> {
    /// Fills `chunks`, whose memory is used again.
    pub(super) fn run(&self, lanes: Lanes, chunks: &mut Vec<Chunk>) {
        self.share_out(chunks);
        chunks.par_iter_mut().enumerate().with_max_len(1).for_each(|(number, chunk)| {
            for part in 0..chunk.parts.len() {
                let (draw, first, end) = chunk.parts[part];
                on_lanes!(lanes, simd => self.cull(simd, &self.draws[draw], first..end, number, chunk));
            }
            self.sort(chunk);
        });
    }

    /// Cuts the list of all triangles into chunks.
    fn share_out(&self, chunks: &mut Vec<Chunk>) {
        for chunk in chunks.iter_mut() {
            chunk.parts.clear();
            chunk.survivors.clear();
            chunk.pieces.clear();
            chunk.corners.clear();
            chunk.rasterized = 0;
        }
        let (mut number, mut room) = (0, CHUNK as u32);
        for (index, draw) in self.draws.iter().enumerate() {
            let (mut first, end) = (draw.first.0, draw.first.0 + draw.mesh.triangles.len() as u32);
            while first < end {
                if chunks.len() <= number {
                    chunks.push(Chunk::default());
                }
                let take = room.min(end - first);
                chunks[number].parts.push((index, first, first + take));
                first += take;
                room -= take;
                if room == 0 {
                    (number, room) = (number + 1, CHUNK as u32);
                }
            }
        }
        chunks.truncate(number + usize::from(room < CHUNK as u32));
    }

    #[inline(always)]
    fn cull<S: Simd>(
        &self,
        simd: S,
        draw: &Draw<'_>,
        ids: std::ops::Range<u32>,
        chunk_number: usize,
        chunk: &mut Chunk,
    ) {
        let offset = (ids.start - draw.first.0) as usize;
        let triangles = &draw.mesh.triangles[offset..offset + ids.len()];
        let vertices = &self.arrays.vertices[draw.first_vertex..draw.first_vertex + draw.mesh.positions.len()];
        let nowhere = Vertex::default();
        for (group, corners) in triangles.chunks(LANES).enumerate() {
            let first_id = ids.start + (group * LANES) as u32;
            let mut x = [[0.0_f32; LANES]; 3];
            let mut y = [[0.0_f32; LANES]; 3];
            for (lane, triangle) in corners.iter().enumerate() {
                for corner in 0..3 {
                    let vertex = vertices.get(triangle[corner] as usize).unwrap_or(&nowhere);
                    [x[corner][lane], y[corner][lane]] = vertex.position();
                }
            }
            let all = (1_u64 << corners.len()) - 1;
            let (mut whole, mut cut) = (all, 0);
            if draw.may_cross() {
                (whole, cut) = self.crossings(draw, corners);
            }
            let (shown, alive, tiles) = self.cull_lanes(simd, x, y);
            let alive = alive & whole;
            chunk.rasterized += (shown & whole).count_ones() as usize;
            if alive | cut == 0 {
                continue;
            }
            for lane in (0..corners.len()).filter(|lane| (alive | cut) >> lane & 1 != 0) {
                let id = first_id + lane as u32;
                if cut >> lane & 1 != 0 {
                    self.cut(draw, id, corners[lane], chunk_number, chunk);
                } else {
                    chunk.survivors.push(Survivor { key: Key(id), tiles: tiles.map(|t| t[lane] as u8) });
                }
            }
        }
    }

    /// Which of eight triangles face the right way, which of them may show, both as bits, and the tiles that they touch.
    #[inline(never)]
    fn cull_lanes<S: Simd>(
        &self,
        simd: S,
        x: [[f32; LANES]; 3],
        y: [[f32; LANES]; 3],
    ) -> (u64, u64, [[i32; LANES]; 4]) {
        simd.vectorize(
            #[inline(always)]
            || {
                let x = each!(corner in [0, 1, 2] => F32::load_array(simd, x[corner]));
                let y = each!(corner in [0, 1, 2] => F32::load_array(simd, y[corner]));
                let dx = each!(corner in [0, 1, 2] => widen(simd, x[corner]));
                let dy = each!(corner in [0, 1, 2] => widen(simd, y[corner]));
                let area = (dx[1] - dx[0]) * (dy[2] - dy[0]) - (dx[2] - dx[0]) * (dy[1] - dy[0]);
                let shown = match self.settings.culling {
                    Culling::Back => area.simd_lt(0.0),
                    Culling::Front => area.simd_gt(0.0),
                    Culling::None => area.simd_ne(0.0),
                };
                let shown = shown.to_bitmask();
                let mut alive = shown;
                let mut tiles = [[0; LANES]; 4];
                for (axis, v, size) in [(0, x, self.packed.0), (1, y, self.packed.1)] {
                    let (least, greatest) = (v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2]));
                    let [first, last] = self.lattice.range_lanes(simd, axis, least, greatest);
                    let (first, last) = (first.max(0.0), last.min(size as f32 - 1.0));
                    alive &= first.simd_le(last).to_bitmask();
                    let per_tile = 1.0 / TILE as f32;
                    tiles[2 * axis] = (first * per_tile).to_int::<i32x8<S>>().to_array();
                    tiles[2 * axis + 1] = (last * per_tile).to_int::<i32x8<S>>().to_array();
                }
                (shown, alive, tiles)
            },
        )
    }

    /// Bits of the triangles that lie whole within the guard band, and of those that must be cut.
    fn crossings(&self, draw: &Draw<'_>, corners: &[[u32; 3]]) -> (u64, u64) {
        let (mut whole, mut cut) = (0, 0);
        for (lane, triangle) in corners.iter().enumerate() {
            let codes = triangle.map(|corner| self.arrays.outcodes[draw.first_vertex + corner as usize]);
            match Outcode::verdict(codes) {
                Crossing::Gone => {}
                Crossing::Whole => whole |= 1 << lane,
                Crossing::Cut => cut |= 1 << lane,
            }
        }
        (whole, cut)
    }

    /// Clips one triangle as the classic way does, and bins what is left.
    fn cut(&self, draw: &Draw<'_>, id: u32, corners: [u32; 3], chunk_number: usize, chunk: &mut Chunk) {
        let vertices = corners.map(|corner| draw.clip_vertex(draw.first_vertex + corner as usize, self.arrays));
        let one = ClipSpaceDraw {
            instance: draw.instance,
            vertices: &vertices,
            triangles: &[[0, 1, 2]],
            first: TriangleId(id),
            may_cross: true,
            divides_by_w: draw.plan.runs(Part::PerspectiveDivision),
        };
        let mut out = Geometry { depth_scale: self.scale, ..Geometry::default() };
        finish_draw(&one, self.settings, self.viewport, &mut out, &mut ());
        chunk.rasterized += out.triangles.len();
        for piece in out.triangles.into_vec() {
            let axis = |values: [i32; 3], axis: usize, size: u32| {
                let [a, b, c] = values.map(|v| v as f32);
                let [first, last] = self.lattice.range(axis, a.min(b).min(c), a.max(b).max(c));
                let (first, last) = (first.max(0.0), last.min(size as f32 - 1.0));
                (first <= last).then_some([(first as usize / TILE) as u8, (last as usize / TILE) as u8])
            };
            let columns = axis(piece.vertices.each_ref().map(|v| v.x), 0, self.packed.0);
            let rows = axis(piece.vertices.each_ref().map(|v| v.y), 1, self.packed.1);
            if let Some(([x0, x1], [y0, y1])) = columns.zip(rows) {
                let key = Key::piece(chunk_number, chunk.pieces.len());
                chunk.corners.push(piece.vertices.each_ref().map(|vertex| {
                    let Varyings { normal, uv, color, light, .. } = vertex.varyings;
                    let position = [vertex.x as f32, vertex.y as f32];
                    (
                        Vertex::new(position, vertex.depth, vertex.inv_w, light, uv.to_array()),
                        Surface::new(normal, color),
                    )
                }));
                chunk.pieces.push(piece);
                chunk.survivors.push(Survivor { key, tiles: [x0, x1, y0, y1] });
            }
        }
    }

    /// Sorts the survivors of a chunk by tile, keeping their order.
    fn sort(&self, chunk: &mut Chunk) {
        let Chunk { survivors, starts, keys, .. } = chunk;
        let tiles = self.tiles.0 * self.tiles.1;
        starts.clear();
        starts.resize(tiles + 1, 0);
        let row = self.tiles.0;
        let touched = |survivor: &Survivor| {
            let [x0, x1, y0, y1] = survivor.tiles.map(usize::from);
            (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * row + x))
        };
        for tile in survivors.iter().flat_map(touched) {
            starts[tile + 1] += 1;
        }
        for tile in 0..tiles {
            starts[tile + 1] += starts[tile];
        }
        keys.clear();
        keys.resize(starts[tiles] as usize, Key::NONE);
        for survivor in survivors.iter() {
            for tile in touched(survivor) {
                keys[starts[tile] as usize] = survivor.key;
                starts[tile] += 1;
            }
        }
        // Every start has moved on to the next one.
        starts.rotate_right(1);
        starts[0] = 0;
    }
}
