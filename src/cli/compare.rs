//! `rasterscope compare`: measures the error between picture files, without a scene.

use std::path::{Path, PathBuf};

use crate::image::file::write_png;
use crate::image::picture::{Layer, Picture, format_names};
use crate::measure::difference::{self, Difference};
use crate::measure::picture_error::{LayerPair, Metric, PictureErrors, PictureLayer, ValueScale};
use crate::measure::tone::{Tone, ToneCurve};
use crate::pipeline::settings::Choice;
use clap::Args;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::failure::Failure;
use super::{output, parse};

/// Arguments of `compare`.
#[derive(Args, Debug)]
pub(crate) struct CompareArgs {
    #[arg(value_name = "A", help = format!("Picture A: {}", format_names()))]
    a: PathBuf,

    /// Picture B
    #[arg(value_name = "B")]
    b: PathBuf,

    /// Reference picture: measure A and B against it, and name the better one
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,

    /// Metric to print; may be given several times [default: all that apply]
    #[arg(long, value_name = "METRIC", value_parser = parse::choice::<Metric>())]
    metric: Vec<Metric>,

    /// Largest allowed value of a metric; exit code 1 if it is exceeded. May be given several times
    #[arg(long, value_name = "METRIC=VALUE", value_parser = limit)]
    max: Vec<Limit>,

    /// Smallest allowed value of a metric; exit code 1 if it is not reached. May be given several times
    #[arg(long, value_name = "METRIC=VALUE", value_parser = limit)]
    min: Vec<Limit>,

    /// Layer to compare, such as `diffuse` or `Z` [default: the first colour of each picture]
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,

    /// Exposure in stops of float pictures, for FLIP and SSIM
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_hyphen_values = true, value_parser = exposure)]
    exposure: f32,

    /// Tone curve of float pictures, for FLIP and SSIM
    #[arg(long, value_name = "CURVE", default_value = "clamp", value_parser = parse::choice::<ToneCurve>())]
    tone_curve: ToneCurve,

    /// Difference that the picture of `--output` shows
    #[arg(long, value_name = "KIND", default_value = "absolute", value_parser = parse::choice::<Difference>())]
    difference: Difference,

    /// Factor by which the picture of `--output` amplifies differences
    #[arg(long, value_name = "FACTOR", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    gain: u32,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,

    /// PNG file for the difference of A and B
    #[arg(short, long, value_name = "FILE.png")]
    output: Option<PathBuf>,
}

/// Bound of a metric.
#[derive(Clone, Copy, Debug)]
struct Limit {
    metric: Metric,
    value: f64,
}

/// Parses a bound such as `flip=0.01`.
fn limit(text: &str) -> Result<Limit, String> {
    let (id, value) = text.split_once('=').ok_or("expected a metric and a value, such as flip=0.01")?;
    let ids = || Metric::ALL.iter().map(|metric| metric.id()).collect::<Vec<_>>().join(", ");
    let metric = Metric::ALL.iter().copied().find(|metric| metric.id() == id);
    let metric = metric.ok_or_else(|| format!("{id} is not a metric; the metrics are {}", ids()))?;
    let value = value.parse().ok().filter(|value: &f64| !value.is_nan());
    Ok(Limit { metric, value: value.ok_or("the value after `=` must be a number")? })
}

/// Parses an exposure in stops.
fn exposure(text: &str) -> Result<f32, String> {
    let stops = text.parse().ok().filter(|stops: &f32| stops.abs() <= 100.0);
    stops.ok_or_else(|| "expected an exposure from -100 to 100 stops".to_owned())
}

/// Picture file that takes part in the comparison.
struct Input<'a> {
    /// Name in the output: `A`, `B` or `reference`.
    role: &'static str,
    path: &'a Path,
    picture: Picture,
}

/// Errors of one picture against another.
struct Measured<'a> {
    of: &'a Input<'a>,
    against: &'a Input<'a>,
    scale: ValueScale,
    errors: PictureErrors,
}

/// Runs `compare`: reads the pictures, measures and prints their errors, and checks the bounds.
pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    check_bounds(args)?;
    let input = |role: &'static str, path| Picture::read(path).map(|picture| Input { role, path, picture });
    let (a, b) = (input("A", args.a.as_path())?, input("B", args.b.as_path())?);
    let reference = args.reference.as_deref().map(|path| input("reference", path)).transpose()?;
    let tone = Tone { exposure: args.exposure, curve: args.tone_curve };
    let metrics = metrics(args);
    let pair = pair(args, &a, &b, tone)?;
    let measured = match &reference {
        None => vec![Measured { of: &a, against: &b, scale: pair.scale(), errors: pair.measure(&metrics) }],
        Some(reference) => {
            let against = |of| {
                let pair = self::pair(args, of, reference, tone)?;
                Ok(Measured { of, against: reference, scale: pair.scale(), errors: pair.measure(&metrics) })
            };
            [&a, &b].into_iter().map(against).collect::<Result<_, Failure>>()?
        }
    };
    check_defined(args, &measured)?;
    if let Some(path) = &args.output {
        let values = pair.difference(args.difference);
        write_png(path, &difference::picture(args.difference, args.gain, &values))?;
    }
    let inputs: Vec<&Input<'_>> = [&a, &b].into_iter().chain(&reference).collect();
    let exceeded = exceeded(args, &measured);
    if args.json {
        output::print_json(&report(args, tone, &inputs, &measured))?;
    } else {
        output::print(&text(args, tone, &inputs, &measured))?;
    }
    if exceeded.is_empty() { Ok(()) } else { Err(Failure::OutOfBounds(exceeded.join("; "))) }
}

