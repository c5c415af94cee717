//! The time budget in plots: a vertical line that can be dragged, and a label that names the method with the lowest
//! error within the budget.

use eframe::egui::{CursorIcon, FontId, Pos2, Rangef, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::ui::session::Session;
use crate::ui::theme::{self, Icon, font_size, space, tokens};

/// Half the width of the area in which the line can be dragged, in points.
const REACH: f32 = 4.0;

/// Half the width of the grip at the top of the line, in points.
const GRIP: f32 = 5.0;

/// Size of the star in the label, in points.
const STAR: f32 = 12.0;

/// Width of the line, in points.
const WIDTH: f32 = 1.5;

/// Height of the grip at the top of the line, in points.
pub(super) const GRIP_HEIGHT: f32 = 6.0;

/// Height of the label, in points.
pub(super) const LABEL_HEIGHT: f32 = 18.0;

/// Draws the line at `x` over the height of `plot`, with a grip at its top. Returns the new position while the line is
/// dragged, limited to the plot.
pub(super) fn line(ui: &Ui, plot: Rect, x: f32) -> Option<f32> {
    let strip = Rect::from_x_y_ranges(Rangef::new(x - REACH, x + REACH), plot.y_range());
    let response = ui.interact(strip, ui.scope_id().with("budget line"), Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Splitter, true, "Time budget"));
    let color = tokens(ui).accent;
    ui.painter().vline(x, plot.y_range(), Stroke::new(WIDTH, color));
    let grip = [pos2(x - GRIP, plot.top()), pos2(x + GRIP, plot.top()), pos2(x, plot.top() + GRIP_HEIGHT + 2.0)];
    ui.painter().add(Shape::convex_polygon(grip.to_vec(), color, Stroke::NONE));
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged());
    pointer.map(|pointer: Pos2| pointer.x.clamp(plot.left(), plot.right()))
}

/// Draws the label of the line: the winner in words, after a star if there is one. The label is centred at `x` and
/// shifted where it would extend beyond `area`.
pub(super) fn label(ui: &Ui, session: &Session, area: Rect, x: f32) {
    let winner = session.features.timings.budget_winner();
    let words = winner.words(session.features.timings.metric_in_use(), session.features.timings.budget_ms());
    let star = if winner.best().is_some() { STAR + space::XS } else { 0.0 };
    let galley = ui.painter().layout_no_wrap(words.clone(), FontId::proportional(font_size::SMALL), tokens(ui).text);
    let width = star + galley.size().x;
    let left = (x - width / 2.0).min(area.right() - width).max(area.left());
    let place = Rect::from_min_size(pos2(left, area.top()), vec2(width, area.height()));
    if star > 0.0 {
        let center = pos2(left + STAR / 2.0, place.center().y);
        theme::paint_icon(ui.painter(), center, Icon::Star, STAR, tokens(ui).accent);
    }
    let corner = pos2(left + star, place.center().y - galley.size().y / 2.0);
    ui.painter().galley(corner, galley, tokens(ui).text);
    let response = ui.interact(place, ui.scope_id().with("budget label"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &words));
    response.on_hover_text("Lowest mean error among the methods whose median time is within the budget");
}
