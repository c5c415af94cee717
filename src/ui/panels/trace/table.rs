//! The table of all lines of a trace: columns and rows.

use eframe::egui::{Align2, Color32, FontId, Rect, RichText, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::inspect::trace::{Trace, TraceLine};
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::Shown;
use crate::ui::session::command::Command;
use crate::ui::session::trace::{TraceChange, TraceView};
use crate::ui::theme::{Icon, font_size, paint_icon, tokens};

/// Height of a row of the table, in points.
pub(super) const ROW: f32 = 19.0;

// Widths of the columns, in points. The formula takes the rest.
const STAGE: f32 = 72.0;
const WHAT: f32 = 186.0;
const VALUE: f32 = 172.0;
const BITS: f32 = 142.0;
const EXACT: f32 = 196.0;
const ROUNDING: f32 = 104.0;
const SHOW: f32 = 26.0;

/// Width of the value column in a compact table, in points.
const COMPACT_VALUE: f32 = 96.0;

/// Width of the scroll bar, which covers the right end of each row, in points.
const BAR: f32 = 12.0;

/// Minimum width of the formula column, in points. If the table is too narrow, the columns of bits and exact values are
/// omitted, and then all but quantity and value.
const MIN_FORMULA_POINTS: f32 = 120.0;

/// Column of the table: its left edge, in points from the left edge of the table, and its width in points.
#[derive(Clone, Copy)]
struct Column {
    left: f32,
    width: f32,
}

impl Column {
    /// Returns the part of a row that the column occupies.
    fn of(self, row: Rect) -> Rect {
        Rect::from_min_size(row.min + vec2(self.left, 0.0), vec2(self.width, row.height()))
    }
}

/// Columns of the table. A narrow table omits columns.
pub(super) struct TraceColumns {
    stage: Option<Column>,
    what: Column,
    formula: Option<Column>,
    value: Column,
    bits: Option<Column>,
    exact: Option<Column>,
    rounding: Option<Column>,
    show: Column,
}

impl TraceColumns {
    /// Computes the columns of a table `width` points wide. A narrow table omits the bits first, then the exact values,
    /// and then everything but quantity and value.
    pub(super) fn of(width: f32) -> Self {
        let fixed = STAGE + WHAT + VALUE + ROUNDING + SHOW + BAR;
        let (mut bits, mut exact) = (BITS, EXACT);
        if width - fixed - bits - exact < MIN_FORMULA_POINTS {
            bits = 0.0;
        }
        if width - fixed - bits - exact < MIN_FORMULA_POINTS {
            exact = 0.0;
        }
        let formula = width - fixed - bits - exact;
        if formula < MIN_FORMULA_POINTS {
            return Self::compact(width);
        }
        let mut left = 0.0;
        let mut column = |width: f32| {
            let column = Column { left, width };
            left += width;
            column
        };
        Self {
            stage: Some(column(STAGE)),
            what: column(WHAT),
            formula: Some(column(formula)),
            value: column(VALUE),
            bits: (bits > 0.0).then(|| column(bits)),
            exact: (exact > 0.0).then(|| column(exact)),
            rounding: Some(column(ROUNDING)),
            show: column(SHOW),
        }
    }

    /// Returns columns for quantity and value alone.
    fn compact(width: f32) -> Self {
        let what = (width - COMPACT_VALUE - SHOW - BAR).max(60.0);
        Self {
            stage: None,
            what: Column { left: 0.0, width: what },
            formula: None,
            value: Column { left: what, width: COMPACT_VALUE },
            bits: None,
            exact: None,
            rounding: None,
            show: Column { left: what + COMPACT_VALUE, width: SHOW },
        }
    }

    /// Whether the table shows only quantity and value.
    pub(super) fn is_compact(&self) -> bool {
        self.formula.is_none()
    }
}

/// Table of the lines of a trace.
pub(super) struct TraceTable<'a> {
    pub(super) trace: &'a Trace,
    /// Current line, and lines whose values have changed.
    pub(super) view: &'a TraceView,
    pub(super) columns: TraceColumns,
    /// Quantity that the canvas shows.
    pub(super) shown: Shown,
}

