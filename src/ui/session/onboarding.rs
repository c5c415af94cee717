//! Introduction for new users: a card with starting points, and a coach that explains four steps on the live picture.

use std::path::Path;

use crate::inspect::lesson::BlackPixelLesson;
use crate::scene::SceneSource;
use crate::ui::session::feature::Feature;
use crate::ui::session::preferences::Seen;
use crate::ui::session::window_task::WindowTask;
use crate::ui::session::{Preferences, Session};

/// Step of the coach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CoachStep {
    /// Orbiting the camera and zooming the picture.
    Move,
    /// Picking a pixel of the picture.
    Pick,
    /// Showing the picture after a stage.
    Stage,
    /// Comparing the pictures of two upscalers.
    Compare,
}

impl CoachStep {
    /// All steps, in order.
    pub(crate) const ALL: [Self; 4] = [Self::Move, Self::Pick, Self::Stage, Self::Compare];

    /// Returns the next step; `None` after the last one.
    pub(crate) fn next(self) -> Option<Self> {
        Self::ALL.get(self.number()).copied()
    }

    /// Returns the number of the step, from 1.
    pub(in crate::ui) fn number(self) -> usize {
        Self::ALL.iter().position(|step| *step == self).map_or(0, |index| index + 1)
    }
}

/// State of the introduction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Onboarding {
    /// Whether the start card is shown.
    pub(crate) card_open: bool,
    /// Step that the coach explains; `None` if the coach is closed.
    pub(crate) step: Option<CoachStep>,
    /// Parts of the introduction that the user has closed.
    pub(crate) seen: Seen,
    /// Whether the user has orbited the camera, and zoomed, since the coach was started.
    moved: (bool, bool),
    /// Zoom of the canvas as of the last frame, in screen pixels per picture pixel; `None` if the picture is fitted.
    zoom: Option<f32>,
    /// Lesson whose scene is being opened.
    pub(crate) opening_lesson: Option<&'static BlackPixelLesson>,
    /// Lesson of the scene on screen; its black spot is picked automatically.
    pub(crate) lesson: Option<&'static BlackPixelLesson>,
}

/// Change to the introduction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OnboardingChange {
    /// Shows the start card.
    OpenCard,
    /// Closes the start card, and starts the coach unless it was closed before.
    CloseCard,
    /// Starts the coach at its first step.
    StartCoach,
    /// Goes to the next step of the coach; after the last one, closes the coach.
    NextStep,
    /// Closes the coach.
    SkipCoach,
}

/// State of the window that the coach observes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Observed {
    /// Zoom of the canvas, in screen pixels per picture pixel; `None` if the picture is fitted.
    pub(crate) zoom: Option<f32>,
    /// Whether the picture after a stage is shown.
    pub(crate) shows_stage: bool,
    /// Whether pictures are compared.
    pub(crate) compares: bool,
}

impl Onboarding {
    /// Shows what the user has not closed yet: the start card, or otherwise the coach.
    pub(crate) fn begin(&mut self) {
        if !self.seen.start_card {
            self.card_open = true;
        } else if !self.seen.coach {
            self.apply(OnboardingChange::StartCoach);
        }
    }

    /// Applies a change.
    pub(crate) fn apply(&mut self, change: OnboardingChange) {
        match change {
            OnboardingChange::OpenCard => (self.card_open, self.step) = (true, None),
            OnboardingChange::CloseCard => {
                (self.card_open, self.seen.start_card) = (false, true);
                if !self.seen.coach {
                    self.apply(OnboardingChange::StartCoach);
                }
            }
            OnboardingChange::StartCoach => {
                (self.card_open, self.seen.start_card) = (false, true);
                (self.step, self.moved) = (Some(CoachStep::ALL[0]), (false, false));
            }
            OnboardingChange::NextStep => match self.step.and_then(CoachStep::next) {
                Some(next) => self.step = Some(next),
                None => self.apply(OnboardingChange::SkipCoach),
            },
            OnboardingChange::SkipCoach => (self.step, self.seen.coach) = (None, true),
        }
    }

    /// Closes the start card or otherwise the coach. Returns whether one of them was open.
    pub(crate) fn escape(&mut self) -> bool {
        let change = match (self.card_open, self.step) {
            (true, _) => OnboardingChange::CloseCard,
            (false, Some(_)) => OnboardingChange::SkipCoach,
            (false, None) => return false,
        };
        self.apply(change);
        true
    }