/// Checks that `--max` has errors and `--min` has similarities.
fn check_bounds(args: &CompareArgs) -> Result<(), Failure> {
    for (option, other, limits, wants_larger) in
        [("--max", "--min", &args.max, false), ("--min", "--max", &args.min, true)]
    {
        if let Some(Limit { metric, .. }) = limits.iter().find(|limit| limit.metric.is_larger_better() != wants_larger)
        {
            let which = if wants_larger { "smaller" } else { "larger" };
            return Err(Failure::Usage(format!(
                "{option} {}: {which} values are better; use {other} {}=VALUE",
                metric.id(),
                metric.id()
            )));
        }
    }
    Ok(())
}

/// Returns the metrics to print: those requested, or all, and those with bounds.
fn metrics(args: &CompareArgs) -> Vec<Metric> {
    let is_bounded = |metric: &Metric| args.max.iter().chain(&args.min).any(|limit| limit.metric == *metric);
    let is_wanted = |metric: &&Metric| args.metric.is_empty() || args.metric.contains(metric) || is_bounded(metric);
    Metric::ALL.iter().filter(is_wanted).copied().collect()
}

/// Returns the compared layer of a picture.
fn layer<'a>(args: &CompareArgs, input: &'a Input<'_>) -> Result<&'a Layer, Failure> {
    let layers = input.picture.layers();
    let Some(name) = &args.layer else { return Ok(&layers[0]) };
    layers.iter().find(|layer| layer.name == *name).ok_or_else(|| {
        let known: Vec<_> = layers.iter().map(|layer| layer.name.as_str()).collect();
        Failure::Usage(format!("{}: no layer {name}; its layers are {}", output::display(input.path), known.join(", ")))
    })
}

fn pair<'a>(args: &CompareArgs, a: &'a Input<'_>, b: &'a Input<'_>, tone: Tone) -> Result<LayerPair<'a>, Failure> {
    let of = |input: &'a Input<'_>| layer(args, input).map(|layer| PictureLayer { picture: &input.picture, layer });
    LayerPair::new(of(a)?, of(b)?, tone).map_err(|reason| {
        Failure::Usage(format!("{} and {}: {reason}", output::display(a.path), output::display(b.path)))
    })
}

