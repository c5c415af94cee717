//! Distribution of tiles over threads.
//!
//! If the picture has many rows of tiles per thread, a thread takes whole rows and draws directly into the picture.
//! Otherwise some threads would idle while others draw the last rows. A thread then takes a few tiles of a row, draws
//! each of them in private memory and copies it into the picture. A single thread never idles, so it takes whole rows.

use std::cmp::Reverse;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::bins::Chunk;
use super::layout::{TileGrid, TilePlace};
use super::pixel_samples::PreparedSamples;
use super::target::{PictureRows, Target, TileMemory, lock};
use super::{TiledFrame, Workspace};
use crate::math::lanes::*;

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

/// Divides the tiles of a picture into runs: whole rows, or parts of rows. Runs with the most work come first, so that
/// no thread starts a long run when the other threads have no work left.
pub(super) fn split_into_runs(chunks: &[Chunk], tiles: TileGrid, threads: usize) -> Vec<TileRun> {
    let TileGrid { columns, rows } = tiles;
    let runs_per_row = if rows >= threads * ROWS_PER_THREAD || threads == 1 {
        1
    } else {
        (threads * RUNS_PER_THREAD).div_ceil(rows.max(1))
    };
    let length = columns.div_ceil(runs_per_row).max(1);
    let run = |row: usize, columns_of_run: Range<usize>| {
        let load = columns_of_run.clone().map(|column| load(chunks, tiles.place(column, row))).sum();
        TileRun { row, columns: columns_of_run, load }
    };
    let firsts = |row| (0..columns).step_by(length).map(move |first| (row, first));
    let mut runs: Vec<_> =
        (0..rows).flat_map(firsts).map(|(row, first)| run(row, first..columns.min(first + length))).collect();
    runs.sort_by_key(|run| Reverse(run.load));
    runs
}

/// Returns the number of triangles in a tile's bin.
pub(super) fn load(chunks: &[Chunk], tile: TilePlace) -> usize {
    chunks.iter().map(|chunk| chunk.keys(tile.number).len()).sum()
}

impl TiledFrame<'_> {
    /// Draws all tiles into the picture, on all threads. `rows` holds the picture, split into rows of tiles.
    pub(super) fn draw_tiles(&self, lanes: Lanes, rows: &[Mutex<PictureRows<'_>>], workspaces: &Mutex<Vec<Workspace>>) {
        let threads = rayon::current_num_threads();
        let runs = split_into_runs(self.chunks, self.tiles, threads);
        let next_run = AtomicUsize::new(0);
        let draw_runs = || {
            let taken = workspaces.lock().ok().and_then(|mut all| all.pop());
            let mut workspace = taken.unwrap_or_else(Workspace::new);
            while let Some(run) = runs.get(next_run.fetch_add(1, Ordering::Relaxed)) {
                self.draw_run(lanes, run, &rows[run.row], &mut workspace);
            }
            if let Ok(mut all) = workspaces.lock() {
                all.push(workspace);
            }
        };
        rayon::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|_| draw_runs());
            }
        });
    }

    /// Draws a run of tiles into its row of the picture.
    fn draw_run(&self, lanes: Lanes, run: &TileRun, rows: &Mutex<PictureRows<'_>>, workspace: &mut Workspace) {
        let tiles = run.columns.clone().map(|column| self.tiles.place(column, run.row));
        if run.load == 0 {
            let (background, depth) = (self.background, self.rules.clear);
            on_lanes!(lanes, simd => lock(rows).clear(simd, &run.columns, background, depth));
        } else if run.columns.len() == self.tiles.columns {
            let mut rows = lock(rows);
            on_lanes!(lanes, simd => rows.fill(simd, self.background));
            for tile in tiles {
                self.draw_target(lanes, workspace, rows.target(tile));
            }
        } else {
            let mut memory = workspace.memory.take().unwrap_or_else(TileMemory::new);
            for tile in tiles {
                memory.fill(lanes, self.background);
                memory.draw(lanes, tile, rows, |target| self.draw_target(lanes, workspace, target));
            }
            workspace.memory = Some(memory);
        }
    }

    /// Draws and shades one tile in the sampling mode of the frame.
    fn draw_target(&self, lanes: Lanes, workspace: &mut Workspace, target: Target<'_>) {
        match &self.samples {
            PreparedSamples::Centre => on_lanes!(lanes, simd => self.draw_tile(simd, workspace, target)),
            PreparedSamples::Multisampled(planes) => {
                on_lanes!(lanes, simd => self.draw_samples(simd, planes, workspace, target));
            }
            PreparedSamples::Jittered(samples) => {
                on_lanes!(lanes, simd => self.draw_jittered(simd, samples, workspace, target));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_split_if_there_are_few_per_thread() {
        let lengths = |(columns, rows), threads| {
            split_into_runs(&[], TileGrid { columns, rows }, threads)
                .iter()
                .map(|run| run.columns.len())
                .collect::<Vec<_>>()
        };
        assert_eq!(lengths((30, 17), 1), [30; 17]);
        assert_eq!(lengths((30, 17), 2), [30; 17]);
        assert_eq!(lengths((30, 17), 8), [4, 4, 4, 4, 4, 4, 4, 2].repeat(17));
        assert_eq!(lengths((3, 2), 64), [1; 6]);
        assert!(lengths((0, 2), 2).is_empty() && lengths((2, 0), 2).is_empty());
    }
}
