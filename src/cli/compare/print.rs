//! Errors of a comparison as text and as JSON.

use crate::measure::metric::Metric;
use crate::measure::picture_error::ValueScale;
use crate::measure::tone::Tone;
use crate::pipeline::settings::Choice;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{CompareArgs, Input, Inputs, Measured, exceeded, tone, value_of};
use crate::cli::output;

/// Returns the role of the better picture by a metric, or `None` if both are equally good.
fn better(metric: Metric, measured: &[Measured]) -> Option<&'static str> {
    let [a, b] = measured else { return None };
    let (of_a, of_b) = (value_of(&a.errors, metric)?, value_of(&b.errors, metric)?);
    let order = if metric.is_larger_better() { of_a.partial_cmp(&of_b) } else { of_b.partial_cmp(&of_a) };
    match order? {
        std::cmp::Ordering::Greater => Some(a.of),
        std::cmp::Ordering::Less => Some(b.of),
        std::cmp::Ordering::Equal => None,
    }
}

/// Names the better picture in words; empty without a reference.
pub(super) fn verdict(inputs: &Inputs<'_>, measured: &[Measured]) -> String {
    let [a, _] = measured else { return String::new() };
    let metrics = a.errors.metrics.iter().map(|(metric, _)| *metric);
    let by = |role: &str| -> Vec<&str> {
        metrics.clone().filter(|metric| better(*metric, measured) == Some(role)).map(Choice::id).collect()
    };
    let path = |input: &Input<'_>| output::display(input.path);
    match (by("A"), by("B")) {
        (of_a, of_b) if of_a.is_empty() && of_b.is_empty() => "A and B are equally good\n".to_owned(),
        (_, of_b) if of_b.is_empty() => format!("A is better: {}\n", path(&inputs.a)),
        (of_a, _) if of_a.is_empty() => format!("B is better: {}\n", path(&inputs.b)),
        (of_a, of_b) => format!("A is better by {}, B by {}\n", of_a.join(", "), of_b.join(", ")),
    }
}

/// Returns the line that names the exposure and the tone curve of linear light; empty for other values.
pub(super) fn tone_line(args: &CompareArgs, measured: &[Measured]) -> String {
    if measured.iter().all(|measured| measured.scale != ValueScale::Linear) {
        return String::new();
    }
    let Tone { exposure, curve } = tone(args);
    format!("SSIM and perceptual metrics: exposure {exposure} EV, tone curve {}, 8-bit sRGB\n", curve.name())
}

/// Returns the line that names the viewing conditions of ColorVideoVDP; empty if it was not measured.
pub(super) fn viewing_line(args: &CompareArgs, measured: &[Measured]) -> String {
    if measured.iter().all(|measured| value_of(&measured.errors, Metric::Jod).is_none()) {
        return String::new();
    }
    format!("{}: {} pixels per degree\n", Metric::Jod.name(), args.pixels_per_degree)
}

/// Returns the comparison as text.
pub(super) fn text(args: &CompareArgs, inputs: &Inputs<'_>, measured: &[Measured]) -> String {
    let mut text = String::new();
    for Input { role, path, picture } in inputs.all() {
        text += &format!("{role}: {}: {}\n", output::display(path), picture.description());
    }
    for Measured { of, against, scale, errors } in measured {
        text += &format!("{of} against {against}, {}\n", scale.name());
        for (metric, value) in &errors.metrics {
            let Some(value) = value else { continue };
            text += &format!("  {}: {}\n", metric.name(), metric.format(*value));
        }
        if errors.non_finite_pixels > 0 {
            let count = errors.non_finite_pixels;
            text += &format!("  {count} pixels are NaN or infinite in one picture only and are left out\n");
        }
    }
    text += &verdict(inputs, measured);
    text += &tone_line(args, measured);
    text += &viewing_line(args, measured);
    if let Some(path) = args.output.as_ref().filter(|path| output::is_html(path)) {
        text += &format!("{}: pictures, their difference, and errors\n", output::display(path));
    } else if let Some(path) = &args.output {
        let (kind, gain) = (args.difference.name().to_lowercase(), args.gain);
        text += &format!("{}: {kind} difference of A and B, × {gain}\n", output::display(path));
    }
    text
}

/// Comparison of picture files, as JSON.
#[derive(Serialize)]
pub(super) struct CompareReport {
    pictures: Vec<Value>,
    layer: Option<String>,
    /// Exposure and tone curve of linear light for SSIM and perceptual metrics.
    tone: Tone,
    /// Pixels per degree of visual angle for ColorVideoVDP.
    pixels_per_degree: f64,
    errors: Vec<Value>,
    /// Better picture by each metric; empty without a reference.
    better: Map<String, Value>,
    /// Violated bounds in words.
    exceeded: Vec<String>,
}

/// Returns the errors of one picture against another as JSON.
pub(super) fn errors(Measured { of, against, scale, errors }: &Measured) -> Value {
    let values = errors.metrics.iter().filter_map(|(metric, value)| Some((metric.id().to_owned(), json!((*value)?))));
    json!({
        "of": of,
        "against": against,
        "scale": scale,
        "metrics": values.collect::<Map<_, _>>(),
        "non_finite_pixels": errors.non_finite_pixels,
    })
}

/// Returns the comparison as JSON.
pub(super) fn report(args: &CompareArgs, inputs: &Inputs<'_>, measured: &[Measured]) -> CompareReport {
    let picture = |input: &Input<'_>| {
        let (width, height) = input.picture.size();
        let channels: Vec<_> = input
            .picture
            .channels()
            .iter()
            .map(|channel| json!({ "name": channel.name, "type": channel.kind() }))
            .collect();
        json!({
            "role": input.role,
            "path": output::display(input.path),
            "format": input.picture.format(),
            "size": [width, height],
            "channels": channels,
        })
    };
    let metrics = measured.first().into_iter().flat_map(|measured| &measured.errors.metrics);
    let better = metrics
        .filter(|_| measured.len() > 1)
        .map(|(metric, _)| (metric.id().to_owned(), json!(better(*metric, measured))));
    CompareReport {
        pictures: inputs.all().map(picture).collect(),
        layer: args.layer.clone(),
        tone: tone(args),
        pixels_per_degree: args.pixels_per_degree,
        errors: measured.iter().map(errors).collect(),
        better: better.collect(),
        exceeded: exceeded(args, measured),
    }
}
