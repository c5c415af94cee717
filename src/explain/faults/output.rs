//! Faults in the finished picture: order of rows, columns and channels, encoding and rounding.

use rasterscope_engine::image::Rgba8;
use rasterscope_engine::image::color::{decode, encode};

use crate::agreement::Rounding;
use crate::fault::{Change, Fault, Slot};
use crate::setup::{OutputChange, PixelChange};

pub(super) const FAULTS: &[Fault] = &[
    Fault::error("flip-vertical", "the picture is upside down", Slot::RowOrder, Change::Output(OutputChange::FlipRows)),
    Fault::error(
        "flip-horizontal",
        "left and right are swapped",
        Slot::ColumnOrder,
        Change::Output(OutputChange::FlipColumns),
    ),
    Fault::error(
        "red-blue-swapped",
        "red and blue are swapped (BGR instead of RGB)",
        Slot::Channels,
        Change::Output(OutputChange::Pixel(PixelChange { apply: swap_red_and_blue, undo: swap_red_and_blue })),
    ),
    Fault::error(
        "no-srgb-encoding",
        "linear values are written without sRGB encoding",
        Slot::Encoding,
        Change::Output(OutputChange::Pixel(PixelChange {
            apply: |pixel| of_codes(pixel, decode),
            undo: |pixel| of_codes(pixel, encode),
        })),
    ),
    Fault::error(
        "encoded-twice",
        "the sRGB encoding is applied twice",
        Slot::Encoding,
        Change::Output(OutputChange::Pixel(PixelChange {
            apply: |pixel| of_codes(pixel, encode),
            undo: |pixel| of_codes(pixel, decode),
        })),
    ),
    Fault::convention(
        "gamma-2.2",
        "colours are encoded with a power of 1/2.2 instead of the sRGB curve",
        Slot::Encoding,
        Change::Output(OutputChange::Pixel(PixelChange {
            apply: |pixel| of_codes(pixel, |code| decode(code).powf(1.0 / 2.2)),
            undo: |pixel| of_codes(pixel, |code| encode(code.powf(2.2))),
        })),
    ),
    Fault::error(
        "colour-truncated",
        "colours are truncated to codes instead of rounded",
        Slot::Rounding,
        Change::Rounding(Rounding::Down),
    ),
    Fault::error(
        "colour-rounded-up",
        "colours are rounded up to codes",
        Slot::Rounding,
        Change::Rounding(Rounding::Up),
    ),
];

fn swap_red_and_blue([r, g, b, alpha]: Rgba8) -> Rgba8 {
    [b, g, r, alpha]
}

/// Applies a function of a value in [0, 1] to the three colour codes of a pixel.
fn of_codes([r, g, b, alpha]: Rgba8, change: impl Fn(f32) -> f32) -> Rgba8 {
    let [r, g, b] = [r, g, b].map(|code| (change(f32::from(code) / 255.0) * 255.0).round() as u8);
    [r, g, b, alpha]
}
