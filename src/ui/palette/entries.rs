//! Entries of the command palette, as data: commands with their keys, all values of all settings, scenes, buffers,
//! stages, panels, upscalers, bookmarks and recent files. Each list comes from the table that the rest of the window
//! uses.

use crate::chain::Recipe;
use crate::inspect::find::SearchTarget;
use crate::inspect::outline::OutlineKind;
use crate::inspect::{Buffer, Intermediate, Stage, fields};
use crate::pipeline::settings::Choice as _;
use crate::scene::{SceneSource, builtin};
use crate::ui::command::{BINDINGS, Command};
use crate::ui::compare::{CompareChange, Mode};
use crate::ui::engine::Shown;
use crate::ui::filmstrip::FilmstripChange;
use crate::ui::key_sheet::key_name;
use crate::ui::legend_strip;
use crate::ui::panels::switches;
use crate::ui::place;
use crate::ui::session::{PictureSize, Session};
use crate::ui::what_if;
use crate::ui::workspace::{Panel, Workspace, WorkspaceChange};
use crate::upscale;

/// Category of a palette entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EntryKind {
    /// Command that the window can run.
    Command,
    /// Value of a setting.
    Setting,
    /// Built-in scene or recent file.
    Scene,
    /// Buffer of the frame.
    Buffer,
    /// Picture after a pipeline stage.
    Stage,
    /// Workspace or panel of the window.
    Panel,
    /// Upscaler that reconstructs the pixels that are not drawn.
    Upscaler,
    /// Bookmark of an inspection state.
    Bookmark,
}

impl EntryKind {
    /// Returns the display name of the category.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Command => "Command",
            Self::Setting => "Setting",
            Self::Scene => "Scene",
            Self::Buffer => "Buffer",
            Self::Stage => "Stage",
            Self::Panel => "Panel",
            Self::Upscaler => "Upscaler",
            Self::Bookmark => "Bookmark",
        }
    }
}

/// Effect of choosing a palette entry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Runs a command.
    Run(Box<Command>),
    /// Fills the search field with this text, for the user to append a value.
    Type(String),
}

/// Entry of the command palette.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PaletteEntry {
    /// Category, shown at the left of the entry.
    pub(crate) kind: EntryKind,
    /// Title, shown in the list and matched by the search.
    pub(crate) title: String,
    /// Tooltip of the entry; empty for none.
    pub(crate) help: String,
    /// Name of the key that triggers the same action; empty if there is none.
    pub(crate) key: String,
    /// Whether the entry is the current value of its setting, or the current scene, upscaler or shown quantity.
    pub(crate) is_current: bool,
    /// Effect of choosing the entry.
    pub(crate) action: Action,
    /// Stage that owns the setting; choosing the entry selects it. `None` for entries that change no setting of a stage.
    pub(crate) owner: Option<Stage>,
}

fn entry(kind: EntryKind, title: impl Into<String>, command: Command) -> PaletteEntry {
    let binding = BINDINGS.iter().find(|binding| (binding.command)() == command);
    let key = binding.map(key_name).unwrap_or_default();
    PaletteEntry {
        kind,
        title: title.into(),
        help: String::new(),
        key,
        is_current: false,
        action: Action::Run(Box::new(command)),
        owner: None,
    }
}

impl PaletteEntry {
    fn with(self, help: impl Into<String>, holds: bool) -> Self {
        Self { help: help.into(), is_current: holds, ..self }
    }

    fn owned_by(self, owner: Option<Stage>) -> Self {
        Self { owner, ..self }
    }
}

/// Returns commands that depend on the picture: removals of what changes its look, remedies for the picked pixel, and
/// views of the what-if comparison.
fn of_the_picture(session: &Session) -> Vec<PaletteEntry> {
    let removals = legend_strip::removals(session).into_iter();
    let mut entries: Vec<_> = removals.map(|(name, command)| entry(EntryKind::Command, name, command)).collect();
    let report = session.view.as_ref().and_then(|view| view.report.as_ref());
    entries.extend(report.iter().flat_map(|report| &report.remedies).map(|remedy| {
        let title = format!("Remedy for the picked pixel: {}", remedy.label());
        entry(EntryKind::Command, title, Command::ApplyRemedy(*remedy)).with(remedy.effect(), false)
    }));
    if session.what_if.open {
        entries.extend(what_if::Show::ALL.map(|(show, name, help)| {
            let command = Command::WhatIf(what_if::WhatIfChange::Show(show));
            entry(EntryKind::Command, format!("What changed: {name}"), command).with(help, session.what_if.show == show)
        }));
    }
    entries
}

