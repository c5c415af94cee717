//! Replacement for the workbench in builds without it (feature `ui` off): every function returns an error that names
//! the missing feature.

#[path = "workbench/args.rs"]
mod args;

use clap::builder::{StringValueParser, TypedValueParser};

use crate::chain::Recipe;
use crate::image::{Image, Rgba8};
use crate::measure::motion::Turn;
use crate::measure::window_cost::{AnswerTime, WindowCost};
use crate::pipeline::viewport::Viewport;

use super::failure::Failure;
use super::scene_args::RequestedView;
use super::seen_args::{SeenArgs, WindowArgs};

pub(crate) use args::WorkbenchArgs;

const BUILT_WITHOUT: &str = "this program was built without the window (feature `ui`): \
    `window`, `screenshot`, `bench --window` and `bench --answers` are not available";

/// Returns an error, because there is no window to open.
pub(crate) fn open(_view: RequestedView, _args: &WindowArgs) -> Result<(), String> {
    Err(BUILT_WITHOUT.to_owned())
}

/// Returns an error, because there is no window to measure.
pub(crate) fn window_costs(_view: RequestedView, _size: Viewport, _passes: usize) -> Result<Vec<WindowCost>, Failure> {
    Err(Failure::NoWindow(BUILT_WITHOUT.to_owned()))
}

/// Returns an error, because there is no window whose requests could be answered.
pub(crate) fn answer_time(
    _view: RequestedView,
    _size: Viewport,
    _turn: Turn,
    _count: usize,
) -> Result<Option<AnswerTime>, Failure> {
    Err(Failure::NoWindow(BUILT_WITHOUT.to_owned()))
}

/// Id of a panel. Any text is accepted, because there are no panels.
pub(crate) type Panel = String;

/// Id of a workspace. Any text is accepted, because there are no workspaces.
pub(crate) type Workspace = String;

/// Returns the parser for the id of a panel.
pub(crate) fn panel() -> impl TypedValueParser<Value = Panel> {
    StringValueParser::new()
}

/// Returns the parser for the id of a workspace.
pub(crate) fn workspace() -> impl TypedValueParser<Value = Workspace> {
    StringValueParser::new()
}

/// Returns an error, because there is no workbench to render.
pub(crate) fn draw(
    _view: RequestedView,
    _look: &WorkbenchArgs,
    _seen: SeenArgs,
    _against: Option<Recipe>,
) -> Result<Image<Rgba8>, Failure> {
    Err(Failure::NoWindow(BUILT_WITHOUT.to_owned()))
}