impl TraceTable<'_> {
    /// Draws the headings of the columns.
    pub(super) fn headings(&self, ui: &mut Ui) {
        let columns = &self.columns;
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
        let color = tokens(ui).text_weak;
        let font = FontId::proportional(font_size::SMALL);
        let left = |x: f32, text: &str| {
            ui.painter().text(rect.left_center() + vec2(x + 4.0, 0.0), Align2::LEFT_CENTER, text, font.clone(), color);
        };
        let right = |x: f32, text: &str| {
            ui.painter().text(rect.left_center() + vec2(x - 8.0, 0.0), Align2::RIGHT_CENTER, text, font.clone(), color);
        };
        for (column, text) in [
            (columns.stage, "Stage"),
            (Some(columns.what), "Quantity"),
            (columns.formula, "Formula"),
            (columns.bits, "Bits"),
            (columns.exact, "Exact"),
        ] {
            if let Some(column) = column {
                left(column.left, text);
            }
        }
        for (column, text) in [(Some(columns.value), "Value"), (columns.rounding, "Rounding")] {
            if let Some(column) = column {
                right(column.left + column.width, text);
            }
        }
    }

    /// Draws the row of the line at index `place`, and handles clicks on it.
    pub(super) fn row(&self, ui: &mut Ui, place: usize, commands: &mut Vec<Command>) {
        let Self { trace, view, columns, shown } = self;
        let line = &trace.lines[place];
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Row, true, format!("{} = {}", line.what, line.value_text())));
        let is_current = place == view.line;
        if is_current {
            ui.painter().rect_filled(rect, 2.0, tokens(ui).accent_fill);
        } else if response.hovered() || place % 2 == 1 {
            ui.painter().rect_filled(rect, 0.0, tokens(ui).raised);
        }
        let show = columns.show.of(rect);
        if response.clicked() {
            commands.push(Command::Trace(TraceChange::Line(place)));
        }
        let is_changed = view.is_changed(place);
        cells(ui, line, rect, columns, is_changed);
        response.on_hover_ui(|ui| explain(ui, line, is_changed));
        if let Some(buffer) = line.buffer {
            show_button(ui, show, Shown::Intermediate(buffer), *shown, commands);
        }
    }
}

/// Draws the texts of a row, each clipped to its column.
fn cells(ui: &Ui, line: &TraceLine, rect: Rect, columns: &TraceColumns, is_changed: bool) {
    let tokens = tokens(ui);
    let quiet = if line.aside { tokens.text_weak } else { tokens.text };
    let mono = FontId::monospace(font_size::SMALL);
    let plain = FontId::proportional(font_size::SMALL);
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
    if let Some(stage) = columns.stage {
        write(stage.of(rect), line.stage.name(), false, &plain, tokens.text_weak);
    }
    write(columns.what.of(rect), &line.what, false, &plain, quiet);
    if let Some(formula) = columns.formula {
        write(formula.of(rect), &line.formula, false, &mono, tokens.text_weak);
    }
    let value = columns.value.of(rect);
    write(value, &line.value_text(), true, &mono, if line.aside { quiet } else { tokens.text_strong });
    if is_changed {
        ui.painter().circle_filled(value.left_center(), 2.0, tokens.accent);
    }
    if let Some(bits) = columns.bits {
        write(bits.of(rect), &line.bits, false, &mono, tokens.text_weak);
    }
    if let (Some(column), Some(exact)) = (columns.exact, &line.exact) {
        write(column.of(rect), &exact.decimal, false, &mono, quiet);
    }
    // Without a column for rounding, the icon of a flagged line precedes the value.
    let rounding = columns.rounding.map_or(value, |column| column.of(rect));
    if !line.flags.is_empty() {
        let center = rounding.left_center() + vec2(8.0, 0.0);
        paint_icon(ui.painter(), center, Icon::TriangleAlert, 13.0, tokens.warning);
    }
    if columns.rounding.is_some() {
        match line.flags.first() {
            Some(flag) => {
                let word = flag.lost_bits.map_or_else(|| flag.kind.name().to_owned(), |bits| format!("−{bits} bits"));
                write(rounding.with_min_x(rounding.left() + 18.0), &word, false, &plain, tokens.warning);
            }
            None => write(rounding, &line.rounding(), true, &mono, quiet),
        }
    }
}

/// Draws all details of a line.
pub(super) fn explain(ui: &mut Ui, line: &TraceLine, is_changed: bool) {
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
