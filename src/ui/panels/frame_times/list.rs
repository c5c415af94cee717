//! The dot plot: a header with the time axis, and below it a row for each method.

use std::sync::Arc;

use eframe::egui::{
    Align, Align2, Checkbox, Color32, FontId, Galley, Layout, Rangef, Rect, Response, Role, ScrollArea, Sense, Stroke,
    TextStyle, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use super::axis::TimeAxis;
use super::columns::Columns;
use super::marks::RowMarks;
use super::rows::MethodRow;
use super::tooltip;
use crate::chain::Recipe;
use crate::ui::panels::{budget_line, tradeoff};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::timings::{RowOrder, TimingsChange};
use crate::ui::session::workspace::Panel;
use crate::ui::theme::{RADIUS, font_size, space, tokens};
use crate::upscale::Upscaling;

/// Minimum height of a row, in points.
pub(super) const ROW: f32 = 22.0;

/// Height of the line with tick labels and column headings, in points.
const HEADINGS: f32 = 18.0;

/// Height of everything above the rows, in points.
pub(super) const HEADER: f32 = budget_line::LABEL_HEIGHT + HEADINGS;

/// Width of the mark at the left end of the row of the current upscaler, in points.
const MARK: f32 = 3.0;

/// List of rows with their time axis.
#[derive(Clone, Copy)]
pub(super) struct MethodListView<'a> {
    /// Rows that the filter shows, in display order.
    pub(super) rows: &'a [MethodRow],
    /// Axis of the times of all rows, shown or not.
    pub(super) axis: TimeAxis,
    /// State of the window.
    pub(super) session: &'a Session,
}

