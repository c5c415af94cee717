//! The manual window: search field and list of chapters on the left, the open chapter on the right.

mod table;

use std::collections::BTreeSet;

use eframe::egui::{self, Key, Label, RichText, ScrollArea, Sense, TextEdit, Ui, WidgetInfo, vec2};
use egui_commonmark::{CommonMarkCache, CommonMarkViewer};

use super::session::command::Command;
use super::theme::{self, CONTROL_HEIGHT, Icon, space, tokens};
use super::widgets::{copy_button, icon_button};
use crate::manual::{Chapter, Passage, Section, SectionPart, find, web_address};
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::window_task::DialogCommand;

/// Initial size of the manual window, in points.
const DEFAULT_SIZE_POINTS: [f32; 2] = [820.0, 560.0];

/// Width of the list of chapters and search results, in points.
const LIST_POINTS: f32 = 220.0;

/// Maximum number of search results listed.
const MAX_RESULTS: usize = 40;

/// State of the manual window: the open chapter and the search query.
#[derive(Default)]
pub(crate) struct ManualWindow {
    is_open: bool,
    chapter: Chapter,
    query: String,
    /// Index of the section to scroll to in the next frame.
    scroll_to: Option<usize>,
    /// Whether the search field gets the keyboard focus in the next frame.
    focuses_search: bool,
    cache: CommonMarkCache,
    /// Targets of all links in the manual.
    links: BTreeSet<String>,
}

impl ManualWindow {
    /// Opens the window at a chapter. `None` opens the last chapter and focuses the search field.
    pub(crate) fn open(&mut self, chapter: Option<Chapter>) {
        self.is_open = true;
        match chapter {
            Some(chapter) => self.go_to(chapter, 0),
            None => self.focuses_search = true,
        }
        if self.links.is_empty() {
            let sections: Vec<_> = Chapter::ALL.iter().flat_map(|chapter| chapter.sections()).collect();
            self.links = sections.iter().flat_map(Section::links).map(str::to_owned).collect();
            for link in &self.links {
                self.cache.add_link_hook(link);
            }
        }
    }

    /// Whether the manual window is open.
    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Closes the manual window.
    pub(crate) fn close(&mut self) {
        self.is_open = false;
    }

    fn go_to(&mut self, chapter: Chapter, section: usize) {
        self.chapter = chapter;
        self.scroll_to = Some(section);
    }

    /// Draws the manual window if it is open. A link that leads outside the manual becomes a command.
    pub(crate) fn ui(&mut self, ui: &Ui, commands: &mut Vec<Command>) {
        let mut is_open = self.is_open;
        let room = (ui.ctx().content_rect().size() - vec2(40.0, 80.0)).max(vec2(1.0, 1.0));
        egui::Window::new("Manual")
            .open(&mut is_open)
            .default_size(vec2(DEFAULT_SIZE_POINTS[0], DEFAULT_SIZE_POINTS[1]).min(room))
            .max_size(room)
            .collapsible(false)
            .show(ui.ctx(), |ui| {
                ui.horizontal_top(|ui| {
                    ui.vertical(|ui| {
                        ui.set_width(LIST_POINTS);
                        self.list(ui);
                    });
                    ui.separator();
                    ui.vertical(|ui| self.page(ui, commands));
                });
            });
        self.is_open = is_open;
    }

    /// Draws the search field, and below it the results or all chapters.
    fn list(&mut self, ui: &mut Ui) {
        let field =
            ui.add(TextEdit::singleline(&mut self.query).hint_text("Search the manual").desired_width(LIST_POINTS));
        field.widget_info(|| WidgetInfo::labeled(egui::Role::TextInput, true, "Search the manual"));
        if std::mem::take(&mut self.focuses_search) {
            field.request_focus();
        }
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        ui.add_space(space::S);
        ScrollArea::vertical().id_salt("chapters").auto_shrink(false).show(ui, |ui| {
            if self.query.trim().is_empty() {
                for chapter in Chapter::ALL.iter().copied() {
                    if ui.selectable_label(self.chapter == chapter, chapter.title()).clicked() {
                        self.go_to(chapter, 0);
                    }
                }
                return;
            }
            let passages = find(&self.query);
            if passages.is_empty() {
                ui.label(RichText::new("No section contains these words.").color(tokens(ui).text_weak));
            }
            if let Some(first) = passages.first().filter(|_| entered) {
                self.go_to(first.chapter, first.section);
            }
            for passage in passages.iter().take(MAX_RESULTS) {
                if result(ui, passage) {
                    self.go_to(passage.chapter, passage.section);
                }
            }
        });
    }

    /// Draws the open chapter, and follows the link that was clicked.
    fn page(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let scroll_to = self.scroll_to.take();
        let mut clicked = None;
        ScrollArea::vertical().id_salt(("page", self.chapter)).auto_shrink(false).show(ui, |ui| {
            for (index, section) in self.chapter.sections().into_iter().enumerate() {
                let top = ui.cursor().min;
                let link = ui.push_id(index, |ui| content(ui, &mut self.cache, &section, &self.links)).inner;
                clicked = clicked.take().or(link);
                if scroll_to == Some(index) {
                    let heading = egui::Rect::from_min_size(top, vec2(1.0, 1.0));
                    ui.scroll_to_rect(heading, Some(egui::Align::Min));
                }
            }
        });
        if let Some(link) = clicked {
            self.follow(&link, commands);
        }
    }

