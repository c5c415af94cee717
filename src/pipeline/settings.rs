//! Every decision of the pipeline as plain data: one enum per decision, each variant with the name and the one
//! sentence that menus, tooltips and the command line show.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::background::Background;
use super::depth::DepthEncoding;
use crate::scene::DepthMapping;

/// A closed set of alternatives that a person picks from.
pub trait Choice: Copy + PartialEq + 'static {
    /// All alternatives, in the order in which menus list them.
    const ALL: &'static [Self];

    /// The word in files and on the command line; kebab case.
    fn id(self) -> &'static str;

    /// What a person calls it.
    fn name(self) -> &'static str;

    /// One sentence: what it does.
    fn help(self) -> &'static str;
}

/// Declares an enum of alternatives with id, name and help, and its [`Choice`].
macro_rules! choice {
    ($(#[$meta:meta])* $enum:ident { $($variant:ident = $id:literal, $name:literal, $help:literal;)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        pub enum $enum {
            $(#[doc = $help] #[serde(rename = $id)] $variant,)+
        }

        impl Choice for $enum {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn id(self) -> &'static str {
                match self { $(Self::$variant => $id),+ }
            }

            fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            fn help(self) -> &'static str {
                match self { $(Self::$variant => $help),+ }
            }
        }
    };
}

pub(crate) use choice;

choice! {
    /// How the pipeline is executed. The picture is the same, bit for bit; the time is not.
    Execution {
        Tiled = "tiled", "Tiled", "Tile by tile, several samples at a time, on all threads; each visible sample is shaded once.";
        Classic = "classic", "Classic", "Triangle after triangle through every stage, on one thread: what the stages and rasterizers can be told apart with.";
    }
}

choice! {
    /// What runs although a draw could do without it. The picture is the same; what the plan saves shows in the time.
    Force {
        Nothing = "nothing", "Nothing", "Every draw leaves out what it does not need.";
        Everything = "everything", "Everything", "All of the following run where they can.";
        Vertices = "vertices", "Vertices", "Objects that are wholly outside of the view are transformed and clipped.";
        Clusters = "clusters", "Every cluster", "Clusters of triangles of a large object that are wholly outside of the view, or turned away, are transformed and culled one by one.";
        Clipping = "clipping", "Clipping", "Triangles of objects that are wholly inside of the view are tested against its planes.";
        PerspectiveDivision = "perspective-division", "Perspective division", "Weights are divided by w in orthographic views too, where all w are equal.";
        TextureCoordinates = "texture-coordinates", "Texture coordinates", "Texture coordinates are fetched and interpolated even if none is read.";
        Normals = "normals", "Normals", "Normals are transformed and interpolated even if none is read.";
        VertexColors = "vertex-colors", "Vertex colours", "Vertex colours are fetched and interpolated even if none is read.";
    }
}

choice! {
    /// Which triangles are dropped because of the side that they show.
    Culling {
        None = "none", "None", "Both sides are drawn.";
        Back = "back", "Back", "Triangles that turn their back are dropped: in a closed body they are always hidden.";
        Front = "front", "Front", "Triangles that face the viewer are dropped: one looks into bodies.";
    }
}

choice! {
    /// How the samples inside a triangle are found. But for the two that are kept as published, the samples are the same; the
    /// work is not.
    Rasterizer {
        BoundingBox = "bounding-box", "Bounding box", "Every pixel of the box around a triangle is tested against its three edges: the plainest way.";
        Scanline = "scanline", "Scanline", "The triangle is split at its middle corner; on each row the first and last pixel inside are computed, and only those between are visited.";
        EdgeWalk = "edge-walk", "Edge walk", "Down the longest edge, and on each row from there towards the other two edges until the triangle ends.";
        ActiveEdge = "active-edge", "Active edge list", "Edges step down row by row by their slope, and each row is filled between the two that are active.";
        Tiled = "tiled", "Tiled", "Squares of 64 and 8 pixels are taken or left as a whole; only those that an edge runs through are looked at pixel by pixel.";
        BoundingBoxPublished = "bounding-box-published", "Bounding box (as published)", "Faulty, to show it: samples at the corners of pixels, shared edges drawn twice, clockwise triangles not drawn at all.";
        ScanlinePublished = "scanline-published", "Scanline (as published)", "Faulty, to show it: a rounded fourth corner, rows that start at the corner instead of at the row's centre, both ends drawn.";
    }
}

