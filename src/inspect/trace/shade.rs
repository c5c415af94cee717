//! Light and colour of a fragment, and what blending makes of it.

use glam::Vec3;

use super::attributes::CHANNELS;
use super::formula::{Formula, Function, fraction, given, sum, whole};
use super::geometry::{AXES, unit_component};
use super::line::{Notable, Scribe, TraceStage};
use super::subject::Subject;
use super::texture::number_formula;
use crate::image::Rgba8;
use crate::inspect::intermediate::Intermediate;
use crate::pipeline::depth::depth_at;
use crate::pipeline::plan::Part;
use crate::pipeline::settings::{Choice as _, ColorSpace, Shading};
use crate::pipeline::shade::CEL_THRESHOLD;
use crate::scene::Transparency;
use crate::scene::material::CUT_OUT_BELOW;

/// Writes light and colour.
pub(super) fn write(subject: &Subject<'_>, scribe: &mut Scribe) {
    scribe.enter(TraceStage::Light);
    if subject.runs(Part::Normals) && subject.settings.shading != Shading::Gouraud {
        unit_normal(subject, scribe);
    }
    if subject.runs(Part::Light) {
        light(subject, scribe);
    }
    scribe.enter(TraceStage::Colour);
    if let Some(alpha) = subject.record.alpha {
        opacity(subject, alpha, scribe);
    }
    let Some(shading) = &subject.record.shading else { return };
    let below = shading.below;
    let code = match below {
        Some(below) => subject.shader.blend(&subject.fragment, subject.triangle, below),
        None => subject.shader.shade(&subject.fragment, subject.triangle),
    };
    if subject.settings.shading.reads_material() {
        material(subject, below, code, scribe);
    } else {
        quantity(subject, code, scribe);
    }
}

fn unit_normal(subject: &Subject<'_>, scribe: &mut Scribe) {
    let unit = subject.shader.unit_normal(&subject.fragment).to_array();
    for (axis, value) in unit.into_iter().enumerate() {
        let formula = unit_component(subject.fragment.normal.to_array(), axis);
        scribe.compute(format!("unit normal {}", AXES[axis]), value, &formula);
    }
}

/// N·L, and the light that follows from it.
fn light(subject: &Subject<'_>, scribe: &mut Scribe) {
    let (shader, fragment) = (&subject.shader, &subject.fragment);
    let factor = shader.light(fragment);
    if subject.settings.shading == Shading::Gouraud {
        scribe.compute("light", factor, &given("light from the corners", fragment.light)).shown_by(Intermediate::Light);
        return;
    }
    let (normal, direction) = (shader.unit_normal(fragment).to_array(), shader.light_direction.to_array());
    for (axis, value) in direction.into_iter().enumerate() {
        scribe.read(format!("to the light {}", AXES[axis]), "the direction of the light at unit length", value);
    }
    let cosine = shader.cosine(fragment);
    scribe.compute("N·L", cosine, &dot(normal, direction)).shown_by(Intermediate::Cosine);
    if subject.settings.shading == Shading::Cel {
        let is_lit = cosine > CEL_THRESHOLD;
        let words = format!("N·L > {CEL_THRESHOLD}: the light texture, else the dark one");
        let line = scribe.decide("side of the threshold", words, if is_lit { "light" } else { "dark" });
        line.flag(Notable::Tie, cosine == CEL_THRESHOLD);
        scribe.read("light", "1 where a texture tells the side", factor);
        return;
    }
    let formula = lambert_formula(normal, direction, subject.settings.light.ambient);
    scribe.compute("light", factor, &formula).shown_by(Intermediate::Light);
}

fn dot(normal: [f32; 3], direction: [f32; 3]) -> Formula {
    sum((0..3)
        .map(|axis| given(["nx", "ny", "nz"][axis], normal[axis]) * given(["lx", "ly", "lz"][axis], direction[axis])))
}

/// ambient + (1 − ambient)·max(0, N·L).
pub(super) fn lambert_formula(normal: [f32; 3], direction: [f32; 3], ambient: f32) -> Formula {
    let share = || given("ambient", ambient);
    share() + (whole("1", 1) - share()) * dot(normal, direction).max(whole("0", 0))
}

