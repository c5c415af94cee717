//! The observer that passes each fragment to the assertions and counts violations.

use super::checks::{AssertionCheck, Blend, CoveredSample, PassedFragment, ShadedFragment};
use super::exact::{Owner, depth};
use super::{Assertion, AssertionReport, Finding, Violation};
use crate::chain::{Frame, Recipe};
use crate::image::{Image, Rgba8};
use crate::inspect::blending::BlendedDepths;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::{DepthOutcome, Observer};
use crate::pipeline::plan::{DrawPlan, PipelinePart};
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use crate::pipeline::settings::Settings;
use crate::pipeline::shading::Input;

/// Observer that checks the fragments of a frame in drawing order.
pub(super) struct AssertionObserver<'a> {
    settings: &'a Settings,
    scale: DepthScale,
    plans: &'a [DrawPlan],
    entries: Vec<(AssertionCheck, Finding)>,
    /// Stored depth of each sample before quantisation; NaN until a depth is stored.
    stored: Image<f64>,
    blended: BlendedDepths<'a>,
    /// Address and ownership test of the triangle that covered the previous sample, cached for the next sample.
    triangle: Option<(*const ScreenTriangle, Owner)>,
}

impl<'a> AssertionObserver<'a> {
    pub(super) fn new(recipe: &'a Recipe, frame: &'a Frame, wanted: &[Assertion]) -> Self {
        let finding = |assertion| Finding { assertion, checked: 0, violated: 0, first: None };
        let (width, height) = frame.drawn.color.size();
        Self {
            settings: &recipe.pipeline,
            scale: frame.geometry().depth_scale,
            plans: &frame.plans,
            entries: wanted.iter().map(|assertion| (AssertionCheck::of(*assertion), finding(*assertion))).collect(),
            stored: Image::filled(width, height, f64::NAN),
            blended: BlendedDepths::new(&recipe.pipeline, frame),
            triangle: None,
        }
    }

    pub(super) fn report(self) -> AssertionReport {
        AssertionReport { findings: self.entries.into_iter().map(|(_, finding)| finding).collect() }
    }
}

/// Counts one checked fragment; `wrong` describes its violation, if any.
fn count(finding: &mut Finding, triangle: &ScreenTriangle, sample: &RasterSample, wrong: Option<String>) {
    finding.checked += 1;
    if let Some(text) = wrong {
        finding.violated += 1;
        finding.first.get_or_insert(Violation { x: sample.x, y: sample.y, triangle: triangle.id, text });
    }
}

impl Observer for AssertionObserver<'_> {
    fn covered(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
        let place = std::ptr::from_ref(triangle);
        if self.triangle.as_ref().is_none_or(|(known, _)| *known != place) {
            self.triangle = Some((place, Owner::of(triangle, self.settings)));
        }
        let Some((_, owner)) = &self.triangle else { return };
        let depth = depth_at(triangle, sample);
        let at = CoveredSample { settings: self.settings, scale: &self.scale, triangle, sample, depth, owner };
        for (check, finding) in &mut self.entries {
            if let AssertionCheck::Covered(check) = check {
                count(finding, triangle, sample, check(&at));
            }
        }
    }

    fn depth_tested(&mut self, triangle: &ScreenTriangle, sample: &RasterSample, outcome: DepthOutcome) {
        let old = self.stored.at(sample.column, sample.row);
        if !outcome.passed || old.is_nan() {
            return;
        }
        let (new, unknown) = depth(triangle, sample, &self.scale);
        let steps = [outcome.new, outcome.stored].map(|stored| {
            let [depth, next] = self.scale.encoding().depth_and_next(stored);
            (next - depth).abs()
        });
        let pass =
            PassedFragment { settings: self.settings, depths: [new, old], step: steps[0].max(steps[1]) + unknown };
        for (check, finding) in &mut self.entries {
            if let AssertionCheck::Pass(check) = check {
                count(finding, triangle, sample, check(&pass));
            }
        }
    }

    fn depth_stored(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
        let (depth, _) = depth(triangle, sample, &self.scale);
        self.stored.set(sample.column, sample.row, depth);
    }

    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let plan = self.plans.get(triangle.instance as usize);
        let is_lit = self.settings.shading.reads(Input::LightDirection)
            && plan.is_some_and(|plan| plan.runs(PipelinePart::Light));
        let at = ShadedFragment { fragment, is_lit };
        let pair = self.blended.add(triangle, &fragment.sample);
        let blend =
            pair.map(|[depth, nearest]| Blend { depth, nearest, is_wrong: self.blended.is_wrong([depth, nearest]) });
        for (check, finding) in &mut self.entries {
            if let AssertionCheck::Shaded(check) = check
                && let Some(wrong) = check(&at)
            {
                count(finding, triangle, &fragment.sample, wrong);
            }
            if let (AssertionCheck::Blend(check), Some(blend)) = (&*check, &blend) {
                count(finding, triangle, &fragment.sample, check(blend));
            }
        }
    }
}
