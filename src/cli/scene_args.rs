//! Options for scene, camera and settings, shared by all commands that draw.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use crate::chain::{Frame, PrecedingView, Recipe, RenderInputs, Renderer, SettingKey, run};
use crate::inspect::project::{LoadedProject, Project};
use crate::inspect::scrub::{Moment, Scrubber};
use crate::pipeline::settings::{Arithmetic, Choice as _, Rasterizer};
use crate::pipeline::viewport::Viewport;
use crate::scene::obj::TrMeaning;
use crate::scene::{
    Camera, LoadControl, Loaded, MemoryLimit, Scene, SceneFormat, SceneSource, Warning, builtin, camera_file,
};
use clap::Args;

use super::failure::Failure;
use super::parse::Up;
use super::progress::ProgressLine;
use super::upscaler_args::UpscalerArgs;
use super::{output, parse};

/// Options for scene, camera and settings.
#[derive(Args, Clone, Debug)]
pub(crate) struct SceneArgs {
    #[arg(help = scene_help())]
    scene: Option<PathBuf>,

    /// Setting to change; may be given several times, in any order
    #[arg(long, value_name = "KEY=VALUE", long_help = set_help())]
    set: Vec<String>,

    /// Algorithm that finds covered samples; the same as --set rasterizer=R
    #[arg(long, value_name = "R", value_parser = parse::choice::<Rasterizer>())]
    rasterizer: Option<Rasterizer>,

    /// Arithmetic that decides coverage; the same as --set arithmetic=A
    #[arg(long, value_name = "A", value_parser = parse::choice::<Arithmetic>())]
    arithmetic: Option<Arithmetic>,

    /// Mirror the scene in z, for models of the opposite handedness
    #[arg(long)]
    mirror_z: bool,

    /// Axis that points up in the scene's home view; `auto` guesses it from the model
    #[arg(long, value_name = "AXIS", default_value = "auto", conflicts_with = "camera", value_parser = parse::up())]
    up: Up,

    /// View of the scene by the name of a camera in its file, instead of the home view
    #[arg(long, value_name = "NAME", conflicts_with_all = ["camera", "up"])]
    view: Option<String>,

    /// Meaning of `Tr` in material libraries: transparency (0 is opaque) or opacity; `auto` guesses it from the file
    #[arg(long, value_name = "MEANING", default_value = "auto", value_parser = parse::tr())]
    tr: TrMeaning,

    /// Time at which a scene in motion is shown, in seconds; the motion repeats [default: 0]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = parse::seconds)]
    time: Option<f64>,

    #[command(flatten)]
    memory: MemoryArgs,

    #[command(flatten)]
    upscalers: UpscalerArgs,

    /// Camera, as JSON or as a path to a JSON file
    #[arg(long, value_name = "FILE.json", long_help = CAMERA_HELP)]
    camera: Option<PathBuf>,
}

/// Option for the memory limit when loading models.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct MemoryArgs {
    /// Memory limit for the meshes and textures of a model, in MiB
    #[arg(long, value_name = "MIB", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..))]
    memory: u32,
}

impl MemoryArgs {
    /// Loads a scene. After one second, prints progress to standard error if that is a terminal.
    pub(crate) fn load(self, source: &SceneSource) -> Result<Loaded, Failure> {
        let (begun, line) = (Instant::now(), ProgressLine::new());
        let percent = AtomicU32::new(0);
        let progress = |completed: f32| {
            let now = (100.0 * completed) as u32;
            let is_news = percent.swap(now, Ordering::Relaxed) != now;
            if is_news && begun.elapsed() > SLOW_LOAD {
                line.show_share("loading", completed);
            }
        };
        let control = LoadControl { progress: &progress, ..LoadControl::quiet(self.limit()) };
        Ok(source.load_with(control)?)
    }

    /// Returns the memory limit for loading a model.
    pub(crate) fn limit(self) -> MemoryLimit {
        MemoryLimit::mib(self.memory)
    }
}

/// Time after which loading progress is printed.
const SLOW_LOAD: Duration = Duration::from_secs(1);

const CAMERA_HELP: &str = "Camera in world space, as JSON or as a path to a JSON file, for example\n\
    {\"eye\": [0, 1, 5], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov_y_degrees\": 45, \
    \"near\": 0.1, \"far\": 100}\n\
    `up` can be omitted, `fov_y_radians` can replace `fov_y_degrees`, and `height` (in world units) instead of the \
    angle gives an orthographic view. Default: the scene's home view";

