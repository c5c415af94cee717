//! The menu bar, with statistics of the frame at its right end.

use eframe::egui::{self, Button, Layout, MenuBar, RichText, ScrollArea, Ui};

use crate::chain::Recipe;
use crate::inspect::outline::OutlineKind;
use crate::inspect::{Buffer, lesson};
use crate::pipeline::settings::Choice as _;
use crate::scene::builtin;
use crate::ui::command::{BINDINGS, Command};
use crate::ui::compare::{CompareChange, Mode};
use crate::ui::engine::Shown;
use crate::ui::format;
use crate::ui::key_sheet::key_name;
use crate::ui::place;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, tokens};
use crate::ui::what_if;
use crate::ui::widgets::icon_button;
use crate::ui::workspace::{Workspace, WorkspaceChange};

/// Selectable interface scales, as factors of the default size.
const SCALES: [f32; 6] = [0.75, 1.0, 1.25, 1.5, 1.75, 2.0];

/// Draws the menu bar.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, session, commands));
        ui.menu_button("Edit", |ui| edit(ui, session, commands));
        ui.menu_button("Scene", |ui| scene(ui, commands));
        ui.menu_button("View", |ui| view(ui, session, commands));
        ui.menu_button("Go", |ui| place::menu::ui(ui, session, commands));
        ui.menu_button("Help", |ui| help(ui, commands));
        ui.separator();
        workspaces(ui, session, commands);
        ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| figures(ui, session, commands));
    });
}

/// Draws the switch between the workspaces.
fn workspaces(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let current = session.workspace();
    for (index, workspace) in Workspace::ALL.iter().copied().enumerate() {
        let button = ui.add(Button::selectable(workspace == current, workspace.name()));
        if button.on_hover_text(format!("{}  (Ctrl+{})", workspace.help(), index + 1)).clicked() {
            commands.push(Command::Workspace(WorkspaceChange::Show(workspace)));
        }
    }
}

/// Draws a menu entry for a command, with its key from the key map.
fn entry(ui: &mut Ui, name: &str, command: Command, commands: &mut Vec<Command>) {
    entry_if(ui, true, name, command, commands);
}

fn entry_if(ui: &mut Ui, enabled: bool, name: &str, command: Command, commands: &mut Vec<Command>) {
    let mut button = Button::new(name);
    if let Some(binding) = BINDINGS.iter().find(|b| (b.command)() == command) {
        button = button.shortcut_text(key_name(binding));
    }
    if ui.add_enabled(enabled, button).clicked() {
        commands.push(command);
        ui.close();
    }
}

fn file(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    entry(ui, "Open model…", Command::ShowFileDialog, commands);
    ui.menu_button("Recent files", |ui| {
        if session.recent.is_empty() {
            ui.weak("No recent files");
        }
        for path in &session.recent {
            let name =
                path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned());
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                commands.push(Command::Open(path.clone()));
                ui.close();
            }
        }
    });
    ui.separator();
    entry(ui, "Save picture", Command::SavePicture, commands);
    entry(ui, "Save exact values (PFM)", Command::SaveData, commands);
    ui.menu_button("Save as drawing", |ui| {
        for kind in OutlineKind::ALL {
            for end in ["svg", "pdf"] {
                let name = format!("{}, {}", kind.name(), end.to_uppercase());
                if ui.button(name).on_hover_text(kind.help()).clicked() {
                    commands.push(Command::SaveOutline(*kind, end));
                    ui.close();
                }
            }
        }
    });
    entry(ui, "Copy picture", Command::CopyPicture, commands);
    entry(ui, "Copy view as command", Command::Place(place::PlaceChange::Copy), commands);
    entry(ui, "Save triangle as case file", Command::SaveCase, commands);
    ui.separator();
    if ui.add(Button::new("Quit").shortcut_text("Ctrl+Q")).clicked() {
        ui.send_viewport_cmd(egui::ViewportCommand::Close);
    }
}

