//! The picture: enlarged at the pointer, moved, picked, and read pixel by pixel.
//!
//! The display never changes the data: pixels are shown as squares from 1:1 on, smoothed only when the picture is shown
//! smaller than it is. Grid and numbers appear when pixels are large enough to hold them. A fitted picture, and one
//! enlarged a lot, is shown at a whole factor, so that all squares are equal.

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Color32, ColorImage, FontId, Pos2, Rect, Response, Role, Sense, Stroke, StrokeKind, TextureHandle,
    TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::command::Command;
use super::engine::{Shown, View};
use super::fault_bar;
use super::format;
use super::session::{PointerMode, Session};
use super::theme::{MARK_EDGE, ON_PIXEL, PIXEL_GRID, RADIUS, font_size, space, tokens};
use crate::image::color::luma;
use crate::image::{Image, Rgba8};
use crate::inspect::Buffer;
use crate::inspect::view::{Value, absence, map_color, value};
use crate::pipeline::settings::Choice as _;

/// Screen pixels per picture pixel, least and greatest.
const SCALE_RANGE: (f32, f32) = (1.0 / 32.0, 256.0);

/// From this enlargement on it is a whole factor.
const WHOLE_FROM: f32 = 8.0;

/// A pixel that is looked for is enlarged at least so much: its neighbours and the course of an edge are seen, too.
const SEEN_FROM: f32 = 16.0;

/// The grid is drawn from this many points per pixel on.
const GRID_FROM: f32 = 10.0;

/// Numbers are written from this many points per pixel on.
const NUMBERS_FROM: f32 = 48.0;

/// How fast the wheel enlarges: e^(points · this).
const WHEEL_RATE: f32 = 0.004;

/// How fast dragging turns the scene, radians per point.
const ORBIT_RATE: f32 = 0.008;

/// How fast a held key flies, in distances to the target per second.
const FLY_RATE: f32 = 0.8;

/// Where the picture is on the canvas, and its texture.
#[derive(Default)]
pub struct Canvas {
    texture: Option<TextureHandle>,
    uploaded: Option<Arc<Image<Rgba8>>>,
    /// Screen pixels per picture pixel; `None` fits the picture into the canvas.
    scale: Option<f32>,
    /// The enlargement that the wheel has come to, before it is rounded to a whole factor.
    zoom: f32,
    /// Picture position at the canvas's top-left corner, in picture pixels.
    origin: Vec2,
    /// The pixel under the pointer.
    pub hovered: Option<(u32, u32)>,
}

/// Where the picture is drawn in this frame of the window.
#[derive(Clone, Copy)]
struct Placement {
    /// The canvas, in points.
    canvas: Rect,
    /// Points per picture pixel.
    points_per_px: f32,
    /// Top-left corner of the picture, in points.
    corner: Pos2,
}

impl Placement {
    fn to_picture(self, position: Pos2) -> Vec2 {
        (position - self.corner) / self.points_per_px
    }

    fn rect_of(self, x: u32, y: u32) -> Rect {
        let min = self.corner + vec2(x as f32, y as f32) * self.points_per_px;
        Rect::from_min_size(min, Vec2::splat(self.points_per_px))
    }
}

impl Canvas {
    /// Enlarges so that the whole picture fits, and stays so.
    pub fn fit(&mut self) {
        self.scale = None;
    }

    /// One picture pixel per screen pixel, centred.
    pub fn one_to_one(&mut self, picture: (u32, u32), canvas_px: (u32, u32)) {
        self.set_view(1.0, canvas_px, (picture.0 as f32 / 2.0, picture.1 as f32 / 2.0));
    }

    /// Enlarges to `scale` screen pixels per picture pixel with `center` (picture px) in the middle.
    pub fn set_view(&mut self, scale: f32, canvas_px: (u32, u32), center: (f32, f32)) {
        self.scale = Some(scale);
        self.origin = vec2(center.0, center.1) - vec2(canvas_px.0 as f32, canvas_px.1 as f32) / (2.0 * scale);
    }

    /// Puts a pixel into the middle, enlarged enough to be seen.
    pub fn bring_into_view(&mut self, (x, y): (u32, u32), canvas_px: (u32, u32)) {
        let scale = self.scale.unwrap_or(0.0).max(SEEN_FROM);
        self.set_view(scale, canvas_px, (x as f32 + 0.5, y as f32 + 0.5));
    }

    /// Screen pixels per picture pixel, if not fitted.
    pub fn scale(&self) -> Option<f32> {
        self.scale
    }

