//! Anti-aliasing: sample patterns, resolve of samples, area coverage, and filters over finished pictures.

pub(crate) mod area;

pub(crate) mod fxaa;

mod luma;

pub(crate) mod mask;

pub mod pattern;

pub(crate) mod post;

pub(crate) mod resolve;

pub mod settings;

pub(crate) mod smaa;

pub(crate) mod weight;
