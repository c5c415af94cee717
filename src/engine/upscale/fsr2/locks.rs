//! Locks, which protect thin features from rectification: their samples are missing in most frames, so that the colours
//! around the pixel do not contain them.

use super::super::FilterSpace;
use super::super::ycocg::YCoCg;
use crate::math::lanes::*;

/// Luminances of 3 × 3 samples, row by row.
pub(super) type Luminances<S> = [f32x16<S>; 9];

/// Locks of sixteen pixels.
#[derive(Clone, Copy)]
pub(super) struct Locks<S: Simd> {
    /// Remaining lifetime: 1 when a lock is created, 0 if there is none.
    pub(super) lifetime: f32x16<S>,
    /// Median luminance of the 3 × 3 samples when the lock was created. A line covers three of them, so the median is
    /// the luminance beside it, whether or not the samples of a frame hit it.
    luminance: f32x16<S>,
}

impl<S: Simd> Locks<S> {
    /// Returns the two numbers per lock that the history stores. They can be interpolated, because the luminance is
    /// weighted by the lifetime.
    #[inline(always)]
    pub(super) fn stored(self) -> [f32x16<S>; 2] {
        [self.lifetime, self.lifetime * self.luminance]
    }

    /// Returns the locks that the history stores as these numbers.
    #[inline(always)]
    pub(super) fn from_stored(simd: S, [lifetime, weighted]: [f32x16<S>; 2]) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        let exists = lifetime.simd_gt(zero);
        Self { lifetime: exists.select(lifetime, zero), luminance: exists.select(weighted / lifetime, zero) }
    }

    /// Returns the locks in the next of `lifetime_frames` frames. Locks expire, end if the shading around the pixel has
    /// changed, and are created where `is_new`. `median` is that of the luminances around each pixel.
    #[inline(always)]
    pub(super) fn next(
        self,
        lifetime_frames: u32,
        is_new: mask32x16<S>,
        median: f32x16<S>,
        contrast: Contrast,
    ) -> Self {
        let simd = median.simd;
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let lifetime = self.lifetime - 1.0 / lifetime_frames as f32;
        let continues = lifetime.simd_gt(zero) & !contrast.differ(median, self.luminance);
        Self {
            lifetime: is_new.select(one, continues.select(lifetime, zero)),
            luminance: is_new.select(median, continues.select(self.luminance, zero)),
        }
    }

    /// Returns the shares of the history that are not rectified, in [0, 1]: 1 until the last quarter of the lifetime.
    #[inline(always)]
    pub(super) fn strength(self) -> f32x16<S> {
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
    fn differ<S: Simd>(self, one: f32x16<S>, other: f32x16<S>) -> mask32x16<S> {
        one.max(other).simd_gt(one.min(other) * self.ratio + self.step)
    }

    /// Whether the middle one of 3 × 3 samples belongs to a thin feature: it is brighter or darker than all samples that
    /// differ from it, and no 2 × 2 samples around it are all like it.
    #[inline(always)]
    pub(super) fn is_thin<S: Simd>(self, simd: S, luminances: &Luminances<S>) -> mask32x16<S> {
        let own = luminances[4];
        let (infinity, all) = (f32x16::splat(simd, f32::INFINITY), own.simd_eq(own));
        let (mut least, mut greatest) = (infinity, f32x16::splat(simd, f32::NEG_INFINITY));
        let mut is_like = [all; 9];
        for (is_like, luminance) in is_like.iter_mut().zip(luminances) {
            let differs = self.differ(own, *luminance);
            *is_like = !differs;
            least = least.min(differs.select(*luminance, infinity));
            greatest = greatest.max(differs.select(*luminance, f32x16::splat(simd, f32::NEG_INFINITY)));
        }
        let is_extreme = own.simd_lt(least) | own.simd_gt(greatest);
        // The other three samples of each 2 × 2 samples that contain the middle one.
        let [a, b, c, d] = each!([i, j, k] in [[0, 1, 3], [1, 2, 5], [3, 6, 7], [5, 7, 8]] => {
            is_like[i] & is_like[j] & is_like[k]
        });
        is_extreme & !(a | b | c | d)
    }
}

