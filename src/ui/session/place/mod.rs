//! Bookmarks and navigation history. Both store places: inspection states that consist of scene, camera, settings,
//! shown quantity and picked pixel. A place can be written as one command line.

pub(crate) mod visits;

use std::path::PathBuf;

use super::preferences::Bookmark;
use super::{PictureSize, Preferences, Session, Severity, vertices};
use crate::inspect::find::{SearchResult, SearchTarget};
use crate::inspect::project::Project;
use crate::inspect::scrub::Moment;
use crate::inspect::{Buffer, InspectionState};
use crate::scene::SceneSource;
use crate::ui::engine::Shown;
use crate::ui::session::feature::Feature;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::window_task::WindowTask;
use crate::ui::task::BackgroundTask;
use visits::Visits;

/// Maximum number of bookmarks.
const MAX_BOOKMARKS: usize = 200;

/// Bookmarks, navigation history, and the inspection state being restored.
#[derive(Debug, Default)]
pub(crate) struct Places {
    /// Bookmarks in the order of their creation. The keys Alt + 1 to Alt + 9 open the first nine.
    pub(crate) bookmarks: Vec<Bookmark>,
    /// Navigation history.
    pub(crate) visits: Visits,
    /// Inspection state to restore once its scene is loaded; `None` if none is pending.
    pub(crate) pending: Option<InspectionState>,
    /// Project to restore together with `pending`.
    pub(crate) project: Option<OpenedProject>,
    /// Commands that open the picture files of the project, to apply after it was restored.
    pub(crate) after_project: Vec<FileCommand>,
    /// Search of the frame for a target; `None` if none is running.
    pub(crate) searching: Option<BackgroundTask<(), (SearchTarget, SearchResult)>>,
}

/// Project that is being opened.
#[derive(Clone, Debug)]
pub(crate) struct OpenedProject {
    /// Path of the project file.
    pub(crate) path: PathBuf,
    /// Its content.
    pub(crate) project: Project,
}

/// Change to the bookmarks or to the current inspection state.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PlaceChange {
    /// Copies a command line to the clipboard. Running it restores the current inspection state.
    Copy,
    /// Bookmarks the current inspection state.
    Bookmark,
    /// Restores the bookmark at this index.
    Jump(usize),
    /// Renames the bookmark at this index.
    Rename(usize, String),
    /// Deletes the bookmark at this index.
    Remove(usize),
    /// Goes back to the previous entry of the navigation history.
    Back,
    /// Goes forward to the next entry of the navigation history.
    Forward,
    /// Restores an inspection state.
    Go(Box<InspectionState>),
    /// Searches the frame for a target, such as a triangle or an object, and picks a pixel that shows it.
    Find(SearchTarget),
}

impl Feature for Places {
    type Change = PlaceChange;

    fn apply(session: &mut Session, change: PlaceChange) -> Option<WindowTask> {
        session.change_places(change)
    }

    fn leave_scene(&mut self) {
        // The result of the search would change the pick in the new scene.
        self.searching = None;
    }

    fn store(&self, preferences: &mut Preferences) {
        preferences.bookmarks.clone_from(&self.bookmarks);
    }

    fn restore(&mut self, preferences: &Preferences) {
        self.bookmarks.clone_from(&preferences.bookmarks);
    }
}

impl Session {
    /// Parses a typed destination, such as a pixel or a triangle. The error message says why there is no such
    /// destination.
    pub(crate) fn search_target(&self, text: &str) -> Result<SearchTarget, String> {
        SearchTarget::parse(text, &self.scene, self.viewport(), vertices::picked_object(self))
    }

