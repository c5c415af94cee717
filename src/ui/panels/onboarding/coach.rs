//! The coach: a small card beside the thing that the current step explains.

use eframe::egui::{Align, Align2, Area, Frame, Id, Layout, Order, Rect, RichText, Stroke, Ui, Vec2, vec2};

use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::onboarding::{CoachStep, Onboarding, OnboardingChange};
use crate::ui::theme::{self, Icon, font_size, space, tokens};

/// Width of the card, in points.
const WIDTH: f32 = 272.0;

impl CoachStep {
    fn title(self) -> &'static str {
        match self {
            Self::Move => "Orbit and zoom",
            Self::Pick => "Explain a pixel",
            Self::Stage => "See a stage",
            Self::Compare => "Compare upscalers",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Move => "Drag in the picture to orbit the camera. Turn the wheel to zoom at the pointer.",
            Self::Pick => "Click a pixel. The panel “Pixel” on the right says why it has its colour.",
            Self::Stage => {
                "Click the eye beside a stage on the right. The picture then shows the frame after that stage. “Colour” \
                 in the list above the picture shows the finished frame again."
            }
            Self::Compare => "Press Ctrl+3 to see the same view drawn with several upscalers, side by side.",
        }
    }

    /// Returns the icon of an arrow that points from the card to the thing that the step explains.
    fn arrow(self) -> Icon {
        match self {
            Self::Move => Icon::Move,
            Self::Pick | Self::Stage => Icon::ArrowRight,
            Self::Compare => Icon::ArrowUp,
        }
    }

    /// Returns the edge or corner of the canvas at which the card is shown.
    fn place(self) -> Align2 {
        match self {
            Self::Move => Align2::CENTER_BOTTOM,
            Self::Pick => Align2::RIGHT_CENTER,
            Self::Stage => Align2::RIGHT_TOP,
            Self::Compare => Align2::CENTER_TOP,
        }
    }
}

/// Draws the card of the current step over the canvas, if the coach is open.
pub(crate) fn ui(ui: &Ui, canvas: Rect, session: &Session, commands: &mut Vec<Command>) {
    let onboarding = &session.features.onboarding;
    let Some(step) = onboarding.step.filter(|_| !onboarding.card_open) else { return };
    let room = canvas.shrink(space::L);
    Area::new(Id::unique(("coach", step.number())))
        .order(Order::Middle)
        .pivot(step.place())
        .fixed_pos(step.place().pos_in_rect(&room))
        .constrain_to(canvas)
        .fade_in(false)
        .show(ui.ctx(), |ui| {
            let frame = Frame::popup(ui.style()).inner_margin(space::S).stroke(Stroke::new(1.0, tokens(ui).accent));
            frame.show(ui, |ui| {
                ui.set_width(WIDTH.min(room.width() - 2.0 * space::M));
                content(ui, step, onboarding, commands);
            });
        });
}

fn content(ui: &mut Ui, step: CoachStep, onboarding: &Onboarding, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let (place, _) = ui.allocate_exact_size(Vec2::splat(theme::ICON_SIZE), eframe::egui::Sense::hover());
        theme::paint_icon(ui.painter(), place.center(), step.arrow(), theme::ICON_SIZE, tokens(ui).accent);
        ui.label(RichText::new(step.title()).strong().color(tokens(ui).text_strong));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let count = format!("{} of {}", step.number(), CoachStep::ALL.len());
            ui.label(RichText::new(count).size(font_size::SMALL).color(tokens(ui).text_weak));
        });
    });
    ui.label(step.text());
    if step == CoachStep::Move {
        let (orbited, zoomed) = onboarding.moved();
        ui.horizontal(|ui| {
            for (done, name) in [(orbited, "orbited"), (zoomed, "zoomed")] {
                let (icon, color) =
                    if done { (Icon::CircleCheck, tokens(ui).passed) } else { (Icon::Circle, tokens(ui).text_weak) };
                let (place, _) =
                    ui.allocate_exact_size(vec2(theme::ICON_SIZE, theme::ICON_SIZE), eframe::egui::Sense::hover());
                theme::paint_icon(ui.painter(), place.center(), icon, theme::ICON_SIZE, color);
                ui.label(RichText::new(name).size(font_size::SMALL).color(color));
            }
        });
    }
    ui.add_space(space::XS);
    ui.horizontal(|ui| {
        let is_last = step.next().is_none();
        if ui.button(if is_last { "Done" } else { "Next" }).clicked() {
            commands.push(Command::Onboarding(OnboardingChange::NextStep));
        }
        if !is_last && ui.button("Skip").on_hover_text("Close the introduction  (Esc)").clicked() {
            commands.push(Command::Onboarding(OnboardingChange::SkipCoach));
        }
    });
}
