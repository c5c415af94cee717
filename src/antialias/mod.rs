//! Smooth edges: where a pixel is sampled, how samples become its colour, what share of it a shape covers, and filters over
//! finished pictures.

pub mod area;

pub mod fxaa;

pub mod mask;

pub mod pattern;

pub mod post;

pub mod resolve;

pub mod settings;

pub mod weight;
