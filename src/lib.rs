//! Rasterscope: a software rendering pipeline that anyone can open up, stop at any stage, and question.

pub mod math;

pub mod image;

pub mod scene;

pub mod pipeline;

pub mod upscale;

#[cfg(feature = "ui")]
pub mod ui;
