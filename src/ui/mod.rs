//! The window, and everything that may name its toolkit (egui).
//!
//! From the bottom up: [`theme`] holds every colour, size and font; [`mod@format`] turns every number into text; [`widgets`]
//! are the small parts that panels are made of; [`cpu_painter`] turns a finished egui frame into a picture without a
//! graphics card, and [`headless`] drives any user interface without a window system, for screenshots and tests.

pub mod cpu_painter;

pub mod headless;

pub mod theme;

pub mod format;

pub mod widgets;
