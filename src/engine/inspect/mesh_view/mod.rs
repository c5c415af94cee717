//! The mesh view: the scene, the render camera's frustum and the fates of the triangles, as seen by a second camera.
//!
//! The pipeline draws the triangles with the second camera ([`paint`]). The frustum, the ray through the picked pixel
//! and the clipped parts are drawn as lines and polygons in an overlay ([`drawn`]). The geometry stages themselves
//! report the fate of each triangle and where it was clipped.

mod explode;

mod hatch;

mod overlay;

mod outside;

mod picture;

use crate::image::Rgba8;
use crate::inspect::fates::{GeometryOutcome, Rejections};
use crate::pipeline::observe::Fate;
use crate::pipeline::settings::{Choice, Culling, Settings, choice};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, TriangleId};

pub(crate) use explode::corners;
pub(crate) use explode::exploded;
pub use outside::first_view;
pub use outside::fit;
pub use outside::with_planes;
pub use overlay::MarkKind;
pub use overlay::MeshMark;
pub use overlay::OverlayInputs;
pub use overlay::drawn;
pub use picture::MeshNormals;
pub use picture::Painting;
pub use picture::paint;
pub use picture::shown_at;

choice! {
    /// Style in which the mesh view draws triangles.
    pub MeshStyle {
        Flat = "flat", "Flat", "Flat-shaded in grey, by the orientation of each triangle.";
        Wire = "wire", "Wire", "Edges only: blue if front-facing for the render camera, red if back-facing.";
        Facing = "facing", "Facing",
            "Side facing the render camera, by the sign of the screen-space area: front or back.";
        Fate = "fate", "Fate", "Fate of each triangle in the pipeline: drawn, clipped, or rejected, and why.";
        Object = "object", "Object", "One colour per object.";
    }
}

/// The render camera that the second camera looks at, with its settings and picture size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inner {
    /// Camera that renders the inspected frame.
    pub camera: Camera,
    /// Pipeline settings of the render camera.
    pub settings: Settings,
    /// Size of the render camera's picture, in pixels.
    pub viewport: Viewport,
}

impl Inner {
    /// Runs the geometry stages of the render camera with this culling mode, and returns the rejected and clipped
    /// triangles. The mode may differ from the one in the settings.
    pub(crate) fn rejections(&self, scene: &Scene, culling: Culling) -> Rejections {
        Rejections::of(scene, &self.camera, &Settings { culling, ..self.settings }, self.viewport)
    }
}

/// Returns the display colour of a triangle with this outcome of the geometry stages.
pub(crate) fn met_color(met: GeometryOutcome) -> Rgba8 {
    match met {
        GeometryOutcome::Drawn => [120, 168, 216, 255],
        GeometryOutcome::Cut => [240, 160, 48, 255],
        GeometryOutcome::Rejected(Fate::BackFacing | Fate::FrontFacing) => [206, 84, 84, 255],
        GeometryOutcome::Rejected(Fate::Outside) => [104, 104, 112, 255],
        GeometryOutcome::Rejected(Fate::ClippedAway) => [150, 96, 40, 255],
        GeometryOutcome::Rejected(Fate::ZeroArea) => [236, 220, 96, 255],
        GeometryOutcome::Rejected(Fate::NotFinite) => [214, 80, 214, 255],
    }
}

/// Returns the legend of a style as names and colours; empty if the colours only distinguish triangles or objects.
pub fn key(style: MeshStyle) -> Vec<(&'static str, Rgba8)> {
    let fates = [
        ("drawn", GeometryOutcome::Drawn),
        ("clipped, drawn", GeometryOutcome::Cut),
        ("culled", GeometryOutcome::Rejected(Fate::BackFacing)),
        ("outside", GeometryOutcome::Rejected(Fate::Outside)),
        ("clipped away", GeometryOutcome::Rejected(Fate::ClippedAway)),
        ("zero area", GeometryOutcome::Rejected(Fate::ZeroArea)),
        ("not finite", GeometryOutcome::Rejected(Fate::NotFinite)),
    ];
    let sides = [
        ("front", GeometryOutcome::Drawn),
        ("back", GeometryOutcome::Rejected(Fate::BackFacing)),
        ("outside", GeometryOutcome::Rejected(Fate::Outside)),
    ];
    match style {
        MeshStyle::Fate => fates.map(|(name, met)| (name, met_color(met))).to_vec(),
        MeshStyle::Facing | MeshStyle::Wire => sides.map(|(name, met)| (name, met_color(met))).to_vec(),
        MeshStyle::Flat | MeshStyle::Object => Vec::new(),
    }
}

/// Whether an id refers to a triangle, not to the background.
fn is_triangle(id: TriangleId) -> bool {
    id != TriangleId::NONE
}

#[cfg(test)]
mod tests;
