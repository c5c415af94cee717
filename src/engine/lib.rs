//! Engine of Rasterscope: a software rendering pipeline that can be stopped and inspected at any stage, without the
//! window and the command line.
//!
//! Modules are listed in the order of the data flow; each module imports only from the modules above it.
//!
//! # Examples
//! Render a frame and explain one of its pixels:
//!
//! ```
//! use std::sync::Arc;
//!
//! use rasterscope_engine::chain::{Recipe, RenderInputs, Renderer};
//! use rasterscope_engine::inspect::inspect;
//! use rasterscope_engine::pipeline::viewport::Viewport;
//! use rasterscope_engine::scene::builtin;
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

// Lets tests that both crates compile refer to the engine as `rasterscope`, like the examples.
#[cfg(test)]
extern crate self as rasterscope;

#[cfg(test)]
#[path = "../../tests/internal/mod.rs"]
mod internal;
