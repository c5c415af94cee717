//! Commands that have no key: the palette finds them by their names.

use crate::ui::session::PictureSize;
use crate::ui::session::appearance::AppearanceChange;
use crate::ui::session::camera_path::CameraPathChange;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::filmstrip::FilmstripChange;
use crate::ui::session::long_tasks::MeasureCommand;
use crate::ui::session::onboarding::OnboardingChange;
use crate::ui::session::over_time::OverTimeChange;
use crate::ui::session::temporal::TemporalChange;
use crate::ui::session::timings::TimingsChange;
use crate::ui::session::what_if::WhatIfChange;
use crate::ui::session::window_task::DialogCommand;

/// Command that has no key, but a name by which the palette finds it.
pub(crate) struct KeylessCommand {
    /// Title in the palette.
    pub(crate) title: &'static str,
    /// Constructor of the command.
    pub(crate) command: fn() -> Command,
    /// Other words for the command, in lower case, by which the palette finds it.
    pub(crate) synonyms: &'static [&'static str],
}

const fn keyless(title: &'static str, command: fn() -> Command) -> KeylessCommand {
    KeylessCommand { title, command, synonyms: &[] }
}

impl KeylessCommand {
    /// Returns the command with other words for it, in lower case, by which the palette finds it.
    const fn also(self, synonyms: &'static [&'static str]) -> Self {
        Self { synonyms, ..self }
    }
}

/// Commands that have no key, in the order of the palette. Commands on items of a list, such as scenes, follow from the
/// list and are not included.
pub(crate) const KEYLESS: &[KeylessCommand] = &[
    keyless("Fit the scene into the view", || Command::FitCamera).also(&["frame all"]),
    keyless("Mirror the scene along z", || Command::MirrorZ).also(&["handedness", "flip z"]),
    keyless("Reset all settings", || Command::ResetRecipe).also(&["reset", "defaults"]),
    keyless("Save the picked triangle as a case file", || Command::File(FileCommand::SaveCase)),
    keyless("Restart upscaler processes", || Command::RestartUpscalers).also(&["external", "retry"]),
    keyless("Switch between dark and light theme", || Command::Appearance(AppearanceChange::ToggleTheme))
        .also(&["dark mode", "light mode"]),
    keyless("Reduce motion", || Command::Appearance(AppearanceChange::ToggleMotion)).also(&[
        "animation",
        "accessibility",
        "blinking",
        "smooth scrolling",
    ]),
    keyless("Add key view to the camera path", || Command::CameraPath(CameraPathChange::Add)).also(&[
        "record",
        "keyframe",
        "animation",
    ]),
    keyless("Remove key view of the camera path", || Command::CameraPath(CameraPathChange::Remove)),
    keyless("Remove the camera path", || Command::CameraPath(CameraPathChange::Clear)),
    keyless("Measure errors over time", || Command::OverTime(OverTimeChange::Measure)).also(&["flicker", "motion"]),
    keyless("Manage bookmarks", || Command::Dialog(DialogCommand::Bookmarks)),
    keyless("Compare all upscalers in tiles", || Command::Compare(CompareChange::Every(None))),
    keyless("Earlier frames of the picked pixel", || Command::Temporal(TemporalChange::Toggle)).also(&[
        "history",
        "ghosting",
        "contribution",
    ]),
    keyless("Filmstrip of all upscaling methods", || Command::Filmstrip(FilmstripChange::Toggle)).also(&["thumbnails"]),
    keyless("Pin the current settings as A and compare later changes with them", || {
        Command::WhatIf(WhatIfChange::PinNow)
    }),
    keyless("Restore the settings from before the last change", || Command::WhatIf(WhatIfChange::Revert)),
    keyless("Save the compared pictures and their errors as an HTML page", || {
        Command::File(FileCommand::SaveComparison)
    }),
    keyless("Stop comparing", || Command::Compare(CompareChange::Mode(Mode::Off))),
    keyless("Add an upscaler process…", || Command::Dialog(DialogCommand::AddUpscaler))
        .also(&["external", "python", "plugin", "custom"]),
    keyless("Measure all upscalers", || Command::Measure(MeasureCommand::MeasureUpscalers)).also(&["profile"]),
    keyless("Measure the savings of skipped work", || Command::Measure(MeasureCommand::MeasurePlan)),
    keyless("Measure scaling", || Command::Measure(MeasureCommand::MeasureScaling)),
    keyless("Run the stability report", || Command::Measure(MeasureCommand::RunStability)),
    keyless("Save all frame times as CSV", || Command::Timings(TimingsChange::Export)).also(&["csv"]),
    keyless("Match the picture size to the window", || Command::SetSize(PictureSize::MatchWindow))
        .also(&["resolution"]),
    keyless("Show the start card", || Command::Onboarding(OnboardingChange::OpenCard)).also(&["welcome", "examples"]),
    keyless("Start the introduction in four steps", || Command::Onboarding(OnboardingChange::StartCoach))
        .also(&["tutorial", "tour", "coach"]),
];
