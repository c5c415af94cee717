//! Implementations of the assertions: each returns a description of a violation, or `None`.

use super::Assertion;
use super::exact::{Owner, corner_depths};
use crate::pipeline::depth::DepthScale;
use crate::pipeline::interpolate::{Fragment, affine_weights, attribute_weights};
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Arithmetic, Choice as _, DepthTest, Settings};

/// Maximum difference between 1 and the sum of the attribute weights: twice the machine epsilon of f32.
const SUM_SLACK: f32 = 2.0 * f32::EPSILON;

/// Maximum difference between the sum of the edge values and the doubled area in floating point, as a fraction of the
/// doubled area: four times the machine epsilon of f64.
const EDGE_ROUNDINGS: f64 = 4.0 * f64::EPSILON;

/// Tolerance for fragments that passed the depth test: they may lie on the wrong side of the stored depth by this many
/// units of [`PassedFragment::step`]. The tolerance covers the rounding error of w: the depth is computed from w, which
/// is a sum of four products.
const PASS_STEPS: f64 = 8.0;

/// A covered sample, as passed to the checks of coverage, weights and depth.
pub(super) struct CoveredSample<'a> {
    pub(super) settings: &'a Settings,
    pub(super) scale: &'a DepthScale,
    pub(super) triangle: &'a ScreenTriangle,
    pub(super) sample: &'a RasterSample,
    /// Depth of the fragment as the depth buffer stores it, in [0, 1].
    pub(super) depth: f32,
    pub(super) owner: &'a Owner,
}

/// A fragment that passed the depth test against an already stored depth.
pub(super) struct PassedFragment<'a> {
    pub(super) settings: &'a Settings,
    /// Depths of the fragment and of the stored fragment, in that order, before quantisation.
    pub(super) depths: [f64; 2],
    /// Unit of [`PASS_STEPS`]: the depth buffer's step at the fragment's depth or at the stored depth, whichever is
    /// larger, plus the uncertainty of the fragment's depth.
    pub(super) step: f64,
}

/// A fragment that was blended over another blended fragment.
pub(super) struct Blend {
    /// Depth of the fragment, quantised like a stored depth.
    pub(super) depth: f32,
    /// Quantised depth of the nearest fragment blended earlier at the same sample.
    pub(super) nearest: f32,
    /// Whether the earlier fragment is nearer to the viewer, so that the order is wrong.
    pub(super) is_wrong: bool,
}

/// Input of the assertions on shaded fragments.
pub(super) struct ShadedFragment<'a> {
    pub(super) fragment: &'a Fragment,
    pub(super) is_lit: bool,
}

/// Description of a violation; `None` if the assertion holds.
type ViolationText = Option<String>;

