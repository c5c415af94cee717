//! Bar above the canvas that states the effect of changed settings. Also draws the label of the visible picture, A or
//! B.

use eframe::egui::{self, Align2, Button, FontId, Label, Rect, RichText, Ui, vec2};

use crate::inspect::fields::{FieldChange, changes};
use crate::manual::Chapter;
use crate::measure::noise;
use crate::measure::pair::PairTimes;
use crate::ui::engine::replay::ReplayProgress;
use crate::ui::format;
use crate::ui::manual::manual_button;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::what_if::drawer::WhatIfResults;
use crate::ui::session::what_if::{Show, WhatIfChange};
use crate::ui::session::window_task::DialogCommand;
use crate::ui::theme::{self, Icon, font_size, space, tokens};

/// Maximum number of changed settings listed in the bar; the tooltip lists all of them.
const NAMED: usize = 2;

/// Draws the what-if bar.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut chosen = Vec::new();
    let Some(before) = session.features.what_if.before else {
        ui.horizontal(|ui| {
            ui.label(RichText::new("What changed?").strong());
            let words =
                "Change any setting: the frame before the change is kept as A and compared with the current frame B.";
            ui.add(Label::new(RichText::new(words).color(tokens(ui).text_weak)).truncate());
            palette_button(ui, commands);
            manual_button(ui, Chapter::ComparingUpscalers, commands);
            close(ui, &mut chosen);
        });
        commands.extend(chosen.into_iter().map(Command::WhatIf));
        return;
    };
    let fields = changes(&before, &session.state.recipe);
    keep_height(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            fields_in_words(ui, &fields);
            ui.separator();
            palette_button(ui, commands);
            buttons(ui, session, !fields.is_empty(), &mut chosen);
            manual_button(ui, Chapter::ComparingUpscalers, commands);
            close(ui, &mut chosen);
        });
        ui.horizontal_wrapped(|ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            for (show, name, help) in Show::ALL {
                if ui.selectable_label(session.features.what_if.show == show, name).on_hover_text(help).clicked() {
                    chosen.push(WhatIfChange::Show(show));
                }
            }
            ui.separator();
            figures(ui, session, &mut chosen);
        });
        verdicts(ui, session);
    });
    commands.extend(chosen.into_iter().map(Command::WhatIf));
}

/// Prevents the bar from shrinking while its width stays the same. The bar grows when results arrive. If it shrank
/// again, the canvas would grow, and all results would be recomputed for the new size, in an endless loop.
fn keep_height(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let (id, width) = (egui::Id::unique("height of the bar of changes"), ui.available_width());
    let before: Option<(f32, f32)> = ui.data(|data| data.get_temp(id));
    let height = ui.vertical(|ui| {
        ui.set_min_height(before.filter(|(of, _)| *of == width).map_or(0.0, |(_, height)| height));
        content(ui);
    });
    ui.data_mut(|data| data.insert_temp(id, (width, height.response.rect.height())));
}

/// Draws the list of settings that differ between A and B.
fn fields_in_words(ui: &mut Ui, fields: &[FieldChange]) {
    if fields.is_empty() {
        ui.label(RichText::new("A and B have the same settings").color(tokens(ui).text_weak));
        return;
    }
    let words: Vec<_> = fields.iter().map(FieldChange::words).collect();
    let mut text = words[..words.len().min(NAMED)].join(",  ");
    if words.len() > NAMED {
        text += &format!("  and {} more", words.len() - NAMED);
    }
    ui.label(RichText::new(text).strong()).on_hover_text(words.join("\n"));
}

fn palette_button(ui: &mut Ui, commands: &mut Vec<Command>) {
    let help = "Change any setting by name: type “key=value”, or choose one from the list";
    if ui.add(Button::new((theme::icon(Icon::Search), "Change setting…"))).on_hover_text(help).clicked() {
        commands.push(Command::Dialog(DialogCommand::Palette));
    }
}

