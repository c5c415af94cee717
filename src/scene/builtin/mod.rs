//! Scenes that need no file: each is made by code and shows one thing well.
//!
//! In: nothing. Out: a [`Scene`], the same one every time. A scene is one file that holds its name, its sentence and
//! the function that drafts it; menus, command line and tests read [`ALL`]. `shapes` and `revolve` make the meshes,
//! `textures` and `noise` the pictures, `draft` puts them together. `workload` makes scenes of any size, to measure with.
//!
//! Meshes have counter-clockwise front faces; textures are read with v downwards; colours are sRGB values.

mod black;
mod cel;
mod chess;
mod cubes;
mod draft;
mod glass;
mod near_plane;
mod noise;
mod polished;
mod revolve;
mod shapes;
mod textures;
mod triangles;
mod wheels;
pub mod workload;
mod z_fighting;

use super::Scene;
use draft::Draft;

/// A scene made by code.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Word by which recipes and the command line name it; kebab case.
    pub id: &'static str,
    /// What a person calls it; also the name of the built scene.
    pub title: &'static str,
    /// One sentence: what it is good for showing.
    pub summary: &'static str,
    draft: fn() -> Draft,
}

impl Builtin {
    /// Makes the scene. Takes some milliseconds, as textures are computed.
    pub fn build(&self) -> Scene {
        (self.draft)().finish(self.title)
    }
}

/// All built-in scenes, in the order in which menus list them. The first is the default.
pub const ALL: &[Builtin] = &[
    chess::CHESS,
    cubes::CUBES,
    cel::CEL,
    glass::STAINED_GLASS,
    polished::POLISHED,
    triangles::TRIANGLE,
    triangles::INTERPENETRATING,
    triangles::SHARED_EDGES,
    triangles::SLIVERS,
    z_fighting::Z_FIGHTING,
    near_plane::NEAR_PLANE,
    wheels::WHEELS,
    black::BACK_FACING,
    black::NEAR_CLIPPED,
    black::Z_FOUGHT,
    black::NAN_NORMAL,
    black::MISSING_TEXTURE,
];

/// Finds a scene by its [`Builtin::id`].
pub fn by_id(id: &str) -> Option<&'static Builtin> {
    ALL.iter().find(|b| b.id == id)
}

#[cfg(test)]
mod tests;
