//! Trace of the fragment's depth, from interpolation to the stored format, and of the depth test.

use super::formula::{Formula, given, sum, whole};
use super::line::{Notable, TraceRecorder, TraceStage};
use super::subject::TracedFragment;
use crate::inspect::depth::DepthRecord;
use crate::inspect::intermediate::Intermediate;
use crate::pipeline::depth::{DepthComparison, TriangleBias};
use crate::pipeline::screen_triangle::{depth_at, unquantised_depth_at};
use crate::pipeline::settings::DepthBias;

/// Writes the trace lines for the fragment's depth and the depth test.
pub(super) fn write(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Depth);
    if subject.record.stored_depth.is_none() {
        scribe.decide("depth test", "off: the triangle drawn last is visible", "passes");
        return;
    }
    let (triangle, sample) = (subject.triangle, &subject.sample);
    let (biased_least, rises) = triangle.depth.terms();
    let depths = triangle.vertices.each_ref().map(|vertex| vertex.depth);
    let of_least = given("depth 0", depths[0]).min(given("depth 1", depths[1])).min(given("depth 2", depths[2]));
    let least = depths[0].min(depths[1]).min(depths[2]);
    scribe.compute("least depth", least, &of_least);
    let is_linear = triangle.depth.is_linear_in_space();
    for corner in 0..3 {
        let above = given(format!("depth {corner}"), depths[corner]) - given("least", least);
        let formula = if is_linear { above } else { above / given("doubled area", triangle.doubled_area) };
        scribe.compute(format!("rise {corner}"), rises[corner], &formula);
    }
    bias(subject, least, biased_least, scribe);
    let least = biased_least;
    let formula = if is_linear { in_space(subject, least, rises) } else { on_screen(sample.edges, least, rises) };
    let unquantised = unquantised_depth_at(triangle, sample);
    let within = formula.max(whole("0", 0)).min(whole("1", 1));
    scribe.compute("depth in f64", unquantised, &within);
    let depth = DepthRecord::new(depth_at(triangle, sample), subject.frame.depth_scale());
    stored(unquantised, &depth, subject, scribe);
    scribe.read("one step in world units", "to the next depth that can be stored", depth.resolution);
    test(subject, &depth, scribe);
}

/// Writes the depth bias, if one is set: its terms, and the biased minimum depth of the corners.
fn bias(subject: &TracedFragment<'_>, least: f64, biased_least: f64, scribe: &mut TraceRecorder) {
    let Some(bias) = subject.frame.geometry().depth_scale.bias_of(&subject.triangle.vertices) else { return };
    let TriangleBias { gradient: [along_x, along_y], slope, step, offset } = bias;
    scribe.read("∂z/∂x", "change of the triangle's depth per px to the right, from its corners", along_x);
    scribe.read("∂z/∂y", "change of the triangle's depth per px downwards, from its corners", along_y);
    let magnitude = |name: &'static str, value: f64| given(name, value).max(-given(name, value));
    scribe.compute("slope m", slope, &magnitude("∂z/∂x", along_x).max(magnitude("∂z/∂y", along_y)));
    scribe.read("smallest difference r", "one step of the format at the triangle's greatest depth", step);
    let DepthBias { constant, slope: factor } = subject.settings.depth_bias;
    let formula = given("m", slope) * given("depth_bias.slope", factor)
        + given("r", step) * given("depth_bias.constant", constant);
    scribe.compute("depth bias", offset, &formula);
    scribe.compute("least depth, biased", biased_least, &(given("least", least) + given("bias", offset)));
}

fn on_screen(edges: [f64; 3], least: f64, rises: [f64; 3]) -> Formula {
    let term = |corner: usize| given(format!("edge {corner}"), edges[corner]) * given("rise", rises[corner]);
    given("least", least) + sum((0..3).map(term))
}

fn in_space(subject: &TracedFragment<'_>, least: f64, rises: [f64; 3]) -> Formula {
    let inv_w = subject.triangle.vertices.each_ref().map(|vertex| f64::from(vertex.inv_w));
    let weight = |corner: usize| {
        let edge = given(format!("edge {corner}"), subject.sample.edges[corner]).max(whole("0", 0));
        edge * given("1/w", inv_w[corner])
    };
    let above = sum((0..3).map(|corner| weight(corner) * given("rise", rises[corner])));
    given("least", least) + above / sum((0..3).map(weight))
}

/// Writes the conversion of the depth to the format of the depth buffer.
fn stored(unquantised: f64, depth: &DepthRecord, subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    let depth64 = || given("depth in f64", unquantised);
    match depth.code.zip(subject.frame.depth_scale().encoding().largest_code()) {
        None => {
            scribe.compute("depth as stored", depth.value, &depth64()).shown_by(Intermediate::Depth);
        }
        Some((code, largest)) => {
            scribe.compute("code", code, &(depth64() * given("largest code", largest)));
            let formula = given("code", code) / given("largest code", largest);
            scribe.compute("depth as stored", depth.value, &formula).shown_by(Intermediate::Depth);
        }
    }
}

fn test(subject: &TracedFragment<'_>, depth: &DepthRecord, scribe: &mut TraceRecorder) {
    let Some(stored) = subject.record.stored_depth else { return };
    scribe.read("depth in the buffer", "the stored depth before this fragment", stored.value);
    let comparison = DepthComparison::of(subject.settings);
    let passes = comparison.passes(depth.value, stored.value);
    let steps = depth.steps_from(&stored);
    let step = if depth.code.is_some() { "codes" } else { "ulp" };
    let sign = comparison.symbol();
    let words = match comparison {
        DepthComparison::Always => "every fragment passes".to_owned(),
        _ => format!("{} {sign} {}? The difference is {steps} {step}", depth.value, stored.value),
    };
    let line = scribe.decide("depth test", words, if passes { "passes" } else { "fails" });
    line.flag(Notable::DepthEqual, depth.value == stored.value);
    line.flag(Notable::Tie, depth.value == stored.value && comparison != DepthComparison::Always);
}
