//! Shading: from interpolated attributes to the colour of a fragment.
//!
//! Light is ambient + (1 − ambient)·max(0, N·L), with N normalised after interpolation and L of unit length. Cel shading
//! takes the light texture where N·L > 0.5 (60° with unit vectors) and the dark one elsewhere. Colours are computed in
//! linear light, or directly on the codes, by the colour space; the views of single quantities (normals, texture
//! coordinates, weights …) are codes and know no light.

use std::ops::{Add, Mul};

use glam::Vec3;

use super::depth::depth_at;
use super::interpolate::{Attributes, Fragment};
use super::plan::{DrawPlan, Part};
use super::sample::Sampler;
use super::settings::{ColorSpace, Filter, Settings, Shading};
use super::viewport::ScreenTriangle;
use crate::image::color::{Tables, decode_rgb, quantize};
use crate::image::{Image, Rgba8};
use crate::math::unit_or;
use crate::scene::material::CUT_OUT_BELOW;
use crate::scene::{Instance, Library, Texture, Transparency, TriangleId};

/// N·L above which cel shading takes the light texture.
pub const CEL_THRESHOLD: f32 = 0.5;

/// What the light colour is multiplied with on the dark side of a material that has no dark texture.
pub const CEL_DARK_FACTOR: f32 = 0.45;

/// Light on a surface: ambient + (1 − ambient)·max(0, N·L) for unit vectors.
#[inline]
pub fn lambert(normal: Vec3, light_direction: Vec3, ambient: f32) -> f32 {
    ambient + (1.0 - ambient) * normal.dot(light_direction).max(0.0)
}

/// A texture with the smaller copies of it that its filter reads.
#[derive(Clone, Copy, Debug)]
pub struct Readable<'a> {
    image: &'a Image<Rgba8>,
    /// Each half as long as the last; none unless they are read.
    smaller: &'a [Image<Rgba8>],
    mips: bool,
}

impl<'a> Readable<'a> {
    fn new(texture: &'a Texture, settings: &Settings) -> Self {
        let mips = settings.filter == Filter::Trilinear;
        let smaller = if mips { texture.smaller(settings.color_space == ColorSpace::Linear) } else { &[] };
        Self { image: texture.image(), smaller, mips }
    }

    /// The texture itself at level 0, or one of its copies.
    pub fn level(&self, level: usize) -> &'a Image<Rgba8> {
        level.checked_sub(1).and_then(|level| self.smaller.get(level)).unwrap_or(self.image)
    }

    /// The levels that are read for a fragment, and their shares; one alone without mip-mapping.
    pub fn levels(&self, fragment: &Fragment) -> ([(usize, f32); 2], usize) {
        if self.mips {
            (Sampler::levels(self.image.size(), self.smaller.len(), fragment.uv_gradient), 2)
        } else {
            ([(0, 1.0); 2], 1)
        }
    }

    /// What `read` finds in the levels of a fragment, weighted.
    #[cold]
    fn mixed<T: Mul<f32, Output = T> + Add<Output = T>>(
        &self,
        fragment: &Fragment,
        read: impl Fn(&Image<Rgba8>) -> T,
    ) -> T {
        let ([(fine, share), (coarse, rest)], _) = self.levels(fragment);
        read(self.level(fine)) * share + read(self.level(coarse)) * rest
    }

    #[inline(always)] // One of several callers is the loop over opaque samples, where a call shows.
    fn color(&self, sampler: Sampler, fragment: &Fragment) -> Vec3 {
        if self.mips {
            return self.mixed(fragment, |image| sampler.sample(image, fragment.uv));
        }
        sampler.sample(self.image, fragment.uv)
    }

    #[inline(always)]
    fn alpha(&self, sampler: Sampler, fragment: &Fragment) -> f32 {
        if self.mips {
            return self.mixed(fragment, |image| sampler.alpha(image, fragment.uv));
        }
        sampler.alpha(self.image, fragment.uv)
    }

    #[inline(always)]
    fn color_and_alpha(&self, sampler: Sampler, fragment: &Fragment) -> (Vec3, f32) {
        if self.mips {
            return (self.color(sampler, fragment), self.alpha(sampler, fragment));
        }
        sampler.sample_with_alpha(self.image, fragment.uv)
    }
}