/// Returns all entries for the current state of `session`.
pub(crate) fn all(session: &Session) -> Vec<PaletteEntry> {
    let mut entries = commands();
    entries.extend(of_the_picture(session));
    entries.extend(bookmarks(session));
    entries.extend(scenes(session));
    entries.extend(Buffer::ALL.iter().map(|buffer| {
        let shown = Shown::Buffer(*buffer);
        let title = format!("Show buffer: {}", buffer.name());
        entry(EntryKind::Buffer, title, Command::Show(shown)).with(buffer.help(), session.shown == shown)
    }));
    entries.extend(Intermediate::ALL.iter().map(|number| {
        let shown = Shown::Intermediate(*number);
        let title = format!("Show intermediate value: {}", number.name());
        entry(EntryKind::Buffer, title, Command::Show(shown)).with(number.help(), session.shown == shown)
    }));
    entries.extend(Stage::ALL.iter().map(|stage| {
        let shown = Shown::Stage(*stage);
        let title = format!("Show stage: {}", stage.name());
        entry(EntryKind::Stage, title, Command::Show(shown)).with(stage.help(), session.shown == shown)
    }));
    entries.extend(Stage::ALL.iter().map(|stage| {
        let title = format!("Select stage: {}", stage.name());
        let help = "Show the switches of this stage in the pipeline panel";
        let is_selected = session.selected_stage == *stage;
        entry(EntryKind::Stage, title, Command::SelectStage(*stage)).with(help, is_selected)
    }));
    entries.extend(Workspace::ALL.iter().copied().map(|workspace| {
        let title = format!("Show workspace: {}", workspace.name());
        let command = Command::Workspace(WorkspaceChange::Show(workspace));
        entry(EntryKind::Panel, title, command).with(workspace.help(), workspace == session.workspace())
    }));
    entries.extend(Panel::ALL.iter().map(|panel| {
        let title = format!("Show panel: {}", panel.name());
        entry(EntryKind::Panel, title, Command::Workspace(WorkspaceChange::Panel(*panel)))
            .with(panel.spec().help, false)
    }));
    entries.extend(upscale::ALL.iter().enumerate().map(|(place, upscaler)| {
        let chosen = session.state.recipe.upscaler.method() == upscaler.id();
        let title = format!("Choose upscaler: {}", upscaler.name());
        let entry = entry(EntryKind::Upscaler, title, Command::ChooseUpscaler(place));
        entry.with("", chosen).owned_by(Some(Stage::Upscale))
    }));
    entries.extend(settings(session));
    entries
}

/// Returns one entry for each command that has a key, and for each menu command that has none.
fn commands() -> Vec<PaletteEntry> {
    let mut entries: Vec<PaletteEntry> = Vec::new();
    for binding in BINDINGS {
        let command = (binding.command)();
        // Skips commands that other entries cover (upscalers and bookmarks), and the command that opens the palette.
        let is_elsewhere = matches!(
            command,
            Command::ChooseUpscaler(_) | Command::OpenPalette | Command::Place(place::PlaceChange::Jump(_))
        );
        if !is_elsewhere && !entries.iter().any(|known| known.title == binding.description) {
            entries.push(entry(EntryKind::Command, binding.description, command));
        }
    }
    let keyless = [
        ("Fit the scene into the view", Command::FitCamera),
        ("Mirror the scene along z", Command::MirrorZ),
        ("Reset all settings", Command::ResetRecipe),
        ("Save the picked triangle as a case file", Command::SaveCase),
        ("Switch between dark and light theme", Command::ToggleTheme),
        ("Manage bookmarks", Command::Place(place::PlaceChange::Manage)),
        ("Compare all upscalers in tiles", Command::Compare(CompareChange::Every(None))),
        ("Filmstrip of all upscaling methods", Command::Filmstrip(FilmstripChange::Toggle)),
        (
            "Pin the current settings as A and compare later changes with them",
            Command::WhatIf(what_if::WhatIfChange::PinNow),
        ),
        ("Restore the settings from before the last change", Command::WhatIf(what_if::WhatIfChange::Revert)),
        ("Save the compared pictures and their errors as an HTML page", Command::SaveComparison),
        ("Stop comparing", Command::Compare(CompareChange::Mode(Mode::Off))),
        ("Measure all upscalers", Command::Measure),
        ("Measure the savings of skipped work", Command::MeasurePlan),
        ("Measure scaling", Command::MeasureScaling),
        ("Run the stability report", Command::RunStability),
        ("Save all frame times as CSV", Command::ExportTimings),
        ("Match the picture size to the window", Command::SetSize(PictureSize::MatchWindow)),
    ];
    entries.extend(keyless.map(|(title, command)| entry(EntryKind::Command, title, command)));
    for kind in OutlineKind::ALL {
        for end in ["svg", "pdf"] {
            let title = format!("Save scene as drawing: {}, {}", kind.name(), end.to_uppercase());
            entries.push(entry(EntryKind::Command, title, Command::SaveOutline(*kind, end)).with(kind.help(), false));
        }
    }
    entries
}

