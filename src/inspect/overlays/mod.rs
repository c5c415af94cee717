//! What can be laid over any picture of a frame: edges, counts, sizes, faults. Overlays stack in any order, each with a
//! legend, with totals, and with an exact value at every pixel; what lies below is never changed.
//!
//! A file for each group. All that watches the frame being drawn shares one more drawing of it ([`watch`]), which is made
//! only when it is asked for.

mod alpha_bleed;

mod badness;

mod blend_order;

mod discarded;

mod edges;

mod exact_owner;

mod faults;

mod fragments;

mod junctions;

mod layer;

mod normals;

pub mod sheet;

mod surfaces;

mod tiles;

pub mod watch;

use std::sync::OnceLock;

pub use edges::{EdgeMarks, edge_marks};
pub use layer::Layer;
pub use normals::{FACE_NORMAL, VERTEX_NORMAL};
pub use sheet::{Key, Kind, Scale, Sheet, Total, compose, csv};
use watch::Watched;

use super::normals::DEFAULT_LENGTH;
use super::view::{Range, Value};
use crate::chain::{Frame, Recipe};
use crate::image::Image;
use crate::pipeline::settings::{Choice, choice};
use crate::scene::Scene;
use crate::scene::seams::Seams;

choice! {
    /// What is laid over the picture.
    Overlay {
        Wireframe = "wireframe", "Wireframe", "Edges of all rasterized triangles where projection put them, before corners were snapped; light on dark and dark on light.";
        SnappedWireframe = "wireframe-snapped", "Wireframe, snapped", "The same edges between the corners that the rasterizer works with, snapped to 1/256 px in fixed point.";
        VertexNormals = "vertex-normals", "Vertex normals", "Normals of all vertices of rasterized triangles as lines, which surfaces do not hide.";
        FaceNormals = "face-normals", "Face normals", "Normals of all rasterized triangles as lines from their centroids, which surfaces do not hide.";
        Facing = "facing", "Facing", "Whether the triangle that is seen shows its front or its back.";
        DepthTest = "depth-test", "Depth test", "Whether all fragments of a pixel passed the depth test when they came, or some were rejected.";
        Discarded = "discarded", "Discarded fragments", "Which reason discarded most fragments of a pixel: depth test, alpha test, or culling of the side that their triangle shows. Hover a pixel for the counts.";
        Rasterized = "rasterized", "Overdraw: rasterized", "Fragments of each pixel, drawn or not.";
        Passed = "passed", "Overdraw: passed", "Fragments of each pixel that passed the depth test when they came.";
        Visible = "visible", "Overdraw: visible", "Fragments that are still seen in the end: one where something opaque is seen, more where panes are looked through.";
        TriangleSize = "triangle-size", "Triangle size", "Area of the triangle that is seen, in px², from a hundredth of a pixel to the whole picture.";
        Sliver = "sliver", "Slivers", "Least height of the triangle that is seen, in px: thin ones are where rounding decides.";
        TexelDensity = "texel-density", "Texel density", "Texels per pixel along a side: above 1 texels are skipped, below 1 they are enlarged.";
        AlphaBleed = "alpha-bleed", "Colour bleeding", "Codes by which colour differs from what premultiplied filtering gives: straight filtering takes colour from texels with alpha 0.";
        Faults = "faults", "Cracks and double hits", "Pixels along shared edges, and at T-junctions, that no triangle draws, or two do, without depth test.";
        Junctions = "t-junctions", "T-junctions", "Vertices within the open edge of another triangle, and vertices that lie close together without being the same.";
        BadNumbers = "bad-numbers", "NaN, infinite, negative", "Values of the shown quantity that are not a number, not finite, or below zero.";
        Clipped = "clipped", "Clipped", "Values of the shown quantity beyond the ends of its range; codes of colours at 0 and 255, too.";
        ExactOwner = "exact-owner", "Owner against exact", "Pixels that show another triangle than exact arithmetic on unsnapped corners would: missing where only that one draws, extra where only this frame does.";
        BlendOrder = "blend-order", "Wrong blending order", "Pixels where a blended fragment was drawn over a nearer one, and whether the exact order gives another colour there.";
        TileLoad = "tile-load", "Tile load", "Triangles that each 64-px tile of the tiled way is handed.";
    }
}

