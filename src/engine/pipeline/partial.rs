//! Partial drawing of the last triangle in a list: only its first fragments are drawn, in the order in which the
//! rasterizer finds them.

use super::area::DrawnArea;
use super::raster::{SampleArea, Span};
use super::screen_triangle::ScreenTriangle;
use super::settings::Settings;

/// Returns the samples that a triangle covers, in drawing order.
pub fn samples_of(triangle: &ScreenTriangle, settings: &Settings, DrawnArea { grid, raster }: DrawnArea) -> Vec<Span> {
    let rules = settings.coverage_rules();
    let mut spans = Vec::new();
    rules.cover_within(triangle.corners_px(), SampleArea::full(grid, raster), &mut spans);
    spans
}

/// Returns the number of samples in the spans.
pub fn count(samples: &[Span]) -> usize {
    samples.iter().map(|span| (span.right - span.left) as usize).sum()
}

/// Returns the position, in drawing order, of the sample at (column, row) of the packed picture, or `None` if the spans
/// do not contain it.
pub(crate) fn index_of(samples: &[Span], (column, row): (u32, u32)) -> Option<usize> {
    let found = samples.iter().position(|span| span.row == row && (span.left..span.right).contains(&column))?;
    Some(count(&samples[..found]) + (column - samples[found].left) as usize)
}

/// Returns the first `most` samples of the spans, or all samples if the spans contain fewer.
pub(crate) fn first(samples: &[Span], most: usize) -> Vec<Span> {
    let mut left = most;
    let mut first = Vec::new();
    for span in samples {
        let length = left.min((span.right - span.left) as usize);
        if length == 0 {
            break;
        }
        first.push(Span { right: span.left + length as u32, ..*span });
        left -= length;
    }
    first
}

/// Appends to `out` those samples that lie within an area. Returns the number of samples appended.
pub(super) fn within(samples: &[Span], SampleArea { grid, scissor }: SampleArea, out: &mut Vec<Span>) -> u64 {
    let rows = grid.rows(scissor.top, scissor.bottom);
    let before = out.len();
    for span in samples.iter().filter(|span| rows.contains(&span.row)) {
        let columns = grid.columns(span.row, scissor.left, scissor.right);
        let (left, right) = (span.left.max(columns.start), span.right.min(columns.end));
        if left < right {
            out.push(Span { left, right, ..*span });
        }
    }
    count(&out[before..]) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: [Span; 2] = [Span { row: 1, left: 2, right: 5 }, Span { row: 2, left: 0, right: 4 }];

    #[test]
    fn the_first_end_within_a_span() {
        assert_eq!(count(&SAMPLES), 7);
        assert_eq!(first(&SAMPLES, 0), []);
        assert_eq!(first(&SAMPLES, 2), [Span { row: 1, left: 2, right: 4 }]);
        assert_eq!(first(&SAMPLES, 4), [SAMPLES[0], Span { row: 2, left: 0, right: 1 }]);
        assert_eq!(first(&SAMPLES, 99), SAMPLES);
        assert_eq!(
            [(2, 1), (4, 1), (0, 2), (3, 2), (4, 2)].map(|at| index_of(&SAMPLES, at)),
            [Some(0), Some(2), Some(3), Some(6), None]
        );
    }

    #[test]
    fn a_scissor_leaves_what_lies_within() {
        for (x, y) in (0..6).flat_map(|y| (0..6).map(move |x| (x, y))) {
            let mut out = Vec::new();
            let found = within(&SAMPLES, SampleArea::pixel((x, y)), &mut out);
            let inside = SAMPLES.iter().any(|span| span.row == y && (span.left..span.right).contains(&x));
            assert_eq!(found, u64::from(inside), "({x}, {y})");
            assert_eq!(count(&out), usize::from(inside), "({x}, {y})");
        }
    }
}
