//! Switches of the selected stage: settings, statistics, and the work that is skipped, with reasons. Settings that do
//! not apply to the scene are not offered.

use std::collections::BTreeSet;

use eframe::egui::Ui;

use super::setting_row::{note, others, setting, setting_row};
use super::{skipped_work, smooth};
use crate::chain::{Recipe, SettingKey, execution};
use crate::inspect::Stage;
use crate::measure::noise::WITHIN;
use crate::pipeline::background::Background;
use crate::pipeline::observe::Fate;
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::settings::{Choice as _, DepthTest, Execution, SceneData, Shading, TexelFilter};
use crate::scene::obj::TrMeaning;
use crate::scene::{Camera, Projection, SceneFormat, SceneSource, UpAxis, builtin};
use crate::ui::engine::{RenderedView, StageFigures};
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::theme::Icon;
use crate::ui::widgets::{choice, combo, drag, drag_by, icon_button, row, slider, value_row};

/// Draws the settings and statistics of a stage.
pub(crate) fn ui(ui: &mut Ui, stage: Stage, session: &Session, recipe: &mut Recipe, commands: &mut Vec<Command>) {
    others(ui, stage, recipe);
    match stage {
        Stage::Assemble => assemble(ui, session, commands),
        Stage::Transform => camera(ui, session, commands),
        Stage::Clip => clip(ui, session),
        Stage::Project => project(ui),
        Stage::Cull => cull(ui, session),
        Stage::Rasterize => rasterize(ui, session, recipe),
        Stage::Depth => depth(ui, recipe),
        Stage::Interpolate => interpolate(ui, session),
        Stage::Shade => shade(ui, session, recipe),
        Stage::Upscale => upscaling(ui, session, recipe),
    }
}

fn assemble(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let name = session.source.title();
    row(ui, "Scene", "Scene to draw. To open your own model, use File ▸ Open model, or drop it on the window", |ui| {
        combo("scene", &name, ui.spacing().combo_width).height(480.0).show_ui(ui, |ui| {
            for scene in builtin::ALL {
                let here = matches!(&session.source, SceneSource::Builtin(b) if b.id == scene.id);
                if ui.selectable_label(here, scene.title).on_hover_text(scene.summary).clicked() {
                    commands.push(Command::File(FileCommand::OpenBuiltin(scene.id.to_owned())));
                }
            }
        });
    });
    let mut mirrored = session.mirrored;
    row(ui, "Mirror z", "Mirrors the scene along z, for models with the opposite handedness", |ui| {
        if ui.checkbox(&mut mirrored, "").changed() {
            commands.push(Command::MirrorZ);
        }
    });
    model_reading(ui, session, commands);
    let scene = &session.scene;
    let library = &scene.library;
    value_row(ui, "Instances", &format::count(scene.instances.len() as u64), "Number of mesh instances in the scene");
    value_row(
        ui,
        "Meshes",
        &format::count(library.meshes().len() as u64),
        "Number of meshes, each with a vertex and an index buffer",
    );
    value_row(
        ui,
        "Textures",
        &format::count(library.textures().len() as u64),
        "Number of textures in the scene, each stored once",
    );
    let memory = scene.memory();
    let bytes = |number: usize| format::bytes(number as u64);
    let figures = [
        ("Texture memory", memory.shared_bytes - memory.mesh_bytes, "Memory used by all textures, each stored once"),
        ("Mesh memory", memory.mesh_bytes, "Memory used by all meshes, each stored once for all its instances"),
        ("Unshared mesh memory", memory.unshared_bytes, "Memory that meshes would need if every instance had a copy"),
        ("Instance records", memory.instance_bytes, "Memory used by the records that place meshes in the scene"),
    ];
    for (label, number, help) in figures {
        value_row(ui, label, &bytes(number), help);
    }
    let limit = format::bytes(session.features.files.memory_limit.bytes());
    value_row(ui, "Memory limit", &limit, "Maximum memory for meshes and textures of a model  (--memory)");
}

