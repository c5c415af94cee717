//! What became of every triangle before the rasterizer, asked of the stages themselves.

use super::Inner;
use crate::pipeline::observe::{Fate, Observer};
use crate::pipeline::prepare;
use crate::pipeline::settings::{Culling, Settings};
use crate::scene::{Scene, TriangleId};

/// What a triangle met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// It reached the rasterizer as it is.
    Drawn,
    /// It was cut, and what is left reached the rasterizer.
    Cut,
    /// It ended before.
    Rejected(Fate),
}

struct Meetings(Vec<Met>);

impl Meetings {
    fn set(&mut self, id: TriangleId, met: Met) {
        if let Some(place) = self.0.get_mut(id.0 as usize) {
            *place = met;
        }
    }
}

impl Observer for Meetings {
    fn rejected(&mut self, id: TriangleId, fate: Fate) {
        self.set(id, Met::Rejected(fate));
    }

    fn clipped(&mut self, id: TriangleId, _pieces: usize) {
        self.set(id, Met::Cut);
    }
}

/// What every triangle of the scene met, by its number. With `culling` another one than that of the settings may be tried.
pub fn fates(scene: &Scene, inner: &Inner, culling: Culling) -> Vec<Met> {
    let mut met = Meetings(vec![Met::Drawn; scene.triangle_count()]);
    let settings = Settings { culling, ..inner.settings };
    prepare(scene, &inner.camera, &settings, inner.viewport, &mut met);
    met.0
}
