//! Time budget of a frame, and the method with the lowest error within it.

use super::TradeOff;
use crate::measure::metric::Metric;
use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::upscale::Upscaling;

/// Budget without a measured time of native rendering, in milliseconds.
pub(super) const FALLBACK_MS: f64 = 2.0;

/// Smallest budget, in milliseconds.
pub(crate) const MIN_MS: f64 = 0.001;

/// Largest budget, in milliseconds.
pub(crate) const MAX_MS: f64 = 10_000.0;

/// Method with the lowest error among those within the time budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BudgetWinner {
    /// Upscaler with the lowest error by the metric in use; of several with the same error, the fastest.
    Best(Upscaling),
    /// The median times of all methods exceed the budget.
    NothingFits,
    /// No errors have been measured yet.
    NoErrors,
}

impl BudgetWinner {
    /// Finds the winner for a budget in milliseconds.
    pub(super) fn of(methods: &[TradeOff], budget_ms: f64) -> Self {
        if methods.is_empty() {
            return Self::NoErrors;
        }
        let rank = |method: &TradeOff| (method.mean_error(), method.ms.median);
        let within = methods.iter().filter(|method| method.ms.median <= budget_ms);
        let best = within.min_by(|a, b| {
            let ((a_error, a_ms), (b_error, b_ms)) = (rank(a), rank(b));
            a_error.total_cmp(&b_error).then(a_ms.total_cmp(&b_ms))
        });
        best.map_or(Self::NothingFits, |method| Self::Best(method.upscaling))
    }

    /// Returns the winner if there is one.
    pub(crate) fn best(self) -> Option<Upscaling> {
        match self {
            Self::Best(upscaling) => Some(upscaling),
            Self::NothingFits | Self::NoErrors => None,
        }
    }

    /// Describes the winner by a metric for a budget in milliseconds, for example “Lanczos 2 ×2: lowest FLIP within
    /// 2.0 ms”.
    pub(crate) fn words(self, metric: Metric, budget_ms: f64) -> String {
        let budget = text(budget_ms);
        match self {
            Self::Best(upscaling) => format!("{}: {} within {budget}", upscaling.label(), best_words(metric)),
            Self::NothingFits => format!("No method within {budget}"),
            Self::NoErrors => format!("Budget {budget}: errors not measured"),
        }
    }
}

/// Describes the best value of a metric: “lowest FLIP” or “highest PSNR”.
pub(crate) fn best_words(metric: Metric) -> String {
    format!("{} {}", if metric.is_larger_better() { "highest" } else { "lowest" }, metric.name())
}

/// Returns the default budget for a median time of native rendering, both in milliseconds: about half of it, as 1, 2 or
/// 5 times a power of ten. The round steps keep the budget constant while a measurement refines the median.
pub(super) fn default_ms(native_ms: f64) -> f64 {
    let half = native_ms / 2.0;
    if half.is_nan() || half <= 0.0 {
        return FALLBACK_MS;
    }
    let power = 10_f64.powf(half.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    let distance = |step: &f64| (step / half).ln().abs();
    steps.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(FALLBACK_MS)
}

/// Rounds a budget in milliseconds to two significant digits and limits it to [`MIN_MS`] to [`MAX_MS`].
pub(crate) fn rounded(ms: f64) -> f64 {
    let ms = if ms.is_nan() { FALLBACK_MS } else { ms.clamp(MIN_MS, MAX_MS) };
    let step = 10_f64.powf(ms.log10().floor() - 1.0);
    (ms / step).round() * step
}

/// Formats a budget with two significant digits: “0.35 ms”, “2.0 ms”, “16 ms”.
pub(crate) fn text(ms: f64) -> String {
    let decimals = (1.0 - ms.max(MIN_MS).log10().floor()).clamp(0.0, 4.0) as usize;
    format!("{}\u{2009}ms", format::fixed(ms, decimals))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::measure::against::figures;
    use crate::measure::motion::MotionError;
    use crate::measure::timing::summarize;
    use crate::report::upscaling::tradeoff::Standing;
    use crate::ui::session::timings::request::MethodError;

    fn method(id: &str, ms: f64, brightness: u8) -> TradeOff {
        let picture = |code| Image::filled(8, 8, [code, code, code, 255]);
        let still = figures(&picture(brightness), &picture(0)).unwrap().0;
        TradeOff {
            upscaling: Upscaling::new(id, 2).unwrap(),
            ms: summarize(&[ms]).unwrap(),
            error: MethodError { still, motion: MotionError::of(&[still]).unwrap() },
            standing: Some(Standing::Front),
            metric: Metric::Flip,
            native_within_noise: false,
        }
    }

    #[test]
    fn the_winner_has_the_lowest_error_within_the_budget() {
        let methods = [
            method("nearest", 1.0, 90),
            method("lanczos3", 1.9, 30),
            method("bilinear", 1.5, 30),
            method("native", 5.0, 0),
        ];
        let winner = |ms| BudgetWinner::of(&methods, ms);
        let best = |id| BudgetWinner::Best(Upscaling::new(id, 2).unwrap());
        assert_eq!(winner(0.9), BudgetWinner::NothingFits);
        assert_eq!(winner(1.0), best("nearest"), "the budget itself fits");
        assert_eq!(winner(2.0), best("bilinear"), "the faster of two with the same error");
        assert_eq!(winner(9.0), best("native"));
        assert_eq!(BudgetWinner::of(&[], 2.0), BudgetWinner::NoErrors);
        assert_eq!(winner(2.0).words(Metric::Flip, 2.0), "Bilinear ×2: lowest FLIP within 2.0\u{2009}ms");
        assert_eq!(winner(2.0).words(Metric::Ssim, 2.0), "Bilinear ×2: highest SSIM within 2.0\u{2009}ms");
    }

    #[test]
    fn the_default_budget_is_about_half_of_native() {
        for (native, budget) in [(5.1, 2.0), (4.0, 2.0), (3.9, 2.0), (12.0, 5.0), (1.1, 0.5), (0.21, 0.1), (17.0, 10.0)]
        {
            assert!((default_ms(native) / budget - 1.0).abs() < 1e-9, "{native}: {}", default_ms(native));
        }
        assert_eq!([default_ms(0.0), default_ms(f64::NAN)], [FALLBACK_MS; 2]);
    }

    #[test]
    fn budgets_have_two_significant_digits() {
        let texts = [2.0, 0.347, 16.4, 0.0999, 123.0].map(|ms| text(rounded(ms)));
        assert_eq!(texts, ["2.0", "0.35", "16", "0.10", "120"].map(|number| format!("{number}\u{2009}ms")));
        assert_eq!([rounded(0.0), rounded(f64::INFINITY), rounded(f64::NAN)], [MIN_MS, MAX_MS, FALLBACK_MS]);
    }
}
