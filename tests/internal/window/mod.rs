//! Tests that drive the window through its accessibility tree, without a display.

mod appearance;
mod arithmetic;
mod bench;
mod camera;
mod comparing;
mod context;
mod fates;
mod files;
mod growth;
mod history;
mod lab;
mod manual;
mod measuring;
mod outside;
mod overlays;
mod picking;
mod places;
mod ranges;
mod scrubbing;
mod settings;
mod stepping;
mod strip;
mod tradeoff;
mod watching;
mod what_if;
mod workspaces;
