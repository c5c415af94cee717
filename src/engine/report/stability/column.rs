//! Columns of the stability report: one for each configuration of the engine.

use serde::Serialize;

use super::catalogue::Family;
use super::subject::{Configuration, Weighting, depth_formats, is_published};
use crate::pipeline::settings::{Choice as _, DepthFormat};

/// A configuration of the engine, one column of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(untagged)]
pub enum ReportColumn {
    /// Rasterizer and the arithmetic that it uses.
    Coverage(Configuration),
    /// Interpolation formula and the arithmetic that it uses.
    Weights(Weighting),
    /// Depth buffer format.
    Depth(#[serde(serialize_with = "depth_format")] DepthFormat),
}

fn depth_format<S: serde::Serializer>(format: &DepthFormat, to: S) -> Result<S::Ok, S::Error> {
    std::collections::BTreeMap::from([("depth_format", format)]).serialize(to)
}

impl ReportColumn {
    /// Returns all columns for the classes of a family.
    pub(crate) fn of(family: Family) -> Vec<Self> {
        match family {
            Family::Coverage | Family::Mesh | Family::ClipSpace | Family::Throughput => {
                Configuration::all().into_iter().map(Self::Coverage).collect()
            }
            Family::Weights => Weighting::all().into_iter().map(Self::Weights).collect(),
            Family::Depth => depth_formats().iter().copied().map(Self::Depth).collect(),
        }
    }

    /// Returns the id of the rasterizer, formula or format.
    pub fn method(self) -> &'static str {
        match self {
            Self::Coverage(by) => by.rasterizer.id(),
            Self::Weights(by) => by.interpolation.id(),
            Self::Depth(format) => format.id(),
        }
    }

    /// Returns the display name of the rasterizer, formula or format.
    pub fn method_name(self) -> &'static str {
        match self {
            Self::Coverage(by) => by.rasterizer.name(),
            Self::Weights(by) => by.interpolation.name(),
            Self::Depth(format) => format.name(),
        }
    }

    /// Returns the id of the arithmetic; `None` for depth formats.
    pub fn arithmetic(self) -> Option<&'static str> {
        match self {
            Self::Coverage(by) => Some(by.arithmetic.id()),
            Self::Weights(by) => Some(by.arithmetic.id()),
            Self::Depth(_) => None,
        }
    }

    /// Returns the display name of the arithmetic; `None` for depth formats.
    pub(crate) fn arithmetic_name(self) -> Option<&'static str> {
        match self {
            Self::Coverage(by) => Some(by.arithmetic.name()),
            Self::Weights(by) => Some(by.arithmetic.name()),
            Self::Depth(_) => None,
        }
    }

    /// Returns whether the method is implemented as commonly published, with its faults.
    pub(crate) fn is_published(self) -> bool {
        match self {
            Self::Coverage(by) => by.rasterizer.is_published(),
            Self::Weights(by) => is_published(by.interpolation),
            Self::Depth(_) => false,
        }
    }

    /// Returns the ids of the method and the arithmetic, such as "tiled · f64".
    pub fn label(self) -> String {
        self.arithmetic().map_or_else(|| self.method().to_owned(), |numbers| format!("{} · {numbers}", self.method()))
    }
}
