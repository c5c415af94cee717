//! Rendering of buffers as pictures: the colour of each value, and the value range of the colour map.

use serde::Serialize;

use super::buffers::{Buffer, Buffers};
use super::hits::FaultKind;
use super::reprojection::previous_position_px;
use crate::chain::Frame;
use crate::image::color::quantize;
use crate::image::{Image, Rgba8};
use crate::pipeline::shade::id_color;
use crate::scene::TriangleId;

/// Range of values that a colour map spans.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// Value at the start of the colour map.
    pub low: f32,
    /// Value at the end of the colour map.
    pub high: f32,
}

impl Range {
    /// Returns the range from minimum to maximum of the finite `values`; `None` if there are none.
    pub(crate) fn fit(values: impl Iterator<Item = f32>) -> Option<Self> {
        values.filter(|v| v.is_finite()).fold(None, |range: Option<Self>, v| {
            Some(range.map_or(Self { low: v, high: v }, |r| Self { low: r.low.min(v), high: r.high.max(v) }))
        })
    }

    /// Returns the position of a value within the range, clamped to [0, 1].
    pub fn position(self, value: f32) -> f32 {
        let width = self.high - self.low;
        if width > 0.0 { ((value - self.low) / width).clamp(0.0, 1.0) } else { 0.0 }
    }
}

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

/// Returns the colour at a position in [0, 1] of a buffer's colour map. The map of [`Buffer::Hits`] is grey, because
/// colours mark faults there. Motion has a diverging map: no motion is white.
pub fn map_color(buffer: Buffer, position: f32) -> Rgba8 {
    /// Grey levels at the two ends of the map, in [0, 1]; chosen so that dark and light marks stay visible.
    const GREYS: (f32, f32) = (0.11, 0.84);
    match buffer {
        Buffer::Hits => {}
        Buffer::MotionX | Buffer::MotionY => {
            let [r, g, b] =
                colorous::PURPLE_ORANGE.eval_continuous(1.0 - f64::from(position.clamp(0.0, 1.0))).as_array();
            return [r, g, b, 255];
        }
        _ => return magnitude_color(position),
    }
    let grey = quantize(GREYS.0 + (GREYS.1 - GREYS.0) * position.clamp(0.0, 1.0));
    [grey, grey, grey, 255]
}

/// Value of a buffer at a pixel of the full picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// The pixel was not drawn; the upscaler filled it in.
    NotDrawn,
    /// The pixel was drawn but has no value in the buffer.
    Nothing,
    /// Red, green, blue and alpha, as sRGB codes.
    Color(Rgba8),
    /// Floating-point value, such as a depth.
    Number(f32),
    /// Integer count, such as overdraw.
    Count(u32),
    /// Barycentric weights of the triangle's corners.
    Weights([f32; 3]),
    /// Triangle that is visible at the pixel.
    Triangle(TriangleId),
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
    if buffer == Buffer::Depth {
        return depth_of(frame, buffers, column, row).map_or(Value::Nothing, Value::Number);
    }
    let Some(buffers) = buffers else {
        return Value::Nothing;
    };
    let id = buffers.triangle.at(column, row);
    match buffer {
        Buffer::Overdraw => Value::Count(buffers.overdraw.at(column, row)),
        Buffer::Shaded => Value::Count(buffers.shaded.at(column, row)),
        Buffer::Hits => buffers.hits.as_ref().map_or(Value::Nothing, |hits| Value::Count(hits.counts.at(column, row))),
        _ if buffer.is_motion() => motion_value(buffer, buffers, frame.drawn.grid.pixel(column, row)),
        _ if id == TriangleId::NONE => Value::Nothing,
        Buffer::Lambda => Value::Weights(buffers.lambda.at(column, row)),
        Buffer::PerspectiveLambda => Value::Weights(buffers.perspective_lambda.at(column, row)),
        _ => Value::Triangle(id),
    }
}