fn bookmarks(session: &Session) -> impl Iterator<Item = PaletteEntry> {
    session.places.bookmarks.iter().enumerate().map(|(number, bookmark)| {
        let jump = Command::Place(place::PlaceChange::Jump(number));
        entry(EntryKind::Bookmark, format!("Go to {}", bookmark.name), jump)
    })
}

fn scenes(session: &Session) -> impl Iterator<Item = PaletteEntry> {
    let builtins = builtin::ALL.iter().map(|scene| {
        let holds = matches!(&session.source, SceneSource::Builtin(shown) if shown.id == scene.id);
        let open = Command::OpenBuiltin(scene.id.to_owned());
        entry(EntryKind::Scene, format!("Open scene: {}", scene.title), open).with(scene.summary, holds)
    });
    let files = session.recent.iter().map(|path| {
        let holds = matches!(&session.source, SceneSource::File(shown, _) if shown == path);
        entry(EntryKind::Scene, format!("Open {}", path.display()), Command::Open(path.clone())).with("", holds)
    });
    builtins.chain(files)
}

/// Returns one entry for every value of each setting that has a finite set of values, and one entry for each other
/// setting.
fn settings(session: &Session) -> Vec<PaletteEntry> {
    let recipe = session.state.recipe;
    let now = fields::fields(&recipe);
    let mut entries = Vec::new();
    for ((key, values), (_, present)) in Recipe::keys().into_iter().zip(now) {
        let choices = fields::choices(&recipe, &values, &key);
        let owner = switches::owner(&key);
        for choice in &choices {
            let mut changed = recipe;
            // Skips values that the recipe rejects.
            if changed.set(&format!("{key}={choice}")).is_ok() {
                let set = entry(EntryKind::Setting, format!("{key} = {choice}"), Command::SetRecipe(changed));
                entries.push(set.with("", *choice == present).owned_by(owner));
            }
        }
        if choices.is_empty() {
            let action = Action::Type(format!("{key}="));
            let title = format!("{key} = …  (now {present})");
            let help = format!("{values}: type a value and press Enter");
            entries.push(PaletteEntry {
                kind: EntryKind::Setting,
                title,
                help,
                key: String::new(),
                is_current: false,
                action,
                owner,
            });
        }
    }
    entries
}

/// Returns an entry for a typed assignment such as `light.ambient=0.3`, if it is valid.
pub(crate) fn assignment(session: &Session, typed: &str) -> Option<PaletteEntry> {
    let mut recipe = session.state.recipe;
    recipe.set(typed.trim()).ok()?;
    let (key, value) = typed.split_once('=')?;
    let title = format!("Set {} to {}", key.trim(), value.trim());
    let set = entry(EntryKind::Setting, title, Command::SetRecipe(recipe));
    Some(set.with("", recipe == session.state.recipe).owned_by(switches::owner(&key.trim().replace('-', "_"))))
}

