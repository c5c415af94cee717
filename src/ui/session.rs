//! State of the window as plain data: the scene, its settings, and the view of the results.
//!
//! Panels read this state and push [`Command`]s, which only [`Session::apply`] applies. Widgets store no settings.

mod messages;

mod preferences;

mod undo;

pub(crate) use messages::Messages;
pub(crate) use messages::Notice;
pub(crate) use messages::Severity;
pub(crate) use preferences::PictureSize;
pub(crate) use preferences::PointerMode;
pub(crate) use preferences::Preferences;
pub(crate) use preferences::WindowState;
use undo::UndoHistory;
pub(crate) use undo::Undoable;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::checks::Checks;
use super::command::Command;
use super::compare::compute::{CompareRequest, Compared};
use super::compare::{CompareChange, CompareSettings, Mode, TileSet};
use super::engine::{RenderedView, Request, Shown, StageFigures};
use super::fates::FatesView;
use super::filmstrip::Filmstrip;
use super::lab::{self, Lab};
use super::long_tasks::LongTasks;
use super::look::Look;
use super::mesh_view::{self, MeshView};
use super::onboarding::Onboarding;
use super::open_case::OpenCase;
use super::overlays::Overlays;
use super::picked_point::PickedPoint;
use super::place::Places;
use super::probe::ProbeState;
use super::range::{self, RangeControl};
use super::scrub::{self, Scrub};
use super::timings::Timings;
use super::trace::TraceView;
use super::vertices::VertexTable;
use super::watch::WatchList;
use super::what_if::WhatIf;
use super::window_time::WindowTimes;
use super::workspace::Workspace;
use crate::chain::{Frame, Recipe};
use crate::image::file;
use crate::inspect::lesson::BlackPixelLesson;
use crate::inspect::scrub::{Moment, Unit};
use crate::inspect::{Buffer, Stage, TriangleSelection};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, MemoryLimit, Scene, SceneSource};
use crate::upscale;

/// Maximum number of recent files.
const RECENT_FILES: usize = 8;

