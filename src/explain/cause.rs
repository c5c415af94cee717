//! Causes: the faults that were found, with what each of them explains, and what makes them convincing.

use rasterscope_engine::image::{Image, Rgba8};
use serde::Serialize;

use crate::fault::{Fault, Slot};

/// Smallest number of pixels that only one fault must explain to be named.
pub(crate) const LEAST_PIXELS: f64 = 20.0;

/// Smallest share of the picture that only one fault must explain to be named.
const LEAST_SHARE: f64 = 2e-4;

/// Smallest share of the pixels that a fault changes towards or away from agreement that must change towards it.
const LEAST_PRECISION: f64 = 0.9;

/// Smallest share of the pixels that differ without a fault that the fault must explain. An unknown fault can look like a
/// known one in a few of its pixels.
const LEAST_OF_DIFFERING: f64 = 0.15;

/// Smallest share of the explained pixels that must agree exactly. Of a chance agreement within the tolerance of two
/// codes either way, a fifth is exact.
const LEAST_EXACT: f64 = 0.3;

/// Smallest share of the picture whose codes another rounding must explain.
const LEAST_ROUNDED: f64 = 0.05;

/// Fault that was found.
#[derive(Clone, Debug)]
pub struct Cause {
    /// The fault.
    pub fault: &'static Fault,
    /// Value that was measured in the picture: the colour of the background as `#rrggbb`.
    pub detail: Option<String>,
    /// Number of pixels that agree with all causes, but not without this one.
    pub explained: u64,
    /// Number of the explained pixels that agree exactly.
    pub exact: u64,
    /// Number of pixels that differ without this cause.
    pub differing_without: u64,
    /// Number of pixels that agree without this cause, but not with all of them.
    pub spoiled: u64,
    /// Pixels whose depths agree only with, or only without it.
    pub depth: Tally,
    /// Pixels whose ids agree only with, or only without it.
    pub ids: Tally,
    /// Other faults that would give exactly the same picture here.
    pub alternatives: Vec<&'static Fault>,
}

/// Effect of a cause on the agreement of depths or ids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Number of pixels that agree with all causes, but not without this one.
    pub explained: u64,
    /// Number of pixels that differ without this cause.
    pub differing_without: u64,
    /// Number of pixels that agree without this cause, but not with all of them.
    pub spoiled: u64,
}

impl Tally {
    /// Counts pixels that differ with and without a cause.
    pub(crate) fn of(with: &[bool], without: &[bool]) -> Self {
        let count = |is_counted: &dyn Fn(bool, bool) -> bool| {
            with.iter().zip(without).filter(|(with, without)| is_counted(**with, **without)).count() as u64
        };
        Self {
            explained: count(&|with, without| !with && without),
            differing_without: count(&|_, without| without),
            spoiled: count(&|with, without| with && !without),
        }
    }

    /// Returns whether enough pixels agree only with the cause, and few only without it.
    fn is_convincing(self, least: f64) -> bool {
        let (explained, spoiled) = (self.explained as f64, self.spoiled as f64);
        let of_differing = LEAST_OF_DIFFERING * self.differing_without as f64;
        explained >= least.max(of_differing) && explained >= LEAST_PRECISION * (explained + spoiled)
    }
}

impl Cause {
    /// Returns the effect on colours.
    fn color(&self) -> Tally {
        let Self { explained, differing_without, spoiled, .. } = *self;
        Tally { explained, differing_without, spoiled }
    }

    /// Returns the settings, each as `key=value`, that have the effect of the cause; `None` if no settings have it.
    pub fn settings(&self) -> Option<Vec<String>> {
        let of_fault = self.fault.settings().map(|settings| settings.iter().map(|text| (*text).to_owned()).collect());
        of_fault.or_else(|| self.detail.as_ref().map(|color| vec![format!("background={color}")]))
    }
}

/// Returns whether enough pixels agree only with a cause, many of them exactly, and few only without it: in colour,
/// depth or ids, without making the others worse.
pub(crate) fn is_convincing(cause: &Cause, picture: &Image<Rgba8>) -> bool {
    let least = |share: f64| LEAST_PIXELS.max(share * picture.pixels().len() as f64);
    let share = if cause.fault.slot == Slot::Rounding { LEAST_ROUNDED } else { LEAST_SHARE };
    let color = cause.color();
    let is_exact = cause.exact as f64 >= LEAST_EXACT * cause.explained as f64;
    let in_color = is_exact && color.is_convincing(least(share));
    let in_buffers = [cause.depth, cause.ids].iter().any(|tally| tally.is_convincing(least(LEAST_SHARE)));
    let all = [color, cause.depth, cause.ids];
    let explained: u64 = all.iter().map(|tally| tally.explained).sum();
    let spoiled: u64 = all.iter().map(|tally| tally.spoiled).sum();
    (in_color || in_buffers) && explained as f64 >= LEAST_PRECISION * (explained + spoiled) as f64
}
