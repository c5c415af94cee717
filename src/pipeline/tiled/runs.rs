//! Which thread draws which tiles.
//!
//! Where a picture has many rows of tiles for each thread, a thread takes a row and draws straight into the picture. Otherwise
//! some threads would wait for the last rows of others: then a thread takes a few tiles of a row, draws each in memory of its
//! own, and copies it. One thread waits for nobody, and takes rows.

use std::cmp::Reverse;
use std::ops::Range;

use super::bins::Chunk;

/// So many rows of tiles for each thread let all be done at about the same time: what shorter runs would gain, copies would
/// cost.
const ROWS_PER_THREAD: usize = 8;

/// Shorter runs for each thread, if there are fewer rows.
const RUNS_PER_THREAD: usize = 16;

/// Tiles side by side that a thread draws one after the other, as the same triangles often lie in them.
pub(super) struct Run {
    pub(super) row: usize,
    pub(super) columns: Range<usize>,
    /// Triangles that the tiles are handed.
    pub(super) load: usize,
}

/// All tiles, of so many columns and rows, in runs for so many threads: whole rows, or shorter ones. Those with the most work
/// come first, so that no thread begins with it when the others are done.
pub(super) fn share_out(chunks: &[Chunk], (columns, rows): (usize, usize), threads: usize) -> Vec<Run> {
    let runs_per_row = if rows >= threads * ROWS_PER_THREAD || threads == 1 {
        1
    } else {
        (threads * RUNS_PER_THREAD).div_ceil(rows.max(1))
    };
    let length = columns.div_ceil(runs_per_row).max(1);
    let run = |row: usize, columns_of_run: Range<usize>| {
        let tiles = columns_of_run.clone().map(|column| row * columns + column);
        let load = tiles.map(|number| load(chunks, number)).sum();
        Run { row, columns: columns_of_run, load }
    };
    let firsts = |row| (0..columns).step_by(length).map(move |first| (row, first));
    let mut runs: Vec<_> =
        (0..rows).flat_map(firsts).map(|(row, first)| run(row, first..columns.min(first + length))).collect();
    runs.sort_by_key(|run| Reverse(run.load));
    runs
}

/// How many triangles a tile is handed.
pub(super) fn load(chunks: &[Chunk], number: usize) -> usize {
    chunks.iter().map(|chunk| chunk.keys(number).len()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_cut_where_there_are_few_for_each_thread() {
        let lengths =
            |tiles, threads| share_out(&[], tiles, threads).iter().map(|run| run.columns.len()).collect::<Vec<_>>();
        assert_eq!(lengths((30, 17), 1), [30; 17]);
        assert_eq!(lengths((30, 17), 2), [30; 17]);
        assert_eq!(lengths((30, 17), 8), [4, 4, 4, 4, 4, 4, 4, 2].repeat(17));
        assert_eq!(lengths((3, 2), 64), [1; 6]);
        assert!(lengths((0, 2), 2).is_empty() && lengths((2, 0), 2).is_empty());
    }
}
