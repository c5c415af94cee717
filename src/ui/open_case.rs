//! A case file that is open instead of the scene.

use std::path::Path;
use std::sync::Arc;

use crate::case::{Case, CaseError};
use crate::pipeline::settings::Settings;
use crate::report::stability::column::Column;

/// A case that is open.
#[derive(Clone, Debug)]
pub struct OpenCase {
    /// The case.
    pub case: Arc<Case>,
    /// Which of its parts is shown.
    pub part: usize,
    /// The settings that come back when it is closed, if it was opened with others.
    pub settings_before: Option<Settings>,
}

impl OpenCase {
    /// Opens a case at its first part.
    pub fn new(case: Case) -> Self {
        Self { case: Arc::new(case), part: 0, settings_before: None }
    }
}

/// The case that went worst in a column of the stability report, and the settings changed to those of the column.
pub fn worst(column: Column, json: &str, settings: &Settings) -> Result<(Case, Settings), CaseError> {
    let case = Case::parse(json.as_bytes(), Path::new("worst case"))?;
    let mut settings = *settings;
    match column {
        Column::Coverage(by) => (settings.rasterizer, settings.arithmetic) = (by.rasterizer, by.arithmetic),
        Column::Weights(by) => settings.arithmetic = by.arithmetic,
        Column::Depth(format) => settings.depth_format = format,
    }
    Ok((case, settings))
}