    /// Draws the picture and turns pointer input into commands.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> Response {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Rendered picture"));
        ui.painter().rect_filled(rect, 0.0, tokens(ui).canvas);
        let Some(view) = &session.view else {
            ui.painter().text(
                rect.center(),
                Align2::CENTER_CENTER,
                "Drawing the first frame …",
                FontId::proportional(font_size::BODY),
                tokens(ui).text_weak,
            );
            return response;
        };
        self.navigate(ui, &response, session, view, commands);
        let placement = self.placement(ui, rect, view.picture.size());
        self.pick(&response, placement, view, commands);
        self.paint(ui, placement, session, view);
        if session.shown != Shown::Buffer(Buffer::Color) {
            let frame = legend(ui, rect, view);
            let hits = view.buffers.as_ref().and_then(|buffers| buffers.hits.as_ref());
            if let Some(hits) = hits.filter(|_| view.request.shown == Shown::Buffer(Buffer::Hits)) {
                fault_bar::ui(ui, frame, hits, commands);
            }
        }
        response
    }

    fn placement(&self, ui: &Ui, canvas: Rect, (width, height): (u32, u32)) -> Placement {
        let screen = ui.pixels_per_point();
        let size = vec2(width as f32, height as f32);
        let (scale, origin) = match self.scale {
            Some(scale) => (scale, self.origin),
            None => {
                let available = canvas.size() * screen;
                let exact = (available.x / size.x).min(available.y / size.y);
                // From 1:1 on only whole factors, so that all squares are equal.
                let scale = if exact >= 1.0 { exact.floor() } else { exact };
                (scale, (size - available / scale) / 2.0)
            }
        };
        let corner = canvas.min - origin * scale / screen;
        let corner = pos2((corner.x * screen).round() / screen, (corner.y * screen).round() / screen);
        Placement { canvas, points_per_px: scale / screen, corner }
    }

    fn navigate(&mut self, ui: &Ui, response: &Response, session: &Session, view: &View, commands: &mut Vec<Command>) {
        let placement = self.placement(ui, response.rect, view.picture.size());
        let delta = response.drag_delta();
        let camera_mode = session.pointer_mode == PointerMode::Camera;
        let shift = ui.input(|i| i.modifiers.shift);
        let turning = response.dragged_by(egui::PointerButton::Middle)
            || camera_mode && response.dragged_by(egui::PointerButton::Primary);
        if turning && delta != Vec2::ZERO {
            let mut camera = session.state.camera;
            if shift {
                let height = view.picture.height() as f32 * placement.points_per_px;
                camera.pan(glam::Vec2::new(delta.x / height, delta.y / height));
            } else {
                camera.orbit(delta.x * ORBIT_RATE, delta.y * ORBIT_RATE);
            }
            commands.push(Command::SetCamera(camera));
        } else if response.dragged_by(egui::PointerButton::Primary) && delta != Vec2::ZERO {
            self.keep_placement(ui, placement);
            self.origin -= delta / placement.points_per_px;
        }
        if let Some(pointer) = response.hover_pos() {
            self.wheel(ui, pointer, placement, session, commands);
        }
        if camera_mode && response.hovered() {
            fly(ui, session, commands);
        }
    }

    /// Turns a fitted view into the same one with numbers of its own.
    fn keep_placement(&mut self, ui: &Ui, placement: Placement) {
        self.scale = Some(placement.points_per_px * ui.pixels_per_point());
        self.origin = placement.to_picture(placement.canvas.min);
    }

    fn wheel(&mut self, ui: &Ui, pointer: Pos2, placement: Placement, session: &Session, commands: &mut Vec<Command>) {
        let (scroll, pinch, ctrl) =
            ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta(), i.modifiers.command || i.modifiers.ctrl));
        if session.pointer_mode == PointerMode::Camera || ctrl {
            let factor = (-scroll * WHEEL_RATE).exp() / pinch;
            if factor != 1.0 {
                let mut camera = session.state.camera;
                camera.dolly(factor);
                commands.push(Command::SetCamera(camera));
            }
            return;
        }
        let factor = (scroll * WHEEL_RATE).exp() * pinch;
        if factor == 1.0 {
            return;
        }
        let under_pointer = placement.to_picture(pointer);
        self.keep_placement(ui, placement);
        let old = self.scale.unwrap_or(1.0);
        self.zoom = (self.zoom_of(old) * factor).clamp(SCALE_RANGE.0, SCALE_RANGE.1);
        let scale = if self.zoom >= WHOLE_FROM { self.zoom.round() } else { self.zoom };
        self.scale = Some(scale);
        self.origin = under_pointer - (pointer - placement.canvas.min) * ui.pixels_per_point() / scale;
    }

    /// The unrounded enlargement behind a shown one: wheel steps smaller than one must add up.
    fn zoom_of(&self, shown: f32) -> f32 {
        if (self.zoom - shown).abs() <= 0.5 && shown >= WHOLE_FROM { self.zoom } else { shown }
    }

    fn pick(&mut self, response: &Response, placement: Placement, view: &View, commands: &mut Vec<Command>) {
        let pixel_at = |position: Pos2| {
            let p = placement.to_picture(position);
            let inside =
                p.x >= 0.0 && p.y >= 0.0 && p.x < view.picture.width() as f32 && p.y < view.picture.height() as f32;
            inside.then_some((p.x as u32, p.y as u32))
        };
        self.hovered = response.hover_pos().and_then(pixel_at);
        let questioned = response.clicked_by(egui::PointerButton::Primary)
            || response.clicked_by(egui::PointerButton::Secondary)
            || response.dragged_by(egui::PointerButton::Secondary);
        if questioned && let Some(pixel) = response.interact_pointer_pos().and_then(pixel_at) {
            commands.push(Command::Pick(Some(pixel)));
        }
    }

    fn upload(&mut self, ui: &Ui, picture: &Arc<Image<Rgba8>>) {
        if self.uploaded.as_ref().is_some_and(|old| Arc::ptr_eq(old, picture)) {
            return;
        }
        let (width, height) = picture.size();
        let image = ColorImage::from_rgba_premultiplied([width as usize, height as usize], picture.as_bytes());
        let minification = TextureOptions::LINEAR.minification;
        let options = TextureOptions { minification, ..TextureOptions::NEAREST };
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(ui.ctx().load_texture("picture", image, options)),
        }
        self.uploaded = Some(picture.clone());
    }

    fn paint(&mut self, ui: &Ui, placement: Placement, session: &Session, view: &View) {
        let (width, height) = view.picture.size();
        self.upload(ui, &view.picture);
        let Some(texture) = &self.texture else { return };
        let painter = ui.painter().with_clip_rect(placement.canvas);
        let size = vec2(width as f32, height as f32) * placement.points_per_px;
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture.id(), Rect::from_min_size(placement.corner, size), uv, Color32::WHITE);
        if placement.points_per_px >= GRID_FROM {
            grid(&painter, placement, (width, height));
        }
        if placement.points_per_px >= NUMBERS_FROM {
            numbers(&painter, placement, view, ui.input(|i| i.modifiers.alt));
        }
        if let Some((x, y)) = session.pick.filter(|(x, y)| *x < width && *y < height) {
            marker(&painter, placement, (x, y), tokens(ui).accent);
        }
    }
}

