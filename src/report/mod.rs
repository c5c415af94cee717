//! Reports that assess the engine or describe its work: headless, and also shown in the window.

pub mod comparison;

mod html;

pub mod leaving_out;

pub mod plan;

mod plot;

pub mod scaling;

pub mod stability;

pub mod upscaling;

/// Last line of the text and CSV output of an interrupted measurement.
const PARTIAL: &str = "# partial: interrupted before everything was measured";
