//! Reports that judge the engine, or tell what it does: headless, and shown by the window as well.

pub mod comparison;

pub mod plan;

pub mod stability;

pub mod upscaling;
