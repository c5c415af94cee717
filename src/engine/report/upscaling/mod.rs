//! Upscaling report: the run time that drawing fewer samples saves, and the resulting loss of image quality.
//!
//! ```text
//! recipes × scenes ── sweep ──┬── errors against a named reference ──┐
//!                             ├── times in interleaved rounds ───────┼── tradeoff ── page, csv, JSON
//!                             └── skipping: skipped pixels ──────────┘
//! ```
//!
//! [`sweep`] draws each recipe over a sequence of frames, and measures errors and times. [`tradeoff`] finds the recipes
//! that others dominate in time and error. [`skipping`] compares two ways to draw fewer pixels: skipping them inside
//! the pixel loop, and visiting only the wanted ones. The report is plain data, which [`page`] and [`csv`] format.

pub mod csv;

pub mod page;

mod plot;

pub(crate) mod skipping;

pub mod sweep;

pub mod tradeoff;
