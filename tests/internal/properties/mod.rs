//! Property tests of the pipeline, which check seeded random input against oracles that share no code with it. A
//! failure prints its seed.

mod coverage;
mod depth;
mod hits;
mod interpolation;
mod junctions;
mod robustness;
mod switches;
mod transparency;
