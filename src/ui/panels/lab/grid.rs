//! The 2D lab's grid: pixels drawn as squares, the ideal shape over them, and draggable handles. The wheel zooms, and
//! dragging pans.

use eframe::egui::{
    Align2, Color32, CornerRadius, FontId, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo,
    emath::GuiRounding as _, pos2, vec2,
};
use glam::DVec2;

use super::grid_view::{GridView, HANDLE};
use super::{palette, pointer};
use crate::lab::recording::{Mark, Tone};
use crate::ui::session::lab::{Lab, LabChange};
use crate::ui::theme::{space, tokens};

/// Minimum side length of a pixel for which grid lines are drawn, in points.
const LINES_FROM: f32 = 6.0;

/// Minimum and maximum zoom of the grid, in points per pixel.
const SCALES: (f32, f32) = (2.0, 160.0);

/// Radius of a dot on the grid, in points.
const DOT: f32 = 3.5;

/// Radius of a dot drawn in the weak (less prominent) tone, in points.
const SMALL_DOT: f32 = 1.3;

/// Draws the grid and handles pointer input.
pub(super) fn ui(ui: &mut Ui, lab: &Lab, changes: &mut Vec<LabChange>) {
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Grid of the lab"));
    let size = vec2(lab.recording.size.0 as f32, lab.recording.size.1 as f32).max(Vec2::splat(1.0));
    let fitted = ((area.size() - Vec2::splat(2.0 * space::L)) / size).min_elem().clamp(SCALES.0, SCALES.1);
    let (scale, center) = lab.view.unwrap_or((fitted, size / 2.0));
    let before = (scale, center);
    let (scale, center) = moved(ui, &response, lab, scale, center);
    if (scale, center) != before {
        changes.push(LabChange::View(Some((scale, center))));
    }
    let view = GridView { scale, origin: (area.center() - center * scale).round_to_pixels(ui.pixels_per_point()) };
    paint(ui, area, view, lab);
    pointer::ui(ui, &response, view, lab, changes);
}

/// Applies wheel and drag input to the view with a scale in points per pixel and a centre in grid pixels. Returns the
/// new scale and centre.
fn moved(ui: &Ui, response: &eframe::egui::Response, lab: &Lab, mut scale: f32, mut center: Vec2) -> (f32, Vec2) {
    let middle = response.rect.center();
    if pointer::drags_view(ui, response, lab) {
        center -= response.drag_delta() / scale;
    }
    let wheel = if response.hovered() { ui.input(|i| i.smooth_scroll_delta().y) } else { 0.0 };
    if wheel != 0.0
        && let Some(at) = response.hover_pos()
    {
        let below = (at - middle) / scale + center;
        scale = (scale * (wheel * 0.005).exp()).clamp(SCALES.0, SCALES.1);
        // The point under the pointer stays fixed.
        center = below - (at - middle) / scale;
    }
    (scale, center)
}

fn paint(ui: &Ui, area: Rect, view: GridView, lab: &Lab) {
    let (painter, tokens) = (ui.painter().with_clip_rect(area), tokens(ui));
    let (width, height) = lab.recording.size;
    let ppp = ui.pixels_per_point();
    let square = |x: f64, y: f64, w: f64, h: f64| {
        Rect::from_min_max(view.screen(DVec2::new(x, y)), view.screen(DVec2::new(x + w, y + h))).round_to_pixels(ppp)
    };
    let sheet = square(0.0, 0.0, width.into(), height.into());
    painter.rect_filled(sheet, CornerRadius::ZERO, palette::paper(tokens));
    for cell in lab.recording.cells(lab.step) {
        let inside = (0..i64::from(width)).contains(&cell.x) && (0..i64::from(height)).contains(&cell.y);
        if inside {
            let rect = square(cell.x as f64, cell.y as f64, 1.0, 1.0);
            painter.rect_filled(rect, CornerRadius::ZERO, palette::ink(cell.ink, tokens));
        }
    }
    if view.scale >= LINES_FROM {
        let stroke = Stroke::new(1.0 / ppp, tokens.border.gamma_multiply(0.55));
        (0..=width).for_each(|x| {
            painter.vline(square(x.into(), 0.0, 0.0, 0.0).left(), sheet.y_range(), stroke);
        });
        (0..=height).for_each(|y| {
            painter.hline(sheet.x_range(), square(0.0, y.into(), 0.0, 0.0).top(), stroke);
        });
    }
    painter.rect_stroke(sheet, CornerRadius::ZERO, Stroke::new(1.0, tokens.border), StrokeKind::Outside);
    for mark in lab.recording.marks(lab.step) {
        paint_mark(&painter, view, mark, |tone| palette::tone(tone, tokens), tokens.canvas);
    }
    for handle in lab.lesson().handles() {
        painter.circle(view.screen(handle), HANDLE, tokens.canvas.gamma_multiply(0.6), Stroke::new(2.0, tokens.accent));
    }
}

fn paint_mark(
    painter: &eframe::egui::Painter,
    view: GridView,
    mark: &Mark,
    color: impl Fn(Tone) -> Color32,
    behind: Color32,
) {
    let stroke = |tone: &Tone| Stroke::new(if *tone == Tone::Weak { 1.0 } else { 2.0 }, color(*tone));
    match mark {
        Mark::Line(from, to, tone) => {
            painter.line_segment([view.screen(*from), view.screen(*to)], stroke(tone));
        }
        Mark::Outline(corners, tone) => {
            let points = corners.iter().map(|corner| view.screen(*corner)).collect();
            painter.add(Shape::closed_line(points, stroke(tone)));
        }
        Mark::Ellipse(center, radii, tone) => {
            let radius = vec2(radii.x as f32, radii.y as f32) * view.scale;
            painter.add(Shape::ellipse_stroke(view.screen(*center), radius, stroke(tone)));
        }
        Mark::Dot(at, tone) => {
            let radius = if *tone == Tone::Weak { SMALL_DOT } else { DOT };
            painter.circle_filled(view.screen(*at), radius, color(*tone));
        }
        Mark::Text(at, text, tone) => {
            let font = FontId::monospace((view.scale * 0.7).clamp(10.0, 15.0));
            let galley = painter.layout_no_wrap(text.clone(), font, color(*tone));
            let at = view.screen(*at);
            let rect = Align2::CENTER_CENTER.anchor_size(pos2(at.x, at.y), galley.size());
            painter.rect_filled(rect.expand2(vec2(3.0, 0.0)), CornerRadius::same(3), behind.gamma_multiply(0.8));
            painter.galley(rect.min, galley, color(*tone));
        }
    }
}
