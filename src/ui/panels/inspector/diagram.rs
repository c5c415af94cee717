//! Diagram of a fragment's triangle in screen space with its sample, and the barycentric weights of its vertices.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, RichText, Sense, Stroke, Ui, Vec2, vec2};

use super::context::SIDE;
use crate::inspect::pixel::sample_position_px;
use crate::inspect::{FragmentRecord, PixelReport};
use crate::ui::format;
use crate::ui::theme::{self, tokens};

/// Position of the sample relative to the triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SampleLocation {
    /// The sample is inside the triangle.
    Inside,
    /// The sample is outside the triangle.
    Outside,
}

/// Draws the triangle in screen space with the sample. A sample inside the triangle splits it into three parts, in the
/// colours of the barycentric weights.
pub(super) fn triangle_diagram(ui: &mut Ui, corners_px: [[f32; 2]; 3], place: SampleLocation, report: &PixelReport) {
    let (response, painter) = ui.allocate_painter(vec2(ui.available_width(), SIDE), Sense::hover());
    let frame = response.rect;
    painter.rect_filled(frame, theme::RADIUS, tokens(ui).canvas);
    let corners = corners_px.map(|[x, y]| vec2(x, y));
    let [x, y] = sample_position_px(report.drawn_at[0], report.drawn_at[1]);
    let sample = vec2(x, y);
    let (low, high) =
        corners.iter().fold((sample, sample), |(low, high), corner| (low.min(*corner), high.max(*corner)));
    let inner = frame.shrink(22.0);
    let extent = (high - low).max(Vec2::splat(1e-3));
    let scale = (inner.width() / extent.x).min(inner.height() / extent.y);
    let offset = inner.center() - (low + high) * 0.5 * scale;
    let on_panel = |p: Vec2| -> Pos2 { offset + p * scale };
    let (sample, corners) = (on_panel(sample), corners.map(on_panel));
    let fill = |corners: Vec<Pos2>, color| painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
    match place {
        SampleLocation::Inside => {
            for (i, color) in theme::WEIGHTS.into_iter().enumerate() {
                fill(vec![corners[(i + 1) % 3], corners[(i + 2) % 3], sample], color.gamma_multiply(0.45));
            }
        }
        SampleLocation::Outside => {
            fill(corners.to_vec(), tokens(ui).text_weak.gamma_multiply(0.3));
        }
    }
    painter.add(egui::Shape::closed_line(corners.to_vec(), Stroke::new(1.0, tokens(ui).text)));
    for (i, corner) in corners.into_iter().enumerate() {
        if place == SampleLocation::Inside {
            painter.line_segment([sample, corner], Stroke::new(1.0, tokens(ui).text_weak.gamma_multiply(0.5)));
        }
        let outward = (corner - corners_center(&corners)).normalized() * 11.0;
        painter.circle_filled(corner, 2.5, theme::WEIGHTS[i]);
        painter.text(
            corner + outward,
            Align2::CENTER_CENTER,
            format!("v{i}"),
            FontId::monospace(11.0),
            tokens(ui).text,
        );
    }
    painter.circle(sample, 3.5, tokens(ui).accent, Stroke::new(1.0, Color32::BLACK));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Barycentric diagram"));
    response.on_hover_text(match place {
        SampleLocation::Inside => {
            "The triangle in screen space, with the pixel's centre inside. The weight λ of a corner is \
                          the area of the part opposite to it, divided by the area of the triangle"
        }
        SampleLocation::Outside => "The triangle in screen space, and the pixel's centre, which lies outside",
    });
}

fn corners_center(corners: &[Pos2; 3]) -> Pos2 {
    ((corners[0].to_vec2() + corners[1].to_vec2() + corners[2].to_vec2()) / 3.0).to_pos2()
}

/// Draws the barycentric weights of the vertices, both in screen space and as used for attribute interpolation.
pub(super) fn weights(ui: &mut Ui, fragment: &FragmentRecord) {
    egui::Grid::new("weights").num_columns(3).spacing([12.0, 2.0]).min_col_width(20.0).show(ui, |ui| {
        ui.label(RichText::new("λ").small().color(tokens(ui).text_weak)).on_hover_text("Barycentric weights");
        for (heading, help) in [
            ("Linear", "Area opposite to the corner, divided by the area of the triangle, in screen space"),
            (
                "Perspective-correct",
                "λ/w, divided by the sum of all three: the weights of attributes. If interpolation is affine, \
                            they equal the linear ones",
            ),
        ] {
            ui.label(RichText::new(heading).small().color(tokens(ui).text_weak)).on_hover_text(help);
        }
        ui.end_row();
        for (i, color) in theme::WEIGHTS.into_iter().enumerate() {
            ui.label(RichText::new(format!("λ{i}")).monospace().color(color));
            for value in [fragment.affine_weights[i], fragment.attribute_weights[i]] {
                ui.label(RichText::new(format::f32_full(value)).monospace()).on_hover_text(format::bits(value));
            }
            ui.end_row();
        }
    });
}
