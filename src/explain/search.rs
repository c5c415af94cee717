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
use crate::buffers::{BufferTarget, OurBuffers};
use crate::candidate::Candidate;
use crate::fault::Slot;
use crate::query::Evidence;
use crate::setup::Setup;
use crate::window::Window;

/// Greatest number of faults in an explanation.
const MOST_FAULTS: usize = 5;

/// Number of sets extended per step, by likelihood and by coarse difference, while most of the picture is unexplained.
const BEAM: [usize; 2] = [5, 4];

/// The same once a set explains nearly all of the picture.
const NARROW_BEAM: [usize; 2] = [2, 0];

/// Share of differing pixels below which nearly all of the picture is explained.
const NEARLY_ALL: f64 = 0.005;

/// Cost of one more fault, in nats: about that of twelve pixels that disagree.
pub(crate) const COST_OF_FAULT: f64 = 100.0;

/// Set of faults: indices of candidates, in ascending order.
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

/// Search state: the correct setup, windows of the picture to explain, and all drawings made so far.
pub(crate) struct Search<'a> {
    correct: &'a Setup,
    candidates: &'a [Candidate],
    targets: Vec<Target>,
    buffers: BufferTarget,
    progress: &'a Progress<'a>,
    trials: HashMap<FaultSet, Trial>,
}

/// Interruption of a search by the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Interrupted;

/// Progress of one or several searches, and the way to interrupt them.
pub(crate) struct Progress<'a> {
    /// Function that gets the progress in [0, 1], and returns whether to continue.
    go_on: &'a (dyn Fn(f32) -> bool + Sync),
    /// Number of drawings made, and expected in total.
    drawn: AtomicUsize,
    expected: usize,
    interrupted: AtomicBool,
}

impl<'a> Progress<'a> {
    /// Starts the progress of searches among a number of candidates.
    pub(crate) fn new(go_on: &'a (dyn Fn(f32) -> bool + Sync), candidates: usize) -> Self {
        let expected = 1 + candidates * (1 + BEAM[0] + BEAM[1] + 2 * NARROW_BEAM[0]);
        Self { go_on, expected, drawn: AtomicUsize::new(0), interrupted: AtomicBool::new(false) }
    }

    /// Counts a drawing. Returns an error if the user interrupts.
    pub(crate) fn step(&self) -> Result<(), Interrupted> {
        let done = self.drawn.fetch_add(1, Ordering::Relaxed);
        if self.interrupted.load(Ordering::Relaxed) || !(self.go_on)((done as f32 / self.expected as f32).min(1.0)) {
            self.interrupted.store(true, Ordering::Relaxed);
            return Err(Interrupted);
        }
        Ok(())
    }

    /// Returns the number of drawings made.
    pub(crate) fn drawings(&self) -> usize {
        self.drawn.load(Ordering::Relaxed)
    }
}

impl<'a> Search<'a> {
    /// Prepares a search that compares some windows of the picture.
    pub(crate) fn new(
        evidence: &Evidence<'a>,
        candidates: &'a [Candidate],
        windows: &[Window],
        progress: &'a Progress<'a>,
    ) -> Self {
        let Evidence { query, buffers } = *evidence;
        let targets = windows.iter().map(|window| Target::new(&query.theirs, *window)).collect();
        let buffers = buffers.target(windows);
        Self { correct: &query.correct, candidates, targets, buffers, progress, trials: HashMap::new() }
    }

    /// Returns the setup with a set of candidates.
    pub(crate) fn setup(&self, faults: &[usize]) -> Setup {
        self.correct.changed(faults.iter().map(|index| self.candidates[*index].change))
    }

    /// Draws every set that was not drawn before.
    pub(crate) fn draw_all(&mut self, sets: Vec<FaultSet>) -> Result<(), Interrupted> {
        let mut new: Vec<_> = sets.into_iter().filter(|set| !self.trials.contains_key(set)).collect();
        new.sort_unstable();
        new.dedup();
        let drawn: Vec<_> = new
            .into_par_iter()
            .map_init(Renderer::default, |renderer, faults| self.progress.step().map(|()| self.trial(renderer, faults)))
            .collect();
        for trial in drawn {
            let trial = trial?;
            self.trials.insert(trial.faults.clone(), trial);
        }
        Ok(())
    }

