//! The table of all lines of a trace: columns and rows.

use eframe::egui::{Align2, Color32, FontId, Rect, RichText, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::panel::ROW;
use super::{TraceChange, TraceView};
use crate::inspect::trace::{Trace, TraceLine};
use crate::pipeline::settings::Choice as _;
use crate::ui::command::Command;
use crate::ui::engine::Shown;
use crate::ui::theme::{Icon, font_size, paint_icon, tokens};

// Widths of the columns, in points. The formula takes the rest.
const STAGE: f32 = 72.0;
const WHAT: f32 = 186.0;
const VALUE: f32 = 172.0;
const BITS: f32 = 142.0;
const EXACT: f32 = 196.0;
const ROUNDING: f32 = 104.0;
const SHOW: f32 = 26.0;

/// Minimum width of the formula column, in points. If the table is too narrow, the columns of bits and exact values are
/// omitted.
const MIN_FORMULA_POINTS: f32 = 170.0;

/// Positions of the columns, in points from the left edge of the table.
pub(super) struct TraceColumns {
    formula: f32,
    value: f32,
    bits: Option<f32>,
    exact: Option<f32>,
    rounding: f32,
    show: f32,
}

impl TraceColumns {
    /// Computes the columns of a table `width` points wide. A narrow table omits the bits first, then the exact values.
    pub(super) fn of(width: f32) -> Self {
        /// Width of the scroll bar, which covers the right end of each row, in points.
        const BAR: f32 = 12.0;
        let fixed = STAGE + WHAT + VALUE + ROUNDING + SHOW + BAR;
        let (mut bits, mut exact) = (BITS, EXACT);
        if width - fixed - bits - exact < MIN_FORMULA_POINTS {
            bits = 0.0;
        }
        if width - fixed - bits - exact < MIN_FORMULA_POINTS {
            exact = 0.0;
        }
        let formula = STAGE + WHAT;
        let value = formula + (width - fixed - bits - exact).max(0.0);
        let after_value = value + VALUE;
        Self {
            formula,
            value,
            bits: (bits > 0.0).then_some(after_value),
            exact: (exact > 0.0).then_some(after_value + bits),
            rounding: after_value + bits + exact,
            show: after_value + bits + exact + ROUNDING,
        }
    }
}

/// Draws the headings of the columns.
pub(super) fn headings(ui: &mut Ui, columns: &TraceColumns) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let color = tokens(ui).text_weak;
    let font = FontId::proportional(font_size::SMALL);
    let left = |x: f32, text: &str| {
        ui.painter().text(rect.left_center() + vec2(x + 4.0, 0.0), Align2::LEFT_CENTER, text, font.clone(), color);
    };
    let right = |x: f32, text: &str| {
        ui.painter().text(rect.left_center() + vec2(x - 8.0, 0.0), Align2::RIGHT_CENTER, text, font.clone(), color);
    };
    left(0.0, "Stage");
    left(STAGE, "Quantity");
    left(columns.formula, "Formula");
    right(columns.value + VALUE, "Value");
    if let Some(bits) = columns.bits {
        left(bits, "Bits");
    }
    if let Some(exact) = columns.exact {
        left(exact, "Exact");
    }
    right(columns.rounding + ROUNDING, "Rounding");
}

/// Draws the table row of one trace line, and handles clicks on it.
pub(super) fn table_row(
    ui: &mut Ui,
    (trace, place): (&Trace, usize),
    table: &TraceView,
    columns: &TraceColumns,
    shown: Shown,
    commands: &mut Vec<Command>,
) {
    let line = &trace.lines[place];
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Row, true, format!("{} = {}", line.what, line.value_text())));
    let is_current = place == table.line;
    if is_current {
        ui.painter().rect_filled(rect, 2.0, tokens(ui).accent_fill);
    } else if response.hovered() || place % 2 == 1 {
        ui.painter().rect_filled(rect, 0.0, tokens(ui).raised);
    }
    let show = Rect::from_min_size(rect.min + vec2(columns.show, 0.0), vec2(SHOW, ROW));
    if response.clicked() {
        commands.push(Command::Trace(TraceChange::Line(place)));
    }
    cells(ui, line, (rect, columns), table.is_changed(place));
    let is_changed = table.is_changed(place);
    response.on_hover_ui(|ui| explain(ui, line, is_changed));
    if let Some(buffer) = line.buffer {
        show_button(ui, show, Shown::Intermediate(buffer), shown, commands);
    }
}

