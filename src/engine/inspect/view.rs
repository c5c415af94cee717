//! Rendering of buffers as pictures: the colour of each value, and the value range of the colour map.

use super::buffers::{Buffer, BufferMap, Buffers, SampleContext};
use super::hits::FaultKind;
use super::recording::BufferOrigin;
pub use super::value::{Range, Value};
use crate::chain::Frame;
use crate::image::color::quantize;
use crate::image::{Image, Rgba8};
use crate::pipeline::shade::id_color;

/// Returns the colour at a position in [0, 1] of the viridis colour map, which is perceptually uniform and safe for
/// colour-blind people.
pub fn magnitude_color(position: f32) -> Rgba8 {
    let [r, g, b] = colorous::VIRIDIS.eval_continuous(f64::from(position.clamp(0.0, 1.0))).as_array();
    [r, g, b, 255]
}

/// Colour of pixels that were not drawn but left to the upscaler.
pub(crate) const NOT_DRAWN: Rgba8 = [12, 12, 12, 255];

/// Colour of a crack: a pixel along a shared edge that too few triangles hit. Colour-blind people can distinguish it
/// from [`DOUBLE_HIT`].
pub const CRACK: Rgba8 = [48, 132, 255, 255];

/// Colour of a double hit: a pixel along a shared edge that too many triangles hit.
pub const DOUBLE_HIT: Rgba8 = [255, 150, 0, 255];

/// Returns the colour at a position in [0, 1] of a buffer's colour map.
pub fn map_color(buffer: Buffer, position: f32) -> Rgba8 {
    /// Grey levels at the two ends of the map, in [0, 1]; chosen so that dark and light marks stay visible.
    const GREYS: (f32, f32) = (0.11, 0.84);
    match buffer.facts().map {
        BufferMap::Magnitude => magnitude_color(position),
        BufferMap::Diverging => {
            let [r, g, b] =
                colorous::PURPLE_ORANGE.eval_continuous(1.0 - f64::from(position.clamp(0.0, 1.0))).as_array();
            [r, g, b, 255]
        }
        BufferMap::Grey => {
            let grey = quantize(GREYS.0 + (GREYS.1 - GREYS.0) * position.clamp(0.0, 1.0));
            [grey, grey, grey, 255]
        }
    }
}

/// Returns the value of a buffer at a pixel inside the picture. Colour and depth are available even if `buffers` is
/// `None`.
pub fn value(buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>, x: u32, y: u32) -> Value {
    if buffer == Buffer::Color {
        return frame.image().get(x, y).map_or(Value::NotDrawn, Value::Color);
    }
    let Some((column, row)) = frame.sample_at(x, y) else {
        return Value::NotDrawn;
    };
    let value = buffer.facts().value;
    value(&SampleContext { frame, buffers, column, row }).unwrap_or(Value::Nothing)
}

/// Returns the reason why a buffer has no values in this frame; `None` if it has values.
pub fn absence(buffer: Buffer, frame: &Frame) -> Option<&'static str> {
    match buffer.facts().origin {
        BufferOrigin::Motion | BufferOrigin::Reprojection => {
            frame.before.is_none().then_some("no motion: scene and camera are still")
        }
        BufferOrigin::DepthBuffer => frame.drawn.depth.is_none().then_some("no depth buffer: the depth test is off"),
        BufferOrigin::Picture | BufferOrigin::Drawing | BufferOrigin::Hits => None,
    }
}

/// Returns the value range of a buffer that uses a colour map: from minimum to maximum of stored depths, or from 0 to
/// the maximum of counts. Returns `None` for other buffers, or if the buffer has no values.
pub fn range(buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>) -> Option<Range> {
    let range = buffer.facts().range;
    range(frame, buffers)
}

/// Returns a picture of a buffer at full resolution. `range` is the value range of the colour map; `None` stands for
/// [0, 1].
pub fn picture(buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>, range: Option<Range>) -> Image<Rgba8> {
    if buffer == Buffer::Color {
        return frame.image().clone();
    }
    let range = range.unwrap_or(Range { low: 0.0, high: 1.0 });
    let (width, height) = frame.image().size();
    let mut image = Image::from_fn(width, height, |x, y| match value(buffer, frame, buffers, x, y) {
        Value::NotDrawn | Value::Nothing => NOT_DRAWN,
        Value::Color(color) => color,
        Value::Number(number) => map_color(buffer, range.position(number)),
        Value::Count(count) => map_color(buffer, range.position(count as f32)),
        Value::Weights([a, b, c]) => [quantize(a), quantize(b), quantize(c), 255],
        Value::Triangle(id) => id_color(id),
    });
    if let Some(hits) = buffers.and_then(|buffers| buffers.hits.as_ref()).filter(|_| buffer == Buffer::Hits) {
        for fault in &hits.faults {
            image.set(fault.x, fault.y, fault_color(fault.kind));
        }
    }
    image
}

