//! Registry of the error metrics between two pictures: names, units, directions and costs.

use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Error metric between two pictures.
    pub Metric {
        Psnr = "psnr", "PSNR", "Peak signal-to-noise ratio in dB; the peak is 255 for sRGB codes and 1 for linear light.";
        Ssim = "ssim", "SSIM", "Structural similarity, 1 for identical pictures; linear light is tone mapped first.";
        MsSsim = "ms-ssim", "MS-SSIM",
            "Structural similarity at five scales, 1 for identical pictures; linear light is tone mapped first.";
        Flip = "flip", "FLIP", "Mean perceived difference (LDR-FLIP), 0 to 1; linear light is tone mapped first.";
        Ssimulacra2 = "ssimulacra2", "SSIMULACRA2",
            "Perceived quality: 100 for identical pictures, below 0 for very different ones; linear light is tone mapped \
             first.";
        Jod = "jod", "ColorVideoVDP",
            "Quality in just-objectionable differences: 10 for no visible difference, also over sequences; linear light is \
             tone mapped first. Slow.";
        Mse = "mse", "MSE", "Mean squared error over all pixels and channels.";
        RelativeMse = "relmse", "Relative MSE",
            "Mean of (a − b)² / (b² + 0.01) in linear light, where b is the second picture or the reference.";
        Max = "max", "Largest difference", "Largest absolute difference of a channel.";
        Changed = "changed", "Changed pixels", "Number of pixels that differ in any channel except alpha.";
    }
}

/// Cost of computing a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MetricCost {
    /// Cheap enough to be computed without being requested.
    Fast,
    /// Computed only on request.
    Slow,
}

impl Metric {
    /// Returns the metrics that are cheap enough to be computed without being requested.
    pub fn fast() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|metric| metric.cost() == MetricCost::Fast)
    }

    /// Returns the cost of computing the metric.
    pub fn cost(self) -> MetricCost {
        match self {
            Self::Jod | Self::Ssimulacra2 => MetricCost::Slow,
            _ => MetricCost::Fast,
        }
    }

    /// Whether larger values mean a smaller error.
    pub fn is_larger_better(self) -> bool {
        matches!(self, Self::Psnr | Self::Ssim | Self::MsSsim | Self::Ssimulacra2 | Self::Jod)
    }

    /// Returns the unit of the values; empty for plain numbers.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Psnr => "dB",
            Self::Jod => "JOD",
            _ => "",
        }
    }

    /// Formats a value with its unit and at least four significant digits.
    pub fn format(self, value: f64) -> String {
        match self {
            Self::Changed => format!("{value}"),
            Self::Psnr | Self::Jod => format!("{value:.4} {}", self.unit()),
            _ if value == 0.0 || (1e-3..1e7).contains(&value.abs()) => format!("{value:.6}"),
            _ => format!("{value:.6e}"),
        }
    }

    /// Whether the metric is defined for data, such as depths and ids, and not only for colours.
    pub fn measures_data(self) -> bool {
        matches!(self, Self::Mse | Self::Max | Self::Changed)
    }

    /// Whether the metric is computed from displayed pictures, that is, from linear light after tone mapping.
    pub fn measures_displayed(self) -> bool {
        matches!(self, Self::Ssim | Self::MsSsim | Self::Flip | Self::Ssimulacra2 | Self::Jod)
    }

    /// Converts a value to an error: 0 for identical pictures, and larger for larger errors. Plots show it on a logarithmic
    /// axis. [`Self::error_name`] names it.
    pub fn error(self, value: f64) -> f64 {
        match self {
            Self::Psnr => 10.0_f64.powf(-value / 20.0),
            Self::Ssim | Self::MsSsim => 1.0 - value,
            Self::Ssimulacra2 => 100.0 - value,
            Self::Jod => 10.0 - value,
            _ => value,
        }
    }

    /// Returns the name of [`Self::error`], such as `1 − SSIM`.
    pub fn error_name(self) -> String {
        let best = match self {
            Self::Psnr => return "RMS error of PSNR".to_owned(),
            Self::Ssim | Self::MsSsim => 1,
            Self::Ssimulacra2 => 100,
            Self::Jod => 10,
            _ => return self.name().to_owned(),
        };
        format!("{best} − {}", self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_zero_for_identical_pictures_and_grow_with_the_difference() {
        for metric in Metric::ALL.iter().copied() {
            let (same, near, far) = match metric {
                Metric::Psnr => (f64::INFINITY, 40.0, 20.0),
                Metric::Ssim | Metric::MsSsim => (1.0, 0.9, -0.2),
                Metric::Ssimulacra2 => (100.0, 90.0, -30.0),
                Metric::Jod => (10.0, 9.5, 3.0),
                _ => (0.0, 0.25, 4.0),
            };
            assert_eq!(metric.error(same), 0.0, "{}", metric.id());
            assert!(metric.error(near) > 0.0 && metric.error(far) > metric.error(near), "{}", metric.id());
            assert_eq!(metric.is_larger_better(), near > far, "{}", metric.id());
            assert!(!(metric.measures_displayed() && metric.measures_data()), "{}", metric.id());
        }
        assert_eq!(Metric::Psnr.error(40.0), 0.01, "the RMS error of 40 dB is a hundredth of the peak");
        assert_eq!([Metric::Jod, Metric::MsSsim].map(Metric::error_name), ["10 − ColorVideoVDP", "1 − MS-SSIM"]);
    }

    #[test]
    fn values_have_their_unit() {
        assert_eq!(Metric::Psnr.format(32.0), "32.0000 dB");
        assert_eq!(Metric::Jod.format(9.5), "9.5000 JOD");
        assert_eq!(Metric::Changed.format(12.0), "12");
        assert_eq!(Metric::Mse.format(1e-5), "1.000000e-5");
    }
}
