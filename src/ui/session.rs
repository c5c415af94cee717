//! State of the window as plain data: the scene, its settings, the view of the results, and the state of all tools.
//!
//! Panels read this state and push [`Command`]s, which only [`Session::apply`] applies. Widgets store no settings. Each tool
//! has a module with its state and its changes; [`features`] lists them.

pub(crate) mod feature;
pub(crate) mod file_command;
pub(crate) mod layout;
mod messages;
pub(crate) mod picture_role;
pub(crate) mod preferences;
pub(crate) mod save_item;
pub(crate) mod tile_set;
mod undo;
pub(crate) mod window_task;
pub(crate) mod workspace;

pub(crate) mod appearance;
pub(crate) mod camera_path;
pub(crate) mod canvas_state;
pub(crate) mod checks;
pub mod compare;
pub(crate) mod explaining;
pub(crate) mod fates;
pub(crate) mod files;
pub(crate) mod filmstrip;
pub(crate) mod first_pick;
pub(crate) mod lab;
pub(crate) mod long_tasks;
pub(crate) mod mesh_view;
pub(crate) mod onboarding;
pub(crate) mod open_case;
pub(crate) mod over_time;
pub(crate) mod overlays;
pub(crate) mod picked_point;
pub(crate) mod place;
pub(crate) mod probe;
pub(crate) mod project;
pub(crate) mod range;
pub(crate) mod scene_time;
pub(crate) mod scrub;
pub(crate) mod sequences;
pub(crate) mod stages;
pub(crate) mod temporal;
pub(crate) mod timings;
pub(crate) mod trace;
pub(crate) mod vertices;
pub(crate) mod watch;
pub(crate) mod what_if;
pub(crate) mod workspaces;

pub(crate) mod command;
pub(crate) mod features;
mod routing;

pub(crate) use messages::Dismissal;
pub(crate) use messages::Messages;
pub(crate) use messages::Notice;
pub(crate) use messages::Severity;
pub(crate) use preferences::PictureSize;
pub(crate) use preferences::PointerMode;
pub(crate) use preferences::Preferences;
pub(crate) use preferences::WindowState;
use undo::UndoHistory;
pub(crate) use undo::Undoable;

use std::sync::Arc;

use super::engine::{Look, RenderedView, Request, Shown};
use crate::chain::Recipe;
use crate::inspect::{Buffer, TriangleSelection};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene, SceneSource};
use crate::upscale;
use command::Command;
use compare::{CompareChange, Mode};
use fates::FatesChange;
use features::Features;
use tile_set::TileSet;
use window_task::WindowTask;
use workspace::Workspace;

/// Angle by which a key orbits the camera, in radians: 5°.
const ORBIT_STEP: f32 = 5.0 * std::f32::consts::PI / 180.0;

/// State of the window, apart from widgets: the document, the selection, and the state of all features.
#[derive(Debug)]
pub(crate) struct Session {
    /// Scene on screen.
    pub(crate) scene: Arc<Scene>,
    /// Source of the scene: a built-in scene or a file.
    pub(crate) source: SceneSource,
    /// Whether the scene is mirrored along z relative to its source.
    pub(crate) mirrored: bool,
    /// State that can be undone and redone.
    pub(crate) state: Undoable,
    /// Buffer, stage or intermediate value shown on the canvas.
    pub(crate) shown: Shown,
    /// Column and row of the picked pixel.
    pub(crate) pick: Option<(u32, u32)>,
    /// Selected triangles, highlighted in the picture, in tables and on meshes.
    pub(crate) selection: TriangleSelection,
    /// Newest view from the renderer.
    pub(crate) view: Option<RenderedView>,
    /// State of all features.
    pub(crate) features: Features,
    history: UndoHistory,
}

impl Session {
    /// Creates a session that shows a scene with a recipe and a camera.
    pub(crate) fn new(scene: Arc<Scene>, source: SceneSource, recipe: Recipe, camera: Camera) -> Self {
        let state = Undoable { recipe, camera, size: PictureSize::default(), tiles: TileSet::default() };
        Self {
            scene,
            source,
            mirrored: false,
            history: UndoHistory::new(&state),
            state,
            shown: Shown::Buffer(Buffer::Color),
            pick: None,
            selection: TriangleSelection::default(),
            view: None,
            features: Features::default(),
        }
    }

    /// Returns the size of the picture, at least one pixel in each direction.
    pub(crate) fn viewport(&self) -> Viewport {
        let (width, height) = match self.state.size {
            PictureSize::MatchWindow => self.features.canvas.size_px,
            PictureSize::Fixed(width, height) => (width, height),
        };
        Viewport { width: width.max(1), height: height.max(1) }
    }

    /// Whether the size of the picture is known. Before the first layout pass, the size of the canvas is not.
    pub(crate) fn has_size(&self) -> bool {
        self.state.size != PictureSize::MatchWindow || self.features.canvas.size_px != (0, 0)
    }

    /// Returns the current request for the renderer.
    pub(crate) fn request(&self) -> Request {
        Request {
            scene: self.scene.clone(),
            camera: self.state.camera,
            recipe: self.state.recipe,
            sequence: self.shot_frame(),
            is_replayed: true,
            viewport: self.viewport(),
            shown: self.shown,
            triangle_limit: self.features.scrub.triangle_limit,
            fragment_limit: self.features.scrub.fragment_limit(),
            pick: self.pick,
            look: Look {
                display: self.features.range.setting(self.shown).display,
                statistics: self.features.range.measures(self.shown),
                layers: self.features.overlays.layers.clone(),
                vectors: self.features.overlays.vectors,
            },
        }
    }

