//! Comparison of picture sequences: the errors of every frame, their means, and the worst frames.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use crate::image::sequence::FileSequence;
use crate::measure::metric::Metric;
use crate::pipeline::settings::Choice as _;
use serde::Serialize;
use serde_json::Value;

use super::quality::{QualityMeters, SequenceQuality};
use super::{
    CompareArgs, Inputs, Measured, check_defined, exceeded, measure, metrics, print, value_of, write_difference,
};
use crate::cli::failure::Failure;
use crate::cli::progress::ProgressLine;
use crate::cli::{interrupt, output};

/// Pictures of one role: a sequence, or one picture that is used for every frame.
struct Source<'a> {
    role: &'static str,
    path: &'a Path,
    sequence: Option<FileSequence>,
    /// Number that is added to the frame number of A.
    shift: i64,
}

impl<'a> Source<'a> {
    fn find(role: &'static str, path: &'a Path, shift: i32) -> Result<Self, Failure> {
        let sequence = FileSequence::is_named_by(path).then(|| FileSequence::find(path)).transpose()?;
        Ok(Self { role, path, sequence, shift: shift.into() })
    }

    /// Returns the picture for a frame of A, or `None` if the sequence lacks it.
    fn file(&self, frame: i64) -> Option<&Path> {
        match &self.sequence {
            None => Some(self.path),
            Some(sequence) => sequence.file(u64::try_from(frame + self.shift).ok()?),
        }
    }

    /// Returns the frames of A for which the sequence has a picture; `None` if it has one for every frame.
    fn frames(&self) -> Option<BTreeSet<i64>> {
        let numbers = self.sequence.as_ref()?.frames().filter_map(|(number, _)| i64::try_from(number).ok());
        Some(numbers.map(|number| number - self.shift).collect())
    }

    /// Returns all pictures.
    fn files(&self) -> Vec<&Path> {
        self.sequence
            .as_ref()
            .map_or_else(|| vec![self.path], |sequence| sequence.frames().map(|(_, file)| file).collect())
    }

    /// Returns role, path and number of frames in words.
    fn description(&self) -> String {
        let count = self.sequence.as_ref().map_or_else(
            || "one picture for all frames".to_owned(),
            |sequence| {
                let (first, last) = sequence.range();
                format!("{} frames from {first} to {last}", sequence.frames().count())
            },
        );
        format!("{}: {}: {count}\n", self.role, output::display(self.path))
    }
}

/// Errors of one frame.
#[derive(Serialize)]
struct FrameErrors {
    /// Number of the frame of A.
    frame: i64,
    errors: Vec<Value>,
    #[serde(skip)]
    measured: Vec<Measured>,
}

/// Mean and worst value of a metric over all frames.
#[derive(Serialize)]
struct MetricSummary {
    of: &'static str,
    against: &'static str,
    metric: Metric,
    mean: f64,
    worst: f64,
    /// Number of the first frame with the worst value.
    worst_frame: i64,
}

/// Comparison of sequences, as JSON.
#[derive(Serialize)]
struct SequenceReport<'a> {
    frames: &'a [FrameErrors],
    summary: &'a [MetricSummary],
    /// ColorVideoVDP over the whole sequence; empty if it was not requested.
    quality: &'a [SequenceQuality],
    /// Frames without a picture in one of the sequences.
    skipped: &'a [i64],
    /// Violated bounds in words.
    exceeded: &'a [String],
    /// Whether the command was interrupted.
    partial: bool,
}

/// Results of comparing frame by frame.
struct ComparedFrames {
    frames: Vec<FrameErrors>,
    /// Number of each frame that cannot be compared, and the reason.
    failures: Vec<(i64, Failure)>,
    quality: QualityMeters,
    /// Whether the command was interrupted.
    partial: bool,
}

