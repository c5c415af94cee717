//! A plain scalar rasterizer in `f64`, written from the textbook and the conventions in the manual.
//!
//! It shares no code with the program. Its pictures, with and without one of the [`Fault`]s of common renderers, are
//! those of an independent renderer.
//!
//! Data flow: [`scenes`] ─► [`view`] ─► [`clip`] ─► [`coverage`] ─► [`texture`], [`color`] ─► [`frame`] ─► [`Picture`].
//! [`render()`] runs it; [`export`] writes a scene as files that the program loads.

pub(crate) mod clip;
pub(crate) mod color;
pub(crate) mod coverage;
pub(crate) mod export;
pub(crate) mod fault;
pub(crate) mod frame;
pub(crate) mod mesh;
pub(crate) mod pattern;
pub(crate) mod picture;
pub(crate) mod render;
pub(crate) mod scene;
pub(crate) mod scenes;
pub(crate) mod shapes;
pub(crate) mod texture;
pub(crate) mod view;

pub(crate) use fault::{Fault, Faults};
pub(crate) use picture::{Picture, Size};
pub(crate) use render::{render, render_with_buffers};
