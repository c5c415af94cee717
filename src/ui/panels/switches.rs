//! Switches of the selected stage: settings, statistics, and the work that is skipped, with reasons. Settings that do
//! not apply to the scene are not offered.

use std::collections::BTreeSet;

use eframe::egui::{Label, RichText, Ui};

use super::{pick, skipped_work, smooth};
use crate::chain::{Recipe, execution};
use crate::inspect::Stage;
use crate::measure::noise::WITHIN;
use crate::pipeline::background::Background;
use crate::pipeline::observe::Fate;
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::settings::{Choice as _, DepthTest, Execution, MIP_BIAS, SceneData, Shading, TexelFilter};
use crate::scene::obj::TrMeaning;
use crate::scene::{Camera, Projection, SceneFormat, SceneSource, UpAxis, builtin};
use crate::ui::command::Command;
use crate::ui::engine::{RenderedView, StageFigures};
use crate::ui::files::FileCommand;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::{choice, combo, drag, drag_by, icon_button, row, slider, value_row};

/// Draws the settings and statistics of a stage.
pub(crate) fn ui(ui: &mut Ui, stage: Stage, session: &Session, recipe: &mut Recipe, commands: &mut Vec<Command>) {
    match stage {
        Stage::Assemble => assemble(ui, session, commands),
        Stage::Transform => camera(ui, session, commands),
        Stage::Clip => clip(ui, session),
        Stage::Project => project(ui),
        Stage::Cull => cull(ui, session, recipe),
        Stage::Rasterize => rasterize(ui, session, recipe),
        Stage::Depth => depth(ui, recipe),
        Stage::Interpolate => interpolate(ui, session, recipe),
        Stage::Shade => shade(ui, session, recipe),
        Stage::Upscale => upscaling(ui, session, recipe),
    }
}

