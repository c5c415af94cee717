//! Checkerboard rendering with missing pixels interpolated along edges instead of across them.
//!
//! A missing pixel lies between two drawn ones in its row and two in its column; one pixel of each pair is at distance
//! 1, the other at distance 2. Each pair is interpolated linearly. The pair whose two pixels differ less in luma gets
//! more weight. If this difference is dh for the pair in the row and dv for the pair in the column, the weight of the
//! row is (1 + dv²) / (2 + dh² + dv²). At borders, where a pair is incomplete, the plain mean of `checkerboard` is
//! used.

use super::mean::{CHECKERBOARD, mean_of_sources};
use super::squares::{DrawnNeighbours, Fill, MissingRun, channel, fill, pixels};
use super::{BEHIND, OFFERS, PixelPosition, TOUCHING, neighbours, packed_column};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::grid::SampleGrid;
use crate::upscale::{Offers, Sampling, Tap, UpscaleInputs, Upscaler, Upscaling};

/// Checkerboard rendering that interpolates missing pixels along edges.
pub(crate) static CHECKERBOARD_EDGES: CheckerboardEdges = CheckerboardEdges;

/// [`Upscaler`] implementation of [`CHECKERBOARD_EDGES`].
pub(crate) struct CheckerboardEdges;

impl Upscaler for CheckerboardEdges {
    fn id(&self) -> &'static str {
        "checkerboard-edges"
    }

    fn name(&self) -> &'static str {
        "Checkerboard, along edges"
    }

    fn help(&self) -> &'static str {
        "Draws the 2×2-pixel squares of one colour of a checkerboard and interpolates the others along row and column, \
         with more weight for the one that changes less. Good on vertical and horizontal edges, which the plain \
         checkerboard frays. Slanted edges and lines one pixel wide still break up, because half of them was never \
         drawn. Preferring the direction of the smaller difference comes from the demosaicing of camera images \
         (Hamilton and Adams, 1997)."
    }

    fn artefacts(&self) -> &'static str {
        "slanted edges fray, thin lines break"
    }

    fn offers(&self) -> Offers {
        OFFERS
    }

    fn sampling(&self, _how: Upscaling) -> Sampling {
        Sampling::Grid(SampleGrid::Checkerboard)
    }

    fn upscale(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        let by = AlongEdges { drawn: drawn.color, size: full.size() };
        fill(Lanes::best(), SampleGrid::Checkerboard, drawn.color, full, &by);
    }

    fn pixel(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        mixed(drawn.color, size, at)
    }

    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let Some(pairs) = pairs(size, at) else {
            return CHECKERBOARD.taps(how, drawn, size, at);
        };
        let shares = shares(pairs.map(|(x, y)| drawn.color.at(packed_column(x), y)));
        let taps = pairs.into_iter().zip(shares);
        taps.map(|((x, y), weight)| Tap { x, y, weight }).filter(|tap| tap.weight != 0.0).collect()
    }
}

/// Returns the four drawn pixels around a missing pixel: near and far in its row, then near and far in its column.
/// Returns `None` if one lies outside the image.
fn pairs(size: (u32, u32), at: PixelPosition) -> Option<[PixelPosition; 4]> {
    if SampleGrid::Checkerboard.sample_at(at.0, at.1).is_some() {
        return None;
    }
    let [[beside, across], [far_beside, far_across]] = [TOUCHING, BEHIND].map(|by| neighbours(by, size, at));
    Some([beside?, far_beside?, across?, far_across?])
}

/// Weight of the nearer of two pixels at distances 1 and 2, for linear interpolation.
const NEAR: f32 = 2.0 / 3.0;

/// Returns the weights of the four pixels of [`pairs`], given their colours; the weights sum to 1.
fn shares(colors: [Rgba8; 4]) -> [f32; 4] {
    let luma = |[r, g, b, _]: Rgba8| f32::from(r) + 2.0 * f32::from(g) + f32::from(b);
    let [across, down] = [(0, 1), (2, 3)].map(|(near, far)| (luma(colors[near]) - luma(colors[far])) / 4.0);
    let (across, down) = (across * across, down * down);
    let of_row = (1.0 + down) / (2.0 + across + down);
    let of_column = 1.0 - of_row;
    [of_row * NEAR, of_row * (1.0 - NEAR), of_column * NEAR, of_column * (1.0 - NEAR)]
}

