//! Settings of the pipeline as plain data: one enum per decision. Each variant has the name and the help text that
//! menus, tooltips and the command line show.

use std::ops::RangeInclusive;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::background::Background;
pub use super::choice::{Choice, choice};
pub use super::depth_format::DepthFormat;
use super::raster::CoverageRules;
pub use super::raster::{Arithmetic, FillRule, Rasterizer};
pub use super::shading::{SceneData, Shading};
use crate::image::Rgba8;

choice! {
    /// Execution strategy of the pipeline. All alternatives give the same picture, bit for bit, but differ in speed.
    pub Execution {
        Tiled = "tiled", "Tiled",
            "Draws tile by tile, several samples at a time (SIMD), on all threads; shades each visible sample once.";
        Classic = "classic", "Classic",
            "Draws triangle by triangle through every stage, on one thread: for examining stages and comparing \
             rasterizers.";
    }
}

choice! {
    /// Optimisation to disable: the chosen parts of the pipeline run even in draws that do not need them. The picture
    /// is the same; the time shows what skipping the parts saves.
    pub DisabledOptimisation {
        Nothing = "nothing", "Nothing", "Every draw skips the parts that it does not need.";
        Everything = "everything", "Everything", "Every part that can be skipped runs in every draw.";
        Vertices = "vertices", "Vertices", "Objects wholly outside the view are still transformed and clipped.";
        Clusters = "clusters", "Every cluster",
            "Clusters of a large mesh that are wholly outside the view or culled by facing are still transformed, and \
             their triangles are culled one by one.";
        Clipping = "clipping", "Clipping",
            "Triangles of objects wholly inside the view are still tested against the clipping planes.";
        PerspectiveDivision = "perspective-division", "Perspective division",
            "Weights are still divided by w in orthographic views, where all w are equal.";
        TextureCoordinates = "texture-coordinates", "Texture coordinates",
            "Texture coordinates are fetched and interpolated even if no texture is read.";
        Normals = "normals", "Normals", "Normals are transformed and interpolated even if the shading reads none.";
        VertexColors = "vertex-colors", "Vertex colours",
            "Vertex colours are fetched and interpolated even if the shading reads none.";
    }
}

choice! {
    /// Culling of triangles by their facing.
    pub Culling {
        None = "none", "None", "Front-facing and back-facing triangles are drawn.";
        Back = "back", "Back", "Back-facing triangles are culled: in a closed mesh they are always hidden.";
        Front = "front", "Front", "Front-facing triangles are culled: shows the inside of closed meshes.";
    }
}

choice! {
    /// Depth test: comparison that a fragment must pass to replace the stored depth. The names refer to standard depth;
    /// reversed depth mirrors the comparison.
    pub DepthTest {
        Off = "off", "Off", "The last triangle drawn wins (painter's algorithm). There is no depth buffer.";
        Less = "less", "Less", "The nearer fragment wins; at equal depth, the first one drawn.";
        LessEqual = "less-equal", "Less or equal", "The nearer fragment wins; at equal depth, the last one drawn.";
        Greater = "greater", "Greater",
            "The farther fragment wins: shows the back of the scene. The buffer is cleared to the near plane.";
        Always = "always", "Always", "Every fragment and its depth are written.";
    }
}

choice! {
    /// Method of interpolating vertex attributes across a triangle.
    pub Interpolation {
        Affine = "affine", "Affine",
            "Attributes vary linearly in screen space: wrong in perspective (textures swim and kink).";
        Perspective = "perspective", "Perspective-correct",
            "Attributes vary linearly in 3D space: weights are divided by w and normalised.";
        Published = "published", "Affine (as published)",
            "Wrong on purpose: affine weights by a formula that divides by the width of one edge and fails where that \
             edge is vertical.";
    }
}

choice! {
    /// Texture filter, which computes colours between texel centres.
    pub TexelFilter {
        Point = "point", "Point", "Nearest texel: blocky up close, shimmers in the distance.";
        Bilinear = "bilinear", "Bilinear",
            "Four surrounding texels, weighted by distance: smooth up close, still shimmers in the distance.";
        Trilinear = "trilinear", "Trilinear, mip-mapped",
            "Blends bilinear samples of the two mip levels whose texels are nearest to a pixel's size: no moiré or \
             shimmer in the distance, but oblique surfaces blur.";
        Anisotropic = "anisotropic", "Anisotropic, mip-mapped",
            "Averages several trilinear samples along the major axis of a pixel's footprint: oblique surfaces stay \
             sharp and free of moiré, but a pixel reads many texels.", also ["af"];
    }
}