/// Returns the value of a buffer that needs the motion, at a rasterized pixel.
fn motion_value(buffer: Buffer, buffers: &Buffers, (x, y): (u32, u32)) -> Value {
    let Some(motion) = &buffers.motion else { return Value::Nothing };
    let [across_px, down_px] = motion.vector_px(x, y);
    let [previous_x, previous_y] = previous_position_px(motion, (x, y));
    match buffer {
        Buffer::MotionX => Value::Number(across_px),
        Buffer::MotionY => Value::Number(down_px),
        Buffer::PreviousX => Value::Number(previous_x),
        Buffer::PreviousY => Value::Number(previous_y),
        Buffer::ReprojectionError => {
            let error = buffers.reprojection_error.as_ref().map(|errors| errors.at(x, y));
            error.filter(|error| !error.is_nan()).map_or(Value::Nothing, Value::Number)
        }
        _ => Value::Count(u32::from(motion.is_disoccluded(x, y))),
    }
}

/// Returns the reason why a buffer has no values in this frame; `None` if it has values.
pub fn absence(buffer: Buffer, frame: &Frame) -> Option<&'static str> {
    match buffer {
        _ if buffer.is_motion() && frame.before.is_none() => Some("no motion: scene and camera are still"),
        Buffer::Depth if frame.drawn.depth.is_none() => Some("no depth buffer: the depth test is off"),
        _ => None,
    }
}

/// Returns the stored depth of a sample; `None` if no fragment stored its depth. Without `buffers`, the depth is
/// compared with the clear depth, so a fragment at exactly that depth is not detected.
fn depth_of(frame: &Frame, buffers: Option<&Buffers>, column: u32, row: u32) -> Option<f32> {
    let stored = frame.drawn.depth.as_ref()?.at(column, row);
    let drawn = match buffers {
        Some(buffers) => buffers.depth_stored.at(column, row),
        None => stored != frame.drawn.clear_depth,
    };
    drawn.then_some(stored)
}

/// Returns the value range of a buffer that uses a colour map: from minimum to maximum of stored depths, or from 0 to
/// the maximum of counts. Returns `None` for other buffers, or if the buffer has no values.
pub fn range(buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>) -> Option<Range> {
    match buffer {
        Buffer::Depth => {
            let (width, height) = frame.drawn.color.size();
            let samples = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
            Range::fit(samples.filter_map(|(column, row)| depth_of(frame, buffers, column, row)))
        }
        Buffer::Hits => {
            let hits = buffers?.hits.as_ref()?;
            let mut counts = hits.counts.map(|count| count as f32);
            // Samples with faults have their own colours, so their counts are excluded. High counts there would leave
            // few greys for the other samples.
            for (column, row) in hits.faults.iter().filter_map(|fault| frame.drawn.grid.sample_at(fault.x, fault.y)) {
                counts.set(column, row, f32::NAN);
            }
            Range::fit(counts.pixels().iter().copied()).map(|r| Range { low: 0.0, ..r })
        }
        Buffer::MotionX | Buffer::MotionY => {
            let motion = buffers?.motion.as_ref()?;
            let (width, height) = (frame.raster.width, frame.raster.height);
            let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let axis = usize::from(buffer == Buffer::MotionY);
            let lengths = pixels.map(|(x, y)| motion.vector_px(x, y)[axis].abs()).filter(|length| length.is_finite());
            let most = lengths.fold(0.0, f32::max);
            Some(Range { low: -most, high: most })
        }
        Buffer::PreviousX => buffers?.motion.as_ref().map(|_| Range { low: 0.0, high: frame.raster.width as f32 }),
        Buffer::PreviousY => buffers?.motion.as_ref().map(|_| Range { low: 0.0, high: frame.raster.height as f32 }),
        Buffer::ReprojectionError => {
            let errors = buffers?.reprojection_error.as_ref()?;
            Range::fit(errors.pixels().iter().copied()).map(|range| Range { low: 0.0, ..range })
        }
        Buffer::Disocclusion => buffers?.motion.as_ref().map(|_| Range { low: 0.0, high: 1.0 }),
        Buffer::Overdraw | Buffer::Shaded => {
            let buffers = buffers?;
            let counts = if buffer == Buffer::Overdraw { &buffers.overdraw } else { &buffers.shaded };
            Range::fit(counts.pixels().iter().map(|c| *c as f32)).map(|r| Range { low: 0.0, ..r })
        }
        _ => None,
    }
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
