//! Builds a minimal case that reproduces one pixel of a frame: a `tri_coverage` case with only the triangle that covers
//! the pixel. Where possible, its picture is only a small window of the frame's picture.

use serde::Serialize;

use super::rule;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{FillRule, Settings};
use crate::pipeline::viewport::Viewport;

/// Maximum width and height of the picture of a minimal case, in pixels.
const SIDE_PX: u32 = 64;

/// A `tri_coverage` case of one triangle, with a note on its origin. Fields that the kind does not define, such as
/// `note`, are ignored when the case is read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MinimalCase {
    /// Identifier of the case, built from triangle and pixel.
    pub id: String,
    kind: &'static str,
    class: &'static str,
    note: String,
    width: u32,
    height: u32,
    #[serde(with = "rule")]
    rule: FillRule,
    /// Corners of the triangle in pixels: the f32 coordinates of the frame, converted exactly to f64.
    triangles: [[[f64; 2]; 3]; 1],
    /// Column and row of the pixel to examine.
    pixel: [u32; 2],
    settings: Settings,
}

impl MinimalCase {
    /// Creates a case from a triangle that covers `pixel` in a picture of size `viewport`.
    ///
    /// The picture of the case is a window around `pixel` of at most [`SIDE_PX`] pixels per side. The triangle is
    /// shifted by whole pixels into the coordinates of this window. If the shift would round a coordinate, the case has
    /// the full picture instead.
    pub fn new(
        triangle: &ScreenTriangle,
        pixel: (u32, u32),
        viewport: Viewport,
        settings: &Settings,
        scene: &str,
    ) -> Self {
        let corners = triangle.corners_px();
        let first = |pixel: u32, size: u32| pixel.saturating_sub(SIDE_PX / 2).min(size.saturating_sub(SIDE_PX));
        let shift = [first(pixel.0, viewport.width), first(pixel.1, viewport.height)];
        let shifted = corners.map(|corner| [0, 1].map(|axis| corner[axis] - shift[axis] as f32));
        let is_exact = (0..3).all(|i| {
            (0..2).all(|axis| f64::from(shifted[i][axis]) + f64::from(shift[axis]) == f64::from(corners[i][axis]))
        });
        let (corners, shift, width, height) = if is_exact {
            (shifted, shift, viewport.width.min(SIDE_PX), viewport.height.min(SIDE_PX))
        } else {
            (corners, [0, 0], viewport.width, viewport.height)
        };
        Self {
            id: format!("triangle-{}-at-{}-{}", triangle.id.0, pixel.0, pixel.1),
            kind: "tri_coverage",
            class: "reported",
            note: format!(
                "triangle {} of {scene}, pixel {}, {} of a picture of {} × {} px",
                triangle.id.0, pixel.0, pixel.1, viewport.width, viewport.height
            ),
            width,
            height,
            rule: settings.fill_rule,
            triangles: [corners.map(|corner| corner.map(f64::from))],
            pixel: [pixel.0 - shift[0], pixel.1 - shift[1]],
            settings: *settings,
        }
    }

    /// Returns the content of the case file, as indented JSON.
    pub fn to_json(&self) -> String {
        // Corners of drawn triangles and all numbers in the settings are finite, so serialization cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Answer, Case, Control, Options, answer};
    use crate::chain::{Recipe, run};
    use crate::pipeline::settings::Culling;
    use crate::scene::builtin;

    #[test]
    fn a_minimal_case_covers_the_pixel_that_it_was_made_from() {
        let scene = builtin::by_id("slivers").unwrap().build();
        let mut recipe = Recipe::default();
        recipe.pipeline.culling = Culling::None;
        recipe.pipeline.fill_rule = FillRule::BottomRight;
        let viewport = Viewport { width: 200, height: 150 };
        let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
        let mut made = 0;
        for (x, y) in (0..200).step_by(7).flat_map(|x| (0..150).step_by(5).map(move |y| (x, y))) {
            let report = crate::inspect::inspect(&scene, &recipe, &frame, x, y).unwrap();
            let Some(visible) = report.visible() else { continue };
            let triangle = &frame.geometry().triangles[visible.submission];
            let minimal = MinimalCase::new(triangle, (x, y), viewport, &recipe.pipeline, &scene.name);
            let case = Case::parse(minimal.to_json().as_bytes(), "minimal.json".as_ref()).unwrap();
            let answer = answer(&case, Options::default(), &Control::default());
            let Ok(Answer::TriCoverage(answer)) = answer else { panic!("{}", minimal.id) };
            let [column, row] = minimal.pixel;
            let hit = answer.triangles[0].spans.iter().any(|[y, l, r]| *y == row && (*l..*r).contains(&column));
            assert!(hit, "{}", minimal.to_json());
            made += 1;
        }
        assert!(made > 20, "only {made}");
    }
}
