//! State of an open case, which is shown in place of the scene.

use std::path::Path;
use std::sync::Arc;

use super::session::{Session, Severity};
use crate::case::Case;
use crate::pipeline::settings::Settings;
use crate::report::stability::column::ReportColumn;

/// Case that is shown in place of the scene.
#[derive(Clone, Debug)]
pub(crate) struct OpenCase {
    /// Contents of the case file.
    pub(crate) case: Arc<Case>,
    /// Index of the shown part of the case, such as one of its triangles.
    pub(crate) part: usize,
    /// Settings to restore on closing; `None` if the case was opened with the current settings.
    pub(crate) settings_before: Option<Settings>,
}

impl OpenCase {
    /// Opens a case at its first part.
    pub(crate) fn new(case: Arc<Case>) -> Self {
        Self { case, part: 0, settings_before: None }
    }
}

impl Session {
    /// Shows a test case in place of the scene. The scene stays loaded, and a previously open case is closed.
    pub(crate) fn show_case(&mut self, case: impl Into<Arc<Case>>) {
        let case = case.into();
        self.close_case();
        self.report(Severity::Info, format!("Opened case {}", case.id));
        self.error = None;
        self.case = Some(OpenCase::new(case));
    }

    /// Shows `json`, the worst case of a cell of the stability report, and applies the settings of the cell's column.
    pub(super) fn open_worst(&mut self, column: ReportColumn, json: &str) {
        let case = match Case::parse(json.as_bytes(), Path::new("worst case")) {
            Ok(case) => case,
            Err(error) => return self.report(Severity::Error, error.to_string()),
        };
        self.show_case(case);
        let settings = &mut self.state.recipe.pipeline;
        let before = *settings;
        match column {
            ReportColumn::Coverage(by) => (settings.rasterizer, settings.arithmetic) = (by.rasterizer, by.arithmetic),
            ReportColumn::Weights(by) => settings.arithmetic = by.arithmetic,
            ReportColumn::Depth(format) => settings.depth_format = format,
        }
        self.case.iter_mut().for_each(|open| open.settings_before = Some(before));
    }

    /// Closes the open case and restores the settings that were in use before it was opened.
    pub(super) fn close_case(&mut self) {
        if let Some(OpenCase { settings_before: Some(before), .. }) = self.case.take() {
            let Settings { rasterizer, arithmetic, depth_format, .. } = before;
            self.state.recipe.pipeline =
                Settings { rasterizer, arithmetic, depth_format, ..self.state.recipe.pipeline };
        }
    }
}
