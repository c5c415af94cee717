//! Fates of all triangles and fragments (visible, hidden, culled, clipped and others): state of the panel “Triangle fates”, and
//! selection of triangles by fate.

pub(crate) mod finder;

use std::sync::Arc;

use crate::inspect::fates::{Bin, FateFilter, Fates};
use crate::inspect::selection::TriangleSelection;
use crate::scene::TriangleId;
use crate::ui::session::Session;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use finder::Finder;

/// Fates of the triangles and fragments on screen, and the filter that selects triangles by fate, object or text.
#[derive(Debug, Default)]
pub(crate) struct FatesView {
    /// Fates of the frame; `None` until computed. The fates of the previous frame remain until the new ones are ready.
    pub(crate) fates: Option<Arc<Fates>>,
    /// Fate (of the triangle or of one of its fragments) by which the filter selects triangles; `None` for all fates.
    pub(crate) bin: Option<Bin>,
    /// Index of the instance that the filter selects; `None` for all instances.
    pub(crate) object: Option<usize>,
    /// Filter text above the list, as typed.
    pub(crate) text: String,
    /// Triangles that match all filters: fate, object and text.
    pub(crate) members: Arc<[TriangleId]>,
    /// Background task that counts the fates.
    finder: Finder,
}

/// Change to the filter, requested by the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum FatesChange {
    /// Filters triangles by a fate: their own, or that of one of their fragments. Removes the filter if this fate is
    /// already selected.
    Bin(Bin),
    /// Filters triangles by the instance with this index. Removes the filter if that instance is already selected.
    Object(usize),
    /// Filters triangles by this text.
    Text(String),
    /// Clears all filters.
    Clear,
}

impl FatesView {
    /// Applies a change to the filter and updates the selection.
    pub(crate) fn apply(&mut self, change: FatesChange, selection: &mut TriangleSelection) {
        match change {
            FatesChange::Bin(bin) => self.bin = (self.bin != Some(bin)).then_some(bin),
            FatesChange::Object(object) => self.object = (self.object != Some(object)).then_some(object),
            FatesChange::Text(text) => self.text = text,
            FatesChange::Clear => (self.bin, self.object, self.text) = (None, None, String::new()),
        }
        self.find_members();
        *selection = self.selection();
    }

    /// Clears the filter and replaces the selection with `others`, a selection made outside the panel “Triangle fates”.
    pub(crate) fn adopt_selection(&mut self, others: TriangleSelection, selection: &mut TriangleSelection) {
        self.apply(FatesChange::Clear, selection);
        *selection = others;
    }

    /// Stores the fates of a new frame and reapplies the filter.
    pub(crate) fn set_fates(&mut self, fates: Arc<Fates>, selection: &mut TriangleSelection) {
        self.object = self.object.filter(|object| *object < fates.objects.len());
        self.fates = Some(fates);
        self.find_members();
        if self.is_filtering() {
            *selection = self.selection();
        }
    }

    /// Whether any filter is active.
    pub(crate) fn is_filtering(&self) -> bool {
        self.bin.is_some() || self.object.is_some() || !self.text.trim().is_empty()
    }

    fn find_members(&mut self) {
        let filter = FateFilter::parse(&self.text);
        self.members =
            self.fates.as_ref().map_or_else(Arc::default, |fates| fates.members(self.bin, self.object, &filter).into());
    }

    fn selection(&self) -> TriangleSelection {
        let Some(fates) = self.fates.as_ref().filter(|_| self.is_filtering()) else {
            return TriangleSelection::default();
        };
        let object =
            self.object.and_then(|object| fates.objects.get(object)).map(|object| format!("“{}”", object.name));
        let text = Some(self.text.trim().to_owned()).filter(|text| !text.is_empty());
        let words: Vec<_> = self.bin.map(Bin::label).into_iter().chain(object).chain(text).collect();
        TriangleSelection::new(words.join(", "), self.members.iter().copied())
    }
}

impl Feature for FatesView {
    type Change = FatesChange;

    fn apply(session: &mut Session, change: FatesChange) -> Option<WindowTask> {
        session.features.fates.apply(change, &mut session.selection);
        None
    }

    fn leave_scene(&mut self) {
        *self = Self::default();
    }
}
