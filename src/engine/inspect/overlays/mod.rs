//! Overlays over any picture of a frame: edges, counts, sizes, faults. They stack in any order. Each has a legend,
//! totals, and an exact value at every pixel; the picture below never changes.
//!
//! Each group of overlays has its own module. All overlays that need an observer share one additional drawing of the
//! frame ([`watch`]), which is made on demand.

mod alpha_bleed;

mod badness;

mod blend_order;

mod discarded;

mod edges;

mod exact_owner;

mod faults;

mod fragments;

mod history;

mod junctions;

mod layer;

mod motion;

mod normals;

pub(crate) mod sheet;

mod surfaces;

mod tiles;

pub mod watch;

use std::sync::OnceLock;

pub use edges::EdgeMarks;
pub use edges::edge_marks;
pub use layer::OverlayLayer;
pub(crate) use normals::FACE_NORMAL;
pub(crate) use normals::VERTEX_NORMAL;
pub use sheet::ColorScale;
pub use sheet::Sheet;
pub use sheet::SheetLegend;
pub use sheet::Total;
pub use sheet::compose;
pub use sheet::csv;
use watch::FragmentStats;

use super::normals::DEFAULT_LENGTH;
use super::temporal::HistoryMask;
use super::view::{Range, Value};
use crate::chain::{Frame, Recipe};
use crate::image::Image;
use crate::pipeline::settings::{Choice, choice};
use crate::scene::Scene;
use crate::scene::seams::Seams;

choice! {
    /// An overlay that can be drawn over any picture of a frame.
    pub Overlay {
        Wireframe = "wireframe", "Wireframe", "Edges of all rasterized triangles after projection, before snapping: light lines over dark pixels, dark lines over light ones.";
        SnappedWireframe = "wireframe-snapped", "Wireframe, snapped", "Edges of all rasterized triangles between the corners that the rasterizer uses: in fixed point, snapped to 1/256 px.";
        VertexNormals = "vertex-normals", "Vertex normals", "Normals of all vertices of rasterized triangles as lines, not hidden by surfaces.";
        FaceNormals = "face-normals", "Face normals", "Normals of all rasterized triangles as lines from their centroids, not hidden by surfaces.";
        Motion = "motion-vectors", "Motion vectors", "Lines from pixels on a grid to where their surfaces were in the preceding frame; red where that frame does not show them.";
        RejectedHistory = "rejected-history", "Rejected history", "Pixels whose history the upscaler rejected, with precision and recall against the exact disocclusion.", also ["disocclusion mask", "ghosting"];
        ClampedHistory = "clamped-history", "Clamped history", "Pixels whose history was changed to agree with the samples around them, with precision and recall against the exact disocclusion.", also ["rectified", "ghosting"];
        LockedHistory = "locked-history", "Locked history", "Pixels whose history a lock protects from clamping, because they show a thin feature.", also ["locks"];
        Facing = "facing", "Facing", "Whether the visible triangle is front-facing or back-facing.";
        DepthTest = "depth-test", "Depth test", "Whether all, some or none of the fragments of a pixel passed the depth test when they were drawn.";
        Discarded = "discarded", "Discarded fragments", "The most frequent reason for discarding fragments of a pixel: depth test, alpha test, or face culling. Hover over a pixel to see the counts.";
        Rasterized = "rasterized", "Overdraw: rasterized",
            "Number of fragments of each pixel, whether or not they pass the depth test.";
        Passed = "passed", "Overdraw: passed", "Number of fragments of each pixel that passed the depth test when they were drawn.";
        Visible = "visible", "Overdraw: visible", "Number of fragments that contribute to the finished picture: one for opaque surfaces, more where blended surfaces lie in front.";
        TriangleSize = "triangle-size", "Triangle size", "Area of the visible triangle in px², on a logarithmic scale from 0.01 px² to the area of the picture.";
        Sliver = "sliver", "Slivers", "Smallest height of the visible triangle, in px: rounding decides the coverage of thin triangles.";
        TexelDensity = "texel-density", "Texel density", "Texels per pixel along one axis (square root of the area that a pixel covers on the texture): above 1, texels are skipped; below 1, they are magnified.";
        AlphaBleed = "alpha-bleed", "Colour bleeding", "Difference from premultiplied filtering, in sRGB codes: straight filtering takes colour from texels with alpha 0.";
        Faults = "faults", "Cracks and double hits", "Pixels along shared edges and at T-junctions that too few triangles cover (crack) or too many (double hit), without depth test.";
        Junctions = "t-junctions", "T-junctions", "Vertices within the open edge of another triangle, and vertices that lie close together but are not welded.";
        BadNumbers = "bad-numbers", "NaN, infinite, negative", "Values of the displayed quantity that are NaN, infinite, or negative.";
        Clipped = "clipped", "Clipped", "Values of the displayed quantity outside its range; for colours also the codes 0 and 255.";
        ExactOwner = "exact-owner", "Owner vs. exact", "Pixels whose visible triangle differs from that of exact arithmetic on unsnapped corners: missing if only exact arithmetic draws one, extra if only this frame does.";
        BlendOrder = "blend-order", "Wrong blending order", "Pixels where a blended fragment was drawn over a nearer one, and whether the exact order gives a different colour.";
        TileLoad = "tile-load", "Tile load", "Number of triangles binned to each 64-px tile in tiled execution.";
    }
}

