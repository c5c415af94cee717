//! The window, and the only module that may use its toolkit (egui).
//!
//! State flows one way: panels read the [`session`] and push [`command`]s, the [`app`] applies them, the [`worker`]
//! renders the newest request on its own thread and returns a view. From the bottom up: [`theme`] defines every colour,
//! size and font; [`mod@format`] formats every number; [`widgets`] are the building blocks of panels; [`cpu_painter`]
//! paints a finished egui frame without a GPU, and [`headless`] drives any user interface without a window system, for
//! screenshots and tests.

pub mod cpu_painter;

pub mod headless;

pub mod task;

pub mod fates;

pub mod scrub;

mod layout;

mod seam_search;

pub mod theme;

pub mod format;

pub mod widgets;

pub mod manual;

pub mod ticks;

pub mod look;

pub mod engine;

pub mod range;

pub mod overlays;

pub mod compare;

pub mod worker;

pub mod lab;

pub mod trace;

pub mod probe;

pub mod command;

pub mod timings;

pub mod judging;

pub mod open_case;

pub mod session;

pub mod checks;

pub mod place;

pub mod what_if;

pub mod watch;

pub mod fault_bar;

pub mod zoom;

pub mod vertices;

pub mod navigate;

pub mod canvas;

pub mod mesh_view;

pub mod panels;

pub mod palette;

pub mod key_sheet;

pub mod app;

mod start;

pub mod store;

pub mod window_time;

pub use start::{ScreenshotRequest, Seen, Theme, WindowStart, resumed, run_window, screenshot, workbench};
