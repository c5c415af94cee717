//! Observer that records which triangles the geometry stages clip, which they reject, and the reason for each
//! rejection.

use crate::pipeline::observe::{Fate, Observer};
use crate::pipeline::prepare;
use crate::pipeline::settings::Settings;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, TriangleId};

/// Result of the geometry stages for a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GeometryOutcome {
    /// The triangle reaches the rasterizer unclipped.
    Drawn,
    /// The triangle is clipped, and the remaining pieces reach the rasterizer.
    Cut,
    /// The triangle is rejected.
    Rejected(Fate),
}

/// Observer that records which triangles the geometry stages clip, which they reject, and the reason for each
/// rejection.
#[derive(Clone, Debug)]
pub(crate) struct Rejections {
    /// Reason for rejection of each triangle of the scene; `None` if it was not rejected.
    pub(super) fates: Vec<Option<Fate>>,
    /// Triangles that were rejected more than once; empty unless the pipeline has a bug.
    pub(super) rejected_again: Vec<TriangleId>,
    /// Triangles that crossed a frustum plane and were clipped, ascending.
    pub(super) cut: Vec<TriangleId>,
}

impl Rejections {
    /// Creates an empty record for a scene with this number of triangles.
    pub(crate) fn new(triangles: usize) -> Self {
        Self { fates: vec![None; triangles], rejected_again: Vec::new(), cut: Vec::new() }
    }

    /// Runs the geometry stages for a view of a scene and records the rejected and clipped triangles.
    pub(crate) fn of(scene: &Scene, camera: &Camera, settings: &Settings, viewport: Viewport) -> Self {
        let mut rejections = Self::new(scene.triangle_count());
        prepare(scene, camera, settings, viewport, &mut rejections);
        rejections
    }

    /// Whether a triangle was clipped, regardless of the fate of its pieces.
    pub(crate) fn is_cut(&self, id: TriangleId) -> bool {
        self.cut.binary_search(&id).is_ok()
    }

    /// Returns the outcome of the geometry stages for every triangle, in scene order.
    pub(crate) fn outcomes(&self) -> impl Iterator<Item = GeometryOutcome> {
        let met = |(fate, id): (&Option<Fate>, u32)| match fate {
            Some(fate) => GeometryOutcome::Rejected(*fate),
            None if self.is_cut(TriangleId(id)) => GeometryOutcome::Cut,
            None => GeometryOutcome::Drawn,
        };
        self.fates.iter().zip(0..).map(met)
    }
}

impl Observer for Rejections {
    fn rejected(&mut self, id: TriangleId, fate: Fate) {
        if let Some(place) = self.fates.get_mut(id.0 as usize)
            && place.replace(fate).is_some()
        {
            self.rejected_again.push(id);
        }
    }

    fn clipped(&mut self, id: TriangleId, _pieces: usize) {
        self.cut.push(id);
    }
}
