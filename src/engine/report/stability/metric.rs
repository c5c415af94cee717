//! Metrics of the report, and rules for combining their values over several cases.

use std::collections::HashMap;
use std::fmt::{self, Display, Formatter};

use serde::ser::SerializeMap as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Metric of the stability report: an error, a cost, or a count.
    pub Metric {
        Pixels = "pixels", "pixels", "Pixels that the exact answer covers.";
        Wrong = "wrong", "wrong",
            "Pixels drawn by mistake or missing, relative to the corners that the configuration declares.";
        WrongUnsnapped = "wrong-unsnapped", "wrong unsnapped",
            "Wrong pixels relative to the corners as given, which includes the effect of snapping.";
        WrongStrict = "wrong-strict", "clearly wrong",
            "Wrong pixels whose centres are more than 1/128 px from every relevant edge.";
        Seams = "seams", "seams", "Pixels of a mesh that were not drawn exactly once: cracks and double hits.";
        Cracks = "cracks", "cracks", "Pixels of a mesh that were not drawn at all.";
        Doubles = "doubles", "double hits", "Pixels of a mesh that were drawn more than once.";
        Samples = "samples", "samples", "Pixel centres at which weights and depth were checked.";
        AffineError = "affine-error", "screen weight error", "Largest error of a screen-space (affine) weight.";
        WeightError = "weight-error", "weight error",
            "Largest error of a weight for attributes, relative to perspective-correct weights.";
        SumError = "sum-error", "sum error", "Largest distance of the sum of three weights from 1.";
        NegativeWeights = "negative-weights", "negative weights", "Samples inside the triangle with a weight below 0.";
        UvTexels = "uv-texels", "texels off", "Largest error of a texture coordinate, in texels of a texture 1024 wide.";
        DepthError = "depth-error", "depth error", "Largest depth error.";
        DepthUlp = "depth-ulp", "depth ulp",
            "Largest depth error, in units in the last place of the stored format; up to 0.5 is the best possible.";
        Flips = "flips", "flips", "Samples where two triangles in one plane have different depths.";
        Pairs = "pairs", "pairs", "Neighbouring distances compared.";
        Ties = "ties", "ties", "Pairs with the same stored depth.";
        IdealTies = "ideal-ties", "ideal ties", "Pairs that would have the same stored depth even if it were rounded only once.";
        Inversions = "inversions", "inversions", "Pairs whose stored depths are in the wrong order.";
        Lost = "lost", "lost pairs", "Share of pairs that are tied or inverted, in per cent.";
        OutOfRange = "out-of-range", "out of range", "Stored depths outside 0…1.";
        NotFinite = "not-finite", "NaN or ∞", "Answers that are NaN or infinite.";
        Stiffness = "stiffness", "stiffness", "Time as a multiple of that of a compact triangle with as many pixels.";
    }
}

/// Rule for combining a metric over several cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Join {
    Sum,
    Largest,
    /// Computed from other metrics.
    Derived,
}

/// Number of severity levels, not counting level 0 (no fault); see [`Measures::severity`].
pub const LEVELS: usize = 6;

impl Metric {
    fn join(self) -> Join {
        match self {
            Self::AffineError
            | Self::WeightError
            | Self::SumError
            | Self::UvTexels
            | Self::DepthError
            | Self::DepthUlp
            | Self::Stiffness => Join::Largest,
            Self::Lost => Join::Derived,
            _ => Join::Sum,
        }
    }

    /// Returns whether the metric is a count, which is summed over cases.
    pub(crate) fn is_count(self) -> bool {
        self.join() == Join::Sum
    }

    /// Returns whether the metric measures a fault. Totals, ties that the storage format makes unavoidable, and run
    /// times are not faults.
    pub(crate) fn is_fault(self) -> bool {
        !matches!(self, Self::Pixels | Self::Samples | Self::Pairs | Self::IdealTies | Self::Stiffness)
    }

    /// If this metric counts a part of a total, returns the metric that counts the total: for wrong pixels, this is the
    /// number of all pixels. Otherwise, returns `None`.
    fn whole(self) -> Option<Self> {
        match self {
            Self::Wrong | Self::WrongUnsnapped | Self::WrongStrict | Self::Seams | Self::Cracks | Self::Doubles => {
                Some(Self::Pixels)
            }
            Self::Flips | Self::NegativeWeights => Some(Self::Samples),
            Self::Ties | Self::Inversions => Some(Self::Pairs),
            _ => None,
        }
    }