/// Returns the help text of `--set`: every key with its accepted values, and an example.
fn set_help() -> String {
    let mut help = "Setting to change; may be given several times, in any order. Keys and their values:\n".to_owned();
    for key in SettingKey::ALL {
        help.push_str(&format!("  {}: {}\n", key.id(), key.values()));
    }
    help.push_str("Example: --set shading=gouraud --set light.direction=1,0.5,0");
    help
}

/// Environment variable of a restarted process. It is set if the warnings about the model have already been printed.
pub(crate) const WARNED: &str = "RASTERSCOPE_WARNED";

/// Scene, camera and recipe requested by the shared options.
#[derive(Clone, Debug)]
#[cfg_attr(not(feature = "ui"), expect(dead_code, reason = "only the workbench needs all of it"))]
pub(crate) struct RequestedView {
    pub(crate) source: SceneSource,
    pub(crate) scene: Arc<Scene>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) recipe: Recipe,
    pub(crate) camera: Camera,
    /// Whether the scene is mirrored in z relative to its source.
    #[cfg_attr(not(feature = "ui"), expect(dead_code, reason = "only the window mirrors it back"))]
    pub(crate) mirrored: bool,
    /// Whether the options that select scene, home view, camera and recipe have their default values.
    pub(crate) is_default: bool,
    /// Project file that gave the scene, for what the other fields do not hold.
    #[cfg_attr(not(feature = "ui"), expect(dead_code, reason = "only the window restores it"))]
    pub(crate) project: Option<Box<Project>>,
    /// Memory limit for models that the user opens later.
    #[cfg_attr(not(feature = "ui"), expect(dead_code, reason = "only the window opens others"))]
    pub(crate) memory_limit: MemoryLimit,
}

impl RequestedView {
    /// Returns a copy of the recipe with the given settings of `--against` applied.
    pub(crate) fn against(&self, settings: &[String]) -> Result<Recipe, Failure> {
        let mut recipe = self.recipe;
        recipe.set_all(settings).map_err(|error| Failure::Usage(format!("--against {error}")))?;
        Ok(recipe)
    }
}

impl SceneArgs {
    /// Loads the scene, and reads the camera and the recipe. Warnings of the loader go to standard error.
    pub(crate) fn view(&self) -> Result<RequestedView, Failure> {
        self.upscalers.register()?;
        // Invalid options are reported before the scene is loaded.
        self.recipe(Recipe::default())?;
        let camera = self.camera.as_deref().map(camera).transpose()?;
        let loaded = self.project()?;
        let warnings_of_project = loaded.iter().flat_map(|loaded| &loaded.warnings);
        warnings_of_project.for_each(|warning| output::report("warning", warning));
        let project = loaded.map(|loaded| loaded.project);
        let source = match &project {
            Some(project) if self.tr == TrMeaning::Auto => project.source(),
            Some(project) => project.source().with_tr(self.tr),
            None => source(self.scene.as_deref())?.with_tr(self.tr),
        };
        let state = project.as_ref().map(Project::state);
        let Loaded { scene, warnings, notes } = self.memory.load(&source)?;
        if std::env::var_os(WARNED).is_none() {
            warnings.iter().for_each(|warning| output::report("warning", warning));
            notes.iter().for_each(|note| output::report("note", note));
        }
        let mirrored = self.mirror_z || state.as_ref().is_some_and(|state| state.mirrored);
        let mut scene = if mirrored { scene.mirrored_z() } else { scene };
        if let Up::Axis(up) = self.up {
            scene.home = scene.first_view(up);
        }
        let scene = self.posed(&Arc::new(scene), state.as_ref().map_or(0.0, |state| state.time_s));
        let mut recipe = Recipe::default();
        recipe.take_light(&scene, None);
        recipe = state.as_ref().map_or(recipe, |state| state.recipe);
        let stored = state.map(|state| state.camera).filter(|_| self.up == Up::Auto);
        let view = self.view.as_deref().map(|name| view(&scene, name)).transpose()?;
        Ok(RequestedView {
            recipe: self.recipe(recipe)?,
            camera: camera.or(view).or(stored).unwrap_or(scene.home),
            source,
            scene,
            warnings,
            mirrored,
            project: project.map(Box::new),
            is_default: self.is_default(),
            memory_limit: self.memory.limit(),
        })
    }

