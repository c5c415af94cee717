//! The history of the picked pixel as a list: its clear value, every fragment in drawing order with its effect,
//! triangles that have no fragment at the pixel, with the reason, and the final value. Chips filter the list.

use eframe::egui::{self, Align, Button, Color32, Label, Layout, RichText, Sense, Ui, UiBuilder};

use super::{codes, to_color};
use crate::inspect::pixel::{Absent, Kind, SampleState};
use crate::inspect::{FragmentOutcome, FragmentRecord, PixelReport, TriangleSelection};
use crate::pipeline::settings::Choice as _;
use crate::scene::TriangleId;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{Status, chip, icon_button, section_header, swatch};

/// Maximum number of fragments listed at the beginning and at the end of the history. A pixel may have ten thousand
/// fragments.
const LISTED_AT_AN_END: usize = 50;

/// Maximum number of listed triangles that have no fragment at the pixel. The most relevant ones come first.
const LISTED_ABSENT: usize = 60;

/// Width of the colours before and after a fragment, in points, including the space around them.
const CHANGE_WIDTH: f32 = 72.0;

/// Selected entry and filters of the history.
pub(super) struct HistoryView {
    /// Entry whose details are shown below the list; `None` means the visible fragment.
    pub(super) chosen: Option<Chosen>,
    /// Whether entries of each kind are listed, in the order of [`Kind::ALL`].
    listed: [bool; Kind::ALL.len()],
}

/// Selected entry of the history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chosen {
    /// Fragment, by its index in the report.
    Fragment(usize),
    /// Triangle without a fragment at the pixel, by its index in the report.
    Absent(usize),
}

impl Default for HistoryView {
    /// Returns a view that lists all kinds of entries except triangles that narrowly miss the pixel, which are
    /// numerous.
    fn default() -> Self {
        Self { chosen: None, listed: [0, 1, 2, 3, 4].map(|place| Kind::ALL[place] != Kind::Missed) }
    }
}

impl HistoryView {
    /// Draws the history of the picked pixel.
    pub(super) fn ui(&mut self, ui: &mut Ui, session: &Session, report: &PixelReport, commands: &mut Vec<Command>) {
        section_header(ui, "History", |ui| {
            if session.features.scrub.triangle_limit.is_some() {
                let help = "Draw all triangles again  (End)";
                if icon_button(ui, Icon::ListRestart, help).clicked() {
                    commands.push(Command::LimitTriangles(None));
                }
            }
        });
        self.filters(ui, report);
        state_row(ui, "clear", "Colour and depth at the pixel's centre before the first triangle", report.clear);
        self.fragments(ui, session, report, commands);
        self.absent(ui, session, report, commands);
        state_row(ui, "final", "Colour and depth at the pixel's centre after the last triangle", report.last());
    }

    fn filters(&mut self, ui: &mut Ui, report: &PixelReport) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::Vec2::splat(2.0);
            ui.spacing_mut().button_padding.x = theme::space::XS;
            let words = words_fit(ui, report);
            for (kind, listed) in Kind::ALL.iter().zip(&mut self.listed) {
                let count = kind.count(report);
                let text = RichText::new(chip_text(*kind, count, words)).small();
                let is_on = *listed && count > 0;
                let response = ui.add_enabled(count > 0, Button::selectable(is_on, (theme::icon(icon(*kind)), text)));
                let name = format!("{} {count}", kind.name());
                response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, count > 0, is_on, &name));
                let listing = if *listed { "listed" } else { "not listed" };
                let help = format!("{}: {} Currently {listing}.", kind.name(), kind.help());
                let none = format!("{}: none at this pixel. {}", kind.name(), kind.help());
                if response.on_hover_text(help).on_disabled_hover_text(none).clicked() {
                    *listed ^= true;
                }
            }
        });
        ui.add_space(theme::space::XS);
    }

    fn lists(&self, kind: Kind) -> bool {
        Kind::ALL.iter().zip(self.listed).any(|(other, listed)| *other == kind && listed)
    }

    fn fragments(&mut self, ui: &mut Ui, session: &Session, report: &PixelReport, commands: &mut Vec<Command>) {
        let count = report.fragments.len();
        for (index, fragment) in report.fragments.iter().enumerate() {
            if count > 2 * LISTED_AT_AN_END && (LISTED_AT_AN_END..count - LISTED_AT_AN_END).contains(&index) {
                if index == LISTED_AT_AN_END {
                    let omitted = count - 2 * LISTED_AT_AN_END;
                    ui.weak(format!(
                        "… {} more; copy this pixel as JSON to see them all …",
                        format::count(omitted as u64)
                    ));
                }
                continue;
            }
            if !self.lists(Kind::of(fragment)) {
                continue;
            }
            let this = Chosen::Fragment(index);
            let chosen = self.chosen.map_or(fragment.outcome == FragmentOutcome::Visible, |chosen| chosen == this);
            if row(ui, chosen, &HistoryRow::of_fragment(fragment, session), commands) {
                self.chosen = Some(this);
            }
        }
    }

    fn absent(&mut self, ui: &mut Ui, session: &Session, report: &PixelReport, commands: &mut Vec<Command>) {
        let all = report.absent.iter().enumerate();
        let listed: Vec<_> = all.filter(|(_, absent)| self.lists(absent.cause.kind())).collect();
        for (index, absent) in listed.iter().take(LISTED_ABSENT) {
            let this = Chosen::Absent(*index);
            if row(ui, self.chosen == Some(this), &HistoryRow::of_absent(absent, session), commands) {
                self.chosen = Some(this);
            }
        }
        if let Some(more) = listed.len().checked_sub(LISTED_ABSENT).filter(|more| *more > 0) {
            ui.weak(format!("… {} more; copy this pixel as JSON to see them all …", format::count(more as u64)));
        }
    }
}

