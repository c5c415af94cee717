//! Sets of triangles that were selected in the fates view, in a table, or by a click on a mesh.

use crate::scene::TriangleId;

/// Set of selected triangles of one scene, with a label. The default is the empty set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TriangleSelection {
    label: String,
    /// One bit per triangle, least significant first; truncated after the word of the last selected triangle.
    bits: Vec<u64>,
    len: usize,
}

impl TriangleSelection {
    /// Creates a set from triangles in any order; duplicates are ignored.
    pub fn new(label: impl Into<String>, members: impl IntoIterator<Item = TriangleId>) -> Self {
        let mut set = Self { label: label.into(), ..Self::default() };
        for TriangleId(id) in members {
            let (word, bit) = (id as usize / 64, 1 << (id % 64));
            if word >= set.bits.len() {
                set.bits.resize(word + 1, 0);
            }
            set.len += usize::from(set.bits[word] & bit == 0);
            set.bits[word] |= bit;
        }
        set
    }

    /// Returns the label that describes the selected triangles.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Returns the number of selected triangles.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no triangle is selected.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether a triangle is selected.
    pub fn contains(&self, TriangleId(id): TriangleId) -> bool {
        self.bits.get(id as usize / 64).is_some_and(|word| word >> (id % 64) & 1 == 1)
    }

    /// Returns the selected triangles, in scene order.
    #[cfg(test)]
    pub(crate) fn iter(&self) -> impl Iterator<Item = TriangleId> + '_ {
        let words = self.bits.iter().zip((0..).step_by(64));
        words.flat_map(|(word, first)| {
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| TriangleId(first + bit))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_contains_each_member_once_and_in_order() {
        let ids = [130, 0, 64, 63, 130, 5].map(TriangleId);
        let set = TriangleSelection::new("some", ids);
        assert_eq!((set.len(), set.label()), (5, "some"));
        assert_eq!(set.iter().collect::<Vec<_>>(), [0, 5, 63, 64, 130].map(TriangleId));
        assert!(ids.iter().all(|id| set.contains(*id)));
        assert!([1, 65, 131, 5000].iter().all(|id| !set.contains(TriangleId(*id))) && !set.contains(TriangleId::NONE));
    }

    #[test]
    fn the_default_is_empty() {
        let set = TriangleSelection::default();
        assert!(set.is_empty() && set.iter().next().is_none() && !set.contains(TriangleId(0)));
    }
}
