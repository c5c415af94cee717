//! Reference images for error metrics. An error is meaningless without the name of its reference:
//!
//! * *native* is the same recipe with one sample in every pixel; an error against it is what an approximation changed;
//! * *converged* is the mean of 256 samples per pixel in linear light; an error against it is the distance from the
//!   ideal image, and native has such an error, too.

use std::sync::Arc;

use crate::chain::Recipe;
pub(crate) use crate::chain::samples::ProgressiveRender;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

choice! {
    /// Reference image to measure against.
    Reference {
        Native = "native", "Native, 1 sample",
            "One sample at the centre of each pixel: the picture that an upscaler approximates.";
        Converged = "converged", "Converged, 256 samples",
            "The mean of 256 low-discrepancy samples of every pixel in linear light: the picture that anti-aliasing \
            approximates. Native has an error against it, too.";
    }
}

impl Reference {
    /// Returns the number of samples per pixel.
    pub fn samples(self) -> u32 {
        match self {
            Self::Native => 1,
            Self::Converged => 256,
        }
    }

    /// Begins to render the reference of a recipe: its pipeline without upscaler, post filter and wireframe.
    pub(crate) fn begin(
        self,
        scene: &Arc<Scene>,
        camera: &Camera,
        recipe: &Recipe,
        viewport: Viewport,
    ) -> ProgressiveRender {
        ProgressiveRender::new(scene, camera, recipe, viewport, self.samples())
    }

    /// Renders the complete reference. `go_on` receives the completed fraction in [0, 1] after each sample and returns
    /// whether to continue; the result is `None` if it returns `false`.
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
    use crate::measure::error::compare;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 96, height: 60 };

    fn rmse(a: &Image<Rgba8>, b: &Image<Rgba8>) -> f64 {
        compare(a, b).map_or(f64::NAN, |error| error.mse).sqrt()
    }

    #[test]
    fn native_is_the_frame_without_upscaler_and_post_filter() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let upscaler = Upscaling::new("bilinear", 4).unwrap();
        let recipe = Recipe { upscaler, wireframe: true, ..Recipe::default() };
        let native = Reference::Native.picture(&scene, &scene.home, &recipe, SIZE, |_| true).unwrap();
        assert_eq!(native, *run(&scene, &scene.home, &Recipe::default(), SIZE, &mut ()).image());
    }

    #[test]
    fn the_converged_picture_has_converged() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let of = |samples| {
            let mut gathering = ProgressiveRender::new(&scene, &scene.home, &Recipe::default(), SIZE, samples);
            while gathering.step() {}
            gathering.picture()
        };
        let converged = Reference::Converged.picture(&scene, &scene.home, &Recipe::default(), SIZE, |_| true).unwrap();
        assert_eq!(converged, of(256));
        let errors = [1, 4, 16, 64].map(|samples| rmse(&of(samples), &converged));
        assert!(errors.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{errors:?}");
        assert!(errors[3] < 0.1 * errors[0], "{errors:?}");
    }

    #[test]
    fn rendering_stops_when_cancelled() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let mut told = Vec::new();
        let stopped = Reference::Converged.picture(&scene, &scene.home, &Recipe::default(), SIZE, |progress| {
            told.push(progress);
            told.len() < 3
        });
        assert_eq!(stopped, None);
        assert_eq!(told, [1.0, 2.0, 3.0].map(|samples| samples / 256.0));
    }
}
