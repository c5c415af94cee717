//! The start card: starting points for a new user, over the canvas.

use eframe::egui::{Align, Align2, Area, Button, Frame, Id, Layout, Order, Rect, RichText, ScrollArea, Ui, vec2};

use crate::inspect::lesson;
use crate::pipeline::settings::Choice as _;
use crate::scene::builtin;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::onboarding::OnboardingChange;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::session::workspace::{Workspace, WorkspaceChange};
use crate::ui::theme::{self, Icon, space, tokens};
use crate::ui::thumbnails::{self, Thumbnails};
use crate::ui::widgets::icon_button;

/// Width of the content of the card, in points.
const WIDTH: f32 = 372.0;

/// Minimum width of the content, in points. On a narrow canvas, the card has no thumbnails.
const MIN_WIDTH: f32 = 208.0;

/// Maximum fraction of the canvas's width that the content takes up, so that the picture stays visible beside it.
const MAX_SHARE: f32 = 0.56;

/// Maximum number of recent files on the card.
const RECENT: usize = 4;

/// Opacity of the card, in [0, 1].
const OPACITY: f32 = 0.96;

/// Draws the card over the left part of the canvas, if it is open.
pub(crate) fn ui(ui: &Ui, canvas: Rect, session: &Session, thumbnails: &mut Thumbnails, commands: &mut Vec<Command>) {
    if !session.features.onboarding.card_open {
        return;
    }
    let room = canvas.shrink(space::L);
    let chosen = Area::new(Id::unique("start card"))
        .order(Order::Middle)
        .pivot(Align2::LEFT_CENTER)
        .fixed_pos(room.left_center())
        .constrain_to(canvas)
        .fade_in(false)
        .show(ui.ctx(), |ui| {
            let frame = Frame::popup(ui.style()).inner_margin(space::M).fill(tokens(ui).panel.gamma_multiply(OPACITY));
            let content = |ui: &mut Ui| {
                ui.set_width((room.width() * MAX_SHARE).clamp(MIN_WIDTH, WIDTH));
                ScrollArea::vertical()
                    .max_height(room.height() - 2.0 * space::M)
                    .show(ui, |ui| content(ui, session, thumbnails))
                    .inner
            };
            frame.show(ui, content).inner
        });
    if let Some(choice) = chosen.inner {
        commands.push(Command::Onboarding(OnboardingChange::CloseCard));
        commands.extend(choice);
    }
}

/// Draws the content of the card. Returns the command of the user's choice if the card is to be closed; the inner
/// `None` only closes it.
fn content(ui: &mut Ui, session: &Session, thumbnails: &mut Thumbnails) -> Option<Option<Command>> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        ui.heading("Start");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, Icon::X, "Close the start card").clicked() {
                chosen = Some(None);
            }
        });
    });
    let show = |workspace| Command::Workspace(WorkspaceChange::Show(workspace));
    let starts = [
        (Icon::FolderOpen, "Open a model…", "Open a model or a case", Command::Dialog(DialogCommand::Open)),
        (Icon::Columns2, "Compare upscalers", Workspace::Compare.help(), show(Workspace::Compare)),
        (Icon::Grid3x3, "2D lab", Workspace::Lab.help(), show(Workspace::Lab)),
    ];
    ui.horizontal_wrapped(|ui| {
        for (icon, name, help, command) in starts {
            if ui.button((theme::icon(icon), name)).on_hover_text(help).clicked() {
                chosen = Some(Some(command));
            }
        }
    });
    section(ui, "Why is a pixel black?");
    let has_thumbnails = ui.available_width() > MIN_WIDTH + thumbnails::SMALL.x;
    for lesson in lesson::ALL {
        let scene = builtin::ALL.iter().position(|scene| scene.id == lesson.scene);
        let help = "Opens a small scene and picks its black spot: the panel “Pixel” names the cause";
        ui.horizontal(|ui| {
            if let Some(scene) = scene.filter(|_| has_thumbnails) {
                thumbnails.show(ui, scene, thumbnails::SMALL);
            }
            let button =
                Button::new(lesson.question).frame_when_inactive(false).min_size(vec2(0.0, thumbnails::SMALL.y));
            if ui.add(button).on_hover_text(help).clicked() {
                chosen = Some(Some(Command::File(FileCommand::OpenLesson(lesson))));
            }
        });
    }
    if !session.features.files.recent.is_empty() {
        section(ui, "Recent files");
        for path in session.features.files.recent.iter().take(RECENT) {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            let button = Button::new(name).frame_when_inactive(false).truncate();
            if ui.add(button).on_hover_text(path.display().to_string()).clicked() {
                chosen = Some(Some(Command::File(FileCommand::Open(path.clone()))));
            }
        }
    }
    ui.add_space(space::S);
    ui.label(RichText::new("Help ▸ Start card shows this card again.").small().color(tokens(ui).text_weak));
    chosen
}

fn section(ui: &mut Ui, title: &str) {
    ui.add_space(space::S);
    ui.label(RichText::new(title).strong().color(tokens(ui).text_strong));
}
