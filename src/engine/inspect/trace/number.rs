//! Numbers as the pipeline stores them: value, type, bit pattern, and rounding error.

use std::fmt;

use serde::{Serialize, Serializer};

use super::exact::ExactNumber;

/// Number in the type in which the pipeline stores it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Single-precision float.
    F32(f32),
    /// Double-precision float.
    F64(f64),
    /// Signed 64-bit integer.
    I64(i64),
    /// Unsigned 32-bit integer.
    U32(u32),
    /// 8-bit value of a colour channel.
    U8(u8),
}

impl Number {
    /// Returns the name of the number's type, such as "f32".
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::F32(_) => "f32",
            Self::F64(_) => "f64",
            Self::I64(_) => "i64",
            Self::U32(_) => "u32",
            Self::U8(_) => "u8",
        }
    }

    /// Converts the number to f64; integers beyond 2⁵³ are rounded.
    pub(crate) fn to_f64(self) -> f64 {
        match self {
            Self::F32(value) => value.into(),
            Self::F64(value) => value,
            Self::I64(value) => value as f64,
            Self::U32(value) => value.into(),
            Self::U8(value) => value.into(),
        }
    }

    /// Whether the type is `f32` or `f64`.
    pub(crate) fn is_float(self) -> bool {
        matches!(self, Self::F32(_) | Self::F64(_))
    }

    /// Returns the exact value; `None` for NaN and the infinities.
    pub(crate) fn exact(self) -> Option<ExactNumber> {
        match self {
            Self::I64(value) => Some(ExactNumber::whole(value)),
            other => ExactNumber::from_f64(other.to_f64()),
        }
    }

    /// Returns the precision of the number's type in bits; `None` for integers, which are not rounded.
    pub(crate) fn precision(self) -> Option<u32> {
        match self {
            Self::F32(_) => Some(f32::MANTISSA_DIGITS),
            Self::F64(_) => Some(f64::MANTISSA_DIGITS),
            Self::I64(_) | Self::U32(_) | Self::U8(_) => None,
        }
    }

    /// Whether the number is a subnormal float.
    pub(crate) fn is_subnormal(self) -> bool {
        match self {
            Self::F32(value) => value.is_subnormal(),
            Self::F64(value) => value.is_subnormal(),
            Self::I64(_) | Self::U32(_) | Self::U8(_) => false,
        }
    }

    /// Whether two numbers have the same type and bit pattern.
    pub fn same_bits(self, other: Self) -> bool {
        match (self, other) {
            (Self::F32(a), Self::F32(b)) => a.to_bits() == b.to_bits(),
            (Self::F64(a), Self::F64(b)) => a.to_bits() == b.to_bits(),
            (a, b) => a == b,
        }
    }

    /// Returns the number's bit pattern in hexadecimal, with the prefix `0x`.
    pub(crate) fn bits(self) -> String {
        match self {
            Self::F32(value) => format!("0x{:08X}", value.to_bits()),
            Self::F64(value) => format!("0x{:016X}", value.to_bits()),
            Self::I64(value) => format!("0x{value:X}"),
            Self::U32(value) => format!("0x{value:08X}"),
            Self::U8(value) => format!("0x{value:02X}"),
        }
    }

    /// Returns the rounding error: the number minus the exact result, in ulps of the number's type at the magnitude of
    /// `exact`. Integer types have an ulp of 1. Returns `None` if the number is not finite.
    pub(crate) fn rounding_ulp(self, exact: &ExactNumber) -> Option<f64> {
        let error = &self.exact()? - exact;
        Some(error.shifted(-self.last_place(exact)).approximate())
    }

    /// Returns the binary exponent of the unit in the last place of this type at the magnitude of `exact`.
    fn last_place(self, exact: &ExactNumber) -> i64 {
        /// Binary exponent of the smallest positive subnormal `f32`.
        const MIN_EXPONENT_F32: i64 = -149;
        /// Binary exponent of the smallest positive subnormal `f64`.
        const MIN_EXPONENT_F64: i64 = -1074;
        let least = match self {
            Self::F32(_) => MIN_EXPONENT_F32,
            Self::F64(_) => MIN_EXPONENT_F64,
            Self::I64(_) | Self::U32(_) | Self::U8(_) => return 0,
        };
        let digits = i64::from(self.precision().unwrap_or(1)) - 1;
        exact.floor_log2().map_or(least, |magnitude| (magnitude - digits).max(least))
    }
}

/// Writes the shortest decimal text that identifies the number.
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::F32(value) => special((*value).into()).unwrap_or_else(|| format!("{value:?}")),
            Self::F64(value) => special(*value).unwrap_or_else(|| format!("{value:?}")),
            Self::I64(value) => value.to_string(),
            Self::U32(value) => value.to_string(),
            Self::U8(value) => value.to_string(),
        };
        f.write_str(&text.replace('-', "−"))
    }
}

fn special(value: f64) -> Option<String> {
    (!value.is_finite()).then(|| match value {
        _ if value.is_nan() => "NaN".to_owned(),
        _ if value > 0.0 => "∞".to_owned(),
        _ => "-∞".to_owned(),
    })
}

/// Serialises the value as a JSON number; null if it is not finite.
impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::F32(value) => value.serialize(serializer),
            Self::F64(value) => value.serialize(serializer),
            Self::I64(value) => value.serialize(serializer),
            Self::U32(value) => value.serialize(serializer),
            Self::U8(value) => value.serialize(serializer),
        }
    }
}

impl From<f32> for Number {
    fn from(value: f32) -> Self {
        Self::F32(value)
    }
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Self::F64(value)
    }
}

impl From<i64> for Number {
    fn from(value: i64) -> Self {
        Self::I64(value)
    }
}

impl From<u32> for Number {
    fn from(value: u32) -> Self {
        Self::U32(value)
    }
}

impl From<u8> for Number {
    fn from(value: u8) -> Self {
        Self::U8(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ulp_is_the_distance_between_neighbouring_floats() {
        for value in [1.0_f32, 1.5, 0.1, 3e38, 1e-40, 1e-45] {
            let exact = Number::from(value).exact().unwrap();
            assert_eq!(Number::from(value.next_up()).rounding_ulp(&exact), Some(1.0), "{value:e}");
            assert_eq!(Number::from(value.next_up() as f64).rounding_ulp(&exact).map(|ulps| ulps > 1e8), Some(true));
        }
        let third = ExactNumber::ratio(1, 3).unwrap();
        assert!(Number::from(1.0_f32 / 3.0).rounding_ulp(&third).unwrap().abs() <= 0.5);
        assert_eq!(Number::from(1_i64).rounding_ulp(&ExactNumber::ratio(3, 4).unwrap()), Some(0.25));
        assert_eq!(Number::from(f32::NAN).rounding_ulp(&third), None);
    }

    #[test]
    fn non_finite_numbers_are_written_as_symbols() {
        assert_eq!(Number::from(-f32::INFINITY).to_string(), "−∞");
        assert_eq!(Number::from(f64::NAN).to_string(), "NaN");
        assert_eq!(Number::from(-0.1_f32).to_string(), "−0.1");
        assert_eq!(Number::from(-1_i64).bits(), "0xFFFFFFFFFFFFFFFF");
    }
}
