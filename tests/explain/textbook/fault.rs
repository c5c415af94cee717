//! Faults of common renderers, each a switch of this one.

/// Defines [`Fault`], its names and the list of all of them.
macro_rules! faults {
    ($($(#[$doc:meta])* $variant:ident = $name:literal,)*) => {
        /// Fault of a renderer.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Fault { $($(#[$doc])* $variant,)* }

        impl Fault {
            /// All faults.
            pub(crate) const ALL: &[Self] = &[$(Self::$variant,)*];

            /// Name in file names: lower case, words joined by `-`.
            pub(crate) fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }
        }
    };
}

faults! {
    /// Rows of the picture in reverse order.
    FlipVertical = "flip-vertical",
    /// Columns of the picture in reverse order.
    FlipHorizontal = "flip-horizontal",
    /// Pixels sampled at their top left corners instead of their centres.
    PixelCorners = "pixel-corners",
    /// Pixel centres on an edge belong to both triangles.
    FillInclusive = "fill-inclusive",
    /// Pixel centres on an edge belong to neither triangle.
    FillExclusive = "fill-exclusive",
    /// Back-facing triangles drawn too.
    CullNone = "cull-none",
    /// Front-facing triangles culled instead of back-facing ones.
    CullFront = "cull-front",
    /// Farthest surface kept: depth cleared to 0, test “greater”.
    DepthReversed = "depth-reversed",
    /// No depth test: the last triangle drawn wins.
    DepthOff = "depth-off",
    /// No depth test: triangles sorted by the distance of their centroids.
    Painter = "painter",
    /// Depth rounded to 16 bits.
    Depth16 = "depth-16",
    /// Depth rounded to 8 bits.
    Depth8 = "depth-8",
    /// Texture coordinates and normals interpolated linearly on the screen.
    Affine = "affine",
    /// Texture origin at the top left instead of the bottom left.
    TextureTop = "texture-top",
    /// Texture coordinates outside 0…1 clamped instead of repeated.
    Clamp = "clamp",
    /// Nearest texel instead of bilinear filtering.
    Nearest = "nearest",
    /// Bilinear filtering with texel centres at whole numbers: the offset of half a texel is missing.
    HalfTexel = "half-texel",
    /// Filtering, light and blending on sRGB codes, without any conversion.
    LightOnCodes = "light-on-codes",
    /// Linear light written to the picture without sRGB encoding.
    NoEncoding = "no-encoding",
    /// Light direction negated.
    LightNegated = "light-negated",
    /// Normals negated: the same picture as [`Self::LightNegated`], because only the product of both counts.
    NormalsNegated = "normals-negated",
    /// Interpolated normals not scaled to unit length.
    NormalsNotUnit = "normals-not-unit",
    /// Normals left in object space.
    NormalsUntransformed = "normals-untransformed",
    /// Normals transformed by the model matrix instead of its inverse transpose, then scaled to unit length.
    NormalsByModel = "normals-by-model",
    /// Aspect ratio of the picture taken as 1.
    AspectIgnored = "aspect-ignored",
    /// Aspect ratio of the picture inverted.
    AspectInverse = "aspect-inverse",
    /// Vertical field of view used as the horizontal one.
    FovHorizontal = "fov-horizontal",
    /// Left-handed view of right-handed data: mirrored, with the winding reversed.
    LeftHanded = "left-handed",
    /// No clipping against the near plane: corners behind the eye are projected through it.
    NoNearClip = "no-near-clip",
    /// Straight colours blended as if they were premultiplied by alpha.
    Premultiplied = "premultiplied",
    /// Colours truncated to 8 bits instead of rounded.
    Truncated = "truncated",
    /// Red and blue swapped.
    RedBlue = "red-blue",
    /// Corners not snapped to the grid of 1/256 px. Not a mistake, but a difference between correct renderers.
    NoSnapping = "no-snapping",
}

/// Set of faults.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Faults(u64);

impl Faults {
    /// Returns the set of the given faults; none gives a correct renderer.
    pub(crate) fn new(faults: &[Fault]) -> Self {
        Self(faults.iter().fold(0, |set, &fault| set | 1 << fault as u64))
    }

    /// Whether the set contains `fault`.
    pub(crate) fn has(self, fault: Fault) -> bool {
        self.0 >> fault as u64 & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_contains_exactly_its_faults() {
        let set = Faults::new(&[Fault::Affine, Fault::NoSnapping]);
        let found: Vec<&str> = Fault::ALL.iter().filter(|&&fault| set.has(fault)).map(|fault| fault.name()).collect();
        assert_eq!(found, ["affine", "no-snapping"]);
    }
}