    /// Goes to the target of a link in the open chapter.
    fn follow(&mut self, link: &str, commands: &mut Vec<Command>) {
        match self.chapter.linked_section(link) {
            Some((chapter, section)) => self.go_to(chapter, section),
            None => commands.push(Command::File(FileCommand::OpenAddress(web_address(link)))),
        }
    }
}

/// Draws a section of a chapter. If one of `links` was clicked, returns that link.
fn content(ui: &mut Ui, cache: &mut CommonMarkCache, section: &Section, links: &BTreeSet<String>) -> Option<String> {
    let mut clicked = None;
    for (index, part) in section.parts().into_iter().enumerate() {
        ui.push_id(index, |ui| match part {
            SectionPart::Text(text) => {
                CommonMarkViewer::new().show(ui, cache, &text);
                // The hooks must be read now, because drawing the next text resets all of them.
                let link = links.iter().find(|link| cache.get_link_hook(link) == Some(true)).cloned();
                clicked = clicked.take().or(link);
            }
            SectionPart::Code(code) => code_block(ui, &code),
            SectionPart::Table(rows) => clicked = clicked.take().or(table::ui(ui, &rows)),
        });
    }
    clicked
}

/// Draws a block of code with a button that copies it.
fn code_block(ui: &mut Ui, code: &str) {
    theme::card_frame(ui).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            let room = (ui.available_width() - CONTROL_HEIGHT - space::S).max(0.0);
            ui.scope(|ui| {
                ui.set_width(room);
                ui.add(Label::new(RichText::new(code).monospace()).wrap());
            });
            copy_button(ui, "code", || code.to_owned());
        });
    });
    ui.add_space(space::S);
}

/// Draws a search result: heading, chapter and the matching line. Returns whether it was clicked.
fn result(ui: &mut Ui, passage: &Passage) -> bool {
    let weak = tokens(ui).text_weak;
    let response = ui
        .scope(|ui| {
            ui.add(Label::new(RichText::new(passage.heading).strong()).truncate().selectable(false));
            ui.add(Label::new(RichText::new(passage.chapter.title()).small().color(weak)).truncate().selectable(false));
            ui.add(Label::new(RichText::new(&passage.line).small()).truncate().selectable(false));
            ui.add_space(space::S);
        })
        .response
        .interact(Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, passage.heading));
    response.on_hover_cursor(egui::CursorIcon::PointingHand).clicked()
}

/// Adds the “?” button of a panel, which opens its chapter of the manual.
pub(crate) fn manual_button(ui: &mut Ui, chapter: Chapter, commands: &mut Vec<Command>) {
    if icon_button(ui, Icon::CircleQuestionMark, &format!("Manual: {}", chapter.title())).clicked() {
        commands.push(Command::Dialog(DialogCommand::Manual(Some(chapter))));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::headless::Headless;

    #[test]
    fn a_link_out_of_the_manual_opens_its_web_address() {
        let mut manual = ManualWindow::default();
        manual.open(Some(Chapter::GettingStarted));
        let mut commands = Vec::new();
        let mut headless = Headless::new(vec2(1280.0, 800.0), 1.0, egui::Theme::Dark);
        let mut page = |manual: &mut ManualWindow, commands: &mut Vec<Command>, events| {
            headless.pass(events, |ui| manual.ui(ui, commands));
        };
        for _ in 0..3 {
            page(&mut manual, &mut commands, Vec::new());
        }
        assert!(commands.is_empty());
        manual.follow("../../README.md", &mut commands);
        manual.follow("03-stages.md", &mut commands);
        assert_eq!(manual.chapter, Chapter::Stages);
        let [Command::File(FileCommand::OpenAddress(address))] = &commands[..] else { panic!("{commands:?}") };
        assert!(address.starts_with("https://") && address.ends_with("/README.md"), "{address}");
    }

    #[test]
    fn tables_do_not_widen_the_window() {
        for chapter in [Chapter::Settings, Chapter::Commands, Chapter::Reference] {
            let mut manual = ManualWindow::default();
            manual.open(Some(chapter));
            let mut headless = Headless::new(vec2(1280.0, 800.0), 1.0, egui::Theme::Dark);
            for _ in 0..4 {
                headless.pass(Vec::new(), |ui| manual.ui(ui, &mut Vec::new()));
            }
            let picture = headless.picture();
            let background = picture.at(1270, 780);
            let (width, height) = picture.size();
            let widened = DEFAULT_SIZE_POINTS[0] as u32 + 60;
            let is_empty = |x: u32| (0..height).all(|y| picture.at(x, y) == background);
            assert!((widened..width).all(is_empty), "{}", chapter.file());
        }
    }
}
