//! Locks, which protect thin features from rectification: their samples are missing in most frames, so that the colours
//! around the pixel do not contain them.

use super::super::FilterSpace;
use super::super::ycocg::YCoCg;

/// Luminances of 3 × 3 samples, row by row.
pub(super) type Luminances = [f32; 9];

/// Lock of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lock {
    /// Remaining lifetime: 1 when the lock is created, 0 if there is none.
    lifetime: f32,
    /// Median luminance of the 3 × 3 samples when the lock was created. A line covers three of them, so the median is
    /// the luminance beside it, whether or not the samples of a frame hit it.
    luminance: f32,
}

impl Lock {
    /// No lock.
    pub(super) const NONE: Self = Self { lifetime: 0.0, luminance: 0.0 };

    /// Returns a new lock on the thin feature in the middle of samples with these luminances.
    pub(super) fn new(luminances: &Luminances) -> Self {
        Self { lifetime: 1.0, luminance: median(luminances) }
    }

    /// Returns the two numbers that the history stores. They can be interpolated, because the luminance is weighted by the
    /// lifetime.
    #[inline(always)]
    pub(super) fn stored(self) -> [f32; 2] {
        [self.lifetime, self.lifetime * self.luminance]
    }

    /// Returns the lock that the history stores as these two numbers.
    #[inline(always)]
    pub(super) fn from_stored([lifetime, weighted]: [f32; 2]) -> Self {
        if lifetime > 0.0 { Self { lifetime, luminance: weighted / lifetime } } else { Self::NONE }
    }

    /// Returns the lock in the next of `lifetime_frames` frames, or none if it expires or if the shading around the
    /// pixel has changed.
    #[inline(always)]
    pub(super) fn aged(self, lifetime_frames: u32, luminances: &Luminances, contrast: Contrast) -> Self {
        let lifetime = self.lifetime - 1.0 / lifetime_frames as f32;
        if lifetime <= 0.0 || contrast.differ(median(luminances), self.luminance) {
            return Self::NONE;
        }
        Self { lifetime, ..self }
    }

    /// Returns the share of the history that is not rectified, in [0, 1]: 1 until the last quarter of the lifetime.
    #[inline(always)]
    pub(super) fn strength(self) -> f32 {
        (self.lifetime * 4.0).min(1.0)
    }
}

/// Contrast from which two luminances count as different.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contrast {
    /// Least ratio of the luminances.
    ratio: f32,
    /// Least difference in addition to the ratio: one sRGB code, so that the rounding of dark codes is no contrast.
    step: f32,
}

impl Contrast {
    /// Returns the published contrast: a ratio of 1.05 between the sixth roots of luminances in linear light.
    pub(super) fn of(colors: YCoCg) -> Self {
        match colors.light {
            FilterSpace::Linear => Self { ratio: 1.340_096, step: 1.0 / (255.0 * 12.92) },
            // The same ratio to the power 1 / 2.2.
            FilterSpace::Bytes => Self { ratio: 1.142_3, step: 1.0 },
        }
    }

    /// Whether two luminances differ.
    #[inline(always)]
    fn differ(self, one: f32, other: f32) -> bool {
        one.max(other) > one.min(other) * self.ratio + self.step
    }

    /// Whether the middle one of 3 × 3 samples belongs to a thin feature: it is brighter or darker than all samples that
    /// differ from it, and no 2 × 2 samples around it are all like it.
    pub(super) fn is_thin(self, luminances: &Luminances) -> bool {
        /// The other three samples of each 2 × 2 samples that contain the middle one.
        const SQUARES: [[usize; 3]; 4] = [[0, 1, 3], [1, 2, 5], [3, 6, 7], [5, 7, 8]];
        let own = luminances[4];
        let (mut least, mut greatest) = (f32::INFINITY, f32::NEG_INFINITY);
        let mut is_like = [true; 9];
        for (is_like, luminance) in is_like.iter_mut().zip(luminances) {
            *is_like = !self.differ(own, *luminance);
            if !*is_like {
                (least, greatest) = (least.min(*luminance), greatest.max(*luminance));
            }
        }
        let is_extreme = own < least || own > greatest;
        is_extreme && !SQUARES.iter().any(|square| square.iter().all(|place| is_like[*place]))
    }
}

/// Returns the median of nine numbers.
#[inline(always)]
fn median(values: &Luminances) -> f32 {
    /// Exchanges that move the median to the middle (J. L. Smith, “Implementing Median Filters in XC4000E FPGAs”, 1996).
    const EXCHANGES: [(usize, usize); 19] = [
        (1, 2),
        (4, 5),
        (7, 8),
        (0, 1),
        (3, 4),
        (6, 7),
        (1, 2),
        (4, 5),
        (7, 8),
        (0, 3),
        (5, 8),
        (4, 7),
        (3, 6),
        (1, 4),
        (2, 5),
        (4, 7),
        (4, 2),
        (6, 4),
        (4, 2),
    ];
    let mut values = *values;
    for (low, high) in EXCHANGES {
        (values[low], values[high]) = (values[low].min(values[high]), values[low].max(values[high]));
    }
    values[4]
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTRAST: Contrast = Contrast { ratio: 1.34, step: 0.001 };

    #[test]
    fn the_median_is_the_fifth_of_the_sorted_numbers() {
        let mut random = fastrand::Rng::with_seed(4);
        for _ in 0..2000 {
            let values: Luminances = std::array::from_fn(|_| random.u8(..12).into());
            let mut sorted = values;
            sorted.sort_by(f32::total_cmp);
            assert_eq!(median(&values), sorted[4], "{values:?}");
        }
    }

    #[test]
    fn lines_and_points_are_thin_and_edges_and_areas_are_not() {
        let is_thin = |pattern: &str| {
            let levels: Vec<f32> = pattern.chars().map(|c| if c == '#' { 0.8 } else { 0.1 }).collect();
            CONTRAST.is_thin(&levels.try_into().unwrap())
        };
        for line in [".#..#..#.", "...###...", "#...#...#", "....#....", "#.##.##.#", "##..##..#"] {
            assert!(is_thin(line), "{line}");
        }
        for wide in ["##.##.##.", "######...", "#########", ".........", "...##.##.", "##.##...."] {
            assert!(!is_thin(wide), "{wide}");
        }
        // A slope is not extreme, and a small contrast is none.
        assert!(!CONTRAST.is_thin(&[0.1, 0.4, 0.8, 0.1, 0.4, 0.8, 0.1, 0.4, 0.8]));
        assert!(!CONTRAST.is_thin(&[0.5, 0.6, 0.5, 0.5, 0.6, 0.5, 0.5, 0.6, 0.5]));
    }

    #[test]
    fn locks_expire_and_end_when_the_surroundings_change() {
        let line = [0.1, 0.8, 0.1, 0.1, 0.8, 0.1, 0.1, 0.8, 0.1];
        let (missed, lit) = ([0.1; 9], [0.3; 9]);
        let lock = Lock::new(&line);
        assert_eq!(lock.aged(8, &missed, CONTRAST).stored(), [0.875, 0.875 * 0.1]);
        assert_eq!(lock.aged(8, &lit, CONTRAST), Lock::NONE);
        assert_eq!((0..8).fold(lock, |lock, _| lock.aged(8, &missed, CONTRAST)), Lock::NONE);
        assert_eq!(Lock::from_stored(lock.stored()), lock);
        assert_eq!([1.0, 0.25, 0.125].map(|lifetime| Lock { lifetime, ..lock }.strength()), [1.0, 1.0, 0.5]);
    }
}
