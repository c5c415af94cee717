//! Navigation history: inspection states in the order in which they were visited, with steps back and forward.

use crate::inspect::InspectionState;

/// Maximum number of entries in the navigation history.
const MAX_VISITS: usize = 200;

/// Maximum time, in seconds, between two changes of camera or pixel that are combined into one entry of the history,
/// for example during a drag, scrolling or a held arrow key.
const ONE_MOVE_SECONDS: f64 = 0.6;

/// Navigation history with its past, current and future entries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Visits {
    past: Vec<InspectionState>,
    here: Option<InspectionState>,
    future: Vec<InspectionState>,
    /// Time of the last change of the current entry, in seconds.
    changed_at: f64,
}

impl Visits {
    /// Whether there is an entry to go back to.
    pub(crate) fn can_go_back(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is an entry to go forward to.
    pub(crate) fn can_go_forward(&self) -> bool {
        !self.future.is_empty()
    }

    /// Records the current inspection state at time `now`, in seconds. Changing settings or clearing the pick does not
    /// add an entry to the history.
    pub(crate) fn note(&mut self, place: InspectionState, now: f64) {
        let Some(here) = &self.here else {
            self.here = Some(place);
            return;
        };
        if same_sight(here, &place) {
            return;
        }
        let no_pixel = InspectionState { pixel: None, ..here.clone() };
        if same_sight(&no_pixel, &place) {
            return;
        }
        let moves_on = now - self.changed_at < ONE_MOVE_SECONDS
            && same_sight(&InspectionState { camera: place.camera, pixel: place.pixel, ..here.clone() }, &place);
        let picks_first =
            here.pixel.is_none() && same_sight(&InspectionState { pixel: place.pixel, ..here.clone() }, &place);
        let before = self.here.replace(place);
        self.changed_at = now;
        if moves_on || picks_first {
            return;
        }
        if self.past.len() == MAX_VISITS {
            self.past.remove(0);
        }
        self.past.extend(before);
        self.future.clear();
    }

    /// Goes one entry back or forward in the history and returns its inspection state; `None` at the end of the
    /// history.
    pub(crate) fn travel(&mut self, back: bool) -> Option<InspectionState> {
        let (from, to) = if back { (&mut self.past, &mut self.future) } else { (&mut self.future, &mut self.past) };
        let place = from.pop()?;
        to.extend(self.here.replace(place.clone()));
        // The next change is not combined with this entry, even if it follows soon.
        self.changed_at = f64::NEG_INFINITY;
        Some(place)
    }

    /// Replaces the state returned by [`Self::travel`] with the state that was actually restored, so that the
    /// difference does not count as a new entry.
    pub(crate) fn arrived(&mut self, place: InspectionState) {
        let is_expected = self.here.as_ref().is_some_and(|here| same_sight(here, &place));
        if is_expected {
            self.here = Some(place);
        }
    }
}

/// Whether two inspection states are equal, ignoring recipe, picture size, display settings, overlays and the time of the
/// scene, which playback changes.
fn same_sight(a: &InspectionState, b: &InspectionState) -> bool {
    InspectionState {
        recipe: b.recipe,
        picture: b.picture,
        display: b.display,
        time_s: b.time_s,
        overlays: b.overlays.clone(),
        ..a.clone()
    } == *b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Recipe;
    use crate::inspect::{Buffer, Stage};
    use crate::scene::builtin;

    fn place(pixel: u32) -> InspectionState {
        InspectionState {
            scene: "triangle".into(),
            mirrored: false,
            time_s: 0.0,
            camera: builtin::by_id("triangle").map(|scene| scene.build().home).unwrap(),
            recipe: Recipe::default(),
            picture: None,
            buffer: Buffer::Color,
            stage: None,
            number: None,
            display: Default::default(),
            overlays: Vec::new(),
            triangles: None,
            fragments: None,
            pixel: Some((pixel, 0)),
        }
    }

    #[test]
    fn back_and_forward_retrace_the_visits() {
        let mut visits = Visits::default();
        for step in 0..4 {
            visits.note(place(step), f64::from(step) * 10.0);
        }
        for expected in [2, 1, 0] {
            assert_eq!(visits.travel(true), Some(place(expected)));
        }
        assert_eq!(visits.travel(true), None);
        for expected in [1, 2, 3] {
            assert_eq!(visits.travel(false), Some(place(expected)));
        }
        assert!(!visits.can_go_forward() && visits.can_go_back());
    }

    #[test]
    fn quick_moves_are_one_visit_and_a_change_of_stage_is_another() {
        let mut visits = Visits::default();
        for (step, seconds) in [(0, 10.0), (1, 20.0), (2, 20.1), (3, 20.2)] {
            visits.note(place(step), seconds);
        }
        visits.note(InspectionState { stage: Some(Stage::Clip), ..place(3) }, 20.3);
        assert_eq!(visits.travel(true), Some(place(3)));
        assert_eq!(visits.travel(true), Some(place(0)));
    }

    #[test]
    fn settings_and_clearing_the_pick_are_not_visits_and_a_new_visit_clears_the_future() {
        let mut visits = Visits::default();
        visits.note(place(0), 0.0);
        let mut other = place(0);
        other.recipe.wireframe = true;
        visits.note(other, 10.0);
        visits.note(InspectionState { pixel: None, ..place(0) }, 20.0);
        assert!(!visits.can_go_back());
        visits.note(place(1), 30.0);
        visits.travel(true);
        visits.note(place(7), 40.0);
        assert!(!visits.can_go_forward());
        assert_eq!(visits.travel(true), Some(place(0)));
    }
}
