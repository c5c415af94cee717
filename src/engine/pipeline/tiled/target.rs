//! Destination of a tile's colours and depths: rows of the picture, or private memory that is copied into it
//! afterwards.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::layout::{SamplePlace, TILE, TILE_SAMPLES, TilePlace, TileSize};
use super::patch::Patch;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Rows of memory that contain the rows of a tile, in the picture or in private memory.
pub(super) struct TileRows<'a, T> {
    pub(super) values: &'a mut [T],
    /// Distance between adjacent rows, in values.
    pub(super) stride: usize,
    /// Index of the tile's first value in the first row.
    pub(super) left: usize,
    pub(super) size: TileSize,
}

/// Rows of colours that contain the rows of a tile.
pub(super) type ColorRows<'a> = TileRows<'a, Rgba8>;

impl<T> TileRows<'_, T> {
    /// Reborrows the rows for a shorter lifetime.
    #[inline(always)]
    pub(super) fn reborrow(&mut self) -> TileRows<'_, T> {
        TileRows { values: self.values, ..*self }
    }

    /// Returns the index of the first value of a patch in a row of the tile.
    #[inline(always)]
    pub(super) fn start(&self, patch: &Patch, row: usize) -> usize {
        row * self.stride + self.left + patch.column
    }

    /// Returns the values of a patch in a row of the tile.
    #[inline(always)]
    pub(super) fn row(&mut self, patch: &Patch, row: usize) -> &mut [T] {
        let start = self.start(patch, row);
        &mut self.values[start..start + patch.count]
    }

    /// Returns the value of a sample.
    #[inline(always)]
    pub(super) fn at(&mut self, place: SamplePlace) -> &mut T {
        &mut self.values[place.row * self.stride + self.left + place.column]
    }

    /// Returns an iterator over the rows of the tile.
    pub(super) fn rows(&mut self) -> impl Iterator<Item = &mut [T]> {
        let (left, TileSize { columns, rows }) = (self.left, self.size);
        self.values.chunks_mut(self.stride).take(rows).map(move |row| &mut row[left..left + columns])
    }
}

/// Destination of one tile of the picture.
pub(super) struct Target<'a> {
    pub(super) place: TilePlace,
    /// Destination of the colours, already filled with the background.
    pub(super) picture: ColorRows<'a>,
    /// Destination of the depths; `None` if they are not kept.
    pub(super) depths: Option<TileRows<'a, f32>>,
}

impl Target<'_> {
    /// Fills the depths, if they are kept, with the clear value.
    pub(super) fn clear_depths(&mut self, clear: f32) {
        self.depths.iter_mut().flat_map(TileRows::rows).for_each(|row| row.fill(clear));
    }
}

/// One row of tiles of the packed picture, with its colours and depths. The bottom row of tiles may have fewer rows of
/// pixels.
pub(super) struct PictureRows<'p> {
    width: usize,
    colors: &'p mut [Rgba8],
    depths: Option<&'p mut [f32]>,
}

/// Splits a picture, and its depths if they are kept, into rows of tiles that threads can lock.
pub(super) fn picture_rows<'p>(
    colors: &'p mut Image<Rgba8>,
    depths: Option<&'p mut Image<f32>>,
) -> Vec<Mutex<PictureRows<'p>>> {
    let width = colors.width() as usize;
    let length = (width * TILE).max(1);
    let mut depths = depths.map(|depths| depths.pixels_mut().chunks_mut(length));
    let colors = colors.pixels_mut().chunks_mut(length);
    colors
        .map(|colors| PictureRows { width, colors, depths: depths.as_mut().and_then(Iterator::next) })
        .map(Mutex::new)
        .collect()
}

/// Locks a row of tiles, even if another thread panicked while it held the lock.
pub(super) fn lock<'a, 'p>(rows: &'a Mutex<PictureRows<'p>>) -> MutexGuard<'a, PictureRows<'p>> {
    rows.lock().unwrap_or_else(PoisonError::into_inner)
}

