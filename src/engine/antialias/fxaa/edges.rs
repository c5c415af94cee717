//! Edges of high contrast: their direction, the search for their ends, and the share of the neighbour that they give.

use super::{MARGIN, MIN_CONTRAST, MIN_CONTRAST_SHIFT, MIN_SHARE, SUBPIXEL};
use crate::antialias::luma::BLOCK;
use crate::math::lanes::*;

/// View of the luma around [`BLOCK`] adjacent pixels of a row.
#[derive(Clone, Copy)]
pub(super) struct Neighbourhood<'a> {
    pub(super) luma: &'a [i16],
    /// Distance between rows, in elements of `luma`.
    pub(super) stride: usize,
    /// Index in `luma` of the first of the [`BLOCK`] pixels.
    pub(super) place: usize,
}

/// Edges through [`BLOCK`] pixels, one edge per SIMD lane.
struct ContrastEdges<S: Simd> {
    /// Mask of the pixels with an edge.
    found: mask16x32<S>,
    /// Mask of the pixels whose neighbour across the edge lies above or to the left.
    towards_before: mask16x32<S>,
    /// Luma of each pixel plus the luma of its neighbour across the edge.
    line: i16x32<S>,
    /// Change of [`ContrastEdges::line`], up or down, at which the edge ends.
    ends_at: i16x32<S>,
}

/// Endpoints of the edges through [`BLOCK`] pixels, in one of the two directions along the edges.
#[derive(Clone, Copy)]
struct EdgeDistances<S: Simd> {
    /// Distance from the pixel to the endpoint of its edge, in pixels.
    step: i16x32<S>,
    /// Value of [`ContrastEdges::line`] at the endpoint of the edge minus its value at the pixel.
    change: i16x32<S>,
}

/// Blend weights and neighbours of [`BLOCK`] pixels. Bit `i` of each mask belongs to pixel `i`.
pub(super) struct Blends {
    /// Mask of the pixels with a blend weight of at least [`MIN_SHARE`].
    pub(super) found: u32,
    pub(super) horizontal: u32,
    pub(super) towards_before: u32,
    pub(super) shares: [f32; BLOCK],
}

impl Neighbourhood<'_> {
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, place: usize) -> i16x32<S> {
        i16x32::from_slice(simd, &self.luma[place..place + BLOCK])
    }

    /// Returns the luma of the neighbours above, below, to the left and to the right, and of the pixels themselves.
    #[inline(always)]
    fn cross<S: Simd>(&self, simd: S) -> [i16x32<S>; 5] {
        let Self { stride, place, .. } = *self;
        each!(at in [place - stride, place + stride, place - 1, place + 1, place] => self.at(simd, at))
    }

    /// Returns a mask of the pixels around which the contrast is large enough for an edge.
    #[inline(always)]
    pub(super) fn contrasts<S: Simd>(&self, simd: S) -> mask16x32<S> {
        let cross = self.cross(simd);
        let least = (brightest(cross) + ((1 << MIN_CONTRAST_SHIFT) - 1)) >> MIN_CONTRAST_SHIFT;
        contrast(cross).simd_ge(least.max(MIN_CONTRAST))
    }

    /// Computes the neighbour to blend with and the blend weight of each pixel in the mask `found`.
    #[inline(always)]
    pub(super) fn blends<S: Simd>(&self, simd: S, found: mask16x32<S>) -> Blends {
        let cross = self.cross(simd);
        let [n, s, w, e, middle] = cross;
        let [above, below] = [self.place - self.stride, self.place + self.stride];
        let [nw, ne, sw, se] = each!(at in [above - 1, above + 1, below - 1, below + 1] => self.at(simd, at));
        let across_rows = bend(n, middle, s) * 2 + bend(nw, w, sw) + bend(ne, e, se);
        let across_columns = bend(w, middle, e) * 2 + bend(nw, n, ne) + bend(sw, s, se);
        let horizontal = across_rows.simd_ge(across_columns);
        let (before, after) = (horizontal.select(n, w), horizontal.select(s, e));
        let towards_before = (before - middle).abs().simd_ge((after - middle).abs());
        let beyond = towards_before.select(before, after);
        let gradient = (beyond - middle).abs();
        let found = found & gradient.simd_gt(0);

        let (line, ends_at) = (middle + beyond, (gradient + 1) >> 1);
        let edges = ContrastEdges { found: found & horizontal, towards_before, line, ends_at };
        let zero = i16x32::splat(simd, 0);
        let mut ends = [EdgeDistances { step: i16x32::splat(simd, 1), change: zero }; 2];
        self.search(simd, [1, self.stride], &edges, &mut ends);
        self.search(simd, [self.stride, 1], &ContrastEdges { found: found & !horizontal, ..edges }, &mut ends);
        let [back, ahead] = ends;
        let nearest = back.step.simd_le(ahead.step).select(back.change, ahead.change);
        // The line cuts into a pixel if, at the nearer endpoint, the luma changes towards that of the neighbour
        // `beyond`.
        let cuts_in = nearest.simd_lt(0) ^ middle.simd_lt(beyond);
        let off_centre = (found & cuts_in).select((ahead.step - back.step).abs(), zero);
        let around = (n + s + w + e) * 2 + nw + ne + sw + se;
        let stands_out = found.select((around - middle * 12).abs(), zero);

        let (off_low, off_high) = off_centre.widen();
        let (length_low, length_high) = (back.step + ahead.step).widen();
        let (out_low, out_high) = stands_out.widen();
        let (contrast_low, contrast_high) = contrast(cross).widen();
        let low = share([off_low, length_low, out_low, contrast_low]);
        let high = share([off_high, length_high, out_high, contrast_high]);
        let mut shares = [0.0; BLOCK];
        low.store_slice(&mut shares[..WIDE]);
        high.store_slice(&mut shares[WIDE..]);
        Blends {
            // The mask excludes pixels without contrast, whose share is 0 / 0.
            found: (found & low.simd_ge(MIN_SHARE).narrow(high.simd_ge(MIN_SHARE))).to_bitmask() as u32,
            horizontal: horizontal.to_bitmask() as u32,
            towards_before: towards_before.to_bitmask() as u32,
            shares,
        }
    }

    /// Follows edges in both directions. `along` and `across` are the distances between neighbours along and across the
    /// edge, in elements of the luma buffer.
    #[inline(always)]
    fn search<S: Simd>(
        &self,
        simd: S,
        [along, across]: [usize; 2],
        edges: &ContrastEdges<S>,
        [back, ahead]: &mut [EdgeDistances<S>; 2],
    ) {
        let [mut going_back, mut going_ahead] = [edges.found; 2];
        for step in 1..=MARGIN {
            if !(going_back | going_ahead).any_true() {
                break;
            }
            let [before, after] = each!(place in [self.place - step * along, self.place + step * along] => {
                let beyond =
                    edges.towards_before.select(self.at(simd, place - across), self.at(simd, place + across));
                self.at(simd, place) + beyond - edges.line
            });
            going_back = back.extend(going_back, step, before, edges.ends_at);
            going_ahead = ahead.extend(going_ahead, step, after, edges.ends_at);
        }
    }
}