    /// Returns the scene at the time of the options, or else at the time that its project stores, in seconds.
    fn posed(&self, scene: &Arc<Scene>, stored_s: f64) -> Arc<Scene> {
        if self.time.is_some() && scene.animation.is_none() {
            output::report("note", "the scene does not move: --time has no effect");
        }
        scene.at(self.time.unwrap_or(stored_s))
    }

    /// Reads the project file that the options name; returns `None` if they name something else.
    pub(crate) fn project(&self) -> Result<Option<LoadedProject>, Failure> {
        let path = self.scene.as_deref().filter(|path| Project::is_named(path));
        Ok(path.map(Project::read).transpose()?)
    }

    fn is_default(&self) -> bool {
        let keeps_recipe = self.set.is_empty() && self.rasterizer.is_none() && self.arithmetic.is_none();
        let keeps_view = self.camera.is_none() && self.view.is_none() && self.time.is_none();
        keeps_recipe && keeps_view && !self.mirror_z && self.up == Up::Auto && self.scene.is_none()
    }

    /// Returns the recipe with the settings of the options.
    fn recipe(&self, mut recipe: Recipe) -> Result<Recipe, Failure> {
        recipe.set_all(&self.set)?;
        let settings = &mut recipe.pipeline;
        settings.rasterizer = self.rasterizer.unwrap_or(settings.rasterizer);
        settings.arithmetic = self.arithmetic.unwrap_or(settings.arithmetic);
        Ok(recipe)
    }
}

/// Returns the help text of the argument that names a scene.
fn scene_help() -> String {
    let formats = SceneFormat::names();
    format!(
        "Id of a built-in scene (see `rasterscope scenes`), path of a model ({formats}), or path of a project \
         (.rasterscope), whose camera, settings and size other options override; the first built-in scene if omitted"
    )
}

/// Returns the camera of a view that the file of the scene defines.
fn view(scene: &Scene, name: &str) -> Result<Camera, Failure> {
    let known = || match scene.views.as_slice() {
        [] => "its file has no cameras".to_owned(),
        views => {
            format!("its views are {}", views.iter().map(|view| view.name.as_str()).collect::<Vec<_>>().join(", "))
        }
    };
    let found = scene.views.iter().find(|view| view.name == name).map(|view| view.camera);
    found.ok_or_else(|| Failure::Usage(format!("--view {name}: the scene has no such view; {}", known())))
}

/// Reads a camera from a file, or from the argument itself if it starts with `{`.
fn camera(given: &Path) -> Result<Camera, Failure> {
    match given.to_str().filter(|text| text.trim_start().starts_with('{')) {
        Some(text) => camera_file::parse(text).map_err(|reason| Failure::Usage(format!("--camera: {reason}"))),
        None => Ok(camera_file::read(given)?),
    }
}

/// Returns the source of a scene: a built-in scene if `name` is its id, otherwise a file. Without a name, returns the
/// first built-in scene.
pub(crate) fn source(name: Option<&Path>) -> Result<SceneSource, Failure> {
    let Some(name) = name else { return Ok(SceneSource::default()) };
    let source = SceneSource::named(name.to_owned());
    let is_bare_word = name.extension().is_none() && name.components().count() == 1;
    if matches!(source, SceneSource::File(..)) && is_bare_word && !name.exists() {
        let known: Vec<_> = builtin::ALL.iter().map(|b| b.id).collect();
        return Err(Failure::UnknownScene { name: name.to_owned(), known: known.join(", ") });
    }
    Ok(source)
}

/// Scene that an argument names, as a file or as part of a project.
pub(crate) struct NamedScene {
    pub(crate) scene: Scene,
    /// Home view of the scene, or the camera of the project.
    pub(crate) camera: Camera,
    /// Default recipe with the light of the scene, or the recipe of the project.
    pub(crate) recipe: Recipe,
    /// Size of the project's picture, in pixels; `None` without a project.
    pub(crate) size: Option<Viewport>,
}

