//! Options of methods that blend samples with their history.

use serde::{Deserialize, Serialize};

use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Rectification: the change of the history's colour so that it agrees with the 3 × 3 samples of the current frame.
    #[derive(PartialOrd, Ord)]
    pub Rectification {
        Variance = "variance", "Variance clipping",
            "Clips the history to the mean ± 1 standard deviation of the 3 × 3 samples, in YCoCg: rejects stale colours \
             best, and tolerates a single outlier (M. Salvi, “An Excursion in Temporal Supersampling”, 2016).";
        Clip = "clip", "Clipping",
            "Moves the history straight towards the middle of the range of the 3 × 3 samples, in YCoCg, until it is \
             inside (L. Pedersen, “Temporal Reprojection Anti-Aliasing in INSIDE”, 2016).";
        Clamp = "clamp", "Clamping",
            "Clamps each YCoCg channel of the history to the range of the 3 × 3 samples (B. Karis, “High Quality Temporal \
             Supersampling”, 2014).";
        None = "none", "None",
            "Leaves the history as it is: the picture is smoothest, and everything that changes leaves a ghost.";
    }
}

choice! {
    /// Filter that reads the history between its pixels.
    #[derive(PartialOrd, Ord)]
    pub HistoryFilter {
        CatmullRom = "catmull-rom", "Catmull-Rom",
            "Cubic filter of 4 × 4 pixels: keeps the picture sharp over many frames of motion.";
        Bilinear = "bilinear", "Bilinear", "Filter of 2 × 2 pixels: faster, but blurs the picture with every frame of motion.";
    }
}

/// Options of methods that blend samples with their history.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HistoryOptions {
    /// Rectification of the history.
    pub rectification: Rectification,
    /// Filter that reads the history between its pixels.
    pub filter: HistoryFilter,
    /// Whether colours are blended with weights 1 / (1 + luminance), which suppresses flickering highlights but darkens
    /// edges next to them (Karis, 2014).
    pub luminance_weighting: bool,
}

impl HistoryOptions {
    /// Default options.
    pub const DEFAULT: Self =
        Self { rectification: Rectification::Variance, filter: HistoryFilter::CatmullRom, luminance_weighting: false };
}

impl Default for HistoryOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}
