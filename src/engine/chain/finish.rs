//! Finishing: turns the drawn picture into the finished one, by upscaling, a post filter and a wireframe overlay.

use std::time::{Duration, Instant};

use super::Recipe;
use super::pool::BufferPool;
use crate::antialias::post;
use crate::image::{Image, Rgba8};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::wireframe;
use crate::upscale::{Accumulated, UpscaleInputs, Upscaled};

/// Full-resolution picture before the post filter and the wireframe. It is stored separately only if it differs from
/// both the drawn and the finished picture.
#[derive(Clone, Debug)]
pub(super) enum Unfiltered {
    /// Identical to the finished picture, because there is neither filter nor wireframe.
    Finished,
    /// Identical to the drawn picture, because there is no upscaling.
    Drawn,
    /// Stored separately, because it differs from both the drawn and the finished picture.
    Kept(Image<Rgba8>),
}

/// Result of [`finish`]. `picture` is the finished picture, or `None` if the drawn picture is already finished.
/// `unfiltered` is the full-resolution picture before the post filter and the wireframe. `history` is the upscaler's
/// history for the next frame.
pub(super) struct Finished {
    pub(super) picture: Option<Image<Rgba8>>,
    pub(super) unfiltered: Unfiltered,
    pub(super) history: Option<Accumulated>,
    /// Time taken by transfers to and from the process of the upscaler.
    pub(super) transfer: Duration,
    /// Time taken by the post filter and the wireframe.
    pub(super) post: Duration,
}

/// Upscales and filters the drawn picture and overlays the wireframe, as selected by `recipe`. Reuses buffers
/// of the pool.
pub(super) fn finish<'a>(
    recipe: &Recipe,
    drawn: &UpscaleInputs<'_>,
    viewport: Viewport,
    pool: &mut BufferPool,
    triangles: impl Fn() -> &'a TriangleList,
) -> Finished {
    let Viewport { width, height } = viewport;
    let (upscaled, result) = if recipe.upscaler.is_native() {
        (None, Upscaled::default())
    } else {
        let mut full = Image::reusing(pool.codes((width, height)), width, height, [0; 4]);
        let upscaler = recipe.upscaler.upscaler();
        let result = upscaler.upscale_with_history(recipe.upscaler, drawn, &mut full, pool.history());
        (Some(full), result)
    };
    let Upscaled { history, transfer } = result;
    let upscaled_at = Instant::now();
    let spare = if recipe.post.is_off() { None } else { pool.codes((width, height)) };
    let filtered = post::apply(&recipe.post, upscaled.as_ref().unwrap_or(drawn.color), spare);
    if filtered.is_none() && !recipe.wireframe {
        let (unfiltered, post) = (Unfiltered::Finished, Duration::ZERO);
        return Finished { picture: upscaled, unfiltered, history, transfer, post };
    }
    let mut picture = filtered.unwrap_or_else(|| upscaled.as_ref().unwrap_or(drawn.color).clone());
    if recipe.wireframe {
        wireframe::overlay(triangles(), &mut picture);
    }
    let unfiltered = upscaled.map_or(Unfiltered::Drawn, Unfiltered::Kept);
    Finished { picture: Some(picture), unfiltered, history, transfer, post: upscaled_at.elapsed() }
}