impl TexelFilter {
    /// Returns whether the filter reads mip levels, selected by the footprint of a pixel.
    pub fn reads_mip_levels(self) -> bool {
        matches!(self, Self::Trilinear | Self::Anisotropic)
    }
}

choice! {
    /// Maximum number of trilinear samples of the anisotropic texture filter in one pixel.
    pub MaxAnisotropy {
        Two = "2", "2×", "At most 2 samples: enough for surfaces that are tilted by 60°.";
        Four = "4", "4×", "At most 4 samples: enough for surfaces that are tilted by 75°.";
        Eight = "8", "8×", "At most 8 samples: enough for surfaces that are tilted by 82°.";
        Sixteen = "16", "16×", "At most 16 samples: enough for surfaces that are tilted by 86°.";
    }
}

impl MaxAnisotropy {
    /// Returns the maximum number of samples.
    pub fn samples(self) -> u32 {
        match self {
            Self::Two => 2,
            Self::Four => 4,
            Self::Eight => 8,
            Self::Sixteen => 16,
        }
    }
}

/// Range of [`Settings::mip_bias`], in mip levels.
pub const MIP_BIAS: RangeInclusive<f32> = -4.0..=4.0;

choice! {
    /// Treatment of alpha when a texture filter mixes texels.
    pub AlphaMode {
        Straight = "straight", "Straight",
            "Colour and alpha are filtered separately: the colour of texels with alpha 0 bleeds into visible edges.";
        Premultiplied = "premultiplied", "Premultiplied",
            "Colours are weighted by alpha: texels with alpha 0 contribute no colour. Opaque textures look the same \
             either way.";
    }
}

choice! {
    /// Addressing mode for texture coordinates outside of [0, 1].
    pub AddressMode {
        Clamp = "clamp", "Clamp", "Border texels extend beyond the texture.";
        Repeat = "repeat", "Repeat", "The texture repeats in both directions.";
        Mirror = "mirror", "Mirror", "The texture repeats with every second copy mirrored: no seams.";
    }
}

choice! {
    /// Colour space in which light is computed and textures are filtered.
    pub ColorSpace {
        Linear = "linear", "Linear light", "sRGB codes are decoded to linear light first: physically correct.";
        Bytes = "bytes", "sRGB",
            "Computes directly with 8-bit sRGB codes, as many simple renderers do: shading comes out too dark.";
    }
}

choice! {
    /// Order in which the fragments of blended materials are blended.
    pub BlendingOrder {
        Objects = "objects", "Objects, as submitted",
            "Blended triangles are drawn in submission order, object by object: correct only where the scene lists \
             them from far to near.";
        Triangles = "triangles", "Triangles, far to near",
            "Blended triangles are sorted by the mean distance of their vertices: wrong where large triangles lie next \
             to small ones or intersect.";
        Exact = "exact", "Fragments, far to near",
            "The fragments of each sample are collected and sorted by depth before blending (A-buffer): always \
             correct, but slower.";
    }
}

/// Depth bias: offset added to the depths of each triangle before the depth test, like Vulkan's `vkCmdSetDepthBias` and
/// OpenGL's `glPolygonOffset`.
///
/// The offset is `slope` · m + `constant` · r. m is the greatest change of the triangle's depth per pixel along x or y,
/// and r is the smallest difference that the depth format resolves. The offset is added to the depth as it is stored:
/// positive numbers move surfaces away from the viewer, or towards the viewer if depth is reversed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DepthBias {
    /// Factor of r, the smallest depth difference that the format resolves. For floats, r is the unit in the last place
    /// of the triangle's greatest depth; for integer formats, one step.
    pub constant: f32,
    /// Factor of m, the greatest change of the triangle's depth per pixel along x or y.
    pub slope: f32,
}

/// Settings for drawing blended materials.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Blending {
    /// Order in which fragments are blended.
    pub order: BlendingOrder,
}

impl Default for Blending {
    fn default() -> Self {
        Self { order: BlendingOrder::Triangles }
    }
}

/// Directional light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// World-space direction towards the light, not necessarily of unit length.
    pub direction: Vec3,
    /// Ambient fraction of the light, in [0, 1], which reaches every surface. The rest is diffuse: it is multiplied by
    /// the cosine of the angle between the normal and the direction towards the light.
    pub ambient: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self { direction: Vec3::new(0.4, 0.7, 0.6), ambient: 0.2 }
    }
}