    /// Returns the current inspection state: scene, camera, settings, shown quantity and picked pixel.
    pub(crate) fn place(&self) -> InspectionState {
        let (buffer, stage, number) = match self.shown {
            Shown::Buffer(buffer) => (buffer, None, None),
            Shown::Stage(stage) => (Buffer::Color, Some(stage), None),
            Shown::Intermediate(number) => (Buffer::Color, None, Some(number)),
        };
        InspectionState {
            scene: match &self.source {
                SceneSource::Builtin(_) => self.source.name(),
                SceneSource::File(path, _) => std::path::absolute(path).unwrap_or_else(|_| path.clone()),
            },
            mirrored: self.mirrored,
            time_s: self.scene.time_s(),
            camera: self.state.camera,
            recipe: self.state.recipe,
            picture: match self.state.size {
                PictureSize::MatchWindow => None,
                PictureSize::Fixed(width, height) => Some((width, height)),
            },
            buffer,
            stage,
            number,
            display: self.features.range.setting(self.shown).display,
            overlays: self.features.overlays.layers.clone(),
            triangles: self.features.scrub.triangle_limit,
            fragments: self.features.scrub.fragment_limit(),
            pixel: self.pick,
        }
    }

    /// Returns a command line that restores the current inspection state from any working directory. It always includes
    /// the picture size, because pixel coordinates are meaningless without it.
    pub(crate) fn command_line(&self) -> String {
        let viewport = self.viewport();
        InspectionState { picture: Some((viewport.width, viewport.height)), ..self.place() }.command_line()
    }

    /// Applies a change. Returns a task if the window must complete it, such as opening a file.
    fn change_places(&mut self, change: PlaceChange) -> Option<WindowTask> {
        let bookmarks = &mut self.features.places.bookmarks;
        match change {
            PlaceChange::Bookmark => self.bookmark(),
            PlaceChange::Rename(number, name) => {
                if let Some(bookmark) = bookmarks.get_mut(number) {
                    bookmark.name = name;
                }
            }
            PlaceChange::Remove(number) if number < bookmarks.len() => drop(bookmarks.remove(number)),
            PlaceChange::Jump(number) => match bookmarks.get(number).cloned() {
                Some(bookmark) => return self.go(bookmark.place),
                None => {
                    self.report(
                        Severity::Info,
                        format!("There is no bookmark {}. Press Ctrl+B to add a bookmark", number + 1),
                    );
                }
            },
            PlaceChange::Go(place) => return self.go(*place),
            PlaceChange::Back | PlaceChange::Forward => {
                if let Some(visit) = self.features.places.visits.travel(change == PlaceChange::Back) {
                    // Back and forward keep recipe, picture size, display settings, overlays and the time of the scene.
                    // Undo covers the recipe and the picture size.
                    let here = self.place();
                    let display = self.features.range.setting(shown_at(&visit)).display;
                    let InspectionState { recipe, picture, overlays, time_s, .. } = here;
                    return self.go(InspectionState { recipe, picture, overlays, display, time_s, ..visit });
                }
            }
            PlaceChange::Copy => {
                let line = self.command_line();
                self.report(Severity::Info, format!("Copied: {line}"));
                return Some(WindowTask::CopyText(line));
            }
            PlaceChange::Find(SearchTarget::View(x, y, percent)) => return Some(WindowTask::ShowAt(x, y, percent)),
            PlaceChange::Find(wanted) => return Some(WindowTask::Search(wanted)),
            PlaceChange::Remove(_) => {}
        }
        None
    }

    /// Picks the pixel that a search has found, and reports the result. Returns the pixel to bring into view.
    pub(crate) fn apply_search_result(&mut self, wanted: &SearchTarget, found: &SearchResult) -> Option<(u32, u32)> {
        let words = wanted.words();
        let (level, text, pixel) = match found {
            SearchResult::Visible(pixel, count) => {
                (Severity::Info, format!("{words} is visible in {count} pixels"), Some(*pixel))
            }
            SearchResult::Hidden(pixel, count) => (
                Severity::Error,
                format!("{words} is hidden: it covers {count} pixels but is visible in none of them"),
                Some(*pixel),
            ),
            SearchResult::At(pixel, text) => (Severity::Info, text.clone(), Some(*pixel)),
            SearchResult::Nowhere(reason) => (Severity::Error, reason.clone(), None),
        };
        self.report(level, text);
        self.pick = pixel.or(self.pick);
        if let SearchTarget::Vertex(object, number) = wanted {
            self.features.vertices.apply(vertices::VerticesChange::Select(Some((*object as usize, *number))));
        }
        pixel
    }

