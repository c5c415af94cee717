//! Slots: the numbers by which the samples of a tile refer to its triangles.

/// Index of a triangle in the bin of its tile, with a flag bit for edge values that may exceed 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(pub(super) u32);

impl Slot {
    /// Slot of samples that show the background.
    pub(super) const NONE: Self = Self(u32::MAX);
    /// Flag bit of triangles whose edge values may exceed 32 bits.
    pub(super) const LARGE: u32 = 1 << 31;

    #[inline(always)]
    pub(super) fn new(place: usize, is_large: bool) -> Self {
        Self(place as u32 | if is_large { Self::LARGE } else { 0 })
    }

    /// Returns the index of the entry in the tile's bin.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        (self.0 & !Self::LARGE) as usize
    }

    /// Returns `true` if edge values of the triangle may exceed 32 bits.
    #[inline(always)]
    pub(super) fn is_large(self) -> bool {
        self.0 & Self::LARGE != 0
    }
}
