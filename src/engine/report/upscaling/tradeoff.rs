//! Dominance of methods in time and error, accounting for timing noise.

use crate::measure::noise::Noise;

/// Position of a method relative to the Pareto front of time and error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing<M> {
    /// On the Pareto front. Every method with a smaller error takes longer by more than the noise, and no method with
    /// an equal error is faster.
    Front,
    /// Within noise of the Pareto front. The given method has a smaller error, or an equal error and a shorter time,
    /// but the two times differ by no more than the noise.
    WithinNoise(M),
    /// Dominated by the given method, which is at least as good in both time and error, and better in one of them. A
    /// shorter time counts as better only if the difference exceeds the noise.
    Beaten(M),
}

impl<M> Standing<M> {
    /// Replaces the identifier of the other method, if there is one, with the result of calling `name` on it.
    pub fn map<N>(self, name: impl FnOnce(M) -> N) -> Standing<N> {
        match self {
            Self::Front => Standing::Front,
            Self::WithinNoise(other) => Standing::WithinNoise(name(other)),
            Self::Beaten(other) => Standing::Beaten(name(other)),
        }
    }
}

/// Returns the standing of each method. `points` holds the time in milliseconds and the error of each method; in the
/// result, other methods are identified by their index in `points`. If several methods dominate a method, its standing
/// names the one with the smallest error.
pub fn standings(points: &[(f64, f64)], noise: &Noise) -> Vec<Standing<usize>> {
    let beats = |(time, error): (f64, f64), (other_time, other_error): (f64, f64)| {
        let is_faster = time < other_time && !noise.covers(time, other_time);
        time <= other_time && error <= other_error && (is_faster || error < other_error)
    };
    let may_beat = |(time, error): (f64, f64), (other_time, other_error): (f64, f64)| {
        let is_better = error < other_error || error == other_error && time < other_time;
        noise.covers(time, other_time) && is_better
    };
    let find = |of: usize, relation: &dyn Fn((f64, f64), (f64, f64)) -> bool| {
        let better = (0..points.len()).filter(|other| relation(points[*other], points[of]));
        better.min_by(|a, b| points[*a].1.total_cmp(&points[*b].1))
    };
    let standing = |of: usize| match (find(of, &beats), find(of, &may_beat)) {
        (Some(by), _) => Standing::Beaten(by),
        (None, Some(by)) => Standing::WithinNoise(by),
        (None, None) => Standing::Front,
    };
    (0..points.len()).map(standing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Standing::{Beaten, Front, WithinNoise};

    const QUIET: Noise = Noise { pairs: 10, p90: 0.0 };

    #[test]
    fn the_pareto_front_stays_and_what_lies_above_it_is_beaten() {
        let points = [(1.0, 9.0), (2.0, 4.0), (3.0, 5.0), (4.0, 1.0), (2.0, 4.0), (5.0, 4.5)];
        assert_eq!(standings(&points, &QUIET), [Front, Front, Beaten(1), Front, Front, Beaten(3)]);
        assert_eq!(standings(&[], &QUIET), []);
    }

    #[test]
    fn a_lead_in_time_within_noise_does_not_count() {
        let noise = Noise { pairs: 10, p90: 0.02 };
        // The first is faster by only 0.5 %, which is within noise, and the second has a smaller error.
        assert_eq!(standings(&[(1.0, 9.0), (1.005, 4.0)], &noise), [WithinNoise(1), Front]);
        assert_eq!(standings(&[(1.0, 9.0), (1.005, 4.0)], &QUIET), [Front, Front]);
        // Equal errors: a method that is 0.5 % slower is within noise, one that is 20 % slower is dominated.
        assert_eq!(standings(&[(1.0, 4.0), (1.005, 4.0), (1.2, 4.0)], &noise), [Front, WithinNoise(0), Beaten(0)]);
        assert_eq!(standings(&[(1.0, 9.0), (1.2, 4.0)], &noise), [Front, Front]);
    }
}
