//! Table of objects: the number of visible triangles of each object, and the fates of its other triangles.

use eframe::egui::{Align2, Color32, FontId, Rect, Role, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};

use super::funnel::BinnedFate as _;
use crate::inspect::fates::{FragmentFate, ObjectFates, TriangleCounts, TriangleFate};
use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::ui::session::command::Command;
use crate::ui::session::fates::FatesChange;
use crate::ui::theme::{RADIUS, font_size, space, tokens};
use crate::ui::widgets::elided;

/// Height of a row, in points.
const ROW: f32 = 20.0;

/// Widths of the columns for name, numbers and bar, as fractions of the row width; the text takes the rest.
const SHARES: [f32; 3] = [0.26, 0.28, 0.16];

/// Draws the rows of all objects.
pub(crate) fn ui(ui: &mut Ui, objects: &[ObjectFates], chosen: Option<usize>, commands: &mut Vec<Command>) {
    let weak = tokens(ui).text_weak;
    let (head, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let [_, bar, words] = columns(head);
    for (x, align, heading) in [
        (head.left() + space::XS, Align2::LEFT_CENTER, "Object"),
        (bar - space::S, Align2::RIGHT_CENTER, "visible / all"),
        (words, Align2::LEFT_CENTER, "other fates"),
    ] {
        let small = FontId::proportional(font_size::SMALL);
        ui.painter_at(head).text(head.left_center() + vec2(x - head.left(), 0.0), align, heading, small, weak);
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical().id_salt("objects").auto_shrink(false).show_rows(ui, ROW, objects.len(), |ui, rows| {
        for (place, object) in objects.iter().enumerate().skip(rows.start).take(rows.len()) {
            if row(ui, object, chosen == Some(place)) {
                commands.push(Command::Fates(FatesChange::Object(place)));
            }
        }
    });
}

/// Returns the x coordinates of the left edges of the columns for numbers, bar and text, in points.
fn columns(row: Rect) -> [f32; 3] {
    let mut x = row.left();
    SHARES.map(|share| {
        x += share * row.width();
        x
    })
}

/// Draws the row of one object. Returns whether it was clicked.
fn row(ui: &mut Ui, object: &ObjectFates, chosen: bool) -> bool {
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let (seen, all) = (seen(&object.triangles), object.triangles.sum());
    let words = fate_shares(&object.triangles);
    response.widget_info(|| {
        WidgetInfo::selected(Role::Button, true, chosen, format!("{}: {seen} of {all} visible; {words}", object.name))
    });
    let fill = match (chosen, response.hovered()) {
        (true, _) => tokens(ui).accent_fill,
        (false, true) => tokens(ui).raised,
        (false, false) => Color32::TRANSPARENT,
    };
    let painter = ui.painter_at(row);
    painter.rect_filled(row, RADIUS, fill);
    let [numbers, bar, reasons] = columns(row);
    let body = FontId::proportional(font_size::BODY);
    let (text, weak) = (tokens(ui).text, tokens(ui).text_weak);
    let put = |from: f32, to: f32, words: &str, color| {
        let galley = elided(ui, words, body.clone(), color, to - from);
        let top = row.center().y - galley.size().y / 2.0;
        painter.galley(pos2(from, top), galley, color);
    };
    let figures = format!("{} / {}", format::count(seen), format::count(all));
    let figures_at = row.left_center() + vec2(bar - row.left() - space::S, 0.0);
    let color = if seen == 0 { tokens(ui).warning } else { text };
    let figures = painter.text(figures_at, Align2::RIGHT_CENTER, figures, FontId::monospace(font_size::BODY), color);
    put(row.left() + space::XS, numbers.min(figures.left() - space::XS), &object.name, text);
    put(reasons, row.right(), &words, weak);
    stack(ui, row.with_min_x(bar).with_max_x(reasons - space::S).shrink2(vec2(0.0, 5.0)), &object.triangles);
    response.on_hover_ui(|ui| details(ui, object)).clicked()
}

fn seen(triangles: &TriangleCounts) -> u64 {
    triangles.of(TriangleFate::Visible) + triangles.of(TriangleFate::BlendedOver)
}

/// Formats the fates of an object's triangles with their counts, most frequent fate first. Omits visible and
/// blended-over triangles.
fn fate_shares(triangles: &TriangleCounts) -> String {
    let is_seen = |fate: TriangleFate| matches!(fate, TriangleFate::Visible | TriangleFate::BlendedOver);
    let mut bins: Vec<_> = TriangleFate::ALL.iter().copied().filter(|f| !is_seen(*f) && triangles.of(*f) > 0).collect();
    bins.sort_by_key(|fate| std::cmp::Reverse(triangles.of(*fate)));
    let words =
        bins.iter().map(|fate| format!("{} {}", format::count(triangles.of(*fate)), fate.name().to_lowercase()));
    let words: Vec<_> = words.collect();
    if words.is_empty() { "all visible".to_owned() } else { words.join(", ") }
}

/// Draws the triangle counts of all fates as one stacked bar, visible triangles first.
fn stack(ui: &Ui, track: Rect, triangles: &TriangleCounts) {
    let all = triangles.sum().max(1) as f32;
    let mut left = track.left();
    for fate in TriangleFate::ALL.iter().rev() {
        let width = track.width() * triangles.of(*fate) as f32 / all;
        let part = Rect::from_min_size(track.left_top() + vec2(left - track.left(), 0.0), vec2(width, track.height()));
        ui.painter().rect_filled(part, 0.0, fate.color(tokens(ui)));
        left += width;
    }
}

fn details(ui: &mut Ui, object: &ObjectFates) {
    ui.strong(&object.name);
    for fate in TriangleFate::ALL.iter().filter(|fate| object.triangles.of(**fate) > 0) {
        ui.label(format!("{} {}", format::count(object.triangles.of(*fate)), fate.name().to_lowercase()));
    }
    let fragments = &object.fragments;
    let seen = fragments.of(FragmentFate::Visible) + fragments.of(FragmentFate::BlendedOver);
    ui.label(format!("{} of {} fragments visible", format::count(seen), format::count(fragments.sum())));
    ui.weak("Click to list the triangles of this object and select them in the picture.");
}
