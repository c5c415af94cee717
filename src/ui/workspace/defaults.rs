//! Default layout of each workspace.

use crate::pipeline::settings::Choice as _;
use crate::ui::session::layout::{Layout, Part};
use crate::ui::session::workspace::{Panel, Workspace};

/// Default height of the stages above the panels that explain a pixel, in points.
const STAGES_HEIGHT: f32 = 360.0;

/// Default width of the panels beside compared pictures, in points: their four tabs fit into it.
const COMPARED_WIDTH: f32 = 352.0;

/// Default width of the stages and of the panels below them that explain a pixel, in points.
const STAGES_WIDTH: f32 = 260.0;

/// Default width of the picture beside the panels about robustness, in points.
const BESIDE_WIDTH: f32 = 480.0;

/// Default height of the panels below the picture, in points.
const BELOW_HEIGHT: f32 = 250.0;

/// Size of panels that take the remaining space; only its ratio to others of this size counts.
const REST: f32 = 400.0;

impl Workspace {
    /// Returns the default layout.
    pub(super) fn default_layout(self) -> Layout {
        match self {
            // Both groups of panels are on one side, so that a picture in 16:9 fills most of the canvas.
            Self::Inspect => Layout::Row(vec![
                part(Layout::Panel(Panel::Picture), REST),
                part(
                    Layout::Column(vec![
                        part(tabs(&[Panel::Stages, Panel::Histogram]), STAGES_HEIGHT),
                        part(tabs(&[Panel::Pixel, Panel::Calculation, Panel::Watch]), REST),
                    ]),
                    STAGES_WIDTH,
                ),
            ]),
            Self::Geometry => Layout::Column(vec![
                part(
                    Layout::Row(vec![
                        part(Layout::Panel(Panel::Picture), REST),
                        part(Layout::Panel(Panel::MeshView), REST),
                    ]),
                    REST,
                ),
                part(tabs(&[Panel::TriangleFates, Panel::Vertices]), BELOW_HEIGHT),
            ]),
            Self::Compare => Layout::Row(vec![
                part(
                    Layout::Column(vec![
                        part(Layout::Panel(Panel::Picture), REST),
                        part(tabs(&[Panel::FilterTaps, Panel::OverTime]), BELOW_HEIGHT),
                    ]),
                    REST,
                ),
                part(tabs(&[Panel::Stages, Panel::Pixel, Panel::PictureFiles, Panel::OtherRenderer]), COMPARED_WIDTH),
            ]),
            Self::Measure => tabs(&[
                Panel::FrameTime,
                Panel::ErrorTime,
                Panel::OverTime,
                Panel::Scaling,
                Panel::SkippedWork,
                Panel::Log,
            ]),
            Self::Robustness => Layout::Row(vec![
                part(tabs(&[Panel::Stability, Panel::Probe, Panel::Assertions]), REST),
                part(
                    Layout::Column(vec![
                        part(Layout::Panel(Panel::Picture), REST),
                        part(tabs(&[Panel::Pixel]), BELOW_HEIGHT),
                    ]),
                    BESIDE_WIDTH,
                ),
            ]),
            Self::Lab => Layout::Panel(Panel::Lab),
        }
    }

    /// Whether the panels around the picture are hidden by default.
    pub(super) fn hides_panels(self) -> bool {
        match self {
            Self::Compare => true,
            Self::Inspect | Self::Geometry | Self::Measure | Self::Robustness | Self::Lab => false,
        }
    }

    /// Returns the first workspace with a panel in its default layout.
    pub(super) fn of(panel: Panel) -> Self {
        let has = |workspace: &Self| workspace.default_layout().panels().contains(&panel);
        Self::ALL.iter().copied().find(has).unwrap_or(Self::Inspect)
    }
}

fn tabs(panels: &[Panel]) -> Layout {
    Layout::Tabs { panels: panels.to_vec(), active: 0 }
}

fn part(layout: Layout, points: f32) -> Part {
    Part { layout, points }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_panel_is_in_a_workspace() {
        for panel in Panel::ALL {
            assert!(Workspace::of(*panel).default_layout().panels().contains(panel), "{panel:?}");
        }
    }
}