/// Returns the text of a filter chip: the count, preceded by the name if `words` is `true` and the count is not 0.
fn chip_text(kind: Kind, count: usize, words: bool) -> String {
    let number = format::count(count as u64);
    if words && count > 0 { format!("{} {number}", kind.name()) } else { number }
}

/// Whether all filter chips, including their names, fit in one row. Otherwise, only their tooltips show the names.
fn words_fit(ui: &Ui, report: &PixelReport) -> bool {
    let font = egui::FontId::proportional(theme::font_size::SMALL);
    let spacing = ui.spacing();
    let width = |kind: &Kind| {
        let text = chip_text(*kind, kind.count(report), true);
        let text = ui.painter().layout_no_wrap(text, font.clone(), Color32::WHITE).size().x;
        theme::ICON_SIZE + spacing.icon_spacing + text + 2.0 * spacing.button_padding.x + spacing.item_spacing.x
    };
    Kind::ALL.iter().map(width).sum::<f32>() <= ui.available_width()
}

fn icon(kind: Kind) -> Icon {
    match kind {
        Kind::Passed => Icon::CircleCheck,
        Kind::Failed => Icon::CircleX,
        Kind::Culled => Icon::EyeOff,
        Kind::Clipped => Icon::Scissors,
        Kind::Missed => Icon::CircleDashed,
    }
}

/// Draws the colour and depth of the sample before the first or after the last entry of the history.
fn state_row(ui: &mut Ui, word: &str, help: &str, state: SampleState) {
    // In a narrow panel, the depth moves to a second line.
    ui.horizontal_wrapped(|ui| {
        chip(ui, Status::Neutral, word, help);
        swatch(ui, to_color(state.color));
        let depth = state.depth.map(|depth| format!("z {}", format::f32_full(depth.value)));
        for number in std::iter::once(codes(state.color)).chain(depth) {
            let text = RichText::new(number).small().monospace().color(tokens(ui).text);
            ui.add(Label::new(text).extend());
        }
    });
}

/// Row of the history, for a fragment or for a triangle without a fragment.
struct HistoryRow<'a> {
    status: Status,
    word: &'a str,
    /// Triangle number and object name.
    title: String,
    reason: &'a str,
    /// Colour and depth of the sample before and after the fragment; `None` if nothing was written.
    change: Option<[SampleState; 2]>,
    /// Index of the triangle among all rasterized triangles; `None` if it was not rasterized.
    submission: Option<usize>,
    /// Identifier of the triangle that the row describes.
    triangle: TriangleId,
    /// Whether this triangle, and no other, is selected in the picture.
    is_selected: bool,
    /// Whether the row can be clicked to show details.
    can_be_chosen: bool,
    /// Name of the row for screen readers.
    name: String,
}

impl<'a> HistoryRow<'a> {
    fn of_fragment(fragment: &'a FragmentRecord, session: &Session) -> Self {
        let (status, word) = match fragment.outcome {
            FragmentOutcome::Visible => (Status::Passed, "visible"),
            FragmentOutcome::Overwritten => (Status::Neutral, "overwritten"),
            FragmentOutcome::BlendedOver => (Status::Passed, "blended over"),
            FragmentOutcome::DepthRejected => (Status::Rejected, "rejected"),
            FragmentOutcome::AlphaRejected => (Status::Rejected, "alpha test"),
        };
        Self {
            status,
            word,
            title: format!("{} “{}”", fragment.triangle.0, fragment.instance),
            reason: &fragment.reason,
            change: fragment.outcome.is_written().then_some([fragment.before, fragment.after]),
            submission: Some(fragment.submission),
            triangle: fragment.triangle,
            is_selected: is_selected(session, fragment.triangle),
            can_be_chosen: true,
            name: format!("Fragment of triangle {}", fragment.triangle.0),
        }
    }