fn buttons(ui: &mut Ui, session: &Session, differs: bool, chosen: &mut Vec<WhatIfChange>) {
    let pinned = session.features.what_if.pinned;
    let help = "Keep A while you change several settings. Otherwise, every change makes the frame before it the new A";
    if ui.add(Button::new((theme::icon(Icon::Pin), "Pin A")).selected(pinned)).on_hover_text(help).clicked() {
        chosen.push(WhatIfChange::Pin(!pinned));
    }
    let mut button = |ui: &mut Ui, icon: Icon, name: &str, help: &str, change: WhatIfChange| {
        if ui.add_enabled(differs, Button::new((theme::icon(icon), name))).on_hover_text(help).clicked() {
            chosen.push(change);
        }
    };
    button(ui, Icon::Undo2, "Revert", "Restore the settings of frame A", WhatIfChange::Revert);
    button(ui, Icon::ArrowLeftRight, "Swap", "Swap the settings of A and B", WhatIfChange::Swap);
}

fn close(ui: &mut Ui, chosen: &mut Vec<WhatIfChange>) {
    if ui
        .add(Button::new(theme::icon(Icon::X)).frame_when_inactive(false))
        .on_hover_text("Close the bar  (X)")
        .clicked()
    {
        chosen.push(WhatIfChange::Toggle);
    }
}

/// Draws the number of changed pixels, the error and the time difference as soon as they are known.
fn figures(ui: &mut Ui, session: &Session, chosen: &mut Vec<WhatIfChange>) {
    let Some(found) = session.view.as_ref().and_then(|view| session.features.what_if.current(view)) else {
        waiting(ui, session);
        return;
    };
    let count = found.changes.count;
    let text = match count {
        0 => "No pixel changed".to_owned(),
        1 => format!("1 pixel changed ({})", share(found.changes.share())),
        _ => format!("{} pixels changed ({})", format::count(count), share(found.changes.share())),
    };
    let help = "Pixels whose value differs between A and B in the picture or buffer on the canvas";
    ui.label(RichText::new(text).strong()).on_hover_text(help);
    for (icon, step, name) in
        [(Icon::ChevronLeft, -1, "Previous changed pixel"), (Icon::ChevronRight, 1, "Next changed pixel")]
    {
        let button = Button::new(theme::icon(icon)).min_size(egui::Vec2::splat(theme::CONTROL_HEIGHT));
        if ui.add_enabled(count > 0, button).on_hover_text(name).clicked() {
            chosen.push(WhatIfChange::Step(step));
        }
    }
    ui.separator();
    if let Some(ReplayProgress { done, of }) = found.replay {
        incomplete(ui, &format!("History incomplete, drawing frame {done} of {of} …"));
        ui.separator();
    }
    error(ui, found);
    ui.separator();
    match &found.times {
        Some(times) => time(ui, times, found.request.after.sequence.is_some()),
        None => {
            ui.label(RichText::new("time: …").monospace().color(tokens(ui).text_weak));
        }
    }
}

/// Says why there are no results.
fn waiting(ui: &mut Ui, session: &Session) {
    if session.view.as_ref().is_some_and(|view| view.needs_replay) {
        incomplete(ui, "History incomplete, not compared");
        return;
    }
    ui.spinner();
    ui.label(RichText::new("Drawing A and B…").color(tokens(ui).text_weak));
}

/// Says that the history of A or B is incomplete.
fn incomplete(ui: &mut Ui, words: &str) {
    let help = "A or B lacks earlier frames in its history until they are drawn";
    ui.label(RichText::new(words).color(tokens(ui).text_weak)).on_hover_text(help);
}

/// Formats a fraction as a percentage, with more decimals if it is small, so that a single pixel does not round to
/// zero.
fn share(share: f64) -> String {
    /// Fraction below which a percentage with one decimal is too coarse.
    const SMALL: f64 = 0.01;
    if share > 0.0 && share < SMALL {
        format!("{}\u{2009}%", format::fixed(share * 100.0, 4))
    } else {
        format::percent(share)
    }
}

