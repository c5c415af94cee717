//! List of the filtered triangles, one row each. Only visible rows are laid out.

use eframe::egui::{Align2, Color32, FontId, Rect, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo, vec2};

use crate::inspect::fates::{Fates, FragmentFate};
use crate::pipeline::settings::Choice as _;
use crate::scene::TriangleId;
use crate::ui::format;
use crate::ui::session::command::Command;
use crate::ui::session::fates::{FatesChange, FatesView};
use crate::ui::theme::{Icon, RADIUS, font_size, space, tokens};
use crate::ui::widgets::{elided, icon_button};

/// Height of a row, in points.
const ROW: f32 = 20.0;

/// Right edge of each column, as a fraction of the row width.
const ENDS: [f32; 5] = [0.14, 0.33, 0.51, 0.69, 1.0];

/// Draws the filter field and the list. The row of the triangle visible at the picked pixel is highlighted.
pub(crate) fn ui(
    ui: &mut Ui,
    view: &FatesView,
    fates: &Fates,
    picked: Option<TriangleId>,
    commands: &mut Vec<Command>,
) {
    filter(ui, view, commands);
    let (head, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let headings = ["Triangle", "Object", "Fate", "px²", "visible / all px"].map(str::to_owned);
    cells(ui, head, &headings, [tokens(ui).text_weak; 5], &FontId::proportional(font_size::SMALL));
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical().id_salt("members").auto_shrink(false).show_rows(ui, ROW, view.members.len(), |ui, rows| {
        for triangle in &view.members[rows] {
            row(ui, fates, *triangle, picked == Some(*triangle), commands);
        }
    });
}

fn filter(ui: &mut Ui, view: &FatesView, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let mut text = view.text.clone();
        let hint = "Filter: tri 123, area<1, is:cut, name";
        let edit = TextEdit::singleline(&mut text).hint_text(hint).desired_width(ui.available_width() * 0.55);
        let response = ui.add(edit).on_hover_text(
            "Filter triangles by number (tri 123), screen area in px² (area<1, area>20), clipping (is:cut), NaN or \
             infinite normals or texture coordinates (is:broken), or part of the name of an object or material",
        );
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Filter triangles"));
        if text != view.text {
            commands.push(Command::Fates(FatesChange::Text(text)));
        }
        ui.weak(format!("{} triangles", format::count(view.members.len() as u64)));
        if view.is_filtering() && icon_button(ui, Icon::X, "Clear the selection and list all triangles").clicked() {
            commands.push(Command::Fates(FatesChange::Clear));
        }
    });
}

fn row(ui: &mut Ui, fates: &Fates, triangle: TriangleId, is_picked: bool, commands: &mut Vec<Command>) {
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let name = &fates.objects[fates.object_of(triangle)].name;
    let (fate, fragments) = (fates.triangles[triangle.0 as usize], fates.fragments[triangle.0 as usize]);
    let seen = fragments.of(FragmentFate::Visible) + fragments.of(FragmentFate::BlendedOver);
    let area = fates.area_px(triangle).map_or_else(|| "–".to_owned(), |area| format::fixed(area, 1));
    let label = format!("Triangle {} of {name}: {}", triangle.0, fate.name().to_lowercase());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    if is_picked || response.hovered() {
        let fill = if is_picked { tokens(ui).accent_fill } else { tokens(ui).raised };
        ui.painter().rect_filled(row, RADIUS, fill);
    }
    let texts = [
        triangle.0.to_string(),
        name.clone(),
        fate.name().to_lowercase(),
        area,
        format!("{} / {}", format::count(seen), format::count(fragments.sum())),
    ];
    let text = tokens(ui).text;
    let weak = if is_picked { text } else { tokens(ui).text_weak };
    cells(ui, row, &texts, [text, text, weak, text, text], &FontId::monospace(font_size::BODY));
    let response = response.on_hover_text("Pick a pixel of this triangle");
    if response.clicked() {
        commands.extend(fates.representative_pixel(triangle).map(|pixel| Command::Pick(Some(pixel))));
    }
}

/// Draws the cells of a row: numbers right-aligned, text left-aligned.
fn cells(ui: &Ui, row: Rect, texts: &[String; 5], colors: [Color32; 5], numbers: &FontId) {
    let mut left = row.left();
    for (column, (text, end)) in texts.iter().zip(ENDS).enumerate() {
        let cell = row.with_min_x(left).with_max_x(row.left() + end * row.width()).shrink2(vec2(space::XS, 0.0));
        let is_word = matches!(column, 1 | 2);
        let (at, align) = if is_word {
            (cell.left_center(), Align2::LEFT_CENTER)
        } else {
            (cell.right_center(), Align2::RIGHT_CENTER)
        };
        let font = if is_word { FontId::proportional(numbers.size) } else { numbers.clone() };
        let galley = elided(ui, text, font, colors[column], cell.width());
        let place = align.anchor_size(at, galley.size()).min;
        ui.painter().galley(place, galley, colors[column]);
        left = row.left() + end * row.width();
    }
}
