//! Explanation of a pixel whose colour is wrong because its fragments were not blended from far to near.

use crate::chain::{Frame, Recipe};
use crate::inspect::blending::{is_nearer, sorted};
use crate::inspect::pixel::{FragmentRecord, PixelReport, centre_color};
use crate::pipeline::settings::Settings;
use crate::scene::{Scene, Transparency};

/// Reports a fragment that was blended over a nearer one. Adds the colour that the exact blending order gives, and the
/// setting that selects this order. Returns `None` if there is no such fragment.
pub(super) fn verdict(report: &PixelReport, scene: &Scene, recipe: &Recipe, frame: &Frame) -> Option<String> {
    let [near, far] = wrong_pair(report, &recipe.pipeline)?.map(super::name);
    let [x, y] = report.drawn_at;
    let [red, green, blue, _] = centre_color(scene, &sorted(recipe), frame, (x, y))?;
    Some(format!(
        "Blended in the wrong order: {far} was blended over {near}, which is nearer; sorted from far to near the \
         colour is ({red}, {green}, {blue}). Set blending.order to exact."
    ))
}

/// Returns the first two fragments of which the nearer one was blended before the farther one, in this order.
fn wrong_pair<'a>(report: &'a PixelReport, settings: &Settings) -> Option<[&'a FragmentRecord; 2]> {
    let blended = |f: &&FragmentRecord| f.transparency == Transparency::Blended && f.outcome.is_written();
    let blended: Vec<_> = report.fragments.iter().filter(blended).collect();
    let lies_over = |pair: &&[&FragmentRecord]| is_nearer(pair[0].depth.value, pair[1].depth.value, settings);
    blended.windows(2).find(lies_over).map(|pair| [pair[0], pair[1]])
}

/// Whether a fragment was blended over a nearer one.
pub(in crate::inspect) fn is_blended_wrongly(report: &PixelReport, settings: &Settings) -> bool {
    wrong_pair(report, settings).is_some()
}
