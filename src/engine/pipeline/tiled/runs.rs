//! Distribution of tiles over threads.
//!
//! If the picture has many rows of tiles per thread, a thread takes whole rows and draws directly into the picture.
//! Otherwise some threads would idle while others draw the last rows. A thread then takes a few tiles of a row, draws
//! each of them in private memory and copies it into the picture. A single thread never idles, so it takes whole rows.

use std::cmp::Reverse;
use std::ops::Range;

use super::bins::Chunk;

/// Minimum number of rows of tiles per thread for which threads take whole rows. So many rows balance the load well
/// enough: shorter runs would save less time than copying their tiles takes.
const ROWS_PER_THREAD: usize = 8;

/// Number of runs per thread, if there are fewer than [`ROWS_PER_THREAD`] rows per thread.
const RUNS_PER_THREAD: usize = 16;

/// Adjacent tiles that one thread draws in sequence, because such tiles often share triangles.
pub(super) struct TileRun {
    pub(super) row: usize,
    pub(super) columns: Range<usize>,
    /// Number of triangles in the bins of all tiles of the run.
    pub(super) load: usize,
}

/// Divides a picture of `columns` × `rows` tiles into runs: whole rows, or parts of rows. Runs with the most work come
/// first, so that no thread starts a long run when the other threads have no work left.
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
    fn rows_are_split_if_there_are_few_per_thread() {
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
