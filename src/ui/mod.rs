//! The window, and the only module that may use its toolkit (egui).
//!
//! State flows one way: panels read the [`session`] and push [`command`]s, the [`app`] applies them, the [`worker`]
//! renders the newest request on its own thread and returns a view. From the bottom up: [`theme`] defines every colour,
//! size and font; [`mod@format`] formats every number; [`widgets`] are the building blocks of panels; [`cpu_painter`]
//! paints a finished egui frame without a GPU, and [`headless`] drives any user interface without a window system, for
//! screenshots and tests.

pub(crate) mod cpu_painter;

pub mod headless;

pub(crate) mod task;

pub mod fates;

pub mod scrub;

mod layout;

mod seam_search;

pub mod theme;

pub mod format;

pub(crate) mod widgets;

pub(crate) mod manual;

pub(crate) mod ticks;

pub mod look;

pub mod engine;

pub mod range;

pub mod overlays;

pub mod compare;

pub mod worker;

pub(crate) mod lab;

pub mod trace;

pub(crate) mod probe;

pub mod command;

pub(crate) mod timings;

pub(crate) mod long_tasks;

pub(crate) mod open_case;

pub mod session;

pub mod checks;

pub mod place;

pub(crate) mod what_if;

pub(crate) mod watch;

pub(crate) mod fault_bar;

pub(crate) mod zoom;

pub mod vertices;

pub(crate) mod navigate;

pub(crate) mod canvas;

pub(crate) mod mesh_view;

pub(crate) mod panels;

pub(crate) mod palette;

pub mod key_sheet;

pub mod app;

mod start;

pub mod store;

pub(crate) mod window_time;

pub use start::InitialView;
pub use start::ScreenshotRequest;
pub use start::Theme;
pub use start::WindowStart;
pub use start::resumed;
pub(crate) use start::run_window;
pub use start::screenshot;
pub use start::workbench;
