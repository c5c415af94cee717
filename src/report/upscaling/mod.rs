//! Upscaling report, error against run time: the savings of drawing fewer samples, and the loss of image quality.
//!
//! ```text
//! recipes × scenes ── sweep ──┬── errors against a named reference ──┐
//!                             ├── times in interleaved rounds ───────┼── tradeoff ── page, csv, JSON
//!                             └── skipping: skipped pixels ──────────┘
//! ```
//!
//! [`sweep`] draws each recipe over a sequence of frames, and measures errors and times. [`tradeoff`] finds the recipes
//! that are dominated in both. [`skipping`] draws fewer pixels in the naive way, by skipping them inside the loop, for
//! comparison with visiting fewer. The report is plain data, which [`page`] and [`csv`] format.

pub(crate) mod csv;

pub(crate) mod page;

mod plot;

pub(crate) mod skipping;

pub mod sweep;

pub(crate) mod tradeoff;
