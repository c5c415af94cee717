//! Anti-aliasing: sample patterns, resolve of samples, area coverage, and filters over finished pictures.

pub mod area;

pub mod fxaa;

pub mod mask;

pub mod pattern;

pub mod post;

pub mod resolve;

pub mod settings;

pub mod weight;