impl MethodListView<'_> {
    /// Draws the list in the available space. The header stays in place while the rows scroll vertically. `add_below`
    /// adds content below the last row.
    pub(super) fn ui(self, ui: &mut Ui, commands: &mut Vec<Command>, add_below: impl FnOnce(&mut Ui)) {
        ui.spacing_mut().item_spacing.y = 0.0;
        let width = ui.available_width() - ui.spacing().scroll.allocated_width();
        let (header, _) = ui.allocate_exact_size(vec2(width, HEADER), Sense::hover());
        let has_errors = self.rows.iter().any(|row| row.error.is_some());
        let columns = Columns::divide(header.x_range(), self.widest_name(ui), has_errors, self.axis);
        self.header(ui, header, columns);
        let scrolled = ScrollArea::vertical().id_salt("frame time rows").auto_shrink(false).show(ui, |ui| {
            ui.set_width(width);
            let hovered = self.rows(ui, columns, commands);
            let bottom = ui.min_rect().bottom();
            ui.add_space(space::S);
            add_below(ui);
            (hovered, bottom)
        });
        let (hovered, bottom) = scrolled.inner;
        let change = self.session.features.timings.list.hover_change(Panel::FrameTime, hovered);
        commands.extend(change.map(Command::Timings));
        let bottom = bottom.clamp(header.bottom(), scrolled.inner_rect.bottom().max(header.bottom()));
        let plot = columns.plot_area(Rangef::new(header.bottom() - budget_line::GRIP_HEIGHT, bottom));
        if let Some(x) = budget_line::line(ui, plot, columns.x(self.session.features.timings.budget_ms())) {
            commands.push(Command::Timings(TimingsChange::Budget(columns.ms_at(x))));
        }
    }

    fn widest_name(&self, ui: &Ui) -> f32 {
        let font = TextStyle::Body.resolve(ui.style());
        let width = |row: &MethodRow| {
            ui.painter().layout_no_wrap(row.upscaling.label(), font.clone(), Color32::WHITE).size().x.ceil()
        };
        self.rows.iter().map(width).fold(0.0, f32::max)
    }

    /// Draws the label of the budget line, and below it the column headings and the labels of the ticks.
    fn header(&self, ui: &Ui, rect: Rect, columns: Columns) {
        let label = rect.with_max_y(rect.top() + budget_line::LABEL_HEIGHT);
        budget_line::label(ui, self.session, label, columns.x(self.session.features.timings.budget_ms()));
        let weak = tokens(ui).text_weak;
        let baseline = rect.bottom() - space::XS;
        let heading = |x: f32, align: Align2, text: &str| {
            ui.painter().text(pos2(x, baseline), align, text, FontId::proportional(font_size::SMALL), weak);
        };
        heading(columns.names.min, Align2::LEFT_BOTTOM, "Upscaler");
        heading(columns.ms, Align2::RIGHT_BOTTOM, "ms");
        heading(columns.speedup, Align2::RIGHT_BOTTOM, "speed-up");
        if let Some(flip) = columns.flip {
            heading(flip, Align2::RIGHT_BOTTOM, "FLIP");
        }
        let font = FontId::monospace(font_size::SMALL);
        for ms in columns.ticks() {
            let place = pos2(columns.x(ms), baseline);
            ui.painter().text(place, Align2::CENTER_BOTTOM, ms.to_string(), font.clone(), weak);
        }
    }

    /// Draws all rows. Returns the upscaler under the pointer.
    fn rows(&self, ui: &mut Ui, columns: Columns, commands: &mut Vec<Command>) -> Option<Upscaling> {
        let marks = RowMarks::new(columns, self.session, self.rows);
        let groups = self.session.features.timings.list.order == RowOrder::Method;
        let mut hovered = None;
        for (index, row) in self.rows.iter().enumerate() {
            let top = ui.cursor().top();
            if self.row(ui, &marks, row, commands) {
                hovered = Some(row.upscaling);
            }
            let before = index.checked_sub(1).map(|before| self.rows[before].upscaling.method());
            if groups && before.is_some_and(|before| before != row.upscaling.method()) {
                ui.painter().hline(columns.whole, top, Stroke::new(1.0, tokens(ui).control));
            }
        }
        hovered
    }

    fn is_current(&self, upscaling: Upscaling) -> bool {
        self.session.state.recipe.upscaler == upscaling
    }

    /// Lays out the name of a row, on several lines if it is longer than its column.
    fn name(&self, ui: &Ui, columns: Columns, row: &MethodRow) -> Arc<Galley> {
        let color = match (row.native_within_noise, self.is_current(row.upscaling)) {
            (true, _) => tokens(ui).text_weak,
            (false, true) => tokens(ui).text_strong,
            (false, false) => tokens(ui).text,
        };
        let font = TextStyle::Body.resolve(ui.style());
        ui.painter().layout(row.upscaling.label(), font, color, columns.names.span() + 1.0)
    }

    /// Draws a row, and handles clicks on it and on its check box. Returns whether the pointer is on the row.
    fn row(&self, ui: &mut Ui, marks: &RowMarks, row: &MethodRow, commands: &mut Vec<Command>) -> bool {
        let columns = marks.columns;
        let name = self.name(ui, columns, row);
        let height = (name.size().y + space::XS).max(ROW);
        let (_, rect) = ui.allocate_space(vec2(columns.whole.span(), height));
        // The id depends on the method, so that sorting does not move the keyboard focus to another method.
        let response = ui.interact(rect, ui.scope_id().with(("row", row.upscaling.label())), Sense::click());
        let is_current = self.is_current(row.upscaling);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_current, row.name()));
        if ui.is_rect_visible(rect) {
            self.backdrop(ui, &response, row.upscaling);
            ui.painter().galley(pos2(columns.names.min, rect.center().y - name.size().y / 2.0), name, tokens(ui).text);
            marks.ui(ui, rect, row);
        }
        let cell = Rect::from_x_y_ranges(columns.checks, rect.y_range());
        self.check_box(ui, cell, row.upscaling, commands);
        // Also true if the check box or the budget line is under the pointer, which cover the row.
        let is_hovered = response.contains_pointer();
        if response.clicked() {
            self.choose(ui, row.upscaling, commands);
        }
        response.on_hover_ui(|ui| tooltip::ui(ui, row, self.session));
        is_hovered
    }

    /// Draws the background of a row, which shows whether it is current, under the pointer, or focused.
    fn backdrop(&self, ui: &Ui, response: &Response, upscaling: Upscaling) {
        let is_hovered = self.session.features.timings.list.hovered() == Some(upscaling);
        let is_current = self.is_current(upscaling);
        if is_hovered || is_current {
            ui.painter().rect_filled(response.rect, RADIUS, tokens(ui).raised);
        }
        if is_current {
            ui.painter().rect_filled(response.rect.with_max_x(response.rect.left() + MARK), RADIUS, tokens(ui).accent);
        }
        if response.has_focus() {
            let line = Stroke::new(1.0, tokens(ui).accent);
            ui.painter().rect_stroke(response.rect, RADIUS, line, eframe::egui::StrokeKind::Inside);
        }
    }

    fn check_box(&self, ui: &mut Ui, cell: Rect, upscaling: Upscaling, commands: &mut Vec<Command>) {
        let label = upscaling.label();
        let size = ui.spacing().icon_width;
        let place = Rect::from_center_size(cell.center() + vec2(MARK / 2.0, 0.0), vec2(size, size));
        let builder =
            UiBuilder::new().id_salt(("check", &label)).max_rect(place).layout(Layout::left_to_right(Align::Center));
        let mut child = ui.new_child(builder);
        child.spacing_mut().interact_size = vec2(size, size);
        let mut is_checked = self.session.features.timings.list.is_checked(upscaling);
        let response = child.add(Checkbox::without_text(&mut is_checked));
        let words = format!("Plot the frames of {label}");
        response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, is_checked, &words));
        if response.on_hover_text(words).changed() {
            commands.push(Command::Timings(TimingsChange::ToggleChecked(upscaling)));
        }
    }

    /// Draws the picture with an upscaler; with Shift held, compares the picture with that of the upscaler.
    fn choose(&self, ui: &Ui, upscaling: Upscaling, commands: &mut Vec<Command>) {
        if ui.input(|input| input.modifiers.shift) {
            let other = usize::from(self.session.state.tiles.active == 0);
            tradeoff::choose(self.session, other, upscaling, commands);
        } else {
            commands.push(Command::SetRecipe(Recipe { upscaler: upscaling, ..self.session.state.recipe }));
        }
    }
}
