//! Trace of the lighting, colour and blending of a fragment.

use glam::Vec3;

use super::formula::{Formula, Function, fraction, given, sum, whole};
use super::geometry::unit_component;
use super::inputs::FormulaInputs;
use super::line::{Notable, TraceRecorder, TraceStage};
use super::names::{AXES, CHANNELS};
use super::subject::TracedFragment;
use super::texture::number_formula;
use crate::image::Rgba8;
use crate::inspect::intermediate::Intermediate;
use crate::inspect::pixel::ShadingRecord;
use crate::math::real::dot;
use crate::pipeline::footprint::TextureRead;
use crate::pipeline::formulas::blended;
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::settings::{Choice as _, ColorSpace};
use crate::pipeline::shade::{Highlight, NormalMap, Readable};
use crate::pipeline::shading::{Input, LightInputs as _, ShadingKind, cel};
use crate::scene::Transparency;

/// Writes the trace lines for the fragment's lighting, opacity and colour.
pub(super) fn write(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Light);
    let shading = subject.settings.shading;
    if subject.runs(PipelinePart::Normals) && !shading.reads(Input::VertexLight) {
        unit_normal(subject, scribe);
    }
    if shading.reads(Input::EyeDirection) {
        eye_direction(subject.shader.eye_direction(&subject.fragment), scribe);
    }
    if subject.runs(PipelinePart::Light) {
        light(subject, scribe);
    }
    scribe.enter(TraceStage::Colour);
    if let Some(alpha) = subject.record.alpha {
        opacity(subject, alpha, scribe);
    }
    let Some(ShadingRecord { below, .. }) = subject.record.shading else { return };
    let code = match below {
        Some(below) => subject.shader.blend(&subject.fragment, subject.triangle, below),
        None => subject.shader.shade(&subject.fragment, subject.triangle),
    };
    if shading.reads_material() {
        material(subject, below, code, scribe);
    } else {
        quantity(subject, code, scribe);
    }
}

fn unit_normal(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    let smooth = subject.shader.smooth_normal(&subject.fragment);
    for (axis, value) in smooth.to_array().into_iter().enumerate() {
        let formula = unit_component(subject.fragment.normal.to_array(), axis);
        scribe.compute(format!("unit normal {}", AXES[axis]), value, &formula);
    }
    if let Some(map) = subject.shader.normal_map() {
        mapped_normal(subject, map, smooth, scribe);
    }
}

/// Writes the trace lines for the normal from the normal map, which replaces the interpolated normal.
fn mapped_normal(subject: &TracedFragment<'_>, map: &NormalMap<'_>, smooth: Vec3, scribe: &mut TraceRecorder) {
    let fragment = &subject.fragment;
    let vector = map.vector(fragment);
    for (axis, value) in vector.to_array().into_iter().enumerate() {
        let words = "2 · texel − 1 in tangent space; x and y times the scale of the normal map";
        scribe.read(format!("normal map {}", AXES[axis]), words, value);
    }
    let Some([tangent, bitangent]) = map.frame(smooth, fragment) else {
        scribe.decide("normal map", "the triangle has no tangent: its texture coordinates have no area", "not applied");
        return;
    };
    let mut sum_of_all = [0.0; 3];
    for axis in 0..3 {
        let name = AXES[axis];
        scribe.read(
            format!("tangent {name}"),
            "unit vector along growing u, perpendicular to the normal",
            tangent[axis],
        );
        scribe.read(format!("bitangent {name}"), "unit vector along falling v, perpendicular to both", bitangent[axis]);
        let value = tangent[axis] * vector.x + bitangent[axis] * vector.y + smooth[axis] * vector.z;
        let formula = given("tangent", tangent[axis]) * given("map x", vector.x)
            + given("bitangent", bitangent[axis]) * given("map y", vector.y)
            + given("unit normal", smooth[axis]) * given("map z", vector.z);
        scribe.compute(format!("mapped normal {name}"), value, &formula);
        sum_of_all[axis] = value;
    }
    let unit = subject.shader.unit_normal(fragment);
    for (axis, value) in unit.to_array().into_iter().enumerate() {
        scribe.compute(format!("unit mapped normal {}", AXES[axis]), value, &unit_component(sum_of_all, axis));
    }
}