/// What overlays are made from.
pub struct Context<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How the frame was drawn.
    pub recipe: &'a Recipe,
    /// The frame.
    pub frame: &'a Frame,
    /// Whether all of its triangles were drawn.
    pub is_whole: bool,
    /// The watched drawing, made when it is first needed.
    pub watched: &'a OnceLock<Watched>,
    /// Open seams of the scene; none while they are searched for.
    pub seams: Option<&'a Seams>,
    /// The quantity that is shown, at a pixel of the full picture.
    pub shown: &'a dyn Fn(u32, u32) -> Value,
    /// The range that it is shown with.
    pub range: Option<Range>,
}

impl Context<'_> {
    /// What was seen while the frame was drawn once more.
    pub fn watched(&self) -> &Watched {
        self.watched.get_or_init(|| watch::watch(self.scene, self.recipe, self.frame))
    }

    /// A number for each pixel of the full picture from one for each packed sample; NaN where nothing was drawn.
    fn spread(&self, number: impl Fn(u32, u32) -> f32) -> Image<f32> {
        let (width, height) = self.frame.image().size();
        let at = |x, y| self.frame.sample_at(x, y).map_or(f32::NAN, |(column, row)| number(column, row));
        Image::from_fn(width, height, at)
    }
}

impl Overlay {
    /// Whether it depends on which quantity is shown and on its range.
    pub fn reads_shown(self) -> bool {
        matches!(self, Self::BadNumbers | Self::Clipped)
    }

    /// How strong it is at first, in [0, 1]: lines wholly, areas so that the picture below is still seen.
    pub fn first_opacity(self) -> f32 {
        match self {
            Self::Wireframe
            | Self::SnappedWireframe
            | Self::VertexNormals
            | Self::FaceNormals
            | Self::Faults
            | Self::Junctions
            | Self::BadNumbers
            | Self::ExactOwner
            | Self::BlendOrder => 1.0,
            _ => 0.7,
        }
    }

    /// Whether it may take longer than a frame should: the scene is drawn once more by slower arithmetic.
    pub fn is_slow(self) -> bool {
        self == Self::ExactOwner
    }

    /// Whether it is lines of a length that can be set.
    pub fn has_length(self) -> bool {
        matches!(self, Self::VertexNormals | Self::FaceNormals)
    }

    /// Whether it needs the open seams of the scene.
    pub fn reads_seams(self) -> bool {
        matches!(self, Self::Faults | Self::Junctions)
    }

    /// What stands for it while it is being made.
    pub fn unmade(self, context: &Context<'_>) -> Sheet {
        let why = if self.reads_seams() {
            "not yet, as the open edges of the scene are still being searched for T-junctions"
        } else {
            "not yet, as the scene is still being drawn once more with exact arithmetic"
        };
        Sheet::absent(self, context.frame.image().size(), why)
    }

    /// Makes it for a frame, as it is at first.
    pub fn sheet(self, context: &Context<'_>) -> Sheet {
        match self {
            Self::Wireframe | Self::SnappedWireframe => edges::wireframe(self, context),
            Self::VertexNormals | Self::FaceNormals => normals::normals(self, DEFAULT_LENGTH, context),
            Self::Facing => surfaces::facing(context),
            Self::DepthTest => fragments::depth_test(context),
            Self::Discarded => discarded::discarded(context),
            Self::Rasterized | Self::Passed | Self::Visible => fragments::count(self, context),
            Self::TriangleSize => surfaces::size(context),
            Self::Sliver => surfaces::sliver(context),
            Self::TexelDensity => surfaces::texel_density(context),
            Self::AlphaBleed => alpha_bleed::alpha_bleed(context),
            Self::Faults => faults::faults(context),
            Self::Junctions => junctions::junctions(context),
            Self::BadNumbers => badness::bad_numbers(context),
            Self::Clipped => badness::clipped(context),
            Self::ExactOwner => exact_owner::exact_owner(context),
            Self::BlendOrder => blend_order::blend_order(context),
            Self::TileLoad => tiles::load(context),
        }
    }
}

#[cfg(test)]
mod tests;
