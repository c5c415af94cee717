//! From what was drawn to the full picture: upscaled, filtered, with lines laid over it.

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

/// A full picture, none if that is what was drawn, and the same before filter and lines.
pub(super) struct Finished {
    pub(super) picture: Option<Image<Rgba8>>,
    pub(super) unfiltered: Unfiltered,
}

/// The full picture from what was drawn, in memory that is no longer needed.
pub(super) fn finish<'a>(
    recipe: &Recipe,
    drawn: &Drawn<'_>,
    viewport: Viewport,
    memory: Option<Image<Rgba8>>,
    triangles: impl Fn() -> &'a TriangleList,
) -> Finished {
    let Viewport { width, height } = viewport;
    let upscaled = (!recipe.upscaler.is_native()).then(|| {
        let mut full = Image::reusing(memory, width, height, [0; 4]);
        recipe.upscaler.upscaler().upscale(recipe.upscaler, drawn, &mut full);
        full
    });
    let filtered = post::apply(&recipe.post, upscaled.as_ref().unwrap_or(drawn.color));
    if filtered.is_none() && !recipe.wireframe {
        return Finished { picture: upscaled, unfiltered: Unfiltered::Finished };
    }
    let mut picture = filtered.unwrap_or_else(|| upscaled.as_ref().unwrap_or(drawn.color).clone());
    if recipe.wireframe {
        wireframe::overlay(triangles(), &mut picture);
    }
    Finished { picture: Some(picture), unfiltered: upscaled.map_or(Unfiltered::Drawn, Unfiltered::Kept) }
}
