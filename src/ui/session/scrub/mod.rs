//! Playback of how the frame was drawn: by stage, object, triangle or fragment, step by step or continuously. It can be
//! limited to triangles and fragments at the picked pixel.

use std::sync::Arc;

use super::Session;
use crate::inspect::scrub::{Moment, Timeline, Unit};
use crate::ui::engine::reel::timeline_of;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

/// Selectable playback speeds, in steps per second.
pub(crate) const SPEEDS: [f32; 8] = [1.0, 4.0, 15.0, 60.0, 250.0, 1_000.0, 4_000.0, 16_000.0];

/// Maximum speed of playback by stage, in stages per second, so that each picture can be inspected.
const FASTEST_STAGES: f32 = 2.0;

/// State of the playback of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scrub {
    /// Maximum number of triangles to draw; `None` draws all.
    pub(crate) triangle_limit: Option<usize>,
    /// Last requested moment at which a triangle is only partially drawn. It is ignored once the triangle limit
    /// changes.
    partial: Option<Moment>,
    /// Unit of a step, for the buttons and for playback.
    pub(crate) unit: Unit,
    /// Playback direction: 1 forwards, −1 backwards, 0 paused.
    pub(crate) playing: i64,
    /// Playback speed, in steps per second.
    pub(crate) speed: f32,
    /// Whether steps skip triangles and fragments that do not touch the picked pixel.
    pub(crate) only_touches: bool,
    /// Fraction of the current playback step that has elapsed, in [0, 1).
    due: f32,
}

impl Default for Scrub {
    fn default() -> Self {
        Self {
            triangle_limit: None,
            partial: None,
            unit: Unit::Triangle,
            playing: 0,
            speed: 60.0,
            only_touches: false,
            due: 0.0,
        }
    }
}

/// Change to the playback of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ScrubChange {
    /// Steps by this unit, forwards if `true`, otherwise backwards.
    Step(Unit, bool),
    /// Steps by the selected unit, forwards if `true`, otherwise backwards.
    StepUnit(bool),
    /// Pauses playback and goes to a moment in the drawing of the frame.
    Go(Moment),
    /// Sets the unit of a step.
    Unit(Unit),
    /// Plays forwards if `true`, otherwise backwards. Pauses if it already plays in that direction.
    Play(bool),
    /// Sets the playback speed, in steps per second.
    Speed(f32),
    /// Sets whether steps skip triangles and fragments that do not touch the picked pixel; `None` toggles it.
    Touching(Option<bool>),
    /// Advances playback by this many seconds.
    Tick(f32),
}

impl Scrub {
    /// Returns the number of fragments to draw of the last triangle; `None` if it is drawn completely.
    pub(crate) fn fragment_limit(&self) -> Option<usize> {
        self.partial.filter(|moment| Some(moment.triangles) == self.triangle_limit)?.fragments
    }
}

impl Session {
    /// Returns the requested moment in the drawing of the frame.
    pub(crate) fn moment(&self) -> Moment {
        let all = self.triangle_count();
        let triangles = self.features.scrub.triangle_limit.map_or(all, |limit| limit.min(all));
        Moment { triangles, fragments: self.features.scrub.fragment_limit() }
    }

    /// Goes to a moment in the drawing of the frame. Removes the triangle limit if the moment is the end of the frame.
    pub(crate) fn go_to(&mut self, moment: Moment) {
        let Moment { triangles, fragments } = moment;
        let is_all = triangles > self.triangle_count() || (triangles == self.triangle_count() && fragments.is_none());
        self.features.scrub.triangle_limit = (!is_all).then_some(triangles);
        self.features.scrub.partial = Some(moment).filter(|_| triangles > 0 && fragments.is_some());
    }

    /// Requests a moment in the drawing of the frame without checking that it exists, for use before the first frame.
    pub(crate) fn begin_at(&mut self, moment: Moment) {
        (self.features.scrub.triangle_limit, self.features.scrub.partial) = (Some(moment.triangles), Some(moment));
    }

    /// Returns the timeline of the frame on screen, for stepping from the current moment; `None` before the first
    /// frame.
    pub(crate) fn timeline(&self) -> Option<Arc<Timeline>> {
        let view = self.view.as_ref()?;
        let whole = || Arc::new(timeline_of(&view.request, &view.frame, None));
        Some(view.timeline.clone().unwrap_or_else(whole))
    }

    /// Draws only this many triangles; all if `None`. Pauses playback.
    pub(crate) fn limit_triangles(&mut self, limit: Option<usize>) {
        self.scrub(ScrubChange::Go(Moment::after(limit.unwrap_or(self.triangle_count()))));
    }

    /// Applies a change to the playback.
    pub(super) fn scrub(&mut self, change: ScrubChange) {
        let scrub = &mut self.features.scrub;
        match change {
            ScrubChange::Step(unit, forwards) => self.step(unit, if forwards { 1 } else { -1 }),
            ScrubChange::StepUnit(forwards) => {
                let unit = scrub.unit;
                self.step(unit, if forwards { 1 } else { -1 });
            }
            ScrubChange::Go(moment) => {
                scrub.playing = 0;
                self.go_to(moment);
            }
            ScrubChange::Unit(unit) => scrub.unit = unit,
            ScrubChange::Play(forwards) => self.play(if forwards { 1 } else { -1 }),
            ScrubChange::Speed(speed) => scrub.speed = speed,
            ScrubChange::Touching(touching) => scrub.only_touches = touching.unwrap_or(!scrub.only_touches),
            ScrubChange::Tick(seconds) => self.tick(seconds),
        }
    }

    fn step(&mut self, unit: Unit, steps: i64) {
        if unit == Unit::Stage {
            self.show(self.stage_beside_shown(steps));
            return;
        }
        let touching = self.features.scrub.only_touches && self.pick.is_some();
        if let Some(timeline) = self.timeline() {
            self.go_to(timeline.steps(self.moment(), unit, steps, touching));
        }
    }

    fn play(&mut self, direction: i64) {
        let same = self.features.scrub.playing == direction;
        (self.features.scrub.playing, self.features.scrub.due) = (if same { 0 } else { direction }, 0.0);
        let ends_at = if direction > 0 { self.triangle_count() } else { 0 };
        // Playing from the end restarts from the beginning.
        if !same && self.features.scrub.unit != Unit::Stage && self.moment() == Moment::after(ends_at) {
            self.go_to(Moment::after(self.triangle_count() - ends_at));
        }
    }

    /// Advances playback by `seconds`. Playback waits while the requested moment is not on screen yet.
    fn tick(&mut self, seconds: f32) {
        let is_shown = self.view.as_ref().is_some_and(|view| view.request.moment() == self.request().moment());
        let scrub = &mut self.features.scrub;
        if scrub.playing == 0 || !is_shown {
            return;
        }
        let Scrub { unit, speed, playing, .. } = *scrub;
        scrub.due += seconds * if unit == Unit::Stage { speed.min(FASTEST_STAGES) } else { speed };
        let steps = scrub.due.floor();
        if steps < 1.0 {
            return;
        }
        scrub.due -= steps;
        let (before, shown) = (self.moment(), self.shown);
        self.step(unit, playing * steps as i64);
        if self.moment() == before && self.shown == shown {
            self.features.scrub.playing = 0;
        }
    }
}

impl Feature for Scrub {
    type Change = ScrubChange;

    fn apply(session: &mut Session, change: ScrubChange) -> Option<WindowTask> {
        session.scrub(change);
        None
    }

    fn leave_scene(&mut self) {
        (self.triangle_limit, self.playing) = (None, 0);
    }
}

#[cfg(test)]
mod tests;
