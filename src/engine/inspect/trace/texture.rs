//! Trace of the texels that a fragment reads, with their weights and weighted mean.

use glam::Vec2;

use super::formula::{Formula, Function, fraction, given, sum, whole};
use super::line::{Notable, TraceRecorder, TraceStage};
use super::names::CHANNELS;
use super::subject::TracedFragment;
use crate::image::{Image, Rgba8};
use crate::pipeline::footprint::{TextureRead, TextureReads};
use crate::pipeline::formulas::bilinear_weights;
use crate::pipeline::sample::TexelTap;
use crate::pipeline::settings::{AddressMode, Choice as _, ColorSpace, TexelFilter};

/// One mip level of the texture, as read for one probe.
struct TracedRead<'a> {
    image: &'a Image<Rgba8>,
    is_premultiplied: bool,
    uv: Vec2,
    /// Beginning of the names of the lines: probe and mip level, if there are several.
    name: String,
}

/// Writes the trace lines for the texels read by each probe from each mip level. Writes none if no texture is read.
pub(super) fn write(subject: &TracedFragment<'_>, scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Texture);
    let Some(texture) = subject.shader.texture_for(&subject.fragment) else { return };
    let reads = texture.reads(&subject.fragment);
    let shares = reads.levels.iter().take(reads.level_count).filter(|_| reads.level_count > 1);
    for (level, share) in shares {
        let words = "from the level of detail: the base-2 logarithm, to five digits, of the part of a pixel's footprint \
                     that a probe covers, in texels, plus the mip bias";
        scribe.read(format!("share of mip level {level}"), words, *share);
    }
    if reads.probes > 1 {
        axis(&reads, scribe);
    }
    let mut last_probe = None;
    for TextureRead { probe, uv, level, .. } in reads.all(subject.fragment.uv) {
        let of_probe = if reads.probes > 1 { format!("probe {probe} · ") } else { String::new() };
        if reads.probes > 1 && last_probe.replace(probe) != Some(probe) {
            position(subject, &reads, probe, scribe);
        }
        let of_level = if reads.level_count > 1 { format!("mip level {level} · ") } else { String::new() };
        let image = texture.level(level);
        let name = of_probe + &of_level;
        read(subject, &TracedRead { image, is_premultiplied: texture.is_premultiplied(), uv, name }, scribe);
    }
}

/// Writes the trace lines for the number of probes and the major axis of the footprint.
fn axis(reads: &TextureReads, scribe: &mut TraceRecorder) {
    let words = "ratio of the axes of a pixel's footprint, rounded up, at most the maximum anisotropy";
    scribe.read("probes", words, reads.probes);
    for (axis, part) in ["u", "v"].into_iter().enumerate() {
        let words = "longest axis of the ellipse that is a pixel's footprint";
        scribe.read(format!("major axis {part}"), words, reads.major_axis[axis]);
    }
}

/// Writes the trace lines for the texture coordinates of a probe.
fn position(subject: &TracedFragment<'_>, reads: &TextureReads, probe: u32, scribe: &mut TraceRecorder) {
    let uv = reads.position(subject.fragment.uv, probe);
    for (axis, part) in ["u", "v"].into_iter().enumerate() {
        let along = given("major axis", reads.major_axis[axis]) * given("place on the axis", reads.offset(probe));
        scribe.compute(format!("probe {probe} · {part}"), uv[axis], &(given(part, subject.fragment.uv[axis]) + along));
    }
}

/// Writes the trace lines for the addressing, weights and texels of one read.
fn read(subject: &TracedFragment<'_>, traced: &TracedRead<'_>, scribe: &mut TraceRecorder) {
    let TracedRead { image, uv, ref name, .. } = *traced;
    let (sampler, size) = (subject.shader.sampler(), image.size());
    let unit = sampler.unit(uv);
    let lengths = [size.0, size.1];
    let mut shares = [0.0; 2];
    for axis in 0..2 {
        let part = ["u", "v"][axis];
        let formula = in_unit(uv[axis], part, sampler.address);
        scribe.compute(format!("{name}{part} in 0…1"), unit[axis], &formula);
        let texels = || given(part, unit[axis]) * given(["width", "height"][axis], lengths[axis]);
        if sampler.filter == TexelFilter::Point {
            continue;
        }
        shares[axis] = sampler.share_of_next(unit[axis], lengths[axis]);
        let position = || texels() - fraction("½", 1, 2);
        let formula = position() - position().apply(Function::Floor);
        scribe.compute(format!("{name}share of the next {}", ["column", "row"][axis]), shares[axis], &formula);
    }
    let (taps, count) = sampler.taps(size, uv);
    if sampler.filter == TexelFilter::Point {
        nearest(&taps[0], unit, lengths, name, scribe);
    }
    let weights = bilinear_weights(whole("1", 1), [given("next column", shares[0]), given("next row", shares[1])]);
    for (tap, weight) in taps[..count].iter().zip(&weights) {
        let what = format!("{name}weight of texel {}, {}", tap.x, tap.y);
        if count == 1 {
            scribe.read(what, "the nearest texel alone", tap.weight);
        } else {
            scribe.compute(what, tap.weight, weight);
        }
    }
    colors(subject, traced, &taps[..count], scribe);
}