/// The function that checks an assertion. The variant determines the pipeline event at which the function is called.
#[derive(Clone, Copy)]
pub(super) enum AssertionCheck {
    Covered(fn(&CoveredSample<'_>) -> ViolationText),
    Pass(fn(&PassedFragment<'_>) -> ViolationText),
    Shaded(fn(&ShadedFragment<'_>) -> Option<ViolationText>),
    Blend(fn(&Blend) -> ViolationText),
    /// The assertion concerns the mesh rather than fragments, so it is checked once, after all fragments.
    Mesh,
}

impl AssertionCheck {
    /// Returns the function that checks an assertion.
    pub(super) fn of(assertion: Assertion) -> Self {
        match assertion {
            Assertion::Owner => Self::Covered(owner),
            Assertion::EdgeSum => Self::Covered(edge_sum),
            Assertion::Weights => Self::Covered(weights),
            Assertion::WeightsSum => Self::Covered(weights_sum),
            Assertion::Finite => Self::Covered(finite),
            Assertion::DepthRange => Self::Covered(depth_range),
            Assertion::DepthPass => Self::Pass(depth_pass),
            Assertion::Attributes => Self::Shaded(|shaded| Some(attributes(shaded))),
            Assertion::BlendOrder => Self::Blend(blend_order),
            Assertion::Normal => Self::Shaded(normal),
            Assertion::Junctions => Self::Mesh,
        }
    }
}

fn owner(at: &CoveredSample<'_>) -> ViolationText {
    match at.owner.owns((at.sample.x, at.sample.y)) {
        Ok(()) => None,
        Err(None) => Some("the triangle has no area, yet it has a fragment".to_owned()),
        Err(Some(edges)) => {
            let least = (0..3).min_by(|a, b| edges[*a].total_cmp(&edges[*b])).unwrap_or(0);
            let side = if edges[least] < 0.0 { "outside" } else { "on an edge that another triangle owns" };
            Some(format!("the centre lies {side}: edge opposite to v{least} is {} exactly", edges[least]))
        }
    }
}

fn edge_sum(at: &CoveredSample<'_>) -> ViolationText {
    let (sum, area) = (at.sample.edges.iter().sum::<f64>(), at.triangle.doubled_area);
    let slack = if at.settings.arithmetic == Arithmetic::Fixed { 0.0 } else { area * EDGE_ROUNDINGS };
    let holds = (sum - area).abs() <= slack;
    (!holds).then(|| format!("edge values {:?} sum to {sum}, not to the doubled area {area}", at.sample.edges))
}

fn all_weights(at: &CoveredSample<'_>) -> [[f32; 3]; 2] {
    let affine = affine_weights(at.triangle, at.sample);
    [affine, attribute_weights(at.triangle, at.sample, at.settings.interpolation)]
}

fn weights(at: &CoveredSample<'_>) -> ViolationText {
    let found = all_weights(at).into_iter().find(|weights| !weights.iter().all(|w| (0.0..=1.0).contains(w)));
    found.map(|weights| format!("the weights are {weights:?}"))
}

fn weights_sum(at: &CoveredSample<'_>) -> ViolationText {
    let [_, weights] = all_weights(at);
    let sum: f32 = weights.iter().sum();
    let holds = (sum - 1.0).abs() <= SUM_SLACK;
    (!holds).then(|| format!("the weights {weights:?} sum to {sum:?}"))
}

fn finite(at: &CoveredSample<'_>) -> ViolationText {
    let weights = all_weights(at);
    let holds = weights.as_flattened().iter().all(|w| w.is_finite()) && at.depth.is_finite();
    (!holds).then(|| format!("weights {weights:?}, depth {:?}", at.depth))
}

fn depth_range(at: &CoveredSample<'_>) -> ViolationText {
    let corners = corner_depths(at.triangle, at.scale).map(|depth| depth.clamp(0.0, 1.0));
    let (low, high) = (corners.into_iter().fold(1.0, f64::min), corners.into_iter().fold(0.0, f64::max));
    let [depth, next] = at.scale.encoding().depth_and_next(at.depth);
    let step = (next - depth).abs();
    let holds = (low - step..=high + step).contains(&f64::from(at.depth)) && (0.0..=1.0).contains(&at.depth);
    (!holds).then(|| format!("the depth is {:?}, the corner depths are {corners:?}", at.depth))
}

fn depth_pass(pass: &PassedFragment<'_>) -> ViolationText {
    let [new, old] = pass.depths;
    let asks_for_farther = pass.settings.depth_test == DepthTest::Greater;
    let less_is_asked_for = asks_for_farther == pass.settings.reversed();
    let wrong_by = if less_is_asked_for { new - old } else { old - new };
    let holds = wrong_by <= PASS_STEPS * pass.step;
    let way = if asks_for_farther { "in front of" } else { "behind" };
    let test = pass.settings.depth_test.name();
    (!holds).then(|| format!("it passed the depth test “{test}” at depth {new}, {way} the stored depth {old}"))
}

fn blend_order(Blend { depth, nearest, is_wrong }: &Blend) -> ViolationText {
    is_wrong.then(|| format!("it is blended at depth {depth:?} over a nearer fragment at depth {nearest:?}"))
}

fn attributes(at: &ShadedFragment<'_>) -> ViolationText {
    let Fragment { uv, normal, color, light, .. } = at.fragment;
    let holds = uv.is_finite() && normal.is_finite() && color.is_finite() && light.is_finite();
    (!holds).then(|| format!("texture coordinates {uv}, normal {normal}, colour {color}, light {light}"))
}

/// Checks that the normal of a lit fragment has a non-zero length; returns `None` for unlit fragments.
fn normal(at: &ShadedFragment<'_>) -> Option<ViolationText> {
    let length = at.fragment.normal.length();
    at.is_lit.then(|| {
        (length <= f32::MIN_POSITIVE || length.is_nan()).then(|| format!("the normal is {}", at.fragment.normal))
    })
}
