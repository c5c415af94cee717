//! Identifiers of shared data.

macro_rules! id {
    ($(#[$doc:meta])* $visibility:vis $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        $visibility struct $name(pub(super) u32);

        impl $name {
            /// Returns the index of the item in its library.
            pub(crate) fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// Identifier of a mesh in a [`Library`](super::Library).
    pub MeshId
);
id!(
    /// Identifier of a material in a [`Library`](super::Library).
    pub MaterialId
);
id!(
    /// Identifier of a texture in a [`Library`](super::Library).
    pub TextureId
);
