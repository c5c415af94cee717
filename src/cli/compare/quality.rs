//! ColorVideoVDP over a sequence: one value for all frames, because flicker and other changes over time count.

use serde::Serialize;

use super::{CompareArgs, Inputs, Limit, bounded, metrics, pair, undefined_size, viewing_conditions};
use crate::cli::failure::Failure;
use crate::measure::jod::{SequenceJod, Viewing};
use crate::measure::metric::Metric;
use crate::measure::picture_error::ValueScale;
use crate::pipeline::settings::Choice as _;

/// Quality of a sequence.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SequenceQuality {
    of: &'static str,
    against: &'static str,
    jod: f64,
    viewing: Viewing,
}

impl SequenceQuality {
    /// Returns the quality and the viewing conditions as a line of text.
    pub(super) fn line(&self) -> String {
        let Self { of, against, jod, viewing: Viewing { pixels_per_degree, frames_per_second } } = self;
        let (name, value) = (Metric::Jod.name(), Metric::Jod.format(*jod));
        format!(
            "{of} against {against}, {name}: {value} over the sequence, at {frames_per_second} frames per second and \
             {pixels_per_degree} pixels per degree\n"
        )
    }

    /// Returns the violated bounds of the quality in words.
    pub(super) fn exceeded(&self, args: &CompareArgs) -> Vec<String> {
        let Self { of, against, jod, .. } = self;
        let violated = args.min.iter().filter(|limit| limit.metric == Metric::Jod && *jod < limit.value);
        let words = |Limit { value, .. }: &Limit| format!("{of} against {against}: jod {jod} is below {value}");
        violated.map(words).collect()
    }
}

/// Measurement of the quality of every pair of sequences.
#[derive(Debug, Default)]
pub(super) struct QualityMeters {
    /// Roles of each pair, and its measurement; empty if the quality is not requested or not defined.
    meters: Vec<(&'static str, &'static str, SequenceJod)>,
}

impl QualityMeters {
    /// Adds a frame of every pair. Creates the measurements with the first frame.
    pub(super) fn add(&mut self, args: &CompareArgs, inputs: &Inputs<'_>, is_first: bool) -> Result<(), Failure> {
        let id = Metric::Jod.id();
        if !metrics(args).contains(&Metric::Jod) {
            return Ok(());
        }
        for (index, [of, against]) in inputs.pairs().into_iter().enumerate() {
            let pair = pair(args, of, against)?;
            if pair.scale() == ValueScale::Stored {
                let is_named = args.metric.contains(&Metric::Jod) || bounded(args).any(|metric| metric == Metric::Jod);
                let data = || Failure::Usage(format!("{id}: not defined for data that are no colours"));
                return if is_named { Err(data()) } else { Ok(()) };
            }
            if is_first {
                let meter = SequenceJod::new(viewing_conditions(args)).ok_or_else(|| undefined_size(id))?;
                self.meters.push((of.role, against.role, meter));
            }
            let [picture, reference] = pair.displayed();
            let Some((_, _, meter)) = self.meters.get_mut(index) else { continue };
            meter.add(&picture, &reference).ok_or_else(|| undefined_size(id))?;
        }
        Ok(())
    }

    /// Returns the quality of every pair.
    pub(super) fn finish(self, args: &CompareArgs) -> Result<Vec<SequenceQuality>, Failure> {
        let viewing = viewing_conditions(args);
        let quality = |(of, against, meter): (&'static str, &'static str, SequenceJod)| {
            let jod = meter.finish().ok_or_else(|| undefined_size(Metric::Jod.id()))?;
            Ok(SequenceQuality { of, against, jod, viewing })
        };
        self.meters.into_iter().map(quality).collect()
    }
}
