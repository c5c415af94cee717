//! Number format of case files: exact f32 values with all digits, and strings for values that JSON cannot represent.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

use crate::case::Float;

/// Conversion of numbers and lists of numbers to and from JSON.
pub(super) trait Wire: Sized {
    /// Converts the value to JSON.
    fn write(&self) -> Value;

    /// Converts a value from JSON, or returns a description of the error.
    fn read(value: &Value) -> Result<Self, String>;
}

impl Wire for f32 {
    fn write(&self) -> Value {
        // Serialising a number or string cannot fail.
        serde_json::to_value(Float(*self)).unwrap_or_default()
    }

    fn read(value: &Value) -> Result<Self, String> {
        Float::deserialize(value).map(|float| float.0).map_err(|e| e.to_string())
    }
}

impl<T: Wire> Wire for Option<T> {
    fn write(&self) -> Value {
        self.as_ref().map_or(Value::Null, T::write)
    }

    fn read(value: &Value) -> Result<Self, String> {
        if value.is_null() { Ok(None) } else { T::read(value).map(Some) }
    }
}

impl<T: Wire> Wire for Vec<T> {
    fn write(&self) -> Value {
        self.iter().map(T::write).collect()
    }

    fn read(value: &Value) -> Result<Self, String> {
        value.as_array().ok_or_else(|| format!("{value} is not a list"))?.iter().map(T::read).collect()
    }
}

impl<T: Wire, const N: usize> Wire for [T; N] {
    fn write(&self) -> Value {
        self.iter().map(T::write).collect()
    }

    fn read(value: &Value) -> Result<Self, String> {
        Vec::read(value)?.try_into().map_err(|list: Vec<T>| format!("expected {N} entries, found {}", list.len()))
    }
}

/// Serialises a value to the number format, for serde's `serialize_with`.
pub(super) fn serialize<T: Wire, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.write().serialize(serializer)
}

/// Deserialises a value from the number format, for serde's `deserialize_with`.
pub(super) fn deserialize<'de, T: Wire, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::read(&Value::deserialize(deserializer)?).map_err(D::Error::custom)
}

/// Serialisation of vertices as JSON objects with the fields x, y, z, w, u and v.
pub(super) mod corners {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::super::oracle::ScreenCorner;

    #[derive(Serialize, Deserialize)]
    struct WireCorner {
        #[serde(serialize_with = "super::serialize", deserialize_with = "super::deserialize")]
        x: f32,
        #[serde(serialize_with = "super::serialize", deserialize_with = "super::deserialize")]
        y: f32,
        #[serde(serialize_with = "super::serialize", deserialize_with = "super::deserialize")]
        z: f32,
        #[serde(serialize_with = "super::serialize", deserialize_with = "super::deserialize")]
        w: f32,
        #[serde(serialize_with = "super::serialize", deserialize_with = "super::deserialize")]
        u: f32,
        #[serde(serialize_with = "super::serialize", deserialize_with = "super::deserialize")]
        v: f32,
    }

    pub(in super::super) fn serialize<S: Serializer>(corners: &[ScreenCorner; 3], to: S) -> Result<S::Ok, S::Error> {
        let written = |&ScreenCorner { x, y, z, w, uv: [u, v] }: &ScreenCorner| WireCorner { x, y, z, w, u, v };
        corners.each_ref().map(written).serialize(to)
    }

    pub(in super::super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[ScreenCorner; 3], D::Error> {
        let read = <[WireCorner; 3]>::deserialize(from)?;
        Ok(read.map(|WireCorner { x, y, z, w, u, v }| ScreenCorner { x, y, z, w, uv: [u, v] }))
    }
}
