//! Trace from clip space to screen space: perspective division, viewport transform, snapping, and the depth of each
//! corner.

use super::formula::{Formula, Function, fraction, given, whole};
use super::geometry::NamedVertex;
use super::line::{Notable, TraceRecorder, TraceStage};
use super::subject::TracedFragment;
use crate::math::fixed::SUBPIXELS;
use crate::pipeline::clip_space::{ClipPlane, ClipVertex};
use crate::pipeline::depth::{DepthLaw, DepthSource};
use crate::pipeline::plan::{PipelinePart, PlanStep};
use crate::pipeline::project::divided;
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::pipeline::settings::Arithmetic;

/// Writes the trace lines for projecting all corners of the triangle.
pub(super) fn write(subject: &TracedFragment<'_>, corners: &[NamedVertex], scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Project);
    for (corner, screen) in corners.iter().zip(&subject.triangle.vertices) {
        position(subject, corner, screen, scribe);
    }
    for (corner, NamedVertex { name, vertex }) in corners.iter().enumerate() {
        let screen = &subject.triangle.vertices[corner];
        let depth = depth_formula(subject, vertex, screen);
        scribe.compute(format!("{name} · depth"), screen.depth, &depth);
    }
    relative(subject, corners, scribe);
}

fn position(
    subject: &TracedFragment<'_>,
    NamedVertex { name, vertex }: &NamedVertex,
    screen: &ScreenVertex,
    scribe: &mut TraceRecorder,
) {
    let (inv_w, ndc) = divided(vertex);
    scribe.compute(format!("{name} · 1/w"), inv_w, &(whole("1", 1) / given("w", vertex.position.w)));
    for (axis, part) in ["x", "y"].into_iter().enumerate() {
        let formula = given(format!("clip {part}"), vertex.position[axis]) * given("1/w", inv_w);
        scribe.compute(format!("{name} · ndc {part}"), ndc[axis], &formula);
    }
    let half = || fraction("½", 1, 2);
    let (width, height) = (f64::from(subject.raster.width), f64::from(subject.raster.height));
    let x = (given("ndc x", ndc.x) * half() + half()) * given("width", width as f32);
    let y = (half() - given("ndc y", ndc.y) * half()) * given("height", height as f32);
    let [x_px, y_px] = screen.position_px;
    scribe.compute(format!("{name} · x in px"), x_px, &x);
    scribe.compute(format!("{name} · y in px"), y_px, &y);
    for (part, px, snapped) in [("x", x_px, screen.x), ("y", y_px, screen.y)] {
        let steps = given(format!("{part} in px"), px) * whole("256", SUBPIXELS);
        let is_tie = steps.evaluate().is_some_and(|exact| {
            let twice = exact.value.shifted(1);
            twice == twice.floor() && exact.value != exact.value.floor()
        });
        let line =
            scribe.compute(format!("{name} · snapped {part}"), i64::from(snapped), &steps.apply(Function::Round));
        line.flag(Notable::Tie, is_tie);
        line.aside = subject.settings.arithmetic != Arithmetic::Fixed;
    }
}

/// Returns the formula for a corner's depth in [0, 1].
fn depth_formula(subject: &TracedFragment<'_>, vertex: &ClipVertex, screen: &ScreenVertex) -> Formula {
    let scale = &subject.frame.geometry().depth_scale;
    if let Some(plane) = vertex.cut_at {
        let name =
            if subject.plane_of_view(plane) == ClipPlane::Near { "on the near plane" } else { "on the far plane" };
        return given(name, screen.depth);
    }
    let w = || given("w", vertex.position.w);
    let DepthLaw { mapping, source } = scale.law();
    let depth = match source {
        DepthSource::Distance => {
            let [zero, factor] = scale.zero_and_factor();
            let zero = given(if mapping.is_reversed() { "far" } else { "near" }, zero);
            mapping.depth(w(), zero, given("factor", factor))
        }
        DepthSource::ClipSpace => given("clip z", vertex.position.z) / w(),
    };
    depth.max(whole("0", 0)).min(whole("1", 1))
}

/// Writes the trace lines for each corner's 1/w divided by the largest 1/w. Interpolation weights are computed from
/// these quotients.
fn relative(subject: &TracedFragment<'_>, corners: &[NamedVertex], scribe: &mut TraceRecorder) {
    if let PlanStep::Skipped(reason) = subject.plan.step(PipelinePart::PerspectiveDivision) {
        scribe.decide("relative 1/w", reason, "1 at all corners");
        return;
    }
    let inv_w = subject.triangle.vertices.each_ref().map(|corner| corner.inv_w);
    let largest = inv_w[0].max(inv_w[1]).max(inv_w[2]);
    for (corner, NamedVertex { name, .. }) in corners.iter().enumerate() {
        let formula = given("1/w", inv_w[corner]) / given("largest 1/w", largest);
        scribe.compute(format!("{name} · relative 1/w"), subject.triangle.relative_inv_w[corner], &formula);
    }
}
