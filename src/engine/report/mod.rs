//! Reports that assess the engine or describe its work, for the command line and for the window.

pub(crate) mod comparison;

pub(crate) mod html;

pub(crate) mod skipped_work;

pub(crate) mod plan;

mod plot;

pub(crate) mod scaling;

pub mod stability;

pub mod upscaling;

/// Last line of the text and CSV output of an interrupted measurement.
const PARTIAL: &str = "# partial: interrupted before everything was measured";