/// Draws the texts of a row, each clipped to its column.
fn cells(ui: &Ui, line: &TraceLine, (rect, columns): (Rect, &TraceColumns), is_changed: bool) {
    let tokens = tokens(ui);
    let quiet = if line.aside { tokens.text_weak } else { tokens.text };
    let mono = FontId::monospace(font_size::SMALL);
    let plain = FontId::proportional(font_size::SMALL);
    let cell = |from: f32, to: f32| {
        Rect::from_min_max(pos2(rect.left() + from, rect.top()), pos2(rect.left() + to, rect.bottom()))
    };
    let write = |cell: Rect, text: &str, right: bool, font: &FontId, color: Color32| {
        let painter = ui.painter().with_clip_rect(cell.intersect(ui.clip_rect()));
        let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), color);
        let x = if right && galley.size().x <= cell.width() - 8.0 {
            cell.right() - 8.0 - galley.size().x
        } else {
            cell.left() + 4.0
        };
        painter.galley(pos2(x, cell.center().y - galley.size().y / 2.0), galley, color);
    };
    write(cell(0.0, STAGE), line.stage.name(), false, &plain, tokens.text_weak);
    write(cell(STAGE, columns.formula), &line.what, false, &plain, quiet);
    write(cell(columns.formula, columns.value), &line.formula, false, &mono, tokens.text_weak);
    let value = cell(columns.value, columns.value + VALUE);
    write(value, &line.value_text(), true, &mono, if line.aside { quiet } else { tokens.text_strong });
    if is_changed {
        ui.painter().circle_filled(value.left_center(), 2.0, tokens.accent);
    }
    if let Some(bits) = columns.bits {
        write(cell(bits, bits + BITS), &line.bits, false, &mono, tokens.text_weak);
    }
    if let (Some(from), Some(exact)) = (columns.exact, &line.exact) {
        write(cell(from, from + EXACT), &exact.decimal, false, &mono, quiet);
    }
    let rounding = cell(columns.rounding, columns.rounding + ROUNDING);
    match line.flags.first() {
        Some(flag) => {
            paint_icon(
                ui.painter(),
                rounding.left_center() + vec2(8.0, 0.0),
                Icon::TriangleAlert,
                13.0,
                tokens.warning,
            );
            let text = cell(columns.rounding + 18.0, columns.rounding + ROUNDING);
            let word = flag.lost_bits.map_or_else(|| flag.kind.name().to_owned(), |bits| format!("−{bits} bits"));
            write(text, &word, false, &plain, tokens.warning);
        }
        None => write(rounding, &line.rounding(), true, &mono, quiet),
    }
}

/// Draws the tooltip with all details of a line.
fn explain(ui: &mut Ui, line: &TraceLine, is_changed: bool) {
    ui.label(RichText::new(&line.what).strong());
    ui.label(&line.formula);
    let mut fact = |name: &str, text: &str| {
        if !text.is_empty() {
            ui.label(RichText::new(format!("{name} {text}")).monospace().size(font_size::SMALL));
        }
    };
    fact("=", &line.numbers);
    fact("value  ", &format!("{} {}", line.value_text(), line.kind));
    fact("bits   ", &line.bits);
    if let Some(exact) = &line.exact {
        let fraction = exact.fraction.as_ref().map_or_else(String::new, |fraction| format!(" = {fraction}"));
        fact("exactly", &format!("{}{fraction}", exact.decimal));
    }
    fact("error  ", &line.rounding());
    for flag in &line.flags {
        ui.label(format!("{}: {}", flag.words(), flag.kind.help()));
    }
    if is_changed {
        ui.label("Dot: the value differs from that of the previously traced pixel or frame.");
    }
    if line.aside {
        ui.label("Not computed by the pipeline; shown for reference.");
    }
}

/// Draws a button that shows a line's quantity for all pixels on the canvas, or the final colours if the quantity is
/// already shown.
fn show_button(ui: &mut Ui, place: Rect, wanted: Shown, shown: Shown, commands: &mut Vec<Command>) {
    let id = ui.scope_id().with(("show", place.min.y as i64));
    let response = ui.interact(place, id, Sense::click());
    let is_shown = shown == wanted;
    let color = match (is_shown, response.hovered()) {
        (true, _) => tokens(ui).accent,
        (false, true) => tokens(ui).text_strong,
        (false, false) => tokens(ui).text_weak,
    };
    paint_icon(ui.painter(), place.center(), Icon::Eye, 14.0, color);
    let name = if is_shown {
        "Show the finished picture again".to_owned()
    } else {
        format!("Show “{}” for the whole picture", wanted.name())
    };
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    if response.on_hover_text(name).clicked() {
        let next = if is_shown { Shown::Buffer(crate::inspect::Buffer::Color) } else { wanted };
        commands.push(Command::Show(next));
    }
}
