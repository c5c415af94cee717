//! Which of several ways are beaten by another one in time and in error.

/// For each of some ways, given as (time, error), the place of one that is at least as good in both and better in one;
/// of several the one with the least error. `None` if nobody beats it.
pub fn dominated_by(points: &[(f64, f64)]) -> Vec<Option<usize>> {
    let beats = |(time, error): (f64, f64), (other_time, other_error): (f64, f64)| {
        time <= other_time && error <= other_error && (time < other_time || error < other_error)
    };
    let beaten = |point: &(f64, f64)| {
        let better = (0..points.len()).filter(|other| beats(points[*other], *point));
        better.min_by(|a, b| points[*a].1.total_cmp(&points[*b].1))
    };
    points.iter().map(beaten).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_staircase_stays_and_what_lies_above_it_goes() {
        let points = [(1.0, 9.0), (2.0, 4.0), (3.0, 5.0), (4.0, 1.0), (2.0, 4.0), (5.0, 4.5)];
        assert_eq!(dominated_by(&points), [None, None, Some(1), None, None, Some(3)]);
        assert_eq!(dominated_by(&[]), []);
    }
}
