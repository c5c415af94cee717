//! Triangles without a fragment at a pixel, as records with the reason.

use serde::Serialize;

use super::{FragmentRecord, PixelReport};
use crate::pipeline::settings::{Choice, choice};
use crate::scene::TriangleId;

choice! {
    /// Outcome of a triangle at a pixel. The history of the pixel can be filtered by these outcomes.
    pub Kind {
        Passed = "passed", "Passed", "Fragments that were written, whether or not they are still visible.";
        Failed = "failed", "Failed", "Fragments that failed the depth test or the alpha test.";
        Culled = "culled", "Culled", "Triangles that would cover the pixel but were removed earlier: by culling, for zero area, or by the triangle slider.";
        Clipped = "clipped", "Clipped", "Triangles clipped here by the near or far plane, and triangles with a NaN or infinite corner.";
        Missed = "missed", "Missed", "Triangles near the pixel that do not cover its centre: the nearest 40, nearest first.";
    }
}

impl Kind {
    /// Returns [`Kind::Passed`] for a fragment that was written, otherwise [`Kind::Failed`].
    pub fn of(fragment: &FragmentRecord) -> Self {
        if fragment.outcome.is_written() { Self::Passed } else { Self::Failed }
    }

    /// Returns the number of fragments and absent triangles with this outcome in a report.
    pub fn count(self, report: &PixelReport) -> usize {
        let fragments = report.fragments.iter().filter(|fragment| Self::of(fragment) == self);
        fragments.count() + report.absent.iter().filter(|absent| absent.cause.kind() == self).count()
    }
}

/// Reason why a triangle has no fragment at a pixel. The order is the order of display, the most relevant cause first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The triangle covers the pixel but is back-facing, and back faces are culled.
    BackFacing,
    /// The triangle covers the pixel but is front-facing, and front faces are culled.
    FrontFacing,
    /// The triangle would cover the pixel, but lies in front of the near plane there.
    NearPlane,
    /// The triangle covers the pixel but comes after the last drawn triangle.
    NotDrawnYet,
    /// The pixel's centre lies on an edge that the fill rule does not assign to the triangle.
    Tie,
    /// The pixel's centre lies inside the triangle, but the rasterizer skips the pixel because of its algorithm or
    /// because of rounding.
    Skipped,
    /// The triangle would cover the pixel, but lies beyond the far plane there.
    FarPlane,
    /// A corner of the triangle is NaN or infinite, so the triangle is not drawn at any pixel.
    NotFinite,
    /// The triangle passes through the pixel's centre, but its corners are collinear after snapping.
    ZeroArea,
    /// The pixel's centre lies outside the triangle.
    Missed,
}

impl Cause {
    /// Returns the display name of the cause, in one to three words.
    pub fn name(self) -> &'static str {
        match self {
            Self::BackFacing => "back-facing",
            Self::FrontFacing => "front-facing",
            Self::NearPlane => "near plane",
            Self::NotDrawnYet => "not drawn yet",
            Self::Tie => "edge tie",
            Self::Skipped => "skipped",
            Self::FarPlane => "far plane",
            Self::NotFinite => "not finite",
            Self::ZeroArea => "zero area",
            Self::Missed => "missed",
        }
    }

    /// Returns the outcome of a triangle that is absent from a pixel for this reason.
    pub fn kind(self) -> Kind {
        match self {
            Self::BackFacing | Self::FrontFacing | Self::ZeroArea | Self::NotDrawnYet => Kind::Culled,
            Self::NearPlane | Self::FarPlane | Self::NotFinite => Kind::Clipped,
            Self::Tie | Self::Skipped | Self::Missed => Kind::Missed,
        }
    }
}

/// A triangle without a fragment at a pixel, and the reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Absent {
    /// Triangle that has no fragment at the pixel.
    pub triangle: TriangleId,
    /// Name of the instance that the triangle belongs to.
    pub instance: String,
    /// Index of the triangle in the list of rasterized triangles; `None` if it was dropped earlier.
    pub submission: Option<usize>,
    /// Reason why the triangle has no fragment, for filters and sorting.
    pub cause: Cause,
    /// Reason as one sentence with the decisive number. The subject, the triangle, is omitted: the text begins with
    /// “covers”, “misses” or a similar verb.
    pub reason: String,
    /// Corners that determine coverage, in px; `None` if the triangle has no position on the screen.
    pub corners_px: Option<[[f32; 2]; 3]>,
    /// Distance from the pixel's centre to the triangle, in px; `None` if the triangle was not rasterized. In fixed
    /// point, this is the distance to the triangle with snapped corners, and only the final root and quotient are
    /// rounded.
    pub distance_px: Option<f64>,
    /// Edge function values at the pixel's centre, in the unit of the arithmetic; `None` if the triangle was not
    /// rasterized.
    pub edges: Option<[f64; 3]>,
}
