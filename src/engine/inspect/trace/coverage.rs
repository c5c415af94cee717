//! Trace of coverage: the edge values at the pixel's centre, and the fill rule's decision for a centre on an edge.

use super::Number;
use super::formula::{Formula, given};
use super::line::{Notable, TraceLine, TraceRecorder, TraceStage};
use super::subject::TracedFragment;
use crate::inspect::intermediate::Intermediate;
use crate::math::fixed::snap;
use crate::pipeline::raster::doubled_area;
use crate::pipeline::raster::inward::Inward;
use crate::pipeline::raster::steps::{EdgeNumbers, EdgeSteps, ExactSteps, FixedSteps, FloatSteps};
use crate::pipeline::settings::{Arithmetic, Choice as _};

/// Intermediate values of the three edge functions.
const EDGE_BUFFERS: [Intermediate; 3] = [Intermediate::Edge0, Intermediate::Edge1, Intermediate::Edge2];

/// Writes the trace lines for the triangle's area, the edge values and the coverage decisions.
pub(super) fn write(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Coverage);
    area(subject, scribe);
    for (edge, steps) in subject.steps.iter().enumerate() {
        let name = format!("edge {edge}");
        let line = match &steps.numbers {
            EdgeNumbers::Fixed(numbers) => {
                let corners = subject.triangle.vertices.each_ref().map(|v| [i64::from(v.x), i64::from(v.y)]);
                fixed(&name, numbers, [corners[(edge + 1) % 3], corners[(edge + 2) % 3]], scribe)
            }
            EdgeNumbers::F32(numbers) => float(&name, numbers, scribe),
            EdgeNumbers::F64(numbers) => float(&name, numbers, scribe),
            EdgeNumbers::Exact(numbers) => exact(&name, numbers, scribe),
        };
        let value = raw_value(&steps.numbers);
        let scaled = subject.sample.edges[edge];
        if steps.scale == 1.0 {
            line.shown_by(EDGE_BUFFERS[edge]);
        } else {
            let formula = given("edge value", value) * given("scale", steps.scale);
            scribe.compute(format!("{name} · scaled value"), scaled, &formula).shown_by(EDGE_BUFFERS[edge]);
        }
        decide(&name, steps, value, scribe);
    }
    if subject.settings.rasterizer.is_published() {
        let words = format!("{} uses its own coverage test, as published", subject.settings.rasterizer.name());
        scribe.decide("coverage", words, "covered");
    }
}

/// Writes the signed doubled area of the triangle; its sign determines the facing.
fn area(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    let arithmetic = subject.settings.arithmetic;
    let (area, scale) = doubled_area(arithmetic, subject.triangle.corners_px());
    let number = |value: f64| match arithmetic {
        Arithmetic::Fixed => Number::I64(value as i64),
        Arithmetic::F32 => Number::F32(value as f32),
        Arithmetic::F64 | Arithmetic::Exact => Number::F64(value),
    };
    let corners = subject.triangle.corners_px();
    let coordinate = |corner: usize, axis: usize| {
        let px = corners[corner][axis];
        let value = if arithmetic == Arithmetic::Fixed { Number::I64(snap(px)) } else { Number::F32(px) };
        given(format!("{}{corner}", ["x", "y"][axis]), value)
    };
    let side = |to: usize, axis: usize| coordinate(to, axis) - coordinate(0, axis);
    let formula = side(1, 0) * side(2, 1) - side(2, 0) * side(1, 1);
    scribe.compute("doubled area", number(area), &formula);
    let facing = if area < 0.0 { "front: counter-clockwise" } else { "back: clockwise" };
    scribe.decide("side", "the sign of the area", facing);
    let unit = if arithmetic == Arithmetic::Fixed { "1/2¹⁶ px²" } else { "px² times the scale" };
    scribe.read("unsigned area", format!("in the unit of edge values: {unit}"), subject.triangle.doubled_area);
    if scale != 1.0 {
        scribe.read("scale of edge values", "the power of two that scales the area to about 1", scale);
    }
}

fn raw_value(numbers: &EdgeNumbers) -> Number {
    match numbers {
        EdgeNumbers::Fixed(FixedSteps { value, .. }) => Number::I64(*value),
        EdgeNumbers::F32(FloatSteps { value, .. }) => Number::F32(*value),
        EdgeNumbers::F64(FloatSteps { value, .. }) | EdgeNumbers::Exact(ExactSteps { value, .. }) => {
            Number::F64(*value)
        }
    }
}

