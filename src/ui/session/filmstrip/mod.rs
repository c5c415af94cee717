//! Filmstrip below a comparison: a detail of the picture as every upscaling method draws it, with frame time and error.
//! A click shows the method as picture B, Shift + click as picture A.

pub(crate) mod drawer;

use std::collections::BTreeSet;

use super::Session;
use super::compare::compute::{CompareRequest, Compared};
use super::compare::files::ComparedFiles;
use super::tile_set::methods;
use super::timings::RowOrder;
use crate::chain::Recipe;
use crate::measure::region::PixelRegion;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use crate::upscale::{Scale, Upscaling};

/// Settings and results of the filmstrip.
#[derive(Debug)]
pub(crate) struct Filmstrip {
    /// Whether the user wants the filmstrip below comparisons; `None` to show it only in high windows.
    open: Option<bool>,
    /// Whether the last pass showed the filmstrip.
    pub(crate) is_shown: bool,
    /// Scale of all methods, as far as they offer it; `None` for the largest scale of each.
    pub(crate) scale: Option<Scale>,
    /// Order of the frames.
    pub(crate) order: RowOrder,
    /// Pictures drawn so far, with the errors measured so far; `None` before the first one.
    pub(crate) drawn: Option<Compared>,
}

impl Default for Filmstrip {
    fn default() -> Self {
        Self { open: None, is_shown: false, scale: None, order: RowOrder::Method, drawn: None }
    }
}

/// Change to the filmstrip that the user requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FilmstripChange {
    /// Shows the filmstrip if it is hidden, and hides it otherwise.
    Toggle,
    /// Sets the scale of all methods; `None` for the largest scale of each.
    Scale(Option<Scale>),
    /// Sets the order of the frames.
    Order(RowOrder),
}

/// Minimum height of the picture panel for a filmstrip, in points. A lower panel has room for the pictures only.
const MIN_PANEL: f32 = 460.0;

/// Height of the picture panel from which a comparison has a filmstrip by default, in points. Three quarters of the
/// window are then left for the pictures.
const DEFAULT_PANEL: f32 = 940.0;

/// Whether a picture panel, whose height is given in points, has room for a filmstrip.
pub(crate) fn has_room(panel_height: f32) -> bool {
    panel_height >= MIN_PANEL
}

impl Filmstrip {
    /// Whether a comparison in a picture panel has a filmstrip. The height of the panel is given in points.
    pub(crate) fn is_shown_in(&self, panel_height: f32) -> bool {
        has_room(panel_height) && self.open.unwrap_or(panel_height >= DEFAULT_PANEL)
    }

    /// Applies a change to the settings.
    pub(crate) fn apply(&mut self, change: FilmstripChange) {
        match change {
            FilmstripChange::Toggle => self.open = Some(!self.is_shown),
            FilmstripChange::Scale(scale) => self.scale = scale,
            FilmstripChange::Order(order) => self.order = order,
        }
    }
}

impl Feature for Filmstrip {
    type Change = FilmstripChange;

    fn apply(session: &mut Session, change: FilmstripChange) -> Option<WindowTask> {
        session.features.filmstrip.apply(change);
        None
    }

    fn leave_scene(&mut self) {
        self.drawn = None;
    }
}

/// Returns every scale that an upscaling method offers, in ascending order, except ×1.
pub(in crate::ui) fn scales() -> BTreeSet<Scale> {
    Upscaling::every().map(Upscaling::scale).filter(|scale| *scale != Scale::ONE).collect()
}

impl Session {
    /// Returns the request for the pictures of the filmstrip; `None` if it is not shown.
    pub(in crate::ui) fn filmstrip_request(&self) -> Option<CompareRequest> {
        self.features.filmstrip.is_shown.then(|| CompareRequest {
            scene: self.scene.clone(),
            camera: self.state.camera,
            sequence: None,
            viewport: self.viewport(),
            recipes: methods(self.features.filmstrip.scale)
                .map(|upscaler| Recipe { upscaler, ..self.state.recipe })
                .collect(),
            files: ComparedFiles::default(),
            reference: self.features.comparison.reference,
            region: None,
            difference: None,
        })
    }
}

/// Returns the part of a picture that every frame of the filmstrip shows: `size` pixels around the picked pixel, or
/// around the middle of the picture, moved as far as necessary to lie inside the picture.
pub(in crate::ui) fn detail(pick: Option<(u32, u32)>, picture: (u32, u32), size: (u32, u32)) -> PixelRegion {
    let center = pick.unwrap_or((picture.0 / 2, picture.1 / 2));
    let along = |center: u32, length: u32, size: u32| {
        let size = size.min(length);
        let first = center.saturating_sub(size / 2).min(length - size);
        (first, first + size)
    };
    let (left, right) = along(center.0, picture.0, size.0);
    let (top, bottom) = along(center.1, picture.1, size.1);
    PixelRegion { left, top, right, bottom }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_detail_lies_inside_the_picture_around_the_picked_pixel() {
        let corners = |region: PixelRegion| (region.left, region.top, region.right, region.bottom);
        assert_eq!(corners(detail(None, (1280, 720), (120, 60))), (580, 330, 700, 390));
        assert_eq!(corners(detail(Some((0, 719)), (1280, 720), (120, 60))), (0, 660, 120, 720));
        assert_eq!(corners(detail(Some((5, 5)), (16, 9), (120, 60))), (0, 0, 16, 9));
    }
}