fn fly(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    use egui::Key::{A, D, E, Q, S, W};
    let (steps, dt) = ui.input(|i| {
        let axis = |plus, minus| f32::from(i8::from(i.key_down(plus)) - i8::from(i.key_down(minus)));
        (glam::Vec3::new(axis(D, A), axis(E, Q), axis(W, S)), i.stable_dt.min(0.1))
    });
    if steps != glam::Vec3::ZERO {
        let mut camera = session.state.camera;
        camera.fly(steps * FLY_RATE * dt);
        commands.push(Command::SetCamera(camera));
        ui.request_repaint();
    }
}

/// Picture columns and rows that are on the canvas.
fn visible(placement: Placement, (width, height): (u32, u32)) -> (std::ops::Range<u32>, std::ops::Range<u32>) {
    let (min, max) = (placement.to_picture(placement.canvas.min), placement.to_picture(placement.canvas.max));
    let range = |from: f32, to: f32, size: u32| (from.max(0.0) as u32).min(size)..(to.max(0.0).ceil() as u32).min(size);
    (range(min.x, max.x, width), range(min.y, max.y, height))
}

fn grid(painter: &egui::Painter, placement: Placement, size: (u32, u32)) {
    let (columns, rows) = visible(placement, size);
    let opacity = ((placement.points_per_px - GRID_FROM) / GRID_FROM).clamp(0.15, 1.0);
    let stroke = Stroke::new(1.0, PIXEL_GRID.gamma_multiply(0.35 * opacity));
    let at = |x: u32, y: u32| placement.corner + vec2(x as f32, y as f32) * placement.points_per_px;
    for x in columns.start..=columns.end {
        painter.vline(at(x, 0).x, at(0, rows.start).y..=at(0, rows.end).y, stroke);
    }
    for y in rows.start..=rows.end {
        painter.hline(at(columns.start, 0).x..=at(columns.end, 0).x, at(0, y).y, stroke);
    }
}

