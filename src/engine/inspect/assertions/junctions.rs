//! Check that the mesh has no T-junctions: adjacent borders must share their vertices.

use super::{Assertion, Finding, Violation};
use crate::chain::{Frame, Recipe};
use crate::inspect::hits::{Hits, border_in_picture, junction_pixels};
use crate::scene::Scene;
use crate::scene::seams::{Junction, Seams};

/// Checks the vertices of all open edges within the picture for T-junctions and unwelded vertices.
pub(super) fn check(scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams) -> Finding {
    let places = junction_pixels(scene, recipe, frame, seams);
    let mut there = seams.junctions().iter().zip(places).filter_map(|(junction, pixel)| Some((junction, pixel?)));
    let hits = Hits::of(frame, &recipe.pipeline).with_seams(scene, recipe, frame, seams);
    let open = hits.faults.iter().find_map(|fault| Some((fault.junction?, (fault.x, fault.y))));
    let violated = there.clone().count();
    let first = match open {
        Some((junction, pixel)) => Some(violation(&junction, pixel)),
        None => there.next().map(|(junction, pixel)| violation(junction, pixel)),
    };
    let checked = border_in_picture(scene, recipe, frame, seams).max(violated) as u64;
    Finding { assertion: Assertion::Junctions, checked, violated: violated as u64, first }
}

fn violation(junction: &Junction, (x, y): (u32, u32)) -> Violation {
    Violation { x, y, triangle: junction.edge.triangle, text: junction.text() }
}