/// Everything that shading one draw needs: settings, light and the material's textures, looked up once.
#[derive(Clone, Copy, Debug)]
pub struct Shader<'a> {
    pub(super) settings: &'a Settings,
    sampler: Sampler,
    tables: &'static Tables,
    pub(crate) light_direction: Vec3,
    /// Material colour × tint, in the numbers of the colour space.
    pub(crate) diffuse: Vec3,
    pub(super) texture: Option<Readable<'a>>,
    dark_texture: Option<Readable<'a>>,
    /// Of the material alone.
    opacity: f32,
    transparency: Transparency,
    attributes: Attributes,
}

impl<'a> Shader<'a> {
    /// For one instance.
    pub fn new(settings: &'a Settings, library: &'a Library, instance: &Instance, plan: &DrawPlan) -> Self {
        let material = library.material(instance.material);
        let image = |id| Readable::new(library.texture(id), settings);
        let reads_texels = plan.runs(Part::Texels);
        Self {
            settings,
            sampler: Sampler::new(settings.filter, settings.address, settings.color_space),
            tables: Tables::get(),
            light_direction: unit_or(settings.light.direction.as_dvec3(), Vec3::Y),
            diffuse: to_working_space(material.diffuse * instance.tint, settings.color_space),
            texture: material.texture.filter(|_| reads_texels).map(image),
            dark_texture: material.dark_texture.filter(|_| reads_texels).map(image),
            opacity: material.opacity,
            transparency: plan.transparency(),
            attributes: Attributes::read_by(plan, settings),
        }
    }

    /// How its fragments meet what is drawn already.
    #[inline]
    pub fn transparency(&self) -> Transparency {
        self.transparency
    }

    /// The opacity of the material alone.
    pub(crate) fn opacity(&self) -> f32 {
        self.opacity
    }

    /// What its fragments are made of.
    #[inline]
    pub fn attributes(&self) -> Attributes {
        self.attributes
    }

