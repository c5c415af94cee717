//! Verification: drawings of whole pictures with the sets of faults that a search found on windows of them.

use rasterscope_engine::chain::Renderer;
use rasterscope_engine::image::Image;

use crate::agreement::{Agreement, TOLERANCE, Target, differences};
use crate::buffers::{BufferDifferences, BufferTarget};
use crate::candidate::Candidate;
use crate::cause::{Cause, Tally, is_convincing};
use crate::fault::{Fault, Slot};
use crate::query::{Evidence, Query};
use crate::search::{COST_OF_FAULT, FaultSet, Interrupted, Progress, Search, extended, reduced};
use crate::setup::Setup;
use crate::window::Window;

/// Drawings of the whole picture of a query.
pub(crate) struct Verification<'a> {
    query: &'a Query,
    buffers: BufferTarget,
    candidates: &'a [Candidate],
    target: Target,
    progress: &'a Progress<'a>,
}

/// Drawing of the whole picture with a set of faults.
pub(crate) struct Drawn {
    /// The set.
    pub(crate) faults: FaultSet,
    /// Setup with the set.
    pub(crate) setup: Setup,
    /// Agreement of the whole picture.
    pub(crate) agreement: Agreement,
    /// Difference of each pixel, in codes.
    pub(crate) differences: Image<u8>,
    /// Differences of the further pictures.
    pub(crate) buffers: BufferDifferences,
}

impl Drawn {
    /// Returns the cost of the picture and of the faults, in nats.
    pub(crate) fn total(&self) -> f64 {
        self.agreement.cost + COST_OF_FAULT * self.faults.len() as f64
    }
}

impl<'a> Verification<'a> {
    /// Prepares the verification of sets of candidates.
    pub(crate) fn new(evidence: &Evidence<'a>, candidates: &'a [Candidate], progress: &'a Progress<'a>) -> Self {
        let Evidence { query, buffers } = *evidence;
        let whole = Window::whole(query.correct.viewport);
        let (target, buffers) = (Target::new(&query.theirs, whole), buffers.target(&[whole]));
        Self { query, buffers, candidates, target, progress }
    }

    /// Draws the whole picture with a set of faults.
    pub(crate) fn draw(&self, faults: FaultSet) -> Result<Drawn, Interrupted> {
        self.progress.step()?;
        let setup = self.query.correct.changed(faults.iter().map(|index| self.candidates[*index].change));
        let mut renderer = Renderer::default();
        let picture = setup.draw(&mut renderer);
        let ours = setup.draw_buffers(&mut renderer, self.target.window, &self.buffers);
        let buffers = self.buffers.differences(&ours);
        let mut agreement = self.target.agreement(&picture, setup.rounding);
        agreement.cost += buffers.cost();
        Ok(Drawn {
            agreement,
            buffers,
            differences: differences(&self.query.theirs, &picture, setup.rounding),
            faults,
            setup,
        })
    }

    /// Removes faults from a set until each of them explains enough of the whole picture. Returns the drawing with the
    /// others, and what each explains, the one that explains most first.
    pub(crate) fn convincing(
        &self,
        search: &mut Search<'_>,
        mut faults: FaultSet,
    ) -> Result<(Drawn, Vec<Cause>), Interrupted> {
        loop {
            let drawn = self.draw(faults.clone())?;
            let causes: Vec<_> = faults.iter().map(|index| self.cause(&drawn, *index)).collect::<Result<_, _>>()?;
            let weak = causes.iter().position(|cause| !is_convincing(cause, &self.query.theirs));
            let Some(weak) = weak else {
                let mut named = Vec::new();
                for (index, cause) in faults.iter().zip(causes) {
                    named.push(Cause { alternatives: self.alternatives(search, &drawn, *index)?, ..cause });
                }
                named.sort_by_key(|cause| std::cmp::Reverse(cause.explained));
                return Ok((drawn, named));
            };
            faults.remove(weak);
        }
    }

    /// Returns what one fault of a set explains.
    fn cause(&self, with: &Drawn, index: usize) -> Result<Cause, Interrupted> {
        let Candidate { fault, .. } = self.candidates[index];
        // Rounding changes codes by one, which is within the tolerance.
        let most = if fault.slot == Slot::Rounding { 0 } else { TOLERANCE };
        let without = self.draw(reduced(&with.faults, index))?;
        let count = |is_counted: &dyn Fn(u8, u8) -> bool| {
            let pairs = with.differences.pixels().iter().zip(without.differences.pixels());
            pairs.filter(|(with, without)| is_counted(**with, **without)).count() as u64
        };
        Ok(Cause {
            fault,
            detail: self.candidates[index].background().map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}")),
            explained: count(&|with, without| with <= most && without > most),
            differing_without: count(&|_, without| without > most),
            exact: count(&|with, without| with == 0 && without > most),
            spoiled: count(&|with, without| with > TOLERANCE && without <= TOLERANCE),
            depth: Tally::of(&with.buffers.depth, &without.buffers.depth),
            ids: Tally::of(&with.buffers.ids, &without.buffers.ids),
            alternatives: Vec::new(),
        })
    }

    /// Returns the faults that give the same picture in place of one fault of a set.
    fn alternatives(
        &self,
        search: &mut Search<'_>,
        with: &Drawn,
        index: usize,
    ) -> Result<Vec<&'static Fault>, Interrupted> {
        let others = reduced(&with.faults, index);
        let replaced = &self.candidates[index];
        let is_compatible = |other: &&Candidate| {
            other.fault.id != replaced.fault.id && others.iter().all(|kept| self.candidates[*kept].is_compatible(other))
        };
        let places = (0..self.candidates.len()).filter(|place| is_compatible(&&self.candidates[*place]));
        let sets: Vec<_> = places.map(|place| (place, extended(&others, place))).collect();
        search.draw_all(sets.iter().map(|(_, set)| set.clone()).chain([with.faults.clone()]).collect())?;
        let hash = |set: &[usize]| search.get(set).map(|trial| trial.hash);
        let mut same: Vec<&'static Fault> = Vec::new();
        for (place, set) in sets.into_iter().filter(|(_, set)| hash(set) == hash(&with.faults)) {
            let fault = self.candidates[place].fault;
            // The windows of a search may not show the difference.
            let is_same = || {
                let drawn = self.draw(set)?;
                let (buffers, others) = (&drawn.buffers, &with.buffers);
                let is_same = buffers.depth == others.depth && buffers.ids == others.ids;
                Ok(is_same && drawn.differences == with.differences)
            };
            if same.iter().all(|known| known.id != fault.id) && is_same()? {
                same.push(fault);
            }
        }
        Ok(same)
    }
}
