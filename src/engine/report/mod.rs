//! Reports that assess the engine or describe its work, for the command line and for the window.

pub mod animation;

pub mod clip;

pub mod comparison;

pub mod html;

pub mod skipped_work;

pub mod motion;

pub mod pictures;

pub mod pixel;

pub mod plan;

mod plot;

pub mod scaling;

pub mod stability;

pub mod upscaling;

/// Last line of the text and CSV output of an interrupted measurement.
const PARTIAL: &str = "# partial: interrupted before everything was measured";

/// Returns text as a quoted field of CSV.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
