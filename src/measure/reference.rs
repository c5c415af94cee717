//! The pictures that others are measured against. A figure of error means nothing without the name of its reference.

use std::sync::Arc;

use crate::chain::{KeepDepth, Recipe, Renderer};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

choice! {
    /// A picture to measure against.
    Reference {
        Native = "native", "Native, 1 sample", "Every pixel drawn once, at its centre: what an upscaler would have to guess. It is aliased itself.";
    }
}

/// A reference that comes about step by step.
#[derive(Debug)]
pub struct Gathering {
    scene: Arc<Scene>,
    camera: Camera,
    recipe: Recipe,
    viewport: Viewport,
    picture: Option<Image<Rgba8>>,
}

impl Gathering {
    /// Draws the next sample of every pixel; false if there was none left to draw.
    pub fn step(&mut self) -> bool {
        if self.picture.is_some() {
            return false;
        }
        let Self { scene, camera, recipe, viewport, .. } = &*self;
        let frame = Renderer::default().render(scene, camera, recipe, *viewport, KeepDepth::No);
        self.picture = Some(frame.image().clone());
        true
    }

    /// Share of the samples that are drawn, in [0, 1].
    pub fn progress(&self) -> f32 {
        f32::from(u8::from(self.picture.is_some()))
    }

    /// The picture so far; black if nothing was drawn yet.
    pub fn picture(&self) -> Image<Rgba8> {
        let Viewport { width, height } = self.viewport;
        self.picture.clone().unwrap_or_else(|| Image::filled(width, height, [0, 0, 0, 255]))
    }
}

impl Reference {
    /// Begins the reference of a recipe: its pipeline, without upscaler and lines.
    pub fn begin(self, scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Gathering {
        let recipe = match self {
            Self::Native => Recipe { upscaler: Upscaling::NATIVE, wireframe: false, ..*recipe },
        };
        Gathering { scene: scene.clone(), camera: *camera, recipe, viewport, picture: None }
    }

    /// The whole reference. `go_on` is told the share that is done after each sample, and says whether to go on; if not,
    /// there is no picture.
    pub fn picture(
        self,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
        mut go_on: impl FnMut(f32) -> bool,
    ) -> Option<Image<Rgba8>> {
        let mut gathering = self.begin(scene, camera, recipe, viewport);
        while gathering.step() {
            if !go_on(gathering.progress()) {
                return None;
            }
        }
        Some(gathering.picture())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::scene::builtin;

    #[test]
    fn native_is_the_frame_of_the_recipe_without_what_comes_after() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let size = Viewport { width: 96, height: 60 };
        let upscaler = Upscaling::new("bilinear", 4).unwrap();
        let recipe = Recipe { upscaler, wireframe: true, ..Recipe::default() };
        let native = Reference::Native.picture(&scene, &scene.home, &recipe, size, |_| true).unwrap();
        assert_eq!(native, *run(&scene, &scene.home, &Recipe::default(), size, &mut ()).image());
        assert_eq!(Reference::Native.picture(&scene, &scene.home, &recipe, size, |_| false), None);
    }
}
