//! Sample patterns: positions of the samples in a pixel.
//!
//! Offsets lie in [0, 1)², x right and y down from the pixel's top left corner. The mean of the samples is the pixel's
//! colour. Patterns differ at edges. In a regular pattern of n² samples, each column holds n samples, so the coverage
//! along a nearly vertical edge changes in only n steps. In a pattern whose samples all lie in different columns, the
//! coverage changes in n² steps.

/// Sample pattern: the positions of the samples in a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// One sample at the centre of each of `side` × `side` equal squares of the pixel.
    Regular {
        /// Number of squares along an axis, at least 1.
        side: u32,
    },
    /// One sample at the centre of each square after `level` subdivisions of the pixel into quarters. The positions
    /// equal those of [`Pattern::Regular`] with a side of 2^`level`, but follow the order of the subdivision.
    Recursive {
        /// Number of subdivisions, at most [`Pattern::MAX_LEVELS`].
        level: u32,
    },
    /// One sample in each of `side` × `side` squares of the pixel. Its position is chosen at random from
    /// [`Pattern::JITTER`]² candidates, anew for each pixel. Turns stair-stepping into noise.
    Jittered {
        /// Number of squares along an axis, at least 1.
        side: u32,
        /// Seed of the random positions.
        seed: u32,
    },
    /// Four samples, each in a row and a column of its own: a square rotated by about 27°.
    RotatedGrid,
    /// First `count` points of Sobol's (0, 2)-sequence. Halving the pixel k times, along either axis, gives 2ᵏ equal
    /// rectangles. Each rectangle contains exactly one of the points with indices from m · 2ᵏ up to (m + 1) · 2ᵏ − 1,
    /// for any integer m ≥ 0.
    LowDiscrepancy {
        /// Number of samples per pixel.
        count: u32,
    },
}

impl Pattern {
    /// Maximum level of [`Pattern::Recursive`], with 256 samples.
    pub(crate) const MAX_LEVELS: u32 = 4;

    /// Number of candidate positions of a jittered sample along each axis of its square.
    pub(crate) const JITTER: u32 = 4;

    /// Returns the number of samples per pixel.
    pub(crate) fn count(self) -> u32 {
        match self {
            Self::Regular { side } | Self::Jittered { side, .. } => side.max(1).pow(2),
            Self::Recursive { level } => 4_u32.pow(level.min(Self::MAX_LEVELS)),
            Self::RotatedGrid => 4,
            Self::LowDiscrepancy { count } => count.max(1),
        }
    }

    /// Returns the sample positions in pixel (`x`, `y`), in pixels from its top left corner.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::antialias::pattern::Pattern;
    ///
    /// let offsets = Pattern::Regular { side: 2 }.offsets(0, 0);
    /// assert_eq!(offsets, [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]]);
    ///
    /// // Each sample of the rotated grid has a row of its own.
    /// let rows: Vec<f64> = Pattern::RotatedGrid.offsets(0, 0).iter().map(|[_, y]| *y).collect();
    /// assert_eq!(rows, [0.125, 0.375, 0.625, 0.875]);
    /// ```
    pub fn offsets(self, x: u32, y: u32) -> Vec<[f64; 2]> {
        match self {
            Self::Regular { side } => grid(side.max(1), |_, _| [0.5; 2]),
            Self::Recursive { level } => quartered(level.min(Self::MAX_LEVELS)),
            Self::Jittered { side, seed } => {
                let side = side.max(1);
                grid(side, |column, row| jittered_position(jitter(x, y, row * side + column, seed)))
            }
            Self::RotatedGrid => [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]].to_vec(),
            Self::LowDiscrepancy { count } => {
                // Adding half a grid step moves each point from the corner of its grid cell to the middle. The mean of
                // 2ᵏ points is then the pixel's centre.
                let half_step = 0.5 / f64::from(count.max(1).next_power_of_two());
                (0..count.max(1)).map(|index| sobol(index).map(|at| at + half_step)).collect()
            }
        }
    }
}

/// Returns the index of the candidate position that is chosen for a jittered sample in pixel (`x`, `y`). Candidates are
/// numbered row by row within the sample's square.
pub(crate) fn jitter(x: u32, y: u32, sample: u32, seed: u32) -> usize {
    // Odd multipliers without simple ratios to each other spread the inputs before the generator mixes them, so
    // adjacent pixels show no common pattern.
    let spread = u64::from(x).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ u64::from(y).wrapping_mul(0xC2B2_AE3D_27D4_EB4F)
        ^ u64::from(sample).wrapping_mul(0xD6E8_FEB8_6659_FD93)
        ^ u64::from(seed).wrapping_mul(0x1656_67B1_9E37_79F9);
    fastrand::Rng::with_seed(spread).usize(0..(Pattern::JITTER * Pattern::JITTER) as usize)
}

/// Computes [`jitter`] of one sample for the pixels at `columns` of row `y`, and stores the results in `places`.
pub(crate) fn jitter_row(columns: &[u32], y: u32, sample: u32, seed: u32, places: &mut [u8]) {
    for (place, x) in places.iter_mut().zip(columns) {
        *place = jitter(*x, y, sample, seed) as u8;
    }
}

/// Returns the position of a jitter candidate in its square, in [0, 1)².
fn jittered_position(place: usize) -> [f64; 2] {
    let steps = Pattern::JITTER as usize;
    [place % steps, place / steps].map(|step| (step as f64 + 0.5) / steps as f64)
}

/// Returns the candidate positions in each of `side` × `side` squares of a pixel, in pixels from the pixel's top left
/// corner. [`jitter`] returns indices into these lists.
pub(crate) fn jittered_positions(side: u32) -> Vec<Vec<[f64; 2]>> {
    let all =
        (0..(Pattern::JITTER * Pattern::JITTER) as usize).map(|place| grid(side, |_, _| jittered_position(place)));
    let all: Vec<_> = all.collect();
    (0..(side * side) as usize).map(|square| all.iter().map(|places| places[square]).collect()).collect()
}