/// Returns the formula by which the address mode maps a texture coordinate to [0, 1].
fn in_unit(coordinate: f32, part: &'static str, address: AddressMode) -> Formula {
    let given_part = || given(part, coordinate);
    match address {
        AddressMode::Clamp => given_part().max(whole("0", 0)).min(whole("1", 1)),
        AddressMode::Repeat => given_part() - given_part().apply(Function::Floor),
        AddressMode::Mirror => {
            // The distance from the nearest even number.
            let half = (given_part() / whole("2", 2)).apply(Function::Floor);
            let period = given_part() - whole("2", 2) * half;
            period.clone().min(whole("2", 2) - period)
        }
    }
}

/// Writes the trace lines for the texel that the point filter selects.
fn nearest(tap: &TexelTap, unit: [f64; 2], lengths: [u32; 2], name: &str, scribe: &mut TraceRecorder) {
    for (axis, value) in [tap.x, tap.y].into_iter().enumerate() {
        let texels = given(["u", "v"][axis], unit[axis]) * given(["width", "height"][axis], lengths[axis]);
        let on_border = texels.evaluate().is_some_and(|exact| exact.value == exact.value.floor());
        let last = given("last", lengths[axis] - 1);
        let line = scribe.compute(
            format!("{name}texel {}", ["column", "row"][axis]),
            value,
            &texels.apply(Function::Floor).min(last),
        );
        line.flag(Notable::Tie, on_border);
    }
}

/// Writes the trace lines for the texels' codes, their decoded values, and the weighted mean.
fn colors(subject: &TracedFragment<'_>, traced: &TracedRead<'_>, taps: &[TexelTap], scribe: &mut TraceRecorder) {
    let TracedRead { image, is_premultiplied, uv, ref name } = *traced;
    let sampler = subject.shader.sampler();
    let space = subject.settings.color_space;
    for (channel, channel_name) in CHANNELS.into_iter().enumerate() {
        for tap in taps {
            let code = image.at(tap.x, tap.y)[channel];
            let number = sampler.number_of(image.at(tap.x, tap.y))[channel];
            let what = format!("{name}texel {}, {} · {channel_name}", tap.x, tap.y);
            scribe.compute(what, number, &number_formula(code, space));
        }
        let term = |tap: &TexelTap| {
            let number = sampler.number_of(image.at(tap.x, tap.y))[channel];
            given("texel", number) * given("weight", tap.weight)
        };
        if is_premultiplied {
            let term = |tap: &TexelTap| {
                let texel = image.at(tap.x, tap.y);
                let number = given("texel", sampler.number_of(texel)[channel]);
                number * given("alpha", texel[3]) * given("weight", tap.weight)
            };
            let value = sampler.sample_premultiplied(image, uv)[channel];
            let formula = sum(taps.iter().map(term));
            scribe.compute(format!("{name}texture {channel_name} × alpha"), value, &formula);
            continue;
        }
        let mean = sum(taps.iter().map(term));
        let formula = if space == ColorSpace::Bytes { mean * given("1/255", sampler.scale) } else { mean };
        let value = sampler.sample(image, uv)[channel];
        scribe.compute(format!("{name}texture {channel_name}"), value, &formula);
    }
    if is_premultiplied {
        let term = |tap: &TexelTap| given("alpha", image.at(tap.x, tap.y)[3]) * given("weight", tap.weight);
        let value = sampler.sample_premultiplied(image, uv).w;
        scribe.compute(format!("{name}texture alpha code"), value, &sum(taps.iter().map(term)));
    }
    if subject.record.alpha.is_some() {
        let term = |tap: &TexelTap| given("alpha", image.at(tap.x, tap.y)[3]) * given("weight", tap.weight);
        let formula = sum(taps.iter().map(term)) / whole("255", 255);
        let value = sampler.alpha(image, uv);
        scribe.compute(format!("{name}texture alpha"), value, &formula);
    }
    if sampler.filter != TexelFilter::Point {
        let words = format!("{} texels, weighted: {}", taps.len(), sampler.filter.name());
        scribe.decide(format!("{name}filter"), words, sampler.address.name());
    }
}

/// Returns the formula that decodes an 8-bit colour code: by the sRGB curve if shading works in linear light, otherwise
/// the code itself.
pub(super) fn number_formula(code: u8, space: ColorSpace) -> Formula {
    /// Largest code on the straight segment of the sRGB curve: 0.04045 · 255 = 10.3.
    const LAST_STRAIGHT: u8 = 10;
    let share = || given("code", code) / whole("255", 255);
    match space {
        ColorSpace::Bytes => given("code", code),
        ColorSpace::Linear if code <= LAST_STRAIGHT => share() / fraction("12.92", 1292, 100),
        ColorSpace::Linear => {
            let inner = (share() + fraction("0.055", 55, 1000)) / fraction("1.055", 1055, 1000);
            inner.apply(Function::SrgbPower)
        }
    }
}
