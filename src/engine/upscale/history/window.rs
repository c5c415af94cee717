//! Reading of the history around the positions to which motion vectors lead.

use crate::image::Image;
use crate::math::lanes::*;
use crate::upscale::quads::Quad;
use crate::upscale::row_parts::RowBlock;

/// Positions of sixteen pixels in the previous frame.
pub(in crate::upscale) struct PastPlaces<S: Simd> {
    /// Column and row in pixels from the top left corner.
    pub(in crate::upscale) place: [f32x16<S>; 2],
    /// Fractions of the way from the pixel centre at or before each position to the next one, in [0, 1).
    pub(in crate::upscale) fraction: [f32x16<S>; 2],
    /// Whether the previous frame shows the pixel's surface.
    pub(in crate::upscale) is_known: mask32x16<S>,
    /// Bit `i`: the position of lane `i` is known.
    known: u64,
    /// Bit `i`: all 4 × 4 pixels around the position of lane `i` lie in the image.
    inside: u64,
    /// Bit `i`: lane `i` reads the pixel to the right of that of lane `i` − 1, or is the first of four.
    continues_row: u64,
    /// For each known position, column and row of the pixel whose centre lies at or before it.
    columns: [i32; WIDE],
    rows: [i32; WIDE],
}

/// Pixel whose centre lies at or before a position.
#[derive(Clone, Copy)]
enum PixelBefore {
    /// The position is not known.
    Unknown,
    /// All 4 × 4 pixels around the position lie in the image; the first one has this index.
    Inside(usize),
    /// Some pixels around the position lie outside the image; the pixel before it has this column and row.
    AtBorder([i64; 2]),
}

/// Four rows of four adjacent pixels each; the position lies between the second and the third row and column.
pub(in crate::upscale) type Window<S> = [f32x16<S>; 4];

/// Returns a bit for every lane whose pixel is to the right of that of the lane before, and for the first of every four.
#[inline(always)]
fn continues_row<S: Simd>([columns, rows]: [i32x16<S>; 2]) -> u64 {
    /// Bits of the first of every four lanes.
    const FIRST: u64 = 0x1111;
    let [columns_before, rows_before] = each!(places in [columns, rows] => places.slide::<15>(places));
    let is_right = columns.simd_eq(columns_before + 1) & rows.simd_eq(rows_before);
    is_right.to_bitmask() | FIRST
}

/// Returns the centres of sixteen pixels.
#[inline(always)]
pub(in crate::upscale) fn centers<S: Simd>(simd: S, RowBlock { from, y }: RowBlock) -> [f32x16<S>; 2] {
    [f32x16::load_array(simd, LANE_NUMBERS) + from as f32 + 0.5, f32x16::splat(simd, y as f32 + 0.5)]
}

impl<S: Simd> PastPlaces<S> {
    /// Finds where sixteen pixels were in a previous frame of `size` px. A vector that is not a number
    /// leads nowhere.
    #[inline(always)]
    pub(in crate::upscale) fn new(simd: S, at: RowBlock, vectors: [f32x16<S>; 2], size: (u32, u32)) -> Self {
        let center = centers(simd, at);
        let place = each!(axis in [0, 1] => center[axis] + vectors[axis]);
        let length = each!(length in [size.0, size.1] => length as f32);
        let zero = f32x16::splat(simd, 0.0);
        let [across, down] = each!(axis in [0, 1] => {
            place[axis].simd_ge(zero) & place[axis].simd_lt(f32x16::splat(simd, length[axis]))
        });
        let is_known = across & down;
        let from = each!(axis in [0, 1] => is_known.select(place[axis], zero) - 0.5);
        let floor = each!(axis in [0, 1] => from[axis].floor());
        let [columns, rows] = each!(axis in [0, 1] => floor[axis].to_int::<i32x16<S>>());
        let [first, last_column, last_row] = each!(number in [1, size.0 as i32 - 3, size.1 as i32 - 3] => {
            i32x16::splat(simd, number)
        });
        let is_inside = is_known
            & columns.simd_ge(first)
            & columns.simd_le(last_column)
            & rows.simd_ge(first)
            & rows.simd_le(last_row);
        Self {
            place,
            fraction: each!(axis in [0, 1] => from[axis] - floor[axis]),
            is_known,
            known: is_known.to_bitmask(),
            inside: is_inside.to_bitmask(),
            continues_row: continues_row([columns, rows]),
            columns: columns.to_array(),
            rows: rows.to_array(),
        }
    }