/// Runs `compare` on sequences: measures frame by frame, prints the errors, and checks the bounds of every frame.
pub(super) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let mut sources = vec![Source::find("A", &args.a, 0)?, Source::find("B", &args.b, args.shift_b)?];
    if let Some(path) = &args.reference {
        sources.push(Source::find("reference", path, args.shift_reference)?);
    }
    let difference = args.output.as_deref().map(DifferenceFiles::new).transpose()?;
    let (wanted, skipped) = frames(&sources);
    if wanted.is_empty() {
        return Err(Failure::Usage("the sequences have no frame number in common; see --shift-b".to_owned()));
    }
    if let Some(files) = &difference {
        protect_inputs(&sources, wanted.iter().map(|frame| files.file(*frame)))?;
    }
    let ComparedFrames { frames, mut failures, quality, partial } =
        compare_frames(args, &sources, &wanted, difference.as_ref())?;
    if frames.is_empty() {
        return Err(if failures.is_empty() { interrupt::nothing() } else { failures.swap_remove(0).1 });
    }
    failures.iter().for_each(|(frame, failure)| output::report("error", format!("frame {frame}: {failure}")));
    let (summary, quality) = (summarize(&frames), quality.finish(args)?);
    let exceeded: Vec<_> = exceeded_of(args, &frames)
        .into_iter()
        .chain(quality.iter().flat_map(|quality| quality.exceeded(args)))
        .collect();
    if args.json {
        let (frames, summary, quality, skipped, exceeded) = (&frames, &summary, &quality, &skipped, &exceeded);
        output::print_json(&SequenceReport { frames, summary, quality, skipped, exceeded, partial })?;
    } else {
        let sources: String = sources.iter().map(Source::description).collect();
        let quality: String = quality.iter().map(SequenceQuality::line).collect();
        output::print(&(sources + &skipped_text(&skipped) + &table(&frames) + &summary_text(&summary) + &quality))?;
    }
    interrupt::outcome(partial)?;
    if let [(first, _), ..] = &failures[..] {
        let (count, of) = (failures.len(), wanted.len());
        return Err(Failure::Usage(format!("{count} of {of} frames cannot be compared, first frame {first}")));
    }
    match &exceeded[..] {
        [] => Ok(()),
        [only] => Err(Failure::OutOfBounds(only.clone())),
        [first, others @ ..] => Err(Failure::OutOfBounds(format!("{first}; {} more", others.len()))),
    }
}

