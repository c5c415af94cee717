//! Entries of the command palette, as data: commands with their keys, all values of all settings, scenes, buffers,
//! stages, panels, upscalers, bookmarks and recent files. Each list comes from the table that the rest of the window
//! uses.

use crate::chain::{Recipe, SettingKey, Word};
use crate::inspect::find::SearchTarget;
use crate::inspect::outline::OutlineKind;
use crate::inspect::overlays::Overlay;
use crate::inspect::{Buffer, Intermediate, Stage, lesson};
use crate::pipeline::settings::Choice as _;
use crate::scene::{SceneSource, builtin};
use crate::ui::engine::Shown;
use crate::ui::fuzzy::{self, FuzzyMatch};
use crate::ui::key_map::{BINDINGS, KEYLESS};
use crate::ui::key_sheet::key_name;
use crate::ui::panels::legend_strip;
use crate::ui::panels::setting_row::owner;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::overlays::OverlayChange;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::save_item::SaveItem;
use crate::ui::session::stages::StageChange;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::session::workspace::{Panel, Workspace, WorkspaceChange};
use crate::ui::session::{Session, place, what_if};
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
    /// Buffer of the frame, or an overlay of the picture.
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
    /// Other words for the entry, in lower case, by which the search also finds it.
    pub(crate) synonyms: Vec<&'static str>,
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
        synonyms: Vec::new(),
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

    /// Matches a query against the title and the synonyms. A query that equals a synonym is the best match.
    pub(crate) fn fit(&self, query: &str) -> Option<FuzzyMatch> {
        /// Score of a query that equals a synonym, larger than that of any title.
        const SYNONYM: i32 = 10_000;
        let (title, typed) = (fuzzy::fit(query, &self.title), query.trim().to_lowercase());
        let score = |word: &&str| match () {
            () if **word == *typed => Some(SYNONYM),
            () if !typed.is_empty() && word.starts_with(&typed) => fuzzy::fit(&typed, word).map(|fit| fit.score),
            () => None,
        };
        let synonym = self.synonyms.iter().filter_map(score).max();
        match (title, synonym) {
            (Some(title), Some(score)) => Some(FuzzyMatch { score: title.score.max(score), ..title }),
            (None, Some(score)) => Some(FuzzyMatch { score, letters: Vec::new() }),
            (title, None) => title,
        }
    }

    fn also(self, synonyms: impl IntoIterator<Item = &'static str>) -> Self {
        Self { synonyms: synonyms.into_iter().collect(), ..self }
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
    if session.features.what_if.open {
        entries.extend(what_if::Show::ALL.map(|(show, name, help)| {
            let command = Command::WhatIf(what_if::WhatIfChange::Show(show));
            entry(EntryKind::Command, format!("What changed: {name}"), command)
                .with(help, session.features.what_if.show == show)
        }));
    }
    entries
}

