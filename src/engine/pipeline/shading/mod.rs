//! Shadings: sources of a fragment's colour. Each file declares one: its names, its inputs, and its kernel.
//!
//! There are four kinds of kernels:
//! - `material`: `light` returns the factor by which light multiplies the colour of the material. Textures, highlight,
//!   emission and blending are the same for all shadings of this kind.
//! - `quantity`: `color` returns a quantity as a colour, whose values 0 to 1 are the codes 0 to 255. The surface is opaque.
//! - `surface`: `color` returns a colour in the working colour space, which is encoded like light. The surface is opaque.
//! - `flat`: `color` returns the colour of a whole triangle.
//!
//! Kernels of all kinds except `flat` are generic over the number. Pictures and the inspector call them with floats, the
//! tiled execution with lanes, and the trace with formulas, so that all three agree. Lanes shade all draws that read
//! nothing else than [`LightInputs`] and a colour texture. Quantities are shaded sample by sample, even by the tiled
//! execution: their pictures are for inspection, where speed matters less than a short kernel.

mod barycentric;
mod blinn_phong;
pub(crate) mod cel;
mod checker;
mod depth;
mod facing_ratio;
mod gouraud;
mod lambert;
mod normals;
mod object_id;
mod texture;
mod triangle_id;
mod uv;
mod vertex_color;

pub(crate) use lambert::lambert;
pub(crate) use triangle_id::id_color;

use super::choice::{Label, registry};
use crate::image::Rgba8;
use crate::math::real::Real;
use crate::scene::{Library, TriangleId};

/// Declares the shadings: the kind of the kernel, and the module with the kernel and the facts.
macro_rules! shadings {
    ($($variant:ident = $kind:ident $module:ident;)+) => {
        registry! {
            /// Source of a fragment's colour.
            pub Shading: ShadingFacts {
                $($variant = $module::FACTS;)+
            }
        }

        impl Shading {
            /// Returns the kind of the kernel.
            pub(crate) const fn kind(self) -> ShadingKind {
                match self { $(Self::$variant => kind!($kind)),+ }
            }

            /// Returns the factor by which light multiplies the colour of the material. It is 1 in shadings without a
            /// material.
            #[inline(always)]
            pub(crate) fn light<I: LightInputs>(self, at: &I) -> I::Number {
                match self { $(Self::$variant => light!($kind, $module, at)),+ }
            }

            /// Returns the colour that shows a quantity or a surface, or `None` if the shading is of another kind.
            #[inline(always)]
            pub(crate) fn quantity<I: SurfaceInputs>(self, at: &I) -> Option<[I::Number; 3]> {
                match self { $(Self::$variant => quantity!($kind, $module, at)),+ }
            }

            /// Returns the colour of a whole triangle, or `None` if the shading is of another kind.
            #[inline(always)]
            pub(crate) fn flat(self, triangle: &FlatInputs) -> Option<Rgba8> {
                match self { $(Self::$variant => flat!($kind, $module, triangle)),+ }
            }
        }
    };
}

macro_rules! kind {
    (material) => {
        ShadingKind::Material
    };
    (quantity) => {
        ShadingKind::Quantity
    };
    (surface) => {
        ShadingKind::Surface
    };
    (flat) => {
        ShadingKind::Flat
    };
}

macro_rules! light {
    (material, $module:ident, $at:ident) => {
        $module::light($at)
    };
    ($other:ident, $module:ident, $at:ident) => {
        $at.constant(1.0)
    };
}

macro_rules! quantity {
    (quantity, $module:ident, $at:ident) => {
        Some($module::color($at))
    };
    (surface, $module:ident, $at:ident) => {
        Some($module::color($at))
    };
    ($other:ident, $module:ident, $at:ident) => {
        None
    };
}

macro_rules! flat {
    (flat, $module:ident, $at:ident) => {
        Some($module::color($at))
    };
    ($other:ident, $module:ident, $at:ident) => {
        None
    };
}

shadings! {
    Texture = material texture;
    VertexColor = surface vertex_color;
    Gouraud = material gouraud;
    Lambert = material lambert;
    BlinnPhong = material blinn_phong;
    Cel = material cel;
    Checker = quantity checker;
    Normals = quantity normals;
    FacingRatio = quantity facing_ratio;
    Uv = quantity uv;
    Barycentric = quantity barycentric;
    Depth = quantity depth;
    TriangleId = flat triangle_id;
    ObjectId = flat object_id;
}

/// Kind of a shading's kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShadingKind {
    /// The colour of the material times light.
    Material,
    /// A quantity as a colour, whose values 0 to 1 are the codes 0 to 255.
    Quantity,
    /// A colour in the working colour space, which is encoded like light.
    Surface,
    /// One colour for a whole triangle.
    Flat,
}

