//! Overlay that highlights the selected triangles: pixels stay unchanged where a selected triangle is visible, are
//! tinted where one is hidden, and are dimmed elsewhere.

use std::sync::Arc;

use eframe::egui::{self, Color32, Painter, Rect, RichText, Ui, UiBuilder, pos2, vec2};

use super::FatesChange;
use crate::image::{Image, Rgba8};
use crate::inspect::fates::{Fates, SelectionVisibility};
use crate::inspect::selection::TriangleSelection;
use crate::ui::canvas::PictureTexture;
use crate::ui::command::Command;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, RADIUS, ROW_HEIGHT, space, tokens};
use crate::ui::widgets::icon_button;
use crate::ui::zoom::Placement;

/// Alpha of the black that is blended over unselected pixels to dim them, in [0, 255].
const DIM_ALPHA: u8 = 165;

/// Opacity of the accent colour over pixels where a selected triangle is hidden, in [0, 1].
const TINT: f32 = 0.55;

/// Overlay image, rebuilt when the selection, the fates or the theme colour changes.
#[derive(Default)]
pub(crate) struct SelectionLayer {
    texture: PictureTexture,
    cached: Option<CachedOverlay>,
}

/// Overlay image and the inputs it was built from.
struct CachedOverlay {
    fates: Arc<Fates>,
    selection: TriangleSelection,
    tint: Color32,
    picture: Arc<Image<Rgba8>>,
}

impl SelectionLayer {
    /// Paints the overlay if any triangle is selected.
    pub(crate) fn paint(&mut self, ui: &Ui, painter: &Painter, placement: Placement, session: &Session) {
        let Some(fates) = session.fates.fates.as_ref().filter(|_| !session.selection.is_empty()) else { return };
        let tint = tokens(ui).accent.gamma_multiply(TINT);
        let fits = |made: &&CachedOverlay| {
            Arc::ptr_eq(&made.fates, fates) && made.selection == session.selection && made.tint == tint
        };
        let picture = self.cached.as_ref().filter(fits).map(|made| made.picture.clone()).unwrap_or_else(|| {
            Arc::new(fates.visibility_of(&session.selection).map(|mark| match mark {
                SelectionVisibility::None => [0, 0, 0, DIM_ALPHA],
                SelectionVisibility::Hidden => tint.to_array(),
                SelectionVisibility::Shown => [0; 4],
            }))
        });
        let texture = self.texture.show(ui, &picture);
        let (fates, selection, size) = (fates.clone(), session.selection.clone(), picture.size());
        self.cached = Some(CachedOverlay { fates, selection, tint, picture });
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture, placement.rect_of_all(size), uv, Color32::WHITE);
    }
}

/// Draws a description of the selection in the upper left corner of the canvas, with a button that clears the
/// selection.
pub(crate) fn badge(ui: &mut Ui, canvas: Rect, session: &Session, commands: &mut Vec<Command>) {
    let selection = &session.selection;
    if selection.is_empty() {
        return;
    }
    let count = selection.len() as u64;
    let noun = if count == 1 { "triangle" } else { "triangles" };
    let text = format!("{} {noun}: {}", format::count(count), selection.label());
    let font = egui::TextStyle::Body.resolve(ui.style());
    let width = ui.painter().layout_no_wrap(text.clone(), font, Color32::WHITE).size().x;
    let most = (canvas.width() - 2.0 * space::S).max(0.0);
    let size = vec2((width + ROW_HEIGHT + 3.0 * space::S).min(most), ROW_HEIGHT + space::XS);
    let card = Rect::from_min_size(canvas.min + vec2(space::S, space::S), size);
    ui.painter().rect_filled(card, RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    let inner = card.shrink2(vec2(space::S, 0.0));
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    let mut row = ui.new_child(UiBuilder::new().max_rect(inner).layout(layout));
    if icon_button(&mut row, Icon::X, "Clear the selection  (Esc)").clicked() {
        commands.push(Command::Fates(FatesChange::Clear));
    }
    let label = egui::Label::new(RichText::new(text).color(tokens(ui).text_strong)).truncate();
    row.add(label).on_hover_text(
        "Pixels that show a selected triangle are unchanged, pixels that hide one are tinted, all others are dimmed",
    );
}