/// Draws the settings for properties that a model file leaves unspecified, such as the up axis.
fn model_reading(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut up = UpAxis::nearest(session.state.camera.up);
    row(ui, "Up axis", "Axis that points up in the view; guessed when a model is loaded  (--up)", |ui| {
        let options = [(UpAxis::Y, "Y", "Fit the scene with y up"), (UpAxis::Z, "Z", "Fit the scene with z up")];
        if choice(ui, &mut up, &options) {
            commands.push(Command::SetCamera(session.scene.first_view(up)));
        }
    });
    if let SceneSource::File(path, tr) = &session.source
        && SceneFormat::by_extension(path).is_none_or(|format| format.has_tr)
    {
        let mut tr = *tr;
        row(
            ui,
            "MTL “Tr”",
            "Interpretation of `Tr` in the material libraries of this model, which is reloaded  (--tr)",
            |ui| {
                let options = [
                    (
                        TrMeaning::Auto,
                        "Auto",
                        "Guess from the file: opacity if it indicates so, otherwise transparency",
                    ),
                    (TrMeaning::Transparency, "Transparency", "0 is opaque, as the format description says"),
                    (TrMeaning::Opacity, "Opacity", "1 is opaque, as MeshLab writes it"),
                ];
                if choice(ui, &mut tr, &options) {
                    commands.push(Command::File(FileCommand::Reopen(path.clone(), tr)));
                }
            },
        );
    }
}

fn camera(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut camera = session.state.camera;
    let mut orthographic = matches!(camera.projection, Projection::Orthographic { .. });
    row(
        ui,
        "Projection",
        "Perspective makes distant objects smaller; orthographic keeps parallel lines parallel",
        |ui| {
            let options = [
                (false, "Perspective", "Distant objects are smaller"),
                (true, "Orthographic", "Parallel lines stay parallel"),
            ];
            if choice(ui, &mut orthographic, &options) {
                camera = camera.with_orthographic(orthographic);
            }
        },
    );
    match &mut camera.projection {
        Projection::Perspective { fov_y } => {
            row(ui, "Field of view", "Vertical field of view of the camera", |ui| {
                let mut degrees = fov_y.to_degrees();
                if slider(ui, &mut degrees, 5.0..=150.0, "°", 1) {
                    *fov_y = degrees.to_radians();
                }
            });
        }
        Projection::Orthographic { height } => {
            row(ui, "Height", "Height of the orthographic view volume, in world units", |ui| {
                drag(ui, height, 1e-30..=1e34)
            });
        }
    }
    let mapping = session.state.recipe.pipeline.depth_format.mapping();
    planes(ui, &mut camera, !mapping.has_far_plane() && !orthographic);
    if camera != session.state.camera {
        commands.push(Command::SetCamera(camera));
    }
    ui.horizontal(|ui| {
        if ui.button("Reset view").on_hover_text("Return to the scene's home view  (H)").clicked() {
            commands.push(Command::ResetCamera);
        }
        if ui
            .button("Fit scene")
            .on_hover_text("Move the camera until the whole scene is visible, without turning it")
            .clicked()
        {
            commands.push(Command::FitCamera);
        }
    });
}

fn planes(ui: &mut Ui, camera: &mut Camera, endless: bool) {
    let Camera { near, far, .. } = *camera;
    row(
        ui,
        "Near plane",
        "Distance from the eye to the near plane. Nothing nearer is drawn; a greater distance gives finer depths",
        |ui| drag(ui, &mut camera.near, 1e-30..=far * 0.999),
    );
    if endless {
        note(ui, "No far plane to set: with this depth format, the far plane is at infinity.");
    } else {
        row(ui, "Far plane", "Distance from the eye to the far plane. Nothing farther is drawn", |ui| {
            drag(ui, &mut camera.far, near * 1.001..=1e34)
        });
    }
}

fn clip(ui: &mut Ui, session: &Session) {
    let (Some(view), Some(figures)) = (&session.view, &session.features.stages.figures) else { return };
    value_row(
        ui,
        "Clipped",
        &format::count(figures.counters.clipped),
        "Number of triangles clipped because they cross a clipping plane",
    );
    for fate in [Fate::Outside, Fate::ClippedAway, Fate::NotFinite] {
        fate_row(ui, figures, fate);
    }
    note_skipped(ui, view, PipelinePart::Clipping);
}

fn fate_row(ui: &mut Ui, figures: &StageFigures, fate: Fate) {
    let mut name = fate.name().to_owned();
    name[..1].make_ascii_uppercase();
    value_row(
        ui,
        &name,
        &format::count(figures.counters.fate(fate)),
        "Number of triangles that this stage discarded for this reason",
    );
}

fn note_skipped(ui: &mut Ui, view: &RenderedView, part: PipelinePart) {
    let reasons = skipped_work::reasons(&view.frame.plans, part);
    if !reasons.is_empty() {
        note(ui, format!("Skipped: {reasons}"));
    }
}

