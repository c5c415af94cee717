//! Steps forwards and backwards through the drawing of a frame.

use super::{LastTriangle, Moment, Touch};
use crate::pipeline::Geometry;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Size of one step when a frame's drawing is played back.
    pub Unit {
        Stage = "stage", "Stage", "Step to the next stage of the pipeline, with the same triangles drawn.";
        Draw = "draw", "Draw", "Step to the next object.";
        Triangle = "triangle", "Triangle", "Step to the next triangle.";
        Fragment = "fragment", "Fragment", "Step to the next fragment, in rasterization order.";
    }
}

/// Data for stepping through the drawing of a frame: its draws, the fragments at the picked pixel, and the numbers of
/// triangles and fragments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// Number of rasterized triangles in the frame.
    pub triangles: usize,
    /// First triangle and instance of each draw, both as indices, in drawing order.
    pub draws: Vec<(usize, u32)>,
    /// Fragment counts of the last drawn triangle, partial or complete, and of the next triangle.
    pub fragments: [usize; 2],
    /// Triangle that was drawn last, partial or complete; `None` before the first triangle and for a complete frame.
    pub last: Option<LastTriangle>,
    /// Fragments at the picked pixel, in drawing order.
    pub touches: Vec<Touch>,
}

impl Timeline {
    /// Creates the timeline of a frame from its complete geometry. Sets the fragment counts to 0 and leaves the list of
    /// fragments at the picked pixel empty.
    pub fn new(geometry: &Geometry) -> Self {
        let mut draws: Vec<(usize, u32)> = Vec::new();
        for (place, triangle) in geometry.triangles.iter().enumerate() {
            if draws.last().is_none_or(|(_, instance)| *instance != triangle.instance) {
                draws.push((place, triangle.instance));
            }
        }
        Self { triangles: geometry.triangles.len(), draws, ..Self::default() }
    }

    /// Returns the playback position one step after or before `now`. With `touching`, steps by triangle or fragment
    /// stop only at positions that touch the picked pixel. [`Unit::Stage`] does not change the position.
    pub(crate) fn step(&self, now: Moment, unit: Unit, forwards: bool, touching: bool) -> Moment {
        let now = if now.triangles > self.triangles { Moment::after(self.triangles) } else { now };
        match unit {
            Unit::Stage => now,
            Unit::Draw => self.by_draw(now, forwards),
            Unit::Triangle | Unit::Fragment if touching => self.by_touch(now, unit, forwards),
            Unit::Triangle if forwards && now.fragments.is_some() => Moment::after(now.triangles),
            Unit::Triangle if forwards => Moment::after((now.triangles + 1).min(self.triangles)),
            Unit::Triangle => Moment::after(now.triangles.saturating_sub(1)),
            Unit::Fragment if forwards => self.next_fragment(now),
            Unit::Fragment => self.fragment_before(now),
        }
    }

    /// Returns the playback position `steps` steps after `now`; a negative number steps backwards. Stops early at
    /// either end of the frame, or where the number of fragments is unknown.
    pub fn steps(&self, now: Moment, unit: Unit, steps: i64, touching: bool) -> Moment {
        let forwards = steps > 0;
        if unit == Unit::Triangle && !touching && now.fragments.is_none() {
            let wanted = now.triangles as i64 + steps;
            return Moment::after(wanted.clamp(0, self.triangles as i64) as usize);
        }
        let mut moment = now;
        for _ in 0..steps.unsigned_abs() {
            let next = self.step(moment, unit, forwards, touching);
            if next == moment || (unit == Unit::Fragment && !touching && next.triangles != now.triangles) {
                return next;
            }
            moment = next;
        }
        moment
    }

    fn by_draw(&self, now: Moment, forwards: bool) -> Moment {
        // A partially drawn triangle counts as not yet drawn.
        let whole = now.triangles - usize::from(now.fragments.is_some());
        let starts = || self.draws.iter().map(|(start, _)| *start);
        Moment::after(if forwards {
            starts().find(|start| *start > whole).unwrap_or(self.triangles)
        } else {
            let before = now.triangles - usize::from(now.fragments.is_none() && now.triangles > 0);
            starts().take_while(|start| *start <= before).filter(|start| *start < now.triangles).last().unwrap_or(0)
        })
    }

    fn by_touch(&self, now: Moment, unit: Unit, forwards: bool) -> Moment {
        let moment = |touch: &Touch| match unit {
            Unit::Fragment => touch.moment,
            _ => Moment::after(touch.moment.triangles),
        };
        let mut moments = self.touches.iter().map(moment);
        if forwards {
            moments.find(|moment| moment.key() > now.key()).unwrap_or(Moment::after(self.triangles))
        } else {
            moments.take_while(|moment| moment.key() < now.key()).last().unwrap_or(Moment::after(0))
        }
    }

    fn next_fragment(&self, Moment { triangles, fragments }: Moment) -> Moment {
        let [own, next] = self.fragments;
        match fragments {
            Some(drawn) if drawn + 1 < own => Moment { triangles, fragments: Some(drawn + 1) },
            Some(_) => Moment::after(triangles),
            None if triangles >= self.triangles => Moment::after(self.triangles),
            None => Moment { triangles: triangles + 1, fragments: (next > 1).then_some(1) },
        }
    }

    fn fragment_before(&self, Moment { triangles, fragments }: Moment) -> Moment {
        match fragments.unwrap_or(self.fragments[0]) {
            _ if triangles == 0 => Moment::after(0),
            0 | 1 => Moment::after(triangles.saturating_sub(1)),
            drawn => Moment { triangles, fragments: Some(drawn - 1) },
        }
    }
}
