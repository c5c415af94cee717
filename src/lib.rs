//! Rasterscope: a software rendering pipeline that can be stopped and inspected at any stage.
//!
//! Modules are listed in the order of the data flow; each imports only from those above it.

pub mod text;

pub mod disk;

pub mod math;

pub mod image;

pub mod flat2d;

pub mod drawing;

pub mod scene;

pub mod pipeline;

pub mod antialias;

pub mod upscale;

pub mod chain;

pub mod measure;

pub mod inspect;

pub mod case;

pub mod report;

pub mod lab;

pub mod manual;

#[cfg(feature = "ui")]
pub mod ui;
