//! Quantities of a frame as images. Each declares its names, the function that returns its values, their range, and the
//! channels of files that hold them.

use super::recording::BufferOrigin;
pub use super::recording::{Buffers, capture};
use super::reprojection::previous_position_px;
use super::value::{Range, Value};
use crate::chain::{Frame, MotionBuffers, Recipe};
use crate::image::Image;
use crate::pipeline::choice::{Label, registry};
use crate::scene::{Scene, TriangleId};

registry! {
    /// A quantity that can be displayed instead of the colour.
    pub Buffer: BufferFacts {
        Color = COLOR;
        Depth = DEPTH;
        TriangleId = TRIANGLE_ID;
        Lambda = LAMBDA;
        PerspectiveLambda = PERSPECTIVE_LAMBDA;
        Overdraw = OVERDRAW;
        Shaded = SHADED;
        MotionX = MOTION_X;
        MotionY = MOTION_Y;
        Disocclusion = DISOCCLUSION;
        PreviousX = PREVIOUS_X;
        PreviousY = PREVIOUS_Y;
        ReprojectionError = REPROJECTION_ERROR;
        Hits = HITS;
    }
}

/// Facts that a buffer declares about itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BufferFacts {
    pub(crate) label: Label,
    pub(crate) origin: BufferOrigin,
    /// Kind of the values, and the channels of OpenEXR files that hold them.
    pub(crate) channels: BufferChannels,
    /// Default colour map of numbers.
    pub(crate) map: BufferMap,
    /// Function that returns the value at a sample, or `None` if there is none.
    pub(crate) value: fn(&SampleContext<'_>) -> Option<Value>,
    /// Function that returns the range of the colour map, or `None` if there is none.
    pub(crate) range: fn(&Frame, Option<&Buffers>) -> Option<Range>,
}

