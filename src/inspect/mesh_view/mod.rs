//! The scene from outside: what a second camera sees of the first one, its view and what the pipeline makes of the triangles.
//!
//! The triangles themselves are drawn by the pipeline, with the second camera ([`picture`]); what explains them (the view as
//! a pyramid, the ray through the picked pixel, what was cut away) are few lines and polygons laid over that ([`drawn`]).
//! Which fate a triangle met and where it was cut is asked of the stages that did it.

mod explode;

mod hatch;

mod overlay;

mod outside;

mod picture;

use crate::image::Rgba8;
use crate::inspect::fates::{Met, Rejections};
use crate::pipeline::observe::Fate;
use crate::pipeline::settings::{Choice, Culling, Settings, choice};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, TriangleId};

pub use explode::{corners, exploded};
pub use outside::{first_view, fit, with_planes};
pub use overlay::{Kind, Look, Mark, drawn};
pub use picture::{MeshNormals, MeshPicture, Painting, paint, shown_at};

choice! {
    /// How triangles are drawn.
    MeshStyle {
        Flat = "flat", "Flat", "Each triangle in one grey, by how it is turned.";
        Wire = "wire", "Wire", "Edges alone: light where the render camera sees the front, red where it sees the back.";
        Facing = "facing", "Facing", "Which side the render camera sees, by the sign of the area on its screen: front or back.";
        Fate = "fate", "Fate", "What the pipeline made of each triangle: drawn, cut, or rejected, and why.";
        Object = "object", "Object", "One colour per object.";
    }
}

/// The first camera and how its picture is drawn: what is looked at from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inner {
    /// The render camera.
    pub camera: Camera,
    /// Its pipeline.
    pub settings: Settings,
    /// Size of its picture.
    pub viewport: Viewport,
}

impl Inner {
    /// What the render camera's pipeline does to every triangle before the rasterizer, culled in this way: another one than
    /// that of the settings may be tried.
    pub fn rejections(&self, scene: &Scene, culling: Culling) -> Rejections {
        Rejections::of(scene, &self.camera, &Settings { culling, ..self.settings }, self.viewport)
    }
}

/// The colour that stands for what a triangle met.
pub fn met_color(met: Met) -> Rgba8 {
    match met {
        Met::Drawn => [120, 168, 216, 255],
        Met::Cut => [240, 160, 48, 255],
        Met::Rejected(Fate::BackFacing | Fate::FrontFacing) => [206, 84, 84, 255],
        Met::Rejected(Fate::Outside) => [104, 104, 112, 255],
        Met::Rejected(Fate::ClippedAway) => [150, 96, 40, 255],
        Met::Rejected(Fate::ZeroArea) => [236, 220, 96, 255],
        Met::Rejected(Fate::NotFinite) => [214, 80, 214, 255],
    }
}

/// What the colours of a style mean; empty where they mean nothing but "another one".
pub fn key(style: MeshStyle) -> Vec<(&'static str, Rgba8)> {
    let fates = [
        ("drawn", Met::Drawn),
        ("cut, and drawn", Met::Cut),
        ("culled", Met::Rejected(Fate::BackFacing)),
        ("outside", Met::Rejected(Fate::Outside)),
        ("clipped away", Met::Rejected(Fate::ClippedAway)),
        ("zero area", Met::Rejected(Fate::ZeroArea)),
        ("not finite", Met::Rejected(Fate::NotFinite)),
    ];
    let sides =
        [("front", Met::Drawn), ("back", Met::Rejected(Fate::BackFacing)), ("not seen", Met::Rejected(Fate::Outside))];
    match style {
        MeshStyle::Fate => fates.map(|(name, met)| (name, met_color(met))).to_vec(),
        MeshStyle::Facing | MeshStyle::Wire => sides.map(|(name, met)| (name, met_color(met))).to_vec(),
        MeshStyle::Flat | MeshStyle::Object => Vec::new(),
    }
}

/// Whether a number of a triangle stands for one.
fn is_triangle(id: TriangleId) -> bool {
    id != TriangleId::NONE
}

#[cfg(test)]
mod tests;