    /// Restores the pending inspection state if its scene is now loaded.
    pub(crate) fn arrive(&mut self) {
        if let Some(place) = self.features.places.pending.take()
            && place.scene == self.place().scene
        {
            self.stand_at(&place);
            if let Some(opened) = self.features.places.project.take() {
                self.finish_project(&opened);
            }
        }
    }

    /// Records the current inspection state in the navigation history. `now` is the time in seconds.
    pub(crate) fn note_visit(&mut self, now: f64) {
        // Nothing is recorded before the first frame, or while another place is pending.
        if self.view.is_some() && self.features.places.pending.is_none() {
            let here = self.place();
            self.features.places.visits.note(here, now);
        }
    }

    fn bookmark(&mut self) {
        let place = self.place();
        let name = format!("{}: {}", self.scene.name, place.words());
        if self.features.places.bookmarks.len() == MAX_BOOKMARKS {
            self.report(Severity::Error, format!("Cannot add more than {MAX_BOOKMARKS} bookmarks: delete some first"));
            return;
        }
        self.features.places.bookmarks.push(Bookmark { name: name.clone(), place });
        let number = self.features.places.bookmarks.len();
        let key = if number <= 9 { format!(", Ctrl+{number} opens it") } else { String::new() };
        self.report(Severity::Info, format!("Bookmarked {name}{key}"));
    }

    /// Restores an inspection state: immediately if its scene is loaded, otherwise after loading the scene.
    fn go(&mut self, place: InspectionState) -> Option<WindowTask> {
        if let Err(reason) = place.check() {
            self.report(Severity::Error, format!("Cannot open this view: {reason}"));
            return None;
        }
        self.close_case();
        self.features.lab.open = false;
        self.features.places.project = None;
        if place.scene == self.place().scene {
            self.stand_at(&place);
            return None;
        }
        let open = match SceneSource::named(place.scene.clone()) {
            SceneSource::Builtin(scene) => FileCommand::OpenBuiltin(scene.id.to_owned()),
            SceneSource::File(path, _) => FileCommand::Open(path),
        };
        self.features.places.pending = Some(place);
        Some(WindowTask::File(open))
    }

    fn stand_at(&mut self, place: &InspectionState) {
        if place.mirrored != self.mirrored {
            self.mirror_z();
        }
        if place.time_s != self.scene.time_s() {
            self.features.scene_time.is_playing = false;
            self.scene = self.scene.at(place.time_s);
        }
        self.state.camera = place.camera;
        self.state.recipe = place.recipe;
        self.state.size =
            place.picture.map_or(PictureSize::MatchWindow, |(width, height)| PictureSize::Fixed(width, height));
        self.set_shown(shown_at(place));
        self.features.range.show_by(place.display, self.shown);
        self.features.overlays.layers.clone_from(&place.overlays);
        self.features.scrub.triangle_limit = None;
        if let Some(triangles) = place.triangles {
            self.begin_at(Moment { triangles, fragments: place.fragments });
        }
        self.pick = place.pixel;
        let here = self.place();
        self.features.places.visits.arrived(here);
    }
}

/// Returns the buffer, stage or intermediate value that is shown in an inspection state.
pub(crate) fn shown_at(place: &InspectionState) -> Shown {
    let number = || place.number.map(Shown::Intermediate);
    place.stage.map(Shown::Stage).or_else(number).unwrap_or(Shown::Buffer(place.buffer))
}

#[cfg(test)]
mod tests;
