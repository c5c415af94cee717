//! What the corners bring along, mixed by the weights.

use super::formula::{Formula, given, sum};
use super::geometry::AXES;
use super::line::{Scribe, TraceStage};
use super::subject::Subject;
use crate::inspect::intermediate::Intermediate;
use crate::pipeline::vertex::Varyings;

/// Channels of a colour.
pub(super) const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Writes every attribute that the draw interpolates.
pub(super) fn write(subject: &Subject<'_>, scribe: &mut Scribe) {
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
    if attributes.uv_gradient {
        gradient(subject, scribe);
    }
}

/// a₀ + p₁·(a₁ − a₀) + p₂·(a₂ − a₀) of one component.
fn mixed(subject: &Subject<'_>, component: impl Fn(&Varyings) -> f32) -> Formula {
    let [a, b, c] = subject.triangle.vertices.each_ref().map(|vertex| component(&vertex.varyings));
    let [_, p1, p2] = subject.fragment.weights;
    let from_first = |name: &'static str, value: f32| given(name, value) - given("a₀", a);
    given("a₀", a) + from_first("a₁", b) * given("weight 1", p1) + from_first("a₂", c) * given("weight 2", p2)
}

/// What texture coordinates change by from pixel to pixel: of u = N / D, with N and D affine on the screen, the derivative is
/// (N' − u·D') / D.
fn gradient(subject: &Subject<'_>, scribe: &mut Scribe) {
    const NAMES: [[&str; 2]; 2] = [["du/dx", "dv/dx"], ["du/dy", "dv/dy"]];
    const BUFFERS: [[Intermediate; 2]; 2] =
        [[Intermediate::DuDx, Intermediate::DvDx], [Intermediate::DuDy, Intermediate::DvDy]];
    for direction in 0..2 {
        for axis in 0..2 {
            let value = subject.fragment.uv_gradient[direction][axis];
            let formula = derivative(subject, direction, axis);
            let line = scribe.compute(NAMES[direction][axis], value, &formula).shown_by(BUFFERS[direction][axis]);
            // Written out it would fill a page.
            line.formula = format!("(N′ − {}·D′) / D with N = Σ {0}ᵢ·rᵢ·λᵢ, D = Σ rᵢ·λᵢ", ["u", "v"][axis]);
            line.numbers = String::new();
        }
    }
}

fn derivative(subject: &Subject<'_>, direction: usize, axis: usize) -> Formula {
    let corners = subject.triangle.corners_px();
    let coordinate = |corner: usize, axis: usize| given(format!("{}{corner}", ["x", "y"][axis]), corners[corner][axis]);
    let side = |to: usize, axis: usize| coordinate(to, axis) - coordinate(0, axis);
    let area = || side(1, 0) * side(2, 1) - side(1, 1) * side(2, 0);
    // What each λ changes by in a pixel to the right, or downwards.
    let by_screen = |corner: usize| {
        let (a, b) = ((corner + 1) % 3, (corner + 2) % 3);
        let across =
            if direction == 0 { coordinate(a, 1) - coordinate(b, 1) } else { coordinate(b, 0) - coordinate(a, 0) };
        across / area()
    };
    let relative = |corner: usize| given("r", subject.triangle.relative_inv_w[corner]);
    let edge = |corner: usize| given(format!("edge {corner}"), subject.sample.edges[corner] as f32);
    let uv = |corner: usize| given(["u", "v"][axis], subject.triangle.vertices[corner].varyings.uv[axis]);
    let numerator = sum((0..3).map(|corner| uv(corner) * relative(corner) * by_screen(corner)));
    let divisor_change = sum((0..3).map(|corner| relative(corner) * by_screen(corner)));
    let divisor = sum((0..3).map(|corner| relative(corner) * edge(corner))) / sum((0..3).map(edge));
    let here = given(["u here", "v here"][axis], subject.fragment.uv[axis]);
    (numerator - here * divisor_change) / divisor
}
