//! The rendering pipeline.

pub mod grid;
