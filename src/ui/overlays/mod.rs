//! What is laid over the picture on the canvas: which overlays, in which order and how strong; their legends, and marks
//! that are drawn where pixels are large.

pub mod card;

pub mod legend;

pub mod marks;

pub mod readout;

pub mod save;

use super::engine::View;
use crate::inspect::overlays::Overlay;

pub use crate::inspect::overlays::Layer;

/// What is laid over the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlays {
    /// The stack, the lowest first.
    pub layers: Vec<Layer>,
    /// Whether the list of all overlays is shown.
    pub open: bool,
    /// Whether sample points and owners of edges are drawn where pixels are large.
    pub marks: bool,
    /// Whether pixels are so large that lines are drawn between them instead of in pixels.
    pub vectors: bool,
}

/// A change of what is laid over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Show the list, or hide it.
    Open(bool),
    /// Show the list if it is hidden, and the other way round.
    ToggleOpen,
    /// Lay this one over all others, or take it away.
    Toggle(Overlay),
    /// Make it this strong.
    Opacity(Overlay, f32),
    /// Make its normals this long, as a share of the diagonal of the scene's box.
    Length(Overlay, f32),
    /// Lay it over the next one above.
    Raise(Overlay),
    /// Take all away.
    Clear,
    /// Draw the marks, or do not.
    Marks(bool),
    /// Draw lines between pixels, or in them.
    Vectors(bool),
    /// Write all totals into a file.
    SaveTotals,
}

impl Overlays {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.layers.len() + usize::from(self.marks)
    }

    /// The layer of an overlay, if it is on.
    pub fn layer(&self, overlay: Overlay) -> Option<Layer> {
        self.layers.iter().copied().find(|layer| layer.overlay == overlay)
    }

    /// Applies a change; returns it if it concerns the disk.
    pub fn apply(&mut self, change: Change) -> Option<Change> {
        match change {
            Change::Open(open) => self.open = open,
            Change::ToggleOpen => self.open ^= true,
            Change::Toggle(overlay) if self.layer(overlay).is_some() => self.layers.retain(|l| l.overlay != overlay),
            Change::Toggle(overlay) => self.layers.push(overlay.into()),
            Change::Opacity(overlay, opacity) => {
                if let Some(layer) = self.layers.iter_mut().find(|layer| layer.overlay == overlay) {
                    layer.opacity = opacity.clamp(0.0, 1.0);
                }
            }
            Change::Length(overlay, length) => {
                if let Some(layer) = self.layers.iter_mut().find(|layer| layer.overlay == overlay) {
                    layer.length = length.clamp(0.0, 1.0);
                }
            }
            Change::Raise(overlay) => {
                if let Some(place) = self.layers.iter().position(|layer| layer.overlay == overlay)
                    && place + 1 < self.layers.len()
                {
                    self.layers.swap(place, place + 1);
                }
            }
            Change::Clear => (self.layers, self.marks) = (Vec::new(), false),
            Change::Marks(marks) => self.marks = marks,
            Change::Vectors(vectors) => self.vectors = vectors,
            Change::SaveTotals => return Some(change),
        }
        None
    }

    /// The overlay whose pixels are stepped through: the uppermost of those that mark faults.
    pub fn stepped(&self) -> Option<Overlay> {
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

    /// The next pixel that [`Overlays::stepped`] marks after another one, or the last before it, round the end.
    pub fn beside(&self, view: &View, from: Option<(u32, u32)>, forwards: bool) -> Option<(u32, u32)> {
        let overlay = self.stepped()?;
        view.looked.sheets.iter().find(|sheet| sheet.overlay == overlay)?.beside(from, forwards)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(overlays: &Overlays) -> Vec<Overlay> {
        overlays.layers.iter().map(|layer| layer.overlay).collect()
    }

    #[test]
    fn overlays_stack_in_the_order_in_which_they_are_laid() {
        let mut overlays = Overlays::default();
        for overlay in [Overlay::Facing, Overlay::Wireframe, Overlay::Clipped] {
            assert_eq!(overlays.apply(Change::Toggle(overlay)), None);
        }
        overlays.apply(Change::Raise(Overlay::Facing));
        assert_eq!(order(&overlays), [Overlay::Wireframe, Overlay::Facing, Overlay::Clipped]);
        overlays.apply(Change::Raise(Overlay::Clipped));
        overlays.apply(Change::Toggle(Overlay::Wireframe));
        assert_eq!(order(&overlays), [Overlay::Facing, Overlay::Clipped]);
        overlays.apply(Change::Opacity(Overlay::Facing, 7.0));
        assert_eq!(overlays.layer(Overlay::Facing).map(|layer| layer.opacity), Some(1.0));
        assert_eq!(overlays.stepped(), Some(Overlay::Clipped));
        overlays.apply(Change::Clear);
        assert_eq!((overlays.count(), overlays.stepped()), (0, None));
        assert_eq!(overlays.apply(Change::SaveTotals), Some(Change::SaveTotals));
    }
}
