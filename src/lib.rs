//! Rasterscope: a software rendering pipeline that can be stopped and inspected at any stage.
//!
//! The engine is a crate of its own and is re-exported here. Modules are listed in the order of the data flow; each
//! module imports only from the modules above it.
//!
//! # Examples
//! Render a frame and explain one of its pixels:
//!
//! ```
//! use std::sync::Arc;
//!
//! use rasterscope::chain::{Recipe, RenderInputs, Renderer};
//! use rasterscope::inspect::inspect;
//! use rasterscope::pipeline::viewport::Viewport;
//! use rasterscope::scene::builtin;
//!
//! let scene = Arc::new(builtin::by_id("interpenetrating").unwrap().build());
//! let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
//! let inputs = RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport };
//! let frame = Renderer::default().render_converged(inputs);
//!
//! let report = inspect(&scene, &recipe, &frame, 32, 18).unwrap();
//! assert_eq!(report.color, frame.image().at(32, 18));
//! assert_eq!(report.visible().unwrap().instance, "blue");
//! assert!(report.verdict.contains("“blue”"));
//! ```

pub use rasterscope_engine::{
    antialias, case, chain, disk, drawing, flat2d, image, inspect, lab, math, measure, pipeline, report, scene, text,
    upscale,
};
pub use rasterscope_explain as explain;

#[cfg_attr(not(feature = "ui"), allow(dead_code, reason = "only the window shows the sections of the manual"))]
pub mod manual;

#[cfg(feature = "ui")]
pub mod ui;

pub mod cli;

// Lets tests refer to the library as `rasterscope`, like the examples.
#[cfg(test)]
extern crate self as rasterscope;

#[cfg(test)]
#[path = "../tests/internal/workbench.rs"]
mod internal;

#[cfg(test)]
#[path = "../tests/fuzz/mod.rs"]
mod fuzz;
