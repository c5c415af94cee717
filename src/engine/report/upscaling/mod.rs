//! Upscaling report: the run time that drawing fewer samples saves, and the resulting loss of image quality.
//!
//! ```text
//! recipes × scenes ── measurements ──┬── errors against a named reference ──┐
//!                     (by shard)     ├── times in interleaved rounds ───────┼── sweep, tradeoff ── page, csv, JSON
//!                                    └── skipping: skipped pixels ──────────┘
//! ```
//!
//! [`measurements`] draws each recipe over a sequence of frames, and measures errors and times. [`sweep`] combines the
//! measurements of all shards, and [`tradeoff`] finds the recipes that others dominate in time and error. [`skipping`] compares two ways to draw fewer pixels: skipping them inside
//! the pixel loop, and visiting only the wanted ones. The report is plain data, which [`page`] and [`csv`] format.

pub mod csv;

pub mod measurements;

pub mod page;

mod plan;

mod plot;

pub(crate) mod skipping;

pub mod sweep;

pub mod tradeoff;

pub use plot::hue_degrees;
