//! Grid lines and labels of plots: at round values, and dense enough that even a plot of small height has several.

use std::ops::RangeInclusive;

use egui_plot::{GridInput, GridMark};

/// Minimum distance between labels, as a multiple of the finest grid spacing that the plot can draw.
const LINES_APART: f64 = 3.5;

/// Returns three grid spacings for an axis: the distance between lines, the distance between labelled lines (1, 2 or 5
/// times a power of ten), and ten times the second.
pub(crate) fn round_steps(input: &GridInput) -> [f64; 3] {
    let least = (input.base_step_size * LINES_APART).max(f64::MIN_POSITIVE);
    let power = 10_f64.powf(least.log10().floor());
    let (factor, parts) = [(1.0, 5.0), (2.0, 4.0), (5.0, 5.0)]
        .into_iter()
        .find(|(factor, _)| factor * power >= least)
        .unwrap_or((10.0, 5.0));
    let step = factor * power;
    [step / parts, step, 10.0 * step]
}

/// Formats the label of a grid mark, with enough decimals to distinguish it from its neighbours.
pub(crate) fn number(mark: GridMark, _shown: &RangeInclusive<f64>) -> String {
    let decimals = (-mark.step_size.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{:.decimals$}", mark.value)
}

/// Returns the marks of a base-10 logarithmic axis: 1 to 9 times each power of ten. Powers of ten have priority for
/// labels, then 2 and 5 times a power.
pub(crate) fn log_marks(input: &GridInput) -> Vec<GridMark> {
    /// Spacing, in powers of ten, that is reported to the plot for the marks at 1, 2, …, 9 times a power of ten. The
    /// plot labels marks with a larger reported spacing first.
    const APART: [f64; 9] = [1.0, 0.45, 0.1, 0.1, 0.45, 0.1, 0.1, 0.1, 0.1];
    let (low, high) = input.bounds;
    /// Maximum number of powers of ten on an axis; an axis with more would be unreadable.
    const MAX_POWERS: i32 = 40;
    let first = low.floor().clamp(-f64::from(MAX_POWERS), f64::from(MAX_POWERS)) as i32;
    let last = (high.ceil() as i32).clamp(first, first + MAX_POWERS);
    let digits = |power: i32| APART.into_iter().zip(1..).map(move |(apart, digit)| (power, digit, apart));
    let marks = (first..=last)
        .flat_map(digits)
        .map(|(power, digit, step_size)| GridMark { value: f64::from(power) + f64::from(digit).log10(), step_size });
    marks.filter(|mark| (low..=high).contains(&mark.value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_at_round_steps_that_contain_the_finer_lines() {
        for (base, step) in [(0.9, 5.0), (1.0, 5.0), (0.5, 2.0), (0.28, 1.0), (12.0, 50.0), (0.000_17, 0.001)] {
            let [fine, numbered, coarse] = round_steps(&GridInput { bounds: (0.0, 1.0), base_step_size: base });
            assert!((numbered / step - 1.0).abs() < 1e-9, "{base}: {numbered}");
            let parts = numbered / fine;
            assert!((parts - parts.round()).abs() < 1e-9 && (coarse / numbered - 10.0).abs() < 1e-9);
        }
    }

    #[test]
    fn labels_of_neighbouring_marks_differ() {
        let shown = |value, step_size| number(GridMark { value, step_size }, &(0.0..=2.0));
        assert_eq!([shown(0.5, 0.5), shown(1.0, 0.5), shown(1.5, 0.5)], ["0.5", "1.0", "1.5"]);
        assert_eq!([shown(0.02, 0.02), shown(5.0, 5.0), shown(200.0, 100.0)], ["0.02", "5", "200"]);
    }

    #[test]
    fn a_logarithmic_axis_has_all_digits_of_all_powers_within_its_bounds() {
        let marks = log_marks(&GridInput { bounds: (-1.0, 1.0), base_step_size: 0.1 });
        assert_eq!(marks.len(), 19);
        assert!(marks.windows(2).all(|pair| pair[0].value < pair[1].value));
        assert_eq!(
            marks.iter().filter(|mark| mark.step_size == 1.0).map(|mark| mark.value).collect::<Vec<_>>(),
            [-1.0, 0.0, 1.0]
        );
    }
}
