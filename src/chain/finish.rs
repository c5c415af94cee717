//! From what was drawn to the full picture: upscaled, filtered, with lines laid over it.

use std::time::{Duration, Instant};

use super::Recipe;
use crate::antialias::post;
use crate::image::{Image, Rgba8};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::wireframe;
use crate::upscale::Drawn;

/// The full picture before filter and lines: never held twice.
#[derive(Clone, Debug)]
pub(super) enum Unfiltered {
    /// The finished one, as nothing came over it.
    Finished,
    /// What was drawn.
    Drawn,
    /// Neither of both.
    Kept(Image<Rgba8>),
}

/// A full picture, none if that is what was drawn, the same before filter and lines, and what the next frame is to remember.
pub(super) struct Finished {
    pub(super) picture: Option<Image<Rgba8>>,
    pub(super) unfiltered: Unfiltered,
    pub(super) memory: Option<Image<[f32; 4]>>,
    /// Time of the post filter and of the wireframe.
    pub(super) post: Duration,
}

/// Memory that is no longer needed: a full picture, and what an upscaler remembered.
#[derive(Debug, Default)]
pub(super) struct Spare {
    pub(super) full: Option<Image<Rgba8>>,
    pub(super) memory: Option<Image<[f32; 4]>>,
}

/// The full picture from what was drawn, in memory that is no longer needed.
pub(super) fn finish<'a>(
    recipe: &Recipe,
    drawn: &Drawn<'_>,
    viewport: Viewport,
    mut spare: Spare,
    triangles: impl Fn() -> &'a TriangleList,
) -> Finished {
    let Viewport { width, height } = viewport;
    let (upscaled, memory) = if recipe.upscaler.is_native() {
        (None, None)
    } else {
        let mut full = Image::reusing(spare.full.take(), width, height, [0; 4]);
        let upscaler = recipe.upscaler.upscaler();
        let memory = upscaler.upscale_and_remember(recipe.upscaler, drawn, &mut full, spare.memory);
        (Some(full), memory)
    };
    let upscaled_at = Instant::now();
    let filtered = post::apply(&recipe.post, upscaled.as_ref().unwrap_or(drawn.color), spare.full);
    if filtered.is_none() && !recipe.wireframe {
        return Finished { picture: upscaled, unfiltered: Unfiltered::Finished, memory, post: Duration::ZERO };
    }
    let mut picture = filtered.unwrap_or_else(|| upscaled.as_ref().unwrap_or(drawn.color).clone());
    if recipe.wireframe {
        wireframe::overlay(triangles(), &mut picture);
    }
    let unfiltered = upscaled.map_or(Unfiltered::Drawn, Unfiltered::Kept);
    Finished { picture: Some(picture), unfiltered, memory, post: upscaled_at.elapsed() }
}