impl Rasterizer {
    /// Those that are meant to be right.
    pub fn sound() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|rasterizer| !rasterizer.is_published())
    }

    /// Whether it is one that is kept with the faults that it is commonly published with.
    pub fn is_published(self) -> bool {
        matches!(self, Self::BoundingBoxPublished | Self::ScanlinePublished)
    }
}

choice! {
    /// The numbers that coverage is decided in.
    Arithmetic {
        Fixed = "fixed", "24.8 fixed point", "Corners are snapped to 1/256 px; from there on everything is exact integers, as in hardware.";
        F32 = "f32", "f32", "Single-precision floats on corners as they are: a pixel centre close to an edge may fall on the wrong side.";
        F64 = "f64", "f64", "Double-precision floats on corners as they are: wrong only where numbers differ by many orders of magnitude.";
        Exact = "exact", "Exact", "Corners as they are, and every decision exact, by adaptive predicates: the truth, and slower.";
    }
}

choice! {
    /// Who owns a pixel centre that lies exactly on an edge.
    FillRule {
        TopLeft = "top-left", "Top-left", "A centre on an edge belongs to the triangle whose top or left edge it is. Shared edges are drawn exactly once.";
        TopRight = "top-right", "Top-right", "The mirror of top-left in x. Also draws shared edges exactly once.";
        BottomLeft = "bottom-left", "Bottom-left", "The mirror of top-left in y, as an API with y up has it. Also draws shared edges exactly once.";
        BottomRight = "bottom-right", "Bottom-right", "The mirror of top-left in x and y. Also draws shared edges exactly once.";
        Inclusive = "inclusive", "Inclusive", "Every centre on an edge is drawn. Wrong on purpose: shared edges are drawn twice.";
        Exclusive = "exclusive", "Exclusive", "No centre on an edge is drawn. Wrong on purpose: shared edges leave cracks.";
    }
}

impl FillRule {
    /// Whether it gives a centre on an edge that two triangles share to exactly one of them.
    pub fn is_sound(self) -> bool {
        !matches!(self, Self::Inclusive | Self::Exclusive)
    }
}

choice! {
    /// When a fragment may replace what the depth buffer holds. Named for standard depth; reversed depth mirrors it.
    DepthTest {
        Off = "off", "Off", "The last triangle drawn wins (painter's order). No depth buffer is kept.";
        Less = "less", "Less", "Nearer than what is stored wins; at equal depth the first one drawn stays.";
        LessEqual = "less-equal", "Less or equal", "Nearer wins; at equal depth the last one drawn wins.";
        Greater = "greater", "Greater", "Farther wins: one sees the back of the scene. The buffer starts at the near plane.";
        Always = "always", "Always", "Every fragment is written, and so is its depth.";
    }
}

choice! {
    /// What the depth buffer stores.
    DepthFormat {
        F32 = "f32", "f32", "z/w as a float, 0 at the near plane and 1 at the far plane. Most of its precision crowds at the near plane.";
        ReversedF32 = "reversed-f32", "Reversed f32", "z/w as a float, 1 near and 0 far: floats are finest where perspective is coarsest, so far surfaces fight less.";
        ReversedInfinite = "reversed-infinite", "Reversed, infinite far", "Reversed f32 with the far plane at infinity: nothing is too far to be drawn. Without perspective it is reversed f32.";
        Unorm24 = "unorm24", "unorm24", "z/w in 24-bit steps, 0 near and 1 far, as graphics cards keep it: in perspective nearly all steps lie close to the near plane.";
        Unorm16 = "unorm16", "unorm16", "z/w in 16-bit steps, 0 near and 1 far: surfaces fight wherever they are close to each other.";
        WBuffer = "w-buffer", "w-buffer", "The distance itself as a float, 0 at the near plane and 1 at the far plane: its steps are finest at the near plane and at most 2⁻²³ of the distance from it.";
    }
}

choice! {
    /// How attributes follow the screen.
    Interpolation {
        Affine = "affine", "Affine", "Attributes change linearly on the screen: wrong in perspective (textures swim and kink).";
        Perspective = "perspective", "Perspective-correct", "Attributes change linearly in space: weights are divided by w and normalised.";
        Published = "published", "Affine (as published)", "Faulty, to show it: affine weights by a formula that divides by the width of one edge, and fails where that edge is vertical.";
    }
}