/// Inputs from which overlays are computed.
pub struct OverlayContext<'a> {
    /// Scene that the frame shows.
    pub scene: &'a Scene,
    /// Recipe that the frame was drawn with.
    pub recipe: &'a Recipe,
    /// Frame for which overlays are computed.
    pub frame: &'a Frame,
    /// Whether all triangles of the frame were drawn.
    pub is_whole: bool,
    /// Cache of the fragment statistics, which are recorded by drawing the frame again on first use.
    pub stats_cache: &'a OnceLock<FragmentStats>,
    /// Open seams of the scene; `None` until the search for them is complete.
    pub seams: Option<&'a Seams>,
    /// Function that returns the displayed quantity at a pixel of the full picture.
    pub shown: &'a dyn Fn(u32, u32) -> Value,
    /// Range of the displayed quantity, if it has one.
    pub range: Option<Range>,
}

impl OverlayContext<'_> {
    /// Returns the fragment statistics of the frame. On first use, draws the frame again to record them.
    pub(crate) fn stats(&self) -> &FragmentStats {
        self.stats_cache.get_or_init(|| watch::watch(self.scene, self.recipe, self.frame))
    }

    /// Expands one number per packed sample to the pixels of the full picture; NaN at pixels that were not drawn.
    fn spread(&self, number: impl Fn(u32, u32) -> f32) -> Image<f32> {
        let (width, height) = self.frame.image().size();
        let at = |x, y| self.frame.sample_at(x, y).map_or(f32::NAN, |(column, row)| number(column, row));
        Image::from_fn(width, height, at)
    }
}

impl Overlay {
    /// Whether the overlay depends on the displayed quantity and its range.
    pub fn reads_shown(self) -> bool {
        matches!(self, Self::BadNumbers | Self::Clipped)
    }

    /// Returns the default opacity, in [0, 1]: 1 for lines and marks, less for areas, so that the picture below remains
    /// visible.
    pub(crate) fn first_opacity(self) -> f32 {
        match self {
            Self::Wireframe
            | Self::SnappedWireframe
            | Self::VertexNormals
            | Self::FaceNormals
            | Self::Motion
            | Self::Faults
            | Self::Junctions
            | Self::BadNumbers
            | Self::ExactOwner
            | Self::BlendOrder => 1.0,
            _ => 0.7,
        }
    }

    /// Whether computing the overlay may take longer than a frame, because it draws the scene with slower arithmetic.
    pub fn is_slow(self) -> bool {
        self == Self::ExactOwner
    }

    /// Whether the overlay consists of lines with an adjustable length.
    pub fn has_length(self) -> bool {
        matches!(self, Self::VertexNormals | Self::FaceNormals)
    }

    /// Whether the overlay needs the open seams of the scene.
    pub fn reads_seams(self) -> bool {
        matches!(self, Self::Faults | Self::Junctions)
    }

    /// Returns a placeholder sheet with the reason why the overlay is not ready yet.
    pub fn pending_sheet(self, context: &OverlayContext<'_>) -> Sheet {
        let why = if self.reads_seams() {
            "still searching the open edges of the scene for T-junctions"
        } else {
            "still drawing the scene with exact arithmetic"
        };
        Sheet::absent(self, context.frame.image().size(), why)
    }

    /// Computes the overlay for a frame, with the default length of normals.
    pub(crate) fn sheet(self, context: &OverlayContext<'_>) -> Sheet {
        match self {
            Self::Wireframe | Self::SnappedWireframe => edges::wireframe(self, context),
            Self::VertexNormals | Self::FaceNormals => normals::normals(self, DEFAULT_LENGTH, context),
            Self::Motion => motion::vectors(context),
            Self::RejectedHistory => history::mask(self, HistoryMask::Rejected, context),
            Self::ClampedHistory => history::mask(self, HistoryMask::Rectified, context),
            Self::LockedHistory => history::mask(self, HistoryMask::Locked, context),
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
