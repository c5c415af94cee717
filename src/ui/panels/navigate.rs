//! Navigation over a picture of the scene by pointer and flying keys: pan and zoom the picture, or orbit, pan and dolly
//! the camera.

use eframe::egui::{self, Ui, Vec2};

use crate::ui::session::command::Command;
use crate::ui::session::{PointerMode, Session};
use crate::ui::zoom::{PlacedPicture, Zoom};

/// Zoom rate of the wheel per point: scrolling by d points scales the picture by e^(d · rate).
pub(super) const WHEEL_RATE: f32 = 0.004;

/// Orbit rate of dragging, in radians per point.
pub(super) const ORBIT_RATE: f32 = 0.008;

/// Flying speed: distance flown per second, as a multiple of the distance between camera and target.
pub(super) const FLY_RATE: f32 = 0.8;

/// Keys that fly the camera, in this order: right, left, up, down, forwards, backwards.
pub(crate) const FLYING_KEYS: [egui::Key; 6] =
    [egui::Key::D, egui::Key::A, egui::Key::E, egui::Key::Q, egui::Key::W, egui::Key::S];

/// Turns pointer input over a picture into a new zoom or a new camera.
pub(crate) fn navigate(
    ui: &Ui,
    picture: PlacedPicture<'_>,
    zoom: &mut Zoom,
    session: &Session,
    commands: &mut Vec<Command>,
) {
    let PlacedPicture { response, placement, size_px, drag_is_free } = picture;
    let delta = response.drag_delta();
    let camera_mode = session.features.canvas.pointer_mode == PointerMode::Camera;
    let shift = ui.input(|i| i.modifiers.shift);
    let middle = response.dragged_by(egui::PointerButton::Middle);
    let primary = drag_is_free && response.dragged_by(egui::PointerButton::Primary);
    if (middle || primary) && delta != Vec2::ZERO {
        let mut camera = session.state.camera;
        if shift {
            let height = size_px.1 as f32 * placement.points_per_px;
            camera.pan(glam::Vec2::new(delta.x / height, delta.y / height));
            commands.push(Command::SetCamera(camera));
        } else if middle || session.features.canvas.pointer_mode == PointerMode::Pan {
            zoom.pan(ui, placement, delta);
        } else {
            camera.orbit(delta.x * ORBIT_RATE, delta.y * ORBIT_RATE);
            commands.push(Command::SetCamera(camera));
        }
    }
    if response.hovered() && session.features.canvas.pointer_mode == PointerMode::Pan {
        ui.set_cursor_icon(if primary { egui::CursorIcon::Grabbing } else { egui::CursorIcon::Grab });
    }
    wheel(ui, picture, zoom, session, commands);
    if camera_mode && response.hovered() {
        fly(ui, session, commands);
    }
}

fn wheel(ui: &Ui, picture: PlacedPicture<'_>, zoom: &mut Zoom, session: &Session, commands: &mut Vec<Command>) {
    let Some(pointer) = picture.response.hover_pos() else { return };
    let (scroll, pinch, ctrl) =
        ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta(), i.modifiers.command || i.modifiers.ctrl));
    if session.features.canvas.pointer_mode == PointerMode::Camera || ctrl {
        let factor = (-scroll * WHEEL_RATE).exp() / pinch;
        if factor != 1.0 {
            let mut camera = session.state.camera;
            camera.dolly(factor);
            commands.push(Command::SetCamera(camera));
        }
        return;
    }
    let factor = (scroll * WHEEL_RATE).exp() * pinch;
    if factor != 1.0 {
        zoom.enlarge(ui, picture.placement, pointer, factor);
    }
}

/// Returns the direction of the held flying keys (right, up, forwards) and the time since the last frame in seconds, at
/// most 0.1.
pub(super) fn flying(ui: &Ui) -> (glam::Vec3, f32) {
    let [right, left, up, down, forwards, backwards] = FLYING_KEYS;
    ui.input(|i| {
        let axis = |plus, minus| f32::from(i8::from(i.key_down(plus)) - i8::from(i.key_down(minus)));
        (glam::Vec3::new(axis(right, left), axis(up, down), axis(forwards, backwards)), i.stable_dt.min(0.1))
    })
}

fn fly(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    let (steps, dt) = flying(ui);
    if steps != glam::Vec3::ZERO {
        let mut camera = session.state.camera;
        camera.fly(steps * FLY_RATE * dt);
        commands.push(Command::SetCamera(camera));
        ui.request_repaint();
    }
}
