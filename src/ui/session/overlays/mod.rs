//! Overlays on the picture: active overlays with their order and opacity.

pub(crate) mod save;

use crate::inspect::overlays::Overlay;
use crate::ui::engine::RenderedView;
use crate::ui::session::Session;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;

pub(crate) use crate::inspect::overlays::OverlayLayer;

/// Active overlays, and the state of their card.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Overlays {
    /// Stack of layers, from the bottom up.
    pub(crate) layers: Vec<OverlayLayer>,
    /// Whether the list of all overlays is open.
    pub(crate) open: bool,
    /// Whether sample points and triangle edges are drawn over enlarged pixels. The colour of an edge shows whether
    /// samples exactly on it belong to the triangle.
    pub(crate) marks: bool,
    /// Whether pixels are large enough to draw lines as vectors instead of pixels.
    pub(crate) vectors: bool,
}

/// Change to the overlays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OverlayChange {
    /// Opens or closes the list of overlays.
    Open(bool),
    /// Toggles the list of overlays.
    ToggleOpen,
    /// Adds an overlay on top of the stack, or removes it.
    Toggle(Overlay),
    /// Sets the opacity of an overlay, in [0, 1].
    Opacity(Overlay, f32),
    /// Sets the length of an overlay's normals, as a fraction of the diagonal of the scene's bounding box.
    Length(Overlay, f32),
    /// Moves an overlay one layer up.
    Raise(Overlay),
    /// Removes all overlays.
    Clear,
    /// Sets whether sample points and triangle edges are drawn over enlarged pixels.
    Marks(bool),
    /// Sets whether lines are drawn as vectors instead of pixels.
    Vectors(bool),
    /// Exports the totals of all overlays to a file.
    SaveTotals,
}

impl Overlays {
    /// Returns the number of active overlays, counting the marks as one.
    pub(crate) fn count(&self) -> usize {
        self.layers.len() + usize::from(self.marks)
    }

    /// Returns the layer of an overlay if it is active.
    pub(crate) fn layer(&self, overlay: Overlay) -> Option<OverlayLayer> {
        self.layers.iter().copied().find(|layer| layer.overlay == overlay)
    }

    /// Applies a change. A change that writes a file is returned instead, for the caller to handle.
    pub(crate) fn apply(&mut self, change: OverlayChange) -> Option<OverlayChange> {
        match change {
            OverlayChange::Open(open) => self.open = open,
            OverlayChange::ToggleOpen => self.open ^= true,
            OverlayChange::Toggle(overlay) if self.layer(overlay).is_some() => {
                self.layers.retain(|l| l.overlay != overlay);
            }
            OverlayChange::Toggle(overlay) => self.layers.push(overlay.into()),
            OverlayChange::Opacity(overlay, opacity) => {
                if let Some(layer) = self.layers.iter_mut().find(|layer| layer.overlay == overlay) {
                    layer.opacity = opacity.clamp(0.0, 1.0);
                }
            }
            OverlayChange::Length(overlay, length) => {
                if let Some(layer) = self.layers.iter_mut().find(|layer| layer.overlay == overlay) {
                    layer.length = length.clamp(0.0, 1.0);
                }
            }
            OverlayChange::Raise(overlay) => {
                if let Some(place) = self.layers.iter().position(|layer| layer.overlay == overlay)
                    && place + 1 < self.layers.len()
                {
                    self.layers.swap(place, place + 1);
                }
            }
            OverlayChange::Clear => (self.layers, self.marks) = (Vec::new(), false),
            OverlayChange::Marks(marks) => self.marks = marks,
            OverlayChange::Vectors(vectors) => self.vectors = vectors,
            OverlayChange::SaveTotals => return Some(change),
        }
        None
    }

    /// Returns the topmost active overlay that marks faulty pixels. The user can step through these pixels.
    pub(crate) fn stepped(&self) -> Option<Overlay> {
        let faults = [
            Overlay::Faults,
            Overlay::Junctions,
            Overlay::BadNumbers,
            Overlay::Clipped,
            Overlay::ExactOwner,
            Overlay::BlendOrder,
        ];
        self.layers.iter().rev().map(|layer| layer.overlay).find(|overlay| faults.contains(overlay))
    }

    /// Returns the first pixel after `from` that the overlay returned by [`Overlays::stepped`] marks. If `forwards` is
    /// `false`, returns the last marked pixel before `from`. Wraps around at the first and the last marked pixel.
    pub(crate) fn beside(&self, view: &RenderedView, from: Option<(u32, u32)>, forwards: bool) -> Option<(u32, u32)> {
        let overlay = self.stepped()?;
        view.look_result.sheets.iter().find(|sheet| sheet.overlay == overlay)?.next_pixel(from, forwards)
    }
}

impl Feature for Overlays {
    type Change = OverlayChange;

    fn apply(session: &mut Session, change: OverlayChange) -> Option<WindowTask> {
        session.features.overlays.apply(change).map(|_| WindowTask::SaveOverlayTotals)
    }

    fn leave_scene(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(overlays: &Overlays) -> Vec<Overlay> {
        overlays.layers.iter().map(|layer| layer.overlay).collect()
    }

    #[test]
    fn overlays_stack_in_the_order_in_which_they_are_added() {
        let mut overlays = Overlays::default();
        for overlay in [Overlay::Facing, Overlay::Wireframe, Overlay::Clipped] {
            assert_eq!(overlays.apply(OverlayChange::Toggle(overlay)), None);
        }
        overlays.apply(OverlayChange::Raise(Overlay::Facing));
        assert_eq!(order(&overlays), [Overlay::Wireframe, Overlay::Facing, Overlay::Clipped]);
        overlays.apply(OverlayChange::Raise(Overlay::Clipped));
        overlays.apply(OverlayChange::Toggle(Overlay::Wireframe));
        assert_eq!(order(&overlays), [Overlay::Facing, Overlay::Clipped]);
        overlays.apply(OverlayChange::Opacity(Overlay::Facing, 7.0));
        assert_eq!(overlays.layer(Overlay::Facing).map(|layer| layer.opacity), Some(1.0));
        assert_eq!(overlays.stepped(), Some(Overlay::Clipped));
        overlays.apply(OverlayChange::Clear);
        assert_eq!((overlays.count(), overlays.stepped()), (0, None));
        assert_eq!(overlays.apply(OverlayChange::SaveTotals), Some(OverlayChange::SaveTotals));
    }
}
