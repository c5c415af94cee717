//! State that the panels “Frame time” and “Error vs time” share: the order and the filter of the rows, the checked rows,
//! the method under the pointer, and the time budget.

use std::collections::{BTreeSet, VecDeque};

use super::TimingsView;
use crate::measure::metric::Metric;
use crate::measure::motion::Turn;
use crate::ui::session::workspace::Panel;
use crate::upscale::{Scale, Upscaling};

/// Maximum number of checked rows, so that the lines of their plot can be told apart.
pub(crate) const MAX_CHECKED: usize = 5;

/// Order of the rows of the panel “Frame time”.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum RowOrder {
    /// Shortest median time first.
    #[default]
    Time,
    /// Lowest FLIP error first; rows without a measured error come last.
    Error,
    /// Menu order of the methods, in ascending order of their scales.
    Method,
}

impl RowOrder {
    /// All orders, each with its display name and help text.
    pub(crate) const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Time, "Time", "Sort by median time, fastest first"),
        (Self::Error, "Error", "Sort by mean FLIP error, lowest first"),
        (Self::Method, "Method", "Group by method, each in ascending order of its scales"),
    ];
}

/// Change to the plots of frame times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimingsChange {
    /// Sets the kind of plot of single frames.
    View(TimingsView),
    /// Sets whether measurements start by themselves.
    Automatic(bool),
    /// Sets the order of the rows.
    Order(RowOrder),
    /// Shows or hides the rows of a scale.
    ToggleScale(Scale),
    /// Checks or unchecks the row of an upscaler.
    ToggleChecked(Upscaling),
    /// Sets the upscaler under the pointer in a panel; `None` if the pointer is on none.
    Hover(Panel, Option<Upscaling>),
    /// Sets the time budget, in milliseconds.
    Budget(f64),
    /// Sets the camera motion for the next measurement of the upscalers.
    Turn(Turn),
    /// Sets the metric that ranks the upscalers.
    Metric(Metric),
    /// Pauses or resumes the recording of recent frame times.
    TogglePaused,
    /// Exports all frame times to a CSV file.
    Export,
    /// Clears all frame times.
    Clear,
}

/// State that the panels “Frame time” and “Error vs time” share.
#[derive(Clone, Debug, Default)]
pub(crate) struct MethodList {
    /// Order of the rows.
    pub(crate) order: RowOrder,
    /// Time budget that the user has set, in milliseconds; `None` for the default.
    pub(super) budget_ms: Option<f64>,
    hidden_scales: BTreeSet<Scale>,
    /// Upscalers whose rows are checked, oldest first.
    checked: VecDeque<Upscaling>,
    hovered: Option<(Panel, Upscaling)>,
}

impl MethodList {
    /// Whether rows of this scale are shown.
    pub(crate) fn shows_scale(&self, scale: Scale) -> bool {
        !self.hidden_scales.contains(&scale)
    }

    /// Whether the row of an upscaler is shown. Native rendering is always shown, as the reference.
    pub(crate) fn shows(&self, upscaling: Upscaling) -> bool {
        upscaling.is_native() || self.shows_scale(upscaling.scale())
    }

    /// Whether the row of an upscaler is checked.
    pub(crate) fn is_checked(&self, upscaling: Upscaling) -> bool {
        self.checked.contains(&upscaling)
    }

    /// Returns the upscaler under the pointer, in whichever panel the pointer is.
    pub(crate) fn hovered(&self) -> Option<Upscaling> {
        self.hovered.map(|(_, upscaling)| upscaling)
    }

    /// Returns the change that reports `upscaling` as the one under the pointer in `panel`; `None` if nothing changes.
    /// A panel without the pointer does not clear what another panel has reported.
    pub(crate) fn hover_change(&self, panel: Panel, upscaling: Option<Upscaling>) -> Option<TimingsChange> {
        let reported = self.hovered.filter(|(by, _)| *by == panel || upscaling.is_some());
        let before = reported.map(|(_, before)| before);
        (before != upscaling).then_some(TimingsChange::Hover(panel, upscaling))
    }

