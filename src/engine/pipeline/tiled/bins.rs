//! Culling and binning: finds the triangles that may be visible, and the tiles that each of them overlaps.
//!
//! Triangles are processed in chunks, in submission order. Each chunk culls eight triangles at a time and sorts the
//! survivors by tile. Chunks run in parallel. A tile reads them in order, so it gets its triangles in submission order.

use rayon::prelude::*;

use super::geometry::{Arrays, InstanceDraw, PackedSurface, PackedVertex};
use super::lattice::{TILE, TileLattice};
use super::outcode::{ClipVerdict, Outcode};
use crate::math::lanes::*;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::settings::{Culling, Settings};
use crate::pipeline::vertex::Varyings;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{ClipSpaceDraw, Geometry, finish_draw};
use crate::scene::TriangleId;

/// Key of a triangle within a frame: the identifier of a scene triangle or, if the highest bit is set, the chunk and
/// the index of a piece made by clipping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct TriangleKey(pub(super) u32);

impl TriangleKey {
    const PIECE: u32 = 1 << 31;
    /// Number of bits for the index of a piece within its chunk. Clipping makes at most eight pieces per triangle.
    const PIECE_BITS: u32 = 17;

    fn piece(chunk: usize, index: usize) -> Self {
        Self(Self::PIECE | (chunk as u32) << Self::PIECE_BITS | index as u32)
    }

    /// For a piece that clipping produced, returns its chunk and its index in that chunk. Returns `None` for an
    /// unclipped triangle.
    #[inline(always)]
    pub(super) fn as_piece(self) -> Option<(usize, usize)> {
        let index = self.0 & !Self::PIECE;
        (self.0 & Self::PIECE != 0)
            .then_some(((index >> Self::PIECE_BITS) as usize, (index & ((1 << Self::PIECE_BITS) - 1)) as usize))
    }
}

/// Number of triangles per chunk: small enough that there are chunks for all threads, and large enough that a tile
/// reads its triangles from few chunks.
///
/// The indices of eight pieces per triangle fit into [`TriangleKey::PIECE_BITS`] bits.
const CHUNK: usize = 16_384;

/// Maximum number of triangles in a frame. Chunk numbers must fit into the remaining bits of a piece's [`TriangleKey`].
pub(super) const MAX_TRIANGLES: usize = CHUNK * ((1 << (31 - TriangleKey::PIECE_BITS)) - 1);

/// Chunk of triangles in submission order, and its potentially visible triangles sorted by tile.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk {
    /// Ranges of triangle identifiers: index of the draw, first identifier, one past the last.
    parts: Vec<(usize, u32, u32)>,
    survivors: Survivors,
    /// For each tile, the index of its first entry in `keys`. One more value at the end is the number of all entries.
    starts: Vec<u32>,
    keys: Vec<TriangleKey>,
    /// Pieces of clipped triangles.
    pub(super) pieces: Vec<ScreenTriangle>,
    /// Vertices of each piece, in the packed layout that SIMD kernels read.
    pub(super) corners: Vec<[(PackedVertex, PackedSurface); 3]>,
    /// Number of triangles and pieces that pass face culling, whether or not they cover any sample.
    pub(super) rasterized: usize,
}

/// Range of tiles that a triangle's bounding box overlaps, packed into 32 bits.
///
/// Bits 0 to 15 hold the index of the first tile in the picture. Bits 16 to 23 hold the number of columns from there to
/// the last tile, and bits 24 to 31 the number of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct TileRange(u32);

impl TileRange {
    const COLUMNS: u32 = 16;
    const ROWS: u32 = 24;

    /// Packs the range from a first to a last tile, each given as column and row. `row` is the number of tiles in a row
    /// of the picture.
    fn new([x0, y0]: [u32; 2], [x1, y1]: [u32; 2], row: usize) -> Self {
        Self((y0 * row as u32 + x0) | (x1 - x0) << Self::COLUMNS | (y1 - y0) << Self::ROWS)
    }

    /// Packs the ranges of eight triangles like [`TileRange::new`]. Returns the bits of each range.
    #[inline(always)]
    fn of_lanes<S: Simd>([x0, y0]: [i32x8<S>; 2], [x1, y1]: [i32x8<S>; 2], row: usize) -> i32x8<S> {
        (y0 * row as i32 + x0) | (x1 - x0) << Self::COLUMNS | (y1 - y0) << Self::ROWS
    }

