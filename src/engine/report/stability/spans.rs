//! Operations on sets of pixels that are given as spans.

use crate::pipeline::raster::Span;
use crate::pipeline::viewport::Viewport;

fn length(span: &Span) -> u64 {
    span.right.saturating_sub(span.left).into()
}

/// Returns the number of pixels in spans, counting a pixel once for each span that contains it.
pub(crate) fn pixel_count(spans: &[Span]) -> u64 {
    spans.iter().map(length).sum()
}

/// Returns the set of pixels in the spans as sorted, disjoint, non-empty spans.
pub(crate) fn normalized(spans: &[Span]) -> Vec<Span> {
    let mut sorted: Vec<Span> = spans.iter().copied().filter(|s| s.left < s.right).collect();
    sorted.sort_unstable_by_key(|s| (s.row, s.left, s.right));
    let mut merged: Vec<Span> = Vec::with_capacity(sorted.len());
    for span in sorted {
        match merged.last_mut() {
            Some(last) if last.row == span.row && span.left <= last.right => last.right = last.right.max(span.right),
            _ => merged.push(span),
        }
    }
    merged
}

/// Returns the symmetric difference of two sets of pixels, as sorted, disjoint spans.
pub(crate) fn difference(a: &[Span], b: &[Span]) -> Vec<Span> {
    let (a, b) = (normalized(a), normalized(b));
    // A resulting span starts and ends where membership in one set changes; simultaneous changes in both cancel out.
    let mut ends: Vec<(u32, u32)> = a.iter().chain(&b).flat_map(|s| [(s.row, s.left), (s.row, s.right)]).collect();
    ends.sort_unstable();
    let mut result: Vec<Span> = Vec::new();
    let mut open: Option<(u32, u32)> = None;
    for end in ends {
        open = match open {
            None => Some(end),
            Some((row, left)) => {
                result.push(Span { row, left, right: end.1 });
                None
            }
        };
    }
    normalized(&result)
}

/// Number of times that each pixel of an image is covered, in row-major order.
#[derive(Clone, Debug)]
pub(crate) struct HitCounts {
    viewport: Viewport,
    counts: Vec<u16>,
}

impl HitCounts {
    /// Creates counters that are 0 for every pixel.
    pub(crate) fn none(viewport: Viewport) -> Self {
        Self { viewport, counts: vec![0; viewport.width as usize * viewport.height as usize] }
    }

    /// Increments the counters of all pixels in the spans; pixels outside the image are ignored.
    pub(crate) fn add(&mut self, spans: &[Span]) {
        let width = self.viewport.width as usize;
        for span in spans.iter().filter(|s| s.row < self.viewport.height) {
            let (left, right) = (width.min(span.left as usize), width.min(span.right as usize));
            let start = span.row as usize * width;
            for count in self.counts.get_mut(start + left..start + right).unwrap_or_default() {
                *count = count.saturating_add(1);
            }
        }
    }

    /// Returns the number of pixels that are not covered.
    pub(crate) fn cracks(&self) -> u64 {
        self.counts.iter().filter(|count| **count == 0).count() as u64
    }

    /// Returns the number of pixels that are covered more than once.
    pub(crate) fn doubles(&self) -> u64 {
        self.counts.iter().filter(|count| **count > 1).count() as u64
    }

    /// Returns the column and row of the first pixel that is not covered exactly once.
    pub(crate) fn first_fault(&self) -> Option<(u32, u32)> {
        let at = self.counts.iter().position(|count| *count != 1)?;
        let width = self.viewport.width as usize;
        Some(((at % width) as u32, (at / width) as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(row: u32, left: u32, right: u32) -> Span {
        Span { row, left, right }
    }

    #[test]
    fn differences_are_those_of_sets_of_pixels() {
        let mut random = fastrand::Rng::with_seed(8);
        for _ in 0..500 {
            let mut some = || -> Vec<Span> {
                let left = |random: &mut fastrand::Rng| random.u32(..12);
                (0..5)
                    .map(|_| {
                        let (row, left) = (random.u32(..3), left(&mut random));
                        span(row, left, left + random.u32(..6))
                    })
                    .collect()
            };
            let (a, b) = (some(), some());
            let holds = |spans: &[Span], row, x| spans.iter().any(|s| s.row == row && (s.left..s.right).contains(&x));
            let found = difference(&a, &b);
            for row in 0..3 {
                for x in 0..20 {
                    assert_eq!(holds(&found, row, x), holds(&a, row, x) != holds(&b, row, x), "{a:?} {b:?}");
                }
            }
            assert_eq!(found, normalized(&found));
        }
    }

    #[test]
    fn hits_are_counted_only_inside_the_image() {
        let mut hits = HitCounts::none(Viewport { width: 4, height: 2 });
        hits.add(&[span(0, 0, 4), span(0, 1, 2), span(1, 0, 3), span(1, 2, 900), span(7, 0, 4)]);
        assert_eq!((hits.cracks(), hits.doubles(), hits.first_fault()), (0, 2, Some((1, 0))));
        assert_eq!(HitCounts::none(Viewport { width: 4, height: 2 }).cracks(), 8);
    }
}
