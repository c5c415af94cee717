//! Dockable panels. The file of a panel declares its [`PanelSpec`], and [`Panel`] lists all of them.

use std::time::Instant;

use eframe::egui::Ui;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

use crate::manual::Chapter;
use crate::pipeline::settings::Choice;
use crate::ui::canvas::CanvasView;
use crate::ui::command::Command;
use crate::ui::compare::tiles::TilesView;
use crate::ui::filmstrip::strip::FilmstripView;
use crate::ui::mesh_view::MeshPane;
use crate::ui::panels::case::CaseView;
use crate::ui::panels::inspector::Inspector;
use crate::ui::session::Session;
use crate::ui::thumbnails::Thumbnails;
use crate::ui::{
    checks, compare, explaining, fates, lab, mesh_view, over_time, panels, picture_panel, probe, range, trace,
    vertices, watch,
};

/// Description of a panel, declared in the file of the panel.
pub(crate) struct PanelSpec {
    /// Identifier in stored layouts and on the command line.
    pub(crate) id: &'static str,
    /// Name in titles, in the palette and in messages.
    pub(crate) name: &'static str,
    /// Tooltip of the title, without a full stop.
    pub(crate) help: &'static str,
    /// Other words for the panel, in lower case, by which the palette finds it.
    pub(crate) synonyms: &'static [&'static str],
    /// Chapter of the manual that describes the panel.
    pub(crate) chapter: Chapter,
    /// Whether the panel takes the space that a larger window offers, instead of keeping its size.
    pub(crate) grows: bool,
    /// Whether the panel has a title even if it is alone in its area. A panel with a toolbar of its own needs none.
    pub(crate) titled: bool,
    /// Draws the controls in a row above the content; `None` if there are none.
    pub(crate) controls: Option<fn(&mut Ui, &mut PanelContext<'_>)>,
    /// Draws the content of the panel into the remaining space.
    pub(crate) content: fn(&mut Ui, &mut PanelContext<'_>),
}

/// Inputs of a panel, and the list to which it appends commands.
pub(crate) struct PanelContext<'a> {
    /// Session that the panel reads.
    pub(crate) session: &'a Session,
    /// Widget state of all panels.
    pub(crate) widgets: &'a mut PanelWidgets,
    /// Commands to run after the layout pass.
    pub(crate) commands: &'a mut Vec<Command>,
}

/// State of the widgets in all panels.
#[derive(Default)]
pub(crate) struct PanelWidgets {
    /// Canvas with the picture.
    pub(crate) canvas: CanvasView,
    /// Tiles of a comparison.
    pub(crate) tiles: TilesView,
    /// Filmstrip below the tiles.
    pub(crate) filmstrip: FilmstripView,
    /// Whether the last pass showed the filmstrip.
    pub(crate) shows_filmstrip: bool,
    /// Height of the panel with the picture, in points, as of the last pass that showed it.
    pub(crate) picture_panel_height: f32,
    /// Pictures of a case.
    pub(crate) case: CaseView,
    /// Mesh view.
    pub(crate) mesh: MeshPane,
    /// Inspector of the picked pixel.
    pub(crate) inspector: Inspector,
    /// Small pictures of the built-in scenes.
    pub(crate) thumbnails: Thumbnails,
    /// Size of the canvas in screen pixels, as of the last frame that showed it.
    pub(crate) canvas_px: (u32, u32),
    /// Size of the visible canvas in screen pixels, without the legend strip.
    pub(crate) visible_px: (u32, u32),
    /// Time at which the oldest unanswered render request was sent; `None` if all requests are answered.
    pub(crate) requested_at: Option<Instant>,
    /// Whether pictures are drawn synchronously, as in screenshots and tests.
    pub(crate) is_synchronous: bool,
}

/// Declares [`Panel`], with one variant per panel and the place of its [`PanelSpec`].
macro_rules! panels {
    ($($(#[$doc:meta])* $name:ident = $spec:expr,)+) => {
        /// Dockable panel.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Panel {
            $($(#[$doc])* $name,)+
        }

        impl Choice for Panel {
            const ALL: &'static [Self] = &[$(Self::$name,)+];

            fn id(self) -> &'static str {
                self.spec().id
            }

            fn name(self) -> &'static str {
                self.spec().name
            }

            fn help(self) -> &'static str {
                self.spec().help
            }

            fn synonyms(self) -> &'static [&'static str] {
                self.spec().synonyms
            }
        }

        impl Panel {
            /// Returns the description of the panel.
            pub(crate) fn spec(self) -> &'static PanelSpec {
                match self {
                    $(Self::$name => &$spec,)+
                }
            }
        }
    };
}

panels! {
    /// Stages of the pipeline with their settings.
    Stages = panels::pipeline::PANEL,
    /// Picture, comparison or case.
    Picture = picture_panel::PANEL,
    /// Explanation of the picked pixel.
    Pixel = panels::inspector::PANEL,
    /// Every arithmetic step of a fragment at the picked pixel.
    Calculation = trace::panel::PANEL,
    /// Values of all buffers at watched pixels.
    Watch = watch::panel::PANEL,
    /// Samples from which the picked pixel was reconstructed, with their weights.
    FilterTaps = panels::filter_taps::PANEL,
    /// Histogram and statistics of the shown values.
    Histogram = range::panel::PANEL,
    /// Scene from a second camera.
    MeshView = mesh_view::PANEL,
    /// Vertices of the picked triangle after every stage.
    Vertices = vertices::PANEL,
    /// Fate of every triangle and fragment.
    TriangleFates = fates::panel::PANEL,
    /// Frame time of each upscaler.
    FrameTime = panels::frame_times::PANEL,
    /// Error against time of each upscaler.
    ErrorTime = panels::tradeoff::PANEL,
    /// Errors of the compared upscalers in every frame.
    OverTime = over_time::panel::PANEL,
    /// Frame time against triangles, pixels, layers and threads.
    Scaling = panels::scaling::PANEL,
    /// Parts of the pipeline that each draw runs or skips.
    SkippedWork = panels::skipped_work::PANEL,
    /// Stability report on difficult test cases.
    Stability = panels::stability::PANEL,
    /// Pixels that change if camera or vertices move by a few units in the last place.
    Probe = probe::PANEL,
    /// Assertions that are checked for every fragment.
    Assertions = checks::panel::PANEL,
    /// Faults of another renderer that explain its picture.
    OtherRenderer = explaining::panel::PANEL,
    /// Layers, ranges and stored values of compared picture files.
    PictureFiles = compare::files_panel::PANEL,
    /// Log of all messages.
    Log = panels::log::PANEL,
    /// 2D lab.
    Lab = lab::PANEL,
}

impl Serialize for Panel {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.id().serialize(to)
    }
}

impl<'de> Deserialize<'de> for Panel {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let id = String::deserialize(from)?;
        let named = Self::ALL.iter().copied().find(|panel| panel.id() == id);
        named.ok_or_else(|| D::Error::custom(format!("there is no panel “{id}”")))
    }
}