/// State of the window, apart from widgets.
#[derive(Debug)]
pub(crate) struct Session {
    /// Scene on screen.
    pub(crate) scene: Arc<Scene>,
    /// Source of the scene: a built-in scene or a file.
    pub(crate) source: SceneSource,
    /// Whether the scene is mirrored along z relative to its source.
    pub(crate) mirrored: bool,
    /// Maximum memory for the meshes and textures of a model.
    pub(crate) memory_limit: MemoryLimit,
    /// State that can be undone and redone.
    pub(crate) state: Undoable,
    /// Buffer, stage or intermediate value shown on the canvas.
    pub(crate) shown: Shown,
    /// Stage whose switches the pipeline panel shows.
    pub(crate) selected_stage: Stage,
    /// Maximum number of triangles to draw; `None` draws all.
    pub(crate) triangle_limit: Option<usize>,
    /// State of the playback of the frame's drawing.
    pub(crate) scrub: Scrub,
    /// Column and row of the picked pixel.
    pub(crate) pick: Option<(u32, u32)>,
    /// Point on the triangle at the picked pixel; `None` if the pixel shows no triangle or is not explained yet.
    pub(crate) picked_point: Option<PickedPoint>,
    /// Pointer mode of the canvas.
    pub(crate) pointer_mode: PointerMode,
    /// Size of the canvas in screen pixels, including the legend strip below it, as of the last frame.
    pub(crate) canvas_px: (u32, u32),
    /// Newest view from the renderer.
    pub(crate) view: Option<RenderedView>,
    /// Counters and times of the pipeline stages, from the last frame that stayed on screen long enough to be timed.
    pub(crate) stages: Option<StageFigures>,
    /// Settings of the comparison.
    pub(crate) comparison: CompareSettings,
    /// Filmstrip of all upscaling methods below the comparison.
    pub(crate) filmstrip: Filmstrip,
    /// Results of the comparison so far.
    pub(crate) compared: Option<Compared>,
    /// Recorded frame times and errors of each upscaler.
    pub(crate) timings: Timings,
    /// Time spent in the user interface itself, for each of the most recent frames of the window.
    pub(crate) window_times: WindowTimes,
    /// Case that is shown in place of the scene, if any.
    pub(crate) case: Option<OpenCase>,
    /// Settings and results of the stability probe.
    pub(crate) probing: ProbeState,
    /// Settings of the vertex table: which vertices are listed, and which one is followed.
    pub(crate) vertices: VertexTable,
    /// Mesh view, which shows the scene from a second camera.
    pub(crate) mesh_view: MeshView,
    /// State of the 2D lab.
    pub(crate) lab: Lab,
    /// Settings and results of the assertions.
    pub(crate) checks: Checks,
    /// Trace of the arithmetic of the picked pixel.
    pub(crate) trace: TraceView,
    /// Ranges and colour maps of the buffers and stages.
    pub(crate) range: RangeControl,
    /// Active overlays of the picture.
    pub(crate) overlays: Overlays,
    /// Selected triangles, highlighted in the picture, in tables and on meshes.
    pub(crate) selection: TriangleSelection,
    /// Fates of the frame's triangles and fragments, and the filter that selects triangles by fate.
    pub(crate) fates: FatesView,
    /// Bookmarks and navigation history.
    pub(crate) places: Places,
    /// State of the what-if comparison, which shows the effect of the last change of settings.
    pub(crate) what_if: WhatIf,
    /// Watched pixels and their values.
    pub(crate) watch: WatchList,
    /// Errors, notices, offers, and the log.
    pub(crate) messages: Messages,
    /// Progress and results of measurements and exports that take long.
    pub(crate) tasks: LongTasks,
    /// Recently opened files, newest first.
    pub(crate) recent: Vec<PathBuf>,
    /// Folder for exported pictures and cases: the working directory at startup.
    pub(crate) folder: PathBuf,
    /// Start card and coach for new users.
    pub(crate) onboarding: Onboarding,
    /// Lesson whose scene is being opened.
    pub(crate) opening_lesson: Option<&'static BlackPixelLesson>,
    /// Lesson of the scene on screen; its black spot is picked automatically.
    lesson: Option<&'static BlackPixelLesson>,
    /// Workspace that is shown unless the 2D lab, a comparison or the mesh view is open.
    pub(in crate::ui) base_workspace: Workspace,
    first_pick: FirstPick,
    history: UndoHistory,
}

/// State of the automatic first pick, which shows new users how a pixel is explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FirstPick {
    /// No pixel has been picked yet.
    Due,
    /// This pixel was picked automatically in a picture of this size. The pick is repeated when the size changes.
    Made((u32, u32), Viewport),
    /// The user has picked a pixel.
    Done,
}

/// Position of the automatic pick, as fractions of width and height: near the centre, where scenes have geometry.
const FIRST_PICK: (f32, f32) = (0.53, 0.49);

impl Session {
    /// Creates a session that shows a scene with a recipe and a camera.
    pub(crate) fn new(scene: Arc<Scene>, source: SceneSource, recipe: Recipe, camera: Camera) -> Self {
        let state = Undoable { recipe, camera, size: PictureSize::default(), tiles: TileSet::default() };
        Self {
            scene,
            source,
            mirrored: false,
            memory_limit: MemoryLimit::default(),
            history: UndoHistory::new(&state),
            state,
            messages: Messages::default(),
            tasks: LongTasks::default(),
            shown: Shown::Buffer(Buffer::Color),
            selected_stage: Stage::Rasterize,
            triangle_limit: None,
            scrub: Scrub::default(),
            pick: None,
            picked_point: None,
            pointer_mode: PointerMode::default(),
            canvas_px: (0, 0),
            view: None,
            stages: None,
            comparison: CompareSettings::default(),
            filmstrip: Filmstrip::default(),
            compared: None,
            timings: Timings::default(),
            window_times: WindowTimes::default(),
            case: None,
            probing: ProbeState::default(),
            vertices: VertexTable::default(),
            mesh_view: MeshView::default(),
            lab: Lab::default(),
            checks: Checks::default(),
            trace: TraceView::default(),
            range: RangeControl::default(),
            overlays: Overlays::default(),
            selection: TriangleSelection::default(),
            fates: FatesView::default(),
            places: Places::default(),
            what_if: WhatIf::default(),
            watch: WatchList::default(),
            recent: Vec::new(),
            folder: std::env::current_dir().unwrap_or_default(),
            onboarding: Onboarding::default(),
            opening_lesson: None,
            lesson: None,
            base_workspace: Workspace::Inspect,
            first_pick: FirstPick::Due,
        }
    }

