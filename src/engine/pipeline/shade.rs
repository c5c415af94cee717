//! Shading: from interpolated attributes to the colour of a fragment.
//!
//! [`super::shading`] declares the shadings and their kernels; this module computes what all of them share. The colour
//! space decides whether colours are computed in linear light or directly on sRGB codes. Shading modes that show a
//! single quantity (normals, texture coordinates, weights …) are written directly as 8-bit codes.
//!
//! All shading modes that use the material add its emission last.

mod blinn_phong;
mod inputs;
mod normal_map;
mod readable;
mod surface;

pub(crate) use blinn_phong::EyeDirections;
pub(crate) use blinn_phong::Highlight;
use glam::Vec3;
use inputs::FragmentInputs;
pub(crate) use normal_map::NormalMap;
pub(crate) use readable::Readable;
pub(crate) use surface::PlacedMesh;

use super::formulas::blended;
use super::interpolate::{AttributeSelection, Fragment};
use super::plan::{DrawPlan, PipelinePart};
use super::sample::Sampler;
use super::screen_triangle::ScreenTriangle;
use super::settings::{AddressMode, ColorSpace, Settings};
pub(crate) use super::shading::id_color;
use super::shading::{FlatInputs, Input, ShadingKind, cel};
use crate::image::Rgba8;
use crate::image::color::{Tables, decode_rgb, quantize};
use crate::math::unit_or;
use crate::scene::{Instance, Library, Transparency, TriangleId};

/// Inputs for shading one draw: settings, light and the material's textures, looked up once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shader<'a> {
    pub(super) settings: &'a Settings,
    sampler: Sampler,
    tables: &'static Tables,
    pub(crate) light_direction: Vec3,
    /// Diffuse colour of the material times the tint of the instance, in the working colour space.
    pub(crate) diffuse: Vec3,
    pub(super) texture: Option<Readable<'a>>,
    dark_texture: Option<Readable<'a>>,
    alpha_texture: Option<Readable<'a>>,
    normal_map: Option<NormalMap<'a>>,
    highlight: Option<Highlight<'a>>,
    /// Directions towards the eye; `None` unless the shading reads them.
    eye: Option<EyeDirections<'a>>,
    /// Emitted colour of the material, in the working colour space; `None` if it emits nothing.
    emission: Option<Vec3>,
    emission_texture: Option<Readable<'a>>,
    /// Opacity of the material in [0, 1], before it is multiplied by the alpha of textures.
    opacity: f32,
    /// Threshold of the alpha test: fragments with a lower alpha are discarded.
    alpha_cutoff: f32,
    transparency: Transparency,
    attributes: AttributeSelection,
}

impl<'a> Shader<'a> {
    /// Returns the shader for the draw of one instance.
    pub(crate) fn new(settings: &'a Settings, library: &'a Library, instance: &Instance, plan: &DrawPlan) -> Self {
        let material = library.material(instance.material);
        let image = |id| Readable::new(library.texture(id), settings);
        let reads_texels = plan.runs(PipelinePart::Texels);
        let address = if material.clamp { AddressMode::Clamp } else { settings.address };
        let mesh = || PlacedMesh::new(library, instance, plan);
        let normal_map = |id| NormalMap {
            texture: Readable::straight(library.texture(id), settings, ColorSpace::Bytes),
            sampler: Sampler::new(settings.filter, address, ColorSpace::Bytes),
            scale: material.normal_scale,
            uv_scale: material.uv_scale,
            mesh: mesh(),
        };
        let emits = plan.runs(PipelinePart::Emission);
        let eye = || EyeDirections { eye: plan.eye(), mesh: mesh() };
        Self {
            settings,
            sampler: Sampler::new(settings.filter, address, settings.color_space),
            tables: Tables::get(),
            light_direction: unit_or(settings.light.direction.as_dvec3(), Vec3::Y),
            diffuse: to_working_space(material.diffuse * instance.tint, settings.color_space),
            texture: material.texture.filter(|_| reads_texels).map(image),
            dark_texture: material.dark_texture.filter(|_| reads_texels).map(image),
            alpha_texture: material.alpha_texture.filter(|_| reads_texels).map(image),
            normal_map: material.normal_texture.filter(|_| plan.runs(PipelinePart::NormalMap)).map(normal_map),
            highlight: plan.runs(PipelinePart::Highlight).then(|| Highlight {
                specular: to_working_space(material.specular, settings.color_space),
                shininess: material.shininess,
                eye: eye(),
            }),
            eye: settings.shading.reads(Input::EyeDirection).then(eye),
            emission: emits.then(|| to_working_space(material.emission, settings.color_space)),
            emission_texture: material.emission_texture.filter(|_| emits && reads_texels).map(image),
            opacity: material.opacity,
            alpha_cutoff: material.alpha_cutoff,
            transparency: plan.transparency(),
            attributes: AttributeSelection::read_by(plan, settings),
        }
    }

