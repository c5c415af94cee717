//! Key sheet: every key and mouse gesture by topic, in columns, generated from the key map.

use eframe::egui::{Key, Label, RichText, ScrollArea, TextEdit, Ui, WidgetInfo, vec2};

use super::fuzzy::fit;
use super::key_map::{BINDINGS, KeyBinding, MOUSE, Topic};
use super::theme::{space, tokens};

/// Width of a column, in points.
const COLUMN_POINTS: f32 = 380.0;

/// Width of the key names within a column, in points.
const KEYS_POINTS: f32 = 128.0;

/// Total margin to the left and right of the sheet, in points.
const MARGIN_POINTS: f32 = 40.0;

/// Height of a line, in points. It is less than the height of controls, because lines are not clickable.
const LINE_POINTS: f32 = 16.0;

/// Maximum number of keys listed for one action. If there are more, only the first and the last are listed.
const MAX_KEYS: usize = 3;

/// Returns the width of the sheet, in points: three columns if the window has room for them, otherwise two.
pub(crate) fn width(ui: &Ui) -> f32 {
    COLUMN_POINTS * columns(ui) as f32
}

fn columns(ui: &Ui) -> usize {
    if ui.ctx().content_rect().width() >= 3.0 * COLUMN_POINTS + MARGIN_POINTS { 3 } else { 2 }
}

/// Line of the sheet: an action's keys or mouse gesture, and the description of the action.
struct SheetLine {
    keys: Vec<String>,
    what: &'static str,
}

impl SheetLine {
    /// Estimates the number of text rows that the key names need.
    fn rows(&self) -> usize {
        /// Estimated number of characters that fit into one row.
        const LETTERS: usize = 17;
        self.names().chars().count().div_ceil(LETTERS)
    }

    fn names(&self) -> String {
        match &self.keys[..] {
            [first, .., last] if self.keys.len() > MAX_KEYS => format!("{first} … {last}"),
            keys => keys.join(", "),
        }
    }
}

/// Returns the keys and the description of every line of the sheet, ordered by topic.
pub fn keys_and_descriptions() -> Vec<(String, &'static str)> {
    let all = Topic::ALL.into_iter().flat_map(|(topic, _)| lines(topic, ""));
    all.map(|line| (line.names(), line.what)).collect()
}

/// Draws the sheet, limited to the lines that match `filter`.
pub(crate) fn ui(ui: &mut Ui, filter: &mut String) {
    let field = ui.add(TextEdit::singleline(filter).hint_text("Filter by key or word").desired_width(240.0));
    field.widget_info(|| WidgetInfo::labeled(eframe::egui::Role::TextInput, true, "Filter the keys"));
    ui.add_space(space::S);
    let topics: Vec<_> = Topic::ALL.into_iter().map(|(topic, name)| (name, lines(topic, filter))).collect();
    let topics: Vec<_> = topics.into_iter().filter(|(_, lines)| !lines.is_empty()).collect();
    if topics.is_empty() {
        ui.label(RichText::new("No key matches.").color(tokens(ui).text_weak));
    }
    let rows = |lines: &[SheetLine]| lines.iter().map(SheetLine::rows).sum::<usize>();
    let all: usize = topics.iter().map(|(_, lines)| rows(lines) + 1).sum();
    let height = (ui.ctx().content_rect().height() * 0.74).max(120.0);
    let count = columns(ui);
    // The height is fixed: a sheet that grows from frame to frame would move its buttons away from the pointer.
    ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        ui.spacing_mut().interact_size.y = LINE_POINTS;
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.columns(count, |columns| {
            let mut before = 0;
            for (name, lines) in &topics {
                // A topic is placed in the column that contains its middle row.
                let column = (count * (2 * before + rows(lines)) / (2 * all)).min(count - 1);
                show(&mut columns[column], name, lines);
                before += rows(lines) + 1;
            }
        });
    });
}

fn show(ui: &mut Ui, topic: &str, lines: &[SheetLine]) {
    ui.label(RichText::new(topic).strong().color(tokens(ui).text_strong));
    for line in lines {
        ui.horizontal_top(|ui| {
            ui.allocate_ui(vec2(KEYS_POINTS, LINE_POINTS), |ui| {
                ui.set_width(KEYS_POINTS);
                ui.add(Label::new(RichText::new(line.names()).monospace().color(tokens(ui).accent)).wrap());
            });
            ui.add(Label::new(line.what).wrap());
        });
    }
    ui.add_space(space::S);
}

/// Returns the lines of a topic that match `filter`. Keys with the same description share a line.
fn lines(topic: Topic, filter: &str) -> Vec<SheetLine> {
    let mut lines: Vec<SheetLine> = Vec::new();
    if topic == Topic::Mouse {
        lines.extend(MOUSE.iter().map(|(gesture, what)| SheetLine { keys: vec![(*gesture).to_owned()], what }));
    }
    for binding in BINDINGS.iter().filter(|binding| binding.topic == topic) {
        match lines.iter_mut().find(|line| line.what == binding.description) {
            Some(known) => known.keys.push(key_name(binding)),
            None => lines.push(SheetLine { keys: vec![key_name(binding)], what: binding.description }),
        }
    }
    lines.retain(|line| fit(filter, &format!("{} {}", line.names(), line.what)).is_some());
    lines
}

/// Returns the name of a key with its modifiers, using only characters that the fonts contain.
pub(crate) fn key_name(binding: &KeyBinding) -> String {
    let mut name = String::new();
    if binding.modifiers.command || binding.modifiers.ctrl {
        name.push_str("Ctrl + ");
    }
    if binding.modifiers.alt {
        name.push_str("Alt + ");
    }
    if binding.modifiers.shift {
        name.push_str("Shift + ");
    }
    name + match binding.key {
        // None of the fonts contains the toolkit's own symbols for these keys.
        Key::ArrowLeft => "←",
        Key::ArrowRight => "→",
        Key::ArrowUp => "↑",
        Key::ArrowDown => "↓",
        key => key.symbol_or_name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_listed_on_the_sheet_once() {
        let all: Vec<SheetLine> = Topic::ALL.into_iter().flat_map(|(topic, _)| lines(topic, "")).collect();
        for binding in BINDINGS {
            let of_it = all.iter().filter(|line| line.what == binding.description);
            assert_eq!(of_it.count(), 1, "{}", binding.description);
        }
        assert!(MOUSE.iter().all(|(gesture, _)| all.iter().any(|line| line.keys == [*gesture])));
    }

    #[test]
    fn the_filter_finds_keys_and_words() {
        let found = |filter: &str| -> Vec<&str> {
            Topic::ALL.into_iter().flat_map(|(topic, _)| lines(topic, filter)).map(|line| line.what).collect()
        };
        assert!(found("ctrl z").contains(&"Undo the last change"));
        assert!(found("bookmark").contains(&"Bookmark the current view"));
        assert!(found("qqqqq").is_empty());
    }
}
