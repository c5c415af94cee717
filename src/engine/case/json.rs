//! JSON building blocks of cases: numbers within range and lists of a fixed length.

use std::array;
use std::fmt;
use std::marker::PhantomData;

use glam::DVec2;
use serde::de::{Error as _, IgnoredAny, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::image::Image;

/// Number within the range of 32-bit floats: 0, or a magnitude from 2⁻¹⁴⁹ to `f32::MAX`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct Real(pub(crate) f64);

impl TryFrom<f64> for Real {
    type Error = String;

    fn try_from(number: f64) -> Result<Self, String> {
        within_range(number).map(Self)
    }
}

fn within_range(number: f64) -> Result<f64, String> {
    /// Smallest positive subnormal, 2⁻¹⁴⁹.
    const LEAST: f32 = f32::from_bits(1);
    let range = f64::from(LEAST)..=f64::from(f32::MAX);
    if number == 0.0 || range.contains(&number.abs()) {
        Ok(number)
    } else {
        Err(format!("{number:e} lies outside the range of 32-bit floats"))
    }
}

/// Strings that represent the `f32` values that JSON numbers cannot express.
const WORDS: [(&str, f32); 3] = [("NaN", f32::NAN), ("Infinity", f32::INFINITY), ("-Infinity", f32::NEG_INFINITY)];

/// Any 32-bit float: a number in the range of [`Real`], rounded to the nearest f32, or one of the strings `NaN`,
/// `Infinity` and `-Infinity`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Float(pub(crate) f32);

impl<'de> Deserialize<'de> for Float {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FloatVisitor)
    }
}

impl Serialize for Float {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let same = |word: f32| word == self.0 || (word.is_nan() && self.0.is_nan());
        match WORDS.iter().find(|(_, value)| same(*value)) {
            Some((word, _)) => serializer.serialize_str(word),
            // Written as f64 to preserve all digits of the exact value.
            None => serializer.serialize_f64(self.0.into()),
        }
    }
}

struct FloatVisitor;

impl Visitor<'_> for FloatVisitor {
    type Value = Float;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, \"NaN\", \"Infinity\" or \"-Infinity\"")
    }

    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Float, E> {
        within_range(number).map(|number| Float(number as f32)).map_err(E::custom)
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<Float, E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<Float, E> {
        self.visit_f64(number as f64)
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Float, E> {
        let word = WORDS.iter().find(|(word, _)| *word == text);
        word.map(|(_, value)| Float(*value)).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
    }
}

/// Point in two dimensions, written as [x, y].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "Exactly<Real, 2>")]
pub(crate) struct Point(pub(crate) DVec2);

impl From<Exactly<Real, 2>> for Point {
    fn from(Exactly([x, y]): Exactly<Real, 2>) -> Self {
        Self(DVec2::new(x.0, y.0))
    }
}

/// List of exactly `N` values. Deserializing a list of any other length returns an error with both lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Exactly<T, const N: usize>(pub(crate) [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(ExactlyVisitor(PhantomData))
    }
}

struct ExactlyVisitor<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for ExactlyVisitor<T, N> {
    type Value = Exactly<T, N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list of {N}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut values: [Option<T>; N] = array::from_fn(|_| None);
        let mut length = 0;
        while length < N
            && let Some(value) = list.next_element()?
        {
            values[length] = Some(value);
            length += 1;
        }
        while list.next_element::<IgnoredAny>()?.is_some() {
            length += 1;
        }
        let wrong_length = || A::Error::invalid_length(length, &self);
        if length > N {
            return Err(wrong_length());
        }
        let values: Option<Vec<T>> = values.into_iter().collect();
        values.and_then(|values| values.try_into().ok()).map(Exactly).ok_or_else(wrong_length)
    }
}