    fn trial(&self, renderer: &mut Renderer, faults: FaultSet) -> Trial {
        let setup = self.setup(&faults);
        let mut hasher = DefaultHasher::new();
        setup.rounding.hash(&mut hasher);
        let (mut agreement, mut ours) = (Agreement::default(), OurBuffers::default());
        for target in &self.targets {
            let picture = setup.draw_window(renderer, target.window);
            picture.as_bytes().hash(&mut hasher);
            agreement = agreement + target.agreement(&picture, setup.rounding);
            ours.append(setup.draw_buffers(renderer, target.window, &self.buffers));
        }
        agreement.cost += self.buffers.differences(&ours).cost();
        Trial { faults, agreement, hash: hasher.finish() }
    }

    /// Returns the trial of a set that was drawn before.
    pub(crate) fn get(&self, faults: &[usize]) -> Option<&Trial> {
        self.trials.get(faults)
    }

    /// Returns the best set of faults, after extending the empty set and `start` as long as that improves the
    /// agreement.
    pub(crate) fn run(&mut self, start: &[usize]) -> Result<Trial, Interrupted> {
        let mut sets = vec![FaultSet::new(), start.to_vec()];
        self.draw_all(sets.clone())?;
        sets.dedup();
        let best = sets.iter().map(|set| &self.trials[set]).min_by(|a, b| a.total().total_cmp(&b.total()));
        let mut best = best.expect("there is at least the empty set").clone();
        for size in 1..=MOST_FAULTS {
            let is_best = |set: &FaultSet| *set == best.faults;
            let mut extended: Vec<_> = sets.iter().flat_map(|set| self.extensions(set, is_best(set))).collect();
            if size == 2 {
                extended.extend(self.hidden_pairs());
            }
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

    /// Returns the set with each compatible further candidate. Only the best set gets those that are slow, or that look
    /// on their own like another candidate or like no change at all.
    fn extensions(&self, set: &[usize], is_best: bool) -> Vec<FaultSet> {
        let is_worthwhile =
            |index: usize| is_best || !self.candidates[index].fault.is_slow() && self.looks_like_no_other(index);
        let is_compatible = |index: usize| {
            let further = &self.candidates[index];
            set.iter().all(|index| self.candidates[*index].is_compatible(further))
        };
        let further = (0..self.candidates.len()).filter(|index| is_compatible(*index) && is_worthwhile(*index));
        further.map(|index| extended(set, index)).collect()
    }

    /// Returns the pairs of faults of culling and of the depth test that change nothing one by one: each may hide the
    /// other, as in a scene of closed, convex bodies.
    fn hidden_pairs(&self) -> Vec<FaultSet> {
        let drawn = |set: &[usize]| self.trials.get(set).map(|trial| trial.hash);
        let hidden = |slot: Slot| {
            let of_slot = move |index: &usize| self.candidates[*index].fault.slot == slot;
            let is_hidden = move |index: &usize| drawn(&[*index]) == drawn(&[]);
            (0..self.candidates.len()).filter(of_slot).filter(is_hidden)
        };
        hidden(Slot::Culling)
            .flat_map(|culling| hidden(Slot::DepthTest).map(move |test| extended(&[culling], test)))
            .collect()
    }

    /// Returns whether the drawing with one candidate differs from those with each previous one, and from that without
    /// any; `true` if it was not drawn yet.
    fn looks_like_no_other(&self, index: usize) -> bool {
        let hash = |set: &[usize]| self.trials.get(set).map(|trial| trial.hash);
        let drawn = hash(&[index]);
        drawn.is_none() || drawn != hash(&[]) && (0..index).all(|previous| drawn != hash(&[previous]))
    }

    /// Returns the sets to extend: the best by likelihood, and the best by coarse difference. Of several sets with the
    /// same picture, only one.
    fn beam(&self, by_total: &[&Trial], best: &Trial) -> Vec<FaultSet> {
        let pixels = self.targets.iter().map(Target::pixels).sum::<usize>() as f64;
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