    /// Returns the thresholds between severity levels, in ascending order. If the metric counts a part of a total, they
    /// apply to the part divided by the total. Otherwise, they apply to the value itself.
    pub(crate) fn thresholds(self) -> [f64; LEVELS] {
        match self {
            Self::AffineError | Self::WeightError | Self::SumError | Self::DepthError => {
                [1e-14, 1e-6, 1e-5, 1e-3, 1e-2, 1e-1]
            }
            Self::UvTexels => [1e-6, 1e-3, 1e-1, 1.0, 10.0, 100.0],
            Self::DepthUlp => [0.5, 1.0, 4.0, 16.0, 256.0, 65_536.0],
            Self::Lost => [0.0, 0.1, 1.0, 5.0, 20.0, 50.0],
            Self::Stiffness => [1.5, 3.0, 10.0, 30.0, 100.0, 300.0],
            Self::Flips | Self::NegativeWeights => [0.0, 0.01, 0.1, 0.25, 0.5, 0.75],
            _ => [0.0, 1e-4, 1e-3, 1e-2, 1e-1, 1.0],
        }
    }

    /// Formats a value of this metric in a few characters, with its unit if it has one.
    pub fn format(self, value: f64) -> String {
        match self {
            Self::Lost => format!("{} %", short(value)),
            Self::Stiffness => format!("{}×", short(value)),
            _ if self.is_count() => grouped(value),
            _ => short(value),
        }
    }
}

/// Formats an integer with thin spaces between groups of three digits if it has more than four digits.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index) % 3 == 0 && digits.len() > 4 {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Formats a number in a few characters, in scientific notation if it is very large or small.
pub(crate) fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        v if !(0.001..1e5).contains(&v) => format!("{value:.1e}"),
        v if v < 0.1 => format!("{value:.3}"),
        v if v < 10.0 => format!("{value:.2}"),
        v if v < 100.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// Measured values of one or more cases; metrics that do not apply are absent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures([Option<f64>; Metric::ALL.len()]);

impl Measures {
    /// Returns the value of a metric, or `None` if the metric does not apply.
    pub fn get(&self, metric: Metric) -> Option<f64> {
        self.0[metric as usize]
    }

    /// Sets the value of a metric and returns the measures.
    pub(crate) fn with(mut self, metric: Metric, value: f64) -> Self {
        self.0[metric as usize] = Some(value);
        self
    }

    /// Records a value of a metric: adds it to a count, or updates a maximum.
    pub(crate) fn note(&mut self, metric: Metric, value: f64) {
        let slot = &mut self.0[metric as usize];
        *slot = Some(match (*slot, metric.join()) {
            (None, _) => value,
            (Some(before), Join::Sum) => before + value,
            (Some(before), Join::Largest | Join::Derived) => before.max(value),
        });
    }

    /// Adds the measures of more cases, and updates derived metrics such as the percentage of lost pairs.
    pub(crate) fn join(&mut self, more: &Self) {
        for (metric, value) in more.iter() {
            if metric.join() != Join::Derived {
                self.note(metric, value);
            }
        }
        if let (Some(pairs), Some(ties), Some(inversions)) =
            (self.get(Metric::Pairs), self.get(Metric::Ties), self.get(Metric::Inversions))
        {
            self.0[Metric::Lost as usize] = Some((ties + inversions) * 100.0 / pairs.max(1.0));
        }
    }

    /// Returns all metrics that apply, with their values.
    pub fn iter(&self) -> impl Iterator<Item = (Metric, f64)> {
        Metric::ALL.iter().filter_map(|metric| Some((*metric, self.get(*metric)?)))
    }

    /// Returns the severity of a metric, from 0 (no fault) to [`LEVELS`]; `None` if it does not apply.
    pub fn severity(&self, metric: Metric) -> Option<usize> {
        let value = self.get(metric)?;
        let whole = metric.whole().and_then(|whole| self.get(whole)).map_or(1.0, |whole| whole.max(1.0));
        Some(metric.thresholds().into_iter().filter(|threshold| value / whole > *threshold).count())
    }
}

impl Serialize for Measures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (metric, value) in self.iter() {
            map.serialize_entry(metric.id(), &value)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Measures {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = HashMap::<Metric, Option<f64>>::deserialize(deserializer)?;
        // JSON writes null for infinity. NaN is never measured: results that are not finite are counted instead.
        let with = |measures: Self, (metric, value): (Metric, Option<f64>)| {
            measures.with(metric, value.unwrap_or(f64::INFINITY))
        };
        Ok(values.into_iter().fold(Self::default(), with))
    }
}