/// Writes each pixel's value into it; as bits if `bits`.
fn numbers(painter: &egui::Painter, placement: Placement, view: &View, bits: bool) {
    let (columns, rows) = visible(placement, view.picture.size());
    let font = FontId::monospace((placement.points_per_px / 6.0).clamp(8.0, 18.0));
    for y in rows {
        for x in columns.clone() {
            let below = view.picture.at(x, y);
            let shown = match view.request.shown {
                Shown::Stage(_) => Value::Color(below),
                Shown::Buffer(buffer) => value(buffer, &view.frame, view.buffers.as_deref(), x, y),
            };
            let color = ON_PIXEL[usize::from(luma(below) >= 128.0)];
            let cell = placement.rect_of(x, y);
            painter.text(cell.center(), Align2::CENTER_CENTER, value_lines(shown, bits), font.clone(), color);
        }
    }
}

fn value_lines(value: Value, bits: bool) -> String {
    let float = |f: f32| if bits { format::bits(f) } else { format!("{f:.6}") };
    match value {
        Value::NotDrawn | Value::Nothing => "–".to_owned(),
        Value::Color([r, g, b, _]) if bits => format!("{r:02X}\n{g:02X}\n{b:02X}"),
        Value::Color([r, g, b, _]) => format!("{r}\n{g}\n{b}"),
        Value::Number(number) => float(number),
        Value::Count(count) => count.to_string(),
        Value::Weights(weights) => weights.map(float).join("\n"),
        Value::Triangle(id) => id.0.to_string(),
    }
}

/// What the colours of the picture mean, in its lower left corner: name, and a bar with numbers where a map is used. Returns
/// the place that it takes.
fn legend(ui: &Ui, canvas: Rect, view: &View) -> Rect {
    let painter = ui.painter().with_clip_rect(canvas);
    const WIDTH: f32 = 220.0;
    const BAR: f32 = 8.0;
    let (name, help) = match view.request.shown {
        Shown::Buffer(buffer) => (buffer.name(), absence(buffer, &view.frame).unwrap_or(buffer.help())),
        Shown::Stage(stage) => (stage.name(), stage.help()),
    };
    let small = FontId::proportional(font_size::SMALL);
    let text = painter.layout(format!("{name}: {help}"), small, tokens(ui).text, WIDTH);
    let bar_height = if view.range.is_some() { BAR + 20.0 } else { 0.0 };
    let size = vec2(WIDTH, text.size().y + bar_height) + Vec2::splat(2.0 * space::S);
    let frame = Rect::from_min_size(canvas.left_bottom() + vec2(space::S, -space::S - size.y), size);
    painter.rect_filled(frame, RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    let inner = frame.shrink(space::S);
    let text_height = text.size().y;
    painter.galley(inner.min, text, tokens(ui).text);
    let (Some(range), Shown::Buffer(buffer)) = (view.range, view.request.shown) else { return frame };
    let bar = Rect::from_min_size(inner.min + vec2(0.0, text_height + 4.0), vec2(WIDTH, BAR));
    for step in 0..WIDTH as u32 {
        let [r, g, b, _] = map_color(buffer, step as f32 / (WIDTH - 1.0));
        let column = Rect::from_min_size(bar.min + vec2(step as f32, 0.0), vec2(1.0, BAR));
        painter.rect_filled(column, 0.0, Color32::from_rgb(r, g, b));
    }
    let mono = FontId::monospace(font_size::SMALL);
    let number = |value: f32| if value.fract() == 0.0 { value.to_string() } else { format::f32_full(value) };
    painter.text(
        bar.left_bottom() + vec2(0.0, 2.0),
        Align2::LEFT_TOP,
        number(range.low),
        mono.clone(),
        tokens(ui).text,
    );
    painter.text(bar.right_bottom() + vec2(0.0, 2.0), Align2::RIGHT_TOP, number(range.high), mono, tokens(ui).text);
    frame
}

/// A frame around the picked pixel that is seen on any picture, however small the pixel is.
fn marker(painter: &egui::Painter, placement: Placement, (x, y): (u32, u32), accent: Color32) {
    const LEAST_POINTS: f32 = 7.0;
    let pixel = placement.rect_of(x, y);
    let frame = Rect::from_center_size(pixel.center(), pixel.size().max(Vec2::splat(LEAST_POINTS)));
    painter.rect_stroke(frame.expand(1.0), 0.0, Stroke::new(3.0, MARK_EDGE), StrokeKind::Outside);
    painter.rect_stroke(frame.expand(2.0), 0.0, Stroke::new(1.5, accent), StrokeKind::Outside);
    if pixel.width() < LEAST_POINTS {
        for direction in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            let (from, to) = (frame.center() + direction * 9.0, frame.center() + direction * 16.0);
            painter.line_segment([from, to], Stroke::new(3.0, MARK_EDGE));
            painter.line_segment([from, to], Stroke::new(1.5, accent));
        }
    }
}