/// Deserializes an image from a list of rows. Returns an error if the rows differ in length, or if there is no value.
pub(super) fn rows<'de, D: Deserializer<'de>, T: Copy + Deserialize<'de>>(
    deserializer: D,
) -> Result<Image<T>, D::Error> {
    let rows = Vec::<Vec<T>>::deserialize(deserializer)?;
    let width = rows.first().map_or(0, Vec::len);
    if width == 0 || rows.iter().any(|row| row.len() != width) {
        return Err(D::Error::custom("rows must have equal length, with at least one row of at least one value"));
    }
    let sides = u32::try_from(width).ok().zip(u32::try_from(rows.len()).ok());
    let (width, height) = sides.ok_or_else(|| D::Error::custom("the number of values is too large"))?;
    Ok(Image::from_pixels(width, height, rows.concat()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error<T: for<'de> Deserialize<'de>>(json: &str) -> String {
        serde_json::from_str::<T>(json).err().unwrap().to_string()
    }

    #[test]
    fn lists_of_another_length_are_refused_with_both_lengths() {
        let Exactly(values) = serde_json::from_str::<Exactly<u8, 3>>("[1, 2, 3]").unwrap();
        assert_eq!(values, [1, 2, 3]);
        for (json, length) in [("[]", 0), ("[1, 2]", 2), ("[1, 2, 3, 4]", 4), ("[1, 2, 3, [], {}]", 5)] {
            let message = error::<Exactly<u8, 3>>(json);
            assert!(message.starts_with(&format!("invalid length {length}, expected a list of 3")), "{message}");
        }
        assert!(error::<Exactly<u8, 3>>("7").starts_with("invalid type: integer `7`, expected a list of 3"));
    }

    #[test]
    fn numbers_must_be_within_the_range_of_32_bit_floats() {
        for number in [0.0, -0.0, 1.5, f32::MAX.into(), -f64::from(f32::MAX), f64::from(f32::from_bits(1))] {
            assert_eq!(serde_json::from_str::<Real>(&format!("{number:?}")).unwrap().0, number);
        }
        for number in ["1e39", "-1e300", "1e-46"] {
            assert!(error::<Real>(number).contains("32-bit"), "{number}");
        }
        assert!(error::<Real>("1e999").starts_with("number out of range"));
    }

    #[test]
    fn every_float_is_read_as_it_was_written() {
        let mut rng = fastrand::Rng::with_seed(3);
        let special =
            [0.0, -0.0, f32::MAX, f32::MIN_POSITIVE, f32::from_bits(1), f32::INFINITY, -f32::INFINITY, f32::NAN];
        for value in special.into_iter().chain((0..10_000).map(|_| f32::from_bits(rng.u32(..)))) {
            let text = serde_json::to_string(&Float(value)).unwrap();
            let Float(read) = serde_json::from_str(&text).unwrap();
            assert!(read.to_bits() == value.to_bits() || (read.is_nan() && value.is_nan()), "{value:?}: {text}");
        }
        assert_eq!(serde_json::from_str::<Vec<Float>>("[1, -2, 0.1]").unwrap(), [1.0, -2.0, 0.1].map(Float));
        for wrong in ["\"nan\"", "\"1\"", "null", "[1]", "true"] {
            let message = error::<Float>(wrong);
            assert!(message.contains("expected a number, \"NaN\", \"Infinity\" or \"-Infinity\""), "{message}");
        }
        assert!(error::<Float>("1e39").contains("32-bit"));
    }

    #[test]
    fn rows_of_unequal_length_are_refused() {
        let rows = |json: &str| rows::<_, u8>(&mut serde_json::Deserializer::from_str(json));
        assert_eq!(rows("[[1, 2, 3], [4, 5, 6]]").unwrap(), Image::from_pixels(3, 2, vec![1, 2, 3, 4, 5, 6]));
        for json in ["[]", "[[]]", "[[1], [1, 2]]", "[[1], []]"] {
            assert!(rows(json).unwrap_err().to_string().contains("rows must have equal length"), "{json}");
        }
    }
}
