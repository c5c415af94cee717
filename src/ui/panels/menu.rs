//! The menu bar, with statistics of the frame at its right end. What does not fit moves into a menu at its end.

use eframe::egui::{self, Button, Color32, Layout, MenuBar, RichText, ScrollArea, Ui};

use super::scene_menu;
use crate::chain::Recipe;
use crate::inspect::Buffer;
use crate::inspect::outline::OutlineKind;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::Shown;
use crate::ui::format;
use crate::ui::key_map::BINDINGS;
use crate::ui::key_sheet::key_name;
use crate::ui::session::appearance::AppearanceChange;
use crate::ui::session::canvas_state::CanvasChange;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::onboarding::OnboardingChange;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::save_item::SaveItem;
use crate::ui::session::stages::StageChange;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::session::workspace::{Workspace, WorkspaceChange};
use crate::ui::session::{Session, place, what_if};
use crate::ui::theme::{CONTROL_HEIGHT, Icon, space, tokens};
use crate::ui::thumbnails::Thumbnails;
use crate::ui::widgets::{icon_button, monospace_width, overflow_menu, text_width};
use crate::upscale;

/// Selectable interface scales, as factors of the default size.
const SCALES: [f32; 6] = [0.75, 1.0, 1.25, 1.5, 1.75, 2.0];

/// Width of the theme switch and of the menu at the end of the bar, with the space beside them, in points.
const END_POINTS: f32 = 2.0 * (CONTROL_HEIGHT + space::S);

/// Draws the menu bar.
pub(crate) fn ui(ui: &mut Ui, session: &Session, thumbnails: &mut Thumbnails, commands: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, session, commands));
        ui.menu_button("Edit", |ui| edit(ui, session, commands));
        ui.menu_button("Scene", |ui| scene_menu::ui(ui, thumbnails, commands));
        ui.menu_button("View", |ui| view(ui, session, commands));
        ui.menu_button("Go", |ui| super::place::menu::ui(ui, session, commands));
        ui.menu_button("Help", |ui| help(ui, commands));
        ui.separator();
        let hidden = workspaces(ui, session, END_POINTS, commands);
        ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| right_end(ui, &hidden, session, commands));
    });
}

/// Draws the buttons of the workspaces that fit beside `reserved` points. Returns the others.
fn workspaces(ui: &mut Ui, session: &Session, reserved: f32, commands: &mut Vec<Command>) -> Vec<Workspace> {
    let mut room = ui.available_width() - reserved;
    let mut fits = |ui: &Ui, workspace: &Workspace| {
        room -= text_width(ui, workspace.name()) + 2.0 * ui.spacing().button_padding.x + ui.spacing().item_spacing.x;
        room >= 0.0
    };
    let count = Workspace::ALL.iter().take_while(|workspace| fits(ui, workspace)).count();
    let (shown, hidden) = Workspace::ALL.split_at(count);
    shown.iter().for_each(|workspace| workspace_button(ui, *workspace, session, commands));
    hidden.to_vec()
}

