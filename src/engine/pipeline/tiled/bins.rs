//! Chunks of triangles: their keys, and the tiles that each triangle overlaps.
//!
//! A chunk holds its potentially visible triangles sorted by tile. A tile reads the chunks in order, so it gets its
//! triangles in submission order.

use std::ops::Range;

use super::layout::TileGrid;
use super::packed::{PackedSurface, PackedVertex};
use crate::math::lanes::*;
use crate::pipeline::screen_triangle::ScreenTriangle;

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
pub(super) const CHUNK: usize = 16_384;

/// Maximum number of triangles in a frame. Chunk numbers must fit into the remaining bits of a piece's [`TriangleKey`].
pub(super) const MAX_TRIANGLES: usize = CHUNK * ((1 << (31 - TriangleKey::PIECE_BITS)) - 1);

/// Chunk of triangles in submission order, and its potentially visible triangles sorted by tile.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk {
    /// Index of the chunk in the frame.
    number: usize,
    pub(super) parts: Vec<ChunkPart>,
    pub(super) survivors: Survivors,
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

/// Triangles of one draw in a chunk.
#[derive(Clone, Debug)]
pub(super) struct ChunkPart {
    /// Index of the draw in the frame's list of draws.
    pub(super) draw: usize,
    /// Identifiers of the triangles in the scene.
    pub(super) ids: Range<u32>,
}

/// Range of tiles that a triangle's bounding box overlaps, packed into 32 bits.
///
/// Bits 0 to 15 hold the index of the first tile in the picture. Bits 16 to 23 hold the number of columns from there to
/// the last tile, and bits 24 to 31 the number of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct TileRange(pub(super) u32);

impl TileRange {
    const COLUMNS: u32 = 16;
    const ROWS: u32 = 24;

    /// Packs the range from a first to a last tile, each given as column and row. `row` is the number of tiles in a row
    /// of the picture.
    pub(super) fn new([x0, y0]: [u32; 2], [x1, y1]: [u32; 2], row: usize) -> Self {
        Self((y0 * row as u32 + x0) | (x1 - x0) << Self::COLUMNS | (y1 - y0) << Self::ROWS)
    }

    /// Packs the ranges of eight triangles like [`TileRange::new`]. Returns the bits of each range.
    #[inline(always)]
    pub(super) fn of_lanes<S: Simd>([x0, y0]: [i32x8<S>; 2], [x1, y1]: [i32x8<S>; 2], row: usize) -> i32x8<S> {
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
pub(super) struct Survivors {
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

    /// Appends a triangle and the range of tiles that it may touch.
    pub(super) fn push(&mut self, key: TriangleKey, tiles: TileRange) {
        self.reserve();
        (self.keys[self.used], self.tiles[self.used]) = (key.0, tiles.0);
        self.used += 1;
    }

    /// Appends the lanes selected by `mask`. `count` is the number of selected lanes.
    #[inline(always)]
    pub(super) fn push_lanes<S: Simd>(&mut self, keys: i32x8<S>, tiles: i32x8<S>, mask: mask32x8<S>, count: u32) {
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
    /// Returns an empty chunk with an index in the frame.
    pub(super) fn new(number: usize) -> Self {
        Self { number, ..Self::default() }
    }

    /// Removes all triangles, but keeps the memory.
    pub(super) fn clear(&mut self) {
        self.parts.clear();
        self.survivors.used = 0;
        self.pieces.clear();
        self.corners.clear();
        self.rasterized = 0;
    }

    /// Returns the key of the next piece that is added to the chunk.
    pub(super) fn next_piece(&self) -> TriangleKey {
        TriangleKey::piece(self.number, self.pieces.len())
    }

    /// Sorts the survivors by tile, keeping the submission order within each tile.
    pub(super) fn sort(&mut self, tiles: TileGrid) {
        let Self { survivors, starts, keys, .. } = self;
        let (row, tiles) = (tiles.columns, tiles.count());
        starts.clear();
        starts.resize(tiles + 1, 0);
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
