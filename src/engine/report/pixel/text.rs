//! Formats a [`PixelReport`] as text: first the verdict, then the fragments in drawing order, then the source samples
//! of the upscaler.

use std::fmt::Debug;

use crate::image::Rgba8;
use crate::inspect::pixel::SampleState;
use crate::inspect::pixel::{ShadingRecord, SourceRecord, TextureMap};
use crate::inspect::{DepthRecord, FragmentOutcome, FragmentRecord, PixelReport};
use crate::pipeline::settings::{Arithmetic, Choice as _};

/// Formats the whole report as text of several lines.
pub fn describe(report: &PixelReport) -> String {
    let mut lines = vec![format!("pixel {}, {}: {}", report.x, report.y, color(report.color)), report.verdict.clone()];
    lines.extend(
        report
            .remedies
            .iter()
            .map(|remedy| format!("Remedy: {} ({}). {}.", remedy.label(), remedy.change(), remedy.effect())),
    );
    lines.push(format!("Cleared to {}.", state(report.clear)));
    if let Some(depth) = report.final_depth {
        lines.push(format!("Final depth in the buffer: {depth}."));
        lines.extend(report.visible().map(|_| one_step(depth)));
    }
    for (index, fragment) in report.fragments.iter().enumerate() {
        lines.push(String::new());
        lines.push(format!("fragment {} of {}", index + 1, report.fragments.len()));
        lines.extend(fragment_rows(fragment).map(|(name, text)| format!("  {name:<9} {text}")));
    }
    if !report.absent.is_empty() {
        lines.push(String::new());
        lines.push("triangles without a fragment at this pixel".to_owned());
        lines.extend(report.absent.iter().map(|absent| {
            format!("  {}: {} of “{}” {}", absent.cause.name(), absent.triangle.0, absent.instance, absent.reason)
        }));
    }
    if let Some(before) = report.unfiltered {
        lines.push(format!("{} before the post filter", color(before)));
    }
    if !report.samples.is_empty() {
        lines.push(String::new());
        lines.push(format!("mean of {} samples, each with its position in the pixel", report.samples.len()));
        lines.extend(report.samples.iter().map(|sample| {
            let [x, y] = sample.place;
            format!("  ({x:.4}, {y:.4})  {}", color(sample.color))
        }));
    }
    if report.drawn_at != [report.x, report.y] || report.sources.len() > 1 {
        lines.push(String::new());
        lines.push("computed by the upscaler from these drawn samples, with their weights".to_owned());
        lines.extend(report.sources.iter().map(|source| format!("  {}", source_line(source))));
    }
    lines.join("\n") + "\n"
}

/// Returns the properties of a fragment, each as a name and text. A name is empty if the text continues the one before.
pub(super) fn fragment_rows(fragment: &FragmentRecord) -> impl Iterator<Item = (&'static str, String)> {
    let corners = fragment.corners_px.map(|[x, y]| format!("({x}, {y})")).join(" ");
    let stored = fragment.stored_depth.map_or("no depth buffer".to_owned(), |d| format!("previously stored {d}"));
    let rows = [
        (
            "triangle",
            format!("{} of “{}”, submission number {}", fragment.triangle.0, fragment.instance, fragment.submission),
        ),
        ("outcome", format!("{}: {}", outcome(fragment.outcome), fragment.reason)),
        ("corners", format!("{corners} px")),
        ("edges", edges(fragment)),
        ("λ", numbers(&fragment.affine_weights)),
        ("λ′", format!("{} for attributes, 1/w {}", numbers(&fragment.attribute_weights), numbers(&fragment.inv_w))),
        ("depth", format!("{} from corner depths {}, {stored}", fragment.depth, numbers(&fragment.corner_depths))),
    ];
    let alpha = fragment.alpha.map(|alpha| ("alpha", format!("{alpha:?}")));
    let change = (fragment.before != fragment.after)
        .then(|| ("change", format!("from {} to {}", state(fragment.before), state(fragment.after))));
    let bias =
        fragment.depth_bias.map(|bias| ("", format!("The depth bias adds {bias:?} to every depth of the triangle.")));
    let step = fragment.stored_depth.map(|_| ("", one_step(fragment.depth)));
    rows.into_iter()
        .chain(bias)
        .chain(step)
        .chain(alpha)
        .chain(change)
        .chain(fragment.shading.iter().flat_map(shading_rows))
}

