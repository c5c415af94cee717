//! The key sheet: every key and gesture by topic, in columns, from the one table that defines the keys.

use eframe::egui::{Key, Label, RichText, ScrollArea, TextEdit, Ui, WidgetInfo, vec2};

use super::command::{BINDINGS, Binding, Command, MOUSE};
use super::palette::fuzzy::fit;
use super::theme::{space, tokens};

/// Width of a column, in points.
const COLUMN_POINTS: f32 = 380.0;

/// Width of the keys in a column, in points.
const KEYS_POINTS: f32 = 128.0;

/// Room on both sides of the sheet, in points.
const MARGIN_POINTS: f32 = 40.0;

/// Height of a line, in points: closer than controls, as nothing is to be hit.
const LINE_POINTS: f32 = 16.0;

/// More keys than this for one thing are told by the first and the last.
const MOST_KEYS: usize = 3;

/// Width of the sheet, in points: three columns if the window has room for them, else two.
pub fn width(ui: &Ui) -> f32 {
    COLUMN_POINTS * columns(ui) as f32
}

fn columns(ui: &Ui) -> usize {
    if ui.ctx().content_rect().width() >= 3.0 * COLUMN_POINTS + MARGIN_POINTS { 3 } else { 2 }
}

/// What a key is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Topic {
    Mouse,
    Picture,
    Pixel,
    Stages,
    Scene,
    Settings,
    Places,
    Comparing,
    Making,
    Showing,
    Arithmetic,
    General,
}

impl Topic {
    const ALL: [(Self, &'static str); 12] = [
        (Self::Mouse, "Mouse"),
        (Self::Picture, "The picture on the canvas"),
        (Self::Pixel, "The picked pixel"),
        (Self::Stages, "Stages"),
        (Self::Making, "How the frame comes about"),
        (Self::Showing, "Range and overlays"),
        (Self::Arithmetic, "Arithmetic of the picked pixel"),
        (Self::Places, "Finding and keeping places"),
        (Self::Scene, "Scene and view"),
        (Self::Settings, "Settings"),
        (Self::Comparing, "Comparing"),
        (Self::General, "Everything else"),
    ];

    /// The topic of a key, by what it does.
    fn of(binding: &Binding) -> Self {
        match (binding.command)() {
            Command::NudgePick(..) | Command::Pick(_) | Command::Watch(_) | Command::StepFault(_) | Command::Escape => {
                Self::Pixel
            }
            Command::ZoomFit | Command::ZoomOne | Command::SavePicture | Command::SaveData | Command::CopyPicture => {
                Self::Picture
            }
            Command::StepStage(_) | Command::Show(_) => Self::Stages,
            Command::StepTriangle(_) | Command::LimitTriangles(_) | Command::Scrub(_) => Self::Making,
            Command::Range(_) | Command::Overlays(_) => Self::Showing,
            Command::Trace(_) => Self::Arithmetic,
            Command::AskForFile
            | Command::TogglePointerMode
            | Command::ResetCamera
            | Command::FitCamera
            | Command::MeshView(_) => Self::Scene,
            Command::Undo | Command::Redo | Command::ChooseUpscaler(_) | Command::SetRecipe(_) => Self::Settings,
            Command::Place(_) | Command::OpenPalette | Command::AskForPixel => Self::Places,
            Command::Compare(_) | Command::WhatIf(_) => Self::Comparing,
            _ => Self::General,
        }
    }
}

/// A key or gesture, and what it does.
struct Line {
    keys: Vec<String>,
    what: &'static str,
}

impl Line {
    /// About how many rows its keys take.
    fn rows(&self) -> usize {
        /// Letters that fit beside each other.
        const LETTERS: usize = 17;
        self.names().chars().count().div_ceil(LETTERS)
    }

    fn names(&self) -> String {
        match &self.keys[..] {
            [first, .., last] if self.keys.len() > MOST_KEYS => format!("{first} … {last}"),
            keys => keys.join(", "),
        }
    }
}

/// Draws the sheet, of what has the letters of `filter`.
pub fn ui(ui: &mut Ui, filter: &mut String) {
    let field = ui.add(TextEdit::singleline(filter).hint_text("Filter by key or word").desired_width(240.0));
    field.widget_info(|| WidgetInfo::labeled(eframe::egui::Role::TextInput, true, "Filter the keys"));
    ui.add_space(space::S);
    let topics: Vec<_> = Topic::ALL.into_iter().map(|(topic, name)| (name, lines(topic, filter))).collect();
    let topics: Vec<_> = topics.into_iter().filter(|(_, lines)| !lines.is_empty()).collect();
    if topics.is_empty() {
        ui.label(RichText::new("No key has these letters.").color(tokens(ui).text_weak));
    }
    let rows = |lines: &[Line]| lines.iter().map(Line::rows).sum::<usize>();
    let all: usize = topics.iter().map(|(_, lines)| rows(lines) + 1).sum();
    let height = (ui.ctx().content_rect().height() * 0.74).max(120.0);
    let count = columns(ui);
    // At once as high as it may be: a sheet that grows from frame to frame has no button that can be hit.
    ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        ui.spacing_mut().interact_size.y = LINE_POINTS;
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.columns(count, |columns| {
            let mut before = 0;
            for (name, lines) in &topics {
                // A topic stands in the column that its middle falls into.
                let column = (count * (2 * before + rows(lines)) / (2 * all)).min(count - 1);
                show(&mut columns[column], name, lines);
                before += rows(lines) + 1;
            }
        });
    });
}

fn show(ui: &mut Ui, topic: &str, lines: &[Line]) {
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

/// The lines of a topic that have the letters of `filter`. Further keys for the same thing stand beside the first.
fn lines(topic: Topic, filter: &str) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    if topic == Topic::Mouse {
        lines.extend(MOUSE.iter().map(|(gesture, what)| Line { keys: vec![(*gesture).to_owned()], what }));
    }
    for binding in BINDINGS.iter().filter(|binding| Topic::of(binding) == topic) {
        match lines.iter_mut().find(|line| line.what == binding.what) {
            Some(known) => known.keys.push(key_name(binding)),
            None => lines.push(Line { keys: vec![key_name(binding)], what: binding.what }),
        }
    }
    lines.retain(|line| fit(filter, &format!("{} {}", line.names(), line.what)).is_some());
    lines
}

/// A key with what is held, in words and signs that the fonts have.
pub fn key_name(binding: &Binding) -> String {
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
        // The toolkit's own signs for these are in none of the fonts.
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
    fn every_key_stands_on_the_sheet_once() {
        let all: Vec<Line> = Topic::ALL.into_iter().flat_map(|(topic, _)| lines(topic, "")).collect();
        for binding in BINDINGS {
            let of_it = all.iter().filter(|line| line.what == binding.what);
            assert_eq!(of_it.count(), 1, "{}", binding.what);
        }
        assert!(MOUSE.iter().all(|(gesture, _)| all.iter().any(|line| line.keys == [*gesture])));
    }

    #[test]
    fn the_filter_finds_keys_and_words() {
        let found = |filter: &str| -> Vec<&str> {
            Topic::ALL.into_iter().flat_map(|(topic, _)| lines(topic, filter)).map(|line| line.what).collect()
        };
        assert!(found("ctrl z").contains(&"Undo the last setting"));
        assert!(found("bookmark").contains(&"Bookmark this place"));
        assert!(found("qqqqq").is_empty());
    }
}