choice! {
    /// What colours a fragment.
    Shading {
        Texture = "texture", "Texture, unlit", "Texture × material colour, no light.";
        VertexColor = "vertex-color", "Vertex colour", "The colours given at the vertices, interpolated, no light.";
        Gouraud = "gouraud", "Gouraud", "Light is computed at the vertices and interpolated: highlights depend on the mesh.";
        Lambert = "lambert", "Lambert", "The normal is interpolated and light computed in every pixel.";
        BlinnPhong = "blinn-phong", "Blinn–Phong", "Lambert plus a highlight: Ks·max(0, N·H)^Ns, with H halfway between the directions to the light and to the eye.";
        Cel = "cel", "Cel", "Two textures: the light one where N·L > 0.5, the dark one elsewhere.";
        Checker = "checker", "Checker", "A chess pattern computed from the texture coordinates, no texture read.";
        Normals = "normals", "Normals", "The unit normal as colour: x, y, z from −1…1 to 0…255.";
        Uv = "uv", "Texture coordinates", "Fraction of u as red, of v as green.";
        Barycentric = "barycentric", "Barycentric", "The weights λ0, λ1, λ2 as red, green, blue.";
        Depth = "depth", "Depth", "The value that the depth buffer would store, as grey.";
        TriangleId = "triangle-id", "Triangle id", "One colour per triangle, by hashing its number.";
        ObjectId = "object-id", "Object id", "One colour per object, by hashing its number.";
    }
}

impl Shading {
    /// Whether it shows the material's colour and texture, and with them its opacity; the others show something else, and
    /// are opaque.
    pub fn reads_material(self) -> bool {
        matches!(self, Self::Texture | Self::Gouraud | Self::Lambert | Self::BlinnPhong | Self::Cel)
    }

    /// Whether light is computed.
    pub fn is_lit(self) -> bool {
        self == Self::Gouraud || self.is_lit_per_pixel()
    }

    /// Whether light is computed in every pixel, from an interpolated normal.
    pub fn is_lit_per_pixel(self) -> bool {
        matches!(self, Self::Lambert | Self::BlinnPhong | Self::Cel)
    }

    /// Whether it reads the normal of every pixel, and with it normal maps.
    pub fn reads_pixel_normals(self) -> bool {
        self == Self::Normals || self.is_lit_per_pixel()
    }
}

choice! {
    /// How a texture is read between texel centres.
    Filter {
        Point = "point", "Point", "The nearest texel: sharp squares near, glitter far.";
        Bilinear = "bilinear", "Bilinear", "The four texels around, weighted by nearness: smooth near, still glitters far.";
        Trilinear = "trilinear", "Trilinear, mip-mapped", "Bilinear in the two copies of the texture whose texels come nearest to a pixel's size, weighted: no moiré and no glitter far away, but slanted surfaces blur.";
    }
}

choice! {
    /// How texels with alpha are mixed by a texture filter.
    AlphaMode {
        Straight = "straight", "Straight", "Colour and alpha are filtered apart: the colour of texels with alpha 0 bleeds into the edges of what is visible.";
        Premultiplied = "premultiplied", "Premultiplied", "Each texel's colour counts by its alpha: texels with alpha 0 tint nothing. Opaque textures look the same either way.";
    }
}

choice! {
    /// What texture coordinates outside of 0…1 mean.
    Address {
        Clamp = "clamp", "Clamp", "The border texel goes on for ever.";
        Repeat = "repeat", "Repeat", "The texture is laid like tiles.";
        Mirror = "mirror", "Mirror", "Like tiles, every second one mirrored: no seams.";
    }
}

choice! {
    /// In which numbers light is computed and textures are filtered.
    ColorSpace {
        Linear = "linear", "Linear light", "Codes are decoded to linear light first, as physics asks.";
        Bytes = "bytes", "Bytes", "Directly on the 8-bit codes, as many simple renderers do: light falls off too dark.";
    }
}

choice! {
    /// The order in which the fragments of blended materials are blended over what lies behind them.
    BlendingOrder {
        Objects = "objects", "Objects, as submitted", "Blended triangles are drawn in submission order, object by object: right only where the scene lists them from far to near.";
        Triangles = "triangles", "Triangles, far to near", "Blended triangles are sorted by the mean distance of their corners: wrong where large triangles lie beside small ones or intersect.";
        Exact = "exact", "Fragments, far to near", "The fragments of every sample are collected and sorted by depth before they are blended (A-buffer): always right, and slower.";
    }
}

