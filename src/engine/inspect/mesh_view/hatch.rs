//! Hatching: parallel lines over a convex polygon, except where another polygon covers it.

/// A point in a picture, in px.
pub(super) type ScreenPoint = [f32; 2];

/// Maximum number of hatching lines in a polygon; a polygon that needs more is not hatched.
const MAX_LINES: f32 = 600.0;

/// Returns hatching lines, rising to the right, over the part of `outer` that `inner` does not cover. The lines cross
/// each axis every `step` px. Either polygon may be degenerate.
pub(super) fn hatch(outer: &[ScreenPoint], inner: &[ScreenPoint], step: f32) -> Vec<[ScreenPoint; 2]> {
    // x + y is constant along a line.
    let along = |p: &ScreenPoint| p[0] + p[1];
    let finite = outer.iter().map(along).filter(|c| c.is_finite());
    let (low, high) = finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)));
    let extent = high - low;
    if !extent.is_finite() || extent <= 0.0 || extent / step > MAX_LINES {
        return Vec::new();
    }
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    let mut lines = Vec::new();
    for number in first..=last {
        let c = number as f32 * step;
        let Some([from, to]) = interval(outer, c).filter(|[from, to]| to > from) else { continue };
        let line = |from: f32, to: f32| [[from, c - from], [to, c - to]];
        match interval(inner, c) {
            Some([start, end]) if end > from && start < to => {
                lines.extend((start > from).then(|| line(from, start)));
                lines.extend((end < to).then(|| line(end, to)));
            }
            _ => lines.push(line(from, to)),
        }
    }
    lines
}

/// Returns the interval of x in which the line x + y = `c` lies within a convex polygon; `None` if it misses the
/// polygon.
fn interval(polygon: &[ScreenPoint], c: f32) -> Option<[f32; 2]> {
    let mut range: Option<[f32; 2]> = None;
    for (index, a) in polygon.iter().enumerate() {
        let b = polygon[(index + 1) % polygon.len()];
        let (da, db) = (a[0] + a[1] - c, b[0] + b[1] - c);
        if (da < 0.0) == (db < 0.0) {
            continue;
        }
        let t = da / (da - db);
        let x = a[0] + (b[0] - a[0]) * t;
        range = Some(range.map_or([x, x], |[low, high]| [low.min(x), high.max(x)]));
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [ScreenPoint; 4] = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];

    fn length(lines: &[[ScreenPoint; 2]]) -> f32 {
        lines.iter().map(|[a, b]| ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()).sum()
    }

    #[test]
    fn lines_fill_the_outer_polygon_less_the_inner_one() {
        // Lines at 45° that cross an axis every `step` have a total length of area · √2 / step.
        let (step, root) = (0.05, std::f32::consts::SQRT_2);
        let area = |lines: &[[ScreenPoint; 2]]| length(lines) * step / root;
        assert!((area(&hatch(&SQUARE, &[], step)) - 100.0).abs() < 1.0);
        let half = [[0.0, 0.0], [5.0, 0.0], [5.0, 10.0], [0.0, 10.0]];
        let lines = hatch(&SQUARE, &half, step);
        assert!((area(&lines) - 50.0).abs() < 1.0);
        assert!(lines.as_flattened().iter().all(|p| p[0] >= 5.0 - 1e-3));
        assert!(hatch(&SQUARE, &SQUARE, step).is_empty());
    }

    #[test]
    fn degenerate_and_excessively_large_polygons_are_not_hatched() {
        assert!(hatch(&[], &[], 1.0).is_empty());
        assert!(hatch(&[[1.0, 1.0]; 3], &[], 1.0).is_empty());
        assert!(hatch(&[[0.0, 0.0], [1e30, 0.0], [0.0, 1e30]], &[], 1.0).is_empty());
        assert!(hatch(&[[f32::NAN, 0.0]; 3], &[], 1.0).is_empty());
    }
}
