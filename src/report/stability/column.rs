//! The columns of the report: everything that can be switched and that a class is about.

use serde::Serialize;

use super::catalogue::Family;
use super::subject::{Configuration, Weighting, depth_formats, is_published};
use crate::pipeline::settings::{Choice as _, DepthFormat};

/// One way to do it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(untagged)]
pub enum Column {
    /// A rasterizer and its arithmetic.
    Coverage(Configuration),
    /// A formula for weights and its arithmetic.
    Weights(Weighting),
    /// What the depth buffer stores.
    Depth(#[serde(serialize_with = "depth_format")] DepthFormat),
}

fn depth_format<S: serde::Serializer>(format: &DepthFormat, to: S) -> Result<S::Ok, S::Error> {
    std::collections::BTreeMap::from([("depth_format", format)]).serialize(to)
}

impl Column {
    /// All columns for classes of a family.
    pub fn of(family: Family) -> Vec<Self> {
        match family {
            Family::Coverage | Family::Mesh | Family::ClipSpace | Family::Throughput => {
                Configuration::all().into_iter().map(Self::Coverage).collect()
            }
            Family::Weights => Weighting::all().into_iter().map(Self::Weights).collect(),
            Family::Depth => depth_formats().iter().copied().map(Self::Depth).collect(),
        }
    }

    /// What is done: the rasterizer, formula or format, by its word in files.
    pub fn method(self) -> &'static str {
        match self {
            Self::Coverage(by) => by.rasterizer.id(),
            Self::Weights(by) => by.interpolation.id(),
            Self::Depth(format) => format.id(),
        }
    }

    /// What a person calls that.
    pub fn method_name(self) -> &'static str {
        match self {
            Self::Coverage(by) => by.rasterizer.name(),
            Self::Weights(by) => by.interpolation.name(),
            Self::Depth(format) => format.name(),
        }
    }

    /// The arithmetic's word in files, where there is a choice.
    pub fn arithmetic(self) -> Option<&'static str> {
        match self {
            Self::Coverage(by) => Some(by.arithmetic.id()),
            Self::Weights(by) => Some(by.arithmetic.id()),
            Self::Depth(_) => None,
        }
    }

    /// What a person calls that.
    pub fn arithmetic_name(self) -> Option<&'static str> {
        match self {
            Self::Coverage(by) => Some(by.arithmetic.name()),
            Self::Weights(by) => Some(by.arithmetic.name()),
            Self::Depth(_) => None,
        }
    }

    /// Whether it is commonly published with faults, and kept so.
    pub fn is_published(self) -> bool {
        match self {
            Self::Coverage(by) => by.rasterizer.is_published(),
            Self::Weights(by) => is_published(by.interpolation),
            Self::Depth(_) => false,
        }
    }

    /// Both words.
    pub fn label(self) -> String {
        self.arithmetic().map_or_else(|| self.method().to_owned(), |numbers| format!("{} · {numbers}", self.method()))
    }
}
