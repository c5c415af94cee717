//! Stability report: the errors of the engine on numerically hard test cases, and the run time of each configuration.
//!
//! ```text
//! catalogue ── cases ──┬── oracle ─── expected answers ──┐
//!   (by a seed)        │                                 ├── measure ── sweep ── text, csv, html, JSON
//!                      └── subject ── actual answers ────┘               │
//!                           (by column)                      timing ─────┘── tradeoff
//! ```
//!
//! [`catalogue`] generates classes of numerically hard [`case`]s, and [`oracle`] solves them in exact arithmetic.
//! [`subject`] runs the engine and is the only part that calls it; [`measure`] compares. [`sweep`] runs and times
//! classes against every [`mod@column`]. The report is plain data, which [`mod@text`], [`mod@csv`] and [`mod@html`]
//! format and the window shows.

pub(crate) mod case;

pub mod catalogue;

pub(crate) mod column;

pub(crate) mod csv;

pub(crate) mod html;

pub(crate) mod measure;

pub(crate) mod metric;

pub(crate) mod oracle;

pub(crate) mod spans;

pub(crate) mod subject;

pub(crate) mod sweep;

pub(crate) mod text;

pub(crate) mod timing;

pub(crate) mod tradeoff;

mod wire;
