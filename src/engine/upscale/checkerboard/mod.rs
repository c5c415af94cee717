//! Checkerboard rendering: only half of the 2×2-pixel squares of the image are drawn, and the others are filled in.
//!
//! In its row and in its column, a pixel of a missing square has a drawn square on either side. The pixel touches one
//! of the two; the rest of its own square separates it from the other:
//!
//! ```text
//!   a a . . e e      For the . at column 2, row 1, the a beside it and the c below it are "touching",
//!   a a . . e e      and the e in its row is "behind"; no drawn pixel lies above.
//!   . . c c . .
//!   . . c c . .
//! ```

mod edges;
mod mean;
mod squares;
mod surfaces;
mod temporal;

pub(crate) use edges::CHECKERBOARD_EDGES;
pub(crate) use mean::CHECKERBOARD;
pub(crate) use surfaces::CHECKERBOARD_SURFACES;
pub(crate) use temporal::CHECKERBOARD_TEMPORAL;

use super::{Anchor, FilterSpace, Offers, Scale};

/// Options of the checkerboard upscalers. Each option has only one value, so there is no choice.
const OFFERS: Offers = Offers {
    scales: &[Scale::ONE],
    anchors: &[Anchor::Corner],
    lights: &[FilterSpace::Bytes],
    deringing: false,
    sharpening: false,
    history: false,
};

/// Column and row of a pixel in the full image.
type PixelPosition = (u32, u32);

/// Argument of [`step`] that leads from a pixel of a missing square to the drawn square it touches.
const TOUCHING: i32 = -1;

/// Argument of [`step`] that leads from a pixel of a missing square across this square to the drawn square behind it.
const BEHIND: i32 = 2;

/// Returns the coordinate `by` pixels from `at` along one axis, or `None` outside the image. Positive steps cross the
/// 2×2 square that contains `at`; negative steps lead out of it in the other direction.
fn step(at: u32, by: i32, length: u32) -> Option<u32> {
    let by = if at.is_multiple_of(2) { by } else { -by };
    at.checked_add_signed(by).filter(|place| *place < length)
}

/// Returns the drawn pixel `by` pixels away from a missing pixel in its row, and the one in its column. [`step`]
/// defines the direction. Pixels outside the image are `None`.
fn neighbours(by: i32, (width, height): (u32, u32), (x, y): PixelPosition) -> [Option<PixelPosition>; 2] {
    [step(x, by, width).map(|x| (x, y)), step(y, by, height).map(|y| (x, y))]
}

/// Returns the drawn pixels around a missing pixel in its row and column: four, or fewer near the borders of the image.
fn around(size: (u32, u32), at: PixelPosition) -> impl Iterator<Item = PixelPosition> {
    [TOUCHING, BEHIND].into_iter().flat_map(move |by| neighbours(by, size, at)).flatten()
}

/// Returns the packed column of a drawn pixel, given its column `x` in the full image. The result does not depend on
/// the row.
fn packed_column(x: u32) -> u32 {
    x / 4 * 2 + x % 2
}
