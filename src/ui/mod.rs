//! The window. No other module may use its toolkit (egui).
//!
//! State flows one way: panels read the [`session`] and push commands, the [`app`] applies them, the [`worker`] renders the
//! newest request on its own thread and returns a view. From the bottom up: [`theme`] defines every colour, size and font;
//! [`mod@format`] formats every number; [`widgets`] are the building blocks of panels; [`cpu_painter`] paints a finished
//! egui frame without a GPU, and [`headless`] drives any user interface without a window system, for screenshots and
//! tests. The [`engine`] computes what a request shows. The [`session`] is the state of the window and of all its tools,
//! [`panels`] draws it, and [`workspace`] lays the panels out.

pub(crate) mod cpu_painter;
pub(crate) mod format;
pub(crate) mod headless;
mod motion;
pub(crate) mod theme;
pub(crate) mod widgets;

mod fuzzy;
mod layout;
mod legend;
pub(crate) mod method_colors;
mod modal;
mod picture_texture;
mod system_dialog;
pub(crate) mod task;
pub(crate) mod thumbnails;
pub(crate) mod ticks;
pub(crate) mod zoom;

pub(crate) mod engine;
mod seam_search;
pub mod session;
pub(crate) mod store;
pub(crate) mod worker;

mod changed_layer;
pub(crate) mod key_map;
pub(crate) mod manual;
pub(crate) mod panels;
pub(crate) mod workspace;

pub(crate) mod answer_time;
pub(crate) mod app;
mod dialogs;
pub mod key_sheet;
pub(crate) mod palette;
mod save_dialog;
mod screenshot;
mod start;
pub(crate) mod window_time;

pub(crate) use screenshot::ScreenshotRequest;
pub(crate) use screenshot::Theme;
pub(crate) use screenshot::screenshot;
pub(crate) use start::InitialView;
pub(crate) use start::WindowStart;
#[cfg(test)]
pub(crate) use start::resumed;
pub(crate) use start::run_window;
#[cfg(test)]
pub(crate) use start::workbench;
