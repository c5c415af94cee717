//! Random numbers with the distributions that the cases need.

use std::f64::consts::TAU;

/// Random number generator, seeded with a number and the name of a class.
#[derive(Clone, Debug)]
pub(super) struct Rng(fastrand::Rng);

impl Rng {
    pub(super) fn new(seed: u64, class: &str) -> Self {
        /// Offset basis and prime of the FNV-1a hash, which gives every class its own sequence.
        const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0100_0000_01b3);
        let hash = class.bytes().fold(FNV.0, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(FNV.1));
        Self(fastrand::Rng::with_seed(seed ^ hash))
    }

    /// Returns a seed for another random number generator, below 2⁵³ so that every JSON reader preserves it.
    pub(super) fn seed(&mut self) -> u64 {
        // 53 bits survive every JSON reader.
        self.0.u64(..1 << 53)
    }

    pub(super) fn integer(&mut self, range: std::ops::Range<i32>) -> i32 {
        self.0.i32(range)
    }

    pub(super) fn bool(&mut self) -> bool {
        self.0.bool()
    }

    /// Returns −1 or 1 with equal probability.
    pub(super) fn sign(&mut self) -> f64 {
        if self.0.bool() { 1.0 } else { -1.0 }
    }

    /// Returns a uniformly distributed number in `low..high`.
    pub(super) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    /// Returns a log-uniformly distributed number in `low..high`.
    pub(super) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        10.0_f64.powf(self.uniform(low.log10(), high.log10()))
    }

    /// Returns a random multiple of 1/256 in `low..high`, which vertex snapping does not change.
    pub(super) fn on_grid(&mut self, low: i32, high: i32) -> f32 {
        self.integer(low * 256..high * 256) as f32 / 256.0
    }

    /// Returns the coordinate of a random pixel centre in `low..high`.
    pub(super) fn centre(&mut self, low: i32, high: i32) -> f32 {
        self.integer(low..high) as f32 + 0.5
    }

    /// Returns a unit vector in a random direction.
    pub(super) fn direction(&mut self) -> [f64; 2] {
        let (sin, cos) = self.uniform(0.0, TAU).sin_cos();
        [cos, sin]
    }

    /// Returns the vertices in random order, which may reverse the winding.
    pub(super) fn shuffled<T>(&mut self, mut corners: [T; 3]) -> [T; 3] {
        self.0.shuffle(&mut corners);
        corners
    }

    /// Shuffles a list in place.
    pub(super) fn shuffle<T>(&mut self, list: &mut [T]) {
        self.0.shuffle(list);
    }
}

/// Rounds coordinates to f32.
pub(super) fn to_f32<const N: usize>(point: [f64; N]) -> [f32; N] {
    point.map(|c| c as f32)
}