/// Procedural checkerboard pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checker {
    /// Number of squares per unit of texture coordinate.
    pub squares: f32,
    /// Colour of the square at the origin, as sRGB values in [0, 1].
    pub even: Vec3,
    /// Colour of the other squares, as sRGB values in [0, 1].
    pub odd: Vec3,
}

impl Default for Checker {
    fn default() -> Self {
        Self { squares: 8.0, even: Vec3::splat(0.92), odd: Vec3::splat(0.12) }
    }
}

/// All settings of the pipeline, from vertices to drawn pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Culling of triangles by their facing.
    pub culling: Culling,
    /// Algorithm that finds covered samples.
    pub rasterizer: Rasterizer,
    /// Arithmetic in which edge functions are computed to decide coverage.
    pub arithmetic: Arithmetic,
    /// Fill rule: decides whether a triangle owns a pixel centre that lies exactly on one of its edges.
    pub fill_rule: FillRule,
    /// Depth test that a fragment must pass to be drawn.
    pub depth_test: DepthTest,
    /// Format of the stored depths.
    pub depth_format: DepthFormat,
    /// Offset added to depths before the depth test.
    pub depth_bias: DepthBias,
    /// Method of interpolating vertex attributes across a triangle.
    pub interpolation: Interpolation,
    /// Source of a fragment's colour.
    pub shading: Shading,
    /// Pattern of [`Shading::Checker`].
    pub checker: Checker,
    /// Directional light of the shading modes with lighting.
    pub light: Light,
    /// Texture filter, which computes colours between texel centres.
    pub filter: TexelFilter,
    /// Maximum number of samples per pixel of [`TexelFilter::Anisotropic`].
    pub max_anisotropy: MaxAnisotropy,
    /// Number added to the level of detail of mip-mapped textures, in levels, in [`MIP_BIAS`]. Negative values read finer
    /// levels: sharper, but with moiré. Temporal upscalers, which see each surface at several sample positions, want
    /// log₂(drawn width / full width) − 1.
    pub mip_bias: f32,
    /// Addressing mode for texture coordinates outside of [0, 1].
    pub address: AddressMode,
    /// Treatment of alpha when a texture filter mixes texels.
    pub alpha: AlphaMode,
    /// Colour space in which light is computed and textures are filtered.
    pub color_space: ColorSpace,
    /// Settings for drawing blended materials.
    pub blending: Blending,
    /// Colour of the pixels that no triangle covers.
    pub background: Background,
    /// Optimisation to disable: the chosen parts of the pipeline run even in draws that do not need them.
    pub force: DisabledOptimisation,
    /// Whether [`Shading::TriangleId`] writes the id itself, as four bytes, least significant first, instead of a colour
    /// that represents it. For internal passes; not serialized.
    #[serde(skip)]
    pub exact_ids: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            culling: Culling::Back,
            rasterizer: Rasterizer::BoundingBox,
            arithmetic: Arithmetic::Fixed,
            fill_rule: FillRule::TopLeft,
            depth_test: DepthTest::Less,
            depth_format: DepthFormat::F32,
            depth_bias: DepthBias::default(),
            interpolation: Interpolation::Perspective,
            shading: Shading::Lambert,
            checker: Checker::default(),
            light: Light::default(),
            filter: TexelFilter::Bilinear,
            max_anisotropy: MaxAnisotropy::Sixteen,
            mip_bias: 0.0,
            address: AddressMode::Repeat,
            alpha: AlphaMode::Straight,
            color_space: ColorSpace::Linear,
            blending: Blending::default(),
            background: Background::Scene,
            force: DisabledOptimisation::Nothing,
            exact_ids: false,
        }
    }
}

impl Settings {
    /// Returns the colour of the pixels that no triangle covers. `of_scene` is the background colour of the scene, as sRGB
    /// codes.
    pub(crate) fn clear_color(&self, of_scene: [u8; 3]) -> Rgba8 {
        let [r, g, b] = self.background.resolve(of_scene);
        [r, g, b, 255]
    }

    /// Returns the rules that decide which samples a triangle covers.
    pub(crate) fn coverage_rules(&self) -> CoverageRules {
        let Self { rasterizer, arithmetic, fill_rule, .. } = *self;
        CoverageRules { rasterizer, arithmetic, fill_rule }
    }

    /// Returns whether depth is reversed, so that nearer surfaces have larger stored depths.
    pub fn reversed(&self) -> bool {
        self.depth_format.mapping().is_reversed()
    }
}
