//! Reference images for error metrics. An error is meaningless without the name of its reference:
//!
//! * *native* is the same recipe with one sample in every pixel; an error against it measures the effect of an
//!   approximation, such as an upscaler;
//! * *converged* is the mean of 256 samples per pixel in linear light; an error against it measures the distance from
//!   the ideal image. The native image has such an error, too.

use std::sync::Arc;

pub use crate::chain::ProgressiveRender;
use crate::chain::Recipe;
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

choice! {
    /// Reference image to measure against.
    pub Reference {
        Native = "native", "Native, 1 sample",
            "One sample at the centre of each pixel: the picture that an upscaler approximates.";
        Converged = "converged", "Converged, 256 samples",
            "The mean of 256 low-discrepancy samples of every pixel in linear light: the picture that anti-aliasing \
            approximates. Native has an error against it, too.";
    }
}

impl Reference {
    /// Returns the number of samples per pixel in the reference.
    pub fn samples(self) -> u32 {
        match self {
            Self::Native => 1,
            Self::Converged => 256,
        }
    }

    /// Begins to render the reference for a recipe. The reference uses the recipe's pipeline, but no upscaler, post
    /// filter or wireframe.
    pub fn begin(self, scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> ProgressiveRender {
        ProgressiveRender::new(scene, camera, recipe, viewport, self.samples())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::image::{Image, Rgba8};
    use crate::measure::error::compare;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 96, height: 60 };

    fn rmse(a: &Image<Rgba8>, b: &Image<Rgba8>) -> f64 {
        compare(a, b).map_or(f64::NAN, |error| error.mse).sqrt()
    }

    fn complete(mut render: ProgressiveRender) -> Image<Rgba8> {
        while render.step() {}
        render.picture()
    }

    #[test]
    fn native_is_the_frame_without_upscaler_and_post_filter() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let upscaler = Upscaling::new("bilinear", 4).unwrap();
        let recipe = Recipe { upscaler, wireframe: true, ..Recipe::default() };
        let native = complete(Reference::Native.begin(&scene, &scene.home, &recipe, SIZE));
        assert_eq!(native, *run(&scene, &scene.home, &Recipe::default(), SIZE, &mut ()).image());
    }

    #[test]
    fn the_converged_picture_has_converged() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let of = |samples| complete(ProgressiveRender::new(&scene, &scene.home, &Recipe::default(), SIZE, samples));
        let converged = complete(Reference::Converged.begin(&scene, &scene.home, &Recipe::default(), SIZE));
        assert_eq!(converged, of(256));
        let errors = [1, 4, 16, 64].map(|samples| rmse(&of(samples), &converged));
        assert!(errors.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{errors:?}");
        assert!(errors[3] < 0.1 * errors[0], "{errors:?}");
    }
}