    /// Records that the user has orbited or otherwise moved the camera.
    pub(super) fn observe_camera(&mut self) {
        self.moved.0 |= self.step == Some(CoachStep::Move);
    }

    /// Advances the coach if its step explains picking, because the user has picked a pixel.
    pub(super) fn observe_pick(&mut self) {
        if self.step == Some(CoachStep::Pick) {
            self.apply(OnboardingChange::NextStep);
        }
    }

    /// Advances the coach if the window is in the state that its step leads to.
    pub(crate) fn observe(&mut self, now: Observed) {
        self.moved.1 |= now.zoom != self.zoom;
        self.zoom = now.zoom;
        let is_done = match self.step {
            Some(CoachStep::Move) => self.moved == (true, true),
            Some(CoachStep::Stage) => now.shows_stage,
            Some(CoachStep::Compare) => now.compares,
            Some(CoachStep::Pick) | None => false,
        };
        if is_done {
            self.apply(OnboardingChange::NextStep);
        }
    }

    /// Starts the lesson that was to be opened, if its scene has now been opened. Returns the lesson.
    pub(crate) fn arrive(&mut self, source: &SceneSource) -> Option<&'static BlackPixelLesson> {
        let is_shown = |lesson: &&BlackPixelLesson| source.name() == Path::new(lesson.scene);
        self.lesson = self.opening_lesson.take().filter(is_shown);
        self.lesson
    }

    /// Returns whether the user has orbited the camera, and whether the user has zoomed, since the coach was started.
    pub(crate) fn moved(&self) -> (bool, bool) {
        self.moved
    }
}

impl Feature for Onboarding {
    type Change = OnboardingChange;

    fn apply(session: &mut Session, change: OnboardingChange) -> Option<WindowTask> {
        session.features.onboarding.apply(change);
        None
    }

    fn leave_scene(&mut self) {
        self.lesson = None;
    }

    fn store(&self, preferences: &mut Preferences) {
        preferences.seen = self.seen;
    }

    fn restore(&mut self, preferences: &Preferences) {
        self.seen = preferences.seen;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::session::command::Command;

    const STILL: Observed = Observed { zoom: None, shows_stage: false, compares: false };

    fn coached() -> Onboarding {
        let mut onboarding = Onboarding { seen: Seen { start_card: true, coach: false }, ..Onboarding::default() };
        onboarding.begin();
        onboarding
    }

    #[test]
    fn each_step_ends_when_the_user_has_done_it() {
        let mut onboarding = coached();
        onboarding.observe(STILL);
        assert_eq!(onboarding.step, Some(CoachStep::Move), "nothing was done");
        let camera = crate::scene::builtin::by_id("triangle").unwrap().build().home;
        onboarding.observe_command(&Command::SetCamera(camera));
        onboarding.observe(STILL);
        assert_eq!(onboarding.step, Some(CoachStep::Move), "the user has not zoomed");
        let zoomed = Observed { zoom: Some(3.0), ..STILL };
        onboarding.observe(zoomed);
        assert_eq!(onboarding.step, Some(CoachStep::Pick));
        onboarding.observe_command(&Command::Pick(None));
        onboarding.observe_command(&Command::Pick(Some((1, 2))));
        assert_eq!(onboarding.step, Some(CoachStep::Stage));
        onboarding.observe(Observed { shows_stage: true, ..zoomed });
        assert_eq!(onboarding.step, Some(CoachStep::Compare));
        onboarding.observe(Observed { compares: true, ..zoomed });
        assert_eq!((onboarding.step, onboarding.seen.coach), (None, true));
    }

    #[test]
    fn the_card_comes_first_and_both_stay_closed() {
        let mut onboarding = Onboarding::default();
        onboarding.begin();
        assert!(onboarding.card_open && onboarding.step.is_none());
        assert!(onboarding.escape());
        assert_eq!((onboarding.card_open, onboarding.step), (false, Some(CoachStep::Move)));
        assert!(onboarding.escape() && !onboarding.escape());
        let mut next = Onboarding { seen: onboarding.seen, ..Onboarding::default() };
        next.begin();
        assert!(!next.card_open && next.step.is_none());
        next.apply(OnboardingChange::OpenCard);
        next.apply(OnboardingChange::CloseCard);
        assert_eq!(next.step, None, "the coach was closed before");
    }
}