    /// Returns the size of the picture, at least one pixel in each direction.
    pub(crate) fn viewport(&self) -> Viewport {
        let (width, height) = match self.state.size {
            PictureSize::MatchWindow => self.canvas_px,
            PictureSize::Fixed(width, height) => (width, height),
        };
        Viewport { width: width.max(1), height: height.max(1) }
    }

    /// Whether the size of the picture is known. Before the first layout pass, the size of the canvas is not.
    pub(crate) fn has_size(&self) -> bool {
        self.state.size != PictureSize::MatchWindow || self.canvas_px != (0, 0)
    }

    /// Returns the current request for the renderer.
    pub(crate) fn request(&self) -> Request {
        Request {
            scene: self.scene.clone(),
            camera: self.state.camera,
            recipe: self.state.recipe,
            viewport: self.viewport(),
            shown: self.shown,
            triangle_limit: self.triangle_limit,
            fragment_limit: self.scrub.fragment_limit(self.triangle_limit),
            pick: self.pick,
            look: Look {
                display: self.range.setting(self.shown).display,
                statistics: self.range.measures(self.shown),
                layers: self.overlays.layers.clone(),
                vectors: self.overlays.vectors,
            },
        }
    }

    /// Returns the current comparison request; `None` if comparison is off.
    pub(crate) fn compare_request(&self) -> Option<CompareRequest> {
        let CompareSettings { mode, reference, region, difference, gain, .. } = self.comparison;
        let shows_difference = mode == Mode::Difference;
        let tiles = 0..self.comparison.shown(&self.state.tiles);
        self.comparison.is_on().then(|| CompareRequest {
            scene: self.scene.clone(),
            camera: self.state.camera,
            viewport: self.viewport(),
            recipes: tiles.map(|tile| self.state.tiles.recipe(tile, self.state.recipe)).collect(),
            reference,
            region,
            difference: shows_difference.then_some((difference, gain)),
        })
    }

    /// Replaces the scene. Resets the camera, the pick and the playback. The recipe stays, except
    /// for the light of a scene that has one.
    pub(crate) fn show_scene(&mut self, scene: Scene, source: SceneSource) {
        if let SceneSource::File(path, _) = &source {
            self.remember(path);
        }
        self.report(Severity::Info, format!("Opened {}: {} triangles", scene.name, scene.triangle_count()));
        self.state.camera = scene.home;
        self.state.recipe.take_light(&scene, Some(&self.scene));
        (self.messages.offered_picture, self.messages.notice) = (None, None);
        self.close_case();
        let is_shown = |lesson: &&BlackPixelLesson| source.name() == Path::new(lesson.scene);
        self.lesson = self.opening_lesson.take().filter(is_shown);
        self.scene = Arc::new(scene);
        self.source = source;
        self.mirrored = false;
        (self.triangle_limit, self.scrub.playing) = (None, 0);
        self.vertices.selected = None;
        self.mesh_view.leave_scene();
        (self.pick, self.first_pick) = (None, FirstPick::Due);
        (self.stages, self.tasks.measuring, self.compared, self.filmstrip.drawn) = (None, None, None, None);
        (self.selection, self.fates) = Default::default();
        self.timings.clear();
        self.messages.error = None;
        self.arrive();
        // Undo must not restore a camera of another scene.
        self.history.undo.clear();
        self.history.redo.clear();
        self.history.settled = self.state.clone();
        if let Some(lesson) = self.lesson {
            // Undo restores the settings from before the lesson.
            self.state.recipe = lesson.recipe();
            self.shown = Shown::Buffer(Buffer::Color);
            self.show_workspace(Workspace::Inspect);
        }
    }