/// Writes the trace lines for N·L, the light factor, and the specular reflection.
fn light(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    let (shader, fragment) = (&subject.shader, &subject.fragment);
    let (shading, inputs) = (subject.settings.shading, FormulaInputs(subject));
    let cosine = shader.cosine(fragment);
    if shading.reads(Input::LightDirection) {
        for (axis, value) in shader.light_direction.to_array().into_iter().enumerate() {
            scribe.read(format!("to the light {}", AXES[axis]), "the direction of the light at unit length", value);
        }
        let formula = dot(&inputs.normal(), &inputs.light_direction());
        scribe.compute("N·L", cosine, &formula).shown_by(Intermediate::Cosine);
    }
    if shading.reads(Input::DarkTexture) {
        let words = format!("N·L > {}: the light texture, else the dark one", cel::THRESHOLD);
        let side = if cel::is_lit(cosine) { "light" } else { "dark" };
        scribe.decide("side of the threshold", words, side).flag(Notable::Tie, cosine == cel::THRESHOLD);
    }
    if shading.reads_material() {
        scribe.compute("light", shader.light(fragment), &shading.light(&inputs)).shown_by(Intermediate::Light);
    }
    if let Some(highlight) = shader.highlight() {
        write_highlight(subject, highlight, cosine, scribe);
    }
}

/// Writes the trace lines for the direction towards the eye.
fn eye_direction(to_eye: Vec3, scribe: &mut TraceRecorder) {
    for axis in 0..3 {
        scribe.read(format!("to the eye {}", AXES[axis]), "unit vector from the point to the eye", to_eye[axis]);
    }
}

/// Writes the trace lines for the halfway vector H, for N·H, and for the specular factor max(0, N·H)^Ns.
fn write_highlight(subject: &TracedFragment<'_>, highlight: &Highlight<'_>, cosine: f32, scribe: &mut TraceRecorder) {
    let (shader, fragment) = (&subject.shader, &subject.fragment);
    let factor = shader.highlight_factor(fragment);
    if cosine <= 0.0 {
        scribe.decide("highlight", "N·L ≤ 0: no highlight on the side away from the light", "none");
        return;
    }
    let to_eye = highlight.eye_direction(fragment);
    let halfway = highlight.halfway(shader.light_direction, fragment);
    let between = shader.light_direction + to_eye;
    if !subject.settings.shading.reads(Input::EyeDirection) {
        eye_direction(to_eye, scribe);
    }
    for axis in 0..3 {
        let formula = given("to the light", shader.light_direction[axis]) + given("to the eye", to_eye[axis]);
        scribe.compute(format!("light + eye {}", AXES[axis]), between[axis], &formula);
    }
    for axis in 0..3 {
        let formula = unit_component(between.to_array(), axis);
        scribe.compute(format!("halfway {}", AXES[axis]), halfway[axis], &formula);
    }
    let normal = shader.unit_normal(fragment);
    let term =
        |axis: usize| given(["nx", "ny", "nz"][axis], normal[axis]) * given(["hx", "hy", "hz"][axis], halfway[axis]);
    let cosine = normal.dot(halfway);
    scribe.compute("N·H", cosine, &sum((0..3).map(term)));
    let formula = given("N·H", cosine).max(whole("0", 0)).raised_to(given("Ns", highlight.shininess));
    scribe.compute("highlight", factor, &formula);
}

/// Returns the formula of the filtered alpha of a texture; `name` is the name of the alpha of one read.
fn alpha_formula(subject: &TracedFragment<'_>, texture: Readable<'_>, name: &'static str) -> Formula {
    mean_of_reads(subject, texture, |read| {
        given(name, subject.shader.sampler().alpha(texture.level(read.level), read.uv))
    })
}

