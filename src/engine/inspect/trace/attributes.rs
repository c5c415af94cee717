//! Trace of the vertex attributes, interpolated with the weights of the corners.

use super::formula::{Formula, given, sum};
use super::line::{TraceRecorder, TraceStage};
use super::names::{AXES, CHANNELS};
use super::subject::TracedFragment;
use crate::inspect::intermediate::Intermediate;
use crate::pipeline::clip_space::Varyings;
use crate::pipeline::formulas::{change as rate, differences, interpolated};
use crate::pipeline::interpolate::{edge_slopes, weight_gradient};
use crate::pipeline::settings::Arithmetic;

/// Writes the trace lines for every attribute that the draw interpolates.
pub(super) fn write(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Attributes);
    let attributes = subject.shader.attributes();
    let fragment = &subject.fragment;
    if attributes.uv {
        for (axis, buffer) in [Intermediate::U, Intermediate::V].into_iter().enumerate() {
            let formula = mixed(subject, |corner| corner.uv[axis]);
            scribe.compute(["u", "v"][axis], fragment.uv[axis], &formula).shown_by(buffer);
        }
    }
    if attributes.normal {
        for (axis, value) in fragment.normal.to_array().into_iter().enumerate() {
            let formula = mixed(subject, |corner| corner.normal[axis]);
            scribe.compute(format!("normal {}", AXES[axis]), value, &formula);
        }
    }
    if attributes.color {
        for (channel, name) in CHANNELS.into_iter().enumerate() {
            let formula = mixed(subject, |corner| corner.color[channel]);
            scribe.compute(format!("vertex {name}"), fragment.color[channel], &formula);
        }
    }
    if attributes.light {
        scribe.compute("light from the corners", fragment.light, &mixed(subject, |corner| corner.light));
    }
    if attributes.source_weights {
        for axis in 0..3 {
            let formula = mixed(subject, |corner| corner.source_weights[axis]);
            scribe.compute(format!("weight of corner {axis} before clipping"), fragment.source_weights[axis], &formula);
        }
    }
    if let Some(arithmetic) = attributes.uv_gradient {
        gradient(subject, arithmetic, scribe);
    }
}

/// Returns the interpolation formula a₀ + p₁·(a₁ − a₀) + p₂·(a₂ − a₀) for one attribute component.
fn mixed(subject: &TracedFragment<'_>, component: impl Fn(&Varyings) -> f32) -> Formula {
    let [_, p1, p2] = subject.fragment.weights;
    interpolated(named(subject, component), [given("weight 1", p1), given("weight 2", p2)])
}

/// Returns an attribute component at the three corners.
fn named(subject: &TracedFragment<'_>, component: impl Fn(&Varyings) -> f32) -> [Formula; 3] {
    let [a, b, c] = subject.triangle.vertices.each_ref().map(|vertex| component(&vertex.varyings));
    [given("a₀", a), given("a₁", b), given("a₂", c)]
}

/// Writes the screen-space gradients of weights and texture coordinates, per pixel in x and in y.
fn gradient(subject: &TracedFragment<'_>, arithmetic: Arithmetic, scribe: &mut TraceRecorder) {
    const DIRECTIONS: [&str; 2] = ["to the right", "downwards"];
    const NAMES: [[&str; 2]; 2] = [["du/dx", "dv/dx"], ["du/dy", "dv/dy"]];
    const BUFFERS: [[Intermediate; 2]; 2] =
        [[Intermediate::DuDx, Intermediate::DvDx], [Intermediate::DuDy, Intermediate::DvDy]];
    let slopes = edge_slopes(subject.triangle, arithmetic);
    let weights = weight_gradient(subject.triangle, &subject.sample, arithmetic);
    for direction in 0..2 {
        let change = |of: &str, corner: usize| format!("change of {of} {corner} in a pixel {}", DIRECTIONS[direction]);
        for (corner, slope) in slopes[direction].into_iter().enumerate() {
            let formula = edge_change(subject, arithmetic, direction, corner);
            scribe.compute(change("edge", corner), slope, &formula);
        }
        for corner in [1, 2] {
            let formula = weight_change(subject, slopes[direction], corner);
            scribe.compute(change("weight", corner), weights[direction][corner - 1], &formula);
        }
        for axis in 0..2 {
            let [first, second] = weights[direction];
            let of_corners = differences(named(subject, |corner| corner.uv[axis]));
            let formula = rate(of_corners, [given("change of weight 1", first), given("change of weight 2", second)]);
            let value = subject.fragment.uv_gradient[direction][axis];
            scribe.compute(NAMES[direction][axis], value, &formula).shown_by(BUFFERS[direction][axis]);
        }
    }
}

/// Returns the formula for the gradient of the edge function opposite to `corner`, per pixel in x (`direction` 0) or y
/// (1). The gradient is the edge rotated by 90°, in the unit of edge values.
fn edge_change(subject: &TracedFragment<'_>, arithmetic: Arithmetic, direction: usize, corner: usize) -> Formula {
    let corners = subject.triangle.corners_in(arithmetic);
    let coordinate = |corner: usize, axis: usize| given(format!("{}{corner}", ["x", "y"][axis]), corners[corner][axis]);
    let between = |from: usize, to: usize, axis: usize| coordinate(to, axis) - coordinate(from, axis);
    let area = between(0, 1, 0) * between(0, 2, 1) - between(0, 1, 1) * between(0, 2, 0);
    let (from, to) = ((corner + 1) % 3, (corner + 2) % 3);
    let side = if direction == 0 { between(to, from, 1) } else { between(from, to, 0) };
    side * (given("doubled area", subject.triangle.doubled_area) / area)
}

/// Returns the formula for the change of a weight pᵢ per pixel: (qᵢ′ − pᵢ·Σ qⱼ′) / Σ qⱼ, where ′ denotes the change per
/// pixel. The weight is pᵢ = qᵢ / Σ qⱼ with qᵢ = edgeᵢ·rᵢ, where rᵢ is the relative 1/w of corner i.
fn weight_change(subject: &TracedFragment<'_>, slopes: [f32; 3], corner: usize) -> Formula {
    const EDGES: [&str; 3] = ["edge 0", "edge 1", "edge 2"];
    const CHANGES: [&str; 3] = ["change of edge 0", "change of edge 1", "change of edge 2"];
    let relative = |corner: usize| given(["r₀", "r₁", "r₂"][corner], subject.triangle.relative_inv_w[corner]);
    let q = |corner: usize| given(EDGES[corner], subject.sample.edges[corner] as f32) * relative(corner);
    let change = |corner: usize| given(CHANGES[corner], slopes[corner]) * relative(corner);
    let total = || sum((0..3).map(q));
    (change(corner) - q(corner) / total() * sum((0..3).map(change))) / total()
}
