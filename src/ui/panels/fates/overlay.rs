//! Overlay that highlights the selected triangles: pixels stay unchanged where a selected triangle is visible, are
//! tinted where one is hidden, and are dimmed elsewhere.

use std::sync::Arc;

use eframe::egui::{Color32, Painter, Rect, Ui, pos2};

use crate::image::{Image, Rgba8};
use crate::inspect::fates::{Fates, SelectionVisibility};
use crate::inspect::selection::TriangleSelection;
use crate::ui::picture_texture::PictureTexture;
use crate::ui::session::Session;
use crate::ui::theme::tokens;
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
        let Some(fates) = session.features.fates.fates.as_ref().filter(|_| !session.selection.is_empty()) else {
            return;
        };
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
