//! Settings of anti-aliasing and post filters, as parts of a recipe.

use serde::{Deserialize, Serialize};

use super::pattern::Pattern;
use crate::flat2d::convolve::{GAUSSIAN_CUTOFF, MAX_REACH};
use crate::pipeline::settings::{Choice, ColorSpace, choice};

choice! {
    /// Anti-aliasing method: sample positions in a drawn pixel, and the work done per sample.
    pub AntialiasMethod {
        None = "none", "None",
            "One sample at the pixel centre: stair-stepping along edges, moiré where a pattern is finer than a pixel.";
        Regular = "regular", "Supersampling, regular",
            "Mean of samples at the centres of n × n squares of the pixel, all shaded: simple, but nearly vertical or \
             horizontal edges show only n steps.";
        Recursive = "recursive", "Supersampling, recursive",
            "Recursive subdivision of the pixel into quarters, as in some ray tracers: the sample positions of the \
             regular grid in another order. Every square is subdivided, so the picture is that of the regular grid.";
        Jittered = "jittered", "Supersampling, jittered",
            "A random position in each of n × n squares, different in every pixel: turns moiré into noise.";
        RotatedGrid = "rotated-grid", "Supersampling, rotated grid",
            "Four samples, each in its own row and column: four steps along edges where the regular grid of four has \
             two.";
        LowDiscrepancy = "low-discrepancy", "Supersampling, low discrepancy",
            "First points of Sobol's sequence, each in its own row and column: as many steps as samples along vertical \
             and horizontal edges. With 16, 64 or 256 samples it is closer to the truth than the regular grid on the \
             scene chess, whose floor repeats along rows; the regular grid is closer on edges in random directions, \
             and with 16 samples on the scenes cubes and cel.";
        Multisample = "multisample", "Multisampling",
            "Coverage and depth at every sample, but each triangle shaded once per pixel (MSAA): smooth edges at less \
             cost than supersampling. Inside surfaces, in textures and at alpha-tested edges, nothing improves.",
            also ["msaa"];
    }
}

choice! {
    /// Number of samples per pixel.
    pub SampleCount {
        Four = "4", "4", "2 × 2, or one level of subdivision.";
        Sixteen = "16", "16", "4 × 4, or two levels of subdivision.";
        SixtyFour = "64", "64", "8 × 8, or three levels of subdivision.";
        All = "256", "256", "16 × 16, or four levels of subdivision: as many samples as the converged reference.";
    }
}

impl SampleCount {
    /// Returns the number of times that the pixel is halved along each axis.
    fn level(self) -> u32 {
        match self {
            Self::Four => 1,
            Self::Sixteen => 2,
            Self::SixtyFour => 3,
            Self::All => 4,
        }
    }

    /// Returns the number of samples per pixel.
    pub fn count(self) -> u32 {
        1 << (2 * self.level())
    }

    /// Returns the number of squares along an axis of the pixel.
    pub fn side(self) -> u32 {
        1 << self.level()
    }
}

/// Anti-aliasing settings: sampling of drawn pixels, and resolve of their samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(default)]
pub struct Antialiasing {
    /// Method, which determines the sample positions and the work done per sample.
    pub method: AntialiasMethod,
    /// Number of samples per pixel. Ignored by the rotated grid, which always has four.
    pub samples: SampleCount,
    /// Seed of the positions of jittered samples.
    pub seed: u32,
    /// Colour space in which samples are averaged.
    pub light: ColorSpace,
}

impl Default for Antialiasing {
    fn default() -> Self {
        Self { method: AntialiasMethod::None, samples: SampleCount::Four, seed: 0, light: ColorSpace::Linear }
    }
}

impl Antialiasing {
    /// Returns whether each pixel has a single sample, at its centre.
    pub fn is_off(self) -> bool {
        self.method == AntialiasMethod::None
    }

    /// Returns whether sample positions differ from pixel to pixel, or shading does not run per sample. In both cases,
    /// samples cannot be drawn in passes over the whole picture.
    pub(crate) fn is_per_pixel(self) -> bool {
        matches!(self.method, AntialiasMethod::Jittered | AntialiasMethod::Multisample)
    }

    /// Returns whether the picture is the mean of several passes, each with one sample per pixel.
    pub(crate) fn has_passes(self) -> bool {
        !self.is_off() && !self.is_per_pixel()
    }

    /// Returns the sample pattern that the method and the number of samples select.
    pub(crate) fn pattern(self) -> Pattern {
        let (side, count) = (self.samples.side(), self.samples.count());
        match self.method {
            AntialiasMethod::None => Pattern::Regular { side: 1 },
            AntialiasMethod::Regular => Pattern::Regular { side },
            AntialiasMethod::Recursive => Pattern::Recursive { level: self.samples.level() },
            AntialiasMethod::Jittered => Pattern::Jittered { side, seed: self.seed },
            AntialiasMethod::RotatedGrid => Pattern::RotatedGrid,
            AntialiasMethod::Multisample if count == SampleCount::Four.count() => Pattern::RotatedGrid,
            AntialiasMethod::LowDiscrepancy | AntialiasMethod::Multisample => Pattern::LowDiscrepancy { count },
        }
    }

    /// Returns the number of samples per pixel.
    pub(crate) fn count(self) -> u32 {
        self.pattern().count()
    }
}