/// Checks that every metric that the user names is defined for the layer.
fn check_defined(args: &CompareArgs, measured: &[Measured<'_>]) -> Result<(), Failure> {
    let bounded = args.max.iter().chain(&args.min).map(|limit| limit.metric);
    let named: Vec<Metric> = args.metric.iter().copied().chain(bounded).collect();
    let is_data = measured.iter().any(|measured| measured.scale == ValueScale::Stored);
    match named.iter().find(|metric| is_data && !metric.measures_data()) {
        Some(metric) => Err(Failure::Usage(format!(
            "{}: not defined for data that are no colours; use mse, max or changed",
            metric.id()
        ))),
        None => Ok(()),
    }
}

/// Returns every violated bound in words. A pixel that is NaN or infinite in one picture only violates every bound.
fn exceeded(args: &CompareArgs, measured: &[Measured<'_>]) -> Vec<String> {
    let mut words = Vec::new();
    for Measured { of, against, errors, .. } in measured {
        let bounds = args.max.iter().map(|limit| (limit, "above")).chain(args.min.iter().map(|limit| (limit, "below")));
        for (Limit { metric, value: bound }, side) in bounds {
            let value = value_of(errors, *metric).unwrap_or(f64::NAN);
            let is_beyond = if side == "above" { value > *bound } else { value < *bound };
            if is_beyond {
                words.push(format!("{} against {}: {} {value} is {side} {bound}", of.role, against.role, metric.id()));
            }
        }
        let has_bounds = !args.max.is_empty() || !args.min.is_empty();
        if has_bounds && errors.non_finite_pixels > 0 {
            let count = errors.non_finite_pixels;
            words.push(format!(
                "{} against {}: {count} pixels are NaN or infinite in one of them",
                of.role, against.role
            ));
        }
    }
    words
}

fn value_of(errors: &PictureErrors, wanted: Metric) -> Option<f64> {
    errors.metrics.iter().find(|(metric, _)| *metric == wanted).and_then(|(_, value)| *value)
}

/// Returns the role of the better picture by a metric, or `None` if both are equally good.
fn better(metric: Metric, measured: &[Measured<'_>]) -> Option<&'static str> {
    let [a, b] = measured else { return None };
    let (of_a, of_b) = (value_of(&a.errors, metric)?, value_of(&b.errors, metric)?);
    let order = if metric.is_larger_better() { of_a.partial_cmp(&of_b) } else { of_b.partial_cmp(&of_a) };
    match order? {
        std::cmp::Ordering::Greater => Some(a.of.role),
        std::cmp::Ordering::Less => Some(b.of.role),
        std::cmp::Ordering::Equal => None,
    }
}

/// Names the better picture in words; empty without a reference.
fn verdict(measured: &[Measured<'_>]) -> String {
    let [a, b] = measured else { return String::new() };
    let metrics = a.errors.metrics.iter().map(|(metric, _)| *metric);
    let by = |role: &str| -> Vec<&str> {
        metrics.clone().filter(|metric| better(*metric, measured) == Some(role)).map(Choice::id).collect()
    };
    let path = |input: &Input<'_>| output::display(input.path);
    match (by("A"), by("B")) {
        (of_a, of_b) if of_a.is_empty() && of_b.is_empty() => "A and B are equally good\n".to_owned(),
        (_, of_b) if of_b.is_empty() => format!("A is better: {}\n", path(a.of)),
        (of_a, _) if of_a.is_empty() => format!("B is better: {}\n", path(b.of)),
        (of_a, of_b) => format!("A is better by {}, B by {}\n", of_a.join(", "), of_b.join(", ")),
    }
}

fn text(args: &CompareArgs, tone: Tone, inputs: &[&Input<'_>], measured: &[Measured<'_>]) -> String {
    let mut text = String::new();
    for Input { role, path, picture } in inputs {
        text += &format!("{role}: {}: {}\n", output::display(path), picture.description());
    }
    for Measured { of, against, scale, errors } in measured {
        text += &format!("{} against {}, {}\n", of.role, against.role, scale.name());
        for (metric, value) in &errors.metrics {
            let Some(value) = value else { continue };
            let unit = if *metric == Metric::Psnr { " dB" } else { "" };
            text += &format!("  {}: {}{unit}\n", metric.name(), number(*metric, *value));
        }
        if errors.non_finite_pixels > 0 {
            let count = errors.non_finite_pixels;
            text += &format!("  {count} pixels are NaN or infinite in one picture only and are left out\n");
        }
    }
    text += &verdict(measured);
    if measured.iter().any(|measured| measured.scale == ValueScale::Linear) {
        text +=
            &format!("SSIM and FLIP: exposure {} EV, tone curve {}, 8-bit sRGB\n", tone.exposure, tone.curve.name());
    }
    if let Some(path) = &args.output {
        let (kind, gain) = (args.difference.name().to_lowercase(), args.gain);
        text += &format!("{}: {kind} difference of A and B, × {gain}\n", output::display(path));
    }
    text
}

/// Formats the value of a metric with at least four significant digits.
fn number(metric: Metric, value: f64) -> String {
    match metric {
        Metric::Changed => format!("{value}"),
        Metric::Psnr => format!("{value:.4}"),
        _ if value == 0.0 || (1e-3..1e7).contains(&value.abs()) => format!("{value:.6}"),
        _ => format!("{value:.6e}"),
    }
}

/// Comparison of picture files, as JSON.
#[derive(Serialize)]
struct CompareReport {
    pictures: Vec<Value>,
    layer: Option<String>,
    /// Exposure and tone curve of linear light for SSIM and FLIP.
    tone: Tone,
    errors: Vec<Value>,
    /// Better picture by each metric; empty without a reference.
    better: Map<String, Value>,
    /// Violated bounds in words.
    exceeded: Vec<String>,
}

fn report(args: &CompareArgs, tone: Tone, inputs: &[&Input<'_>], measured: &[Measured<'_>]) -> CompareReport {
    let picture = |input: &&Input<'_>| {
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
    let errors = |measured: &Measured<'_>| {
        let values = measured
            .errors
            .metrics
            .iter()
            .filter_map(|(metric, value)| Some((metric.id().to_owned(), json!((*value)?))));
        json!({
            "of": measured.of.role,
            "against": measured.against.role,
            "scale": measured.scale,
            "metrics": values.collect::<Map<_, _>>(),
            "non_finite_pixels": measured.errors.non_finite_pixels,
        })
    };
    let metrics = measured.first().into_iter().flat_map(|measured| &measured.errors.metrics);
    let better = metrics
        .filter(|_| measured.len() > 1)
        .map(|(metric, _)| (metric.id().to_owned(), json!(better(*metric, measured))));
    CompareReport {
        pictures: inputs.iter().map(picture).collect(),
        layer: args.layer.clone(),
        tone,
        errors: measured.iter().map(errors).collect(),
        better: better.collect(),
        exceeded: exceeded(args, measured),
    }
}