fn edit(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    entry_if(ui, session.can_undo(), "Undo", Command::Undo, commands);
    entry_if(ui, session.can_redo(), "Redo", Command::Redo, commands);
    ui.separator();
    entry_if(ui, session.state.recipe != Recipe::default(), "Reset all settings", Command::ResetRecipe, commands);
}

fn scene(ui: &mut Ui, commands: &mut Vec<Command>) {
    ui.menu_button("Why is this pixel black?", |ui| lessons(ui, commands));
    ui.separator();
    for scene in builtin::ALL {
        if ui.button(scene.title).on_hover_text(scene.summary).clicked() {
            commands.push(Command::OpenBuiltin(scene.id.to_owned()));
            ui.close();
        }
    }
}

/// Draws a menu entry for each lesson. The entry opens a scene with a black spot and applies the settings that produce
/// the spot.
fn lessons(ui: &mut Ui, commands: &mut Vec<Command>) {
    for lesson in lesson::ALL {
        if ui
            .button(lesson.question)
            .on_hover_text("Open a small scene. Click its black spot: the inspector names the cause")
            .clicked()
        {
            commands.extend([Command::OpenBuiltin(lesson.scene.to_owned()), Command::SetRecipe(lesson.recipe())]);
            ui.close();
        }
    }
}

fn compare(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    for (mode, name, _) in Mode::ALL {
        entry(ui, name, Command::Compare(CompareChange::Toggle(mode)), commands);
    }
    ui.separator();
    entry(
        ui,
        "Show the effect of the last change of a setting",
        Command::WhatIf(what_if::WhatIfChange::Toggle),
        commands,
    );
    entry(ui, "Compare all upscalers in tiles", Command::Compare(CompareChange::Every(None)), commands);
    let is_on = session.comparison.is_on();
    entry_if(ui, is_on, "Swap pictures A and B", Command::Compare(CompareChange::Swap), commands);
    entry_if(ui, is_on, "Save comparison (HTML)", Command::SaveComparison, commands);
    entry_if(ui, is_on, "Stop comparing", Command::Compare(CompareChange::Mode(Mode::Off)), commands);
}

fn view(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.menu_button("Buffer", |ui| {
        for buffer in Buffer::ALL {
            let shown = session.shown == Shown::Buffer(*buffer);
            if ui.selectable_label(shown, buffer.name()).on_hover_text(buffer.help()).clicked() {
                commands.push(Command::Show(Shown::Buffer(*buffer)));
                ui.close();
            }
        }
    });
    ui.menu_button("Compare pictures", |ui| compare(ui, session, commands));
    entry(ui, "Select previous stage", Command::StepStage(-1), commands);
    entry(ui, "Select next stage", Command::StepStage(1), commands);
    ui.separator();
    entry(ui, "Fit picture", Command::ZoomFit, commands);
    entry(ui, "Actual size", Command::ZoomOne, commands);
    entry(ui, "Go to…", Command::ShowPixelDialog, commands);
    ui.separator();
    entry(ui, "Reset view", Command::ResetCamera, commands);
    entry(ui, "Fit scene", Command::FitCamera, commands);
    ui.separator();
    entry(ui, "Hide or show panels", Command::Workspace(WorkspaceChange::TogglePanels), commands);
    entry(ui, "Reset layout", Command::Workspace(WorkspaceChange::ResetLayout), commands);
    ui.separator();
    entry(ui, "Switch between dark and light theme", Command::ToggleTheme, commands);
    ui.menu_button("Interface scale", |ui| {
        for scale in SCALES {
            let current = (ui.ctx().zoom_factor() - scale).abs() < 0.01;
            if ui.selectable_label(current, format!("{:.0} %", scale * 100.0)).clicked() {
                commands.push(Command::SetScale(scale));
                ui.close();
            }
        }
    });
}

/// Licence texts of the fonts and icons that are embedded in the program.
const NOTICES: &str = include_str!("../../../assets/NOTICES.txt");