    /// Returns whether the single frames of an upscaler are plotted: those of the checked rows and of the row under the
    /// pointer, or of `current` if there are neither.
    pub(crate) fn plots_frames_of(&self, upscaling: Upscaling, current: Upscaling) -> bool {
        let is_chosen = self.is_checked(upscaling) || self.hovered() == Some(upscaling);
        let is_fallback = self.checked.is_empty() && self.hovered.is_none() && upscaling == current;
        is_chosen || is_fallback
    }

    pub(super) fn toggle_scale(&mut self, scale: Scale) {
        if !self.hidden_scales.remove(&scale) {
            self.hidden_scales.insert(scale);
        }
    }

    /// Checks or unchecks a row. If too many rows would be checked, unchecks the one that was checked first.
    pub(super) fn toggle_checked(&mut self, upscaling: Upscaling) {
        if self.is_checked(upscaling) {
            self.checked.retain(|checked| *checked != upscaling);
            return;
        }
        if self.checked.len() == MAX_CHECKED {
            self.checked.pop_front();
        }
        self.checked.push_back(upscaling);
    }

    pub(super) fn set_hovered(&mut self, panel: Panel, upscaling: Option<Upscaling>) {
        self.hovered = upscaling.map(|upscaling| (panel, upscaling));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sixth_check_mark_removes_the_oldest() {
        let mut list = MethodList::default();
        let methods: Vec<_> = Upscaling::every().take(MAX_CHECKED + 1).collect();
        methods.iter().for_each(|method| list.toggle_checked(*method));
        assert!(list.checked.iter().eq(&methods[1..]));
        list.toggle_checked(methods[2]);
        assert!(!list.is_checked(methods[2]) && list.checked.len() == MAX_CHECKED - 1);
        list.toggle_checked(methods[0]);
        assert_eq!(list.checked.back(), Some(&methods[0]), "it is the newest again");
    }

    #[test]
    fn hidden_scales_do_not_hide_native() {
        let mut list = MethodList::default();
        let [nearest, checkerboard] =
            [("nearest", 2), ("checkerboard", 1)].map(|(id, scale)| Upscaling::new(id, scale).unwrap());
        list.toggle_scale(Scale::ONE);
        assert!(list.shows(Upscaling::NATIVE) && list.shows(nearest) && !list.shows(checkerboard));
        list.toggle_scale(Scale::TWO);
        assert!(!list.shows(nearest));
        list.toggle_scale(Scale::ONE);
        assert!(list.shows(checkerboard) && !list.shows(nearest));
    }

    #[test]
    fn frames_of_the_current_method_are_plotted_until_another_is_chosen() {
        let mut list = MethodList::default();
        let [native, nearest] = [Upscaling::NATIVE, Upscaling::new("nearest", 2).unwrap()];
        assert!(list.plots_frames_of(native, native) && !list.plots_frames_of(nearest, native));
        list.set_hovered(Panel::FrameTime, Some(nearest));
        assert!(!list.plots_frames_of(native, native) && list.plots_frames_of(nearest, native));
        list.set_hovered(Panel::FrameTime, None);
        list.toggle_checked(nearest);
        assert!(!list.plots_frames_of(native, native) && list.plots_frames_of(nearest, native));
    }

    #[test]
    fn a_panel_clears_only_what_it_has_reported() {
        use Panel::{ErrorTime, FrameTime};
        let mut list = MethodList::default();
        let native = Some(Upscaling::NATIVE);
        assert_eq!(list.hover_change(FrameTime, None), None);
        assert_eq!(list.hover_change(FrameTime, native), Some(TimingsChange::Hover(FrameTime, native)));
        list.set_hovered(FrameTime, native);
        assert_eq!(list.hover_change(FrameTime, native), None);
        assert_eq!(list.hover_change(ErrorTime, None), None);
        assert_eq!(list.hover_change(FrameTime, None), Some(TimingsChange::Hover(FrameTime, None)));
    }
}
