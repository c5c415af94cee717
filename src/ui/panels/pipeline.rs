//! The pipeline at the left: one row per stage with its time and count, its switches when opened, and a button that shows
//! the picture after it. A control that the scene cannot use is not offered, and the row says why.

use std::time::Duration;

use eframe::egui::collapsing_header::CollapsingState;
use eframe::egui::{self, DragValue, Label, RichText, Slider, Ui};

use super::{pick, plan};
use crate::chain::Recipe;
use crate::inspect::Stage;
use crate::measure::stages::StageTimes;
use crate::pipeline::observe::Fate;
use crate::pipeline::plan::Part;
use crate::pipeline::settings::{Choice as _, DepthTest, Shading};
use crate::scene::{Camera, Projection, SceneSource, builtin};
use crate::ui::command::Command;
use crate::ui::engine::{Shown, StageFigures, View};
use crate::ui::format;
use crate::ui::session::{PictureSize, Session};
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{choice, combo, figure, icon_button, row, value_row};
use crate::upscale::{self, Upscaling};

/// Draws all rows.
pub fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut recipe = session.state.recipe;
    for stage in Stage::ALL {
        stage_row(ui, *stage, session, &mut recipe, commands);
    }
    if recipe != session.state.recipe {
        commands.push(Command::SetRecipe(recipe));
    }
    ui.add_space(theme::space::M);
    let changed = session.state.recipe != Recipe::default();
    let reset = ui.add_enabled(changed, egui::Button::new("Reset all settings"));
    if reset
        .on_hover_text("Every switch back to its default")
        .on_disabled_hover_text("All settings are at their defaults")
        .clicked()
    {
        commands.push(Command::ResetRecipe);
    }
}

/// Stages whose switches are shown at first.
const OPEN_AT_FIRST: [Stage; 4] = [Stage::Assemble, Stage::Cull, Stage::Shade, Stage::Upscale];

fn stage_row(ui: &mut Ui, stage: Stage, session: &Session, recipe: &mut Recipe, commands: &mut Vec<Command>) {
    let id = ui.make_persistent_id(("stage", stage.id()));
    let mut open = CollapsingState::load_with_default_open(ui.ctx(), id, OPEN_AT_FIRST.contains(&stage));
    if header(ui, stage, open.is_open(), session, commands) {
        open.toggle(ui);
    }
    open.show_body_unindented(ui, |ui| {
        egui::Frame::new().inner_margin(egui::Margin { left: 8, right: 2, top: 2, bottom: 8 }).show(ui, |ui| {
            ui.push_id(stage.id(), |ui| body(ui, stage, session, recipe, commands));
        });
    });
    open.store(ui.ctx());
}

/// The row of a stage: name at the left; count, time and the button that shows its picture at the right. True when the
/// row was clicked.
fn header(ui: &mut Ui, stage: Stage, open: bool, session: &Session, commands: &mut Vec<Command>) -> bool {
    let size = egui::vec2(ui.available_width(), theme::ROW_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, open, format!("{} stage", stage.name())));
    let shown = session.shown == Shown::Stage(stage);
    let fill = if response.hovered() { tokens(ui).control } else { tokens(ui).raised };
    ui.painter().rect_filled(rect, theme::RADIUS, fill);
    if shown {
        let mark = rect.with_max_x(rect.left() + 3.0);
        ui.painter().rect_filled(mark, theme::RADIUS, tokens(ui).accent);
    }
    let chevron = if open { Icon::ChevronDown } else { Icon::ChevronRight };
    let center = rect.left_center() + egui::vec2(14.0, 0.0);
    theme::paint_icon(ui.painter(), center, chevron, theme::ICON_SIZE, tokens(ui).text_weak);
    ui.painter().text(
        rect.left_center() + egui::vec2(26.0, 0.0),
        egui::Align2::LEFT_CENTER,
        stage.name(),
        egui::TextStyle::Body.resolve(ui.style()),
        tokens(ui).text_strong,
    );
    let right = egui::UiBuilder::new()
        .max_rect(rect.shrink2(egui::vec2(4.0, 0.0)))
        .layout(egui::Layout::right_to_left(egui::Align::Center));
    figures(&mut ui.new_child(right), stage, shown, session, commands);
    response.on_hover_text(stage.help()).clicked()
}

