//! Finishing: turns the drawn picture into the full picture by upscaling, post filter and wireframe.

use std::time::{Duration, Instant};

use super::Recipe;
use crate::antialias::post;
use crate::image::{Image, Rgba8};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::wireframe;
use crate::upscale::UpscaleInputs;

/// Full picture before post filter and wireframe. It is stored only if it differs from the drawn and the finished
/// picture.
#[derive(Clone, Debug)]
pub(super) enum Unfiltered {
    /// Same as the finished picture, because there is neither filter nor wireframe.
    Finished,
    /// Same as the drawn picture.
    Drawn,
    /// Stored separately, because it differs from both.
    Kept(Image<Rgba8>),
}

/// Result of [`finish`]: the full picture (`None` if it is the drawn one), its state before post filter and wireframe,
/// and the upscaler's history for the next frame.
pub(super) struct Finished {
    pub(super) picture: Option<Image<Rgba8>>,
    pub(super) unfiltered: Unfiltered,
    pub(super) history: Option<Image<[f32; 4]>>,
    /// Time taken by the post filter and the wireframe.
    pub(super) post: Duration,
}

/// Spare buffers for reuse: a full picture, and the history of an upscaler.
#[derive(Debug, Default)]
pub(super) struct Spare {
    pub(super) full: Option<Image<Rgba8>>,
    pub(super) history: Option<Image<[f32; 4]>>,
}

/// Computes the full picture from the drawn one, reusing spare buffers.
pub(super) fn finish<'a>(
    recipe: &Recipe,
    drawn: &UpscaleInputs<'_>,
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
        let memory = upscaler.upscale_with_history(recipe.upscaler, drawn, &mut full, spare.history);
        (Some(full), memory)
    };
    let upscaled_at = Instant::now();
    let filtered = post::apply(&recipe.post, upscaled.as_ref().unwrap_or(drawn.color), spare.full);
    if filtered.is_none() && !recipe.wireframe {
        return Finished { picture: upscaled, unfiltered: Unfiltered::Finished, history: memory, post: Duration::ZERO };
    }
    let mut picture = filtered.unwrap_or_else(|| upscaled.as_ref().unwrap_or(drawn.color).clone());
    if recipe.wireframe {
        wireframe::overlay(triangles(), &mut picture);
    }
    let unfiltered = upscaled.map_or(Unfiltered::Drawn, Unfiltered::Kept);
    Finished { picture: Some(picture), unfiltered, history: memory, post: upscaled_at.elapsed() }
}