/// Returns the formula of the weighted mean of `value` over all reads of a texture.
fn mean_of_reads(
    subject: &TracedFragment<'_>,
    texture: Readable<'_>,
    value: impl Fn(TextureRead) -> Formula,
) -> Formula {
    let reads = texture.reads(&subject.fragment);
    let term = |read: TextureRead| {
        if reads.level_count > 1 { value(read) * given("share", read.share) } else { value(read) }
    };
    let total = sum(reads.all(subject.fragment.uv).map(term));
    if reads.probes > 1 { total / given("probes", reads.probes) } else { total }
}

/// Writes the trace lines for the fragment's alpha and the alpha test.
fn opacity(subject: &TracedFragment<'_>, alpha: f32, scribe: &mut TraceRecorder) {
    let own = given("opacity", subject.shader.opacity());
    let formula = match subject.shader.texture_for(&subject.fragment) {
        Some(texture) => own * alpha_formula(subject, texture, "texture alpha"),
        None => own,
    };
    let formula = match subject.shader.alpha_texture() {
        Some(texture) => formula * alpha_formula(subject, texture, "opacity map"),
        None => formula,
    };
    scribe.compute("alpha", alpha, &formula).shown_by(Intermediate::Alpha);
    if subject.record.transparency == Transparency::AlphaTested {
        let cutoff = subject.shader.alpha_cutoff();
        let words = format!("alpha < {cutoff}: discarded");
        let line = scribe.decide("alpha test", words, if alpha < cutoff { "fails" } else { "passes" });
        line.flag(Notable::Tie, alpha == cutoff);
    }
}

/// Writes the trace lines for the surface colour: material × texture × light, blended with the colour below if the
/// material is transparent.
fn material(subject: &TracedFragment<'_>, below: Option<Rgba8>, code: Rgba8, scribe: &mut TraceRecorder) {
    let (shader, fragment) = (&subject.shader, &subject.fragment);
    let (plain, albedo, light) = (shader.plain_albedo(fragment), shader.albedo(fragment), shader.light(fragment));
    let (diffuse, reflected) = (albedo * light, shader.reflected(fragment));
    let texture = texture_color(subject);
    for channel in 0..3 {
        let name = CHANNELS[channel];
        let own = given("material", shader.diffuse[channel]);
        let formula =
            if shader.attributes().color { own * given("vertex colour", fragment.color[channel]) } else { own };
        scribe.compute(format!("material {name}"), plain[channel], &formula);
        let material = given("material", plain[channel]);
        let formula = match &texture {
            Some(mixed) => material * mixed(channel),
            None => material,
        };
        scribe.compute(format!("surface {name}"), albedo[channel], &formula);
        let lit = given("surface", albedo[channel]) * given("light", light);
        scribe.compute(format!("lit {name}"), diffuse[channel], &lit);
        let is_diffuse = shader.highlight().is_none() && shader.emission().is_none();
        if !is_diffuse {
            let formula = added(subject, channel, given("lit", diffuse[channel]), scribe);
            scribe.compute(format!("sum {name}"), reflected[channel], &formula);
        }
        let mut last = reflected[channel];
        if let (Some(below), Some(alpha)) = (below, subject.record.alpha) {
            last = shader.mixed_over(fragment, below)[channel];
            let behind = shader.sampler().value_of(below)[channel];
            let own = if is_diffuse { lit } else { given("sum", reflected[channel]) };
            let formula = blended(whole("1", 1), own, given("behind", behind), given("alpha", alpha));
            scribe.read(format!("behind {name}"), "colour drawn there before", below[channel]);
            scribe.compute(format!("behind {name} as light"), behind, &behind_formula(subject, below[channel]));
            scribe.compute(format!("blended {name}"), last, &formula);
        }
        let formula = code_formula(last, subject.settings.color_space);
        scribe.compute(format!("{name} code"), code[channel], &formula);
    }
}

