//! Where every triangle and fragment went: what the tab shows of it, and what of it is selected in the picture.

pub mod finder;

pub mod funnel;

pub mod list;

pub mod objects;

pub mod overlay;

pub mod tab;

use std::sync::Arc;

use crate::inspect::fates::{Bin, Fates, Filter};
use crate::inspect::selection::TriangleSelection;
use crate::scene::TriangleId;

/// What the window knows of the fates of the frame on screen, and who of them is asked for.
#[derive(Clone, Debug, Default)]
pub struct FatesView {
    /// The fates, once they are known. Those of an earlier view stay until the new ones are there.
    pub fates: Option<Arc<Fates>>,
    /// The chosen bin.
    pub bin: Option<Bin>,
    /// The chosen instance.
    pub object: Option<usize>,
    /// What the list is filtered by, as it is written.
    pub text: String,
    /// The triangles that answer to bin, object and text.
    pub members: Arc<[TriangleId]>,
}

/// A change of who is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// The members of this bin; a second time, all again.
    Bin(Bin),
    /// The triangles of this instance; a second time, all again.
    Object(usize),
    /// Those that answer to this text.
    Text(String),
    /// Nobody in particular any more.
    Clear,
}

impl FatesView {
    /// Applies a change, to what is selected too.
    pub fn apply(&mut self, change: Change, selection: &mut TriangleSelection) {
        match change {
            Change::Bin(bin) => self.bin = (self.bin != Some(bin)).then_some(bin),
            Change::Object(object) => self.object = (self.object != Some(object)).then_some(object),
            Change::Text(text) => self.text = text,
            Change::Clear => (self.bin, self.object, self.text) = (None, None, String::new()),
        }
        self.find_members();
        *selection = self.selection();
    }

    /// Asks for nobody any more, as somebody else selects.
    pub fn give_way(&mut self, others: TriangleSelection, selection: &mut TriangleSelection) {
        self.apply(Change::Clear, selection);
        *selection = others;
    }

    /// Takes the fates of a new view; the same are asked for as before.
    pub fn take(&mut self, fates: Arc<Fates>, selection: &mut TriangleSelection) {
        self.object = self.object.filter(|object| *object < fates.objects.len());
        self.fates = Some(fates);
        self.find_members();
        if self.asks() {
            *selection = self.selection();
        }
    }

    /// Whether anybody in particular is asked for.
    pub fn asks(&self) -> bool {
        self.bin.is_some() || self.object.is_some() || !self.text.trim().is_empty()
    }

    fn find_members(&mut self) {
        let filter = Filter::parse(&self.text);
        self.members =
            self.fates.as_ref().map_or_else(Arc::default, |fates| fates.members(self.bin, self.object, &filter).into());
    }

    fn selection(&self) -> TriangleSelection {
        let Some(fates) = self.fates.as_ref().filter(|_| self.asks()) else { return TriangleSelection::default() };
        let object =
            self.object.and_then(|object| fates.objects.get(object)).map(|object| format!("“{}”", object.name));
        let text = Some(self.text.trim().to_owned()).filter(|text| !text.is_empty());
        let words: Vec<_> = self.bin.map(Bin::label).into_iter().chain(object).chain(text).collect();
        TriangleSelection::new(words.join(", "), self.members.iter().copied())
    }
}
