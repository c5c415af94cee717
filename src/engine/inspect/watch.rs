//! Watched pixels: one row per pixel with the values of all buffers, for comparison between frames.
//!
//! Each row is computed by replaying its pixel, like the pixel report, so drawing the frame has no overhead.

use super::explain::inspect;
use super::pixel::{FragmentOutcome, FragmentRecord, PixelReport};
use crate::chain::{Frame, Recipe};
use crate::image::Rgba8;
use crate::scene::{Scene, TriangleId};

/// Values of all buffers at a watched pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedPixel {
    /// Column of the pixel in the full picture.
    pub x: u32,
    /// Row of the pixel in the full picture.
    pub y: u32,
    /// Values of all buffers at the pixel; `None` outside the picture.
    pub values: Option<PixelValues>,
}

/// Values of all buffers at a watched pixel. If the pixel was upscaled, all values except the colour are those of the
/// drawn pixel with the largest weight.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelValues {
    /// Colour in the finished picture, as sRGB codes.
    pub color: Rgba8,
    /// Whether the pixel was drawn rather than upscaled.
    pub is_drawn: bool,
    /// Visible triangle; if several triangles are blended, the one drawn last.
    pub triangle: Option<TriangleId>,
    /// Name of the object that contains the visible triangle; `None` if there is no visible triangle.
    pub object: Option<String>,
    /// Final depth in the depth buffer; `None` without a depth buffer.
    pub depth: Option<f32>,
    /// Barycentric weights of the visible triangle's corners, linear in screen space.
    pub lambda: Option<[f32; 3]>,
    /// Weights of the visible triangle's corners for interpolating attributes, perspective-correct by default.
    pub perspective_lambda: Option<[f32; 3]>,
    /// Number of fragments at the pixel's centre.
    pub overdraw: usize,
    /// Number of shaded fragments at the pixel's centre.
    pub shaded: usize,
}

/// Replays pixels of a frame and returns their values, in the given order.
pub fn watch(scene: &Scene, recipe: &Recipe, frame: &Frame, pixels: &[(u32, u32)]) -> Vec<WatchedPixel> {
    let row = |(x, y): &(u32, u32)| {
        let values = inspect(scene, recipe, frame, *x, *y).map(|report| values(&report, frame.is_drawn(*x, *y)));
        WatchedPixel { x: *x, y: *y, values }
    };
    pixels.iter().map(row).collect()
}

fn values(report: &PixelReport, is_drawn: bool) -> PixelValues {
    let seen = report.visible();
    PixelValues {
        color: report.color,
        is_drawn,
        triangle: seen.map(|fragment| fragment.triangle),
        object: seen.map(|fragment| fragment.instance.clone()),
        depth: report.final_depth.as_ref().map(|depth| depth.value),
        lambda: seen.map(|fragment| fragment.affine_weights),
        perspective_lambda: seen.map(|fragment| fragment.attribute_weights),
        overdraw: report.fragments.len(),
        shaded: report.fragments.iter().filter(|fragment| was_shaded(fragment)).count(),
    }
}

/// Whether a fragment was shaded and written.
fn was_shaded(fragment: &FragmentRecord) -> bool {
    match fragment.outcome {
        FragmentOutcome::Visible | FragmentOutcome::Overwritten | FragmentOutcome::BlendedOver => true,
        FragmentOutcome::DepthRejected | FragmentOutcome::AlphaRejected => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::inspect::{Buffer, capture, view};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use view::Value;

    #[test]
    fn rows_match_the_buffers() {
        let size = Viewport { width: 40, height: 30 };
        for scene in ["interpenetrating", "cubes", "stained-glass"] {
            let scene = builtin::by_id(scene).unwrap().build();
            let mut recipe = Recipe::default();
            recipe.set("execution=classic").unwrap();
            let frame = run(&scene, &scene.home, &recipe, size, &mut ());
            let buffers = capture(&scene, &recipe, &frame);
            let pixels: Vec<_> = (0..30).map(|i| (i * 7 % 40, i)).collect();
            let mut seen = 0;
            for WatchedPixel { x, y, values } in watch(&scene, &recipe, &frame, &pixels) {
                let values = values.unwrap();
                let held = |buffer| view::value(buffer, &frame, Some(&buffers), x, y);
                assert_eq!(held(Buffer::Color), Value::Color(values.color));
                assert_eq!(held(Buffer::Overdraw), Value::Count(values.overdraw as u32), "{x}, {y}");
                assert_eq!(held(Buffer::Shaded), Value::Count(values.shaded as u32), "{x}, {y}");
                let Some(triangle) = values.triangle else {
                    assert_eq!(held(Buffer::TriangleId), Value::Nothing);
                    continue;
                };
                seen += 1;
                assert_eq!(held(Buffer::TriangleId), Value::Triangle(triangle));
                assert_eq!(Some(held(Buffer::Lambda)), values.lambda.map(Value::Weights));
                assert_eq!(Some(held(Buffer::PerspectiveLambda)), values.perspective_lambda.map(Value::Weights));
                if let Value::Number(depth) = held(Buffer::Depth) {
                    assert_eq!(values.depth, Some(depth));
                }
            }
            assert!(seen > 3, "{}", scene.name);
        }
    }

    #[test]
    fn pixels_outside_the_picture_have_no_values() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, Viewport { width: 8, height: 8 }, &mut ());
        assert_eq!(watch(&scene, &recipe, &frame, &[(8, 0)]), [WatchedPixel { x: 8, y: 0, values: None }]);
    }
}
