//! Tells the engine how it is optimised, because times of other builds are not representative.

use std::env::var;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Cargo sets the variable for every build script.
    println!("cargo::rustc-env=RASTERSCOPE_OPT_LEVEL={}", var("OPT_LEVEL").unwrap_or_default());
}