/// Returns all entries for the current state of `session`.
pub(crate) fn all(session: &Session) -> Vec<PaletteEntry> {
    let mut entries = commands();
    entries.extend(of_the_picture(session));
    entries.extend(bookmarks(session));
    entries.extend(views(session));
    entries.extend(scenes(session));
    entries.extend(Buffer::ALL.iter().map(|buffer| {
        let shown = Shown::Buffer(*buffer);
        let title = format!("Show buffer: {}", buffer.name());
        entry(EntryKind::Buffer, title, Command::Show(shown))
            .with(buffer.help(), session.shown == shown)
            .also(buffer.synonyms().iter().copied())
    }));
    entries.extend(Overlay::ALL.iter().map(|overlay| {
        let title = format!("Overlay: {}", overlay.name());
        entry(EntryKind::Buffer, title, Command::Overlays(OverlayChange::Toggle(*overlay)))
            .with(overlay.help(), session.features.overlays.layer(*overlay).is_some())
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
        let is_selected = session.features.stages.selected == *stage;
        entry(EntryKind::Stage, title, Command::Stage(StageChange::Select(*stage)))
            .with(help, is_selected)
            .also(stage.synonyms().iter().copied())
    }));
    entries.extend(Workspace::ALL.iter().copied().map(|workspace| {
        let title = format!("Show workspace: {}", workspace.name());
        let command = Command::Workspace(WorkspaceChange::Show(workspace));
        entry(EntryKind::Panel, title, command).with(workspace.help(), workspace == session.workspace())
    }));
    entries.extend(Panel::ALL.iter().map(|panel| {
        let title = format!("Show panel: {}", panel.name());
        entry(EntryKind::Panel, title, Command::Workspace(WorkspaceChange::Panel(*panel)))
            .with(panel.help(), false)
            .also(panel.synonyms().iter().copied())
    }));
    entries.extend(upscale::all().iter().enumerate().map(|(place, upscaler)| {
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
            Command::ChooseUpscaler(_)
                | Command::Dialog(DialogCommand::Palette)
                | Command::Place(place::PlaceChange::Jump(_))
        );
        if !is_elsewhere && !entries.iter().any(|known| known.title == binding.description) {
            let synonyms = binding.synonyms.iter().copied();
            entries.push(entry(EntryKind::Command, binding.description, command).also(synonyms));
        }
    }
    entries.extend(
        KEYLESS.iter().map(|named| {
            entry(EntryKind::Command, named.title, (named.command)()).also(named.synonyms.iter().copied())
        }),
    );
    for role in PictureRole::LISTED {
        let title = format!("Open picture as {}…", role.name());
        let open = entry(EntryKind::Command, title, Command::Dialog(DialogCommand::OpenPicture(role)));
        entries.push(open.also(["compare image file", "exr", "png"]));
    }
    for item in SaveItem::LISTED.into_iter().filter(|item| *item != SaveItem::Picture) {
        let title = format!("Save {} as…", item.name());
        entries.push(entry(EntryKind::Command, title, Command::File(FileCommand::SaveAs(item))));
    }
    for kind in OutlineKind::ALL {
        for end in ["svg", "pdf"] {
            let title = format!("Save scene as drawing: {}, {}", kind.name(), end.to_uppercase());
            entries.push(
                entry(EntryKind::Command, title, Command::File(FileCommand::SaveOutline(*kind, end)))
                    .with(kind.help(), false),
            );
        }
    }
    entries
}

fn bookmarks(session: &Session) -> impl Iterator<Item = PaletteEntry> {
    session.features.places.bookmarks.iter().enumerate().map(|(number, bookmark)| {
        let jump = Command::Place(place::PlaceChange::Jump(number));
        entry(EntryKind::Bookmark, format!("Go to {}", bookmark.name), jump)
    })
}

/// Returns an entry for each view that the file of the scene defines.
fn views(session: &Session) -> impl Iterator<Item = PaletteEntry> {
    session.scene.views.iter().map(|view| {
        let holds = session.state.camera == view.camera;
        let title = format!("Go to the camera {}", view.name);
        entry(EntryKind::Command, title, Command::SetCamera(view.camera)).with("Camera of the scene's file", holds)
    })
}

fn scenes(session: &Session) -> impl Iterator<Item = PaletteEntry> {
    let builtins = builtin::ALL.iter().map(|scene| {
        let holds = matches!(&session.source, SceneSource::Builtin(shown) if shown.id == scene.id);
        let open = Command::File(FileCommand::OpenBuiltin(scene.id.to_owned()));
        entry(EntryKind::Scene, format!("Open scene: {}", scene.title), open).with(scene.summary, holds)
    });
    let files = session.features.files.recent.iter().map(|path| {
        let holds = matches!(&session.source, SceneSource::File(shown, _) if shown == path);
        entry(EntryKind::Scene, format!("Open {}", path.display()), Command::File(FileCommand::Open(path.clone())))
            .with("", holds)
    });
    let lessons = lesson::ALL.iter().map(|lesson| {
        let title = format!("Why is this pixel black? {}", lesson.question);
        entry(EntryKind::Scene, title, Command::File(FileCommand::OpenLesson(lesson)))
    });
    builtins.chain(files).chain(lessons)
}

/// Returns one entry for every value of each setting that has a finite set of values, and one entry for each other
/// setting.
fn settings(session: &Session) -> Vec<PaletteEntry> {
    SettingKey::ALL.iter().flat_map(|key| values(*key, &session.state.recipe)).collect()
}

fn values(key: SettingKey, recipe: &Recipe) -> Vec<PaletteEntry> {
    let present = key.read(recipe);
    let words = key.choices(recipe);
    if words.is_empty() {
        return vec![PaletteEntry {
            kind: EntryKind::Setting,
            title: format!("{} = …  (now {present})", key.id()),
            synonyms: key.synonyms().to_vec(),
            help: format!("{}: type a value and press Enter", key.values()),
            key: String::new(),
            is_current: false,
            action: Action::Type(format!("{}=", key.id())),
            owner: owner(key),
        }];
    }
    words.into_iter().filter_map(|word| value(key, recipe, &word)).collect()
}

/// Returns the entry that sets a setting to a word.
fn value(key: SettingKey, recipe: &Recipe, word: &Word) -> Option<PaletteEntry> {
    let mut changed = *recipe;
    changed.set(&format!("{}={}", key.id(), word.id)).ok()?;
    // The synonyms of a switch name what it turns on.
    let of_key = if key.values().is_switch() && word.id != "true" { &[] } else { key.synonyms() };
    let set = entry(EntryKind::Setting, format!("{} = {}", key.id(), word.id), Command::SetRecipe(changed));
    let synonyms = of_key.iter().chain(word.synonyms).copied();
    Some(set.with(word.help, word.id == key.read(recipe)).also(synonyms).owned_by(owner(key)))
}

/// Returns an entry for a typed assignment such as `light.ambient=0.3`, if it is valid.
pub(crate) fn assignment(session: &Session, typed: &str) -> Option<PaletteEntry> {
    let mut recipe = session.state.recipe;
    recipe.set(typed.trim()).ok()?;
    let (key, value) = typed.split_once('=')?;
    let title = format!("Set {} to {}", key.trim(), value.trim());
    let set = entry(EntryKind::Setting, title, Command::SetRecipe(recipe));
    Some(set.with("", recipe == session.state.recipe).owned_by(SettingKey::by_id(key).and_then(owner)))
}

/// Returns an entry for a typed destination, which must be a pixel, a triangle or a vertex. Object names are excluded,
/// because other entries may have the same name.
pub(crate) fn destination(session: &Session, typed: &str) -> Option<PaletteEntry> {
    let wanted = session.search_target(typed).ok().filter(|wanted| !matches!(wanted, SearchTarget::Object(..)))?;
    let title = format!("Go to {}", wanted.words().to_lowercase());
    Some(entry(EntryKind::Command, title, Command::go_to(wanted)))
}

#[cfg(test)]
mod tests;