    /// Calls `visit` with the index in the picture of each tile in the range. `row` is the number of tiles in a row of
    /// the picture.
    #[inline(always)]
    fn for_each(self, row: usize, mut visit: impl FnMut(usize)) {
        let first = (self.0 & ((1 << Self::COLUMNS) - 1)) as usize;
        if self.0 < 1 << Self::COLUMNS {
            // Fast path: most small triangles overlap only one tile.
            return visit(first);
        }
        let (columns, rows) = ((self.0 >> Self::COLUMNS & 0xff) as usize, (self.0 >> Self::ROWS) as usize);
        for y in 0..=rows {
            for x in 0..=columns {
                visit(first + y * row + x);
            }
        }
    }
}

/// Potentially visible triangles in submission order, each with the range of tiles that it overlaps.
#[derive(Clone, Debug, Default)]
struct Survivors {
    /// Key of each triangle. The list is longer than `used`, so that eight keys can be stored at once.
    keys: Vec<u32>,
    /// Bits of each triangle's [`TileRange`]. The list is as long as `keys`.
    tiles: Vec<u32>,
    /// Number of valid entries in `keys` and `tiles`.
    used: usize,
}

impl Survivors {
    /// Reserves space for eight more entries.
    #[inline(always)]
    fn reserve(&mut self) {
        if self.keys.len() < self.used + LANES {
            let len = (2 * self.used).max(1024);
            self.keys.resize(len, 0);
            self.tiles.resize(len, 0);
        }
    }

    fn push(&mut self, key: TriangleKey, tiles: TileRange) {
        self.reserve();
        (self.keys[self.used], self.tiles[self.used]) = (key.0, tiles.0);
        self.used += 1;
    }

    /// Appends the lanes selected by `mask`. `count` is the number of selected lanes.
    #[inline(always)]
    fn push_lanes<S: Simd>(&mut self, keys: i32x8<S>, tiles: i32x8<S>, mask: mask32x8<S>, count: u32) {
        self.reserve();
        let room = self.used..self.used + LANES;
        keys.bitcast::<u32x8<S>>().compress(mask).store_slice(&mut self.keys[room.clone()]);
        tiles.bitcast::<u32x8<S>>().compress(mask).store_slice(&mut self.tiles[room]);
        self.used += count as usize;
    }

    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = (TriangleKey, TileRange)> {
        let (keys, tiles) = (&self.keys[..self.used], &self.tiles[..self.used]);
        keys.iter().zip(tiles).map(|(key, tiles)| (TriangleKey(*key), TileRange(*tiles)))
    }
}

impl Chunk {
    /// Returns the keys of the triangles whose bounding boxes overlap a tile, in submission order.
    #[inline(always)]
    pub(super) fn keys(&self, tile: usize) -> &[TriangleKey] {
        &self.keys[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    /// Returns the number of triangles and pieces that may be visible.
    pub(super) fn kept(&self) -> usize {
        self.survivors.used
    }

    /// Returns the total number of bin entries of all tiles.
    pub(super) fn binned(&self) -> usize {
        self.keys.len()
    }

    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        let Survivors { keys, tiles, .. } = &self.survivors;
        (keys.capacity() + tiles.capacity() + self.starts.capacity() + self.keys.capacity()) * size_of::<u32>()
            + self.pieces.capacity() * size_of::<ScreenTriangle>()
            + self.corners.capacity() * size_of::<[(PackedVertex, PackedSurface); 3]>()
    }
}

/// Inputs of binning that are common to all triangles of a frame.
pub(super) struct Binning<'a> {
    pub(super) draws: &'a [InstanceDraw<'a>],
    pub(super) arrays: &'a Arrays,
    pub(super) settings: &'a Settings,
    pub(super) viewport: Viewport,
    pub(super) scale: DepthScale,
    pub(super) lattice: TileLattice,
    /// Width and height, in samples, of the packed picture, which holds only the drawn samples.
    pub(super) packed: (u32, u32),
    /// Number of tiles in a row and in a column of the picture.
    pub(super) tiles: (usize, usize),
}