impl PictureRows<'_> {
    /// Fills all colours with the background. This brings the pixels into the cache before samples are written.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&mut self, simd: S, background: Rgba8) {
        fill(simd, self.colors, background);
    }

    /// Clears a range of columns of tiles to a background and a depth.
    #[inline(always)]
    pub(super) fn clear<S: Simd>(&mut self, simd: S, columns: &Range<usize>, background: Rgba8, depth: f32) {
        let part = columns.start * TILE..self.width.min(columns.end * TILE);
        if part.len() == self.width {
            fill(simd, self.colors, background);
        } else {
            for row in self.colors.chunks_exact_mut(self.width) {
                fill(simd, &mut row[part.clone()], background);
            }
        }
        for row in self.depths.iter_mut().flat_map(|depths| depths.chunks_exact_mut(self.width)) {
            row[part.clone()].fill(depth);
        }
    }

    /// Returns one of the tiles as a destination.
    pub(super) fn target(&mut self, place: TilePlace) -> Target<'_> {
        let (stride, left, size) = (self.width, place.column * TILE, self.size(place.column));
        let depths = self.depths.as_deref_mut().map(|values| TileRows { values, stride, left, size });
        Target { place, picture: TileRows { values: self.colors, stride, left, size }, depths }
    }

    /// Returns the size of a tile, given by its column.
    fn size(&self, column: usize) -> TileSize {
        TileSize { columns: (self.width - column * TILE).min(TILE), rows: self.colors.len() / self.width }
    }

    /// Copies a tile from private memory into the picture.
    #[inline(always)]
    fn put<S: Simd>(&mut self, simd: S, column: usize, memory: &TileMemory) {
        let (TileSize { columns, .. }, left) = (self.size(column), column * TILE);
        for (row, from) in self.colors.chunks_exact_mut(self.width).zip(memory.colors.as_chunks::<TILE>().0) {
            let row = &mut row[left..left + columns];
            if columns < TILE {
                row.copy_from_slice(&from[..columns]);
                continue;
            }
            for (to, from) in row.as_chunks_mut::<WIDE>().0.iter_mut().zip(from.as_chunks::<WIDE>().0) {
                u8x64::from_slice(simd, from.as_flattened()).store_slice(to.as_flattened_mut());
            }
        }
        let Some(depths) = &mut self.depths else { return };
        for (row, from) in depths.chunks_exact_mut(self.width).zip(memory.depths.as_chunks::<TILE>().0) {
            row[left..left + columns].copy_from_slice(&from[..columns]);
        }
    }
}

/// Private memory for one tile of the picture, aligned to a cache line.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct TileMemory {
    colors: [Rgba8; TILE_SAMPLES],
    depths: [f32; TILE_SAMPLES],
}

impl TileMemory {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self { colors: [[0; 4]; TILE_SAMPLES], depths: [0.0; TILE_SAMPLES] })
    }

    /// Fills all colours with the background.
    pub(super) fn fill(&mut self, lanes: Lanes, background: Rgba8) {
        on_lanes!(lanes, simd => fill(simd, &mut self.colors, background));
    }

    /// Draws a tile into private memory, which must be filled with the background, and copies it into the picture.
    pub(super) fn draw(
        &mut self,
        lanes: Lanes,
        place: TilePlace,
        rows: &Mutex<PictureRows<'_>>,
        draw: impl FnOnce(Target<'_>),
    ) {
        let (size, keeps_depths) = {
            let rows = lock(rows);
            (rows.size(place.column), rows.depths.is_some())
        };
        let (stride, left) = (TILE, 0);
        let depths = keeps_depths.then_some(TileRows { values: &mut self.depths, stride, left, size });
        draw(Target { place, picture: TileRows { values: &mut self.colors, stride, left, size }, depths });
        on_lanes!(lanes, simd => lock(rows).put(simd, place.column, self));
    }
}

/// Fills pixels with one colour. Stores whole cache lines, which need not be read from memory first.
#[inline(always)]
fn fill<S: Simd>(simd: S, pixels: &mut [Rgba8], color: Rgba8) {
    let line = u32x16::splat(simd, u32::from_le_bytes(color));
    let before = pixels.as_ptr().align_offset(size_of_val(&line)).min(pixels.len());
    let (before, pixels) = pixels.split_at_mut(before);
    let (lines, after) = pixels.as_chunks_mut::<WIDE>();
    for pixels in lines {
        line.bitcast::<u8x64<S>>().store_slice(pixels.as_flattened_mut());
    }
    before.fill(color);
    after.fill(color);
}

