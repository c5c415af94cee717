//! Trace from the drawn samples to the pixel of the full picture: resolve, upscaler, post filter and wireframe.

use super::formula::{given, sum, whole};
use super::line::{TraceRecorder, TraceStage};
use super::names::CHANNELS;
use super::shade::encoded;
use crate::chain::{Frame, Recipe};
use crate::image::Rgba8;
use crate::image::color::decode_byte;
use crate::inspect::feeds::{ContributingSample, Mixture};
use crate::inspect::pixel::PixelReport;
use crate::pipeline::settings::{Choice as _, ColorSpace};
use crate::upscale::FilterSpace;

/// Writes the trace lines for all stages after shading.
pub(super) fn write(recipe: &Recipe, frame: &Frame, report: &PixelReport, scribe: &mut TraceRecorder) {
    scribe.enter(TraceStage::Resolve);
    resolve(frame, report, scribe);
    scribe.enter(TraceStage::Upscale);
    let at = (report.x, report.y);
    if !frame.is_drawn(at.0, at.1) || report.sources.len() > 1 {
        upscale(recipe, frame, at, scribe);
    }
    if let Some(before) = report.unfiltered {
        code_lines("before the filter", "the picture that the filter reads", before, scribe);
    }
    if let Some(triangle) = report.wireframe {
        let words = "the pixel lies under a line of the wireframe";
        scribe.decide("wireframe", words, format!("edge of triangle {}", triangle.0));
    }
    code_lines("pixel", "the pixel of the picture", report.color, scribe);
}

fn code_lines(what: &str, words: &str, color: Rgba8, scribe: &mut TraceRecorder) {
    for (channel, name) in CHANNELS.into_iter().enumerate() {
        scribe.read(format!("{what} {name}"), words, color[channel]);
    }
}

/// Writes the anti-aliasing samples of a drawn pixel and their mean.
fn resolve(frame: &Frame, report: &PixelReport, scribe: &mut TraceRecorder) {
    let (count, light) = (report.samples.len(), frame.antialias.light);
    if count == 0 {
        return;
    }
    let words =
        "the fragment above lies at the pixel's centre; each sample was computed by the same steps at its own position";
    scribe.decide("samples", words, format!("{count} samples, mean in {}", light.name().to_lowercase()));
    for (index, sample) in report.samples.iter().enumerate() {
        for (channel, name) in CHANNELS.into_iter().enumerate() {
            let words = format!("at {:.4}, {:.4} px in the pixel", sample.place[0], sample.place[1]);
            scribe.read(format!("sample {index} {name}"), words, sample.color[channel]);
        }
    }
    let drawn = report.sources.iter().find(|source| [source.tap.x, source.tap.y] == report.drawn_at);
    let Some(drawn) = drawn else { return };
    for (channel, name) in CHANNELS.into_iter().enumerate() {
        let what = format!("mean {name}");
        let numbers = report.samples.iter().map(|sample| match light {
            ColorSpace::Bytes => given("code", sample.color[channel]),
            ColorSpace::Linear => given("light", decode_byte(sample.color[channel])),
        });
        let mean = sum(numbers) / whole("samples", count as i64);
        let formula = if light == ColorSpace::Bytes { mean } else { encoded(&mean, light) };
        let line = scribe.compute(what, drawn.color[channel], &formula);
        // The full formula would fill a page, so it is abbreviated.
        let number = if light == ColorSpace::Bytes { "codes" } else { "linear light, encoded" };
        line.formula = format!("Σ / {count} of the {number}");
        line.numbers = String::new();
    }
}

/// Writes the samples that contribute to an upscaled pixel, their weights, and the weighted sums.
fn upscale(recipe: &Recipe, frame: &Frame, at: (u32, u32), scribe: &mut TraceRecorder) {
    let Some(mixture) = Mixture::of(frame, recipe.upscaler, at) else { return };
    for source in &mixture.sources {
        let words = format!("of the drawn sample {}, {}", source.tap.x, source.tap.y);
        scribe.read("weight", words.clone(), source.tap.weight);
        for (channel, name) in CHANNELS.into_iter().enumerate() {
            scribe.read(format!("sample {name}"), words.clone(), source.color[channel]);
        }
    }
    let is_codes = recipe.upscaler.light() == FilterSpace::Bytes;
    for (channel, name) in CHANNELS.into_iter().enumerate().filter(|_| !mixture.sources.is_empty()) {
        let what = format!("weighted sum {name}");
        if is_codes {
            let term =
                |source: &ContributingSample| given("weight", source.tap.weight) * given("code", source.color[channel]);
            scribe.aside(what, mixture.sum[channel], &sum(mixture.sources.iter().map(term)));
        } else {
            scribe.read(what, "in linear light, then encoded", mixture.sum[channel]);
        }
    }
    if mixture.uses_history {
        scribe.decide("history", "part of the pixel comes from previous frames", "used");
    }
    let upscaler = recipe.upscaler.upscaler();
    scribe.decide("upscaler", "clamps, rounds, and applies the method's further steps", upscaler.name());
}
