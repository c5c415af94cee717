//! Playback of how the frame was drawn: by stage, object, triangle or fragment, step by step or continuously. It can be
//! limited to triangles and fragments at the picked pixel.

pub(crate) mod outline;

pub(crate) mod reel;

pub(crate) mod transport;

use std::sync::Arc;

use super::command::Command;
use super::session::Session;
use crate::inspect::scrub::{Moment, Timeline, Unit};

/// Selectable playback speeds, in steps per second.
pub(crate) const SPEEDS: [f32; 8] = [1.0, 4.0, 15.0, 60.0, 250.0, 1_000.0, 4_000.0, 16_000.0];

/// Maximum speed of playback by stage, in stages per second, so that each picture can be inspected.
const FASTEST_STAGES: f32 = 2.0;

/// State of the playback of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scrub {
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
        Self { partial: None, unit: Unit::Triangle, playing: 0, speed: 60.0, only_touches: false, due: 0.0 }
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
    /// Returns the number of fragments to draw of the last triangle, if drawing stops after `triangle_limit` triangles.
    /// Returns `None` if the last triangle is drawn completely.
    pub(crate) fn fragment_limit(&self, triangle_limit: Option<usize>) -> Option<usize> {
        self.partial.filter(|moment| Some(moment.triangles) == triangle_limit)?.fragments
    }
}

impl Session {
    /// Returns the requested moment in the drawing of the frame.
    pub(crate) fn moment(&self) -> Moment {
        let all = self.triangle_count();
        let triangles = self.triangle_limit.map_or(all, |limit| limit.min(all));
        Moment { triangles, fragments: self.scrub.fragment_limit(self.triangle_limit) }
    }

    /// Goes to a moment in the drawing of the frame. Removes the triangle limit if the moment is the end of the frame.
    pub(crate) fn go_to(&mut self, moment: Moment) {
        let Moment { triangles, fragments } = moment;
        let is_all = triangles > self.triangle_count() || (triangles == self.triangle_count() && fragments.is_none());
        self.triangle_limit = (!is_all).then_some(triangles);
        self.scrub.partial = Some(moment).filter(|_| triangles > 0 && fragments.is_some());
    }

    /// Requests a moment in the drawing of the frame without checking that it exists, for use before the first frame.
    pub(crate) fn begin_at(&mut self, moment: Moment) {
        (self.triangle_limit, self.scrub.partial) = (Some(moment.triangles), Some(moment));
    }

    /// Returns the timeline of the frame on screen, for stepping from the current moment; `None` before the first
    /// frame.
    pub(crate) fn timeline(&self) -> Option<Arc<Timeline>> {
        let view = self.view.as_ref()?;
        let whole = || Arc::new(reel::timeline_of(&view.request, &view.frame, None));
        Some(view.timeline.clone().unwrap_or_else(whole))
    }

    /// Applies a change to the playback. Returns a command if another part of the window must complete it.
    pub(super) fn scrub(&mut self, change: ScrubChange) -> Option<Command> {
        match change {
            ScrubChange::Step(unit, forwards) => return self.step(unit, if forwards { 1 } else { -1 }),
            ScrubChange::StepUnit(forwards) => return self.step(self.scrub.unit, if forwards { 1 } else { -1 }),
            ScrubChange::Go(moment) => {
                self.scrub.playing = 0;
                self.go_to(moment);
            }
            ScrubChange::Unit(unit) => self.scrub.unit = unit,
            ScrubChange::Play(forwards) => self.play(if forwards { 1 } else { -1 }),
            ScrubChange::Speed(speed) => self.scrub.speed = speed,
            ScrubChange::Touching(touching) => self.scrub.only_touches = touching.unwrap_or(!self.scrub.only_touches),
            ScrubChange::Tick(seconds) => return self.tick(seconds),
        }
        None
    }

    fn step(&mut self, unit: Unit, steps: i64) -> Option<Command> {
        if unit == Unit::Stage {
            return Some(Command::Show(self.stage_beside_shown(steps)));
        }
        let touching = self.scrub.only_touches && self.pick.is_some();
        let next = self.timeline()?.steps(self.moment(), unit, steps, touching);
        self.go_to(next);
        None
    }

    fn play(&mut self, direction: i64) {
        let same = self.scrub.playing == direction;
        (self.scrub.playing, self.scrub.due) = (if same { 0 } else { direction }, 0.0);
        let ends_at = if direction > 0 { self.triangle_count() } else { 0 };
        // Playing from the end restarts from the beginning.
        if !same && self.scrub.unit != Unit::Stage && self.moment() == Moment::after(ends_at) {
            self.go_to(Moment::after(self.triangle_count() - ends_at));
        }
    }

    /// Advances playback by `seconds`. Playback waits while the requested moment is not on screen yet.
    fn tick(&mut self, seconds: f32) -> Option<Command> {
        let is_shown = self.view.as_ref().is_some_and(|view| view.request.moment() == self.request().moment());
        if self.scrub.playing == 0 || !is_shown {
            return None;
        }
        let Scrub { unit, speed, playing, .. } = self.scrub;
        self.scrub.due += seconds * if unit == Unit::Stage { speed.min(FASTEST_STAGES) } else { speed };
        let steps = self.scrub.due.floor();
        if steps < 1.0 {
            return None;
        }
        self.scrub.due -= steps;
        let (before, shown) = (self.moment(), self.shown);
        if let Some(command) = self.step(unit, playing * steps as i64) {
            self.apply(command);
        }
        if self.moment() == before && self.shown == shown {
            self.scrub.playing = 0;
        }
        None
    }
}

#[cfg(test)]
mod tests;