fn figures(ui: &mut Ui, stage: Stage, shown: bool, session: &Session, commands: &mut Vec<Command>) {
    let icon = if shown { Icon::EyeOff } else { Icon::Eye };
    if icon_button(ui, icon, &format!("Show the picture after “{}”", stage.name())).clicked() {
        let next = if shown { Shown::Buffer(crate::inspect::Buffer::Color) } else { Shown::Stage(stage) };
        commands.push(Command::Show(next));
    }
    let time = session.stages.as_ref().and_then(|figures| time_of(stage, &figures.times));
    let time = time.map_or_else(|| "–".to_owned(), |t| format::ms(t.as_secs_f64() * 1e3));
    let help = "Time of this stage for the frame on screen. Rasterize, depth, interpolate and shade are told apart by drawing the frame several times, each time one stage further; 0 means too short to tell";
    figure(ui, &time, 62.0, tokens(ui).text).on_hover_text(help);
    if let Some((number, what)) = session.view.as_ref().and_then(|view| count_of(stage, session, view)) {
        let help = format!("{} {what}", format::count(number));
        figure(ui, &short_count(number), 54.0, tokens(ui).text_weak).on_hover_text(help);
    }
}

/// 14 860 as "14.9 k": rows have room for no more.
fn short_count(number: u64) -> String {
    match number {
        0..10_000 => format::count(number),
        10_000..1_000_000 => format!("{:.1} k", number as f64 / 1e3),
        _ => format!("{:.2} M", number as f64 / 1e6),
    }
}

fn time_of(stage: Stage, times: &StageTimes) -> Option<Duration> {
    match stage {
        Stage::Assemble => None,
        Stage::Transform => Some(times.transform),
        Stage::Clip => Some(times.clip),
        Stage::Project => Some(times.project),
        Stage::Cull => Some(times.cull),
        Stage::Rasterize => Some(times.rasterize),
        Stage::Depth => times.depth,
        Stage::Interpolate => Some(times.interpolate),
        Stage::Shade => Some(times.shade),
        Stage::Upscale => Some(times.upscale),
    }
}

fn count_of(stage: Stage, session: &Session, view: &View) -> Option<(u64, &'static str)> {
    let (counters, geometry) = (session.stages?.counters, &view.frame.geometry);
    match stage {
        Stage::Assemble => Some((session.scene.triangle_count() as u64, "triangles in the scene")),
        Stage::Transform => Some((geometry.vertices as u64, "vertices transformed")),
        Stage::Clip => Some((counters.clipped, "triangles cut")),
        Stage::Project => Some((geometry.triangles_clipped as u64, "triangles projected")),
        Stage::Cull => Some((view.rasterized as u64, "triangles left to rasterize")),
        Stage::Rasterize => Some((counters.covered, "samples covered")),
        Stage::Depth => view.frame.drawn.depth.as_ref().map(|_| (counters.passed, "fragments passed")),
        Stage::Interpolate => None,
        Stage::Shade => Some((counters.shaded, "fragments shaded")),
        Stage::Upscale => {
            let (width, height) = view.frame.image.size();
            Some((view.frame.drawn.grid.drawn_pixels(width, height), "pixels drawn"))
        }
    }
}

fn body(ui: &mut Ui, stage: Stage, session: &Session, recipe: &mut Recipe, commands: &mut Vec<Command>) {
    match stage {
        Stage::Assemble => assemble(ui, session, commands),
        Stage::Transform => camera(ui, session, commands),
        Stage::Clip => clip(ui, session),
        Stage::Project => project(ui, session, commands),
        Stage::Cull => cull(ui, session, recipe),
        Stage::Rasterize => rasterize(ui, session, recipe),
        Stage::Depth => depth(ui, recipe),
        Stage::Interpolate => interpolate(ui, session, recipe),
        Stage::Shade => shade(ui, session, recipe),
        Stage::Upscale => upscaling(ui, session, recipe),
    }
}

