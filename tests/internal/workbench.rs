//! Tests of the window, tests of the sources, and what the fuzz targets share with the tests of the engine. They are
//! compiled into the root package.

mod cycles;
mod layering;
mod module_graph;
pub(crate) mod samples;
pub(crate) mod scene_builder;
pub(crate) mod sound;
#[cfg(feature = "ui")]
mod ui_pictures;
#[cfg(feature = "window-tests")]
mod window;
#[cfg(feature = "ui")]
mod worker;
