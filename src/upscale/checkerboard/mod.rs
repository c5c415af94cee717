//! Checkerboards: the 2×2-pixel squares of one colour are drawn, half of the picture, and the others are filled in.
//!
//! A pixel of a missing square has a drawn square on each side of it. On one side it touches that, on the other the rest of
//! its own square lies between:
//!
//! ```text
//!   a a . . e e      of the . at column 2, row 1 the a beside it and the c below it are touching,
//!   a a . . e e      and the e in its row is behind; nothing drawn lies above
//!   . . c c . .
//!   . . c c . .
//! ```

mod edges;
mod mean;
mod squares;
mod surfaces;
mod temporal;

pub use edges::CHECKERBOARD_EDGES;
pub use mean::CHECKERBOARD;
pub use surfaces::CHECKERBOARD_SURFACES;
pub use temporal::CHECKERBOARD_TEMPORAL;

use super::{Anchor, Light, Offers, Scale};

/// Nothing is to be chosen about a checkerboard.
const OFFERS: Offers = Offers {
    scales: &[Scale::ONE],
    anchors: &[Anchor::Corner],
    lights: &[Light::Bytes],
    deringing: false,
    sharpening: false,
};

/// Column and row of a pixel of the full picture.
type At = (u32, u32);

/// Step from a pixel of a missing square to the drawn square that it touches; see [`step`].
const TOUCHING: i32 = -1;

/// Step from a pixel of a missing square to the drawn square at its back; see [`step`].
const BEHIND: i32 = 2;

/// The place `by` pixels from `at` along one axis, positive across its 2×2 square and negative straight out of it.
/// `None` outside the picture.
fn step(at: u32, by: i32, length: u32) -> Option<u32> {
    let by = if at.is_multiple_of(2) { by } else { -by };
    at.checked_add_signed(by).filter(|place| *place < length)
}

/// The drawn pixel in the row of a missing one, and that in its column, on the side that a [`step`] leads to; none outside
/// the picture.
fn neighbours(by: i32, (width, height): (u32, u32), (x, y): At) -> [Option<At>; 2] {
    [step(x, by, width).map(|x| (x, y)), step(y, by, height).map(|y| (x, y))]
}

/// The drawn pixels in the row and the column of a missing one, as many as the picture has.
fn around(size: (u32, u32), at: At) -> impl Iterator<Item = At> {
    [TOUCHING, BEHIND].into_iter().flat_map(move |by| neighbours(by, size, at)).flatten()
}

/// Packed column of the drawn pixel in column `x`, the same in rows of either kind.
fn packed_column(x: u32) -> u32 {
    x / 4 * 2 + x % 2
}
