//! The workbench: opens its window, explains why no window can be opened, and renders the workbench without a window.
//!
//! Display servers and libraries are found at run time, so each can be missing: the environment names no display
//! server, the named server does not respond, there is an X server but no Wayland, the keyboard library is missing
//! (which causes a panic), or OpenGL is missing. This is the only file of the command line that uses the window;
//! `workbench_absent` replaces this file in builds without the window.

mod args;

use std::panic::{self, AssertUnwindSafe};

use clap::builder::TypedValueParser;

use crate::chain::Recipe;
use crate::image::{Image, Rgba8};
use crate::measure::motion::Turn;
use crate::measure::window_cost::{AnswerTime, WindowCost};
use crate::pipeline::viewport::Viewport;
use crate::ui::engine::Shown;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::onboarding::OnboardingChange;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::session::{overlays, place, range, watch, what_if};
use crate::ui::{self, InitialView, ScreenshotRequest, WindowStart};

pub(crate) use crate::ui::session::workspace::{Panel, Workspace};

use super::failure::Failure;
use super::parse::{self, Either};
use super::scene_args::{RequestedView, WARNED};
use super::seen_args::{SeenArgs, WindowArgs, moment};

pub(crate) use args::WorkbenchArgs;
use args::{CompareArg, Open, ThemeArg};

/// Opens the window and returns when it is closed, or at once with an error if no window can be opened.
pub(crate) fn open(view: RequestedView, args: &WindowArgs) -> Result<(), String> {
    if needs_display() && !is_set("WAYLAND_DISPLAY") && !is_set("WAYLAND_SOCKET") && !is_set("DISPLAY") {
        return Err("no window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)".to_owned());
    }
    let outcome = without_library_panics(|| ui::run_window(start(view, initial_view(args.seen.clone(), args.at))));
    if outcome.is_err() {
        retry_on_x11();
    }
    outcome.map_err(|reason| format!("no window: {}", in_plain_words(&reason)))
}

/// Renders the whole workbench to an image.
pub(crate) fn draw(
    view: RequestedView,
    look: &WorkbenchArgs,
    shown: SeenArgs,
    against: Option<Recipe>,
) -> Result<Image<Rgba8>, Failure> {
    let request = ScreenshotRequest {
        start: start(view, initial_view(shown, look.at)),
        size: look.size,
        pixels_per_point: look.scale,
        theme: match look.theme {
            ThemeArg::Dark => ui::Theme::Dark,
            ThemeArg::Light => ui::Theme::Light,
        },
        measure: look.measure,
        selected: look.at,
        compare: look.compare.map(comparison),
        workspace: look.workspace,
        panel: look.panel,
        shown: look.number.map(Shown::Intermediate),
        moment: look.moment,
        fate: look.fate,
        probe: look.probe,
        mesh: look.mesh,
        lab: look.lab.map(|page| (page, look.lab_step)),
        first: against
            .map(|recipe| Command::WhatIf(what_if::WhatIfChange::Against(Box::new(recipe))))
            .into_iter()
            .chain(look.watch.then_some(Command::Watch(watch::WatchChange::AddPick)))
            .chain(look.open.into_iter().flat_map(open_first))
            .chain(laid_over(look))
            .collect(),
    };
    ui::screenshot(&request).map_err(|picture| {
        let (x, y) = look.at.unwrap_or_default();
        Failure::OutsidePicture { x, y, picture }
    })
}

/// Measures the cost of drawing the window, part by part.
pub(crate) fn window_costs(view: RequestedView, size: Viewport, passes: usize) -> Result<Vec<WindowCost>, Failure> {
    Ok(ui::window_time::window_costs(&start(view, InitialView::default()), size, passes))
}

/// Times `count` answers of the renderer about the picked pixel while the camera orbits by `turn` per answer.
pub(crate) fn answer_time(
    view: RequestedView,
    size: Viewport,
    turn: Turn,
    count: usize,
) -> Result<Option<AnswerTime>, Failure> {
    Ok(ui::answer_time::answer_time(&start(view, InitialView::default()), size, turn, count))
}

/// Returns the commands that open the range control and the overlay list, if requested.
fn laid_over(look: &WorkbenchArgs) -> impl Iterator<Item = Command> {
    let range = look.range.then_some(Command::Range(range::RangeChange::Open(true)));
    let list = look.overlays.then_some(Command::Overlays(overlays::OverlayChange::Open(true)));
    range.into_iter().chain(list)
}

fn comparison(compare: CompareArg) -> CompareChange {
    match compare {
        CompareArg::Two => CompareChange::Count(2),
        CompareArg::Four => CompareChange::Count(4),
        CompareArg::All => CompareChange::Every(None),
        CompareArg::Wipe => CompareChange::Mode(Mode::Wipe),
        CompareArg::Flip => CompareChange::Mode(Mode::Flip),
        CompareArg::Difference => CompareChange::Mode(Mode::Difference),
    }
}

