//! “Why is this pixel black?”: built-in scenes, each with settings that produce a dark spot.
//!
//! The solution of a lesson is to inspect the dark pixel: its verdict names the cause.

use crate::chain::Recipe;
use crate::image::Rgba8;

/// Greatest sRGB code that counts as black: on a screen in a lit room, lower codes are indistinguishable from 0.
pub(crate) const BLACK_CODE: u8 = 12;

/// Whether all channels of a colour are at most [`BLACK_CODE`].
pub fn is_black([r, g, b, _]: Rgba8) -> bool {
    r.max(g).max(b) <= BLACK_CODE
}

/// A built-in scene with settings that produce a black spot, and a question about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlackPixelLesson {
    /// Id of the built-in scene.
    pub scene: &'static str,
    /// Question about the visible artefact.
    pub question: &'static str,
    /// Settings that differ from the default recipe, as `key=value` assignments.
    pub(crate) settings: &'static [&'static str],
    /// Position of the black spot, as fractions of the picture's width and height.
    pub(crate) place: [f32; 2],
    /// Part of the pixel's verdict that names the cause of the black spot.
    pub cause: &'static str,
}

/// All lessons, ordered by the pipeline stage of their causes.
pub const ALL: &[BlackPixelLesson] = &[
    BlackPixelLesson {
        scene: "near-clipped",
        question: "Why does the floor end too early?",
        settings: &[],
        place: [0.5, 0.9],
        cause: "in front of the near plane",
    },
    BlackPixelLesson {
        scene: "back-facing",
        question: "Where is the middle panel?",
        settings: &[],
        place: [0.5, 0.5],
        cause: "is back-facing",
    },
    BlackPixelLesson {
        scene: "z-fought",
        question: "What are the stripes on the poster?",
        settings: &[],
        place: [0.5, 0.5],
        cause: "have exactly the same depth",
    },
    BlackPixelLesson {
        scene: "nan-normal",
        question: "What is the dark patch on the ball?",
        settings: &["light.ambient=0"],
        place: [0.31, 0.36],
        cause: "is not finite (NaN)",
    },
    BlackPixelLesson {
        scene: "missing-texture",
        question: "Why is the right crate black?",
        settings: &[],
        place: [0.68, 0.5],
        cause: "could not be read",
    },
];

impl BlackPixelLesson {
    /// Returns the default recipe with the lesson's settings.
    pub fn recipe(&self) -> Recipe {
        let mut recipe = Recipe::default();
        // A test covers each setting; an invalid one would leave the default unchanged.
        let _ = recipe.set_all(self.settings);
        recipe
    }

    /// Returns the black pixel nearest to the lesson's spot; `None` if no pixel is black.
    pub fn black_pixel(&self, frame: &crate::chain::Frame) -> Option<(u32, u32)> {
        let (width, height) = (frame.viewport.width, frame.viewport.height);
        let [x, y] = [self.place[0] * width as f32, self.place[1] * height as f32].map(|at| at as u32);
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let black = pixels.filter(|(x, y)| is_black(frame.image().at(*x, *y)));
        black.min_by_key(|pixel| pixel.0.abs_diff(x).pow(2) + pixel.1.abs_diff(y).pow(2))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::{KeepDepth, RenderInputs, Renderer, run};
    use crate::inspect::{Survey, explain};
    use crate::pipeline::settings::Shading;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    #[test]
    fn surfaces_without_normals_look_the_same_drawn_by_tiles_and_by_triangles() {
        let scene = Arc::new(builtin::by_id("nan-normal").unwrap().build());
        let view = Viewport { width: 120, height: 75 };
        for shading in [Shading::Lambert, Shading::Gouraud, Shading::Normals, Shading::Cel] {
            let mut recipe = Recipe::default();
            recipe.pipeline.shading = shading;
            let tiled = Renderer::default().render(
                RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: view },
                KeepDepth::Yes,
            );
            let classic = run(&scene, &scene.home, &recipe, view, &mut ());
            assert_eq!(tiled.image(), classic.image(), "{shading:?}");
        }
    }

    #[test]
    fn the_verdict_at_each_black_spot_names_the_cause_at_any_size() {
        for lesson in ALL {
            assert!(Recipe::default().set_all(lesson.settings).is_ok(), "{}", lesson.scene);
            let scene = builtin::by_id(lesson.scene).unwrap().build();
            let recipe = lesson.recipe();
            for (width, height) in [(160, 100), (211, 97)] {
                let frame = run(&scene, &scene.home, &recipe, Viewport { width, height }, &mut ());
                let (x, y) = lesson.black_pixel(&frame).unwrap();
                let [spot_x, spot_y] = lesson.place;
                let off = ((x as f32 / width as f32 - spot_x).abs()).max((y as f32 / height as f32 - spot_y).abs());
                assert!(off < 0.1, "{}: the nearest black pixel is ({x}, {y})", lesson.scene);
                let survey = Survey::of(&scene, &recipe, &frame);
                let verdict = explain(&scene, &recipe, &frame, &survey, (x, y)).unwrap().verdict;
                assert!(verdict.contains(lesson.cause), "{}: {verdict}", lesson.scene);
            }
        }
    }
}
