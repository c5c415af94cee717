//! Base-2 logarithm from a few sums and products, with the same bits on SIMD lanes and in scalar code.

use super::lanes::*;

/// Coefficients of the polynomial g, constant term first. The logarithm of x = 2ᵉ·(1 + f) is e + log₂(1 + f), and
/// log₂(1 + f) is approximated by f + f·(1 − f)·g(f). The coefficients minimise the maximum error, which is 2.3·10⁻⁶.
const POLYNOMIAL: [f32; 5] = [0.442_544_94, -0.275_600_3, 0.181_948_87, -0.095_956_445, 0.025_841_443];

/// Number of fraction bits of an `f32`.
const FRACTION_BITS: u32 = f32::MANTISSA_DIGITS - 1;

/// Mask of the fraction bits of an `f32`.
const FRACTION: u32 = (1 << FRACTION_BITS) - 1;

/// Bias of the exponent stored in an `f32`.
const BIAS: i32 = f32::MAX_EXP - 1;

/// Returns the base-2 logarithm of a positive normal number, and 128 for infinity. The error is at most 2.3·10⁻⁶ plus
/// one rounding. The result is monotonic, and exact at powers of two. For other inputs the result is meaningless, but
/// the same as on SIMD lanes.
#[inline(always)]
pub(crate) fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let exponent = (bits >> FRACTION_BITS) as i32 - BIAS;
    let f = f32::from_bits(bits & FRACTION | 1.0_f32.to_bits()) - 1.0;
    let [c0, c1, c2, c3, c4] = POLYNOMIAL;
    let g = (((c4 * f + c3) * f + c2) * f + c1) * f + c0;
    exponent as f32 + (f + f * (1.0 - f) * g)
}

/// Returns the base-2 logarithm of sixteen lanes, bit-identical to [`log2`].
#[inline(always)]
pub(crate) fn log2_lanes<S: Simd>(x: f32x16<S>) -> f32x16<S> {
    let bits = x.bitcast::<u32x16<S>>();
    let exponent = (bits >> FRACTION_BITS).bitcast::<i32x16<S>>() - BIAS;
    let f = (bits & FRACTION | 1.0_f32.to_bits()).bitcast::<f32x16<S>>() - 1.0;
    let [c0, c1, c2, c3, c4] = POLYNOMIAL;
    let g = (((f * c4 + c3) * f + c2) * f + c1) * f + c0;
    let one = f32x16::splat(x.simd, 1.0);
    exponent.to_float::<f32x16<S>>() + (f + f * (one - f) * g)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log2_is_accurate_and_monotonic() {
        let mut last = 0.0;
        for bits in 1.0_f32.to_bits()..=2.0_f32.to_bits() {
            let x = f32::from_bits(bits);
            let value = log2(x);
            assert!(value >= last, "{x}: {value} after {last}");
            assert!((f64::from(value) - f64::from(x).log2()).abs() < 2.4e-6, "{x}: {value}");
            last = value;
        }
    }

    #[test]
    fn powers_of_two_are_exact_and_bound_the_values_between() {
        for exponent in f32::MIN_EXP - 1..f32::MAX_EXP {
            let power = 2.0_f32.powi(exponent);
            assert_eq!(log2(power), exponent as f32);
            assert!(log2(power.next_up()) >= exponent as f32);
            let before_next = f32::from_bits(power.to_bits() | FRACTION);
            assert!((exponent as f32..=exponent as f32 + 1.0).contains(&log2(before_next)), "{before_next}");
        }
        assert_eq!(log2(f32::INFINITY), 128.0);
    }

    #[test]
    fn lanes_compute_the_same_bits() {
        let mut random = fastrand::Rng::with_seed(23);
        let odd = [0.0, -0.0, f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, 1e-40, -3.0];
        // Every sign and exponent, each with the smallest, a middle and the largest fractions.
        let of_exponent =
            |top: u32| [0, 1, FRACTION, FRACTION / 2].map(|fraction| f32::from_bits(top << 23 | fraction));
        let mut all: Vec<f32> = (0..512).flat_map(of_exponent).chain(odd).collect();
        all.extend(std::iter::repeat_with(|| f32::from_bits(random.u32(..))).take(100_000));
        for lanes in Lanes::all() {
            for x in all.chunks(WIDE) {
                let mut padded = [1.0; WIDE];
                padded[..x.len()].copy_from_slice(x);
                let found = on_lanes!(lanes, simd => log2_lanes(f32x16::load_array(simd, padded)).to_array());
                assert_eq!(found.map(f32::to_bits), padded.map(|x| log2(x).to_bits()), "{padded:?} {}", lanes.name());
            }
        }
    }
}
