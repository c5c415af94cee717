//! What can be chosen about smooth edges: parts of a recipe.

use serde::{Deserialize, Serialize};

use super::pattern::Pattern;
use crate::flat2d::convolve::{BELL_DEVIATIONS, MOST_REACH};
use crate::pipeline::settings::{Choice, ColorSpace, choice};

choice! {
    /// How a drawn pixel is sampled.
    Method {
        None = "none", "None", "One sample at the pixel's centre: stairs along edges, and moiré where a pattern is finer than pixels.";
        Regular = "regular", "Supersampling, regular", "The middles of n × n squares of the pixel, all shaded, and their mean: simple, but edges that are nearly upright or level show only n steps.";
        Recursive = "recursive", "Supersampling, recursive", "The pixel quartered again and again, as some ray tracers do: the places of the regular grid, square by square. It splits everywhere, so the picture is that of the regular grid.";
        Jittered = "jittered", "Supersampling, jittered", "Somewhere in each of n × n squares, elsewhere in each pixel: what would be moiré becomes noise.";
        RotatedGrid = "rotated-grid", "Supersampling, rotated grid", "Four samples, each in a row and a column of its own: four steps along edges where the regular grid of four has two.";
        LowDiscrepancy = "low-discrepancy", "Supersampling, low discrepancy", "The first points of Sobol's sequence, each in a row and a column of its own: as many steps as samples along upright and level edges. With 16, 64 or 256 samples closer to the truth than the regular grid on the scene chess, whose floor repeats along rows; the regular grid is closer on edges in random directions, and with 16 samples on the scenes cubes and cel.";
        Multisample = "multisample", "Multisampling", "Coverage and depth at every sample, but each triangle shaded once in a pixel: smooth edges at less cost than supersampling. Inside of surfaces, in textures and at cut-outs, nothing improves.";
    }
}

choice! {
    /// How many samples a pixel gets.
    Samples {
        Four = "4", "4", "2 × 2, or one level of quarters.";
        Sixteen = "16", "16", "4 × 4, or two levels of quarters.";
        SixtyFour = "64", "64", "8 × 8, or three levels of quarters.";
        All = "256", "256", "16 × 16, or four levels of quarters: the number that the converged reference has.";
    }
}

impl Samples {
    /// How often the pixel is halved along each axis.
    fn level(self) -> u32 {
        match self {
            Self::Four => 1,
            Self::Sixteen => 2,
            Self::SixtyFour => 3,
            Self::All => 4,
        }
    }

    /// The number.
    pub fn count(self) -> u32 {
        1 << (2 * self.level())
    }

    /// Squares along an axis.
    pub fn side(self) -> u32 {
        1 << self.level()
    }
}

/// How drawn pixels are sampled, and how samples become a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(default)]
pub struct Antialiasing {
    /// Where samples lie, and what is done for each.
    pub method: Method,
    /// How many; the rotated grid always has four.
    pub samples: Samples,
    /// Other seeds, other places of jittered samples.
    pub seed: u32,
    /// The numbers whose mean is taken.
    pub light: ColorSpace,
}

impl Default for Antialiasing {
    fn default() -> Self {
        Self { method: Method::None, samples: Samples::Four, seed: 0, light: ColorSpace::Linear }
    }
}

impl Antialiasing {
    /// One sample at the centre, and nothing else.
    pub fn is_off(self) -> bool {
        self.method == Method::None
    }

    /// Whether places differ from pixel to pixel, or shading is not done for each sample: then samples are not drawn pass by
    /// pass.
    pub fn is_per_pixel(self) -> bool {
        matches!(self.method, Method::Jittered | Method::Multisample)
    }

    /// Whether the picture is the mean of several passes, each with one sample per pixel.
    pub fn has_passes(self) -> bool {
        !self.is_off() && !self.is_per_pixel()
    }

    /// Where samples lie.
    pub fn pattern(self) -> Pattern {
        let (side, count) = (self.samples.side(), self.samples.count());
        match self.method {
            Method::None => Pattern::Regular { side: 1 },
            Method::Regular => Pattern::Regular { side },
            Method::Recursive => Pattern::Recursive { level: self.samples.level() },
            Method::Jittered => Pattern::Jittered { side, seed: self.seed },
            Method::RotatedGrid => Pattern::RotatedGrid,
            Method::Multisample if count == Samples::Four.count() => Pattern::RotatedGrid,
            Method::LowDiscrepancy | Method::Multisample => Pattern::LowDiscrepancy { count },
        }
    }