fn assemble(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let name = session.source.title();
    row(ui, "Scene", "What is drawn; models of your own by File ▸ Open, or dropped on the window", |ui| {
        combo("scene", &name, ui.spacing().combo_width).height(480.0).show_ui(ui, |ui| {
            for scene in builtin::ALL {
                let here = matches!(&session.source, SceneSource::Builtin(b) if b.id == scene.id);
                if ui.selectable_label(here, scene.title).on_hover_text(scene.summary).clicked() {
                    commands.push(Command::OpenBuiltin(scene.id.to_owned()));
                }
            }
        });
    });
    let mut mirrored = session.mirrored;
    row(ui, "Mirror z", "Mirrors the scene in z: for models made for a world of the other handedness", |ui| {
        if ui.checkbox(&mut mirrored, "").changed() {
            commands.push(Command::MirrorZ);
        }
    });
    let scene = &session.scene;
    let library = &scene.library;
    value_row(ui, "Instances", &format::count(scene.instances.len() as u64), "Objects placed in the scene");
    value_row(ui, "Meshes", &format::count(library.meshes().len() as u64), "Shared vertex and index buffers");
    value_row(
        ui,
        "Textures",
        &format::count(library.textures().len() as u64),
        "Pictures laid on surfaces, each held once",
    );
    let memory = scene.memory();
    value_row(
        ui,
        "Shared buffers",
        &format::bytes(memory.shared_bytes as u64),
        "Memory of meshes and textures, each counted once",
    );
    value_row(
        ui,
        "Instance records",
        &format::bytes(memory.instance_bytes as u64),
        "Memory of the records that place meshes in the scene",
    );
    value_row(
        ui,
        "Meshes unshared",
        &format::bytes(memory.unshared_bytes as u64),
        "What the meshes alone would take if every instance held its own copy",
    );
}

fn camera(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut camera = session.state.camera;
    let mut orthographic = matches!(camera.projection, Projection::Orthographic { .. });
    row(ui, "Projection", "Perspective makes far things smaller; orthographic keeps parallel lines parallel", |ui| {
        let options =
            [(false, "Perspective", "Far things are smaller"), (true, "Orthographic", "Parallel lines stay parallel")];
        if choice(ui, &mut orthographic, &options) {
            camera = camera.with_orthographic(orthographic);
        }
    });
    match &mut camera.projection {
        Projection::Perspective { fov_y } => {
            row(ui, "Field of view", "Vertical angle that is seen", |ui| {
                let mut degrees = fov_y.to_degrees();
                if degree_slider(ui, &mut degrees, 5.0..=150.0, 1) {
                    *fov_y = degrees.to_radians();
                }
            });
        }
        Projection::Orthographic { height } => {
            let speed = *height * 0.01;
            row(ui, "Height", "Height of the slab that is seen, world units", |ui| {
                ui.add(DragValue::new(height).speed(speed).range(1e-6..=1e9));
            });
        }
    }
    planes(ui, &mut camera);
    if camera != session.state.camera {
        commands.push(Command::SetCamera(camera));
    }
    ui.horizontal(|ui| {
        if ui.button("Reset view").on_hover_text("Back to the scene's own view  (H)").clicked() {
            commands.push(Command::ResetCamera);
        }
        if ui.button("Fit all").on_hover_text("Same direction, moved until everything is seen").clicked() {
            commands.push(Command::FitCamera);
        }
    });
}

fn planes(ui: &mut Ui, camera: &mut Camera) {
    let (near_speed, far_speed) = (camera.near * 0.02, camera.far * 0.02);
    let (near, far) = (camera.near, camera.far);
    row(ui, "Near plane", "Nothing nearer is drawn. The farther away it is, the finer depth is everywhere", |ui| {
        ui.add(DragValue::new(&mut camera.near).speed(near_speed).range(1e-6..=far * 0.999).max_decimals(6));
    });
    row(ui, "Far plane", "Nothing farther is drawn", |ui| {
        ui.add(DragValue::new(&mut camera.far).speed(far_speed).range(near * 1.001..=1e9).max_decimals(3));
    });
}

fn note(ui: &mut Ui, text: impl Into<String>) {
    ui.add(Label::new(RichText::new(text).small().color(tokens(ui).text_weak)).wrap());
}