/// Loads a scene by its name or by a project. Warnings go to standard error.
pub(crate) fn named_scene(name: Option<&Path>, memory: MemoryArgs) -> Result<NamedScene, Failure> {
    let project = name.filter(|path| Project::is_named(path)).map(Project::read).transpose()?;
    let source = project.as_ref().map_or_else(|| source(name), |loaded| Ok(loaded.project.source()))?;
    let Loaded { scene, warnings, .. } = memory.load(&source)?;
    let warnings = project.iter().flat_map(|loaded| &loaded.warnings).chain(&warnings);
    warnings.for_each(|warning| output::report("warning", warning));
    let Some(LoadedProject { project, .. }) = project else {
        let mut recipe = Recipe::default();
        recipe.take_light(&scene, None);
        return Ok(NamedScene { camera: scene.home, scene, recipe, size: None });
    };
    let state = project.state();
    let scene = Arc::new(if state.mirrored { scene.mirrored_z() } else { scene }).at(state.time_s);
    let scene = Arc::unwrap_or_clone(scene);
    Ok(NamedScene { scene, camera: state.camera, recipe: state.recipe, size: Some(project.size()) })
}

/// Options for scene, camera, recipe and size of one frame.
#[derive(Args, Clone, Debug)]
pub(crate) struct FrameArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// Width and height of the picture in pixels [default: that of the project, or 1280x720]
    #[arg(long, visible_alias = "picture", value_name = "WxH", value_parser = parse::size)]
    size: Option<Viewport>,
}

/// Size of the picture unless an option or a project gives another one.
pub(crate) const DEFAULT_SIZE: Viewport = Viewport { width: 1280, height: 720 };

/// Memory budget for framebuffer checkpoints, in bytes. It is zero, because drawing up to a single point in time needs
/// no checkpoints.
const NO_CHECKPOINTS: usize = 0;

/// Number of frames per second that is assumed for the motion in a single frame of an animated scene.
const FRAMES_PER_SECOND: f64 = 30.0;

/// Drawn frame with its scene, camera and recipe.
#[derive(Clone, Debug)]
pub(crate) struct DrawnFrame {
    pub(crate) scene: Arc<Scene>,
    pub(crate) camera: Camera,
    pub(crate) recipe: Recipe,
    pub(crate) frame: Frame,
}

impl FrameArgs {
    /// Returns the size of the picture, in pixels.
    pub(crate) fn size(&self) -> Result<Viewport, Failure> {
        let of_project = || Ok(self.scene.project()?.map(|loaded| loaded.project.size()));
        match self.size {
            Some(size) => Ok(size),
            None => of_project().map(|size| size.unwrap_or(DEFAULT_SIZE)),
        }
    }

    /// Returns the picked pixel of the project; `None` if there is none, or if the scene is not given by a project.
    pub(crate) fn pick(&self) -> Result<Option<(u32, u32)>, Failure> {
        Ok(self.scene.project()?.and_then(|loaded| loaded.project.state().pixel))
    }

    /// Loads the scene, and reads the camera and the recipe.
    pub(crate) fn view(&self) -> Result<RequestedView, Failure> {
        self.scene.view()
    }

    /// Draws the frame, completely or only the triangles and fragments up to `moment`.
    pub(crate) fn draw(&self, moment: Option<Moment>) -> Result<DrawnFrame, Failure> {
        let RequestedView { scene, recipe, camera, .. } = self.view()?;
        let before = scene.animation.as_ref().map(|_| scene.at(scene.time_s() - 1.0 / FRAMES_PER_SECOND));
        let mut drawn = DrawnFrame::of(scene, camera, recipe, self.size()?, moment);
        drawn.frame.before = before.map(|scene| PrecedingView { scene, camera });
        Ok(drawn)
    }
}

impl DrawnFrame {
    /// Draws a frame, completely or only the triangles and fragments up to `moment`.
    pub(crate) fn of(
        scene: Arc<Scene>,
        camera: Camera,
        recipe: Recipe,
        size: Viewport,
        moment: Option<Moment>,
    ) -> Self {
        let frame = match moment {
            None => Renderer::default().render_converged(RenderInputs {
                scene: &scene,
                camera: &camera,
                recipe: &recipe,
                viewport: size,
            }),
            Some(moment) => {
                let frame = run(&scene, &camera, &recipe, size, &mut ());
                let mut scrubber = Scrubber::new(&scene, &recipe, &frame, NO_CHECKPOINTS);
                let drawn = scrubber.frame_at(moment);
                frame.at_moment(&recipe, drawn, scrubber.geometry_at(moment))
            }
        };
        Self { scene, camera, recipe, frame }
    }
}