fn workspace_button(ui: &mut Ui, workspace: Workspace, session: &Session, commands: &mut Vec<Command>) {
    let number = Workspace::ALL.iter().position(|other| *other == workspace).map_or(0, |index| index + 1);
    let button = ui.add(Button::selectable(workspace == session.workspace(), workspace.name()));
    if button.on_hover_text(format!("{}  (Ctrl+{number})", workspace.help())).clicked() {
        commands.push(Command::Workspace(WorkspaceChange::Show(workspace)));
        ui.close();
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
    entry(ui, "Open model…", Command::Dialog(DialogCommand::Open), commands);
    ui.menu_button("Recent files", |ui| {
        if session.features.files.recent.is_empty() {
            ui.weak("No recent files");
        }
        for path in &session.features.files.recent {
            let name =
                path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned());
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                commands.push(Command::File(FileCommand::Open(path.clone())));
                ui.close();
            }
        }
    });
    ui.separator();
    entry(ui, "Save picture", Command::File(FileCommand::SavePicture), commands);
    entry(ui, "Save exact values (PFM)", Command::File(FileCommand::SaveData), commands);
    ui.menu_button("Save as", |ui| {
        for item in SaveItem::LISTED {
            let name = item.name();
            let enabled = item.is_offered(session);
            entry_if(ui, enabled, &format!("Save {name} as…"), Command::File(FileCommand::SaveAs(item)), commands);
        }
    });
    ui.menu_button("Save as drawing", |ui| {
        for kind in OutlineKind::ALL {
            for end in ["svg", "pdf"] {
                let name = format!("{}, {}", kind.name(), end.to_uppercase());
                if ui.button(name).on_hover_text(kind.help()).clicked() {
                    commands.push(Command::File(FileCommand::SaveOutline(*kind, end)));
                    ui.close();
                }
            }
        }
    });
    entry(ui, "Copy picture", Command::File(FileCommand::CopyPicture), commands);
    entry(ui, "Copy view as command", Command::Place(place::PlaceChange::Copy), commands);
    entry(ui, "Save triangle as case file", Command::File(FileCommand::SaveCase), commands);
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
    let has_failed = upscale::all().iter().any(|upscaler| upscaler.failure().is_some());
    entry(ui, "Add upscaler process…", Command::Dialog(DialogCommand::AddUpscaler), commands);
    entry_if(ui, has_failed, "Restart upscaler processes", Command::RestartUpscalers, commands);
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
    let is_on = session.features.comparison.is_on();
    for role in PictureRole::LISTED {
        let title = format!("Open picture as {}…", role.name());
        entry(ui, &title, Command::Dialog(DialogCommand::OpenPicture(role)), commands);
    }
    entry_if(ui, is_on, "Swap pictures A and B", Command::Compare(CompareChange::Swap), commands);
    entry_if(ui, is_on, "Save comparison (HTML)", Command::File(FileCommand::SaveComparison), commands);
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
    entry(ui, "Select previous stage", Command::Stage(StageChange::Step(-1)), commands);
    entry(ui, "Select next stage", Command::Stage(StageChange::Step(1)), commands);
    ui.separator();
    entry(ui, "Fit picture", Command::Canvas(CanvasChange::Fit), commands);
    entry(ui, "Actual size", Command::Canvas(CanvasChange::OneToOne), commands);
    entry(ui, "Go to…", Command::Dialog(DialogCommand::GoTo), commands);
    ui.separator();
    entry(ui, "Reset view", Command::ResetCamera, commands);
    entry(ui, "Fit scene", Command::FitCamera, commands);
    if !session.scene.views.is_empty() {
        ui.menu_button("Cameras of the file", |ui| {
            for view in &session.scene.views {
                entry(ui, &view.name, Command::SetCamera(view.camera), commands);
            }
        });
    }
    ui.separator();
    entry(ui, "Hide or show panels", Command::Workspace(WorkspaceChange::TogglePanels), commands);
    entry(ui, "Reset layout", Command::Workspace(WorkspaceChange::ResetLayout), commands);
    ui.separator();
    entry(ui, "Switch between dark and light theme", Command::Appearance(AppearanceChange::ToggleTheme), commands);
    let mut reduced = session.features.appearance.reduces_motion();
    let help = "Switch off animations, fading, blinking and smooth scrolling";
    if ui.checkbox(&mut reduced, "Reduce motion").on_hover_text(help).changed() {
        commands.push(Command::Appearance(AppearanceChange::ToggleMotion));
    }
    ui.menu_button("Interface scale", |ui| {
        for scale in SCALES {
            let current = (ui.ctx().zoom_factor() - scale).abs() < 0.01;
            if ui.selectable_label(current, format!("{:.0} %", scale * 100.0)).clicked() {
                commands.push(Command::Appearance(AppearanceChange::Scale(scale)));
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
    entry(ui, "Start card", Command::Onboarding(OnboardingChange::OpenCard), commands);
    entry(ui, "Introduction in four steps", Command::Onboarding(OnboardingChange::StartCoach), commands);
    ui.separator();
    entry(ui, "Manual", Command::Dialog(DialogCommand::Manual(None)), commands);
    entry(ui, "Keys and mouse", Command::Dialog(DialogCommand::Keys), commands);
    entry(ui, "Find anything…", Command::Dialog(DialogCommand::Palette), commands);
    ui.separator();
    ui.menu_button("Licences of fonts and icons", |ui| {
        ui.set_min_width(NOTICES_WIDTH);
        ScrollArea::vertical().max_height(NOTICES_HEIGHT).show(ui, |ui| ui.monospace(NOTICES));
    });
    ui.weak(concat!("Rasterscope ", env!("CARGO_PKG_VERSION")));
}

/// Number about the current frame.
struct Figure {
    text: String,
    color: Color32,
    help: &'static str,
}

/// Draws the right end of the bar from right to left: the theme switch, statistics of the frame, and a menu with the
/// `hidden` workspaces and the statistics that do not fit.
fn right_end(ui: &mut Ui, hidden: &[Workspace], session: &Session, commands: &mut Vec<Command>) {
    let theme_icon = if ui.visuals().dark_mode { Icon::Sun } else { Icon::Moon };
    if icon_button(ui, theme_icon, "Switch between dark and light theme").clicked() {
        commands.push(Command::Appearance(AppearanceChange::ToggleTheme));
    }
    let figures = figures(ui, session);
    let spacing = 2.0 * ui.spacing().item_spacing.x + text_width(ui, "·");
    let mut room = ui.available_width() - CONTROL_HEIGHT - space::S;
    let mut fits = |figure: &Figure| {
        room -= monospace_width(ui, &figure.text) + spacing;
        room >= 0.0
    };
    let count = figures.iter().take_while(|figure| fits(figure)).count();
    let (shown, others) = figures.split_at(count);
    if !hidden.is_empty() || !others.is_empty() {
        overflow_menu(ui, "More of the menu bar", |ui| {
            hidden.iter().for_each(|workspace| workspace_button(ui, *workspace, session, commands));
            others.iter().for_each(|figure| show_figure(ui, figure));
        });
    }
    for (index, figure) in shown.iter().enumerate() {
        if index > 0 {
            ui.label(RichText::new("·").color(tokens(ui).text_weak));
        }
        show_figure(ui, figure);
    }
}

fn show_figure(ui: &mut Ui, figure: &Figure) {
    ui.label(RichText::new(&figure.text).monospace().color(figure.color)).on_hover_text(figure.help);
}

/// Returns statistics of the frame, most important first.
fn figures(ui: &Ui, session: &Session) -> Vec<Figure> {
    let Some(view) = session.view.as_ref().filter(|_| !session.features.lab.open) else { return Vec::new() };
    let color = tokens(ui).text;
    let figure = |text, help| Figure { text, color, help };
    let mut figures = vec![figure(
        format!("{} drawn", format::percent(view.frame.drawn_share())),
        "Share of the picture's pixels that are rasterized and shaded",
    )];
    // With a triangle limit, the picture is drawn twice, and the time would describe neither of the two frames.
    let warm_ms = session.features.timings.warm_median_ms(view.request.recipe.upscaler).or_else(|| {
        let frame = session.features.stages.times()?.frame;
        Some(frame.as_secs_f64() * 1e3)
    });
    if let Some(ms) = warm_ms.filter(|_| view.request.triangle_limit.is_none()) {
        let fps = "Frames per second if frames were drawn continuously; a frame is drawn only if something changes";
        figures.push(figure(format!("{:.0} fps", 1e3 / ms.max(1e-3)), fps));
        let help = "Median frame time with warm caches, from planning to the finished picture";
        figures.push(figure(format::ms(ms), help));
    }
    if let Some(stages) = session.features.stages.figures {
        figures.push(Figure {
            text: format!("{} NaN", format::count(stages.bad)),
            color: if stages.bad > 0 { tokens(ui).warning } else { color },
            help: "Fragments of this frame with NaN or infinite depth or weights. The overlay “NaN, infinite, \
                   negative” marks them  (O)",
        });
    }
    let count = format::count(view.rasterized as u64);
    let noun = if view.rasterized == 1 { "triangle" } else { "triangles" };
    figures.push(figure(format!("{count} {noun}"), "Number of rasterized triangles, after clipping and culling"));
    figures
}
