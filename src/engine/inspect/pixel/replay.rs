//! Replay of one pixel with an observer, which gives its report without the verdict.

use super::recorder::FragmentRecorder;
use super::{PixelReport, SampleRecord, SourceRecord};
use crate::antialias::{post, resolve};
use crate::chain::{Frame, Recipe, replay, samples};
use crate::image::{Image, Rgba8};
use crate::inspect::depth::DepthRecord;
use crate::inspect::hits::fault_at;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::Scissor;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{DrawCall, Extent, wireframe};
use crate::scene::Scene;
use crate::upscale::Tap;

/// Replays pixel (x, y) and returns its report with an empty verdict; `None` outside the picture.
pub(in crate::inspect) fn replayed(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    x: u32,
    y: u32,
) -> Option<PixelReport> {
    let Viewport { width, height } = frame.viewport;
    if x >= width || y >= height {
        return None;
    }
    let (how, upscaler) = (recipe.upscaler, recipe.upscaler.upscaler());
    let taps = upscaler.taps(how, &frame.as_drawn(&frame.drawn.color), (width, height), (x, y));
    let pixels: Vec<_> = taps.iter().map(|tap| (tap.x, tap.y)).collect();
    let replayed = replay::replay(scene, recipe, frame, &pixels);
    let sources: Vec<_> = taps.into_iter().zip(&replayed).map(|(tap, samples)| source(frame, tap, samples)).collect();
    let main = (0..sources.len()).max_by(|a, b| sources[*a].tap.weight.total_cmp(&sources[*b].tap.weight));
    // A frame of at most 2 × 2 pixels may draw no pixel at all. All its pixels then come from the history.
    let drawn_at = main.filter(|_| !frame.is_drawn(x, y)).map_or((x, y), |main| pixels[main]);
    let samples = pixels.iter().position(|pixel| *pixel == drawn_at).map_or_else(Vec::new, |place| {
        let places = samples::places(frame.antialias, drawn_at);
        places.into_iter().zip(&replayed[place]).map(|(place, color)| SampleRecord { place, color: *color }).collect()
    });
    let mut recorder = FragmentRecorder::new(scene, recipe, frame);
    let final_depth = replay(scene, recipe, frame, drawn_at, &mut recorder).flatten();

    let upscaled = if upscaler.is_opaque() {
        frame.unfiltered().at(x, y)
    } else {
        upscaler.pixel(how, &frame.as_drawn(&picture_of(&sources, frame)), (width, height), (x, y))
    };
    let filtered = filtered(recipe, frame, (x, y), upscaled);
    let below = filtered.unwrap_or(upscaled);
    let wireframe = recipe.wireframe.then(|| wireframe::crosses(frame.outlines(), (width, height), (x, y))).flatten();
    let color = if wireframe.is_some() { wireframe::line_color(below) } else { below };
    Some(PixelReport {
        x,
        y,
        verdict: String::new(),
        color,
        drawn_at: drawn_at.into(),
        samples: if frame.antialias.is_off() { Vec::new() } else { samples },
        clear: recorder.clear,
        fragments: recorder.finish(),
        absent: Vec::new(),
        final_depth: final_depth.map(|depth| DepthRecord::new(depth, frame.depth_scale())),
        sources,
        history: upscaler.history_steps(how, &frame.as_drawn(&frame.drawn.color))((x, y)),
        temporal: None,
        unfiltered: filtered.map(|_| upscaled),
        wireframe,
        fault: fault_at(frame, &recipe.pipeline, drawn_at.0, drawn_at.1).filter(|_| frame.is_drawn(x, y)),
        remedies: Vec::new(),
    })
}

fn source(frame: &Frame, tap: Tap, samples: &[Rgba8]) -> SourceRecord {
    let color = match samples {
        [only] if frame.antialias.is_off() => *only,
        samples => resolve::mean(samples, frame.antialias.light),
    };
    SourceRecord { tap, color }
}

/// Returns the colour of a pixel after the post filter, computed from its replayed colour `own` and its neighbours in
/// the frame; `None` without a filter.
fn filtered(recipe: &Recipe, frame: &Frame, (x, y): (u32, u32), own: Rgba8) -> Option<Rgba8> {
    let reach = i64::from(post::reach(&recipe.post)?);
    let around = |at: u32| (i64::from(at) - reach, 2 * reach as u32 + 1);
    let ((left, width), (top, height)) = (around(x), around(y));
    let neighbours = Image::from_fn(width, height, |column, row| {
        let (i, j) = (left + i64::from(column), top + i64::from(row));
        let is_own = |at: i64, length: u32, own: u32| at.clamp(0, i64::from(length) - 1) == i64::from(own);
        if is_own(i, frame.viewport.width, x) && is_own(j, frame.viewport.height, y) {
            own
        } else {
            frame.unfiltered().at_clamped(i, j)
        }
    });
    post::apply(&recipe.post, &neighbours, None).map(|patch| patch.at(reach as u32, reach as u32))
}

/// Returns the packed drawn picture with only the replayed sources filled in. The upscaler reads no other pixels.
fn picture_of(sources: &[SourceRecord], frame: &Frame) -> Image<Rgba8> {
    let (width, height) = frame.drawn.color.size();
    let mut picture = Image::filled(width, height, [0; 4]);
    for source in sources {
        if let Some((column, row)) = frame.drawn.grid.sample_at(source.tap.x, source.tap.y) {
            picture.set(column, row, source.color);
        }
    }
    picture
}

/// Draws only the sample at the centre of one drawn pixel and returns its colour.
pub(in crate::inspect) fn centre_color(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    pixel: (u32, u32),
) -> Option<Rgba8> {
    Some(draw_centre(scene, recipe, frame, pixel, &mut ())?.color.at(0, 0))
}

/// Draws only the sample at the centre of one drawn pixel with an observer, and returns its final depth, if any.
fn replay<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    pixel: (u32, u32),
    observer: &mut O,
) -> Option<Option<f32>> {
    let one = draw_centre(scene, recipe, frame, pixel, observer)?;
    Some(one.depth.map(|d| d.at(0, 0)))
}

fn draw_centre<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    (x, y): (u32, u32),
    observer: &mut O,
) -> Option<Framebuffer> {
    let grid = frame.drawn.grid;
    let sample = grid.sample_at(x, y)?;
    let mut one = Framebuffer::one_sample(grid, sample, scene.background, &recipe.pipeline);
    let extent = Extent { triangles: 0..frame.geometry().triangles.len(), scissor: Scissor::pixel(x, y) };
    DrawCall::new(scene, frame.geometry(), &recipe.pipeline, &extent).draw(&mut one, observer);
    Some(one)
}