impl Binning<'_> {
    /// Culls and bins all triangles into `chunks`, whose memory is reused.
    pub(super) fn run(&self, lanes: Lanes, chunks: &mut Vec<Chunk>) {
        self.split_into_chunks(chunks);
        chunks.par_iter_mut().enumerate().with_max_len(1).for_each(|(number, chunk)| {
            for part in 0..chunk.parts.len() {
                let (draw, first, end) = chunk.parts[part];
                on_lanes!(lanes, simd => self.cull(simd, draw, first..end, number, chunk));
            }
            self.sort(chunk);
        });
    }

    /// Divides the triangles that remain after cluster culling into chunks.
    fn split_into_chunks(&self, chunks: &mut Vec<Chunk>) {
        for chunk in chunks.iter_mut() {
            chunk.parts.clear();
            chunk.survivors.used = 0;
            chunk.pieces.clear();
            chunk.corners.clear();
            chunk.rasterized = 0;
        }
        let (mut number, mut room) = (0, CHUNK as u32);
        let draws = self.draws.iter().enumerate();
        for (index, draw, own) in
            draws.flat_map(|(index, draw)| draw.kept.triangles.as_slice().iter().map(move |own| (index, draw, own)))
        {
            let (mut first, end) = (draw.first.0 + own.start as u32, draw.first.0 + own.end as u32);
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

    /// Culls a range of triangles of one draw, and appends those that may be visible to a chunk.
    #[inline(always)]
    fn cull<S: Simd>(&self, simd: S, draw: usize, ids: std::ops::Range<u32>, chunk_number: usize, chunk: &mut Chunk) {
        let leaves_frustum = self.arrays.leaves_frustum[draw];
        let draw = &self.draws[draw];
        let offset = (ids.start - draw.first.0) as usize;
        let triangles = &draw.mesh.triangles[offset..offset + ids.len()];
        let own = draw.first_vertex..draw.first_vertex + draw.mesh.positions.len();
        let vertices = &self.arrays.vertices[own.clone()];
        let outcodes = if leaves_frustum { &self.arrays.outcodes[own] } else { &[] };
        let mut padded = [[0; 3]; LANES];
        for (first_id, group) in ids.step_by(LANES).zip(triangles.chunks(LANES)) {
            let corners = match group.as_array() {
                Some(corners) => corners,
                None => {
                    padded[..group.len()].copy_from_slice(group);
                    &padded
                }
            };
            let (mut whole, mut cut) = (u64::MAX, 0);
            if leaves_frustum {
                (whole, cut) = crossings(outcodes, group);
                if whole | cut == 0 {
                    continue;
                }
            }
            // Excludes the padding lanes. All three vertices of a padding lane are vertex 0 of the draw, so its area is
            // zero, or NaN if the screen position of that vertex is NaN.
            whole &= u64::from(u32::MAX) >> (u32::BITS as usize - group.len());
            let (shown, alive, tiles) = self.cull_lanes(simd, (vertices, corners), whole, draw.plan.culling());
            chunk.rasterized += shown.count_ones() as usize;
            let count = alive.count_ones();
            if cut != 0 {
                let tiles = tiles.to_array();
                for (lane, corners) in group.iter().enumerate() {
                    let id = first_id + lane as u32;
                    if cut >> lane & 1 != 0 {
                        self.cut(draw, id, *corners, chunk_number, chunk);
                    } else if alive >> lane & 1 != 0 {
                        chunk.survivors.push(TriangleKey(id), TileRange(tiles[lane] as u32));
                    }
                }
            } else if count != 0 {
                let keys = i32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]) + first_id as i32;
                chunk.survivors.push_lanes(keys, tiles, mask32x8::from_bitmask(simd, alive), count);
            }
        }
    }

    /// Culls eight triangles. Those that `whole` does not select are always culled. Returns the bit mask of the
    /// triangles that pass face culling, the bit mask of the triangles that also may cover a sample, and the tile range
    /// of each triangle.
    #[inline(always)]
    fn cull_lanes<S: Simd>(
        &self,
        simd: S,
        (vertices, corners): (&[PackedVertex], &[[u32; 3]; LANES]),
        whole: u64,
        culling: Culling,
    ) -> (u64, u64, i32x8<S>) {
        let nowhere = PackedVertex::default();
        let positions = each!(corner in [0, 1, 2] => {
            let (x, y) = halves(simd, each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
                vertices.get(corners[lane][corner] as usize).unwrap_or(&nowhere).position_bits()
            }));
            [x.bitcast::<F32<S>>(), y.bitcast::<F32<S>>()]
        });
        let [dx, dy] = each!(axis in [0, 1] => each!(corner in [0, 1, 2] => widen(simd, positions[corner][axis])));
        let area = (dx[1] - dx[0]) * (dy[2] - dy[0]) - (dx[2] - dx[0]) * (dy[1] - dy[0]);
        let shown = match culling {
            Culling::Back => area.simd_lt(0.0),
            Culling::Front => area.simd_gt(0.0),
            Culling::None => area.simd_ne(0.0),
        };
        let shown = shown.to_bitmask() & whole;
        if shown == 0 {
            return (0, 0, i32x8::splat(simd, 0));
        }
        let [columns, rows] = each!((axis, size) in [(0, self.packed.0), (1, self.packed.1)] => {
            let [a, b, c] = each!(corner in [0, 1, 2] => positions[corner][axis]);
            let [first, last] = self.lattice.range_lanes(simd, axis, a.min(b).min(c), a.max(b).max(c));
            [first.max(0.0), last.min(size as f32 - 1.0)]
        });
        let has_samples = columns[0].simd_le(columns[1]) & rows[0].simd_le(rows[1]);
        let [first, last] = each!(end in [0, 1] => {
            each!(range in [columns, rows] => (range[end] * (1.0 / TILE as f32)).to_int::<i32x8<S>>())
        });
        (shown, shown & has_samples.to_bitmask(), TileRange::of_lanes(first, last, self.tiles.0))
    }

    /// Clips one triangle with the code of the classic (scalar) path, and bins its pieces.
    fn cut(&self, draw: &InstanceDraw<'_>, id: u32, corners: [u32; 3], chunk_number: usize, chunk: &mut Chunk) {
        let vertices = corners.map(|corner| draw.clip_vertex(draw.first_vertex + corner as usize, self.arrays));
        let one = ClipSpaceDraw {
            instance: draw.instance,
            vertices: &vertices,
            triangles: &[[0, 1, 2]],
            first: TriangleId(id),
            may_cross: true,
            divides_by_w: draw.plan.runs(PipelinePart::PerspectiveDivision),
            culling: draw.plan.culling(),
        };
        let mut out = Geometry { depth_scale: self.scale, ..Geometry::default() };
        finish_draw(&one, self.settings, self.viewport, &mut out, &mut ());
        chunk.rasterized += out.triangles.len();
        for piece in out.triangles.into_vec() {
            let axis = |values: [i32; 3], axis: usize, size: u32| {
                let [a, b, c] = values.map(|v| v as f32);
                let [first, last] = self.lattice.range(axis, a.min(b).min(c), a.max(b).max(c));
                let (first, last) = (first.max(0.0), last.min(size as f32 - 1.0));
                (first <= last).then_some([first as u32 / TILE as u32, last as u32 / TILE as u32])
            };
            let columns = axis(piece.vertices.each_ref().map(|v| v.x), 0, self.packed.0);
            let rows = axis(piece.vertices.each_ref().map(|v| v.y), 1, self.packed.1);
            if let Some(([x0, x1], [y0, y1])) = columns.zip(rows) {
                let key = TriangleKey::piece(chunk_number, chunk.pieces.len());
                chunk.corners.push(piece.vertices.each_ref().map(|vertex| {
                    let Varyings { normal, uv, color, light, .. } = vertex.varyings;
                    let position = [vertex.x as f32, vertex.y as f32];
                    (
                        PackedVertex::new(position, vertex.depth, vertex.inv_w, light, uv.to_array()),
                        PackedSurface::new(normal, color),
                    )
                }));
                chunk.pieces.push(piece);
                chunk.survivors.push(key, TileRange::new([x0, y0], [x1, y1], self.tiles.0));
            }
        }
    }

    /// Sorts the survivors of a chunk by tile, keeping the submission order within each tile.
    fn sort(&self, chunk: &mut Chunk) {
        let Chunk { survivors, starts, keys, .. } = chunk;
        let tiles = self.tiles.0 * self.tiles.1;
        starts.clear();
        starts.resize(tiles + 1, 0);
        let row = self.tiles.0;
        for (_, touched) in survivors.iter() {
            touched.for_each(row, |tile| starts[tile + 1] += 1);
        }
        for tile in 0..tiles {
            starts[tile + 1] += starts[tile];
        }
        keys.clear();
        keys.resize(starts[tiles] as usize, TriangleKey::default());
        for (key, touched) in survivors.iter() {
            touched.for_each(row, |tile| {
                keys[starts[tile] as usize] = key;
                starts[tile] += 1;
            });
        }
        // Each entry of `starts` has advanced to the start of the next tile.
        starts.rotate_right(1);
        starts[0] = 0;
    }
}

