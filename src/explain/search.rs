//! Search for the combination of faults whose drawing agrees best with a picture.
//!
//! A beam search: the view is drawn with every single fault; then the best sets are extended by every further fault,
//! until no extension improves the agreement. Best are both those with the greatest likelihood, pixel by pixel, and
//! those whose coarse picture comes closest: of two faults that both change every pixel, one alone makes no pixel
//! agree, but brings the picture closer.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rasterscope_engine::chain::Renderer;
use rayon::prelude::*;

use crate::agreement::{Agreement, Target};
use crate::explanation::Query;
use crate::fault::Fault;
use crate::faults::ALL;
use crate::setup::Setup;

/// Greatest number of faults in an explanation.
const MOST_FAULTS: usize = 4;

/// Number of sets extended per step, by likelihood and by coarse difference, while most of the picture is unexplained.
const BEAM: [usize; 2] = [5, 4];

/// The same once a set explains nearly all of the picture.
const NARROW_BEAM: [usize; 2] = [2, 0];

/// Share of differing pixels below which nearly all of the picture is explained.
const NEARLY_ALL: f64 = 0.005;

/// Cost of one more fault, in nats: about that of twelve pixels that disagree.
pub(crate) const COST_OF_FAULT: f64 = 100.0;

/// Set of faults: indices in the registry, in ascending order.
pub(crate) type FaultSet = Vec<usize>;

/// Result of drawing one set of faults.
#[derive(Clone, Debug)]
pub(crate) struct Trial {
    pub(crate) faults: FaultSet,
    pub(crate) agreement: Agreement,
    /// Hash of the drawing.
    pub(crate) hash: u64,
}

impl Trial {
    /// Returns the cost of the picture and of the faults, in nats.
    pub(crate) fn total(&self) -> f64 {
        self.agreement.cost + COST_OF_FAULT * self.faults.len() as f64
    }
}

/// Search state: the correct setup, the picture to explain, and all drawings made so far.
pub(crate) struct Search<'a> {
    correct: &'a Setup,
    /// Indices of the faults that are considered.
    known: Vec<usize>,
    target: Target,
    go_on: &'a (dyn Fn(f32) -> bool + Sync),
    trials: HashMap<FaultSet, Trial>,
    /// Number of drawings made, and expected in total.
    drawn: AtomicUsize,
    expected: usize,
}

/// Interruption of a search by the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Interrupted;

impl<'a> Search<'a> {
    /// Prepares a search. `go_on` is called with the progress in [0, 1] and returns whether to continue.
    pub(crate) fn new(query: &'a Query, go_on: &'a (dyn Fn(f32) -> bool + Sync)) -> Self {
        let is_known = |index: &usize| query.without.iter().all(|id| id != ALL[*index].id);
        let known: Vec<_> = (0..ALL.len()).filter(is_known).collect();
        Self {
            correct: &query.correct,
            expected: 1 + known.len() * (1 + BEAM[0] + BEAM[1] + 2 * NARROW_BEAM[0]),
            known,
            target: Target::new(query.theirs.clone()),
            go_on,
            trials: HashMap::new(),
            drawn: AtomicUsize::new(0),
        }
    }

    /// Returns the indices of the faults that are considered.
    pub(crate) fn known(&self) -> &[usize] {
        &self.known
    }

    /// Returns the picture to explain.
    pub(crate) fn target(&self) -> &Target {
        &self.target
    }

    /// Returns the setup with a set of faults.
    pub(crate) fn setup(&self, faults: &[usize]) -> Setup {
        self.correct.with(faults.iter().map(|index| &ALL[*index]))
    }

    /// Draws every set that was not drawn before.
    pub(crate) fn draw_all(&mut self, sets: Vec<FaultSet>) -> Result<(), Interrupted> {
        let mut new: Vec<_> = sets.into_iter().filter(|set| !self.trials.contains_key(set)).collect();
        new.sort_unstable();
        new.dedup();
        let stopped = AtomicBool::new(false);
        let drawn: Vec<_> = new
            .into_par_iter()
            .map_init(Renderer::default, |renderer, faults| {
                let done = self.drawn.fetch_add(1, Ordering::Relaxed);
                if stopped.load(Ordering::Relaxed) || !(self.go_on)((done as f32 / self.expected as f32).min(1.0)) {
                    stopped.store(true, Ordering::Relaxed);
                    return None;
                }
                Some(self.trial(renderer, faults))
            })
            .collect();
        for trial in drawn {
            let trial = trial.ok_or(Interrupted)?;
            self.trials.insert(trial.faults.clone(), trial);
        }
        Ok(())
    }

