//! Stability report: the error of the engine on numerically hard cases, and the cost of being correct.
//!
//! ```text
//! catalogue ── cases ──┬── oracle ─── expected answers ──┐
//!   (by a seed)        │                                 ├── measure ── sweep ── text, csv, html, JSON
//!                      └── subject ── actual answers ────┘               │
//!                           (by column)                      timing ─────┘── tradeoff
//! ```
//!
//! [`catalogue`] generates classes of stiff and extreme [`case`]s, and [`oracle`] solves them in exact arithmetic.
//! [`subject`] runs the engine and is the only part that calls it; [`measure`] compares. [`sweep`] runs and times
//! classes against every [`mod@column`]. The report is plain data, which [`mod@text`], [`mod@csv`] and [`mod@html`]
//! format and the window shows.

pub mod case;

pub mod catalogue;

pub mod column;

pub mod csv;

pub mod html;

pub mod measure;

pub mod metric;

pub mod oracle;

pub mod spans;

pub mod subject;

pub mod sweep;

pub mod text;

pub mod timing;

pub mod tradeoff;

mod wire;