/// Returns the stage whose switches include the setting with the dotted key `key`; `None` if no stage has a switch for it.
pub(crate) fn owner(key: &str) -> Option<Stage> {
    let group = key.split('.').next()?;
    Some(match group {
        "culling" => Stage::Cull,
        "execution" | "rasterizer" | "arithmetic" | "fill_rule" | "wireframe" => Stage::Rasterize,
        "depth_test" | "depth_format" | "depth_bias" => Stage::Depth,
        "interpolation" => Stage::Interpolate,
        "shading" | "light" | "checker" | "filter" | "max_anisotropy" | "mip_bias" | "address" | "alpha"
        | "blending" | "background" | "color_space" => Stage::Shade,
        "antialias" | "upscaler" | "post" => Stage::Upscale,
        _ => return None,
    })
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

/// Draws an explanatory note below a setting.
pub(super) fn note(ui: &mut Ui, text: impl Into<String>) {
    ui.add(Label::new(RichText::new(text).small().color(tokens(ui).text_weak)).wrap());
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

fn cull(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    row(ui, "Culling", "Facing of the triangles that are culled", |ui| pick(ui, &mut recipe.pipeline.culling));
    let Some(figures) = &session.features.stages.figures else { return };
    for fate in [Fate::BackFacing, Fate::FrontFacing, Fate::ZeroArea] {
        fate_row(ui, figures, fate);
    }
}

fn rasterize(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    row(
        ui,
        "Execution",
        "Tile by tile on all threads, or triangle by triangle on one; the picture is the same, bit for bit",
        |ui| pick(ui, &mut recipe.execution),
    );
    match execution(&session.scene, recipe) {
        (_, Some(obstacle)) => note(ui, format!("Drawn in classic execution: {obstacle}.")),
        (Execution::Tiled, None) => {
            note(ui, "Tiled execution has its own algorithm. To use another one, choose classic execution.");
        }
        (Execution::Classic, None) => {}
    }
    row(ui, "Algorithm", "Algorithm that finds the samples inside a triangle", |ui| {
        pick(ui, &mut recipe.pipeline.rasterizer)
    });
    row(ui, "Arithmetic", "Number format in which coverage is computed", |ui| {
        pick(ui, &mut recipe.pipeline.arithmetic)
    });
    row(ui, "Fill rule", "Rule that decides whether a pixel centre exactly on an edge is covered", |ui| {
        pick(ui, &mut recipe.pipeline.fill_rule)
    });
    row(ui, "Wireframe", "Draws the snapped edges of all drawn triangles over the picture", |ui| {
        ui.checkbox(&mut recipe.wireframe, "");
    });
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

const CONSTANT_BIAS_HELP: &str = "Added to all depths of a triangle before the test, in the smallest steps of the \
                                  format: for floats, units in the last place of the triangle's greatest depth. A \
                                  positive bias moves surfaces away, or towards the viewer with a reversed format";

const SLOPE_BIAS_HELP: &str = "Added to all depths of a triangle before the test, times its slope: the change of its \
                               depth per pixel along x or y, whichever is greater";

/// Change of the constant depth bias per dragged point, in smallest steps of the depth format.
const CONSTANT_BIAS_STEP: f64 = 1.0;

/// Change of the slope-scaled depth bias per dragged point.
const SLOPE_BIAS_STEP: f64 = 0.05;

fn depth(ui: &mut Ui, recipe: &mut Recipe) {
    row(ui, "Test", "Depth test: condition under which a fragment replaces the stored one", |ui| {
        pick(ui, &mut recipe.pipeline.depth_test)
    });
    if recipe.pipeline.depth_test == DepthTest::Off {
        note(ui, "Without a depth test, no depth is stored, so there is no format and no bias to choose.");
        return;
    }
    row(ui, "Format", "Number format of the depth buffer, and mapping of distance to depth", |ui| {
        pick(ui, &mut recipe.pipeline.depth_format)
    });
    let (step, slope) = (CONSTANT_BIAS_STEP, SLOPE_BIAS_STEP);
    row(ui, "Constant bias", CONSTANT_BIAS_HELP, |ui| drag_by(ui, &mut recipe.pipeline.depth_bias.constant, step));
    row(ui, "Slope-scaled bias", SLOPE_BIAS_HELP, |ui| drag_by(ui, &mut recipe.pipeline.depth_bias.slope, slope));
}

fn interpolate(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    row(ui, "Attributes", "Interpolation of texture coordinates, normals and colours", |ui| {
        pick(ui, &mut recipe.pipeline.interpolation)
    });
    if let Some(view) = &session.view {
        note_skipped(ui, view, PipelinePart::PerspectiveDivision);
    }
}

const MIP_BIAS_HELP: &str = "Added to the level of detail, in mip levels: negative values are sharper but show moiré. \
                             Temporal upscalers that draw fewer pixels want log₂(drawn width / full width) − 1";

fn shade(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    let recommended_mip_bias = recipe.recommended_mip_bias();
    let settings = &mut recipe.pipeline;
    let (offered, reason) = offered_shadings(session, settings.shading);
    row(ui, "Shading", "Source of the fragments' colour", |ui| choice(ui, &mut settings.shading, &offered));
    if !reason.is_empty() {
        note(ui, reason);
    }
    if settings.shading.is_lit() {
        light(ui, recipe);
    }
    let settings = &mut recipe.pipeline;
    if settings.shading.reads_checker() {
        row(ui, "Squares", "Number of checkerboard squares per unit of texture coordinate", |ui| {
            slider(ui, &mut settings.checker.squares, 1.0..=64.0, "", 1)
        });
        for (label, color) in [("Even square", &mut settings.checker.even), ("Odd square", &mut settings.checker.odd)] {
            row(ui, label, "Colour of every other square of the checkerboard", |ui| {
                let mut rgb = color.to_array();
                if ui.color_edit_button_rgb(&mut rgb).changed() {
                    *color = rgb.into();
                }
            });
        }
    }
    let Some(view) = &session.view else { return };
    if view.frame.plans.iter().any(|p| p.runs(PipelinePart::Texels)) {
        row(ui, "Filter", "Filter that samples a texture between texel centres", |ui| pick(ui, &mut settings.filter));
        if settings.filter == TexelFilter::Anisotropic {
            let help = "Maximum number of samples per pixel along the major axis of its footprint";
            row(ui, "Max. anisotropy", help, |ui| pick(ui, &mut settings.max_anisotropy));
        }
        if settings.filter.reads_mip_levels() {
            row(ui, "Mip bias", MIP_BIAS_HELP, |ui| slider(ui, &mut settings.mip_bias, MIP_BIAS, "", 2));
            if settings.mip_bias != recommended_mip_bias {
                let label = format!("Set mip bias to {}", format::fixed(recommended_mip_bias.into(), 2));
                if ui.button(label).on_hover_text("Use the mip bias that suits the upscaler").clicked() {
                    settings.mip_bias = recommended_mip_bias;
                }
            }
        }
        row(ui, "Texture wrap", "Texels for texture coordinates outside 0…1", |ui| pick(ui, &mut settings.address));
        row(ui, "Alpha", "Treatment of alpha when the filter mixes texels", |ui| pick(ui, &mut settings.alpha));
    } else {
        note_skipped(ui, view, PipelinePart::Texels);
    }
    if view.frame.plans.iter().any(|p| p.runs(PipelinePart::Blending)) {
        row(ui, "Blending order", "Order in which the fragments of blended materials are blended", |ui| {
            pick(ui, &mut settings.blending.order)
        });
    } else {
        note_skipped(ui, view, PipelinePart::Blending);
    }
    background(ui, session, &mut settings.background);
    for part in [PipelinePart::NormalMap, PipelinePart::Highlight, PipelinePart::Emission] {
        if settings.shading.reads_material() && !view.frame.plans.iter().any(|plan| plan.runs(part)) {
            note_skipped(ui, view, part);
        }
    }
    row(ui, "Colour space", "Colour space in which light is computed and textures are filtered", |ui| {
        pick(ui, &mut settings.color_space)
    });
}

fn background(ui: &mut Ui, session: &Session, background: &mut Background) {
    row(ui, "Background", "Colour of the pixels that no triangle covers", |ui| {
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
    row(ui, "Ambient", "Fraction of the light that reaches every surface, whatever its direction", |ui| {
        slider(ui, &mut recipe.pipeline.light.ambient, 0.0..=1.0, "", 2)
    });
}

fn upscaling(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    smooth::antialias(ui, &mut recipe.antialias);
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
    smooth::post(ui, &mut recipe.post);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_with_a_switch_has_an_owner() {
        let keys = Recipe::keys().into_iter().map(|(key, _)| key);
        let without: Vec<_> = keys.filter(|key| owner(key).is_none()).collect();
        assert_eq!(without, ["force"], "no stage has a switch for it");
    }
}