fn clip(ui: &mut Ui, session: &Session) {
    let (Some(view), Some(figures)) = (&session.view, &session.stages) else { return };
    value_row(ui, "Cut", &format::count(figures.counters.clipped), "Triangles that crossed a plane and were cut");
    for fate in [Fate::Outside, Fate::ClippedAway, Fate::NotFinite] {
        fate_row(ui, figures, fate);
    }
    left_out(ui, view, Part::Clipping);
}

fn fate_row(ui: &mut Ui, figures: &StageFigures, fate: Fate) {
    let mut name = fate.name().to_owned();
    name[..1].make_ascii_uppercase();
    value_row(ui, &name, &format::count(figures.counters.fate(fate)), "Triangles that ended here for this reason");
}

fn left_out(ui: &mut Ui, view: &View, part: Part) {
    let reasons = plan::reasons(&view.frame.geometry.plans, part);
    if !reasons.is_empty() {
        note(ui, format!("Left out: {reasons}"));
    }
}

fn project(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut size = session.state.size;
    let options = [
        (PictureSize::Canvas, "As the canvas", "One picture pixel on each screen pixel"),
        (PictureSize::Fixed(160, 90), "160 × 90", "Few, large pixels: good to see edges and grids"),
        (PictureSize::Fixed(320, 180), "320 × 180", "Large pixels"),
        (PictureSize::Fixed(640, 360), "640 × 360", "A quarter of HD"),
        (PictureSize::Fixed(1280, 720), "1280 × 720", "HD"),
        (PictureSize::Fixed(1920, 1080), "1920 × 1080", "Full HD"),
    ];
    row(ui, "Picture size", "How many pixels the pipeline draws", |ui| {
        if choice(ui, &mut size, &options) {
            commands.push(Command::SetSize(size));
        }
    });
    note(ui, "Corners are snapped to 1/256 px, so that edges are exact integers.");
}

fn cull(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    row(ui, "Culling", "Which triangles are dropped because of the side that they show", |ui| {
        pick(ui, &mut recipe.pipeline.culling)
    });
    let Some(figures) = &session.stages else { return };
    for fate in [Fate::BackFacing, Fate::FrontFacing, Fate::ZeroArea] {
        fate_row(ui, figures, fate);
    }
}

fn rasterize(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    row(ui, "Algorithm", "How the samples inside a triangle are found; all find the same ones", |ui| {
        pick(ui, &mut recipe.pipeline.rasterizer)
    });
    row(ui, "Fill rule", "Who owns a pixel centre that lies exactly on an edge", |ui| {
        pick(ui, &mut recipe.pipeline.fill_rule)
    });
    row(ui, "Wireframe", "Lays the snapped edges of all drawn triangles over the picture", |ui| {
        ui.checkbox(&mut recipe.wireframe, "");
    });
    let Some(figures) = &session.stages else { return };
    value_row(ui, "Samples visited", &format::count(figures.counters.visited), "Samples that the algorithm looked at");
    value_row(
        ui,
        "Samples covered",
        &format::count(figures.counters.covered),
        "Samples inside a triangle, over all triangles",
    );
}

fn depth(ui: &mut Ui, recipe: &mut Recipe) {
    row(ui, "Test", "When a fragment may replace what is stored", |ui| pick(ui, &mut recipe.pipeline.depth_test));
    if recipe.pipeline.depth_test == DepthTest::Off {
        note(ui, "Left out: without a test no depth is stored, so there is no format to choose.");
    } else {
        row(ui, "Format", "What the depth buffer stores", |ui| pick(ui, &mut recipe.pipeline.depth_format));
    }
}

fn interpolate(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    row(ui, "Attributes", "How texture coordinates, normals and colours follow the screen", |ui| {
        pick(ui, &mut recipe.pipeline.interpolation)
    });
    if let Some(view) = &session.view {
        left_out(ui, view, Part::PerspectiveDivision);
    }
}