fn mixed(drawn: &Image<Rgba8>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
    let Some(pairs) = pairs(size, at) else {
        return mean_of_sources(drawn, size, at);
    };
    let colors = pairs.map(|(x, y)| drawn.at(packed_column(x), y));
    let shares = shares(colors);
    std::array::from_fn(|channel| {
        let mut sum = 0.5;
        for (share, color) in shares.iter().zip(&colors) {
            sum += share * f32::from(color[channel]);
        }
        sum as u8
    })
}

/// Kernel that interpolates missing pixels along edges.
pub(super) struct AlongEdges<'a> {
    pub(crate) drawn: &'a Image<Rgba8>,
    pub(crate) size: (u32, u32),
}

impl Fill for AlongEdges<'_> {
    fn pixel(&self, at: PixelPosition) -> Rgba8 {
        mixed(self.drawn, self.size, at)
    }

    /// Interpolates 16 missing pixels at a time along edges; see [`mixed`] for one pixel.
    #[inline(always)]
    fn missing<S: Simd>(&self, simd: S, _run: &MissingRun, around: DrawnNeighbours<S>) -> u32x16<S> {
        let DrawnNeighbours { beside, across, far_beside, far_across } = around;
        let [r, g, b, a] = each!(index in [0, 1, 2, 3] => {
            each!(words in [beside, far_beside, across, far_across] => channel(words, index))
        });
        let luma = each!(place in [0, 1, 2, 3] => r[place] + g[place] * 2.0 + b[place]);
        let [across, down] = each!((near, far) in [(0, 1), (2, 3)] => (luma[near] - luma[far]) * 0.25);
        let (across, down) = (across * across, down * down);
        let of_row = (down + 1.0) / (across + 2.0 + down);
        let of_column = f32x16::splat(simd, 1.0) - of_row;
        let shares = [of_row * NEAR, of_row * (1.0 - NEAR), of_column * NEAR, of_column * (1.0 - NEAR)];
        pixels(each!(codes in [r, g, b, a] => {
            ((((shares[0] * codes[0]) + 0.5) + shares[1] * codes[1]) + shares[2] * codes[2]) + shares[3] * codes[3]
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::Scale;

    /// Extracts the checkerboard samples of an image and upscales them again.
    fn refilled(picture: &Image<Rgba8>) -> Image<Rgba8> {
        let (width, height) = picture.size();
        let grid = SampleGrid::Checkerboard;
        let (columns, rows) = grid.packed_size(width, height);
        let drawn = Image::from_fn(columns, rows, |column, row| {
            let (x, y) = grid.pixel(column, row);
            picture.get(x, y).unwrap_or([9; 4])
        });
        let how = Upscaling::new("checkerboard-edges", Scale::ONE).unwrap();
        how.upscale(&UpscaleInputs::from(&drawn), width, height)
    }

    #[test]
    fn upright_and_level_edges_come_back_as_they_were() {
        for edge in 0..16 {
            for upright in [false, true] {
                let picture = Image::from_fn(16, 16, |x, y| {
                    let at = if upright { x } else { y };
                    if at < edge { [10, 20, 30, 255] } else { [240, 200, 90, 255] }
                });
                let full = refilled(&picture);
                // Away from the border, where both pairs are complete.
                for (x, y) in (2..14).flat_map(|y| (2..14).map(move |x| (x, y))) {
                    assert_eq!(full.at(x, y), picture.at(x, y), "edge at {edge}, upright {upright}: ({x}, {y})");
                }
            }
        }
    }

    #[test]
    fn a_linear_ramp_is_reconstructed() {
        let slope = Image::from_fn(20, 20, |x, y| [(x * 6 + y * 3) as u8; 4]);
        let full = refilled(&slope);
        for (x, y) in (2..18).flat_map(|y| (2..18).map(move |x| (x, y))) {
            assert!(full.at(x, y)[0].abs_diff(slope.at(x, y)[0]) <= 1, "({x}, {y})");
        }
    }
}