/// How much the fragment covers, and whether it is there at all.
fn opacity(subject: &Subject<'_>, alpha: f32, scribe: &mut Scribe) {
    let own = given("opacity", subject.shader.opacity());
    let formula = match subject.shader.texture_for(&subject.fragment) {
        Some(texture) => {
            let (levels, count) = texture.levels(&subject.fragment);
            let term = |(level, share): (usize, f32)| {
                let alpha = subject.shader.sampler().alpha(texture.level(level), subject.fragment.uv);
                let alpha = given("texture alpha", alpha);
                if count > 1 { alpha * given("share", share) } else { alpha }
            };
            own * sum(levels[..count].iter().copied().map(term))
        }
        None => own,
    };
    scribe.compute("alpha", alpha, &formula).shown_by(Intermediate::Alpha);
    if subject.record.transparency == Transparency::CutOut {
        let words = format!("alpha < {CUT_OUT_BELOW}: cut out");
        let line = scribe.decide("cut-out", words, if alpha < CUT_OUT_BELOW { "not there" } else { "there" });
        line.flag(Notable::Tie, alpha == CUT_OUT_BELOW);
    }
}

/// Colour of a surface: material × texture × light, blended where it is seen through.
fn material(subject: &Subject<'_>, below: Option<Rgba8>, code: Rgba8, scribe: &mut Scribe) {
    let (shader, fragment) = (&subject.shader, &subject.fragment);
    let (plain, albedo, light) = (shader.plain_albedo(fragment), shader.albedo(fragment), shader.light(fragment));
    let reflected = shader.reflected(fragment);
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
        let mut last = reflected[channel];
        scribe.compute(format!("lit {name}"), last, &lit);
        if let (Some(below), Some(alpha)) = (below, subject.record.alpha) {
            last = shader.mixed_over(fragment, below)[channel];
            let behind = shader.sampler().value_of(below)[channel];
            let share = || given("alpha", alpha);
            let formula = given("surface", albedo[channel]) * given("light", light) * share()
                + given("behind", behind) * (whole("1", 1) - share());
            scribe.read(format!("behind {name}"), "what was drawn there before", below[channel]);
            scribe.compute(format!("behind {name} as light"), behind, &behind_formula(subject, below[channel]));
            scribe.compute(format!("blended {name}"), last, &formula);
        }
        let formula = code_formula(last, subject.settings.color_space);
        scribe.compute(format!("{name} code"), code[channel], &formula);
    }
}

fn behind_formula(subject: &Subject<'_>, code: u8) -> Formula {
    let number = number_formula(code, subject.settings.color_space);
    match subject.settings.color_space {
        ColorSpace::Linear => number,
        ColorSpace::Bytes => number * given("1/255", subject.shader.sampler().scale),
    }
}

/// The mixed colour of the texture by channel, if one is read.
fn texture_color<'a>(subject: &'a Subject<'_>) -> Option<impl Fn(usize) -> Formula + 'a> {
    let texture = subject.shader.texture_for(&subject.fragment)?;
    let (levels, count) = texture.levels(&subject.fragment);
    Some(move |channel: usize| {
        let term = |(level, share): (usize, f32)| {
            let color = subject.shader.sampler().sample(texture.level(level), subject.fragment.uv);
            let color = given("texture", color[channel]);
            if count > 1 { color * given("share", share) } else { color }
        };
        sum(levels[..count].iter().copied().map(term))
    })
}

/// The code of a value by the curve of sRGB, or by 255 steps.
fn code_formula(value: f32, space: ColorSpace) -> Formula {
    encoded(&given("value", value), space)
}

/// The code of a formula's value.
pub(super) fn encoded(value: &Formula, space: ColorSpace) -> Formula {
    /// Where the straight part of the curve ends.
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

/// The views of single quantities, which know no light.
fn quantity(subject: &Subject<'_>, code: Rgba8, scribe: &mut Scribe) {
    let fragment = &subject.fragment;
    let bytes = |value: f32| code_formula(value, ColorSpace::Bytes);
    let formula = |channel: usize| match subject.settings.shading {
        Shading::VertexColor => Some(code_formula(fragment.color[channel], subject.settings.color_space)),
        Shading::Normals => {
            let normal = given("unit normal", subject.shader.unit_normal(fragment)[channel]);
            Some(whole("255", 255) * (normal * fraction("½", 1, 2) + fraction("½", 1, 2)))
        }
        Shading::Uv if channel < 2 => {
            let coordinate = || given(["u", "v"][channel], fragment.uv[channel]);
            Some(whole("255", 255) * (coordinate() - coordinate().apply(Function::Floor)))
        }
        Shading::Uv => Some(whole("0", 0)),
        Shading::Barycentric => Some(bytes(fragment.source_weights[channel])),
        Shading::Depth => Some(bytes(Vec3::splat(depth_at(subject.triangle, &fragment.sample))[channel])),
        _ => None,
    };
    for channel in 0..3 {
        let what = format!("{} code", CHANNELS[channel]);
        match formula(channel) {
            Some(formula) => {
                scribe.compute(what, code[channel], &formula);
            }
            None => scribe.read(what, subject.settings.shading.help(), code[channel]),
        }
    }
}