/// Writes the computation of an edge value in fixed point: A·x + B·y + C. `from` and `to` are the ends of the edge, in
/// grid steps of 1/256 px.
fn fixed<'s>(
    name: &str,
    FixedSteps { a, b, c, centre, value }: &FixedSteps,
    [from, to]: [[i64; 2]; 2],
    scribe: &'s mut TraceRecorder,
) -> &'s mut TraceLine {
    let (a, b, c) = (*a, *b, *c);
    let ends = |first: (&'static str, i64), second: (&'static str, i64), product: i64| {
        // Negates the difference if necessary, because edge values inside the triangle are positive.
        let formula = given(first.0, first.1) - given(second.0, second.1);
        if first.1 - second.1 == product { formula } else { -formula }
    };
    scribe.compute(format!("{name} · A"), a, &ends(("y from", from[1]), ("y to", to[1]), a));
    scribe.compute(format!("{name} · B"), b, &ends(("x to", to[0]), ("x from", from[0]), b));
    let formula = -(given("A", a) * given("x from", from[0]) + given("B", b) * given("y from", from[1]));
    scribe.compute(format!("{name} · C"), c, &formula);
    let formula = given("A", a) * given("x", centre[0]) + given("B", b) * given("y", centre[1]) + given("C", c);
    scribe.compute(format!("{name} · value"), *value, &formula)
}

/// Writes the computation of an edge value in floating point: the difference of two products.
fn float<'s, F: Copy + Into<Number>>(
    name: &str,
    steps: &FloatSteps<F>,
    scribe: &'s mut TraceRecorder,
) -> &'s mut TraceLine {
    for axis in 0..2 {
        let part = ["x", "y"][axis];
        let formula =
            given(format!("{part} lower"), steps.lower[axis]) - given(format!("{part} upper"), steps.upper[axis]);
        scribe.compute(format!("{name} · along {part}"), steps.along[axis], &formula);
    }
    for axis in 0..2 {
        let part = ["x", "y"][axis];
        let formula =
            given(format!("{part} centre"), steps.centre[axis]) - given(format!("{part} upper"), steps.upper[axis]);
        scribe.compute(format!("{name} · to centre {part}"), steps.to_centre[axis], &formula);
    }
    for (place, [along, to]) in [["x", "y"], ["y", "x"]].into_iter().enumerate() {
        let formula = given(format!("along {along}"), steps.along[place])
            * given(format!("to centre {to}"), steps.to_centre[1 - place]);
        scribe.compute(format!("{name} · product {}", place + 1), steps.products[place], &formula);
    }
    let difference = given("product 1", steps.products[0]) - given("product 2", steps.products[1]);
    let formula: Formula = if steps.negated { -difference } else { difference };
    scribe.compute(format!("{name} · value"), steps.value, &formula)
}

/// Writes the computation of an edge value by the exact predicate.
fn exact<'s>(
    name: &str,
    ExactSteps { from, to, centre, sign, value }: &ExactSteps,
    scribe: &'s mut TraceRecorder,
) -> &'s mut TraceLine {
    let along = |axis: usize| given(["x to", "y to"][axis], to[axis]) - given(["x from", "y from"][axis], from[axis]);
    let beyond = |axis: usize| given(["x", "y"][axis], centre[axis]) - given(["x from", "y from"][axis], from[axis]);
    let cross = along(0) * beyond(1) - beyond(0) * along(1);
    let formula = if *sign < 0.0 { -cross } else { cross };
    scribe.compute(format!("{name} · value"), *value, &formula)
}

/// Writes whether the pixel's centre lies inside or outside an edge. For a centre on the edge, the fill rule decides.
fn decide(name: &str, steps: &EdgeSteps, value: Number, scribe: &mut TraceRecorder) {
    let value = value.to_f64();
    let kind = edge_kind(steps.inward);
    let (words, decision) = if value > 0.0 {
        (format!("{kind}: the value is > 0"), "inside")
    } else if value == 0.0 && steps.owned {
        (format!("{kind}: the centre is on the edge, and the fill rule assigns the edge to this triangle"), "inside")
    } else if value == 0.0 {
        (format!("{kind}: the centre is on the edge, and the fill rule assigns the edge to the neighbour"), "outside")
    } else {
        (format!("{kind}: the value is not > 0"), "outside")
    };
    scribe.decide(format!("{name} · decision"), words, decision).flag(Notable::Tie, value == 0.0);
}

/// Returns the kind of an edge, such as "left edge", from the direction of its inner side.
fn edge_kind(inward: Inward) -> &'static str {
    match (inward.right, inward.down) {
        (1.., _) => "left edge",
        (..=-1, _) => "right edge",
        (0, 1..) => "top edge",
        (0, ..=-1) => "bottom edge",
        (0, 0) => "zero-length edge",
    }
}