    fn trial(&self, renderer: &mut Renderer, faults: FaultSet) -> Trial {
        let setup = self.setup(&faults);
        let picture = setup.draw(renderer);
        let mut hasher = DefaultHasher::new();
        picture.as_bytes().hash(&mut hasher);
        setup.rounding.hash(&mut hasher);
        Trial { faults, agreement: self.target.agreement(&picture, setup.rounding), hash: hasher.finish() }
    }

    /// Returns the number of drawings made.
    pub(crate) fn drawings(&self) -> usize {
        self.trials.len()
    }

    /// Returns the trial of a set that was drawn before.
    pub(crate) fn get(&self, faults: &[usize]) -> Option<&Trial> {
        self.trials.get(faults)
    }

    /// Returns the best set of faults, after extending sets as long as that improves the agreement.
    pub(crate) fn run(&mut self) -> Result<Trial, Interrupted> {
        self.draw_all(vec![FaultSet::new()])?;
        let mut sets = vec![FaultSet::new()];
        let mut best = self.trials[&FaultSet::new()].clone();
        for size in 1..=MOST_FAULTS {
            let is_best = |set: &FaultSet| *set == best.faults;
            let extended: Vec<_> = sets.iter().flat_map(|set| self.extensions(set, is_best(set))).collect();
            self.draw_all(extended.clone())?;
            let mut trials: Vec<&Trial> = extended.iter().map(|set| &self.trials[set]).collect();
            trials.sort_by(|a, b| a.faults.cmp(&b.faults));
            trials.dedup_by(|a, b| a.faults == b.faults);
            trials.sort_by(|a, b| a.total().total_cmp(&b.total()));
            let improves = trials.first().is_some_and(|first| first.total() < best.total());
            if improves {
                best = trials[0].clone();
            }
            // Two faults may agree only together.
            if !improves && size > 2 {
                break;
            }
            sets = self.beam(&trials, &best);
        }
        Ok(best)
    }

    /// Returns the set with each compatible further fault, including the slow ones only if `with_slow`.
    fn extensions(&self, set: &[usize], with_slow: bool) -> Vec<FaultSet> {
        let is_compatible = |further: &Fault| {
            (with_slow || !further.is_slow()) && set.iter().all(|index| ALL[*index].slot != further.slot)
        };
        let further = self.known.iter().filter(|index| is_compatible(&ALL[**index]));
        further.map(|index| extended(set, *index)).collect()
    }

    /// Returns the sets to extend: the best by likelihood, and the best by coarse difference. Of several sets with the
    /// same picture, only one.
    fn beam(&self, by_total: &[&Trial], best: &Trial) -> Vec<FaultSet> {
        let pixels = self.target.picture.pixels().len() as f64;
        let is_nearly_done = (best.agreement.differing as f64) < NEARLY_ALL * pixels;
        let [by_likelihood, by_shape] = if is_nearly_done { NARROW_BEAM } else { BEAM };
        let mut by_coarse = by_total.to_vec();
        by_coarse.sort_by(|a, b| a.agreement.coarse.total_cmp(&b.agreement.coarse));
        let mut hashes = Vec::new();
        let mut sets = Vec::new();
        for (trials, count) in [(by_total, by_likelihood), (&by_coarse, by_shape)] {
            let mut taken = 0;
            for trial in trials {
                if taken == count {
                    break;
                }
                if !hashes.contains(&trial.hash) {
                    hashes.push(trial.hash);
                    sets.push(trial.faults.clone());
                    taken += 1;
                }
            }
        }
        sets
    }
}

/// Returns the set with one more fault.
pub(crate) fn extended(set: &[usize], index: usize) -> FaultSet {
    let mut set = set.to_vec();
    set.push(index);
    set.sort_unstable();
    set
}

/// Returns the set without one fault.
pub(crate) fn reduced(set: &[usize], index: usize) -> FaultSet {
    set.iter().copied().filter(|other| *other != index).collect()
}