/// Formats the colour and the depth of a sample.
fn state(state: SampleState) -> String {
    let depth = state.depth.map_or(String::new(), |depth| format!(" at depth {depth}"));
    color(state.color) + &depth
}

fn edges(fragment: &FragmentRecord) -> String {
    let unit = match fragment.arithmetic {
        Arithmetic::Fixed => "in 1/65536 px²",
        Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => "in px², scaled by a power of two",
    };
    let [a, b, c] = fragment.edges;
    format!("({a}, {b}, {c}) of doubled area {}, {unit}", fragment.doubled_area)
}

fn shading_rows(shading: &ShadingRecord) -> Vec<(&'static str, String)> {
    let normal = shading.normal.map(|n| numbers(&n));
    let cosine = shading.cosine.map(|c| format!("N·L {c:?}"));
    let light = shading.light.map(|l| format!("light {l:?}"));
    let highlight = shading.highlight.map(|h| format!("highlight {h:?}"));
    let lighting: Vec<_> = [normal, cosine, light, highlight].into_iter().flatten().collect();
    let mut rows = Vec::new();
    if !lighting.is_empty() {
        rows.push(("normal", lighting.join(", ")));
    }
    rows.extend(shading.emission.map(|emission| ("emission", numbers(&emission))));
    rows.extend(shading.uv.map(|uv| ("uv", numbers(&uv))));
    rows.extend(shading.texels.iter().map(|texel| {
        let tap = texel.tap;
        let map = if texel.map == TextureMap::Color { "" } else { texel.map.id() };
        let level = if texel.level > 0 { format!("level {}", texel.level) } else { String::new() };
        let place = format!("({}, {})", tap.x, tap.y);
        let source: Vec<_> = [map, &level, &place].into_iter().filter(|part| !part.is_empty()).collect();
        let value = match texel.map {
            TextureMap::Opacity => format!("alpha {}", texel.color[3]),
            TextureMap::Color | TextureMap::Normal | TextureMap::Emission => color(texel.color),
        };
        ("texel", format!("{} × {:?}: {value}", source.join(" "), tap.weight))
    }));
    let over = shading.below.map_or(String::new(), |below| format!(", blended with {}", color(below)));
    rows.push(("colour", color(shading.color) + &over));
    rows
}

fn one_step(depth: DepthRecord) -> String {
    match depth.resolution as f32 {
        f32::INFINITY => "The next depth that the buffer can store is at infinity.".to_owned(),
        step => format!("One step of the depth buffer is {step:?} world units here."),
    }
}

/// Formats a drawn sample that the upscaler reads.
pub(super) fn source_line(source: &SourceRecord) -> String {
    format!("({}, {}) × {:?}: {}", source.tap.x, source.tap.y, source.tap.weight, color(source.color))
}

/// Returns the outcome of a fragment in words.
pub(super) fn outcome(outcome: FragmentOutcome) -> &'static str {
    match outcome {
        FragmentOutcome::Visible => "visible",
        FragmentOutcome::Overwritten => "overwritten",
        FragmentOutcome::BlendedOver => "visible through a blended fragment",
        FragmentOutcome::DepthRejected => "rejected by the depth test",
        FragmentOutcome::AlphaRejected => "discarded by the alpha test",
    }
}

/// Formats the codes of a colour in hexadecimal and in decimal.
pub(super) fn color([r, g, b, _]: Rgba8) -> String {
    format!("#{r:02x}{g:02x}{b:02x} ({r}, {g}, {b})")
}

/// Formats numbers in parentheses, each as the shortest text that parses back to the same value.
fn numbers(list: &[impl Debug]) -> String {
    let words: Vec<_> = list.iter().map(|number| format!("{number:?}")).collect();
    format!("({})", words.join(", "))
}