fn project(ui: &mut Ui) {
    note(ui, "Vertices are snapped to 1/256 px, so that edge functions are exact integers.");
}

fn cull(ui: &mut Ui, session: &Session) {
    let Some(figures) = &session.features.stages.figures else { return };
    for fate in [Fate::BackFacing, Fate::FrontFacing, Fate::ZeroArea] {
        fate_row(ui, figures, fate);
    }
}

fn rasterize(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    setting(ui, SettingKey::Execution, recipe);
    match execution(&session.scene, recipe) {
        (_, Some(obstacle)) => note(ui, format!("Drawn in classic execution: {obstacle}.")),
        (Execution::Tiled, None) => {
            note(ui, "Tiled execution has its own algorithm. To use another one, choose classic execution.");
        }
        (Execution::Classic, None) => {}
    }
    for key in [SettingKey::Rasterizer, SettingKey::Arithmetic, SettingKey::FillRule, SettingKey::Wireframe] {
        setting(ui, key, recipe);
    }
    let Some(figures) = &session.features.stages.figures else { return };
    value_row(
        ui,
        "Samples visited",
        &format::count(figures.counters.visited),
        "Number of samples that the algorithm tests",
    );
    value_row(
        ui,
        "Samples covered",
        &format::count(figures.counters.covered),
        "Number of samples inside a triangle, summed over all triangles",
    );
}

/// Change of the constant depth bias per dragged point, in smallest steps of the depth format.
const CONSTANT_BIAS_STEP: f64 = 1.0;

/// Change of the slope-scaled depth bias per dragged point.
const SLOPE_BIAS_STEP: f64 = 0.05;

fn depth(ui: &mut Ui, recipe: &mut Recipe) {
    setting(ui, SettingKey::DepthTest, recipe);
    if recipe.pipeline.depth_test == DepthTest::Off {
        note(ui, "Without a depth test, no depth is stored, so there is no format and no bias to choose.");
        return;
    }
    setting(ui, SettingKey::DepthFormat, recipe);
    let bias = &mut recipe.pipeline.depth_bias;
    setting_row(ui, SettingKey::DepthBiasConstant, |ui| drag_by(ui, &mut bias.constant, CONSTANT_BIAS_STEP));
    setting_row(ui, SettingKey::DepthBiasSlope, |ui| drag_by(ui, &mut bias.slope, SLOPE_BIAS_STEP));
}

fn interpolate(ui: &mut Ui, session: &Session) {
    if let Some(view) = &session.view {
        note_skipped(ui, view, PipelinePart::PerspectiveDivision);
    }
}

fn shade(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    let recommended_mip_bias = recipe.recommended_mip_bias();
    let settings = &mut recipe.pipeline;
    let (offered, reason) = offered_shadings(session, settings.shading);
    setting_row(ui, SettingKey::Shading, |ui| choice(ui, &mut settings.shading, &offered));
    if !reason.is_empty() {
        note(ui, reason);
    }
    if settings.shading.is_lit() {
        light(ui, recipe);
    }
    let settings = &mut recipe.pipeline;
    if settings.shading.reads_checker() {
        let checker = &mut settings.checker;
        setting_row(ui, SettingKey::CheckerSquares, |ui| slider(ui, &mut checker.squares, 1.0..=64.0, "", 1));
        for (key, color) in [(SettingKey::CheckerEven, &mut checker.even), (SettingKey::CheckerOdd, &mut checker.odd)] {
            setting_row(ui, key, |ui| {
                let mut rgb = color.to_array();
                if ui.color_edit_button_rgb(&mut rgb).changed() {
                    *color = rgb.into();
                }
            });
        }
    }
    let Some(view) = &session.view else { return };
    if view.frame.plans.iter().any(|p| p.runs(PipelinePart::Texels)) {
        setting(ui, SettingKey::Filter, recipe);
        if recipe.pipeline.filter == TexelFilter::Anisotropic {
            setting(ui, SettingKey::MaxAnisotropy, recipe);
        }
        if recipe.pipeline.filter.reads_mip_levels() {
            setting(ui, SettingKey::MipBias, recipe);
            if recipe.pipeline.mip_bias != recommended_mip_bias {
                let label = format!("Set mip bias to {}", format::fixed(recommended_mip_bias.into(), 2));
                if ui.button(label).on_hover_text("Use the mip bias that suits the upscaler").clicked() {
                    recipe.pipeline.mip_bias = recommended_mip_bias;
                }
            }
        }
        setting(ui, SettingKey::Address, recipe);
        setting(ui, SettingKey::Alpha, recipe);
    } else {
        note_skipped(ui, view, PipelinePart::Texels);
    }
    if view.frame.plans.iter().any(|p| p.runs(PipelinePart::Blending)) {
        setting(ui, SettingKey::BlendingOrder, recipe);
    } else {
        note_skipped(ui, view, PipelinePart::Blending);
    }
    background(ui, session, &mut recipe.pipeline.background);
    for part in [PipelinePart::NormalMap, PipelinePart::Highlight, PipelinePart::Emission] {
        if recipe.pipeline.shading.reads_material() && !view.frame.plans.iter().any(|plan| plan.runs(part)) {
            note_skipped(ui, view, part);
        }
    }
    setting(ui, SettingKey::ColorSpace, recipe);
}