/// Returns an entry for a typed destination, which must be a pixel, a triangle or a vertex. Object names are excluded,
/// because other entries may have the same name.
pub(crate) fn destination(session: &Session, typed: &str) -> Option<PaletteEntry> {
    let wanted = session.search_target(typed).ok().filter(|wanted| !matches!(wanted, SearchTarget::Object(..)))?;
    let title = format!("Go to {}", wanted.words().to_lowercase());
    Some(entry(EntryKind::Command, title, place::go_to(wanted)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::TriangleId;

    fn run(command: Command) -> Action {
        Action::Run(Box::new(command))
    }

    fn session() -> Session {
        let source = SceneSource::named("triangle".into());
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        Session::new(Arc::new(scene), source, Recipe::default(), home)
    }

    #[test]
    fn everything_with_a_name_has_an_entry() {
        let entries = all(&session());
        let offers = |kind: EntryKind, name: &str| entries.iter().any(|e| e.kind == kind && e.title.contains(name));
        for binding in BINDINGS {
            let elsewhere = ["Choose an upscaler", "Go to a bookmark", "Find anything"];
            assert!(
                offers(EntryKind::Command, binding.description) || elsewhere.contains(&binding.description),
                "{}",
                binding.description
            );
        }
        for scene in builtin::ALL {
            assert!(offers(EntryKind::Scene, scene.title));
        }
        assert!(Buffer::ALL.iter().all(|buffer| offers(EntryKind::Buffer, buffer.name())));
        assert!(Stage::ALL.iter().all(|stage| offers(EntryKind::Stage, stage.name())));
        assert!(upscale::ALL.iter().all(|upscaler| offers(EntryKind::Upscaler, upscaler.name())));
        assert!(Panel::ALL.iter().all(|panel| offers(EntryKind::Panel, panel.name())));
        assert!(Recipe::keys().iter().all(|(key, _)| offers(EntryKind::Setting, &format!("{key} = "))));
    }

    #[test]
    fn setting_entries_set_their_value_and_mark_the_current_one() {
        let session = session();
        let entries = all(&session);
        let find = |title: &str| entries.iter().find(|entry| entry.title == title).unwrap();
        let mut wanted = session.state.recipe;
        wanted.set("fill_rule=inclusive").unwrap();
        assert_eq!(find("fill_rule = inclusive").action, run(Command::SetRecipe(wanted)));
        assert!(find("fill_rule = top-left").is_current && !find("fill_rule = inclusive").is_current);
        for (key, _) in Recipe::keys() {
            let of_key = entries.iter().filter(|entry| entry.title.starts_with(&format!("{key} = ")));
            let holding = of_key.filter(|entry| entry.is_current || matches!(entry.action, Action::Type(_)));
            assert_eq!(holding.count(), 1, "{key} has exactly one value");
        }
    }

    #[test]
    fn entries_of_settings_select_the_stage_with_their_switch() {
        let session = session();
        let entries = all(&session);
        let owner = |start: &str| entries.iter().find(|entry| entry.title.starts_with(start)).unwrap().owner;
        assert_eq!(owner("fill_rule = inclusive"), Some(Stage::Rasterize));
        assert_eq!(owner("light.ambient = …"), Some(Stage::Shade));
        assert_eq!(owner("Choose upscaler: "), Some(Stage::Upscale));
        assert_eq!(owner("Show panel: "), None);
        assert_eq!(assignment(&session, "fill-rule=inclusive").unwrap().owner, Some(Stage::Rasterize));
    }

    #[test]
    fn a_number_is_typed_as_key_and_value() {
        let session = session();
        let typed = assignment(&session, "light.ambient=0.5").unwrap();
        let Action::Run(command) = typed.action else { panic!("it is a command") };
        let Command::SetRecipe(recipe) = *command else { panic!("it sets the recipe") };
        assert_eq!(recipe.pipeline.light.ambient, 0.5);
        assert_eq!(assignment(&session, "light.ambient=7"), None);
        assert_eq!(assignment(&session, "light"), None);
    }

    #[test]
    fn typed_pixels_triangles_and_vertices_are_destinations() {
        let mut session = session();
        session.state.size = PictureSize::Fixed(320, 200);
        let go = |typed: &str| destination(&session, typed).map(|entry| entry.action);
        assert_eq!(go("12,34"), Some(run(Command::Pick(Some((12, 34))))));
        for (typed, wanted) in [("tri 0", SearchTarget::Triangle(TriangleId(0))), ("v 2", SearchTarget::Vertex(0, 2))] {
            assert_eq!(go(typed), Some(run(Command::Place(place::PlaceChange::Find(wanted)))), "{typed}");
        }
        assert_eq!(go("320,0"), None);
        assert_eq!(go(&session.scene.instances[0].name.clone()), None);
    }

    #[test]
    fn entries_show_their_keys() {
        let entries = all(&session());
        let undo = entries.iter().find(|entry| entry.action == run(Command::Undo)).unwrap();
        assert_eq!(undo.key, "Ctrl + Z");
        let second = entries.iter().find(|entry| entry.action == run(Command::ChooseUpscaler(1))).unwrap();
        assert_eq!(second.key, "2");
    }
}