    /// Replaces the scene. Resets the camera, the pick and what the features know of the previous scene; the recipe
    /// stays, except for the light of a scene that has one.
    pub(crate) fn show_scene(&mut self, scene: Scene, source: SceneSource) {
        if let SceneSource::File(path, _) = &source {
            self.features.files.remember(path);
        }
        self.report(Severity::Info, format!("Opened {}: {} triangles", scene.name, scene.triangle_count()));
        self.state.camera = scene.home;
        self.state.recipe.take_light(&scene, Some(&self.scene));
        self.scene = Arc::new(scene);
        self.source = source;
        self.mirrored = false;
        (self.pick, self.selection) = Default::default();
        self.features.leave_scene();
        let lesson = self.features.onboarding.arrive(&self.source);
        self.arrive();
        // Undo must not restore a camera of another scene.
        self.history.restart(&self.state);
        if let Some(lesson) = lesson {
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

    /// Applies a command to this state. Returns a task if the window must complete the command.
    pub(crate) fn apply(&mut self, command: Command) -> Option<WindowTask> {
        let command = self.features.lab.claim(command)?;
        self.redirect_playback(command).apply(self)
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
        if self.features.overlays.stepped().is_some() {
            return self.features.overlays.beside(self.view.as_ref()?, self.pick, forwards);
        }
        let hits = self.view.as_ref()?.buffers.as_ref()?.hits.as_ref()?;
        hits.neighbour(self.pick, forwards).map(|fault| (fault.x, fault.y))
    }

    pub(super) fn mirror_z(&mut self) {
        self.scene = Arc::new(self.scene.mirrored_z());
        self.mirrored = !self.mirrored;
        for state in self.history.states().chain([&mut self.state]) {
            state.camera = state.camera.mirrored_z();
        }
    }

    pub(super) fn choose_upscaler(&mut self, place: usize) {
        let method = upscale::all().get(place).map(|u| u.id());
        let chosen = self.state.recipe.upscaler;
        if let Some(upscaler) = method.and_then(|id| chosen.with_method(id)) {
            upscaler.upscaler().retry();
            self.state.recipe.upscaler = upscaler;
        }
    }

    pub(super) fn set_recipe(&mut self, recipe: Recipe) {
        if recipe.upscaler.method() != self.state.recipe.upscaler.method() {
            recipe.upscaler.upscaler().retry();
        }
        self.state.recipe = recipe;
    }

    /// Starts failed upscaler processes again.
    pub(super) fn restart_upscalers(&mut self) {
        upscale::all().iter().for_each(|upscaler| upscaler.retry());
        // All pictures of the old scene object count as outdated.
        self.scene = Arc::new(Scene::clone(&self.scene));
    }

    pub(super) fn fit_camera(&mut self) {
        let Viewport { width, height } = self.viewport();
        self.state.camera = self.state.camera.refit(self.scene.bounds(), width as f32 / height as f32);
    }

    /// Orbits the camera so that the scene turns by this many steps to the right and downwards.
    pub(super) fn orbit(&mut self, right: i8, down: i8) {
        self.state.camera.orbit(f32::from(right) * ORBIT_STEP, f32::from(down) * ORBIT_STEP);
    }

    /// Picks the next or the previous fault (a crack or double hit), starting at the picked pixel. Returns the pixel. If
    /// no faults are shown, shows the hit count instead.
    pub(super) fn step_fault(&mut self, forwards: bool) -> Option<(u32, u32)> {
        if self.shown != Shown::Buffer(Buffer::Hits) && self.features.overlays.stepped().is_none() {
            self.shown = Shown::Buffer(Buffer::Hits);
            return None;
        }
        let pixel = self.fault_beside_pick(forwards)?;
        self.pick = Some(pixel);
        Some(pixel)
    }

    /// Moves the pick, within the picture. Returns the picked pixel.
    pub(super) fn nudge(&mut self, dx: i64, dy: i64) -> Option<(u32, u32)> {
        let Viewport { width, height } = self.viewport();
        let (x, y) = self.pick?;
        let x = (i64::from(x) + dx).clamp(0, i64::from(width) - 1);
        let y = (i64::from(y) + dy).clamp(0, i64::from(height) - 1);
        self.pick = Some((x as u32, y as u32));
        self.pick
    }

    /// Performs the first applicable action: closes the introduction, closes the case, clears the selection, clears the
    /// pick, hides the probe's heat map, ends the comparison, or shows the colour buffer of the complete frame.
    pub(super) fn escape(&mut self) {
        if self.features.onboarding.escape() {
            return;
        }
        if self.features.case.is_some() {
            self.close_case();
        } else if !self.selection.is_empty() {
            self.features.fates.apply(FatesChange::Clear, &mut self.selection);
        } else if self.pick.take().is_some() || self.features.probing.hide() {
        } else if self.features.comparison.is_on() {
            self.compare(CompareChange::Mode(Mode::Off));
        } else {
            self.shown = Shown::Buffer(Buffer::Color);
            self.limit_triangles(None);
        }
    }

    /// Shows a buffer, a stage or an intermediate value. A shown stage is also selected in the pipeline panel.
    pub(crate) fn set_shown(&mut self, shown: Shown) {
        self.shown = shown;
        if let Shown::Stage(stage) = shown {
            self.features.stages.selected = stage;
        }
    }

    /// Shows a buffer, a stage or an intermediate value. Ends the comparison unless the final colour is shown, because
    /// the comparison shows only finished pictures. If it continued, the inspector would describe values that are not
    /// on the canvas.
    pub(super) fn show(&mut self, shown: Shown) {
        self.set_shown(shown);
        if shown != Shown::Buffer(Buffer::Color) {
            self.features.comparison.mode = Mode::Off;
        }
    }
}

#[cfg(test)]
pub(in crate::ui) mod tests;
