//! Tables of the manual. Their columns fit the width of the page, and their cells wrap.

use eframe::egui::{self, Align, Layout, Rect, RichText, Shape, TextStyle, TextWrapMode, Ui, UiBuilder, pos2, vec2};

use crate::ui::theme::{RADIUS, space, tokens};

/// Part of a cell with one style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Span<'a> {
    Text(&'a str),
    Code(&'a str),
    Strong(&'a str),
    Link { text: &'a str, target: &'a str },
}

impl<'a> Span<'a> {
    fn text(self) -> &'a str {
        match self {
            Self::Text(text) | Self::Code(text) | Self::Strong(text) | Self::Link { text, .. } => text,
        }
    }
}

/// Splits the Markdown of a cell into parts with one style each.
fn spans(cell: &str) -> Vec<Span<'_>> {
    let mut spans = Vec::new();
    let mut rest = cell;
    while !rest.is_empty() {
        let start = rest.find(['`', '*', '[']).unwrap_or(rest.len());
        let marked = &rest[start..];
        let found = marked_span(marked);
        // A mark without its counterpart is text.
        let length = if found.is_some() || marked.is_empty() { start } else { start + 1 };
        if length > 0 {
            spans.push(Span::Text(&rest[..length]));
        }
        rest = match found {
            Some((span, after)) => {
                spans.push(span);
                after
            }
            None => &rest[length..],
        };
    }
    spans
}

/// Returns the span at the start of the text, and the text after it; `None` if the text does not start with a mark and
/// its counterpart.
fn marked_span(text: &str) -> Option<(Span<'_>, &str)> {
    if let Some(code) = text.strip_prefix('`') {
        return code.split_once('`').map(|(code, after)| (Span::Code(code), after));
    }
    if let Some(strong) = text.strip_prefix("**") {
        return strong.split_once("**").map(|(strong, after)| (Span::Strong(strong), after));
    }
    let (text, rest) = text.strip_prefix('[')?.split_once("](")?;
    let (target, after) = rest.split_once(')')?;
    Some((Span::Link { text, target }, after))
}

/// Returns the widths of all columns. Narrow columns keep their natural width, and the others share the rest equally if
/// there is not enough room.
fn widths(natural: &[f32], room: f32) -> Vec<f32> {
    let mut sorted = natural.to_vec();
    sorted.sort_by(f32::total_cmp);
    let (mut rest, mut count) = (room, natural.len() as f32);
    let mut limit = f32::INFINITY;
    for width in sorted {
        limit = rest / count;
        if width > limit {
            break;
        }
        (rest, count, limit) = (rest - width, count - 1.0, f32::INFINITY);
    }
    natural.iter().map(|width| width.min(limit).max(0.0)).collect()
}

/// Draws a table whose first row is its header. Returns the target of the link that was clicked.
pub(super) fn ui(ui: &mut Ui, rows: &[Vec<String>]) -> Option<String> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let spacing = space::M;
    let natural: Vec<_> = (0..columns).map(|column| natural_width(ui, rows, column)).collect();
    let room = ui.available_width() - spacing * columns.saturating_sub(1) as f32 - 2.0 * space::S;
    let widths = widths(&natural, room);
    let mut clicked = None;
    ui.add_space(space::XS);
    for (index, row) in rows.iter().enumerate() {
        let background = ui.painter().add(Shape::Noop);
        let corner = ui.cursor().min;
        let (mut left, mut height) = (corner.x + space::S, 0.0_f32);
        for (cell, width) in row.iter().zip(&widths) {
            // The cell must not widen the table, even if a trailing space protrudes.
            let place = Rect::from_min_size(pos2(left, corner.y), vec2(*width, 0.0));
            let mut inner = ui.new_child(UiBuilder::new().max_rect(place).layout(Layout::top_down(Align::Min)));
            inner.push_id((index, left as i32), |ui| clicked = clicked.take().or(draw_cell(ui, cell, index == 0)));
            (left, height) = (left + width + spacing, height.max(inner.min_rect().height()));
        }
        let place = Rect::from_min_size(corner, vec2(ui.available_width(), height));
        ui.advance_cursor_after_rect(place);
        if index % 2 == 1 {
            ui.painter().set(background, Shape::rect_filled(place, RADIUS, tokens(ui).raised));
        }
    }
    ui.add_space(space::S);
    clicked
}

/// Returns the width that a column needs if nothing wraps.
fn natural_width(ui: &Ui, rows: &[Vec<String>], column: usize) -> f32 {
    let font = |style: TextStyle| style.resolve(ui.style());
    let width = |span: Span<'_>| {
        let style = if matches!(span, Span::Code(_)) { TextStyle::Monospace } else { TextStyle::Body };
        ui.painter().layout_no_wrap(span.text().to_owned(), font(style), egui::Color32::WHITE).size().x
    };
    let cells = rows.iter().filter_map(|row| row.get(column));
    cells.map(|cell| spans(cell).into_iter().map(width).sum::<f32>()).fold(0.0, f32::max).ceil() + 1.0
}

/// Draws a cell. Returns the target of the link that was clicked.
fn draw_cell(ui: &mut Ui, cell: &str, is_header: bool) -> Option<String> {
    let mut clicked = None;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.style_mut().wrap_mode = Some(TextWrapMode::Wrap);
        for span in spans(cell) {
            match span {
                Span::Text(text) if is_header => drop(ui.strong(text)),
                Span::Text(text) => drop(ui.label(text)),
                Span::Strong(text) => drop(ui.strong(text)),
                Span::Code(text) => drop(ui.label(RichText::new(text).code())),
                Span::Link { text, target } => {
                    if ui.link(text).clicked() {
                        clicked = Some(target.to_owned());
                    }
                }
            }
        }
    });
    clicked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_styles_and_links() {
        let link = Span::Link { text: "the view", target: "03-stages.md#view" };
        assert_eq!(
            spans("see [the view](03-stages.md#view) or `--a|b`, **now**"),
            [Span::Text("see "), link, Span::Text(" or "), Span::Code("--a|b"), Span::Text(", "), Span::Strong("now")]
        );
        let text = |cell| spans(cell).iter().map(|span| span.text()).collect::<String>();
        for plain in ["2 * 3", "a [b", "5 ` 6", ""] {
            assert_eq!(text(plain), plain, "marks without a counterpart are text");
        }
    }

    #[test]
    fn columns_fit_the_page_and_narrow_ones_do_not_wrap() {
        assert_eq!(widths(&[50.0, 60.0], 200.0), [50.0, 60.0]);
        assert_eq!(widths(&[50.0, 500.0, 300.0], 450.0), [50.0, 200.0, 200.0]);
        assert_eq!(widths(&[50.0, 90.0], 0.0), [0.0, 0.0]);
    }
}