choice! {
    /// Kind of filter applied to the finished picture.
    pub PostFilterKind {
        None = "none", "None", "No filter.";
        Fxaa = "fxaa", "Edges (FXAA)",
            "Finds edges by their contrast in luma, follows each to its ends, and blends in the share that a slanted \
             line would cover: stairs become ramps. The cost grows with the number of pixels and of edges, not with \
             that of triangles: 1.4 to 3.8 ms at 1920 × 1080 px with two threads (Zen 4), 23 to 84 % of the frame \
             without it on cel, stained-glass, chess and cubes. Texture detail and text soften too, and thin lines \
             stay broken (after T. Lottes, FXAA, 2009).";
        Smaa = "smaa", "Edges (SMAA)",
            "Finds edges by their contrast in luma relative to their surroundings, follows each to the edges that cross \
             its ends, and blends by the exact areas that a line between them cuts off: stairs of slanted edges become \
             ramps, and single pixels stay sharper than with FXAA. Edges near 45° are smoothed along their diagonal, \
             and right-angled corners are rounded only a quarter as much as steps; thin lines stay broken (after Jimenez, \
             Echevarria, Sousa and Gutierrez, SMAA: Enhanced Subpixel Morphological Antialiasing, 2012).";
        Blur = "blur", "Blur", "Mean of 3 × 3 or more pixels: blurs everything, not only edges.";
        Gaussian = "gaussian", "Gaussian blur",
            "Gaussian-weighted mean: softer than the plain mean, without its box artefacts.";
        Sharpen = "sharpen", "Sharpen",
            "Adds the difference between a pixel and its four neighbours: crisper, but amplifies stairs and noise too.";
        Motion = "motion", "Motion blur",
            "Mean along a straight line, as if the camera had moved while the shutter was open.";
        Custom = "own", "Custom mask", "Custom 3 × 3 or 5 × 5 weights; sums are clamped.";
    }
}

impl PostFilterKind {
    /// Returns the maximum strength of the filter, or `None` if the filter has no strength. The maximum follows from
    /// the size of the largest mask or, for sharpening, from the range of useful values.
    pub fn max_strength(self) -> Option<f32> {
        let reach = MAX_REACH as f32;
        match self {
            Self::None | Self::Fxaa | Self::Smaa | Self::Custom => None,
            Self::Blur => Some(reach),
            Self::Gaussian => Some(reach / GAUSSIAN_CUTOFF),
            Self::Sharpen => Some(5.0),
            Self::Motion => Some(2.0 * reach),
        }
    }
}

/// Weights of a custom convolution mask: five rows of five weights, from the top.
pub(crate) type MaskWeights = [f32; 25];

/// Identity mask, which leaves the picture unchanged.
const UNIT: MaskWeights = {
    let mut weights = [0.0; 25];
    weights[12] = 1.0;
    weights
};

/// Settings of the post filter, which is applied to the finished picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PostFilter {
    /// Filter to apply to the finished picture.
    pub filter: PostFilterKind,
    /// Strength of the filter, at most [`PostFilterKind::max_strength`]. It is the radius of a box blur in px, the
    /// standard deviation of a Gaussian blur in px, the amount of sharpening, or the length of a motion blur in px.
    pub strength: f32,
    /// Direction of a motion blur, in degrees clockwise from pointing right.
    pub angle_degrees: f32,
    /// Weights of a custom mask of 5 × 5 pixels, row by row from the top. A 3 × 3 mask lies in the centre, surrounded
    /// by zeros.
    pub mask: MaskWeights,
    /// Colour space in which the filter works. FXAA and SMAA always find edges in sRGB codes.
    pub light: ColorSpace,
}

impl Default for PostFilter {
    fn default() -> Self {
        Self { filter: PostFilterKind::None, strength: 1.0, angle_degrees: 0.0, mask: UNIT, light: ColorSpace::Linear }
    }
}

/// Returns the weights of a 3 × 3 mask, centred in a 5 × 5 mask.
pub(crate) fn centred_in_5x5(weights: [f32; 9]) -> MaskWeights {
    let mut wide = [0.0; 25];
    for (index, weight) in weights.into_iter().enumerate() {
        wide[(index / 3 + 1) * 5 + index % 3 + 1] = weight;
    }
    wide
}

impl PostFilter {
    /// Returns whether no filter is selected.
    pub fn is_off(&self) -> bool {
        self.filter == PostFilterKind::None
    }

    /// Returns the settings with another filter and the strength clamped to that filter's range.
    pub fn with_filter(self, filter: PostFilterKind) -> Self {
        let strength = filter.max_strength().map_or(self.strength, |most| self.strength.clamp(0.0, most));
        Self { filter, strength, ..self }
    }

    /// Returns an error message if the strength is out of range.
    pub(crate) fn check_strength(&self) -> Result<(), String> {
        let Self { filter, strength, .. } = self;
        if let Some(most) = filter.max_strength().filter(|most| !(0.0..=*most).contains(strength)) {
            return Err(format!("the strength of the filter `{}` must lie in 0…{most}, not {strength}", filter.id()));
        }
        if strength.is_finite() { Ok(()) } else { Err("must be finite".to_owned()) }
    }
}