/// Checks that no output replaces a picture of a sequence, compared or not.
fn protect_inputs(sources: &[Source<'_>], mut outputs: impl Iterator<Item = PathBuf>) -> Result<(), Failure> {
    let inputs: BTreeSet<PathBuf> =
        sources.iter().flat_map(Source::files).filter_map(|file| file.canonicalize().ok()).collect();
    match outputs.find(|file| file.canonicalize().is_ok_and(|file| inputs.contains(&file))) {
        None => Ok(()),
        Some(file) => {
            let path = output::display(&file);
            Err(Failure::Usage(format!(
                "--output: {path} is a picture of the sequences; choose another name or folder"
            )))
        }
    }
}

/// Measures the wanted frames, and writes their differences. A frame that cannot be compared does not prevent the others.
fn compare_frames(
    args: &CompareArgs,
    sources: &[Source<'_>],
    wanted: &[i64],
    difference: Option<&DifferenceFiles>,
) -> Result<ComparedFrames, Failure> {
    let (line, interrupted, quality) = (ProgressLine::new(), interrupt::flag(), QualityMeters::default());
    let mut compared =
        ComparedFrames { frames: Vec::with_capacity(wanted.len()), failures: Vec::new(), quality, partial: false };
    // ColorVideoVDP of single frames would miss all changes over time; it is measured over the sequence.
    let metrics: Vec<_> = metrics(args).into_iter().filter(|metric| *metric != Metric::Jod).collect();
    for (done, frame) in wanted.iter().copied().enumerate() {
        if interrupted.load(Ordering::Relaxed) {
            compared.partial = true;
            break;
        }
        line.show(&format!("comparing: {done} of {} frames", wanted.len()));
        let files: Vec<&Path> = sources.iter().filter_map(|source| source.file(frame)).collect();
        let inputs = Inputs::read(files[0], files[1], files.get(2).copied());
        let measured = inputs.and_then(|inputs| {
            let measured = measure(args, &inputs, &metrics)?;
            check_defined(args, &measured)?;
            compared.quality.add(args, &inputs, compared.frames.is_empty())?;
            Ok((inputs, measured))
        });
        let (inputs, measured) = match measured {
            Ok(read) => read,
            Err(failure) => {
                compared.failures.push((frame, failure));
                continue;
            }
        };
        if let Some(files) = difference {
            write_difference(args, &inputs, &files.file(frame))?;
        }
        let errors = measured.iter().map(print::errors).collect();
        compared.frames.push(FrameErrors { frame, errors, measured });
    }
    Ok(compared)
}

/// Returns every violated bound in words, with the number of its frame.
fn exceeded_of(args: &CompareArgs, frames: &[FrameErrors]) -> Vec<String> {
    let of_frame = |FrameErrors { frame, measured, .. }: &FrameErrors| {
        let words = exceeded(args, measured).into_iter();
        words.map(|words| format!("frame {frame}: {words}")).collect::<Vec<_>>()
    };
    frames.iter().flat_map(of_frame).collect()
}

/// Returns the frames of which every sequence has a picture, and the other frames of any sequence.
fn frames(sources: &[Source<'_>]) -> (Vec<i64>, Vec<i64>) {
    let all: BTreeSet<i64> = sources.iter().filter_map(Source::frames).flatten().collect();
    all.into_iter().partition(|frame| sources.iter().all(|source| source.file(*frame).is_some()))
}

/// Files for the differences of all frames.
struct DifferenceFiles {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl DifferenceFiles {
    /// Parses a path with a run of `#` in its file name, one for each digit of the frame number.
    fn new(path: &Path) -> Result<Self, Failure> {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let digits = name.bytes().filter(|byte| *byte == b'#').count();
        let Some((before, after)) = name.split_once(&"#".repeat(digits)).filter(|_| digits > 0) else {
            let path = output::display(path);
            return Err(Failure::Usage(format!(
                "--output {path}: for sequences, name a pattern such as difference.####.png"
            )));
        };
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        Ok(Self { folder, before: before.to_owned(), digits, after: after.to_owned() })
    }

    fn file(&self, frame: i64) -> PathBuf {
        let Self { folder, before, digits, after } = self;
        folder.join(format!("{before}{frame:0digits$}{after}"))
    }
}

/// Returns mean and worst value of every metric that is defined for the pictures.
fn summarize(frames: &[FrameErrors]) -> Vec<MetricSummary> {
    let mut summary = Vec::new();
    for (index, Measured { of, against, errors, .. }) in frames[0].measured.iter().enumerate() {
        for (metric, _) in &errors.metrics {
            let value =
                |frame: &FrameErrors| Some((value_of(&frame.measured.get(index)?.errors, *metric)?, frame.frame));
            let values: Vec<(f64, i64)> = frames.iter().filter_map(value).collect();
            // The first of equal frames is the worst.
            let worst = values.iter().copied().reduce(|worst, next| {
                let is_worse = if metric.is_larger_better() { next.0 < worst.0 } else { next.0 > worst.0 };
                if is_worse { next } else { worst }
            });
            let Some((worst, worst_frame)) = worst else { continue };
            let mean = mean(*metric, values.iter().map(|(value, _)| *value).collect());
            summary.push(MetricSummary { of, against, metric: *metric, mean, worst, worst_frame });
        }
    }
    summary
}

/// Returns the mean of a metric over all frames. The mean PSNR is that of the mean of the squared errors, because identical
/// frames have an infinite one.
fn mean(metric: Metric, values: Vec<f64>) -> f64 {
    let mean = |values: &mut dyn Iterator<Item = f64>, count: usize| values.sum::<f64>() / count as f64;
    let count = values.len();
    match metric {
        Metric::Psnr => {
            let mut relative = values.into_iter().map(|psnr| 10.0_f64.powf(-psnr / 10.0));
            -10.0 * mean(&mut relative, count).log10()
        }
        _ => mean(&mut values.into_iter(), count),
    }
}

fn skipped_text(skipped: &[i64]) -> String {
    match skipped {
        [] => String::new(),
        [only] => format!("skipped frame {only}, which one of the sequences lacks\n"),
        [first, .., last] => {
            format!("skipped {} frames between {first} and {last}, which one of the sequences lacks\n", skipped.len())
        }
    }
}

/// Returns one line for every frame and pair of pictures.
fn table(frames: &[FrameErrors]) -> String {
    let mut text = String::new();
    for FrameErrors { frame, measured, .. } in frames {
        for Measured { of, against, errors, .. } in measured {
            let values = errors
                .metrics
                .iter()
                .filter_map(|(metric, value)| Some(format!("{} {}", metric.id(), metric.format((*value)?))));
            let values: Vec<_> = values.collect();
            if !values.is_empty() {
                text += &format!("frame {frame}, {of} against {against}: {}\n", values.join(", "));
            }
        }
    }
    text
}

fn summary_text(summary: &[MetricSummary]) -> String {
    let line = |MetricSummary { of, against, metric, mean, worst, worst_frame }: &MetricSummary| {
        let [mean, worst] = [mean, worst].map(|value| metric.format(*value));
        let name = metric.name();
        format!("{of} against {against}, {name}: mean {mean}, worst {worst} (frame {worst_frame})\n")
    };
    summary.iter().map(line).collect()
}