/// Facts that a shading declares about itself. Draw plans, interpolated attributes, controls and explanations follow
/// from them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingFacts {
    pub(crate) label: Label,
    pub(crate) reads: Inputs,
}

/// Input of a shading's kernel, or of the kernel's surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Input {
    /// Unit normal of the fragment. It is perturbed by normal maps, for which tangents are read too.
    Normal,
    /// Light computed at the vertices by Lambert's law, and interpolated.
    VertexLight,
    /// Direction towards the light.
    LightDirection,
    /// Ambient fraction of the light.
    Ambient,
    /// Direction towards the eye.
    EyeDirection,
    /// Dark texture of the material, which replaces the colour texture where [`cel::is_lit`] is false.
    DarkTexture,
    /// Specular colour of the material: a highlight is added to the diffuse reflection.
    Specular,
    /// Texture coordinates.
    Uv,
    /// Vertex colour.
    VertexColor,
    /// Barycentric weights of the triangle before clipping.
    Weights,
    /// Depth, as it is stored.
    Depth,
    /// Pattern of the checkerboard in the settings.
    Checker,
}

/// Set of inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inputs(u16);

impl Inputs {
    /// Returns the set of the listed inputs.
    pub(crate) const fn of(inputs: &[Input]) -> Self {
        let (mut set, mut i) = (0, 0);
        while i < inputs.len() {
            set |= 1 << inputs[i] as u16;
            i += 1;
        }
        Self(set)
    }

    /// Returns whether the set contains an input.
    #[inline(always)]
    pub(crate) const fn has(self, input: Input) -> bool {
        self.0 >> input as u16 & 1 != 0
    }
}

/// Data that a scene may lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneData {
    /// Colours of vertices.
    VertexColors,
    /// Texture coordinates.
    TextureCoordinates,
    /// Textures.
    Textures,
}

impl SceneData {
    /// Returns the display name, in the plural and in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::VertexColors => "vertex colours",
            Self::TextureCoordinates => "texture coordinates",
            Self::Textures => "textures",
        }
    }

    /// Returns whether a scene has the data.
    pub fn is_in(self, library: &Library) -> bool {
        match self {
            Self::VertexColors => library.meshes().iter().any(|mesh| !mesh.colors.is_empty()),
            Self::TextureCoordinates => library.meshes().iter().any(|mesh| !mesh.uvs.is_empty()),
            Self::Textures => !library.textures().is_empty(),
        }
    }
}

/// Inputs of the light of a material, for floats, lanes and formulas. Inputs that the shading does not declare in
/// [`ShadingFacts::reads`] are zero.
pub(crate) trait LightInputs {
    /// Number that the kernel computes with.
    type Number: Real;

    /// Returns a constant.
    fn constant(&self, value: f32) -> Self::Number;

    /// Returns [`Input::Normal`], in world space.
    fn normal(&self) -> [Self::Number; 3];

    /// Returns [`Input::VertexLight`].
    fn vertex_light(&self) -> Self::Number;

    /// Returns [`Input::LightDirection`]: the world-space unit vector towards the light.
    fn light_direction(&self) -> [Self::Number; 3];

    /// Returns [`Input::Ambient`], in 0…1.
    fn ambient(&self) -> Self::Number;

    /// Returns the factor of the light on the dark side of [`Input::DarkTexture`].
    fn dark_factor(&self) -> Self::Number;
}

/// Inputs of a quantity, for floats and formulas.
pub(crate) trait SurfaceInputs: LightInputs {
    /// Returns [`Input::EyeDirection`]: the world-space unit vector towards the eye.
    fn eye_direction(&self) -> [Self::Number; 3];

    /// Returns [`Input::Uv`], with v pointing down.
    fn uv(&self) -> [Self::Number; 2];

    /// Returns [`Input::VertexColor`], in the working colour space.
    fn vertex_color(&self) -> [Self::Number; 3];

    /// Returns [`Input::Weights`].
    fn weights(&self) -> [Self::Number; 3];

    /// Returns [`Input::Depth`].
    fn depth(&self) -> Self::Number;

    /// Returns the number of squares per unit of texture coordinate, and the colours of even and odd squares:
    /// [`Input::Checker`].
    fn checker(&self) -> CheckerInputs<Self::Number>;
}

/// Pattern of the checkerboard.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CheckerInputs<N> {
    /// Number of squares per unit of texture coordinate.
    pub(crate) squares: N,
    /// Colour of the square at the origin, as sRGB values.
    pub(crate) even: [N; 3],
    /// Colour of the other squares, as sRGB values.
    pub(crate) odd: [N; 3],
}

