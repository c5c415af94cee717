//! Tests that span several modules of the engine. They are compiled into it, because most of them need its internals.

mod bad_input;
mod cases;
pub(crate) mod common;
mod depth_cases;
mod exact_cases;
mod fate_sums;
mod fates;
mod gltf;
pub(crate) mod gltf_builder;
mod gltf_motion;
mod golden;
mod models;
mod motion;
mod properties;
mod replay;
pub(crate) mod samples;
pub(crate) mod scene_builder;
mod settings;
mod shading;
pub(crate) mod sound;
mod stability_oracle;
mod statements;
pub(crate) mod switches;
mod tiled;
mod trace;
