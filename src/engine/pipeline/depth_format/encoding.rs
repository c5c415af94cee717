//! Number formats in which the depth buffer stores a depth in [0, 1].

use crate::math::lanes::{F32, F64, Simd, SimdFloat as _, widen};

/// Number format of a depth buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthEncoding {
    /// 32-bit float, whose steps become finer towards 0.
    F32,
    /// 24-bit unsigned normalised integer: uniform steps of 1/(2²⁴ − 1).
    Unorm24,
    /// 16-bit unsigned normalised integer: uniform steps of 1/65535.
    Unorm16,
}

impl DepthEncoding {
    /// Returns the integer code of depth 1, or `None` for floats.
    #[inline]
    pub(crate) fn largest_code(self) -> Option<u32> {
        match self {
            Self::F32 => None,
            Self::Unorm24 => Some((1 << 24) - 1),
            Self::Unorm16 => Some((1 << 16) - 1),
        }
    }

    /// Returns the value stored for a depth in [0, 1]. For floats it is the nearest f32. For n-bit codes it is the f32
    /// nearest to code/(2ⁿ − 1) with code = ⌊depth·(2ⁿ − 1) + ½⌋. Distinct codes give distinct floats.
    #[inline]
    pub(crate) fn quantize(self, depth: f64) -> f32 {
        match self.largest_code() {
            None => depth as f32,
            // The cast to an integer truncates.
            Some(largest) => (f64::from((depth * f64::from(largest) + 0.5) as u32) / f64::from(largest)) as f32,
        }
    }

    /// Returns the integer code of a stored value, or `None` for floats.
    pub fn code(self, stored: f32) -> Option<u32> {
        // A stored float is less than half a step away from the exact value of its code.
        self.largest_code().map(|largest| (f64::from(stored) * f64::from(largest) + 0.5) as u32)
    }

    /// Returns the depth that a stored value represents, and a neighbouring storable depth: the next larger one or, for
    /// depth 1, the next smaller one.
    pub(crate) fn depth_and_next(self, stored: f32) -> [f64; 2] {
        match self.largest_code().zip(self.code(stored)) {
            None => [stored, if stored < 1.0 { stored.next_up() } else { stored.next_down() }].map(f64::from),
            Some((largest, code)) => {
                [code, if code < largest { code + 1 } else { code - 1 }].map(|c| f64::from(c) / f64::from(largest))
            }
        }
    }

    /// Returns the depths that eight stored values represent.
    #[inline(always)]
    pub(in crate::pipeline) fn depths_of<S: Simd>(self, simd: S, stored: F32<S>) -> F64<S> {
        let stored = widen(simd, stored);
        match self.largest_code().map(f64::from) {
            None => stored,
            Some(largest) => (stored * largest + 0.5).trunc() / largest,
        }
    }

    /// Returns the number of steps between two stored values. One step leads to the next integer code or, if depths are
    /// floats, to the next representable float.
    pub(crate) fn steps_between(self, a: f32, b: f32) -> u32 {
        match self.code(a).zip(self.code(b)) {
            None => a.to_bits().abs_diff(b.to_bits()),
            Some((a, b)) => a.abs_diff(b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns all codes of a 16-bit format. For a 24-bit format, returns the codes within 500 of either end or of a
    /// power of two, and every 97th code.
    fn codes(encoding: DepthEncoding) -> Vec<u32> {
        let Some(largest) = encoding.largest_code() else { return Vec::new() };
        let around = |code: u32| code.saturating_sub(500)..=(code + 500).min(largest);
        let mut codes: Vec<u32> = match encoding {
            DepthEncoding::Unorm16 => (0..=largest).collect(),
            _ => (0..=24).flat_map(|bit| around(1 << bit)).chain((0..=largest).step_by(97)).collect(),
        };
        codes.sort_unstable();
        codes.dedup();
        codes
    }

    #[test]
    fn every_code_is_kept_apart_and_comes_back() {
        for encoding in [DepthEncoding::Unorm16, DepthEncoding::Unorm24] {
            let largest = f64::from(encoding.largest_code().unwrap());
            let codes = codes(encoding);
            assert_eq!(codes.first().zip(codes.last()), Some((&0, &encoding.largest_code().unwrap())));
            let mut before = -1.0;
            for code in codes {
                let exact = f64::from(code) / largest;
                let stored = encoding.quantize(exact);
                assert_eq!(encoding.code(stored), Some(code));
                assert_eq!(stored, exact as f32, "the nearest float");
                assert!(stored > before, "{code}");
                // Quantising is idempotent.
                assert_eq!(encoding.quantize(f64::from(stored)), stored);
                before = stored;
            }
        }
    }

    #[test]
    fn codes_are_rounded_half_up() {
        let largest = 65_535.0;
        for (depth, code) in [(0.0, 0), (0.499_999, 0), (0.5, 1), (1.499_999, 1), (1.5, 2), (65_534.5, 65_535)] {
            assert_eq!(DepthEncoding::Unorm16.code(DepthEncoding::Unorm16.quantize(depth / largest)), Some(code));
        }
    }

    #[test]
    fn the_next_value_is_the_next_that_can_be_stored() {
        for encoding in [DepthEncoding::F32, DepthEncoding::Unorm16, DepthEncoding::Unorm24] {
            for depth in [0.0, 1e-9, 0.1, 0.5, 0.75, 1.0 - 1e-7, 1.0] {
                let stored = encoding.quantize(depth);
                let [here, next] = encoding.depth_and_next(stored);
                assert_eq!(encoding.quantize(here), stored);
                assert_eq!(encoding.steps_between(stored, encoding.quantize(next)), 1, "{encoding:?} {depth}");
                let between = (here + next) * 0.5;
                let near = [encoding.quantize(here), encoding.quantize(next)];
                assert!(near.contains(&encoding.quantize(between)), "{encoding:?} {depth}: nothing lies between");
                assert_eq!(next > here, stored < 1.0);
            }
        }
    }
}
