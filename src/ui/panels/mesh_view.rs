//! The pane of the mesh view: its toolbar, the picture, and pointer input.

mod marks;
mod picture;

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{
    self, Align2, Color32, FontId, PointerButton, PopupCloseBehavior, Rect, Response, Role, Sense, Slider, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

use crate::inspect::mesh_view::{MeshNormals, MeshStyle, OverlayInputs, Painting, first_view, key};
use crate::inspect::selection::TriangleSelection;
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, TriangleId};
use crate::ui::engine::RenderedView;
use crate::ui::manual::manual_button;
use crate::ui::panels::PanelSpec;
use crate::ui::panels::navigate::{FLY_RATE, ORBIT_RATE, WHEEL_RATE, flying};
use crate::ui::panels::overlays::card::length_slider;
use crate::ui::picture_texture::PictureTexture;
use crate::ui::session::command::Command;
use crate::ui::session::mesh_view::{MeshViewChange, inner};
use crate::ui::session::{Session, vertices};
use crate::ui::theme::{self, Icon, RADIUS, font_size, space, tokens};
use crate::ui::widgets::{combo, icon_button};
use picture::{Painter, PictureRequest};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Stages,
    grows: true,
    titled: false,
    controls: None,
    content: |ui, cx| cx.widgets.mesh.ui(ui, cx.session, cx.widgets.is_synchronous, cx.commands),
};

/// Maximum displacement of triangles away from the centre of their mesh, as a multiple of their distance from that
/// centre.
const MAX_EXPLODE: f32 = 2.0;

/// Minimum free width for the label of the “Explode” slider, in points.
const NAME_FROM_POINTS: f32 = 56.0;

/// Pane that shows the mesh view.
#[derive(Default)]
pub(crate) struct MeshPane {
    texture: PictureTexture,
    painter: Painter,
    /// Whether the pointer is over the mesh view. The flying keys then move its camera instead of running commands.
    pub(crate) hovered: bool,
}

impl MeshPane {
    /// Draws the pane and turns pointer input into commands. If `waits` is `true`, the picture is drawn synchronously.
    pub(crate) fn ui(&mut self, ui: &mut Ui, session: &Session, waits: bool, commands: &mut Vec<Command>) {
        let aspect = ui.available_width() / ui.available_height().max(1.0);
        bar(ui, session, aspect, commands);
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Mesh view"));
        self.hovered = response.hovered();
        ui.painter().rect_filled(rect, 0.0, tokens(ui).canvas);
        let Some(view) = &session.view else { return };
        let Some(camera) = session.features.mesh_view.camera else {
            let camera = first_view(&view.request.scene, &inner(view), rect.aspect_ratio());
            commands.push(Command::MeshView(MeshViewChange::Look(camera)));
            ui.request_repaint();
            return;
        };
        navigate(ui, &response, camera, commands);
        let [r, g, b, _] = tokens(ui).canvas.to_array();
        let px = (rect.size() * ui.pixels_per_point()).max(Vec2::splat(1.0));
        let wish = PictureRequest {
            scene: view.request.scene.clone(),
            inner: inner(view),
            camera,
            size: Viewport { width: px.x as u32, height: px.y as u32 },
            painting: Painting {
                style: session.features.mesh_view.style,
                explode: session.features.mesh_view.explode,
                selection: session.selection.clone(),
                backdrop: [r, g, b],
                normals: session.features.mesh_view.normals,
            },
            look: overlay_inputs(session, view),
        };
        let Some(painted) = self.painter.picture(ui.ctx(), wish, waits) else { return };
        let Viewport { width, height } = painted.size();
        // While the pane is being resized, the last picture keeps its scale.
        let points_per_px = 1.0 / ui.pixels_per_point();
        let place = Rect::from_min_size(rect.min, vec2(width as f32, height as f32) * points_per_px);
        let painter = ui.painter().with_clip_rect(rect);
        let texture = self.texture.show(ui, &painted.image);
        painter.image(texture, place, Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)), Color32::WHITE);
        marks::draw(ui, &painter, place, points_per_px, &painted.marks);
        let under = |at: egui::Pos2| {
            let p = (at - place.min) / points_per_px;
            painted.owner.get(p.x.max(0.0) as u32, p.y.max(0.0) as u32).filter(|id| *id != TriangleId::NONE)
        };
        let hovered = response.hover_pos().and_then(under);
        if response.clicked()
            && let Some(triangle) = response.interact_pointer_pos().and_then(under)
        {
            commands.push(Command::MeshView(MeshViewChange::Select(triangle)));
            let one = TriangleSelection::new(format!("triangle {}", triangle.0), [triangle]);
            commands.push(Command::Select(one));
        }
        legend(ui, &painter, rect, session);
        caption(ui, &painter, rect, caption_text(session, view, hovered));
    }
}

