//! Smooth edges: what share of a pixel a shape covers.

pub mod area;

pub mod weight;
