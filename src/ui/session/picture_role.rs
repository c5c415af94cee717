//! Parts that pictures take in a comparison.

/// Part of a picture in a comparison, or in the explanation of one of its pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureRole {
    /// Picture of the tile with this index; tile 0 is A, tile 1 is B.
    Tile(usize),
    /// Reference that errors are measured against.
    Reference,
    /// Depths of the picture that is explained.
    Depths,
    /// Ids of the triangles or objects in the picture that is explained.
    Ids,
}

impl PictureRole {
    /// Roles with menu entries: A, B and the reference.
    pub(crate) const LISTED: [Self; 3] = [Self::Tile(0), Self::Tile(1), Self::Reference];

    /// Returns the display name, such as `A` or `reference`.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Tile(tile) => letter(tile).to_string(),
            Self::Reference => "reference".to_owned(),
            Self::Depths => "depths of the explained picture".to_owned(),
            Self::Ids => "ids of the explained picture".to_owned(),
        }
    }
}

/// Returns the letter of a tile: A for tile 0, B for tile 1, and so on.
pub(crate) fn letter(tile: usize) -> char {
    char::from(b'A' + (tile % 26) as u8)
}
