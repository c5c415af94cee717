//! The command palette, which finds every action of the window by a few letters of its name.

pub(crate) mod entries;

use eframe::egui::{
    Align, Align2, FontId, Frame, Id, Key, Label, Layout, Modal, Modifiers, RichText, Role, ScrollArea, Sense,
    TextEdit, TextFormat, Ui, UiBuilder, WidgetInfo, text::LayoutJob, vec2,
};

use super::session::Session;
use super::session::command::Command;
use super::theme::{self, ROW_HEIGHT, font_size, space, tokens};
use crate::ui::session::stages::StageChange;
use entries::{Action, PaletteEntry, all, assignment, destination};

/// Width of the palette, in points.
const WIDTH: f32 = 620.0;

/// Maximum height of the list of entries, in points.
const LIST_HEIGHT: f32 = 15.0 * ROW_HEIGHT;

/// Distance of the palette from the top of the window, in points. The list grows downwards, so the search field does
/// not move.
const TOP: f32 = 90.0;

/// Maximum number of matching entries shown. A longer query narrows the list.
const MAX_SHOWN: usize = 100;

/// State of the open command palette.
pub(crate) struct Palette {
    query: String,
    entries: Vec<PaletteEntry>,
    /// Indices of matching entries, best first, each with its matched letters.
    found: Vec<(usize, Vec<usize>)>,
    found_for: Option<String>,
    /// Entry created from the query itself, if the query is an assignment such as `light.ambient=0.3` or a destination
    /// such as a triangle.
    typed: Option<PaletteEntry>,
    chosen: usize,
}

impl Palette {
    /// Opens the palette with an initial query.
    pub(crate) fn new(session: &Session, query: &str) -> Self {
        let entries = all(session);
        Self { query: query.to_owned(), entries, found: Vec::new(), found_for: None, typed: None, chosen: 0 }
    }

    /// Draws the palette. Returns whether it stays open.
    pub(crate) fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> bool {
        let area = Modal::default_area(Id::unique("palette")).anchor(Align2::CENTER_TOP, vec2(0.0, TOP));
        let modal =
            Modal::new(Id::unique("palette")).area(area).frame(Frame::window(ui.style())).show(ui.ctx(), |ui| {
                ui.set_width(WIDTH);
                self.content(ui, session)
            });
        let stays = !modal.should_close();
        let Some(PaletteEntry { action, owner, .. }) = modal.inner else { return stays };
        commands.extend(owner.map(|stage| Command::Stage(StageChange::Select(stage))));
        match action {
            Action::Run(command) => {
                commands.push(*command);
                false
            }
            Action::Type(text) => {
                self.query = text;
                stays
            }
        }
    }

