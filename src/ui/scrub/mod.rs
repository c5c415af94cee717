//! Going through the making of a frame: by stage, object, triangle or fragment, by hand or playing, all of it or only what
//! touches the picked pixel.

pub mod reel;

pub mod transport;

use std::sync::Arc;

use super::command::Command;
use super::session::Session;
use crate::inspect::scrub::{Moment, Timeline, Unit};

/// Steps per second that can be chosen.
pub const SPEEDS: [f32; 8] = [1.0, 4.0, 15.0, 60.0, 250.0, 1_000.0, 4_000.0, 16_000.0];

/// Stages are pictures to look at: they never follow each other faster, per second.
const FASTEST_STAGES: f32 = 2.0;

/// How somebody goes through the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scrub {
    /// The moment within a triangle that was asked for last; it holds as long as no other number of triangles is asked for.
    partial: Option<Moment>,
    /// How far the buttons step, and what follows each other while playing.
    pub unit: Unit,
    /// Forwards 1, backwards −1, not at all 0.
    pub playing: i64,
    /// Steps per second while playing.
    pub speed: f32,
    /// Whether steps go only to moments that touch the picked pixel.
    pub touching: bool,
    /// Parts of a step that time has brought.
    due: f32,
}

impl Default for Scrub {
    fn default() -> Self {
        Self { partial: None, unit: Unit::Triangle, playing: 0, speed: 60.0, touching: false, due: 0.0 }
    }
}

/// What can be asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// One step of this size, forwards or backwards.
    Step(Unit, bool),
    /// One step of the chosen size.
    StepUnit(bool),
    /// To this moment.
    Go(Moment),
    /// Step so far.
    Unit(Unit),
    /// Play forwards or backwards; if that goes on already, stop.
    Play(bool),
    /// So many steps per second.
    Speed(f32),
    /// Only what touches the picked pixel, or all; the other of both if none is given.
    Touching(Option<bool>),
    /// Seconds have passed while playing.
    Tick(f32),
}

impl Scrub {
    /// Of the last of so many triangles only these fragments are drawn; all if none.
    pub fn fragment_limit(&self, triangle_limit: Option<usize>) -> Option<usize> {
        self.partial.filter(|moment| Some(moment.triangles) == triangle_limit)?.fragments
    }
}

impl Session {
    /// The moment that is asked for.
    pub fn moment(&self) -> Moment {
        let triangles = self.triangle_limit.unwrap_or(self.triangle_count());
        Moment { triangles, fragments: self.scrub.fragment_limit(self.triangle_limit) }
    }

    /// Goes to a moment; all triangles are no limit.
    pub fn go_to(&mut self, moment: Moment) {
        let Moment { triangles, fragments } = moment;
        let is_all = triangles > self.triangle_count() || (triangles == self.triangle_count() && fragments.is_none());
        self.triangle_limit = (!is_all).then_some(triangles);
        self.scrub.partial = Some(moment).filter(|_| triangles > 0 && fragments.is_some());
    }

    /// Asks for a moment before there is a frame that would tell whether it has one like that.
    pub fn begin_at(&mut self, moment: Moment) {
        (self.triangle_limit, self.scrub.partial) = (Some(moment.triangles), Some(moment));
    }

    /// What is known of the moments around the one on screen, if a frame is there.
    pub fn timeline(&self) -> Option<Arc<Timeline>> {
        let view = self.view.as_ref()?;
        let whole = || Arc::new(reel::timeline_of(&view.request, &view.frame, None));
        Some(view.timeline.clone().unwrap_or_else(whole))
    }

    /// Applies a change; returns what else is to be done.
    pub(super) fn scrub(&mut self, change: Change) -> Option<Command> {
        match change {
            Change::Step(unit, forwards) => return self.step(unit, if forwards { 1 } else { -1 }),
            Change::StepUnit(forwards) => return self.step(self.scrub.unit, if forwards { 1 } else { -1 }),
            Change::Go(moment) => {
                self.scrub.playing = 0;
                self.go_to(moment);
            }
            Change::Unit(unit) => self.scrub.unit = unit,
            Change::Play(forwards) => self.play(if forwards { 1 } else { -1 }),
            Change::Speed(speed) => self.scrub.speed = speed,
            Change::Touching(touching) => self.scrub.touching = touching.unwrap_or(!self.scrub.touching),
            Change::Tick(seconds) => return self.tick(seconds),
        }
        None
    }

    fn step(&mut self, unit: Unit, steps: i64) -> Option<Command> {
        if unit == Unit::Stage {
            return Some(Command::StepStage(steps));
        }
        let touching = self.scrub.touching && self.pick.is_some();
        let next = self.timeline()?.steps(self.moment(), unit, steps, touching);
        self.go_to(next);
        None
    }

    fn play(&mut self, direction: i64) {
        let same = self.scrub.playing == direction;
        (self.scrub.playing, self.scrub.due) = (if same { 0 } else { direction }, 0.0);
        let ends_at = if direction > 0 { self.triangle_count() } else { 0 };
        // From where it ends it begins anew.
        if !same && self.scrub.unit != Unit::Stage && self.moment() == Moment::after(ends_at) {
            self.go_to(Moment::after(self.triangle_count() - ends_at));
        }
    }

    /// Steps as far as time has come, once the moment that was asked for is on screen.
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
        if let Some(Command::StepStage(step)) = self.step(unit, playing * steps as i64) {
            self.apply(Command::StepStage(step));
        }
        if self.moment() == before && self.shown == shown {
            self.scrub.playing = 0;
        }
        None
    }
}

#[cfg(test)]
mod tests;