impl<S: Simd> EdgeDistances<S> {
    /// Moves the endpoints of the edges in the mask `going` to the distance `step`, in pixels. Returns a mask of the
    /// edges that continue beyond this distance.
    #[inline(always)]
    fn extend(&mut self, going: mask16x32<S>, step: usize, change: i16x32<S>, ends_at: i16x32<S>) -> mask16x32<S> {
        self.step = going.select(i16x32::splat(change.simd, step as i16), self.step);
        self.change = going.select(change, self.change);
        going & change.abs().simd_lt(ends_at)
    }
}

#[inline(always)]
fn brightest<S: Simd>([n, s, w, e, middle]: [i16x32<S>; 5]) -> i16x32<S> {
    n.max(s).max(w).max(e).max(middle)
}

/// Returns the difference between the brightest and the darkest luma among a pixel and its four neighbours.
#[inline(always)]
fn contrast<S: Simd>(cross: [i16x32<S>; 5]) -> i16x32<S> {
    let [n, s, w, e, middle] = cross;
    brightest(cross) - n.min(s).min(w).min(e).min(middle)
}

/// Returns the blend weights of pixels. The weight is the distance from the pixel to the middle of its edge, divided by
/// the edge's length. It is larger if the luma of the pixel differs much from that of its neighbours.
///
/// The elements of `numbers` are: the difference between the pixel's distances to the two endpoints, the edge's length,
/// twelve times the luma difference between the pixel and the weighted mean of its neighbours, and the contrast.
#[inline(always)]
fn share<S: Simd>(numbers: [i32x16<S>; 4]) -> f32x16<S> {
    let [off_centre, length, stands_out, contrast] = each!(i in [0, 1, 2, 3] => numbers[i].to_float::<f32x16<S>>());
    let of_line = off_centre * 0.5 / length;
    let stands_out = (stands_out / (contrast * 12.0)).min(1.0);
    let smooth = stands_out * stands_out * (3.0 - stands_out * 2.0);
    of_line.max(smooth * smooth * SUBPIXEL)
}

/// Returns the magnitude of the second difference of luma, over three adjacent pixels.
#[inline(always)]
fn bend<S: Simd>(before: i16x32<S>, own: i16x32<S>, after: i16x32<S>) -> i16x32<S> {
    (before + after - own * 2).abs()
}