fn open_first(open: Open) -> Vec<Command> {
    match open {
        Open::Keys => vec![Command::Dialog(DialogCommand::Keys)],
        Open::Manual => vec![Command::Dialog(DialogCommand::Manual(None))],
        Open::Palette => vec![Command::Dialog(DialogCommand::Palette)],
        Open::Bookmarks => {
            vec![Command::Place(place::PlaceChange::Bookmark), Command::Dialog(DialogCommand::Bookmarks)]
        }
        Open::StartCard => vec![Command::Onboarding(OnboardingChange::OpenCard)],
        Open::Coach => vec![Command::Onboarding(OnboardingChange::StartCoach)],
    }
}

/// Returns the parser for the id of a panel.
pub(crate) fn panel() -> impl TypedValueParser<Value = Panel> {
    parse::choice()
}

/// Returns the parser for the id of a workspace.
pub(crate) fn workspace() -> impl TypedValueParser<Value = Workspace> {
    parse::choice()
}

fn initial_view(args: SeenArgs, pixel: Option<(u32, u32)>) -> InitialView {
    let quantity = args.buffer.map(|buffer| match buffer {
        Either::First(buffer) => Shown::Buffer(buffer),
        Either::Second(number) => Shown::Intermediate(number),
    });
    let files = [args.picture_a, args.picture_b, args.picture_reference];
    let files = PictureRole::LISTED.into_iter().zip(files).filter_map(|(role, file)| Some((role, file?)));
    InitialView {
        files: files.collect(),
        pixel,
        shown: args.stage.map(Shown::Stage).or(quantity),
        display: args.look,
        layers: args.overlay,
        moment: moment(args.triangles, args.fragments),
        picture: args.picture,
    }
}

fn start(view: RequestedView, seen: InitialView) -> WindowStart {
    let RequestedView { source, scene, warnings, recipe, camera, mirrored, is_default, project, memory_limit } = view;
    let seen = match &project {
        Some(project) => seen.or_of(project),
        None => seen,
    };
    WindowStart {
        source,
        scene,
        warnings,
        recipe,
        camera,
        mirrored,
        resume: is_default,
        initial_view: seen,
        memory_limit,
        pending: None,
        project,
    }
}

/// Returns whether this operating system requires the environment to name a display server.
fn needs_display() -> bool {
    cfg!(all(unix, not(target_os = "macos")))
}

fn is_set(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| !value.is_empty())
}

/// Restarts this program without Wayland if connecting to Wayland failed and an X server is available. The restart is
/// necessary, because a process can connect only once. Returns if there is no X server to try.
fn retry_on_x11() {
    #[cfg(unix)]
    if is_set("DISPLAY") && (is_set("WAYLAND_DISPLAY") || is_set("WAYLAND_SOCKET")) {
        use std::os::unix::process::CommandExt as _;

        let Ok(program) = std::env::current_exe() else { return };
        let mut again = std::process::Command::new(program);
        again.args(std::env::args_os().skip(1));
        again.env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").env(WARNED, "1");
        // `exec` returns only if the program cannot be started; then the first error is reported.
        let _ = again.exec();
    }
}

/// Converts the panic of a missing keyboard library into an error. Other panics continue to unwind.
fn without_library_panics(f: impl FnOnce() -> Result<(), String>) -> Result<(), String> {
    let default_hook = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if missing_library(info.payload()).is_none() {
            default_hook(info);
        }
    }));
    panic::catch_unwind(AssertUnwindSafe(f)).unwrap_or_else(|payload| match missing_library(&*payload) {
        Some(message) => Err(message),
        None => panic::resume_unwind(payload),
    })
}

fn missing_library(payload: &(dyn std::any::Any + Send)) -> Option<String> {
    let text = payload.downcast_ref::<String>().map(String::as_str).or(payload.downcast_ref::<&str>().copied())?;
    text.contains("could not be loaded").then(|| text.trim_end_matches('.').to_owned())
}

/// Removes source locations and configuration dumps from the error messages of libraries.
fn in_plain_words(reason: &str) -> &str {
    if reason.contains("glutin") {
        return "OpenGL is missing or does not work";
    }
    reason.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")).map_or(reason, |(_line, words)| words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_messages_omit_source_locations_and_configuration_dumps() {
        for (reason, words) in [
            ("EventLoopError: os error at /src/x11/mod.rs:788: Failed to open connection", "Failed to open connection"),
            (
                "Found no glutin configs matching the template: ConfigTemplate { .. }",
                "OpenGL is missing or does not work",
            ),
            ("Library libxkbcommon-x11.so could not be loaded", "Library libxkbcommon-x11.so could not be loaded"),
        ] {
            assert_eq!(in_plain_words(reason), words);
        }
    }
}