/// Kind of the values of a buffer, with the names of their channels in OpenEXR files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BufferChannels {
    /// Colours, as [`Value::Color`]: red, green, blue and alpha.
    Color([&'static str; 4]),
    /// One channel of floats, from [`Value::Number`].
    Number(&'static str),
    /// One channel of unsigned integers, from [`Value::Count`].
    Count(&'static str),
    /// Barycentric weights, as [`Value::Weights`]: one channel per corner.
    Weights([&'static str; 3]),
    /// Identifiers of triangles, as [`Value::Triangle`].
    Triangle(&'static str),
}

/// Default colour map of the numbers of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BufferMap {
    /// From dark blue over green to yellow.
    Magnitude,
    /// Grey, for buffers in which colours mark faults.
    Grey,
    /// White in the middle of the range.
    Diverging,
}

/// Sample whose value is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleContext<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) buffers: Option<&'a Buffers>,
    /// Column in the framebuffer of the frame.
    pub(crate) column: u32,
    /// Row in the framebuffer of the frame.
    pub(crate) row: u32,
}

impl<'a> SampleContext<'a> {
    /// Returns the triangle that won the sample, with the buffers; `None` if none did.
    fn winner(&self) -> Option<(TriangleId, &'a Buffers)> {
        let buffers = self.buffers?;
        let triangle = buffers.triangle.at(self.column, self.row);
        (triangle != TriangleId::NONE).then_some((triangle, buffers))
    }

    /// Returns the count of an image of counts.
    fn count(&self, counts: impl Fn(&'a Buffers) -> Option<&'a Image<u32>>) -> Option<Value> {
        Some(Value::Count(counts(self.buffers?)?.at(self.column, self.row)))
    }

    /// Returns the pixel of the rasterized picture.
    fn pixel(&self) -> (u32, u32) {
        self.frame.drawn.grid.pixel(self.column, self.row)
    }

    /// Returns a number that is computed from the motion at the pixel.
    fn moved(&self, number: impl Fn(&MotionBuffers, (u32, u32)) -> f32) -> Option<Value> {
        Some(Value::Number(number(self.buffers?.motion.as_ref()?, self.pixel())))
    }

    /// Returns the stored depth; `None` if no fragment stored its depth. Without buffers, the depth is compared with the
    /// clear depth, so a fragment at exactly that depth is not detected.
    fn depth(&self) -> Option<f32> {
        let stored = self.frame.drawn.depth.as_ref()?.at(self.column, self.row);
        let drawn = match self.buffers {
            Some(buffers) => buffers.depth_stored.at(self.column, self.row),
            None => stored != self.frame.drawn.clear_depth,
        };
        drawn.then_some(stored)
    }
}

/// Returns the range from 0 to the greatest of the finite numbers.
fn from_zero(numbers: impl Iterator<Item = f32>) -> Option<Range> {
    Range::fit(numbers).map(|range| Range { low: 0.0, ..range })
}

/// Returns the range from 0 to the greatest count.
fn of_counts(counts: &Image<u32>) -> Option<Range> {
    from_zero(counts.pixels().iter().map(|count| *count as f32))
}

/// Returns the range of one axis of the motion, symmetrical around 0.
fn of_motion(frame: &Frame, buffers: Option<&Buffers>, axis: usize) -> Option<Range> {
    let motion = buffers?.motion.as_ref()?;
    let (width, height) = (frame.raster.width, frame.raster.height);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let lengths = pixels.map(|(x, y)| motion.vector_px(x, y)[axis].abs()).filter(|length| length.is_finite());
    let most = lengths.fold(0.0, f32::max);
    Some(Range { low: -most, high: most })
}

/// Returns the range from 0 to `high` if there is motion.
fn with_motion(buffers: Option<&Buffers>, high: f32) -> Option<Range> {
    buffers?.motion.as_ref().map(|_| Range { low: 0.0, high })
}

const COLOR: BufferFacts = BufferFacts {
    label: Label {
        id: "color",
        name: "Colour",
        help: "The finished picture.",
        synonyms: &["final", "color buffer", "framebuffer"],
    },
    origin: BufferOrigin::Picture,
    channels: BufferChannels::Color(["R", "G", "B", "A"]),
    map: BufferMap::Magnitude,
    value: |at| {
        let (x, y) = at.pixel();
        at.frame.image().get(x, y).map(Value::Color)
    },
    range: |_, _| None,
};

const DEPTH: BufferFacts = BufferFacts {
    label: Label {
        id: "depth",
        name: "Depth",
        help: "The depth buffer at the end of the frame.",
        synonyms: &["zbuffer", "z-buffer", "depth buffer"],
    },
    origin: BufferOrigin::DepthBuffer,
    channels: BufferChannels::Number("Z"),
    map: BufferMap::Magnitude,
    value: |at| at.depth().map(Value::Number),
    range: |frame, buffers| {
        let (width, height) = frame.drawn.color.size();
        let samples = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        Range::fit(samples.filter_map(|(column, row)| SampleContext { frame, buffers, column, row }.depth()))
    },
};

const TRIANGLE_ID: BufferFacts = BufferFacts {
    label: Label {
        id: "triangle-id",
        name: "Triangle id",
        help: "The triangle that won each sample, one colour per triangle.",
        synonyms: &[],
    },
    origin: BufferOrigin::Drawing,
    channels: BufferChannels::Triangle("id.triangle"),
    map: BufferMap::Magnitude,
    value: |at| at.winner().map(|(triangle, _)| Value::Triangle(triangle)),
    range: |_, _| None,
};

const LAMBDA: BufferFacts = BufferFacts {
    label: Label {
        id: "lambda",
        name: "Barycentric: linear",
        help: "Screen-space weights of the winning triangle: λ0 red, λ1 green, λ2 blue.",
        synonyms: &[],
    },
    origin: BufferOrigin::Drawing,
    channels: BufferChannels::Weights(["lambda.0", "lambda.1", "lambda.2"]),
    map: BufferMap::Magnitude,
    value: |at| at.winner().map(|(_, buffers)| Value::Weights(buffers.lambda.at(at.column, at.row))),
    range: |_, _| None,
};

const PERSPECTIVE_LAMBDA: BufferFacts = BufferFacts {
    label: Label {
        id: "perspective-lambda",
        name: "Barycentric: perspective-correct",
        help: "Weights of attributes in the winning triangle; equal to the linear ones if interpolation is affine.",
        synonyms: &[],
    },
    channels: BufferChannels::Weights(["weight.0", "weight.1", "weight.2"]),
    value: |at| at.winner().map(|(_, buffers)| Value::Weights(buffers.perspective_lambda.at(at.column, at.row))),
    ..LAMBDA
};

const OVERDRAW: BufferFacts = BufferFacts {
    label: Label {
        id: "overdraw",
        name: "Overdraw",
        help: "Number of triangles that cover each sample, whether or not they pass the depth test.",
        synonyms: &["heatmap", "fill rate"],
    },
    origin: BufferOrigin::Drawing,
    channels: BufferChannels::Count("overdraw"),
    map: BufferMap::Magnitude,
    value: |at| at.count(|buffers| Some(&buffers.overdraw)),
    range: |_, buffers| of_counts(&buffers?.overdraw),
};

const SHADED: BufferFacts = BufferFacts {
    label: Label {
        id: "shaded",
        name: "Times shaded",
        help: "Number of times each sample was shaded: work that the depth test did not save.",
        synonyms: &[],
    },
    origin: BufferOrigin::Drawing,
    channels: BufferChannels::Count("shaded"),
    map: BufferMap::Magnitude,
    value: |at| at.count(|buffers| Some(&buffers.shaded)),
    range: |_, buffers| of_counts(&buffers?.shaded),
};

const MOTION_X: BufferFacts = BufferFacts {
    label: Label {
        id: "motion-x",
        name: "Motion: x",
        help: "Position of the surface in the preceding frame minus its position now, in px to the right. Exact: from \
               the transforms of both frames.",
        synonyms: &["motion vector", "velocity", "optical flow"],
    },
    origin: BufferOrigin::Motion,
    channels: BufferChannels::Number("motion.X"),
    map: BufferMap::Diverging,
    value: |at| at.moved(|motion, (x, y)| motion.vector_px(x, y)[0]),
    range: |frame, buffers| of_motion(frame, buffers, 0),
};

const MOTION_Y: BufferFacts = BufferFacts {
    label: Label {
        id: "motion-y",
        name: "Motion: y",
        help: "Position of the surface in the preceding frame minus its position now, in px downwards.",
        synonyms: &["motion vector", "velocity", "optical flow"],
    },
    origin: BufferOrigin::Motion,
    channels: BufferChannels::Number("motion.Y"),
    map: BufferMap::Diverging,
    value: |at| at.moved(|motion, (x, y)| motion.vector_px(x, y)[1]),
    range: |frame, buffers| of_motion(frame, buffers, 1),
};

const DISOCCLUSION: BufferFacts = BufferFacts {
    label: Label {
        id: "disocclusion",
        name: "Disocclusion",
        help: "1 where the preceding frame does not show the surface: it was hidden, outside the picture or behind the \
               eye.",
        synonyms: &[],
    },
    origin: BufferOrigin::Motion,
    channels: BufferChannels::Count("disocclusion"),
    map: BufferMap::Magnitude,
    value: |at| {
        let (x, y) = at.pixel();
        Some(Value::Count(at.buffers?.motion.as_ref()?.is_disoccluded(x, y).into()))
    },
    range: |_, buffers| with_motion(buffers, 1.0),
};

const PREVIOUS_X: BufferFacts = BufferFacts {
    label: Label {
        id: "previous-x",
        name: "Previous position: x",
        help: "Position of the surface in the preceding frame, in px of that frame from the left.",
        synonyms: &["reprojection"],
    },
    origin: BufferOrigin::Motion,
    channels: BufferChannels::Number("previous.X"),
    map: BufferMap::Magnitude,
    value: |at| at.moved(|motion, pixel| previous_position_px(motion, pixel)[0]),
    range: |frame, buffers| with_motion(buffers, frame.raster.width as f32),
};

const PREVIOUS_Y: BufferFacts = BufferFacts {
    label: Label {
        id: "previous-y",
        name: "Previous position: y",
        help: "Position of the surface in the preceding frame, in px of that frame from the top.",
        synonyms: &["reprojection"],
    },
    origin: BufferOrigin::Motion,
    channels: BufferChannels::Number("previous.Y"),
    map: BufferMap::Magnitude,
    value: |at| at.moved(|motion, pixel| previous_position_px(motion, pixel)[1]),
    range: |frame, buffers| with_motion(buffers, frame.raster.height as f32),
};

const REPROJECTION_ERROR: BufferFacts = BufferFacts {
    label: Label {
        id: "reprojection-error",
        name: "Reprojection error",
        help: "Largest difference of a channel, in sRGB codes, from the colour at the previous position. Both frames \
               are drawn without history, anti-aliasing and post filter.",
        synonyms: &["motion vector", "ghosting"],
    },
    origin: BufferOrigin::Reprojection,
    channels: BufferChannels::Number("reprojection.error"),
    map: BufferMap::Magnitude,
    value: |at| {
        let (x, y) = at.pixel();
        let error = at.buffers?.reprojection_error.as_ref()?.at(x, y);
        (!error.is_nan()).then_some(Value::Number(error))
    },
    range: |_, buffers| from_zero(buffers?.reprojection_error.as_ref()?.pixels().iter().copied()),
};

const HITS: BufferFacts = BufferFacts {
    label: Label {
        id: "hits",
        name: "Hit count",
        help: "Number of triangles that cover each sample, without depth test. Cracks along shared edges are blue, \
               double hits orange.",
        synonyms: &[],
    },
    origin: BufferOrigin::Hits,
    channels: BufferChannels::Count("hits"),
    map: BufferMap::Grey,
    value: |at| at.count(|buffers| Some(&buffers.hits.as_ref()?.counts)),
    range: |frame, buffers| {
        let hits = buffers?.hits.as_ref()?;
        let mut counts = hits.counts.map(|count| count as f32);
        // Samples with faults have their own colours, so their counts are excluded. High counts there would leave few
        // greys for the other samples.
        for (column, row) in hits.faults.iter().filter_map(|fault| frame.drawn.grid.sample_at(fault.x, fault.y)) {
            counts.set(column, row, f32::NAN);
        }
        from_zero(counts.pixels().iter().copied())
    },
};

impl Buffer {
    /// Returns the kind of the values, and the channels of OpenEXR files that hold them.
    pub fn channels(self) -> BufferChannels {
        self.facts().channels
    }

    /// Whether the buffer needs the motion since the preceding frame.
    pub fn is_motion(self) -> bool {
        matches!(self.facts().origin, BufferOrigin::Motion | BufferOrigin::Reprojection)
    }
}

impl Buffers {
    /// Whether [`Self::completed_for`] has nothing to add for a buffer.
    pub fn is_complete_for(&self, buffer: Buffer, frame: &Frame) -> bool {
        self.has(buffer.facts().origin, frame)
    }

    /// Adds the hits or the motion if `buffer` shows them and they are missing; [`capture`] does not record them.
    pub fn completed_for(self, buffer: Buffer, scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let origin = buffer.facts().origin;
        if self.has(origin, frame) { self } else { self.with(origin, scene, recipe, frame) }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::{PrecedingView, run};
    use crate::inspect::view;
    use crate::pipeline::settings::Choice as _;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 64, height: 40 };

    /// Checks that no buffer is declared whose values are never recorded.
    #[test]
    fn the_values_of_every_buffer_vary_over_the_picture_of_a_scene_in_motion() {
        let scene = Arc::new(builtin::by_id("walker").unwrap().build());
        let posed = scene.at(0.1);
        let recipe = Recipe::default();
        let mut camera = scene.home;
        camera.orbit(0.1, 0.0);
        let mut frame = run(&posed, &camera, &recipe, SIZE, &mut ());
        frame.before = Some(PrecedingView { scene: Arc::clone(&scene), camera: scene.home });
        let mut buffers = capture(&posed, &recipe, &frame);
        for buffer in Buffer::ALL {
            buffers = buffers.completed_for(*buffer, &posed, &recipe, &frame);
            let pixels = (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y)));
            let values = pixels.map(|(x, y)| view::value(*buffer, &frame, Some(&buffers), x, y));
            let mut values = values.filter(|value| *value != Value::Nothing);
            let first = values.next();
            assert!(first.is_some_and(|first| values.any(|value| value != first)), "{}: {first:?}", buffer.id());
        }
    }
}