#[cfg(test)]
mod tests {
    use super::super::layout::TileGrid;
    use super::super::runs::{TileRun, split_into_runs};
    use super::*;

    /// Pretends to draw a tile: writes its number to every pixel and increments their third channel. Counts the tile in
    /// `drawn`.
    fn draw(target: Target<'_>, drawn: &mut [usize]) {
        let [low, high, ..] = target.place.number.to_le_bytes();
        drawn[target.place.number] += 1;
        let Target { place: TilePlace { number, .. }, mut picture, mut depths } = target;
        for pixel in picture.rows().flatten() {
            *pixel = [low, high, pixel[2] + 1, 255];
        }
        for depth in depths.iter_mut().flat_map(TileRows::rows).flatten() {
            *depth = number as f32;
        }
    }

    #[test]
    fn each_tile_is_drawn_once_and_where_it_belongs() {
        let background = [0, 0, 6, 255];
        for (width, height) in [(1, 1), (64, 64), (65, 63), (200, 130), (1000, 70), (90, 1100)] {
            for threads in [1, 2, 3, 16, 100] {
                let mut colors = Image::from_fn(width, height, |_, _| [9; 4]);
                let mut depths = Image::from_fn(width, height, |_, _| -1.0);
                let tiles = TileGrid::covering((width, height));
                let rows = picture_rows(&mut colors, Some(&mut depths));
                let (mut memory, mut drawn) = (TileMemory::new(), vec![0; tiles.count()]);
                for TileRun { row, columns, .. } in split_into_runs(&[], tiles, threads) {
                    let rows = &rows[row];
                    let places = columns.clone().map(|column| tiles.place(column, row));
                    if columns.len() == tiles.columns {
                        on_lanes!(Lanes::best(), simd => lock(rows).fill(simd, background));
                        places.for_each(|place| draw(lock(rows).target(place), &mut drawn));
                    } else {
                        places.for_each(|tile| {
                            memory.fill(Lanes::best(), background);
                            memory.draw(Lanes::best(), tile, rows, |target| draw(target, &mut drawn));
                        });
                    }
                }
                drop(rows);
                let number = |x: u32, y: u32| y as usize / TILE * tiles.columns + x as usize / TILE;
                let color = |x: u32, y: u32| {
                    let [low, high, ..] = number(x, y).to_le_bytes();
                    [low, high, 7, 255]
                };
                let what = format!("{width}×{height} px, {threads} threads");
                assert!(drawn.iter().all(|times| *times == 1), "{what}: {drawn:?}");
                assert!(colors == Image::from_fn(width, height, color), "{what}");
                assert!(depths == Image::from_fn(width, height, |x, y| number(x, y) as f32), "{what}");
            }
        }
    }

    #[test]
    fn clearing_columns_of_tiles_leaves_others_unchanged() {
        let (mut colors, mut depths) = (Image::from_fn(200, 3, |_, _| [1; 4]), Image::from_fn(200, 3, |_, _| 1.0));
        let rows = picture_rows(&mut colors, Some(&mut depths));
        on_lanes!(Lanes::best(), simd => lock(&rows[0]).clear(simd, &(1..2), [2; 4], 2.0));
        drop(rows);
        let value = |x: u32| if (64..128).contains(&x) { 2 } else { 1 };
        assert!(colors == Image::from_fn(200, 3, |x, _| [value(x); 4]));
        assert!(depths == Image::from_fn(200, 3, |x, _| f32::from(value(x))));
        let rows = picture_rows(&mut colors, Some(&mut depths));
        on_lanes!(Lanes::best(), simd => lock(&rows[0]).clear(simd, &(0..4), [3; 4], 3.0));
        drop(rows);
        assert!(colors == Image::from_fn(200, 3, |_, _| [3; 4]));
        assert!(depths == Image::from_fn(200, 3, |_, _| 3.0));
    }
}
