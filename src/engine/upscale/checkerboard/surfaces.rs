//! Checkerboard rendering with missing pixels interpolated only from neighbours on the same surface.
//!
//! The object and distance of every pixel are known, because they are found without shading. A missing pixel is the
//! weighted mean of up to four drawn pixels, two in its row and two in its column. Only pixels with the same object at
//! about the same distance contribute, nearer ones with more weight. If there are none, the plain mean is used.

use arrayvec::ArrayVec;

use super::squares::{DrawnNeighbours, Fill, MissingRun, channel, fill, pixels};
use super::{BEHIND, OFFERS, PixelPosition, TOUCHING, neighbours};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::grid::SampleGrid;
use crate::upscale::{Offers, Reads, Sampling, Tap, UpscaleInputs, Upscaler, Upscaling};

/// Checkerboard rendering that interpolates missing pixels from neighbours on the same surface.
pub(crate) static CHECKERBOARD_SURFACES: CheckerboardSurfaces = CheckerboardSurfaces;

/// [`Upscaler`] implementation of [`CHECKERBOARD_SURFACES`].
pub(crate) struct CheckerboardSurfaces;

impl Upscaler for CheckerboardSurfaces {
    fn id(&self) -> &'static str {
        "checkerboard-surfaces"
    }

    fn name(&self) -> &'static str {
        "Checkerboard, by surface"
    }

    fn help(&self) -> &'static str {
        "Draws the 2×2-pixel squares of one colour of a checkerboard, and determines the object and the distance of \
         every pixel; a missing pixel is interpolated only from neighbours on the same surface. Outlines stay sharp; \
         textures lose detail as in the plain checkerboard. Half of the pixels are shaded, but the surfaces of all are \
         determined: it saves time where shading costs more than that, as with supersampling. Consoles use an id \
         buffer in hardware for this (PlayStation 4 Pro, 2016)."
    }

    fn artefacts(&self) -> &'static str {
        "thin lines break, textures lose detail"
    }

    fn offers(&self) -> Offers {
        OFFERS
    }

    fn reads(&self) -> Reads {
        Reads { gbuffer: true, history: false }
    }

    fn sampling(&self, _how: Upscaling) -> Sampling {
        Sampling::Grid(SampleGrid::Checkerboard)
    }

    fn upscale(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        let by = SurfaceFill { grid: SampleGrid::Checkerboard, drawn, size: full.size() };
        fill(Lanes::best(), SampleGrid::Checkerboard, drawn.color, full, &by);
    }

    fn pixel(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        filled(SampleGrid::Checkerboard, drawn, size, at)
    }

    fn taps(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        taps(SampleGrid::Checkerboard, drawn, size, at).to_vec()
    }
}

/// Unnormalised weights of a drawn pixel that touches the missing pixel, and of one behind it.
const NEAR_AND_FAR: [f32; 2] = [2.0, 1.0];

/// Kernel that interpolates missing pixels from neighbours on the same surface.
pub(super) struct SurfaceFill<'a> {
    pub(crate) grid: SampleGrid,
    pub(crate) drawn: &'a UpscaleInputs<'a>,
    pub(crate) size: (u32, u32),
}

impl Fill for SurfaceFill<'_> {
    fn pixel(&self, at: PixelPosition) -> Rgba8 {
        filled(self.grid, self.drawn, self.size, at)
    }

    #[inline(always)]
    fn missing<S: Simd>(&self, simd: S, run: &MissingRun, around: DrawnNeighbours<S>) -> u32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let [near, far] = each!(place in [0, 1] => f32x16::splat(simd, NEAR_AND_FAR[place]));
        let DrawnNeighbours { beside, across, far_beside, far_across } = around;
        let mut weights = [zero; 4];
        if let Some(seen) = self.drawn.frame {
            let same = run.same_surface_masks(simd, seen.gbuffer);
            weights = each!((place, weight) in [(0, near), (1, near), (2, far), (3, far)] => same[place].select(weight, zero));
        }
        let sum = ((weights[0] + weights[1]) + weights[2]) + weights[3];
        let none = sum.simd_eq(zero);
        weights[0] = none.select(near, weights[0]);
        weights[1] = none.select(near, weights[1]);
        let sum = none.select(near + near, sum);
        let shares = each!(place in [0, 1, 2, 3] => weights[place] / sum);
        pixels(each!(index in [0, 1, 2, 3] => {
            let [a, b, c, d] = each!(words in [beside, across, far_beside, far_across] => channel(words, index));
            (((shares[0] * a + shares[1] * b) + shares[2] * c) + shares[3] * d) + 0.5
        }))
    }
}

/// Computes one pixel of the full image; `grid` specifies which half of the pixels was drawn.
pub(super) fn filled(grid: SampleGrid, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
    let color = |tap: &Tap| grid.sample_at(tap.x, tap.y).map_or([0; 4], |(column, row)| drawn.color.at(column, row));
    let taps = taps(grid, drawn, size, at);
    if let [only] = taps.as_slice() {
        return color(only);
    }
    let mut sums = [0.0; 4];
    for tap in &taps {
        for (sum, code) in sums.iter_mut().zip(color(tap)) {
            *sum += tap.weight * f32::from(code);
        }
    }
    sums.map(|sum: f32| (sum + 0.5) as u8)
}

/// Returns the drawn pixels that contribute to a pixel, with weights that sum to 1.
pub(super) fn taps(
    grid: SampleGrid,
    drawn: &UpscaleInputs<'_>,
    size: (u32, u32),
    (x, y): PixelPosition,
) -> ArrayVec<Tap, 4> {
    if grid.sample_at(x, y).is_some() {
        return ArrayVec::from_iter([Tap { x, y, weight: 1.0 }]);
    }
    let surfaces = drawn.frame.map(|seen| seen.gbuffer);
    let (mut all, mut used) = (ArrayVec::<(PixelPosition, f32), 4>::new(), ArrayVec::<(PixelPosition, f32), 4>::new());
    for (by, weight) in [TOUCHING, BEHIND].into_iter().zip(NEAR_AND_FAR) {
        for at in neighbours(by, size, (x, y)).into_iter().flatten() {
            all.push((at, weight));
            if surfaces.is_some_and(|surfaces| surfaces.same_surface(at, (x, y))) {
                used.push((at, weight));
            }
        }
    }
    if used.is_empty() {
        let nearest = all.iter().map(|(_, weight)| *weight).fold(0.0, f32::max);
        used = all.into_iter().filter(|(_, weight)| *weight == nearest).collect();
    }
    let sum: f32 = used.iter().map(|(_, weight)| weight).sum();
    if used.is_empty() {
        // The image is so small that no pixel near this one was drawn.
        return drawn_nearest(grid, size, (x, y)).into_iter().collect();
    }
    used.into_iter().map(|((x, y), weight)| Tap { x, y, weight: weight / sum }).collect()
}

/// Returns the nearest drawn pixel, found by testing all of them.
fn drawn_nearest(grid: SampleGrid, (width, height): (u32, u32), (x, y): (u32, u32)) -> Option<Tap> {
    let all = (0..height).flat_map(|j| (0..width).map(move |i| (i, j)));
    let drawn = all.filter(|(i, j)| grid.sample_at(*i, *j).is_some());
    let (x, y) = drawn.min_by_key(|(i, j)| x.abs_diff(*i).pow(2) + y.abs_diff(*j).pow(2))?;
    Some(Tap { x, y, weight: 1.0 })
}
