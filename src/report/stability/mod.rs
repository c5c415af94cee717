//! The stability report: how wrong the engine is where it is hard to be right, and what being right costs.
//!
//! ```text
//! catalogue ── cases ──┬── oracle ── what is right ──┐
//!   (by a seed)        │                             ├── measure ── sweep ── text, csv, html, JSON
//!                      └── subject ── what is given ─┘               │
//!                           (by column)                  timing ─────┘── tradeoff
//! ```
//!
//! [`catalogue`] makes classes of stiff and extreme [`case`]s; [`oracle`] decides them in exact arithmetic; [`subject`] asks
//! the engine, and is the only part that calls it; [`measure`] compares; [`sweep`] runs classes against every [`mod@column`] and
//! has them timed. The report is plain data: [`mod@text`], [`mod@csv`] and [`mod@html`] write it, and the window shows it.

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
