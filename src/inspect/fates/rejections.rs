//! What the geometry stages do to every triangle, asked of the stages themselves: which were rejected, and why, and which
//! were cut.

use crate::pipeline::observe::{Fate, Observer};
use crate::pipeline::prepare;
use crate::pipeline::settings::Settings;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, TriangleId};

/// What becomes of a triangle before the rasterizer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// It reaches the rasterizer as it is.
    Drawn,
    /// It is cut, and what is left reaches the rasterizer.
    Cut,
    /// It ends before.
    Rejected(Fate),
}

/// Triangles that the geometry stages rejected or cut: an observer of these stages.
#[derive(Clone, Debug)]
pub struct Rejections {
    /// Why each triangle of the scene was rejected, if it was.
    pub(super) fates: Vec<Option<Fate>>,
    /// Triangles that were rejected more than once: there must be none.
    pub(super) again: Vec<TriangleId>,
    /// Triangles that crossed a plane of the view and were cut, ascending.
    pub(super) cut: Vec<TriangleId>,
}

impl Rejections {
    /// Nothing seen yet, of so many triangles.
    pub fn new(triangles: usize) -> Self {
        Self { fates: vec![None; triangles], again: Vec::new(), cut: Vec::new() }
    }

    /// By running the stages for a view of a scene.
    pub fn of(scene: &Scene, camera: &Camera, settings: &Settings, viewport: Viewport) -> Self {
        let mut rejections = Self::new(scene.triangle_count());
        prepare(scene, camera, settings, viewport, &mut rejections);
        rejections
    }

    /// Whether a triangle was cut, whatever became of its pieces.
    pub fn is_cut(&self, id: TriangleId) -> bool {
        self.cut.binary_search(&id).is_ok()
    }

    /// What every triangle met, in the order of the scene.
    pub fn met(&self) -> impl Iterator<Item = Met> {
        let met = |(fate, id): (&Option<Fate>, u32)| match fate {
            Some(fate) => Met::Rejected(*fate),
            None if self.is_cut(TriangleId(id)) => Met::Cut,
            None => Met::Drawn,
        };
        self.fates.iter().zip(0..).map(met)
    }
}

impl Observer for Rejections {
    fn rejected(&mut self, id: TriangleId, fate: Fate) {
        if let Some(place) = self.fates.get_mut(id.0 as usize)
            && place.replace(fate).is_some()
        {
            self.again.push(id);
        }
    }

    fn clipped(&mut self, id: TriangleId, _pieces: usize) {
        self.cut.push(id);
    }
}