    /// How many samples a pixel gets.
    pub fn count(self) -> u32 {
        self.pattern().count()
    }

    /// Name with the number of samples, such as "Multisampling, 4 samples".
    pub fn label(self) -> String {
        if self.is_off() { "1 sample".to_owned() } else { format!("{}, {} samples", self.method.name(), self.count()) }
    }
}

choice! {
    /// What is done with the finished picture.
    Filter {
        None = "none", "None", "Nothing.";
        Fxaa = "fxaa", "Edges (FXAA)", "Finds edges by their contrast in brightness, follows each to its ends, and shifts it by the share that a slanted line would cover: stairs become ramps. The cost grows with the number of pixels and of edges, not with that of triangles: 1.4 to 3.8 ms at 1920 × 1080 px with two threads (Zen 4), 23 to 84 % of the frame without it on cel, stained-glass, chess and cubes. Texture detail and letters soften too, and thin lines stay broken (after T. Lottes, FXAA, 2009).";
        Blur = "blur", "Blur", "The mean of 3 × 3 pixels or more: everything loses sharpness, not only edges.";
        Gaussian = "gaussian", "Gaussian blur", "A bell-shaped mean: softer than the plain one, without its boxes.";
        Sharpen = "sharpen", "Sharpen", "What sets a pixel off from its four neighbours, added to it: crisper, and stairs and noise grow too.";
        Motion = "motion", "Motion blur", "The mean along a straight way, as if the camera had moved while the shutter was open.";
        Own = "own", "Own mask", "Your own 3 × 3 or 5 × 5 weights; sums are clamped.";
    }
}

impl Filter {
    /// The greatest strength, where there is a choice: as far as masks go, and for sharpening as much as is of use.
    pub fn most_strength(self) -> Option<f32> {
        let reach = MOST_REACH as f32;
        match self {
            Self::None | Self::Fxaa | Self::Own => None,
            Self::Blur => Some(reach),
            Self::Gaussian => Some(reach / BELL_DEVIATIONS),
            Self::Sharpen => Some(5.0),
            Self::Motion => Some(2.0 * reach),
        }
    }
}

/// Weights of an own mask: five rows of five.
pub type Weights = [f32; 25];

/// The mask that changes nothing.
const UNIT: Weights = {
    let mut weights = [0.0; 25];
    weights[12] = 1.0;
    weights
};

/// The filter over the finished picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PostFilter {
    /// Which one.
    pub filter: Filter,
    /// How far or how much: px from the middle to the edge of a blur, standard deviation in px of a Gaussian one, amount of
    /// sharpening, px of a motion; up to [`Filter::most_strength`].
    pub strength: f32,
    /// Direction of a motion, degrees from the right towards below.
    pub angle_degrees: f32,
    /// Weights of an own mask, row by row; a mask of 3 × 3 stands in the middle.
    pub mask: Weights,
    /// The numbers that are filtered. Edges are always found in codes.
    pub light: ColorSpace,
}

impl Default for PostFilter {
    fn default() -> Self {
        Self { filter: Filter::None, strength: 1.0, angle_degrees: 0.0, mask: UNIT, light: ColorSpace::Linear }
    }
}

/// Nine weights in the middle of five rows of five.
pub fn widened(weights: [f32; 9]) -> Weights {
    let mut wide = [0.0; 25];
    for (index, weight) in weights.into_iter().enumerate() {
        wide[(index / 3 + 1) * 5 + index % 3 + 1] = weight;
    }
    wide
}

impl PostFilter {
    /// Whether it changes nothing.
    pub fn is_off(&self) -> bool {
        self.filter == Filter::None
    }

    /// Another filter, as strong as this one or as it can be.
    pub fn with_filter(self, filter: Filter) -> Self {
        let strength = filter.most_strength().map_or(self.strength, |most| self.strength.clamp(0.0, most));
        Self { filter, strength, ..self }
    }

    /// Why these numbers cannot be filtered with.
    pub fn check(&self) -> Result<(), String> {
        let Self { filter, strength, .. } = self;
        if let Some(most) = filter.most_strength().filter(|most| !(0.0..=*most).contains(strength)) {
            return Err(format!("the strength of the filter `{}` must lie in 0…{most}, not {strength}", filter.id()));
        }
        if !strength.is_finite()
            || !self.angle_degrees.is_finite()
            || !self.mask.iter().all(|weight| weight.is_finite())
        {
            return Err("numbers must be finite".to_owned());
        }
        Ok(())
    }
}