    /// Returns the newest view from the renderer if it shows the current scene, otherwise `None`.
    pub(crate) fn view_of_scene(&self) -> Option<&RenderedView> {
        self.view.as_ref().filter(|view| Arc::ptr_eq(&view.request.scene, &self.scene))
    }

    /// Picks a pixel automatically if the user has not picked one, or if the pick is outside the picture. Chooses the
    /// black spot of the lesson, or otherwise the pixel nearest to [`FIRST_PICK`] that shows a triangle.
    pub(crate) fn pick_by_itself(&mut self) {
        let Some(view) = self.view_of_scene() else { return };
        let viewport = view.frame.viewport;
        if viewport != self.viewport() {
            return;
        }
        let is_wanted = match (self.first_pick, self.pick) {
            (FirstPick::Due, None) => true,
            (FirstPick::Made(own, of), Some(pick)) if own == pick => of != viewport,
            (_, Some((x, y))) => x >= viewport.width || y >= viewport.height,
            (_, None) => false,
        };
        if is_wanted {
            let Viewport { width, height } = viewport;
            let place = ((width as f32 * FIRST_PICK.0) as u32, (height as f32 * FIRST_PICK.1) as u32);
            let spot = self.lesson.and_then(|lesson| lesson.black_pixel(&view.frame));
            let pick = spot.or_else(|| nearest_drawn(&view.frame, place)).unwrap_or(place);
            (self.pick, self.first_pick) = (Some(pick), FirstPick::Made(pick, viewport));
        } else if !matches!((self.first_pick, self.pick), (FirstPick::Made(own, _), Some(pick)) if own == pick) {
            self.first_pick = FirstPick::Done;
        }
    }

