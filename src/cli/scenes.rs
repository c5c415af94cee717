//! `rasterscope scenes`: lists the built-in scenes.

use crate::scene::builtin;
use clap::Args;

use super::failure::Failure;
use super::output;

/// List the built-in scenes
#[derive(Args, Debug)]
#[command(after_help = super::example("scenes"))]
pub(crate) struct ScenesArgs {}

/// Runs `scenes`: prints the built-in scenes with their triangle counts.
pub(crate) fn run(_args: &ScenesArgs) -> Result<(), Failure> {
    let width = builtin::ALL.iter().map(|b| b.id.len()).max().unwrap_or(0);
    let lines = builtin::ALL.iter().map(|b| {
        let triangles = b.build().triangle_count();
        format!("{:width$}  {triangles:>7} triangles  {}\n", b.id, b.summary)
    });
    output::print(&lines.collect::<String>())
}