fn bar(ui: &mut Ui, session: &Session, aspect: f32, commands: &mut Vec<Command>) {
    let mesh = &session.features.mesh_view;
    let (mut changes, mut manual) = (Vec::new(), Vec::new());
    let mut push = |change| changes.push(Command::MeshView(change));
    egui::Frame::new().inner_margin(egui::Margin::symmetric(space::S as i8, space::XS as i8)).show(ui, |ui| {
        ui.horizontal(|ui| {
            let mut style = mesh.style;
            let list = combo("mesh style", style.name(), 84.0).show_ui(ui, |ui| {
                for choice in MeshStyle::ALL {
                    ui.selectable_value(&mut style, *choice, choice.name()).on_hover_text(choice.help());
                }
            });
            list.response
                .on_hover_text(mesh.style.help())
                .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Mesh style"));
            if style != mesh.style {
                push(MeshViewChange::Style(style));
            }
            marks_menu(ui, mesh.culled, mesh.normals, &mut push);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if icon_button(ui, Icon::X, "Hide the mesh view  (M)").clicked() {
                    push(MeshViewChange::Toggle);
                }
                manual_button(ui, Chapter::Stages, &mut manual);
                if icon_button(ui, Icon::House, "Return to the initial position beside the render camera").clicked() {
                    push(MeshViewChange::Reset);
                }
                if icon_button(ui, Icon::Maximize, "Fit the scene and the render camera into the view").clicked() {
                    push(MeshViewChange::Fit(aspect));
                }
                let mut apart = mesh.explode;
                ui.spacing_mut().slider_width = (ui.available_width() - NAME_FROM_POINTS).clamp(56.0, 120.0);
                let slider = ui.add(Slider::new(&mut apart, 0.0..=MAX_EXPLODE).show_value(false));
                slider.widget_info(|| WidgetInfo::slider(true, apart.into(), "Explode"));
                if slider.on_hover_text("Explode: moves each triangle away from the centre of its mesh").changed() {
                    push(MeshViewChange::Explode(apart));
                }
                if ui.available_width() >= NAME_FROM_POINTS {
                    ui.label(egui::RichText::new("Explode").small().color(tokens(ui).text_weak));
                }
            });
        });
    });
    commands.extend(changes.into_iter().chain(manual));
}

/// Draws the menu of marks: outlines of culled triangles, and normals with their length.
fn marks_menu(ui: &mut Ui, culled: bool, normals: MeshNormals, push: &mut impl FnMut(MeshViewChange)) {
    let (culled_before, normals_before) = (culled, normals);
    let (mut culled, mut normals) = (culled, normals);
    // The menu holds several checkboxes and a slider, so clicks inside leave it open.
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::new("Marks").config(config).ui(ui, |ui| {
        let help = "Outline triangles removed by face culling in dashed red, if they are few or selected";
        ui.checkbox(&mut culled, "Culled triangles").on_hover_text(help);
        let help = "Draw the normals of all vertices as lines, not hidden by triangles";
        ui.checkbox(&mut normals.vertices, "Vertex normals").on_hover_text(help);
        let help = "Draw the normals of all triangles as lines from their centroids, not hidden by triangles";
        ui.checkbox(&mut normals.faces, "Face normals").on_hover_text(help);
        ui.horizontal(|ui| {
            ui.spacing_mut().slider_width = 96.0;
            length_slider(ui, &mut normals.length, "Length of normals");
            ui.label(format!("Length {:.1} %", 100.0 * normals.length));
        });
    });
    button.on_hover_text("Outlines of culled triangles, and vertex and face normals");
    if culled != culled_before {
        push(MeshViewChange::Culled(culled));
    }
    if normals != normals_before {
        push(MeshViewChange::Normals(normals));
    }
}

