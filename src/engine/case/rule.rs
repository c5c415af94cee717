//! Serialization of fill rules in case files, where their names contain `_` instead of `-`.

use serde::de::Error as _;
use serde::{Deserialize as _, Deserializer, Serializer};

use crate::pipeline::settings::{Choice as _, FillRule};

pub(crate) fn serialize<S: Serializer>(rule: &FillRule, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&rule.id().replace('-', "_"))
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<FillRule, D::Error> {
    let word = String::deserialize(deserializer)?.replace('_', "-");
    let rule = FillRule::ALL.iter().copied().find(|rule| rule.id() == word);
    rule.ok_or_else(|| D::Error::custom(format!("`{word}` is not a fill rule")))
}