    /// Applies a command to this state. If work is left for the window, such as file access, returns a command for it.
    pub(crate) fn apply(&mut self, command: Command) -> Option<Command> {
        match self.lab.claim(command)? {
            Command::ToggleLab => {
                self.show_workspace(if self.lab.open { self.base_workspace } else { Workspace::Lab });
            }
            Command::Lab(change) => return self.lab.apply(change).map(Command::Lab),
            Command::Trace(change) => return self.trace.apply(change, self.view.as_ref()).map(Command::Trace),
            Command::Place(change) => return self.change_places(change),
            Command::WhatIf(change) => return self.change_what_if(change),
            Command::Watch(change) => self.change_watch(change),
            Command::SetRecipe(recipe) => {
                if recipe.upscaler.method() != self.state.recipe.upscaler.method() {
                    recipe.upscaler.upscaler().retry();
                }
                self.state.recipe = recipe;
            }
            Command::ApplyRemedy(remedy) => remedy.apply(&mut self.state.recipe, &mut self.state.camera),
            Command::ChooseUpscaler(place) => {
                let method = upscale::all().get(place).map(|u| u.id());
                let chosen = self.state.recipe.upscaler;
                if let Some(upscaler) = method.and_then(|id| chosen.with_method(id)) {
                    upscaler.upscaler().retry();
                    self.state.recipe.upscaler = upscaler;
                }
            }
            Command::Overlays(change) => return self.overlays.apply(change).map(Command::Overlays),
            Command::Range(change) => self.range.apply(change, self.shown, self.view.as_ref()),
            Command::Compare(CompareChange::ToggleRegion) if !self.comparison.is_on() => {
                self.range.apply(range::RangeChange::Reset, self.shown, None);
            }
            Command::Compare(change) => self.compare(change),
            Command::Filmstrip(change) => self.filmstrip.apply(change),
            Command::Checks(change) => self.checks.apply(change),
            Command::Vertices(change) => self.vertices.apply(change),
            Command::MeshView(change) => mesh_view::apply(self, change),
            Command::MirrorZ => self.mirror_z(),
            Command::SetCamera(camera) => self.state.camera = camera,
            Command::SetSize(size) => self.state.size = size,
            Command::ResetCamera => self.state.camera = self.scene.home,
            Command::FitCamera => {
                let Viewport { width, height } = self.viewport();
                self.state.camera = self.state.camera.refit(self.scene.bounds(), width as f32 / height as f32);
            }
            Command::RestartUpscalers => {
                upscale::all().iter().for_each(|upscaler| upscaler.retry());
                // All pictures of the old scene object count as outdated.
                self.scene = Arc::new(Scene::clone(&self.scene));
            }
            Command::ResetRecipe => self.state.recipe = Recipe::default(),
            Command::Pick(pixel) => self.pick = pixel,
            Command::NudgePick(dx, dy) => self.nudge(dx, dy),
            Command::Show(shown) => self.show(shown),
            Command::SelectStage(stage) => self.select_stage(stage),
            Command::StepStage(steps) => self.select_stage(self.selected_stage.stepped(steps)),
            Command::LimitTriangles(limit) => {
                self.scrub(scrub::ScrubChange::Go(Moment::after(limit.unwrap_or(self.triangle_count()))));
            }
            Command::StepTriangle(step) => {
                self.scrub(scrub::ScrubChange::Step(Unit::Triangle, step > 0));
            }
            Command::Scrub(change) => return self.scrub(change).and_then(|command| self.apply(command)),
            Command::SetPointerMode(mode) => self.pointer_mode = mode,
            Command::TogglePointerMode(mode) => self.pointer_mode = self.pointer_mode.toggled(mode),
            Command::Undo => self.travel(true),
            Command::Redo => self.travel(false),
            Command::CloseCase => self.close_case(),
            Command::ShowPart(part) => {
                if let Some(open) = &mut self.case {
                    open.part = part;
                }
            }
            Command::SetCaseOptions(options) => self.set_case_options(options),
            Command::OpenWorst(column, json) => self.open_worst(column, &json),
            Command::Fates(change) => self.fates.apply(change, &mut self.selection),
            Command::Select(selection) => self.fates.adopt_selection(selection, &mut self.selection),
            Command::ShowStability(view) => self.tasks.stability.view = view,
            Command::OpenInLab(path) => self.open_in_lab(&path),
            Command::CloseOffer => self.messages.offered_picture = None,
            Command::CloseNotice => self.messages.notice = None,
            Command::CloseError => self.messages.error = None,
            Command::Onboarding(change) => self.onboarding.apply(change),
            Command::Timings(change) => self.timings.apply(change),
            Command::MeasureOver(turn) => self.timings.turn = turn,
            Command::PauseTimings => self.timings.paused ^= true,
            other => return Some(other),
        }
        None
    }

    /// Changes the comparison. A comparison shows final colours only.
    pub(in crate::ui) fn compare(&mut self, change: CompareChange) {
        let Undoable { tiles, recipe, .. } = &mut self.state;
        self.comparison.apply(change, tiles, recipe);
        if self.comparison.is_on() {
            self.shown = Shown::Buffer(Buffer::Color);
        }
    }

    /// Returns the number of triangles that are rasterized if the frame on screen is drawn completely.
    pub(crate) fn triangle_count(&self) -> usize {
        self.view.as_ref().map_or(0, |view| view.rasterized)
    }

    /// Returns the next or previous pixel with a coverage fault (a crack or a double hit) in row-major order, starting
    /// from the picked pixel and wrapping around. Without a pick, returns the first or last one. If an overlay of
    /// faults is active, steps through its pixels instead. Returns `None` if there is no such pixel or hits were not
    /// counted.
    pub(crate) fn fault_beside_pick(&self, forwards: bool) -> Option<(u32, u32)> {
        if self.overlays.stepped().is_some() {
            return self.overlays.beside(self.view.as_ref()?, self.pick, forwards);
        }
        let hits = self.view.as_ref()?.buffers.as_ref()?.hits.as_ref()?;
        hits.neighbour(self.pick, forwards).map(|fault| (fault.x, fault.y))
    }

