//! Sample positions and resolve of the tiled execution, as selected by a recipe.

use super::samples::places_on_grid;
use crate::antialias::pattern::{Pattern, jitter_row};
use crate::antialias::resolve::{add_samples, means, means_of_sums};
use crate::antialias::settings::{AntialiasMethod, Antialiasing};
use crate::image::Rgba8;
use crate::math::lanes::Lanes;
use crate::pipeline::tiled::{JITTER_POSITIONS, Jittering, Multisampling, Picks, PixelSamples, SumOfSamples, Sums};

const _: () = assert!((Pattern::JITTER * Pattern::JITTER) as usize == JITTER_POSITIONS);

/// Calls `draw` with the samples that the tiled execution draws per pixel in one pass: all samples for multisampling
/// and jittered supersampling, and only the pixel's centre for other methods.
pub(super) fn with_pixel_samples<T>(
    antialias: Antialiasing,
    lanes: Lanes,
    draw: impl FnOnce(PixelSamples<'_>) -> T,
) -> T {
    let Antialiasing { method, light, seed, .. } = antialias;
    let places = places_on_grid(antialias);
    match method {
        AntialiasMethod::Multisample => {
            let mean = |colors: &[Rgba8], picks: &[Picks], out: &mut [Rgba8]| means(lanes, colors, picks, light, out);
            draw(PixelSamples::Multisampled(Multisampling { offsets: &places.concat(), mean: &mean }))
        }
        AntialiasMethod::Jittered => {
            let places: Vec<_> = places.iter().map(|places| std::array::from_fn(|place| places[place])).collect();
            let samples = places.len() as u32;
            let chosen = |sample: usize, columns: &[u32], row: u32, places: &mut [u8]| {
                jitter_row(columns, row, sample as u32, seed, places);
            };
            let add = |colors: &[Rgba8], sums: &mut [Sums]| add_samples(lanes, colors, light, sums);
            let mean = |sums: &[Sums], out: &mut [Rgba8]| means_of_sums(lanes, sums, samples, light, out);
            let sum = SumOfSamples { add: &add, mean: &mean };
            draw(PixelSamples::Jittered(Jittering { places: &places, chosen: &chosen, sum }))
        }
        _ => draw(PixelSamples::Centre),
    }
}