/// Returns one position in each of `side` × `side` squares of a pixel, row by row, in pixels from the pixel's top left
/// corner. `within` returns the position within a square, in [0, 1)².
fn grid(side: u32, mut within: impl FnMut(u32, u32) -> [f64; 2]) -> Vec<[f64; 2]> {
    let squares = (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
    squares
        .map(|(column, row)| {
            let [x, y] = within(column, row);
            [(f64::from(column) + x) / f64::from(side), (f64::from(row) + y) / f64::from(side)]
        })
        .collect()
}

/// Returns the centres of the squares after `level` subdivisions of a pixel into quarters, in pixels from the pixel's
/// top left corner and in the order of the subdivision.
fn quartered(level: u32) -> Vec<[f64; 2]> {
    let mut places = vec![[0.5; 2]];
    for depth in 1..=level {
        let shift = 0.5_f64.powi(depth as i32 + 1);
        let quarter = |[x, y]: [f64; 2]| {
            [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(dx, dy)| [x + dx * shift, y + dy * shift])
        };
        places = places.into_iter().flat_map(quarter).collect();
    }
    places
}

/// Returns point `index` of Sobol's (0, 2)-sequence, in [0, 1)²: x is the bit-reversed index, y is Sobol's second
/// dimension.
fn sobol(index: u32) -> [f64; 2] {
    let mut second = 0_u32;
    let (mut rest, mut direction) = (index, 1_u32 << 31);
    while rest != 0 {
        if rest & 1 == 1 {
            second ^= direction;
        }
        rest >>= 1;
        direction ^= direction >> 1;
    }
    [index.reverse_bits(), second].map(|bits| f64::from(bits) / (1_u64 << 32) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATTERNS: [Pattern; 7] = [
        Pattern::Regular { side: 1 },
        Pattern::Regular { side: 3 },
        Pattern::Recursive { level: 3 },
        Pattern::Jittered { side: 4, seed: 9 },
        Pattern::RotatedGrid,
        Pattern::LowDiscrepancy { count: 256 },
        Pattern::LowDiscrepancy { count: 5 },
    ];

    #[test]
    fn all_samples_lie_in_the_pixel_and_match_the_count() {
        for pattern in PATTERNS {
            let offsets = pattern.offsets(17, 4);
            assert_eq!(offsets.len(), pattern.count() as usize, "{pattern:?}");
            assert!(offsets.as_flattened().iter().all(|at| (0.0..1.0).contains(at)), "{pattern:?}");
        }
        assert_eq!(Pattern::Regular { side: 1 }.offsets(0, 0), [[0.5, 0.5]]);
        assert_eq!(Pattern::LowDiscrepancy { count: 1 }.offsets(0, 0), [[0.5, 0.5]]);
    }

    #[test]
    fn samples_balance_around_the_middle_of_the_pixel() {
        for pattern in PATTERNS.into_iter().filter(|p| !matches!(p, Pattern::Jittered { .. }) && p.count() != 5) {
            let offsets = pattern.offsets(0, 0);
            let mean = [0, 1].map(|axis| offsets.iter().map(|at| at[axis]).sum::<f64>() / offsets.len() as f64);
            assert!(mean.iter().all(|at| (at - 0.5).abs() < 1e-9), "{pattern:?}: {mean:?}");
        }
    }

    #[test]
    fn a_quartered_pixel_has_the_places_of_a_regular_grid() {
        for level in 0..=Pattern::MAX_LEVELS {
            let sorted = |pattern: Pattern| {
                let mut offsets = pattern.offsets(0, 0);
                offsets.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
                offsets
            };
            assert_eq!(sorted(Pattern::Recursive { level }), sorted(Pattern::Regular { side: 1 << level }), "{level}");
        }
    }

    #[test]
    fn every_rectangle_of_a_low_discrepancy_pattern_has_one_sample() {
        for power in 0..=8 {
            let offsets = Pattern::LowDiscrepancy { count: 1 << power }.offsets(0, 0);
            for across in 0..=power {
                let (columns, rows) = (1 << across, 1 << (power - across));
                let mut hits = vec![0; 1 << power];
                for [x, y] in &offsets {
                    hits[(y * f64::from(rows)) as usize * columns as usize + (x * f64::from(columns)) as usize] += 1;
                }
                assert!(hits.iter().all(|hit| *hit == 1), "{} samples in {columns} × {rows}", 1 << power);
            }
        }
    }

    #[test]
    fn the_rotated_grid_has_a_row_and_a_column_for_each_sample() {
        for axis in [0, 1] {
            let mut places: Vec<_> =
                Pattern::RotatedGrid.offsets(0, 0).iter().map(|at| (at[axis] * 4.0) as u32).collect();
            places.sort_unstable();
            assert_eq!(places, [0, 1, 2, 3]);
        }
    }

    #[test]
    fn jitter_keeps_to_its_squares_and_differs_from_pixel_to_pixel_but_not_from_run_to_run() {
        let pattern = Pattern::Jittered { side: 4, seed: 1 };
        assert_eq!(pattern.offsets(3, 5), pattern.offsets(3, 5));
        assert_ne!(pattern.offsets(3, 5), pattern.offsets(4, 5));
        assert_ne!(pattern.offsets(3, 5), Pattern::Jittered { side: 4, seed: 2 }.offsets(3, 5));
        for (index, [x, y]) in pattern.offsets(3, 5).into_iter().enumerate() {
            assert_eq!(((x * 4.0) as usize, (y * 4.0) as usize), (index % 4, index / 4));
        }
    }
}