    /// Loads a picture file into the canvas of the 2D lab.
    pub(crate) fn open_picture(&mut self, path: &Path) {
        match file::read(path) {
            Ok(picture) => self.lab.show_picture(&picture),
            Err(error) => self.report(Severity::Error, error.to_string()),
        }
    }

    /// Opens a picture file in the lab. The scene stays loaded and reappears when the lab is closed.
    fn open_in_lab(&mut self, path: &Path) {
        self.messages.offered_picture = None;
        match file::read(path) {
            Ok(picture) => {
                self.lab.apply(lab::LabChange::Open(true));
                self.lab.show_picture(&picture);
                self.report(Severity::Info, format!("Opened {} in the 2D lab", path.display()));
            }
            Err(error) => self.report(Severity::Error, error.to_string()),
        }
    }

    fn mirror_z(&mut self) {
        self.scene = Arc::new(self.scene.mirrored_z());
        self.mirrored = !self.mirrored;
        for state in self
            .history
            .undo
            .iter_mut()
            .chain(&mut self.history.redo)
            .chain([&mut self.state, &mut self.history.settled])
        {
            state.camera = state.camera.mirrored_z();
        }
    }

    fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(RECENT_FILES);
    }

    fn nudge(&mut self, dx: i64, dy: i64) {
        let Viewport { width, height } = self.viewport();
        if let Some((x, y)) = self.pick {
            let x = (i64::from(x) + dx).clamp(0, i64::from(width) - 1);
            let y = (i64::from(y) + dy).clamp(0, i64::from(height) - 1);
            self.pick = Some((x as u32, y as u32));
        }
    }

    fn select_stage(&mut self, stage: Stage) {
        self.selected_stage = stage;
        if matches!(self.shown, Shown::Stage(_)) {
            self.show(Shown::Stage(stage));
        }
    }

    /// Returns the picture after the stage that lies `steps` stages after the shown one. If no stage is shown, the
    /// finished picture counts as the last stage.
    pub(crate) fn stage_beside_shown(&self, steps: i64) -> Shown {
        let now = match self.shown {
            Shown::Stage(stage) => stage,
            Shown::Buffer(_) | Shown::Intermediate(_) => Stage::Upscale,
        };
        Shown::Stage(now.stepped(steps))
    }

    /// Shows a buffer, a stage or an intermediate value. A shown stage is also selected in the pipeline panel.
    pub(crate) fn set_shown(&mut self, shown: Shown) {
        self.shown = shown;
        if let Shown::Stage(stage) = shown {
            self.selected_stage = stage;
        }
    }

    /// Shows a buffer, a stage or an intermediate value. Ends the comparison unless the final colour is shown, because
    /// the comparison shows only finished pictures. If it continued, the inspector would describe values that are not
    /// on the canvas.
    fn show(&mut self, shown: Shown) {
        self.set_shown(shown);
        if shown != Shown::Buffer(Buffer::Color) {
            self.comparison.mode = Mode::Off;
        }
    }
}

/// Returns the pixel nearest to `place` whose stored depth is strictly between 0 and 1, which means that a triangle was
/// drawn there. Returns `None` if there is no such pixel or no depth buffer.
fn nearest_drawn(frame: &Frame, place: (u32, u32)) -> Option<(u32, u32)> {
    let depth = frame.drawn.depth.as_ref()?;
    let pixels = (0..depth.height()).flat_map(|row| (0..depth.width()).map(move |column| (column, row)));
    pixels
        .filter(|(column, row)| (f32::MIN_POSITIVE..1.0).contains(&depth.at(*column, *row)))
        .map(|sample| frame.pixel_of(sample))
        .min_by_key(|(x, y)| u64::from(x.abs_diff(place.0)).pow(2) + u64::from(y.abs_diff(place.1)).pow(2))
}

#[cfg(test)]
pub(in crate::ui) mod tests;