/// Inputs of the colour of a whole triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatInputs {
    /// Identifier of the triangle in the scene.
    pub(crate) triangle: TriangleId,
    /// Index of the instance.
    pub(crate) instance: u32,
    /// Whether ids are written as they are, four bytes, least significant first, instead of as colours.
    pub(crate) exact_ids: bool,
}

impl Shading {
    /// Returns whether the kernel reads an input.
    #[inline(always)]
    pub(crate) const fn reads(self, input: Input) -> bool {
        self.facts().reads.has(input)
    }

    /// Returns whether the shading mode uses the material's colour, texture and opacity. All other shading modes draw
    /// opaque surfaces.
    pub const fn reads_material(self) -> bool {
        matches!(self.kind(), ShadingKind::Material)
    }

    /// Returns whether the shading mode computes lighting, per vertex or per pixel.
    pub const fn is_lit(self) -> bool {
        self.reads(Input::LightDirection) || self.reads(Input::VertexLight)
    }

    /// Returns whether the shading mode has an ambient fraction of the light.
    pub const fn reads_ambient(self) -> bool {
        self.reads(Input::Ambient) || self.reads(Input::VertexLight)
    }

    /// Returns whether the shading mode shows the checkerboard of the settings.
    pub const fn reads_checker(self) -> bool {
        self.reads(Input::Checker)
    }

    /// Returns the data that a scene must have for the shading mode to be useful, or `None` if every scene has it.
    pub const fn requires(self) -> Option<SceneData> {
        if self.reads(Input::Uv) {
            Some(SceneData::TextureCoordinates)
        } else if self.reads(Input::VertexColor) {
            Some(SceneData::VertexColors)
        } else if self.reads_material() && !self.is_lit() {
            Some(SceneData::Textures)
        } else {
            None
        }
    }

    /// Returns whether lanes have all inputs of the shading mode: it reads a single colour texture, and normals or the
    /// light of vertices, but not both.
    pub(crate) const fn fits_lanes(self) -> bool {
        let reads_both = self.reads(Input::Normal) && self.reads(Input::VertexLight);
        self.reads_material() && !self.reads(Input::DarkTexture) && !reads_both
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::pipeline::settings::Choice as _;

    /// Inputs that note which of them a kernel reads.
    #[derive(Default)]
    struct Probe(Cell<u16>);

    impl Probe {
        fn note<T>(&self, input: Input, value: T) -> T {
            self.0.set(self.0.get() | Inputs::of(&[input]).0);
            value
        }
    }

    impl LightInputs for Probe {
        type Number = f32;

        fn constant(&self, value: f32) -> f32 {
            value
        }

        fn normal(&self) -> [f32; 3] {
            self.note(Input::Normal, [0.0, 0.0, 1.0])
        }

        fn vertex_light(&self) -> f32 {
            self.note(Input::VertexLight, 0.5)
        }

        fn light_direction(&self) -> [f32; 3] {
            self.note(Input::LightDirection, [0.0, 0.6, 0.8])
        }

        fn ambient(&self) -> f32 {
            self.note(Input::Ambient, 0.25)
        }

        fn dark_factor(&self) -> f32 {
            self.note(Input::DarkTexture, 1.0)
        }
    }

    impl SurfaceInputs for Probe {
        fn eye_direction(&self) -> [f32; 3] {
            self.note(Input::EyeDirection, [0.0, 0.0, 1.0])
        }

        fn uv(&self) -> [f32; 2] {
            self.note(Input::Uv, [0.25, 0.75])
        }

        fn vertex_color(&self) -> [f32; 3] {
            self.note(Input::VertexColor, [0.5; 3])
        }

        fn weights(&self) -> [f32; 3] {
            self.note(Input::Weights, [0.25, 0.25, 0.5])
        }

        fn depth(&self) -> f32 {
            self.note(Input::Depth, 0.5)
        }

        fn checker(&self) -> CheckerInputs<f32> {
            self.note(Input::Checker, CheckerInputs { squares: 8.0, even: [1.0; 3], odd: [0.0; 3] })
        }
    }

    #[test]
    fn every_kernel_reads_exactly_the_inputs_that_it_declares() {
        for shading in Shading::ALL {
            let probe = Probe::default();
            shading.light(&probe);
            shading.quantity(&probe);
            // The highlight is added outside of the kernel.
            let outside = Inputs::of(&[Input::Specular]).0;
            assert_eq!(probe.0.get(), shading.facts().reads.0 & !outside, "{shading:?}");
        }
    }
}