    fn of_absent(absent: &'a Absent, session: &Session) -> Self {
        Self {
            status: if absent.cause.kind() == Kind::Missed { Status::Neutral } else { Status::Rejected },
            word: absent.cause.name(),
            title: format!("{} “{}”", absent.triangle.0, absent.instance),
            reason: &absent.reason,
            change: None,
            submission: absent.submission,
            triangle: absent.triangle,
            is_selected: is_selected(session, absent.triangle),
            can_be_chosen: absent.corners_px.is_some(),
            name: format!("Triangle {} without a fragment", absent.triangle.0),
        }
    }
}

/// Draws one row of the history. Returns whether it was clicked.
fn row(ui: &mut Ui, chosen: bool, row: &HistoryRow<'_>, commands: &mut Vec<Command>) -> bool {
    let fill = if chosen { tokens(ui).raised } else { Color32::TRANSPARENT };
    let frame = egui::Frame::new().fill(fill).corner_radius(theme::RADIUS).inner_margin(4);
    let sense = if row.can_be_chosen { Sense::click() } else { Sense::hover() };
    // The row registers for clicks before its content, so that clicks on its buttons go to the buttons.
    let builder = UiBuilder::new().sense(sense);
    let response = ui
        .scope_builder(builder, |ui| {
            // With selectable labels, a click on the text would select the text instead of the row.
            ui.style_mut().interaction.selectable_labels = false;
            frame.show(ui, |ui| row_content(ui, row, commands));
        })
        .response;
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, chosen, &row.name));
    let response =
        if row.can_be_chosen { response.on_hover_text("Click to show the values of this entry") } else { response };
    response.clicked()
}

fn row_content(ui: &mut Ui, row: &HistoryRow<'_>, commands: &mut Vec<Command>) {
    ui.set_width(ui.available_width());
    let mut shows_change = row.change.is_none();
    ui.horizontal(|ui| {
        chip(ui, row.status, row.word, "");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            jump_button(ui, row, commands);
            select_button(ui, row, commands);
            let font = egui::TextStyle::Body.resolve(ui.style());
            let title = ui.painter().layout_no_wrap(row.title.clone(), font, Color32::WHITE).size().x;
            if ui.available_width() >= title + CHANGE_WIDTH {
                change(ui, row);
                shows_change = true;
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(&row.title).strong()).truncate());
            });
        });
    });
    let reason = |ui: &mut Ui| {
        ui.add(Label::new(RichText::new(row.reason).small().color(tokens(ui).text)).wrap());
    };
    if shows_change {
        reason(ui);
    } else {
        ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
            change(ui, row);
            ui.with_layout(Layout::left_to_right(Align::Min), reason);
        });
    }
}

/// Draws a button that shows the frame as it was right after this triangle was drawn.
fn jump_button(ui: &mut Ui, row: &HistoryRow<'_>, commands: &mut Vec<Command>) {
    let Some(submission) = row.submission else { return };
    let help = "Show the frame right after this triangle was drawn: moves the triangle slider";
    if icon_button(ui, Icon::SkipForward, help).clicked() {
        commands.push(Command::LimitTriangles(Some(submission + 1)));
    }
}

/// Draws a button that selects the triangle, or clears the selection if it is already selected.
fn select_button(ui: &mut Ui, row: &HistoryRow<'_>, commands: &mut Vec<Command>) {
    let (icon, help) = if row.is_selected {
        (Icon::ScanEye, "Deselect this triangle")
    } else {
        (Icon::Scan, "Select this triangle: dims all others, and marks it in the mesh view  (M)")
    };
    if icon_button(ui, icon, help).clicked() {
        let members = (!row.is_selected).then_some(row.triangle);
        let label = members.map_or(String::new(), |id| format!("triangle {}", id.0));
        commands.push(Command::Select(TriangleSelection::new(label, members)));
    }
}

fn is_selected(session: &Session, triangle: TriangleId) -> bool {
    session.selection.len() == 1 && session.selection.contains(triangle)
}

/// Draws the colours of the pixel before and after the fragment, in a right-to-left layout.
fn change(ui: &mut Ui, row: &HistoryRow<'_>) {
    let Some([before, after]) = row.change else { return };
    swatch(ui, to_color(after.color)).on_hover_text(format!("after: {}", codes(after.color)));
    ui.label(RichText::new("→").color(tokens(ui).text_weak));
    swatch(ui, to_color(before.color)).on_hover_text(format!("before: {}", codes(before.color)));
}