/// Turns pointer input and flying keys into a new pose of the mesh view's camera.
fn navigate(ui: &Ui, response: &Response, camera: Camera, commands: &mut Vec<Command>) {
    let mut moved = camera;
    let delta = response.drag_delta();
    let pans = response.dragged_by(PointerButton::Middle) || ui.input(|i| i.modifiers.shift);
    if response.dragged() && delta != Vec2::ZERO {
        if pans {
            moved.pan(glam::Vec2::new(delta.x, delta.y) / response.rect.height().max(1.0));
        } else {
            moved.orbit(delta.x * ORBIT_RATE, delta.y * ORBIT_RATE);
        }
    }
    if response.hovered() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = (-scroll * WHEEL_RATE).exp() / pinch;
        if factor != 1.0 {
            moved.dolly(factor);
        }
        let (steps, dt) = flying(ui);
        if steps != glam::Vec3::ZERO {
            moved.fly(steps * FLY_RATE * dt);
            ui.request_repaint();
        }
    }
    if moved != camera {
        commands.push(Command::MeshView(MeshViewChange::Look(moved)));
    }
}

/// Draws the legend of triangle and normal colours in the lower left corner.
fn legend(ui: &Ui, painter: &egui::Painter, rect: Rect, session: &Session) {
    const ROW: f32 = 15.0;
    const WIDTH: f32 = 104.0;
    let mut key = key(session.features.mesh_view.style);
    key.extend(session.features.mesh_view.normals.kinds().map(|(_, color, name)| (name, color)));
    if key.is_empty() || rect.height() < ROW * 16.0 {
        return;
    }
    let size = vec2(WIDTH, ROW * key.len() as f32 + space::S);
    let card = Rect::from_min_size(rect.left_bottom() + vec2(space::S, -space::S - size.y), size);
    painter.rect_filled(card, RADIUS, tokens(ui).panel.gamma_multiply(0.9));
    for (row, (name, [r, g, b, _])) in key.into_iter().enumerate() {
        let middle = card.left_top() + vec2(space::S, space::XS + ROW * (row as f32 + 0.5));
        let swatch = Rect::from_center_size(middle + vec2(4.0, 0.0), Vec2::splat(9.0));
        painter.rect_filled(swatch, 2.0, Color32::from_rgb(r, g, b));
        let font = FontId::proportional(font_size::SMALL);
        painter.text(middle + vec2(14.0, 0.0), Align2::LEFT_CENTER, name, font, tokens(ui).text);
    }
}

/// Returns the caption of the picture: the triangle under the pointer, or the selected one, or a hint.
fn caption_text(session: &Session, view: &RenderedView, hovered: Option<TriangleId>) -> String {
    let selected = session.features.mesh_view.selected(session.pick);
    match (hovered, selected) {
        (Some(triangle), _) => format!("Triangle {}: click to select", triangle.0),
        (None, Some(triangle)) => {
            let seen = view.report.as_ref().and_then(|report| report.visible()).is_some_and(|f| f.triangle == triangle);
            let where_to = if seen { "visible at the picked pixel" } else { "not visible in the picture" };
            format!("Triangle {}: {where_to}", triangle.0)
        }
        (None, None) => "Drag: orbit, Shift+drag: pan, wheel: dolly, W A S D Q E: fly".to_owned(),
    }
}

/// Draws a caption over the picture.
fn caption(ui: &Ui, painter: &egui::Painter, rect: Rect, text: String) {
    let font = FontId::proportional(font_size::SMALL);
    let galley = painter.layout(text, font, tokens(ui).text, (rect.width() - 4.0 * space::S).max(40.0));
    let place = Rect::from_min_size(rect.min + Vec2::splat(space::S), galley.size() + vec2(space::S, space::XS));
    painter.rect_filled(place, theme::RADIUS, tokens(ui).panel.gamma_multiply(0.9));
    painter.galley(place.min + vec2(space::XS, 2.0), galley, tokens(ui).text);
}

/// Returns the parts of the scene to mark in the mesh view, such as the picked pixel's ray and the selected triangle.
fn overlay_inputs(session: &Session, view: &RenderedView) -> OverlayInputs {
    let report = view.report.as_ref();
    let visible = report.and_then(|report| report.visible());
    OverlayInputs {
        pixel: report.map(|report| (report.x, report.y)),
        hit_distance: visible.map(|fragment| view.frame.depth_scale().distance_of(fragment.depth.value)),
        selected: vertices::picked_triangle(session),
        vertex: vertices::followed(session).map(|vertex| vertex.world),
        culled: session.features.mesh_view.culled,
        explode: session.features.mesh_view.explode,
    }
}
