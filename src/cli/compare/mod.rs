//! `rasterscope compare`: measures the error between picture files, or sequences of them, without a scene.

mod page;

mod print;

mod quality;

mod sequence;

use std::path::{Path, PathBuf};

use crate::image::file::write_png;
use crate::image::picture::{Layer, Picture, format_names};
use crate::image::sequence::FileSequence;
use crate::image::{Image, Rgba8};
use crate::measure::difference::{self, Difference};
use crate::measure::jod::Viewing;
use crate::measure::metric::{Metric, MetricCost};
use crate::measure::picture_error::{LayerPair, PictureErrors, PictureLayer, ValueScale};
use crate::measure::tone::{Tone, ToneCurve};
use crate::pipeline::settings::Choice;
use clap::Args;

use super::failure::Failure;
use super::{output, parse};

/// Measure the error between two picture files, or of both against a reference, without a scene
#[derive(Args, Debug)]
#[command(after_help = super::example("compare a.exr b.exr --reference converged.exr --max flip=0.05"))]
pub(crate) struct CompareArgs {
    #[arg(value_name = "A", help = format!(
        "Picture A: {}. A sequence is named by its folder or by a pattern such as frame.####.exr", format_names()))]
    a: PathBuf,

    /// Picture B, or sequence of pictures
    #[arg(value_name = "B")]
    b: PathBuf,

    /// Reference picture or sequence: measure A and B against it, and name the better one
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,

    /// Number of frames by which the sequence B is ahead: frame N of A is compared with frame N + FRAMES of B
    #[arg(long, value_name = "FRAMES", default_value_t = 0, allow_hyphen_values = true)]
    shift_b: i32,

    /// Number of frames by which the sequence of references is ahead
    #[arg(long, value_name = "FRAMES", default_value_t = 0, allow_hyphen_values = true)]
    shift_reference: i32,

    /// Metric to print; several are separated by commas [default: all fast ones that apply]
    #[arg(long, value_name = "METRIC", alias = "metrics", value_delimiter = ',', value_parser = parse::choice::<Metric>())]
    metric: Vec<Metric>,

    /// Print all metrics that apply, also slow ones
    #[arg(long, conflicts_with = "metric")]
    all_metrics: bool,

    /// Pixels per degree of visual angle, for ColorVideoVDP
    #[arg(long, value_name = "PIXELS", default_value_t = Viewing::default().pixels_per_degree, value_parser = viewing)]
    pixels_per_degree: f64,

    /// Frames per second of sequences, for ColorVideoVDP
    #[arg(long, value_name = "RATE", default_value_t = Viewing::default().frames_per_second, value_parser = viewing)]
    fps: f64,

    /// Largest allowed value of a metric; exit code 1 if it is exceeded. May be given several times
    #[arg(long, value_name = "METRIC=VALUE", value_parser = limit)]
    max: Vec<Limit>,

    /// Smallest allowed value of a metric; exit code 1 if it is not reached. May be given several times
    #[arg(long, value_name = "METRIC=VALUE", value_parser = limit)]
    min: Vec<Limit>,

    /// Layer to compare, such as `diffuse` or `Z` [default: the first colour of each picture]
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,

    /// Exposure in stops of float pictures, for SSIM and perceptual metrics
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_hyphen_values = true, value_parser = exposure)]
    exposure: f32,

    /// Tone curve of float pictures, for SSIM and perceptual metrics
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

    /// PNG file for the difference of A and B, for sequences a pattern such as difference.####.png; or HTML file for both
    /// pictures, their difference and the errors
    #[arg(short, long, value_name = "FILE")]
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

/// Parses a number of pixels per degree or of frames per second.
fn viewing(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| *value > 0.0 && *value <= Viewing::MAX);
    value.ok_or_else(|| format!("expected a number above 0 and up to {}", Viewing::MAX))
}

/// Picture file that takes part in the comparison.
struct Input<'a> {
    /// Name in the output: `A`, `B` or `reference`.
    role: &'static str,
    path: &'a Path,
    picture: Picture,
}