/// Upper bound on a metric; a class passes if all its bounds hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Bound {
    /// Metric to which the bound applies.
    pub(crate) metric: Metric,
    /// Largest value of the metric that passes.
    pub(crate) most: f64,
}

impl Bound {
    /// Creates a bound that is met by values up to `most`.
    pub(crate) const fn new(metric: Metric, most: f64) -> Self {
        Self { metric, most }
    }

    /// Creates a bound that only the value 0 meets.
    pub(crate) const fn none(metric: Metric) -> Self {
        Self { metric, most: 0.0 }
    }

    /// Returns whether the measures are within the bound; `true` if the metric does not apply.
    pub(crate) fn holds(&self, measures: &Measures) -> bool {
        measures.get(self.metric).is_none_or(|value| value <= self.most)
    }
}

impl Display for Bound {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let sign = if self.most == 0.0 { "=" } else { "≤" };
        write!(f, "{} {sign} {}", self.metric.name(), self.metric.format(self.most))
    }
}

/// Verdict on one configuration in one class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Verdict {
    /// All bounds of the class hold.
    Pass,
    /// At least one bound does not hold; the measured values show by how much.
    Measured,
    /// The engine produced no result for at least one case.
    Refused,
}

impl Verdict {
    /// Returns the verdict in upper case, as reports show it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "PASS",
            Self::Measured => "MEASURED",
            Self::Refused => "REFUSED",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_add_up_and_errors_keep_the_largest() {
        let mut all = Measures::default();
        for (wrong, error) in [(3.0, 0.25), (4.0, 0.125)] {
            all.join(&Measures::default().with(Metric::Wrong, wrong).with(Metric::WeightError, error));
        }
        assert_eq!((all.get(Metric::Wrong), all.get(Metric::WeightError)), (Some(7.0), Some(0.25)));
        assert_eq!(all.get(Metric::Cracks), None);
    }

    #[test]
    fn the_share_of_lost_pairs_is_that_of_all_cases_together() {
        let mut all = Measures::default();
        for (pairs, ties, inversions) in [(100.0, 50.0, 0.0), (300.0, 0.0, 10.0)] {
            let one = Measures::default().with(Metric::Pairs, pairs).with(Metric::Ties, ties);
            all.join(&one.with(Metric::Inversions, inversions));
        }
        assert_eq!(all.get(Metric::Lost), Some(15.0));
    }

    #[test]
    fn the_severity_of_a_partial_count_depends_on_its_share() {
        let at = |wrong: f64| {
            Measures::default().with(Metric::Pixels, 1000.0).with(Metric::Wrong, wrong).severity(Metric::Wrong)
        };
        assert_eq!([0.0, 1.0, 5.0, 500.0, 2000.0].map(at), [0, 2, 3, 5, 6].map(Some));
        let error = |e: f64| Measures::default().with(Metric::WeightError, e).severity(Metric::WeightError);
        assert_eq!([1e-16, 1e-7, 0.5].map(error), [0, 1, 6].map(Some));
        assert_eq!(Measures::default().severity(Metric::Wrong), None);
    }

    #[test]
    fn numbers_are_short_and_show_their_magnitude() {
        for (value, text) in [
            (0.0, "0"),
            (3.456_789e-9, "3.5e-9"),
            (0.012_34, "0.012"),
            (1.234, "1.23"),
            (56.78, "56.8"),
            (1234.5, "1234"),
        ] {
            assert_eq!(short(value), text);
        }
        assert_eq!(Metric::Wrong.format(1_234_567.0), "1\u{202f}234\u{202f}567");
        assert_eq!(Metric::Lost.format(9.73), "9.73 %");
    }

    #[test]
    fn bounds_hold_up_to_their_value_and_where_nothing_was_measured() {
        let bound = Bound::new(Metric::WeightError, 1e-5);
        let with = |error: f64| Measures::default().with(Metric::WeightError, error);
        assert!(bound.holds(&with(1e-5)) && !bound.holds(&with(2e-5)) && bound.holds(&Measures::default()));
        assert_eq!(Bound::none(Metric::Wrong).to_string(), "wrong = 0");
        assert_eq!(bound.to_string(), "weight error ≤ 1.0e-5");
    }
}
