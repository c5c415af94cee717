//! Reports that judge the engine: headless, and shown by the window as well.

pub mod comparison;

pub mod stability;
