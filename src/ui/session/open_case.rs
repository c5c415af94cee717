//! State of an open case, which is shown in place of the scene.

use std::path::Path;
use std::sync::Arc;

use super::{Session, Severity};
use crate::case::{Case, Options};
use crate::report::stability::column::ReportColumn;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

/// Case that is shown in place of the scene.
#[derive(Clone, Debug)]
pub(crate) struct OpenCase {
    /// Contents of the case file.
    pub(crate) case: Arc<Case>,
    /// Index of the shown part of the case, such as one of its triangles.
    pub(crate) part: usize,
    /// Rasterizer and arithmetic that only this case uses; `None` to use those of the recipe.
    pub(crate) own_options: Option<Options>,
}

impl OpenCase {
    /// Opens a case at its first part.
    pub(crate) fn new(case: Arc<Case>) -> Self {
        Self { case, part: 0, own_options: None }
    }
}

/// Change to the open case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CaseChange {
    /// Closes the open case.
    Close,
    /// Shows the part with this index.
    Part(usize),
    /// Sets the rasterizer and the arithmetic with which the case is evaluated.
    Options(Options),
    /// Opens the worst case of a cell of the stability report, with the rasterizer and the arithmetic of the cell's
    /// column. The string is the case as JSON.
    Worst(ReportColumn, String),
}

impl Feature for Option<OpenCase> {
    type Change = CaseChange;

    fn apply(session: &mut Session, change: CaseChange) -> Option<WindowTask> {
        match change {
            CaseChange::Close => session.close_case(),
            CaseChange::Part(part) => session.features.case.iter_mut().for_each(|open| open.part = part),
            CaseChange::Options(options) => session.set_case_options(options),
            CaseChange::Worst(column, json) => session.open_worst(column, &json),
        }
        None
    }

    fn leave_scene(&mut self) {
        *self = None;
    }
}

impl Session {
    /// Shows a test case in place of the scene. The scene stays loaded, and a previously open case is closed.
    pub(crate) fn show_case(&mut self, case: impl Into<Arc<Case>>) {
        let case = case.into();
        self.close_case();
        self.report(Severity::Info, format!("Opened case {}", case.id));
        self.features.messages.error = None;
        self.features.case = Some(OpenCase::new(case));
    }

    /// Shows `json`, the worst case of a cell of the stability report, with the rasterizer and the arithmetic of the
    /// cell's column. The recipe stays as it is.
    fn open_worst(&mut self, column: ReportColumn, json: &str) {
        let case = match Case::parse(json.as_bytes(), Path::new("worst case")) {
            Ok(case) => case,
            Err(error) => return self.report(Severity::Error, error.to_string()),
        };
        self.show_case(case);
        let of_recipe = self.recipe_options();
        let own_options = match column {
            ReportColumn::Coverage(by) => Some(Options { rasterizer: by.rasterizer, arithmetic: by.arithmetic }),
            ReportColumn::Weights(by) => Some(Options { arithmetic: by.arithmetic, ..of_recipe }),
            // The case itself contains the depth format.
            ReportColumn::Depth(_) => None,
        };
        self.features.case.iter_mut().for_each(|open| open.own_options = own_options);
    }

    fn recipe_options(&self) -> Options {
        let settings = &self.state.recipe.pipeline;
        Options { rasterizer: settings.rasterizer, arithmetic: settings.arithmetic }
    }

    /// Returns the rasterizer and the arithmetic with which `open` is evaluated.
    pub(crate) fn options_of(&self, open: &OpenCase) -> Options {
        open.own_options.unwrap_or_else(|| self.recipe_options())
    }

    /// Sets the rasterizer and the arithmetic of the open case. Changes the recipe if the case has no options of its
    /// own.
    fn set_case_options(&mut self, options: Options) {
        match &mut self.features.case {
            Some(OpenCase { own_options: Some(own), .. }) => *own = options,
            Some(_) => {
                let settings = &mut self.state.recipe.pipeline;
                (settings.rasterizer, settings.arithmetic) = (options.rasterizer, options.arithmetic);
            }
            None => {}
        }
    }

    /// Closes the open case.
    pub(super) fn close_case(&mut self) {
        self.features.case = None;
    }
}