/// Width of the licence texts, in points.
const NOTICES_WIDTH: f32 = 620.0;

/// Maximum height of the licence texts, in points.
const NOTICES_HEIGHT: f32 = 420.0;

fn help(ui: &mut Ui, commands: &mut Vec<Command>) {
    entry(ui, "Manual", Command::OpenManual(None), commands);
    entry(ui, "Keys and mouse", Command::ToggleKeys, commands);
    entry(ui, "Find anything…", Command::OpenPalette, commands);
    ui.separator();
    ui.menu_button("Licences of fonts and icons", |ui| {
        ui.set_min_width(NOTICES_WIDTH);
        ScrollArea::vertical().max_height(NOTICES_HEIGHT).show(ui, |ui| ui.monospace(NOTICES));
    });
    ui.weak(concat!("Rasterscope ", env!("CARGO_PKG_VERSION")));
}

/// Draws the number of fragments with NaN or infinite values if there is enough space.
fn bad_numbers(ui: &mut Ui, session: &Session) {
    /// Minimum free width for the number of fragments with NaN or infinite values and the triangle count, in points.
    const ROOM: f32 = 260.0;
    let Some(figures) = session.stages.filter(|_| ui.available_width() >= ROOM) else { return };
    let color = if figures.bad > 0 { tokens(ui).warning } else { tokens(ui).text };
    let text = RichText::new(format!("{} NaN", format::count(figures.bad))).monospace().color(color);
    ui.label(text).on_hover_text(
        "Fragments of this frame with NaN or infinite depth or weights. The overlay “NaN, infinite, negative” marks \
         them  (O)",
    );
    ui.label(RichText::new("·").color(tokens(ui).text_weak));
}

/// Draws statistics of the frame, such as its time and triangle count, and the theme switch.
fn figures(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let theme_icon = if ui.visuals().dark_mode { Icon::Sun } else { Icon::Moon };
    if icon_button(ui, theme_icon, "Switch between dark and light theme").clicked() {
        commands.push(Command::ToggleTheme);
    }
    let Some(view) = session.view.as_ref().filter(|_| !session.lab.open) else { return };
    let drawn = (
        format!("{} drawn", format::percent(view.frame.drawn_share())),
        "Share of the picture's pixels that are rasterized and shaded",
    );
    let mut figures = vec![drawn];
    // With a triangle limit, the picture is drawn twice, and the time would describe neither of the two frames.
    let warm_ms = session.timings.warm_median_ms(view.request.recipe.upscaler).or_else(|| {
        let frame = session.stages.as_ref()?.times.frame;
        Some(frame.as_secs_f64() * 1e3)
    });
    if let Some(ms) = warm_ms.filter(|_| view.request.triangle_limit.is_none()) {
        let fps = "Frames per second if frames were drawn continuously; a frame is drawn only if something changes";
        figures.push((format!("{:.0} fps", 1e3 / ms.max(1e-3)), fps));
        figures.push((format::ms(ms), "Median frame time with warm caches, from planning to the finished picture"));
    }
    /// Minimum free width for a figure, in points.
    const FIGURE_ROOM: f32 = 110.0;
    for (text, help) in figures {
        if ui.available_width() < FIGURE_ROOM {
            return;
        }
        ui.label(RichText::new(text).monospace().color(tokens(ui).text)).on_hover_text(help);
        ui.label(RichText::new("·").color(tokens(ui).text_weak));
    }
    bad_numbers(ui, session);
    if ui.available_width() < FIGURE_ROOM {
        return;
    }
    ui.label(
        RichText::new(format!(
            "{} {}",
            format::count(view.rasterized as u64),
            if view.rasterized == 1 { "triangle" } else { "triangles" }
        ))
        .monospace()
        .color(tokens(ui).text),
    )
    .on_hover_text("Number of rasterized triangles, after clipping and culling");
}