fn background(ui: &mut Ui, session: &Session, background: &mut Background) {
    setting_row(ui, SettingKey::Background, |ui| {
        let mut color = background.resolve(session.scene.background);
        if ui.color_edit_button_srgb(&mut color).changed() {
            *background = Background::Color(color);
        }
        let is_own = *background != Background::Scene;
        let restore = ui.add_enabled_ui(is_own, |ui| icon_button(ui, Icon::RotateCcw, "Use scene colour")).inner;
        if restore.on_disabled_hover_text("This is the background colour of the scene").clicked() {
            *background = Background::Scene;
        }
    });
}

/// Returns the shadings to offer, and a sentence that says why the others are not offered. The current shading and all
/// shadings that apply to the scene are offered.
fn offered_shadings(session: &Session, present: Shading) -> (Vec<(Shading, &'static str, &'static str)>, String) {
    let library = &session.scene.library;
    let missing = |shading: Shading| shading.requires().filter(|data| !data.is_in(library)).map(SceneData::name);
    let offered = |shading: &&Shading| **shading == present || missing(**shading).is_none();
    let options = Shading::ALL.iter().filter(offered).map(|s| (*s, s.name(), s.help())).collect();
    let reasons: BTreeSet<_> = Shading::ALL.iter().filter(|s| !offered(s)).filter_map(|s| missing(*s)).collect();
    let reason = match reasons.len() {
        0 => String::new(),
        _ => format!(
            "Some shadings are not offered because the scene has no {}.",
            reasons.into_iter().collect::<Vec<_>>().join(", no ")
        ),
    };
    (options, reason)
}

fn light(ui: &mut Ui, recipe: &mut Recipe) {
    let light = &mut recipe.pipeline.light;
    let direction = light.direction.normalize_or(glam::Vec3::Y);
    let (mut azimuth, mut elevation) =
        (direction.x.atan2(direction.z).to_degrees(), direction.y.clamp(-1.0, 1.0).asin().to_degrees());
    let mut turned = false;
    row(ui, "Light azimuth", "Direction of the light around the vertical axis; 0° is +z", |ui| {
        turned |= slider(ui, &mut azimuth, -180.0..=180.0, "°", 0);
    });
    row(ui, "Light elevation", "Angle of the light above the horizon", |ui| {
        turned |= slider(ui, &mut elevation, -90.0..=90.0, "°", 0);
    });
    if turned {
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        light.direction = glam::Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
    }
    if !recipe.pipeline.shading.reads_ambient() {
        return;
    }
    setting(ui, SettingKey::LightAmbient, recipe);
}

fn upscaling(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    smooth::antialias(ui, recipe);
    smooth::upscaler(ui, recipe);
    let share = session.features.timings.share_of_native(&session.request(), session.state.recipe.upscaler);
    let is_noise = session.features.timings.is_within_noise_of_native(session.state.recipe.upscaler);
    let share = share.map_or_else(
        || "not measured".to_owned(),
        |share| if is_noise { format!("{}, {WITHIN}", format::percent(share)) } else { format::percent(share) },
    );
    let help = "Median frame time divided by that of native rendering, from the last measurement of all upscalers with \
                the same scene, view, size and settings";
    value_row(ui, "Time vs native", &share, help);
    if let Some(view) = &session.view {
        value_row(
            ui,
            "Pixels drawn",
            &format::percent(view.frame.drawn_share()),
            "Share of the picture's pixels that are rasterized and shaded",
        );
    }
    smooth::post(ui, recipe);
}
