//! Reports that judge the engine, or tell what it does: headless, and shown by the window as well.

pub mod comparison;

mod html;

pub mod leaving_out;

pub mod plan;

mod plot;

pub mod scaling;

pub mod stability;

pub mod upscaling;

/// Last line of the text and tables of a measurement that was interrupted.
const PARTIAL: &str = "# partial: interrupted before everything was measured";