/// Pictures of a comparison.
struct Inputs<'a> {
    a: Input<'a>,
    b: Input<'a>,
    reference: Option<Input<'a>>,
}

impl<'a> Inputs<'a> {
    /// Reads the picture files A, B and, if there is one, the reference.
    fn read(a: &'a Path, b: &'a Path, reference: Option<&'a Path>) -> Result<Self, Failure> {
        let input = |role, path| Picture::read(path).map(|picture| Input { role, path, picture });
        let reference = reference.map(|path| input("reference", path)).transpose()?;
        Ok(Self { a: input("A", a)?, b: input("B", b)?, reference })
    }

    fn all(&self) -> impl Iterator<Item = &Input<'a>> {
        [&self.a, &self.b].into_iter().chain(&self.reference)
    }

    /// Returns each picture to measure with the one that it is measured against.
    fn pairs(&self) -> Vec<[&Input<'a>; 2]> {
        match &self.reference {
            None => vec![[&self.a, &self.b]],
            Some(reference) => vec![[&self.a, reference], [&self.b, reference]],
        }
    }
}

/// Errors of one picture against another.
struct Measured {
    /// Role of the picture.
    of: &'static str,
    /// Role of the picture that it is measured against.
    against: &'static str,
    scale: ValueScale,
    errors: PictureErrors,
}

/// Runs `compare`: reads the pictures, measures and prints their errors, and checks the bounds.
pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    check_bounds(args)?;
    if [&args.a, &args.b].into_iter().chain(&args.reference).any(|path| FileSequence::is_named_by(path)) {
        if args.output.as_deref().is_some_and(output::is_html) {
            return Err(Failure::Usage("--output: HTML pages show single pictures, not sequences".to_owned()));
        }
        return sequence::run(args);
    }
    if args.shift_b != 0 || args.shift_reference != 0 {
        return Err(Failure::Usage("--shift-b and --shift-reference: only sequences have frames".to_owned()));
    }
    let inputs = Inputs::read(&args.a, &args.b, args.reference.as_deref())?;
    let measured = measure(args, &inputs, &metrics(args))?;
    check_defined(args, &measured)?;
    if let Some(path) = args.output.as_ref().filter(|path| output::is_html(path)) {
        page::write(args, &inputs, &measured, path)?;
    } else if let Some(path) = &args.output {
        write_difference(args, &inputs, path)?;
    }
    let exceeded = exceeded(args, &measured);
    if args.json {
        output::print_json(&print::report(args, &inputs, &measured))?;
    } else {
        output::print(&print::text(args, &inputs, &measured))?;
    }
    if exceeded.is_empty() { Ok(()) } else { Err(Failure::OutOfBounds(exceeded.join("; "))) }
}

/// Measures A against B, or A and B against the reference.
fn measure(args: &CompareArgs, inputs: &Inputs<'_>, metrics: &[Metric]) -> Result<Vec<Measured>, Failure> {
    // A and B must be comparable even if only their errors against a reference are measured.
    pair(args, &inputs.a, &inputs.b)?;
    let measured = |[of, against]: [&Input<'_>; 2]| {
        let pair = pair(args, of, against)?;
        Ok(Measured { of: of.role, against: against.role, scale: pair.scale(), errors: pair.measure(metrics) })
    };
    inputs.pairs().into_iter().map(measured).collect()
}

/// Writes the difference of A and B.
fn write_difference(args: &CompareArgs, inputs: &Inputs<'_>, path: &Path) -> Result<(), Failure> {
    Ok(write_png(path, &difference_of(args, inputs)?)?)
}

/// Returns the difference of A and B as a picture.
fn difference_of(args: &CompareArgs, inputs: &Inputs<'_>) -> Result<Image<Rgba8>, Failure> {
    let values = pair(args, &inputs.a, &inputs.b)?.difference(args.difference);
    Ok(difference::picture(args.difference, args.gain, &values))
}

