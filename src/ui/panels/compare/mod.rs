//! Comparison of several pictures: its toolbar, tiles and panel, and its export.

pub(crate) mod bar;
pub(crate) mod export;
pub(crate) mod files_panel;
pub(crate) mod tiles;