    /// Returns the pixel before the position of a lane, in an image of `width` px.
    #[inline(always)]
    fn before(&self, lane: usize, width: usize) -> PixelBefore {
        let (column, row) = (self.columns[lane], self.rows[lane]);
        if self.inside >> lane & 1 != 0 {
            PixelBefore::Inside(self.first_inside(lane, width))
        } else if self.known >> lane & 1 != 0 {
            PixelBefore::AtBorder([i64::from(column), i64::from(row)])
        } else {
            PixelBefore::Unknown
        }
    }

    /// Returns the index of the first of the 4 × 4 pixels around the position of a lane, which all lie in an image of `width`
    /// px.
    #[inline(always)]
    pub(super) fn first_inside(&self, lane: usize, width: usize) -> usize {
        (self.rows[lane] as usize - 1) * width + self.columns[lane] as usize - 1
    }

    /// Returns, for each group of four lanes, whether they read adjacent pixels of a row, and all 4 × 4 pixels around each
    /// position lie in the image.
    #[inline(always)]
    pub(super) fn adjacent_fours(&self) -> [bool; WIDE / 4] {
        let lanes = self.inside & self.continues_row;
        each!(first in [0, 4, 8, 12] => lanes >> first & 0b1111 == 0b1111)
    }

    /// Returns the 4 × 4 pixels around the position of a lane, or `None` if the position is not known. Pixels outside the
    /// image are the nearest ones inside it.
    #[inline(always)]
    pub(in crate::upscale) fn window(&self, simd: S, history: &Image<Quad>, lane: usize) -> Option<Window<S>> {
        let width = history.width() as usize;
        match self.before(lane, width) {
            PixelBefore::Unknown => None,
            PixelBefore::Inside(first) => {
                let rows = &history.pixels()[first..][..3 * width + 4];
                Some(each!(row in [0, 1, 2, 3] => f32x16::from_slice(simd, rows[row * width..][..4].as_flattened())))
            }
            PixelBefore::AtBorder([column, row]) => Some(each!(by in [-1, 0, 1, 2] => {
                let row = history.row((row + by).clamp(0, i64::from(history.height()) - 1) as u32);
                let quads = each!(by in [-1, 0, 1, 2] => row[(column + by).clamp(0, width as i64 - 1) as usize]);
                f32x16::from_slice(simd, quads.as_flattened())
            })),
        }
    }
}

impl<S: Simd> PastPlaces<S> {
    /// Returns the four pixels around the position of a lane, row by row, or `None` if the position is not known. Pixels
    /// outside the image are the nearest ones inside it.
    #[inline(always)]
    pub(in crate::upscale) fn four<T: Copy>(&self, image: &Image<T>, lane: usize) -> Option<[[T; 2]; 2]> {
        let width = image.width() as usize;
        match self.before(lane, width) {
            PixelBefore::Unknown => None,
            PixelBefore::Inside(first) => {
                let rows = &image.pixels()[first + width + 1..][..width + 2];
                Some([[rows[0], rows[1]], [rows[width], rows[width + 1]]])
            }
            PixelBefore::AtBorder([column, row]) => Some([row, row + 1].map(|row| {
                let row = image.row(row.clamp(0, i64::from(image.height()) - 1) as u32);
                [column, column + 1].map(|column| row[column.clamp(0, width as i64 - 1) as usize])
            })),
        }
    }
}