/// Returns exposure and tone curve of linear light.
fn tone(args: &CompareArgs) -> Tone {
    Tone { exposure: args.exposure, curve: args.tone_curve }
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

/// Returns the metrics to print: those requested or the fast ones, and those with bounds.
fn metrics(args: &CompareArgs) -> Vec<Metric> {
    let is_requested = |metric: &Metric| match &args.metric[..] {
        [] => args.all_metrics || metric.cost() == MetricCost::Fast,
        requested => requested.contains(metric),
    };
    Metric::ALL.iter().copied().filter(|metric| is_requested(metric) || bounded(args).any(|of| of == *metric)).collect()
}

/// Returns the metrics with bounds.
fn bounded(args: &CompareArgs) -> impl Iterator<Item = Metric> {
    args.max.iter().chain(&args.min).map(|limit| limit.metric)
}

/// Returns the viewing conditions of ColorVideoVDP.
fn viewing_conditions(args: &CompareArgs) -> Viewing {
    Viewing { pixels_per_degree: args.pixels_per_degree, frames_per_second: args.fps }
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

fn pair<'a>(args: &CompareArgs, a: &'a Input<'_>, b: &'a Input<'_>) -> Result<LayerPair<'a>, Failure> {
    let of = |input: &'a Input<'_>| layer(args, input).map(|layer| PictureLayer { picture: &input.picture, layer });
    let pair = LayerPair::new(of(a)?, of(b)?, tone(args)).map_err(|reason| {
        Failure::Usage(format!("{} and {}: {reason}", output::display(a.path), output::display(b.path)))
    })?;
    Ok(pair.seen_at(viewing_conditions(args)))
}

/// Checks that every metric that the user names is defined for the layer.
fn check_defined(args: &CompareArgs, measured: &[Measured]) -> Result<(), Failure> {
    let is_named = |metric: &Metric| args.metric.contains(metric) || bounded(args).any(|of| of == *metric);
    let all = measured.iter().flat_map(|measured| measured.errors.metrics.iter().map(move |of| (measured.scale, of)));
    let undefined = all.filter(|(_, (metric, value))| value.is_none() && is_named(metric));
    match undefined.map(|(scale, (metric, _))| (scale, metric.id())).next() {
        None => Ok(()),
        Some((ValueScale::Stored, id)) => {
            Err(Failure::Usage(format!("{id}: not defined for data that are no colours; use mse, max or changed")))
        }
        Some((_, id)) => Err(undefined_size(id)),
    }
}

/// Returns the failure of a metric that is not defined for pictures of this size.
fn undefined_size(id: &str) -> Failure {
    Failure::Usage(format!(
        "{id}: not defined for pictures of this size; ColorVideoVDP needs 4 × 4 px to 10 million pixels"
    ))
}

/// Returns every violated bound in words. A pixel that is NaN or infinite in one picture only violates every bound.
fn exceeded(args: &CompareArgs, measured: &[Measured]) -> Vec<String> {
    let mut words = Vec::new();
    for Measured { of, against, errors, .. } in measured {
        let bounds = args.max.iter().map(|limit| (limit, "above")).chain(args.min.iter().map(|limit| (limit, "below")));
        for (Limit { metric, value: bound }, side) in bounds {
            let value = value_of(errors, *metric).unwrap_or(f64::NAN);
            let is_beyond = if side == "above" { value > *bound } else { value < *bound };
            if is_beyond {
                words.push(format!("{of} against {against}: {} {value} is {side} {bound}", metric.id()));
            }
        }
        let has_bounds = !args.max.is_empty() || !args.min.is_empty();
        if has_bounds && errors.non_finite_pixels > 0 {
            let count = errors.non_finite_pixels;
            words.push(format!("{of} against {against}: {count} pixels are NaN or infinite in one of them"));
        }
    }
    words
}

fn value_of(errors: &PictureErrors, wanted: Metric) -> Option<f64> {
    errors.metrics.iter().find(|(metric, _)| *metric == wanted).and_then(|(_, value)| *value)
}