/// Returns two bit masks: the triangles that need no clipping, and those that must be clipped. Triangles that are
/// entirely outside the frustum are in neither.
#[inline(always)]
fn crossings(outcodes: &[Outcode], triangles: &[[u32; 3]]) -> (u64, u64) {
    let codes = triangles.as_flattened().iter().map(|corner| outcodes[*corner as usize]);
    let (any, all) = codes.fold((Outcode::default(), Outcode::ALL), |(any, all), code| (any | code, all & code));
    if any.is_inside() {
        return (u64::MAX, 0);
    } else if all.is_beyond() {
        return (0, 0);
    }
    let (mut whole, mut cut) = (0, 0);
    for (lane, triangle) in triangles.iter().enumerate() {
        match Outcode::verdict(triangle.map(|corner| outcodes[corner as usize])) {
            ClipVerdict::Rejected => {}
            ClipVerdict::Whole => whole |= 1 << lane,
            ClipVerdict::Cut => cut |= 1 << lane,
        }
    }
    (whole, cut)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_tile_ranges_visit_exactly_the_tiles_of_a_box() {
        /// Number of columns of tiles in the widest picture.
        const ROW: usize = 256;
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..2000 {
            let mut range = |size: u32| {
                let first = random.u32(..size);
                [first, if random.bool() { first } else { random.u32(first..size) }]
            };
            let boxes: [[[u32; 2]; 2]; LANES] = std::array::from_fn(|_| [range(ROW as u32), range(256)]);
            let tiles = boxes.map(|[[x0, x1], [y0, y1]]| TileRange::new([x0, y0], [x1, y1], ROW));
            let end = |axis: usize, end: usize| boxes.map(|sides| sides[axis][end] as i32);
            for lanes in Lanes::all() {
                let found = on_lanes!(lanes, simd => {
                    let [first, last] = each!(i in [0, 1] => {
                        each!(axis in [0, 1] => i32x8::load_array(simd, end(axis, i)))
                    });
                    TileRange::of_lanes(first, last, ROW).to_array()
                });
                assert_eq!(found.map(|bits| TileRange(bits as u32)), tiles);
            }
            let [[x0, x1], [y0, y1]] = boxes[0].map(|side| side.map(|tile| tile as usize));
            let expected: Vec<_> = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| y * ROW + x)).collect();
            let mut visited = Vec::new();
            tiles[0].for_each(ROW, |tile| visited.push(tile));
            assert_eq!(visited, expected);
        }
    }

    #[test]
    fn survivors_keep_their_order() {
        let mut random = fastrand::Rng::with_seed(4);
        for lanes in Lanes::all() {
            let (mut survivors, mut expected) = (Survivors::default(), Vec::new());
            for group in 0..1000 {
                let mask = random.u64(..) & 0xff;
                let ids: [i32; LANES] = std::array::from_fn(|lane| group * LANES as i32 + lane as i32);
                let chosen = ids.iter().enumerate().filter(|(lane, _)| mask >> lane & 1 != 0);
                expected.extend(chosen.map(|(_, id)| (TriangleKey(*id as u32), TileRange(!*id as u32))));
                on_lanes!(lanes, simd => {
                    let keys = i32x8::load_array(simd, ids);
                    survivors.push_lanes(keys, !keys, mask32x8::from_bitmask(simd, mask), mask.count_ones());
                });
                if random.u8(..) < 16 {
                    expected.push((TriangleKey(7), TileRange(9)));
                    survivors.push(TriangleKey(7), TileRange(9));
                }
            }
            assert_eq!(survivors.iter().collect::<Vec<_>>(), expected);
        }
    }
}