/// Returns the colour that marks faults of this kind.
pub fn fault_color(kind: FaultKind) -> Rgba8 {
    match kind {
        FaultKind::Crack => CRACK,
        FaultKind::DoubleHit => DOUBLE_HIT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Recipe, run};
    use crate::inspect::capture;
    use crate::pipeline::settings::{DepthFormat, DepthTest, FillRule};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::TriangleId;
    use crate::scene::builtin;

    /// Draws a frame of one triangle, then replaces the stored depth of its pixels by `depth`.
    fn frame_at_depth(test: DepthTest, format: DepthFormat, depth: f32) -> (Frame, Buffers) {
        let scene = builtin::by_id("triangle").unwrap().build();
        let mut recipe = Recipe::default();
        (recipe.pipeline.depth_test, recipe.pipeline.depth_format) = (test, format);
        let mut frame = run(&scene, &scene.home, &recipe, Viewport { width: 32, height: 24 }, &mut ());
        let buffers = capture(&scene, &recipe, &frame);
        for (stored, id) in frame.drawn.depth.iter_mut().flat_map(Image::pixels_mut).zip(buffers.triangle.pixels()) {
            if *id != TriangleId::NONE {
                *stored = depth;
            }
        }
        (frame, buffers)
    }

    #[test]
    fn a_depth_of_0_or_1_is_shown_where_something_was_drawn() {
        for (format, nearest) in [(DepthFormat::F32, 0.0), (DepthFormat::ReversedF32, 1.0)] {
            // Without buffers, a fragment at the clear depth cannot be detected.
            for (depth, with_buffers) in [(nearest, true), (nearest, false), (1.0 - nearest, true)] {
                let (frame, buffers) = frame_at_depth(DepthTest::LessEqual, format, depth);
                let known = with_buffers.then_some(&buffers);
                let range = range(Buffer::Depth, &frame, known);
                assert_eq!(range, Some(Range { low: depth, high: depth }));
                let image = picture(Buffer::Depth, &frame, known, range);
                for (pixel, id) in image.pixels().iter().zip(buffers.triangle.pixels()) {
                    assert_eq!(*pixel == NOT_DRAWN, *id == TriangleId::NONE, "{format:?} {depth}");
                }
            }
        }
    }

    #[test]
    fn hit_counts_without_faults_use_the_full_range_of_greys() {
        let scene = builtin::by_id("shared-edges").unwrap().build();
        let mut recipe = Recipe::default();
        recipe.pipeline.fill_rule = FillRule::Inclusive;
        let frame = run(&scene, &scene.home, &recipe, Viewport { width: 32, height: 24 }, &mut ());
        let buffers = capture(&scene, &recipe, &frame).completed_for(Buffer::Hits, &scene, &recipe, &frame);
        let hits = buffers.hits.as_ref().unwrap();
        assert!(hits.counts.pixels().iter().any(|count| *count > 1));
        let range = range(Buffer::Hits, &frame, Some(&buffers));
        assert_eq!(range, Some(Range { low: 0.0, high: 1.0 }), "everything else is drawn once or not at all");
        let image = picture(Buffer::Hits, &frame, Some(&buffers), range);
        for y in 0..24 {
            for x in 0..32 {
                let expected = match hits.counts.at(x, y) {
                    2.. => DOUBLE_HIT,
                    count => map_color(Buffer::Hits, count as f32),
                };
                assert_eq!(image.at(x, y), expected, "{x},{y}");
            }
        }
    }

    #[test]
    fn without_a_depth_test_the_absence_of_depth_is_explained() {
        let (frame, buffers) = frame_at_depth(DepthTest::Off, DepthFormat::F32, 0.0);
        assert!(absence(Buffer::Depth, &frame).is_some_and(|why| why.contains("depth test is off")));
        assert_eq!(absence(Buffer::Color, &frame), None);
        assert_eq!(range(Buffer::Depth, &frame, Some(&buffers)), None);
        assert_eq!(value(Buffer::Depth, &frame, Some(&buffers), 16, 12), Value::Nothing);
        let (frame, _) = frame_at_depth(DepthTest::Less, DepthFormat::F32, 0.0);
        assert_eq!(absence(Buffer::Depth, &frame), None);
    }

    #[test]
    fn ranges_ignore_non_finite_values_and_handle_constants() {
        assert_eq!(Range::fit([f32::NAN, f32::INFINITY].into_iter()), None);
        let flat = Range::fit([0.5, f32::NAN, 0.5].into_iter()).unwrap();
        assert_eq!(flat, Range { low: 0.5, high: 0.5 });
        assert_eq!(flat.position(0.5), 0.0);
        assert_eq!(Range { low: 1.0, high: 3.0 }.position(2.5), 0.75);
    }
}
