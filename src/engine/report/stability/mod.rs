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
//! [`subject`] runs the engine and is the only part that calls it; [`measure`] compares its results with the exact
//! ones. [`sweep`] runs and times every class in every [`mod@column`]; it combines [`observations`], which may come from
//! several machines. The report is plain data: [`mod@text`], [`mod@csv`] and [`mod@html`] format it, and the window
//! shows it.

pub(crate) mod case;

pub mod catalogue;

pub mod column;

pub mod csv;

pub mod html;

pub(crate) mod measure;

pub mod metric;

pub mod observations;

pub(crate) mod oracle;

mod plan;

pub(crate) mod spans;

pub mod subject;

pub mod sweep;

pub mod text;

pub(crate) mod timing;

pub mod tradeoff;

mod wire;