/// Returns the formula for the sum of diffuse, specular and emitted light. Writes the trace lines for the specular and
/// emitted light, if any.
fn added(subject: &TracedFragment<'_>, channel: usize, diffuse: Formula, scribe: &mut TraceRecorder) -> Formula {
    let (shader, fragment, name) = (&subject.shader, &subject.fragment, CHANNELS[channel]);
    let mut all = diffuse;
    if let Some(highlight) = shader.highlight() {
        let value = shader.specular(fragment)[channel];
        let factor = given("highlight", shader.highlight_factor(fragment));
        scribe.compute(format!("specular {name}"), value, &(given("Ks", highlight.specular[channel]) * factor));
        all = all + given("specular", value);
    }
    if let Some(emission) = shader.emission() {
        let value = shader.emitted(fragment)[channel];
        let own = given("Ke", emission[channel]);
        let formula = match shader.emission_texel(fragment) {
            Some(texel) => own * given("emission texture", texel[channel]),
            None => own,
        };
        scribe.compute(format!("emission {name}"), value, &formula);
        all = all + given("emission", value);
    }
    all
}

fn behind_formula(subject: &TracedFragment<'_>, code: u8) -> Formula {
    let number = number_formula(code, subject.settings.color_space);
    match subject.settings.color_space {
        ColorSpace::Linear => number,
        ColorSpace::Bytes => number * given("1/255", subject.shader.sampler().scale),
    }
}

/// Returns a function that maps a channel to the formula of its filtered texture colour; `None` if no texture is read.
fn texture_color<'a>(subject: &'a TracedFragment<'_>) -> Option<impl Fn(usize) -> Formula + 'a> {
    let texture = subject.shader.texture_for(&subject.fragment)?;
    Some(move |channel: usize| {
        let sampler = subject.shader.sampler();
        if texture.is_premultiplied() {
            let part = |name: &'static str, part: usize| {
                mean_of_reads(subject, texture, |read| {
                    given(name, sampler.sample_premultiplied(texture.level(read.level), read.uv)[part])
                })
            };
            let alpha = part("alpha code", 3);
            if alpha.evaluate().is_none_or(|exact| exact.value.is_zero()) {
                return whole("0", 0);
            }
            let quotient = part("texture × alpha", channel) / alpha;
            return match subject.settings.color_space {
                ColorSpace::Linear => quotient,
                ColorSpace::Bytes => quotient * given("1/255", sampler.scale),
            };
        }
        mean_of_reads(subject, texture, |read| {
            given("texture", sampler.sample(texture.level(read.level), read.uv)[channel])
        })
    })
}

/// Returns the formula that encodes a value as an 8-bit code: by the sRGB curve if shading works in linear light,
/// otherwise in 255 equal steps.
fn code_formula(value: f32, space: ColorSpace) -> Formula {
    encoded(&given("value", value), space)
}

/// Returns the formula that encodes the value of another formula as an 8-bit code.
pub(super) fn encoded(value: &Formula, space: ColorSpace) -> Formula {
    /// Largest linear value on the straight segment of the sRGB curve.
    const STRAIGHT: f64 = 0.003_130_8;
    let is_straight = value.evaluate().is_none_or(|exact| exact.value.approximate() <= STRAIGHT);
    let within = value.clone().max(whole("0", 0)).min(whole("1", 1));
    let steps = whole("255", 255);
    match space {
        ColorSpace::Bytes => steps * within,
        ColorSpace::Linear if is_straight => steps * (fraction("12.92", 1292, 100) * within),
        ColorSpace::Linear => {
            let curve = fraction("1.055", 1055, 1000) * within.apply(Function::SrgbRoot);
            steps * (curve - fraction("0.055", 55, 1000))
        }
    }
}

/// Writes the trace lines for the colour in shading modes that do not use the material.
fn quantity(subject: &TracedFragment<'_>, code: Rgba8, scribe: &mut TraceRecorder) {
    let shading = subject.settings.shading;
    let is_encoded = shading.kind() == ShadingKind::Surface;
    let space = if is_encoded { subject.settings.color_space } else { ColorSpace::Bytes };
    let formulas = shading.quantity(&FormulaInputs(subject));
    for (channel, name) in CHANNELS.into_iter().enumerate() {
        let what = format!("{name} code");
        match &formulas {
            Some(formulas) => {
                scribe.compute(what, code[channel], &encoded(&formulas[channel], space));
            }
            None => scribe.read(what, shading.help(), code[channel]),
        }
    }
}