    /// Draws the search field and the list. Returns the entry that the user chose, if any.
    fn content(&mut self, ui: &mut Ui, session: &Session) -> Option<PaletteEntry> {
        let step = ui.input_mut(|input| {
            let mut pressed = |key| i64::from(input.consume_key(Modifiers::NONE, key));
            let page = (LIST_HEIGHT / ROW_HEIGHT) as i64 - 1;
            pressed(Key::ArrowDown) - pressed(Key::ArrowUp) + page * (pressed(Key::PageDown) - pressed(Key::PageUp))
        });
        let hint =
            "Find a command, setting, scene, buffer, stage, panel or upscaler, or type key=value, x,y, tri 12 or v 12";
        let field = ui.add(TextEdit::singleline(&mut self.query).hint_text(hint).desired_width(f32::INFINITY));
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Find anything"));
        if !field.has_focus() {
            field.request_focus();
            to_the_end(ui, field.id, &self.query);
        }
        self.search(session);
        let count = self.count();
        self.chosen = (self.chosen as i64 + step).clamp(0, count.saturating_sub(1) as i64) as usize;
        let entered = ui.input(|input| input.key_pressed(Key::Enter));
        ui.add_space(space::XS);
        if count == 0 {
            // No scroll area: egui panics if a scroll bar is pressed in the pass in which its list empties.
            ui.label(RichText::new("No entry matches.").color(tokens(ui).text_weak));
            return None;
        }
        let clicked = ScrollArea::vertical()
            .max_height(LIST_HEIGHT)
            .min_scrolled_height(LIST_HEIGHT)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                let mut clicked = None;
                for place in 0..count {
                    let Some((entry, letters)) = self.at(place) else { continue };
                    let chosen = place == self.chosen;
                    let row = row(ui, entry, letters, chosen);
                    if chosen && step != 0 {
                        row.scroll_to_me(None);
                    }
                    if row.clicked() {
                        clicked = Some(place);
                    }
                }
                clicked
            });
        let place = clicked.inner.or_else(|| entered.then_some(self.chosen))?;
        self.at(place).map(|(entry, _)| entry.clone())
    }

    fn search(&mut self, session: &Session) {
        if self.found_for.as_ref() == Some(&self.query) {
            return;
        }
        let fits = self.entries.iter().enumerate().filter_map(|(place, entry)| {
            let fit = entry.fit(&self.query)?;
            Some((fit.score, place, fit.letters))
        });
        let mut found: Vec<_> = fits.collect();
        found.sort_by_key(|(score, place, _)| (std::cmp::Reverse(*score), *place));
        found.truncate(MAX_SHOWN);
        self.found = found.into_iter().map(|(_, place, letters)| (place, letters)).collect();
        self.typed = assignment(session, &self.query).or_else(|| destination(session, &self.query));
        self.found_for = Some(self.query.clone());
        self.chosen = 0;
    }

    fn count(&self) -> usize {
        self.found.len() + usize::from(self.typed.is_some())
    }

    /// Returns the entry at a position of the list and the indices of its matched letters. The entry created from the
    /// query itself comes first.
    fn at(&self, place: usize) -> Option<(&PaletteEntry, &[usize])> {
        let place = match &self.typed {
            Some(entry) if place == 0 => return Some((entry, &[])),
            Some(_) => place - 1,
            None => place,
        };
        let (entry, letters) = self.found.get(place)?;
        Some((self.entries.get(*entry)?, letters))
    }
}

/// Moves the text cursor to the end of the search field.
fn to_the_end(ui: &Ui, field: Id, text: &str) {
    use eframe::egui::text::{CCursor, CCursorRange};
    let mut state = eframe::egui::text_edit::TextEditState::load(ui.ctx(), field).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::one(CCursor::new(text.chars().count()))));
    state.store(ui.ctx(), field);
}

/// Draws one entry: category, title with the matched letters highlighted, “current” for the current value, and key.
fn row(ui: &mut Ui, entry: &PaletteEntry, letters: &[usize], chosen: bool) -> eframe::egui::Response {
    /// Width of the category column, in points.
    const KIND_POINTS: f32 = 84.0;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::click());
    let fill = if chosen { tokens(ui).accent_fill } else { tokens(ui).raised };
    if chosen || response.hovered() {
        ui.painter().rect_filled(rect, theme::RADIUS, fill);
    }
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &entry.title));
    let inner = rect.shrink2(vec2(space::S, 0.0));
    let mut left = ui.new_child(UiBuilder::new().max_rect(inner).layout(Layout::left_to_right(Align::Center)));
    left.allocate_ui(vec2(KIND_POINTS, ROW_HEIGHT), |ui| {
        ui.set_width(KIND_POINTS);
        ui.label(RichText::new(entry.kind.name()).small().color(tokens(ui).text_weak));
    });
    left.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if !entry.key.is_empty() {
            ui.label(RichText::new(&entry.key).monospace().color(tokens(ui).text_weak));
        }
        if entry.is_current {
            ui.label(RichText::new("current").small().color(tokens(ui).accent));
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(Label::new(marked(ui, &entry.title, letters)).truncate());
        });
    });
    if entry.help.is_empty() { response } else { response.on_hover_text(&entry.help) }
}

/// Lays out a title with the matched letters highlighted.
fn marked(ui: &Ui, title: &str, letters: &[usize]) -> LayoutJob {
    let mut job = LayoutJob::default();
    for (place, letter) in title.chars().enumerate() {
        let color = if letters.contains(&place) { tokens(ui).accent } else { tokens(ui).text_strong };
        let format = TextFormat { font_id: FontId::proportional(font_size::BODY), color, ..TextFormat::default() };
        job.append(letter.encode_utf8(&mut [0; 4]), 0.0, format);
    }
    job
}

#[cfg(test)]
mod tests;
