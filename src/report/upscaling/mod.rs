//! Error against run time: what every way to draw fewer samples saves, and what it costs the picture.
//!
//! ```text
//! recipes × scenes ── sweep ──┬── errors against a named reference ──┐
//!                             ├── times in interleaved rounds ───────┼── tradeoff ── page, csv, JSON
//!                             └── skipping: passing over ────────────┘
//! ```
//!
//! [`sweep`] draws each recipe over a sequence of frames, for its error and for its time; [`tradeoff`] finds out which are beaten by
//! another in both; [`skipping`] draws fewer pixels the simple way, by passing them over inside the loop, so that
//! its cost can be set beside that of visiting fewer. The report is plain data; [`page`] and [`csv`] write it.

pub mod csv;

pub mod page;

mod plot;

pub mod skipping;

pub mod sweep;

pub mod tradeoff;