/// Depth bias: what is added to the depths of each triangle before they are tested, as by Vulkan's `vkCmdSetDepthBias` and by
/// `glPolygonOffset`.
///
/// The offset is `slope` · m + `constant` · r, for the greatest change m of the triangle's depth per px along x or y, and the
/// smallest difference r that the depth format resolves. It is added to the depth as it is stored: positive numbers move
/// surfaces away from the viewer, and towards the viewer where depth is reversed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DepthBias {
    /// Factor of the smallest resolvable difference r: the last place of the triangle's greatest depth where depths are floats,
    /// one code where they are codes.
    pub constant: f32,
    /// Factor of the slope m.
    pub slope: f32,
}

/// How blended materials are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Blending {
    /// The order of blended fragments.
    pub order: BlendingOrder,
}

impl Default for Blending {
    fn default() -> Self {
        Self { order: BlendingOrder::Triangles }
    }
}

/// A directional light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Towards the light, world space; need not be of unit length.
    pub direction: Vec3,
    /// Share of light that reaches every surface, in [0, 1]; the rest goes by the cosine.
    pub ambient: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self { direction: Vec3::new(0.4, 0.7, 0.6), ambient: 0.2 }
    }
}

/// The user's procedural pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checker {
    /// Squares per unit of texture coordinate.
    pub squares: f32,
    /// sRGB values of the square at the origin.
    pub even: Vec3,
    /// sRGB values of the other square.
    pub odd: Vec3,
}

impl Default for Checker {
    fn default() -> Self {
        Self { squares: 8.0, even: Vec3::splat(0.92), odd: Vec3::splat(0.12) }
    }
}

/// All decisions from vertices to drawn pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Facing.
    pub culling: Culling,
    /// How covered samples are found.
    pub rasterizer: Rasterizer,
    /// Numbers that coverage is decided in.
    pub arithmetic: Arithmetic,
    /// Ownership of edges.
    pub fill_rule: FillRule,
    /// Visibility.
    pub depth_test: DepthTest,
    /// Stored depth.
    pub depth_format: DepthFormat,
    /// Offset of depths before the test.
    pub depth_bias: DepthBias,
    /// Attributes.
    pub interpolation: Interpolation,
    /// Colour.
    pub shading: Shading,
    /// Pattern of [`Shading::Checker`].
    pub checker: Checker,
    /// Light of the lit shadings.
    pub light: Light,
    /// Texture filter.
    pub filter: Filter,
    /// Texture addressing.
    pub address: Address,
    /// How texels with alpha are mixed.
    pub alpha: AlphaMode,
    /// Numbers that light is computed in.
    pub color_space: ColorSpace,
    /// Blended materials.
    pub blending: Blending,
    /// Colour of the pixels that no triangle covers.
    pub background: Background,
    /// What runs without need.
    pub force: Force,
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
            filter: Filter::Bilinear,
            address: Address::Repeat,
            alpha: AlphaMode::Straight,
            color_space: ColorSpace::Linear,
            blending: Blending::default(),
            background: Background::Scene,
            force: Force::Nothing,
        }
    }
}

impl DepthFormat {
    /// Which depth a distance has.
    pub fn mapping(self) -> DepthMapping {
        match self {
            Self::F32 | Self::Unorm24 | Self::Unorm16 => DepthMapping::Standard,
            Self::ReversedF32 => DepthMapping::Reversed,
            Self::ReversedInfinite => DepthMapping::ReversedInfinite,
            Self::WBuffer => DepthMapping::Linear,
        }
    }

    /// In which numbers depths are stored.
    pub fn encoding(self) -> DepthEncoding {
        match self {
            Self::F32 | Self::ReversedF32 | Self::ReversedInfinite | Self::WBuffer => DepthEncoding::F32,
            Self::Unorm24 => DepthEncoding::Unorm24,
            Self::Unorm16 => DepthEncoding::Unorm16,
        }
    }
}

impl Settings {
    /// Whether depth is stored reversed: nearer is larger.
    pub fn reversed(&self) -> bool {
        self.depth_format.mapping().is_reversed()
    }
}