fn shade(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    let settings = &mut recipe.pipeline;
    row(ui, "Shading", "What colours a fragment", |ui| pick(ui, &mut settings.shading));
    if matches!(settings.shading, Shading::Gouraud | Shading::Lambert | Shading::Cel) {
        light(ui, recipe);
    }
    let settings = &mut recipe.pipeline;
    if settings.shading == Shading::Checker {
        row(ui, "Squares", "Squares of the pattern per unit of texture coordinate", |ui| {
            ui.add(Slider::new(&mut settings.checker.squares, 1.0..=64.0).max_decimals(1))
        });
        for (label, color) in [("Even square", &mut settings.checker.even), ("Odd square", &mut settings.checker.odd)] {
            row(ui, label, "Colour of the pattern", |ui| {
                let mut rgb = color.to_array();
                if ui.color_edit_button_rgb(&mut rgb).changed() {
                    *color = rgb.into();
                }
            });
        }
    }
    let Some(view) = &session.view else { return };
    if view.frame.geometry.plans.iter().any(|p| p.runs(Part::Texels)) {
        row(ui, "Filter", "How a texture is read between texel centres", |ui| pick(ui, &mut settings.filter));
        row(ui, "Address", "What texture coordinates outside of 0…1 mean", |ui| pick(ui, &mut settings.address));
    } else {
        left_out(ui, view, Part::Texels);
    }
    row(ui, "Colour space", "In which numbers light is computed and textures are filtered", |ui| {
        pick(ui, &mut settings.color_space)
    });
}

/// An angle; true when the user changed it. Only the text is rounded: a slider that rounds its value changes it by being
/// drawn.
fn degree_slider(ui: &mut Ui, degrees: &mut f32, range: std::ops::RangeInclusive<f32>, decimals: usize) -> bool {
    let text = move |value: f64, _| format!("{value:.decimals$}");
    ui.add(Slider::new(degrees, range).suffix("°").custom_formatter(text)).changed()
}

fn light(ui: &mut Ui, recipe: &mut Recipe) {
    let light = &mut recipe.pipeline.light;
    let direction = light.direction.normalize_or(glam::Vec3::Y);
    let (mut azimuth, mut elevation) =
        (direction.x.atan2(direction.z).to_degrees(), direction.y.clamp(-1.0, 1.0).asin().to_degrees());
    let mut turned = false;
    row(ui, "Light azimuth", "Where the light comes from, around the vertical axis; 0° is +z", |ui| {
        turned |= degree_slider(ui, &mut azimuth, -180.0..=180.0, 0);
    });
    row(ui, "Light elevation", "How high the light stands", |ui| {
        turned |= degree_slider(ui, &mut elevation, -90.0..=90.0, 0);
    });
    if turned {
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        light.direction = glam::Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
    }
    if recipe.pipeline.shading == Shading::Cel {
        return;
    }
    row(ui, "Ambient", "Share of light that reaches every surface", |ui| {
        ui.add(Slider::new(&mut recipe.pipeline.light.ambient, 0.0..=1.0).max_decimals(2))
    });
}

fn upscaling(ui: &mut Ui, session: &Session, recipe: &mut Recipe) {
    let mut method = recipe.upscaler.method();
    let mut scale = recipe.upscaler.scale();
    let methods: Vec<_> = upscale::ALL.iter().map(|u| (u.id(), u.name(), u.help())).collect();
    row(ui, "Method", "How the pixels that are not drawn are filled in", |ui| choice(ui, &mut method, &methods));
    let scales = recipe.upscaler.upscaler().scales();
    if scales.len() > 1 {
        let names: Vec<_> = scales.iter().map(|s| (*s, format!("×{s}"))).collect();
        let options: Vec<_> = names.iter().map(|(s, name)| (*s, name.as_str(), "Enlargement per axis")).collect();
        row(ui, "Scale", "Enlargement per axis: ×4 draws one pixel of sixteen", |ui| choice(ui, &mut scale, &options));
    }
    if (method, scale) != (recipe.upscaler.method(), recipe.upscaler.scale())
        && let Some(upscaling) = Upscaling::new(method, scale)
    {
        recipe.upscaler = upscaling;
    }
    note(ui, recipe.upscaler.upscaler().help());
    let share = session.timings.share_of_native(&session.request(), session.state.recipe.upscaler);
    let share = share.map_or_else(|| "not measured".to_owned(), format::percent);
    let help = "Median frame time over that of native, from the last measurement of all upscalers on this very picture";
    value_row(ui, "Time against native", &share, help);
    if let Some(view) = &session.view {
        value_row(
            ui,
            "Pixels drawn",
            &format::percent(view.frame.drawn_share()),
            "Share of the picture's pixels that are really rasterized and shaded",
        );
    }
}
