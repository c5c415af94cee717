//! Shading state of a draw, prepared once per frame.

use std::collections::HashMap;

use glam::Vec3;

use super::texture::{Layout, TextureReader};
use crate::pipeline::settings::{ColorSpace, Shading, TexelFilter};
use crate::pipeline::shade::Shader;
use crate::pipeline::shading::Input;
use crate::scene::{Texture, Transparency};

/// Shading features of a draw, which select its SIMD kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct ShadingPlan {
    /// Layout of the texels that a sample reads; `None` without a texture.
    pub(super) texture: Option<Layout>,
    /// Whether the texture is mip-mapped, so that texels of two mip levels are read.
    pub(super) mipmapped: bool,
    pub(super) shading: Shading,
    pub(super) light: LightSource,
    /// Whether the diffuse colour of the material differs from white.
    pub(super) tinted: bool,
    /// Whether colours are interpolated from vertex colours.
    pub(super) colored: bool,
    pub(super) space: ColorSpace,
    /// Whether the draw is blended over the picture behind it.
    pub(super) blended: bool,
}

/// Source of the light that shading multiplies colours by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum LightSource {
    /// Colours are unlit.
    None,
    /// Light is computed at the vertices and interpolated.
    Vertices,
    /// Light is computed from interpolated normals.
    Normals,
}

impl LightSource {
    /// Returns the source of a shading's light.
    fn of(shading: Shading) -> Self {
        if shading.reads(Input::VertexLight) {
            Self::Vertices
        } else if shading.reads(Input::LightDirection) {
            Self::Normals
        } else {
            Self::None
        }
    }
}

impl ShadingPlan {
    /// Plan of textured surfaces with the default settings.
    pub(super) const LAMBERT: Self = Self {
        texture: Some(Layout::PowerOfTwoQuads),
        mipmapped: false,
        shading: Shading::Lambert,
        light: LightSource::Normals,
        tinted: false,
        colored: false,
        space: ColorSpace::Linear,
        blended: false,
    };

    /// Plan of the least work for textured surfaces that are lit.
    pub(super) const GOURAUD: Self = Self { shading: Shading::Gouraud, light: LightSource::Vertices, ..Self::LAMBERT };

    /// Returns the plan in another colour space.
    #[inline(always)]
    pub(super) const fn of_space(self, space: ColorSpace) -> Self {
        Self { space, ..self }
    }
}

/// Number of texels that bilinear filtering reads in one mip level.
pub(super) const TEXELS_AROUND: u64 = 4;

/// Shading state of one draw: shader, texture and plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawShader<'a> {
    pub(super) shader: Shader<'a>,
    pub(super) divides_by_w: bool,
    pub(super) texture: Option<TextureReader<'a>>,
    pub(super) plan: ShadingPlan,
    /// Whether a SIMD kernel supports the shading.
    pub(super) on_lanes: bool,
    /// Number of texels read per sample. For trilinear filtering with SIMD, only the texels of the finer level are counted;
    /// for anisotropic filtering, those of one probe.
    pub(super) texels_per_sample: u64,
}

/// Shader of a draw, and the plan that its code is compiled for.
///
/// Both are references, so that the struct is passed as two of them. The compiler then knows that no store changes what
/// they refer to, and loads it once per loop. Fields that are
/// constants in the referenced plan remain compile-time constants.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlannedShader<'a> {
    pub(super) shader: &'a DrawShader<'a>,
    /// Plan of the shader, or an equal constant.
    pub(super) plan: &'a ShadingPlan,
}

/// Evaluates an expression with a plan that equals `$plan`. If it is one of the listed plans in any colour space, all its
/// other fields are compile-time constants, so the expression is compiled once per plan without branches on them.
macro_rules! with_known_plan {
    ([$($constant:ident),+], $plan:expr, $known:ident => $body:expr) => {{
        let (plan, space) = ($plan, $plan.space);
        match plan.of_space(ShadingPlan::LAMBERT.space) {
            $(ShadingPlan::$constant => {
                let $known = &ShadingPlan::$constant.of_space(space);
                $body
            })+
            _ => {
                let $known = &plan;
                $body
            }
        }
    }};
}
pub(super) use with_known_plan;

impl<'a> DrawShader<'a> {
    /// Creates the shading state of a draw. `texture` is the texture of its material.
    pub(super) fn new(shader: Shader<'a>, texture: Option<&'a Texture>, divides_by_w: bool) -> Self {
        let settings = shader.settings;
        let on_lanes = settings.shading.fits_lanes() && shader.fits_lanes();
        let texture = texture
            .filter(|_| on_lanes && shader.texture.is_some())
            .map(|texture| TextureReader::new(texture, shader.sampler(), settings));
        let plan = ShadingPlan {
            texture: texture.map(|texture: TextureReader<'_>| texture.layout),
            mipmapped: texture.is_some() && settings.filter.reads_mip_levels(),
            shading: settings.shading,
            light: LightSource::of(settings.shading),
            tinted: shader.diffuse != Vec3::ONE,
            colored: shader.attributes().color,
            space: settings.color_space,
            blended: shader.transparency() == Transparency::Blended,
        };
        let texels_per_texture = match settings.filter {
            TexelFilter::Point => 1,
            TexelFilter::Bilinear => TEXELS_AROUND,
            TexelFilter::Trilinear if on_lanes => TEXELS_AROUND,
            TexelFilter::Trilinear | TexelFilter::Anisotropic => 2 * TEXELS_AROUND,
        };
        let texels_per_sample = shader.texture_count() * texels_per_texture;
        Self { shader, divides_by_w, texture, plan, on_lanes, texels_per_sample }
    }

    /// Returns, for each shader, the index of the first equivalent shader, which may be itself. Samples of equivalent
    /// shaders can be shaded together. Perspective division makes no difference, because it is done per triangle.
    pub(super) fn first_alike(shaders: &[Self]) -> Vec<usize> {
        let mut firsts = HashMap::new();
        let first = |(number, shader): (usize, &Self)| {
            let texture = shader.texture.map(|texture| texture.address());
            let alpha = [shader.shader.opacity(), shader.shader.alpha_cutoff()].map(f32::to_bits);
            let surface = (shader.shader.diffuse.to_array().map(f32::to_bits), alpha);
            let looks = (texture, surface, shader.shader.sampler().address, shader.plan);
            if shader.on_lanes { *firsts.entry(looks).or_insert(number) } else { number }
        };
        shaders.iter().enumerate().map(first).collect()
    }
}