    /// The texture that is read for a fragment, if any.
    pub fn texture_for(&self, fragment: &Fragment) -> Option<Readable<'a>> {
        if self.settings.shading == Shading::Cel && !self.is_lit(fragment) {
            self.dark_texture.or(self.texture)
        } else {
            self.texture
        }
    }

    /// How that texture is read.
    pub fn sampler(&self) -> Sampler {
        self.sampler
    }

    /// The unit normal of a fragment; zero where it has none, so that no direct light reaches it.
    #[inline]
    pub fn unit_normal(&self, fragment: &Fragment) -> Vec3 {
        fragment.normal.normalize_or_zero()
    }

    /// N·L of a fragment, in [−1, 1].
    #[inline]
    pub fn cosine(&self, fragment: &Fragment) -> f32 {
        self.unit_normal(fragment).dot(self.light_direction)
    }

    /// The factor that light multiplies a fragment's colour with; 1 for unlit shadings.
    pub fn light(&self, fragment: &Fragment) -> f32 {
        match self.settings.shading {
            Shading::Gouraud => fragment.light,
            Shading::Lambert => lambert(self.unit_normal(fragment), self.light_direction, self.settings.light.ambient),
            Shading::Cel if self.dark_texture.is_none() && !self.is_lit(fragment) => CEL_DARK_FACTOR,
            _ => 1.0,
        }
    }

    /// The share in [0, 1] with which a blended fragment covers what lies behind: the material's opacity × the alpha of
    /// the texture, if one is read.
    #[inline]
    pub fn alpha(&self, fragment: &Fragment) -> f32 {
        self.texture_for(fragment).map_or(self.opacity, |texture| self.opacity * texture.alpha(self.sampler, fragment))
    }

    /// Whether a fragment of a cut-out surface is not there.
    #[inline]
    pub fn cuts_out(&self, fragment: &Fragment) -> bool {
        self.alpha(fragment) < CUT_OUT_BELOW
    }

    /// Colour of a blended fragment of `triangle` over what is drawn there: colour·α + below·(1 − α) in the numbers of the
    /// colour space, with [`Shader::alpha`]. The views of single quantities cover what is `below`.
    #[inline]
    pub fn blend(&self, fragment: &Fragment, triangle: &ScreenTriangle, below: Rgba8) -> Rgba8 {
        if !self.settings.shading.reads_material() {
            return self.shade(fragment, triangle);
        }
        self.encode(self.mixed_over(fragment, below))
    }

    /// The colour of a blended fragment over what lies `below` it, in the numbers of the colour space, before it is encoded.
    #[inline(always)]
    pub(crate) fn mixed_over(&self, fragment: &Fragment, below: Rgba8) -> Vec3 {
        let (albedo, alpha) = self.albedo_and_alpha(fragment);
        albedo * self.light(fragment) * alpha + self.sampler.value_of(below) * (1.0 - alpha)
    }

    /// Colour of a fragment of `triangle` as if nothing could be seen through it.
    #[inline]
    pub fn shade(&self, fragment: &Fragment, triangle: &ScreenTriangle) -> Rgba8 {
        match self.settings.shading {
            Shading::Texture | Shading::Gouraud | Shading::Lambert | Shading::Cel => {
                self.encode(self.reflected(fragment))
            }
            Shading::VertexColor => self.encode(fragment.color),
            Shading::Checker => quantized(self.checker(fragment)),
            Shading::Normals => quantized(self.unit_normal(fragment) * 0.5 + 0.5),
            Shading::Uv => quantized(Vec3::new(fragment.uv.x.rem_euclid(1.0), fragment.uv.y.rem_euclid(1.0), 0.0)),
            Shading::Barycentric => quantized(fragment.source_weights),
            Shading::Depth => quantized(Vec3::splat(depth_at(triangle, &fragment.sample))),
            Shading::TriangleId => id_color(triangle.id),
            Shading::ObjectId => id_color(TriangleId(triangle.instance)),
        }
    }

    /// The colour of every sample of a triangle of an instance, for shadings that show nothing that varies over it.
    pub fn flat_color(&self, id: TriangleId, instance: u32) -> Option<Rgba8> {
        match self.settings.shading {
            Shading::TriangleId => Some(id_color(id)),
            Shading::ObjectId => Some(id_color(TriangleId(instance))),
            _ => None,
        }
    }

    /// The light that the surface gives back, in the numbers of the colour space, before it is encoded.
    #[inline(always)]
    pub(crate) fn reflected(&self, fragment: &Fragment) -> Vec3 {
        self.albedo(fragment) * self.light(fragment)
    }

    /// Surface colour without light, in the numbers of the colour space.
    #[inline]
    pub(crate) fn albedo(&self, fragment: &Fragment) -> Vec3 {
        let plain = self.plain_albedo(fragment);
        match self.texture_for(fragment) {
            Some(texture) => plain * texture.color(self.sampler, fragment),
            None => plain,
        }
    }

    /// Surface colour without light and texture.
    #[inline]
    pub(crate) fn plain_albedo(&self, fragment: &Fragment) -> Vec3 {
        if self.attributes.color { self.diffuse * fragment.color } else { self.diffuse }
    }

    /// The same surface colour, and the share with which it covers what lies behind.
    #[inline]
    fn albedo_and_alpha(&self, fragment: &Fragment) -> (Vec3, f32) {
        let plain = self.plain_albedo(fragment);
        match self.texture_for(fragment) {
            Some(texture) => {
                let (color, alpha) = texture.color_and_alpha(self.sampler, fragment);
                (plain * color, self.opacity * alpha)
            }
            None => (plain, self.opacity),
        }
    }

    #[inline]
    fn is_lit(&self, fragment: &Fragment) -> bool {
        self.cosine(fragment) > CEL_THRESHOLD
    }

    #[inline(always)] // One of several callers is the loop over opaque samples, where a call shows.
    fn encode(&self, color: Vec3) -> Rgba8 {
        match self.settings.color_space {
            ColorSpace::Linear => {
                let [r, g, b] = color.to_array().map(|c| self.tables.encode(c));
                [r, g, b, 255]
            }
            ColorSpace::Bytes => quantized(color),
        }
    }

    fn checker(&self, fragment: &Fragment) -> Vec3 {
        let checker = &self.settings.checker;
        let square = (fragment.uv * checker.squares).floor();
        if (square.x + square.y).rem_euclid(2.0) == 0.0 { checker.even } else { checker.odd }
    }
}

/// sRGB values in the numbers that light is computed in.
pub fn to_working_space(srgb: Vec3, space: ColorSpace) -> Vec3 {
    match space {
        ColorSpace::Linear => decode_rgb(srgb),
        ColorSpace::Bytes => srgb,
    }
}

fn quantized(color: Vec3) -> Rgba8 {
    [quantize(color.x), quantize(color.y), quantize(color.z), 255]
}

/// A colour for a triangle's number: neighbours differ, and none is too dark to see.
pub fn id_color(id: TriangleId) -> Rgba8 {
    // Fibonacci hashing (Knuth, The Art of Computer Programming 3, 6.4): consecutive numbers spread far apart.
    let hash = id.0.wrapping_add(1).wrapping_mul(0x9E37_79B9);
    let [a, b, c, _] = (hash ^ hash >> 15).to_be_bytes();
    let visible = |byte: u8| 64 + (u16::from(byte) * 191 / 255) as u8;
    [visible(a), visible(b), visible(c), 255]
}
