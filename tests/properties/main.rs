//! Properties of every scene, tested with seeded random input against oracles that share no code with the pipeline. A
//! failure prints its seed.

#[path = "../common/mod.rs"]
mod common;

mod coverage;
mod depth;
mod hits;
mod interpolation;
mod junctions;
mod robustness;
mod switches;
mod transparency;
