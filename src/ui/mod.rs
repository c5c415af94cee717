//! The window. No other module may use its toolkit (egui).
//!
//! State flows one way: panels read the [`session`] and push [`command`]s, the [`app`] applies them, the [`worker`]
//! renders the newest request on its own thread and returns a view. From the bottom up: [`theme`] defines every colour,
//! size and font; [`mod@format`] formats every number; [`widgets`] are the building blocks of panels; [`cpu_painter`]
//! paints a finished egui frame without a GPU, and [`headless`] drives any user interface without a window system, for
//! screenshots and tests.

pub(crate) mod cpu_painter;

pub(crate) mod headless;

pub(crate) mod task;

pub(crate) mod fates;

pub(crate) mod scrub;

pub(crate) mod camera_path;
pub(crate) mod over_time;
pub(crate) mod scene_time;
pub(crate) mod sequences;

mod layout;

mod seam_search;

pub(crate) mod theme;

pub(crate) mod format;

pub(crate) mod widgets;

pub(crate) mod manual;

pub(crate) mod ticks;

pub(crate) mod look;

pub(crate) mod engine;

pub(crate) mod range;

pub(crate) mod overlays;

pub mod compare;

pub(crate) mod worker;

pub(crate) mod lab;

pub(crate) mod trace;

pub(crate) mod probe;

pub(crate) mod features;

pub(crate) mod files;

pub(crate) mod appearance;

pub(crate) mod canvas_state;

pub(crate) mod stages;

pub(crate) mod window_task;

pub(crate) mod command;

pub(crate) mod key_map;

mod picture_texture;

pub(crate) mod timings;

pub(crate) mod long_tasks;

pub(crate) mod open_case;

pub(crate) mod session;

pub(crate) mod checks;

pub(crate) mod explaining;

pub(crate) mod first_pick;

pub(crate) mod picked_point;

pub(crate) mod picture_size;

pub(crate) mod picture_panel;

pub(crate) mod place;

pub(crate) mod what_if;

pub(crate) mod watch;

pub(crate) mod method_colors;

pub(crate) mod fault_bar;

pub(crate) mod zoom;

pub(crate) mod vertices;

pub(crate) mod navigate;

pub(crate) mod canvas;

mod changed_layer;

mod legend_strip;

pub(crate) mod mesh_view;

pub(crate) mod workspace;

pub(crate) mod project;

pub(crate) mod panels;

pub(crate) mod onboarding;

pub(crate) mod thumbnails;

pub(crate) mod save_as;

pub(crate) mod palette;

pub mod key_sheet;

pub(crate) mod app;

mod start;

mod screenshot;

pub(crate) mod store;

pub(crate) mod filmstrip;

pub(crate) mod temporal;

pub(crate) mod window_time;

pub(crate) mod answer_time;

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
