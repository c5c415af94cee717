//! Single entry point of window, command line, reports and tests: a scene, a view and a [`Recipe`] give a [`Frame`].

mod finish;
mod frame;
mod pixel_samples;
mod recipe;
mod renderer;
mod run;
pub mod samples;
#[cfg(test)]
mod tests;
mod view;
pub mod whole;

pub use frame::{Frame, FrameTimes, LazyGeometry};
pub use recipe::{Recipe, SetError};
pub use renderer::{KeepDepth, Renderer, execution};
pub use run::{prepare_again, redraw, run};