    /// Returns whether the draw is opaque, alpha-tested or blended.
    #[inline]
    pub(crate) fn transparency(&self) -> Transparency {
        self.transparency
    }

    /// Returns the opacity of the material in [0, 1], before it is multiplied by the alpha of textures.
    pub(crate) fn opacity(&self) -> f32 {
        self.opacity
    }

    /// Returns the threshold of the alpha test: fragments with a lower alpha are discarded.
    #[inline]
    pub(crate) fn alpha_cutoff(&self) -> f32 {
        self.alpha_cutoff
    }

    /// Returns the attributes that the draw interpolates for its fragments.
    #[inline]
    pub(crate) fn attributes(&self) -> AttributeSelection {
        self.attributes
    }

    /// Returns the colour texture read for a fragment, or `None` if there is none.
    pub(crate) fn texture_for(&self, fragment: &Fragment) -> Option<Readable<'a>> {
        if self.settings.shading.reads(Input::DarkTexture) && !cel::is_lit(self.cosine(fragment)) {
            self.dark_texture.or(self.texture)
        } else {
            self.texture
        }
    }

    /// Returns the sampler of the colour texture.
    pub(crate) fn sampler(&self) -> Sampler {
        self.sampler
    }

    /// Returns the texture whose alpha multiplies the opacity, or `None` if none is read.
    pub(crate) fn alpha_texture(&self) -> Option<Readable<'a>> {
        self.alpha_texture
    }

    /// Returns the texture that multiplies the emitted colour, or `None` if none is read.
    pub(crate) fn emission_texture(&self) -> Option<Readable<'a>> {
        self.emission_texture
    }

    /// Returns the normal map, or `None` if it is not read.
    pub(crate) fn normal_map(&self) -> Option<&NormalMap<'a>> {
        self.normal_map.as_ref()
    }

    /// Returns the inputs of the specular highlight, or `None` if the draw has none.
    pub(crate) fn highlight(&self) -> Option<&Highlight<'a>> {
        self.highlight.as_ref()
    }

    /// Returns whether the SIMD kernels can shade the draw. They support neither emission, highlights, normal maps,
    /// opacity maps nor premultiplied filtering.
    pub(super) fn fits_lanes(&self) -> bool {
        let has_more = self.emission.is_some()
            || self.highlight.is_some()
            || self.normal_map.is_some()
            || self.alpha_texture.is_some()
            || self.texture.is_some_and(|texture| texture.is_premultiplied());
        !has_more
    }

    /// Returns the number of textures that are read per fragment.
    pub(super) fn texture_count(&self) -> u64 {
        let read = [
            self.texture.is_some(),
            self.alpha_texture.is_some(),
            self.normal_map.is_some(),
            self.emission_texture.is_some(),
        ];
        read.into_iter().map(u64::from).sum()
    }

    /// Returns the interpolated normal of a fragment, normalised, before normal mapping; zero if its length is zero.
    #[inline]
    pub(crate) fn smooth_normal(&self, fragment: &Fragment) -> Vec3 {
        fragment.normal.normalize_or_zero()
    }

    /// Returns the unit normal of a fragment after normal mapping. Without a normal map, returns zero if the
    /// interpolated normal has zero length, so that no direct light reaches the fragment.
    #[inline]
    pub(crate) fn unit_normal(&self, fragment: &Fragment) -> Vec3 {
        let smooth = self.smooth_normal(fragment);
        match &self.normal_map {
            Some(map) => map.apply(smooth, fragment),
            None => smooth,
        }
    }

    /// Returns N·L of a fragment: the cosine of the angle between its normal and the direction towards the light.
    #[inline]
    pub(crate) fn cosine(&self, fragment: &Fragment) -> f32 {
        self.unit_normal(fragment).dot(self.light_direction)
    }

    /// Returns the light intensity by which a fragment's albedo is multiplied. It is 1 in unlit shading modes.
    pub(crate) fn light(&self, fragment: &Fragment) -> f32 {
        self.settings.shading.light(&FragmentInputs { shader: self, fragment, triangle: () })
    }

    /// Returns the alpha of a fragment in [0, 1]: the material's opacity, times the alpha of the colour texture if one
    /// is read, times the alpha of the opacity texture if there is one.
    #[inline]
    pub(crate) fn alpha(&self, fragment: &Fragment) -> f32 {
        let alpha = self
            .texture_for(fragment)
            .map_or(self.opacity, |texture| self.opacity * texture.alpha(self.sampler, fragment));
        self.with_alpha_texture(alpha, fragment)
    }

    /// Returns `alpha` times the alpha of the opacity texture at a fragment, or `alpha` itself without such a texture.
    #[inline]
    fn with_alpha_texture(&self, alpha: f32, fragment: &Fragment) -> f32 {
        self.alpha_texture.map_or(alpha, |texture| alpha * texture.alpha(self.sampler, fragment))
    }

    /// Returns whether a fragment fails the alpha test: its alpha is below [`Shader::alpha_cutoff`].
    #[inline]
    pub(crate) fn fails_alpha_test(&self, fragment: &Fragment) -> bool {
        self.alpha(fragment) < self.alpha_cutoff
    }

    /// Returns the colour of a blended fragment of `triangle` over `below`: colour·α + below·(1 − α) in the working
    /// colour space, with α from [`Shader::alpha`]. Shading modes that show a single quantity are opaque and replace
    /// `below`.
    #[inline]
    pub(crate) fn blend(&self, fragment: &Fragment, triangle: &ScreenTriangle, below: Rgba8) -> Rgba8 {
        if !self.settings.shading.reads_material() {
            return self.shade(fragment, triangle);
        }
        self.encode(self.mixed_over(fragment, below))
    }

    /// Returns the colour of a blended fragment over `below`, in the working colour space, before it is encoded.
    #[inline(always)]
    pub(crate) fn mixed_over(&self, fragment: &Fragment, below: Rgba8) -> Vec3 {
        let (albedo, alpha) = self.albedo_and_alpha(fragment);
        let color = self.with_added(albedo * self.light(fragment), fragment);
        blended(1.0, color, self.sampler.value_of(below), alpha)
    }

    /// Returns the colour of a fragment of `triangle` as if it were opaque.
    #[inline]
    pub(crate) fn shade(&self, fragment: &Fragment, triangle: &ScreenTriangle) -> Rgba8 {
        let shading = self.settings.shading;
        if let Some(color) = self.flat_color(triangle.id, triangle.instance) {
            return color;
        }
        let inputs = FragmentInputs { shader: self, fragment, triangle };
        match shading.quantity(&inputs).map(Vec3::from_array) {
            Some(color) if shading.kind() == ShadingKind::Surface => self.encode(color),
            Some(color) => quantized(color),
            None => self.encode(self.reflected(fragment)),
        }
    }

    /// Returns the colour of a triangle in shading modes that give all of its samples the same colour, or `None` in all
    /// other modes.
    pub(crate) fn flat_color(&self, id: TriangleId, instance: u32) -> Option<Rgba8> {
        let Settings { shading, exact_ids, .. } = *self.settings;
        shading.flat(&FlatInputs { triangle: id, instance, exact_ids })
    }

    /// Returns the light that the surface reflects and emits, in the working colour space, before it is encoded.
    #[inline(always)]
    pub(crate) fn reflected(&self, fragment: &Fragment) -> Vec3 {
        self.with_added(self.albedo(fragment) * self.light(fragment), fragment)
    }

    /// Adds the specular reflection and the emission of a fragment, if the draw has any, to its diffuse reflection.
    #[inline(always)]
    fn with_added(&self, diffuse: Vec3, fragment: &Fragment) -> Vec3 {
        if self.highlight.is_none() && self.emission.is_none() {
            return diffuse;
        }
        diffuse + self.specular(fragment) + self.emitted(fragment)
    }

    /// Returns the fraction of the specular colour that a fragment reflects: max(0, N·H)^Ns.
    pub(crate) fn highlight_factor(&self, fragment: &Fragment) -> f32 {
        let Some(highlight) = &self.highlight else { return 0.0 };
        highlight.factor(self.unit_normal(fragment), self.light_direction, fragment)
    }

    /// Returns the specular reflection at a fragment, in the working colour space.
    #[cold]
    pub(crate) fn specular(&self, fragment: &Fragment) -> Vec3 {
        let specular = self.highlight.map_or(Vec3::ZERO, |highlight| highlight.specular);
        specular * self.highlight_factor(fragment)
    }

    /// Returns the emitted colour before it is multiplied by the emission texture, in the working colour space, or
    /// `None` if nothing is emitted.
    pub(crate) fn emission(&self) -> Option<Vec3> {
        self.emission
    }

    /// Returns the filtered colour of the emission texture at a fragment, or `None` without such a texture.
    pub(crate) fn emission_texel(&self, fragment: &Fragment) -> Option<Vec3> {
        self.emission_texture.map(|texture| texture.color(self.sampler, fragment))
    }

    /// Returns the light emitted at a fragment, in the working colour space.
    #[cold]
    pub(crate) fn emitted(&self, fragment: &Fragment) -> Vec3 {
        let emission = self.emission.unwrap_or(Vec3::ZERO);
        self.emission_texel(fragment).map_or(emission, |texel| emission * texel)
    }

    /// Returns the albedo (unlit surface colour) of a fragment, in the working colour space.
    #[inline]
    pub(crate) fn albedo(&self, fragment: &Fragment) -> Vec3 {
        let plain = self.plain_albedo(fragment);
        match self.texture_for(fragment) {
            Some(texture) => plain * texture.color(self.sampler, fragment),
            None => plain,
        }
    }

    /// Returns the albedo of a fragment before it is multiplied by the colour texture, in the working colour space.
    #[inline]
    pub(crate) fn plain_albedo(&self, fragment: &Fragment) -> Vec3 {
        if self.attributes.color { self.diffuse * fragment.color } else { self.diffuse }
    }

    /// Returns [`Shader::albedo`] and [`Shader::alpha`] of a fragment, reading the colour texture once.
    #[inline]
    fn albedo_and_alpha(&self, fragment: &Fragment) -> (Vec3, f32) {
        let plain = self.plain_albedo(fragment);
        match self.texture_for(fragment) {
            Some(texture) => {
                let (color, alpha) = texture.color_and_alpha(self.sampler, fragment);
                (plain * color, self.with_alpha_texture(self.opacity * alpha, fragment))
            }
            None => (plain, self.with_alpha_texture(self.opacity, fragment)),
        }
    }

    #[inline(always)] // One of several callers is the loop over opaque samples, where the cost of a call is measurable.
    fn encode(&self, color: Vec3) -> Rgba8 {
        match self.settings.color_space {
            ColorSpace::Linear => {
                let [r, g, b] = color.to_array().map(|c| self.tables.encode(c));
                [r, g, b, 255]
            }
            ColorSpace::Bytes => quantized(color),
        }
    }

    /// Returns the factor of the light on the dark side of cel shading: 1 if a dark texture replaces the light one.
    pub(crate) fn dark_factor(&self) -> f32 {
        if self.dark_texture.is_none() { cel::DARK_FACTOR } else { 1.0 }
    }

    /// Returns the world-space unit vector from a fragment towards the eye; zero unless the shading reads it.
    pub(crate) fn eye_direction(&self, fragment: &Fragment) -> Vec3 {
        self.eye.map_or(Vec3::ZERO, |eye| eye.at(fragment))
    }
}

/// Converts sRGB values in [0, 1] to the working colour space.
pub(crate) fn to_working_space(srgb: Vec3, space: ColorSpace) -> Vec3 {
    match space {
        ColorSpace::Linear => decode_rgb(srgb),
        ColorSpace::Bytes => srgb,
    }
}

fn quantized(color: Vec3) -> Rgba8 {
    [quantize(color.x), quantize(color.y), quantize(color.z), 255]
}
