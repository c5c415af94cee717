//! The automatic first pick, which shows new users how a pixel is explained.

use super::Session;
use crate::chain::Frame;
use crate::pipeline::viewport::Viewport;

/// State of the automatic first pick, which shows new users how a pixel is explained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum FirstPick {
    /// No pixel has been picked yet.
    #[default]
    Due,
    /// This pixel was picked automatically in a picture of this size. The pick is repeated when the size changes.
    Made((u32, u32), Viewport),
    /// The user has picked a pixel.
    Done,
}

/// Position of the automatic pick, as fractions of width and height: near the centre, where scenes have geometry.
const FIRST_PICK: (f32, f32) = (0.53, 0.49);

impl Session {
    /// Picks a pixel automatically if the user has not picked one, or if the pick is outside the picture. Chooses the
    /// black spot of the lesson, or otherwise the pixel nearest to [`FIRST_PICK`] that shows a triangle.
    pub(crate) fn pick_by_itself(&mut self) {
        let Some(view) = self.view_of_scene() else { return };
        let viewport = view.frame.viewport;
        if viewport != self.viewport() {
            return;
        }
        let is_wanted = match (self.features.picking.first, self.pick) {
            (FirstPick::Due, None) => true,
            (FirstPick::Made(own, of), Some(pick)) if own == pick => of != viewport,
            (_, Some((x, y))) => x >= viewport.width || y >= viewport.height,
            (_, None) => false,
        };
        if is_wanted {
            let Viewport { width, height } = viewport;
            let place = ((width as f32 * FIRST_PICK.0) as u32, (height as f32 * FIRST_PICK.1) as u32);
            let spot = self.features.onboarding.lesson.and_then(|lesson| lesson.black_pixel(&view.frame));
            let pick = spot.or_else(|| nearest_drawn(&view.frame, place)).unwrap_or(place);
            (self.pick, self.features.picking.first) = (Some(pick), FirstPick::Made(pick, viewport));
        } else if !matches!((self.features.picking.first, self.pick), (FirstPick::Made(own, _), Some(pick)) if own == pick)
        {
            self.features.picking.first = FirstPick::Done;
        }
    }
}

/// Returns the pixel nearest to `place` whose stored depth is strictly between 0 and 1, which means that a triangle was
/// drawn there. Returns `None` if there is no such pixel or no depth buffer.
pub(in crate::ui) fn nearest_drawn(frame: &Frame, place: (u32, u32)) -> Option<(u32, u32)> {
    let depth = frame.drawn.depth.as_ref()?;
    let pixels = (0..depth.height()).flat_map(|row| (0..depth.width()).map(move |column| (column, row)));
    pixels
        .filter(|(column, row)| (f32::MIN_POSITIVE..1.0).contains(&depth.at(*column, *row)))
        .map(|sample| frame.pixel_of(sample))
        .min_by_key(|(x, y)| u64::from(x.abs_diff(place.0)).pow(2) + u64::from(y.abs_diff(place.1)).pow(2))
}
