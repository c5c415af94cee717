//! The canvas: displays the picture, zooms at the pointer, pans, picks pixels, and draws the value of each pixel as
//! text.
//!
//! The display never changes the data: pixels are drawn as squares at scales of 1:1 and above, and filtered only below
//! 1:1. The pixel grid and the values appear when pixels are large enough for them.

use eframe::egui::{
    self, Align2, Color32, FontId, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::fates::overlay::SelectionLayer;
use super::navigate::navigate;
use super::overlays::marks;
use super::range::{card, region};
use super::scrub::outline;
use super::{vertices, watch};
use crate::image::color::luma;
use crate::image::{Image, Rgba8};
use crate::inspect::view::Value;
use crate::ui::changed_layer::{self, ChangedLayer};
use crate::ui::engine::RenderedView;
use crate::ui::format;
use crate::ui::picture_texture::PictureTexture;
use crate::ui::session::command::Command;
use crate::ui::session::{Session, overlays, range, what_if};
use crate::ui::theme::{MARK_EDGE, ON_PIXEL, PIXEL_GRID, font_size, tokens};
use crate::ui::zoom::{PlacedPicture, Placement, Zoom};

/// Minimum scale at which the pixel grid is drawn, in points per picture pixel.
const GRID_FROM: f32 = 10.0;

/// Minimum scale at which pixel values are drawn as text, in points per picture pixel.
const NUMBERS_FROM: f32 = 48.0;

/// State of the canvas: zoom, pointer state and the texture of the picture.
#[derive(Default)]
pub(crate) struct CanvasView {
    texture: PictureTexture,
    /// Zoom factor and visible part of the picture.
    pub(crate) zoom: Zoom,
    /// Column and row of the pixel under the pointer; `None` if the pointer is not on the picture.
    pub(crate) hovered: Option<(u32, u32)>,
    /// State of selecting a region by dragging the pointer.
    region_drag: region::RegionDrag,
    selection: SelectionLayer,
    changed: ChangedLayer,
}

impl CanvasView {
    /// Fits the whole picture into the canvas, and keeps it fitted when the canvas is resized.
    pub(crate) fn fit(&mut self) {
        self.zoom.fit();
    }

    /// Shows the picture at 1:1 (one picture pixel per screen pixel), centred on the canvas.
    pub(crate) fn one_to_one(&mut self, picture: (u32, u32), canvas_px: (u32, u32)) {
        self.zoom.set_view(1.0, canvas_px, (picture.0 as f32 / 2.0, picture.1 as f32 / 2.0));
    }

    /// Centres the canvas on a pixel and zooms in far enough to distinguish the pixel from its neighbours.
    pub(crate) fn bring_into_view(&mut self, pixel: (u32, u32), canvas_px: (u32, u32)) {
        self.zoom.bring_into_view(pixel, canvas_px);
    }

    /// Returns the scale, in screen pixels per picture pixel; `None` if the picture is fitted to the canvas.
    pub(crate) fn scale(&self) -> Option<f32> {
        self.zoom.scale()
    }

    /// Draws the picture and turns pointer input into commands.
    pub(crate) fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> Response {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Rendered picture"));
        ui.painter().rect_filled(rect, 0.0, tokens(ui).canvas);
        let Some(view) = what_if::visible_view(ui, session) else {
            ui.painter().text(
                rect.center(),
                Align2::CENTER_CENTER,
                "Drawing the first frame…",
                FontId::proportional(font_size::BODY),
                tokens(ui).text_weak,
            );
            return response;
        };
        let placement = self.zoom.placement(ui, rect, view.picture.size());
        let picture =
            PlacedPicture { response: &response, placement, size_px: view.picture.size(), drag_is_free: true };
        let drag_is_free = !self.region_drag.follow(ui, picture, session, commands);
        navigate(ui, PlacedPicture { drag_is_free, ..picture }, &mut self.zoom, session, commands);
        let placement = self.zoom.placement(ui, rect, view.picture.size());
        self.pick(&response, placement, view, commands);
        self.paint(ui, placement, session, view);
        let vectors = placement.points_per_px >= marks::VECTORS_FROM;
        if vectors != session.features.overlays.vectors {
            commands.push(Command::Overlays(overlays::OverlayChange::Vectors(vectors)));
        }
        super::overlays::card::ui(ui, rect, session, view, commands);
        let visible = region::visible(placement, view.picture.size());
        if visible != session.features.range.visible {
            commands.push(Command::Range(range::RangeChange::Visible(visible)));
        }
        if session.features.range.open && session.features.probing.picture(view).is_none() {
            card::ui(ui, rect, session, view, commands);
        }
        response
    }

    fn pick(&mut self, response: &Response, placement: Placement, view: &RenderedView, commands: &mut Vec<Command>) {
        let pixel_at = |position| placement.pixel_at(position, view.picture.size());
        self.hovered = response.hover_pos().and_then(pixel_at);
        let questioned = response.clicked_by(egui::PointerButton::Primary)
            || response.clicked_by(egui::PointerButton::Secondary)
            || response.dragged_by(egui::PointerButton::Secondary);
        if questioned && let Some(pixel) = response.interact_pointer_pos().and_then(pixel_at) {
            commands.push(Command::Pick(Some(pixel)));
        }
    }

    fn paint(&mut self, ui: &Ui, placement: Placement, session: &Session, view: &RenderedView) {
        let (width, height) = view.picture.size();
        let heat = session.features.probing.picture(view);
        let shown = heat.unwrap_or(&view.picture);
        let texture = self.texture.show(ui, shown);
        let painter = ui.painter().with_clip_rect(placement.canvas);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let changes = what_if::marked_changes(ui, session);
        let tint = if changes.is_some() { changed_layer::DIMMED } else { Color32::WHITE };
        painter.image(texture, placement.rect_of_all((width, height)), uv, tint);
        if let Some(changes) = changes {
            self.changed.paint(ui, &painter, placement, changes);
        }
        self.selection.paint(ui, &painter, placement, session);
        grid(&painter, placement, (width, height));
        let value = |x, y| match heat {
            Some(_) => Value::Count(session.features.probing.count((x, y)).unwrap_or(0).into()),
            None => view.value(x, y),
        };
        numbers(&painter, placement, shown, ui.input(|i| i.modifiers.alt), value);
        marks::paint(&painter, placement, session, view);
        outline::paint(&painter, placement, view);
        watch::markers(&painter, placement, session, (width, height), tokens(ui));
        self.region_drag.paint(ui, &painter, placement, session);
        if let Some((x, y)) = session.pick.filter(|(x, y)| *x < width && *y < height) {
            marker(&painter, placement, (x, y), tokens(ui).accent);
        }
        vertices::mark(ui, &painter, placement, session);
    }
}

/// Draws the pixel grid if pixels are at least [`GRID_FROM`] points wide.
pub(super) fn grid(painter: &egui::Painter, placement: Placement, size: (u32, u32)) {
    if placement.points_per_px < GRID_FROM {
        return;
    }
    let (columns, rows) = placement.visible(size);
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

/// Draws the value of each visible pixel as text inside it. Floats are shown as raw bits in hexadecimal if `bits` is
/// `true`.
pub(super) fn numbers(
    painter: &egui::Painter,
    placement: Placement,
    picture: &Image<Rgba8>,
    bits: bool,
    value: impl Fn(u32, u32) -> Value,
) {
    if placement.points_per_px < NUMBERS_FROM {
        return;
    }
    let (columns, rows) = placement.visible(picture.size());
    let font = FontId::monospace((placement.points_per_px / 6.0).clamp(8.0, 18.0));
    for y in rows {
        for x in columns.clone() {
            let color = ON_PIXEL[usize::from(luma(picture.at(x, y)) >= 128.0)];
            let cell = placement.rect_of(x, y);
            let text = value_lines(value(x, y), bits);
            painter.text(cell.center(), Align2::CENTER_CENTER, text, font.clone(), color);
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

/// Draws a frame around a pixel, visible on any picture and at any scale.
pub(super) fn marker(painter: &egui::Painter, placement: Placement, (x, y): (u32, u32), accent: Color32) {
    const MIN_POINTS: f32 = 7.0;
    let pixel = placement.rect_of(x, y);
    let frame = Rect::from_center_size(pixel.center(), pixel.size().max(Vec2::splat(MIN_POINTS)));
    painter.rect_stroke(frame.expand(1.0), 0.0, Stroke::new(3.0, MARK_EDGE), StrokeKind::Outside);
    painter.rect_stroke(frame.expand(2.0), 0.0, Stroke::new(1.5, accent), StrokeKind::Outside);
    if pixel.width() < MIN_POINTS {
        for direction in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            let (from, to) = (frame.center() + direction * 9.0, frame.center() + direction * 16.0);
            painter.line_segment([from, to], Stroke::new(3.0, MARK_EDGE));
            painter.line_segment([from, to], Stroke::new(1.5, accent));
        }
    }
}