fn error(ui: &mut Ui, found: &WhatIfResults) {
    let text = match found.error {
        None => "error: …".to_owned(),
        Some(error) if error.differing_pixels == 0 => "pictures identical".to_owned(),
        Some(error) => format!("PSNR {} dB, max {}", format::fixed(error.psnr_db, 1), error.max_abs),
    };
    let numbers = found.error.map(|error| {
        let (mse, ssim) = (format::fixed(error.mse, 4), format::fixed(error.ssim, 6));
        format!("MSE {mse}, SSIM {ssim}, {} pixels of the picture differ. ", format::count(error.differing_pixels))
    });
    let help = numbers.unwrap_or_default()
        + "Error between the finished pictures of A and B, whatever the canvas shows: peak signal-to-noise ratio, and \
           largest difference of an sRGB code";
    ui.label(RichText::new(text).monospace()).on_hover_text(help);
}

/// Draws the difference in frame time. `moves` is whether scene or camera move, in which case the label says that the times
/// are those of a still view.
fn time(ui: &mut Ui, times: &PairTimes, moves: bool) {
    let change = times.change_ms.median;
    let sign = if change > 0.0 { "+" } else { "" };
    let name = if moves { "Δ time of the still view" } else { "Δ time" };
    let text = format!("{name} {sign}{}", format::ms(change));
    let color = if times.within_noise { tokens(ui).text_weak } else { tokens(ui).text_strong };
    let help = format!(
        "Medians of {} interleaved frames of the still view: A {}, B {}. Noise floor with equal settings: {}, so the \
         change is {}.",
        times.a_ms.n,
        format::ms(times.a_ms.median),
        format::ms(times.b_ms.median),
        times.noise.words(),
        noise::label(times.within_noise),
    );
    ui.label(RichText::new(text).monospace().color(color)).on_hover_text(&help);
    let floor =
        if times.within_noise { noise::WITHIN.to_owned() } else { format!("± {}", format::ms(times.noise_ms())) };
    ui.label(RichText::new(floor).monospace().small().color(tokens(ui).text_weak)).on_hover_text(help);
}

/// Draws the explanations of the picked pixel's colour in A and in B, or a note that the pixel did not change.
fn verdicts(ui: &mut Ui, session: &Session) {
    let Some(view) = &session.view else { return };
    let Some(found) = session.features.what_if.current(view) else { return };
    let (Some(before), Some(after)) = (&found.before.report, &view.report) else { return };
    if (before.x, before.y) != (after.x, after.y) {
        return;
    }
    let changed = found.changes.mask.get(after.x, after.y) == Some(true);
    let place = format!("Pixel {}, {}", after.x, after.y);
    ui.horizontal(|ui| {
        if !changed {
            let text = format!("{place} did not change.");
            ui.label(RichText::new(text).small().color(tokens(ui).text_weak));
            return;
        }
        ui.label(RichText::new("A").small().strong().color(tokens(ui).a));
        ui.add(Label::new(RichText::new(&before.verdict).small()).truncate());
    });
    if changed {
        ui.horizontal(|ui| {
            ui.label(RichText::new("B").small().strong().color(tokens(ui).b));
            ui.add(Label::new(RichText::new(&after.verdict).small()).truncate());
        });
    }
}

/// Draws a label in the upper left corner of the canvas that says which picture is visible, A or B.
pub(crate) fn label(ui: &Ui, canvas: Rect, session: &Session) {
    let what_if = &session.features.what_if;
    if session.view.as_ref().is_none_or(|view| what_if.current(view).is_none()) {
        return;
    }
    let held = ui.input(|input| input.modifiers.shift);
    let (text, color) = match what_if.show {
        _ if held => ("A, before the change", tokens(ui).a),
        Show::Before => ("A, before the change", tokens(ui).a),
        Show::After => ("B, current frame", tokens(ui).b),
        Show::Changed => ("B, unchanged pixels grey", tokens(ui).b),
        Show::Marked => ("Changed pixels over B", tokens(ui).b),
    };
    let painter = ui.painter().with_clip_rect(canvas);
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(font_size::TITLE), color);
    let corner = canvas.left_top() + vec2(space::S, space::S);
    let frame = Rect::from_min_size(corner, galley.size() + vec2(2.0 * space::S, space::XS * 2.0));
    painter.rect_filled(frame, theme::RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    let place = Align2::CENTER_CENTER.anchor_size(frame.center(), galley.size());
    painter.galley(place.min, galley, color);
}
