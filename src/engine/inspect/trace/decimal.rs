//! Exact numbers as text: decimals and short fractions.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed as _, Zero as _};

use super::exact::ExactNumber;

/// Maximum total number of digits in the numerator and denominator of a fraction that is shown.
const SHORT_DIGITS: usize = 12;

/// Maximum total number of bits in the numerator and denominator of a fraction that is worth reducing.
const SHORT_BITS: u64 = 256;

impl ExactNumber {
    /// Returns the number as decimal text with at most `significant` digits, and whether the text is exact. Further
    /// digits are truncated.
    pub(crate) fn decimal(&self, significant: u32) -> (String, bool) {
        /// Range of decimal exponents that are written without exponent notation.
        const PLAIN: std::ops::Range<i64> = -6..22;
        let Some(magnitude) = self.floor_log2() else { return ("0".to_owned(), true) };
        let significant = i64::from(significant);
        let mut exponent = (magnitude as f64 * std::f64::consts::LOG10_2).floor() as i64;
        let (mut digits, mut complete) = self.digits(significant - 1 - exponent);
        if digits.len() as i64 > significant {
            exponent += 1;
            (digits, complete) = self.digits(significant - 1 - exponent);
        }
        let sign = if *self < Self::whole(0) { "−" } else { "" };
        let digits = if complete { digits.trim_end_matches('0') } else { &digits };
        let mark = if complete { "" } else { "…" };
        // Truncated digits before the decimal point are unknown, so exponent notation is necessary.
        let hides_whole = !complete && exponent >= significant;
        let text = if hides_whole || !PLAIN.contains(&exponent) {
            let (first, rest) = digits.split_at(1);
            let point = if rest.is_empty() { "" } else { "." };
            format!("{first}{point}{rest}{mark}e{}", exponent.to_string().replace('-', "−"))
        } else if exponent < 0 {
            format!("0.{}{digits}{mark}", "0".repeat((-exponent - 1) as usize))
        } else {
            let before = exponent as usize + 1;
            let padded = format!("{digits:0<before$}");
            let (whole, rest) = padded.split_at(before);
            let point = if rest.is_empty() && complete { "" } else { "." };
            format!("{whole}{point}{rest}{mark}")
        };
        (format!("{sign}{text}"), complete)
    }

    /// Returns the digits of the integer part of |x| · 10^`power` for the number x, and whether the remainder is zero.
    fn digits(&self, power: i64) -> (String, bool) {
        let (mut numerator, mut denominator) = self.parts();
        let ten = BigInt::from(10).pow(power.unsigned_abs() as u32);
        if power >= 0 {
            numerator *= ten;
        } else {
            denominator *= ten;
        }
        let numerator = numerator.abs();
        let whole = &numerator / &denominator;
        let complete = (numerator - &whole * denominator).is_zero();
        (whole.to_string(), complete)
    }

    /// Returns the number as a fraction, such as "1/3"; `None` if the text is long or the number is an integer.
    pub(crate) fn short_fraction(&self) -> Option<String> {
        let (numerator, denominator) = self.parts();
        if numerator.bits() + denominator.bits() > SHORT_BITS {
            return None;
        }
        let shortest = BigRational::new(numerator, denominator);
        let text = shortest.to_string();
        (!shortest.is_integer() && text.len() <= SHORT_DIGITS + 1).then(|| text.replace('-', "−"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(value: f64) -> ExactNumber {
        ExactNumber::from_f64(value).unwrap()
    }

    #[test]
    fn truncated_decimals_are_marked_with_an_ellipsis() {
        let third = ExactNumber::ratio(1, 3).unwrap();
        assert_eq!(third.decimal(5), ("0.33333…".to_owned(), false));
        assert_eq!(third.short_fraction(), Some("1/3".to_owned()));
        assert_eq!(exact(-0.125).decimal(5), ("−0.125".to_owned(), true));
        assert_eq!(exact(1234.5).decimal(20), ("1234.5".to_owned(), true));
        assert_eq!(exact(1200.0).decimal(20), ("1200".to_owned(), true));
        assert_eq!(exact(1200.0).short_fraction(), None);
        assert_eq!(exact(1e-30).decimal(3).0, "1.00…e−30");
        assert_eq!(exact(0.1).decimal(20).0, "0.10000000000000000555…");
        assert_eq!(ExactNumber::whole(999_999).decimal(3), ("9.99…e5".to_owned(), false));
    }
}
