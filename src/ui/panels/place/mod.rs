//! Menu and dialog of the bookmarks.

pub(crate) mod bookmarks;
pub(crate) mod menu;
