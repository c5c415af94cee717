//! Trace of the interpolation weights: from edge values to screen-space and perspective-correct weights.

use super::formula::{Formula, given, sum, whole};
use super::line::{TraceRecorder, TraceStage};
use super::subject::TracedFragment;
use crate::inspect::intermediate::{Intermediate, inv_w_at};
use crate::pipeline::formulas::{sum_of_three, weight_products};
use crate::pipeline::interpolate::{WeightTerms, affine_weights, attribute_weights, inverse_area, weight_terms};
use crate::pipeline::settings::Interpolation;

const CORNERS: [usize; 3] = [0, 1, 2];
const LAMBDAS: [Intermediate; 3] = [Intermediate::Lambda0, Intermediate::Lambda1, Intermediate::Lambda2];
const WEIGHTS: [Intermediate; 3] = [Intermediate::Weight0, Intermediate::Weight1, Intermediate::Weight2];

/// Writes the trace lines for the screen-space weights and the attribute weights.
pub(super) fn write(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Weights);
    let (triangle, sample) = (subject.triangle, &subject.sample);
    let edges = sample.edges.map(|edge| edge as f32);
    for (corner, edge) in edges.into_iter().enumerate() {
        scribe.compute(format!("edge {corner} as f32"), edge, &given("edge value", sample.edges[corner]));
    }
    let area = triangle.doubled_area as f32;
    scribe.compute("area as f32", area, &given("doubled area", triangle.doubled_area));
    let inverse = inverse_area(triangle);
    scribe.compute("1/area", inverse, &(whole("1", 1) / given("area", area)));
    let lambda = affine_weights(triangle, sample);
    for corner in 0..3 {
        let formula = given(format!("edge {corner}"), edges[corner]) * given("1/area", inverse);
        scribe.compute(format!("λ{corner} on the screen"), lambda[corner], &formula).shown_by(LAMBDAS[corner]);
    }
    let weights = attribute_weights(triangle, sample, subject.settings.interpolation);
    if subject.settings.interpolation == Interpolation::Published {
        published(subject, weights, scribe);
    } else {
        in_space(subject, edges, weights, scribe);
    }
    asides(subject, lambda, scribe);
}

/// Writes the trace lines for the attribute weights: edge values × relative 1/w, divided by their sum.
fn in_space(subject: &TracedFragment<'_>, edges: [f32; 3], weights: [f32; 3], scribe: &mut TraceRecorder) {
    let WeightTerms { q, sum: total, inverse_sum } = weight_terms(subject.triangle, &subject.sample);
    let edges = CORNERS.map(|corner| given(format!("edge {corner}"), edges[corner]));
    let relative = subject.triangle.relative_inv_w.map(|relative| given("relative 1/w", relative));
    for (corner, formula) in weight_products(edges, relative).iter().enumerate() {
        scribe.compute(format!("q{corner}"), q[corner], formula);
    }
    let formula = sum_of_three(CORNERS.map(|corner| given(format!("q{corner}"), q[corner])));
    scribe.compute("sum of q", total, &formula);
    scribe.compute("1/sum", inverse_sum, &(whole("1", 1) / given("sum of q", total)));
    for corner in 0..3 {
        let formula = given(format!("q{corner}"), q[corner]) * given("1/sum", inverse_sum);
        scribe.compute(format!("weight {corner}"), weights[corner], &formula).shown_by(WEIGHTS[corner]);
    }
}

/// Writes the trace lines for the weights by the published formula, which divides by the horizontal extent of one edge.
fn published(subject: &TracedFragment<'_>, weights: [f32; 3], scribe: &mut TraceRecorder) {
    let corners = subject.triangle.corners_px();
    let coordinate = |corner: usize, axis: usize| given(format!("{}{corner}", ["x", "y"][axis]), corners[corner][axis]);
    let side = |to: usize, axis: usize| coordinate(to, axis) - coordinate(0, axis);
    let centre = [subject.sample.x, subject.sample.y].map(|pixel| pixel as f32 + 0.5);
    let p = |axis: usize| given(["x", "y"][axis], centre[axis]) - coordinate(0, axis);
    let [first, b, a] = weights;
    let of_b: Formula = (p(1) * side(2, 0) - p(0) * side(2, 1)) / (side(1, 1) * side(2, 0) - side(1, 0) * side(2, 1));
    scribe.compute("weight 1", b, &of_b).shown_by(WEIGHTS[1]);
    let of_a = (p(0) - side(1, 0) * given("weight 1", b)) / side(2, 0);
    scribe.compute("weight 2", a, &of_a).shown_by(WEIGHTS[2]);
    let rest = whole("1", 1) - given("weight 2", a) - given("weight 1", b);
    scribe.compute("weight 0", first, &rest).shown_by(WEIGHTS[0]);
}

/// Writes 1/w and w at the sample as asides, because the pipeline does not compute them.
fn asides(subject: &TracedFragment<'_>, lambda: [f32; 3], scribe: &mut TraceRecorder) {
    let inv_w = subject.triangle.vertices.each_ref().map(|vertex| vertex.inv_w);
    let at_sample = inv_w_at(subject.triangle, &subject.sample);
    let term = |corner: usize| given(format!("λ{corner}"), lambda[corner]) * given("1/w", inv_w[corner]);
    scribe.aside("1/w at the sample", at_sample, &sum((0..3).map(term))).shown_by(Intermediate::InvW);
    let formula = whole("1", 1) / given("1/w", at_sample);
    scribe.aside("w at the sample", 1.0 / at_sample, &formula).shown_by(Intermediate::Distance);
}
