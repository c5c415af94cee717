//! Distribution of tiles over threads.
//!
//! If a picture has many rows of tiles per thread, a thread takes a row and draws straight into the picture. Otherwise
//! some threads would wait for the last rows of others. A thread then takes a few tiles of a row, draws each in private
//! memory and copies it. A single thread never waits, and takes rows.

use std::cmp::Reverse;
use std::ops::Range;

use super::bins::Chunk;

/// Rows of tiles per thread from which whole rows balance the load. Shorter runs would then gain less than their copies
/// cost.
const ROWS_PER_THREAD: usize = 8;

/// Runs per thread if there are fewer rows.
const RUNS_PER_THREAD: usize = 16;

/// Adjacent tiles that one thread draws in sequence, because they often share triangles.
pub(super) struct TileRun {
    pub(super) row: usize,
    pub(super) columns: Range<usize>,
    /// Number of triangles in the bins of the tiles.
    pub(super) load: usize,
}

/// Divides all tiles, given as columns and rows, into runs: whole rows, or shorter ones. Runs with the most work come
/// first, so that no thread starts one when the others are done.
pub(super) fn split_into_runs(chunks: &[Chunk], (columns, rows): (usize, usize), threads: usize) -> Vec<TileRun> {
    let runs_per_row = if rows >= threads * ROWS_PER_THREAD || threads == 1 {
        1
    } else {
        (threads * RUNS_PER_THREAD).div_ceil(rows.max(1))
    };
    let length = columns.div_ceil(runs_per_row).max(1);
    let run = |row: usize, columns_of_run: Range<usize>| {
        let tiles = columns_of_run.clone().map(|column| row * columns + column);
        let load = tiles.map(|number| load(chunks, number)).sum();
        TileRun { row, columns: columns_of_run, load }
    };
    let firsts = |row| (0..columns).step_by(length).map(move |first| (row, first));
    let mut runs: Vec<_> =
        (0..rows).flat_map(firsts).map(|(row, first)| run(row, first..columns.min(first + length))).collect();
    runs.sort_by_key(|run| Reverse(run.load));
    runs
}

/// Returns the number of triangles in a tile's bin.
pub(super) fn load(chunks: &[Chunk], number: usize) -> usize {
    chunks.iter().map(|chunk| chunk.keys(number).len()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_cut_where_there_are_few_for_each_thread() {
        let lengths = |tiles, threads| {
            split_into_runs(&[], tiles, threads).iter().map(|run| run.columns.len()).collect::<Vec<_>>()
        };
        assert_eq!(lengths((30, 17), 1), [30; 17]);
        assert_eq!(lengths((30, 17), 2), [30; 17]);
        assert_eq!(lengths((30, 17), 8), [4, 4, 4, 4, 4, 4, 4, 2].repeat(17));
        assert_eq!(lengths((3, 2), 64), [1; 6]);
        assert!(lengths((0, 2), 2).is_empty() && lengths((2, 0), 2).is_empty());
    }
}