/// Returns the medians of nine numbers.
#[inline(always)]
pub(super) fn median<S: Simd>(values: &Luminances<S>) -> f32x16<S> {
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

    /// Returns the same luminances for sixteen pixels.
    fn sixteen<S: Simd>(simd: S, luminances: [f32; 9]) -> Luminances<S> {
        luminances.map(|luminance| f32x16::splat(simd, luminance))
    }

    #[test]
    fn the_median_is_the_fifth_of_the_sorted_numbers() {
        let mut random = fastrand::Rng::with_seed(4);
        for _ in 0..2000 {
            let values: [f32; 9] = std::array::from_fn(|_| random.u8(..12).into());
            let mut sorted = values;
            sorted.sort_by(f32::total_cmp);
            let found = on_lanes!(Lanes::best(), simd => median(&sixteen(simd, values)).to_array());
            assert_eq!(found, [sorted[4]; WIDE], "{values:?}");
        }
    }

    #[test]
    fn lines_and_points_are_thin_and_edges_and_areas_are_not() {
        let is_thin_at = |levels: [f32; 9]| {
            on_lanes!(Lanes::best(), simd => {
                let flags = CONTRAST.is_thin(simd, &sixteen(simd, levels));
                flags.select(f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0)).to_array()[0] == 1.0
            })
        };
        let is_thin = |pattern: &str| {
            let levels: Vec<f32> = pattern.chars().map(|c| if c == '#' { 0.8 } else { 0.1 }).collect();
            is_thin_at(levels.try_into().unwrap())
        };
        for line in [".#..#..#.", "...###...", "#...#...#", "....#....", "#.##.##.#", "##..##..#"] {
            assert!(is_thin(line), "{line}");
        }
        for wide in ["##.##.##.", "######...", "#########", ".........", "...##.##.", "##.##...."] {
            assert!(!is_thin(wide), "{wide}");
        }
        // A slope is not extreme, and a small contrast is none.
        assert!(!is_thin_at([0.1, 0.4, 0.8, 0.1, 0.4, 0.8, 0.1, 0.4, 0.8]));
        assert!(!is_thin_at([0.5, 0.6, 0.5, 0.5, 0.6, 0.5, 0.5, 0.6, 0.5]));
    }

    /// Returns the stored numbers of a lock that was created beside a luminance of 0.1, after a number of frames in which
    /// the median was `median`.
    fn aged(frames: u32, median: f32) -> [f32; 2] {
        on_lanes!(Lanes::best(), simd => {
            let number = |value: f32| f32x16::splat(simd, value);
            let (yes, no) = (number(0.0).simd_eq(number(0.0)), number(0.0).simd_eq(number(1.0)));
            let none = Locks::from_stored(simd, [number(0.0), number(0.0)]);
            let mut lock = none.next(8, yes, number(0.1), CONTRAST);
            for _ in 0..frames {
                lock = Locks::from_stored(simd, lock.stored()).next(8, no, number(median), CONTRAST);
            }
            lock.stored().map(|numbers| numbers.to_array()[0])
        })
    }

    #[test]
    fn locks_expire_and_end_when_the_surroundings_change() {
        assert_eq!(aged(0, 0.1), [1.0, 0.1]);
        assert_eq!(aged(1, 0.1), [0.875, 0.875 * 0.1]);
        assert_eq!(aged(1, 0.3), [0.0; 2]);
        assert_eq!(aged(8, 0.1), [0.0; 2]);
    }

    #[test]
    fn a_lock_is_strong_until_the_last_quarter_of_its_lifetime() {
        for (lifetime, strength) in [(1.0, 1.0), (0.25, 1.0), (0.125, 0.5), (0.0, 0.0)] {
            let found = on_lanes!(Lanes::best(), simd => {
                Locks::from_stored(simd, [f32x16::splat(simd, lifetime); 2]).strength().to_array()[0]
            });
            assert_eq!(found, strength, "{lifetime}");
        }
    }
}
