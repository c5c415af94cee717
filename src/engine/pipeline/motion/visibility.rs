//! Visibility of moved surface points in the preceding frame.

use super::MotionVectors;
use super::block::Block;
use super::plane::BLOCK;
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::gbuffer::{GBuffer, SAME_DISTANCE};

/// Least bilinear weight of the pixels of the preceding frame that show an object for a point of it to count as visible.
/// A silhouette passes through a pixel at a weight of about one half; less counts more hidden points as visible and
/// fewer visible ones as hidden.
const LEAST_WEIGHT: f32 = 0.4;

/// Whether a distance agrees with the nearest and the farthest of the pixels around a position.
#[inline(always)]
fn is_near(distance: f32, nearest: f32, farthest: f32) -> bool {
    let slack = farthest - nearest + SAME_DISTANCE * distance;
    distance == nearest || (distance >= nearest - slack && distance <= farthest + slack)
}

impl GBuffer {
    /// Returns [`MotionVectors::VISIBLE`] for each point of a block that this frame shows at the position and the distance
    /// to which its vector leads, and 0 for the others. `at` is the first pixel of the block, and `objects` are those of
    /// the points.
    ///
    /// The four pixels around a position decide, by their bilinear weights, so that silhouettes are found to a fraction
    /// of a pixel. The distances of those that show the object must agree with that of the point, or the object hides
    /// itself; the range is extended by its own size, because the point may lie outside the pixels that show the object.
    #[inline(always)]
    pub(super) fn shows_moved<S: Simd>(
        &self,
        simd: S,
        at: (u32, u32),
        objects: &[Rgba8; BLOCK],
        block: &Block,
    ) -> [u8; BLOCK] {
        let mut visible = [0; BLOCK];
        for (half, visible) in visible.as_chunks_mut().0.iter_mut().enumerate() {
            let points = MovedPoints {
                at: (at.0 + (half * LANES) as u32, at.1),
                objects: &objects.as_chunks().0[half],
                across_px: &block.across_px.as_chunks().0[half],
                down_px: &block.down_px.as_chunks().0[half],
                distance: &block.distance.as_chunks().0[half],
            };
            *visible = self.shows_eight(simd, &points);
        }
        visible
    }

    /// Returns [`MotionVectors::VISIBLE`] for each of eight moved points that this frame shows, and 0 for the others.
    #[inline(always)]
    fn shows_eight<S: Simd>(&self, simd: S, points: &MovedPoints<'_>) -> [u8; LANES] {
        let place = points.places(simd);
        let around = self.around(simd, place);
        let own = u32s(simd, points.objects);
        let differences = each!(i in [0, 1, 2, 3] => around.object[i] ^ own);
        let differences = (differences[0] | differences[1]) | (differences[2] | differences[3]);
        let shows_object = around.is_inside & differences.simd_eq(u32x8::splat(simd, 0));
        let zero = F32::splat(simd, 0.0);
        let is_still = points.across(simd).simd_eq(zero) & points.down(simd).simd_eq(zero);
        let distance = F32::load_array_ref(simd, points.distance);
        let [a, b, c, d] = around.distance;
        let (nearest, farthest) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        let slack = farthest - nearest + distance * SAME_DISTANCE;
        let is_near =
            distance.simd_eq(nearest) | (distance.simd_ge(nearest - slack) & distance.simd_le(farthest + slack));
        let is_simple = shows_object & !is_still;
        let shown = (is_simple & is_near & distance.simd_gt(zero)).to_bitmask();
        if shown == 0xff {
            return [MotionVectors::VISIBLE; LANES];
        }
        let (is_simple, is_still) = (is_simple.to_bitmask(), is_still.to_bitmask());
        let byte = |is_visible: bool| if is_visible { MotionVectors::VISIBLE } else { 0 };
        let mut visible = [0; LANES];
        for (lane, visible) in visible.iter_mut().enumerate() {
            *visible = byte(shown >> lane & 1 != 0);
        }
        if is_simple != 0xff {
            let [x, y] = each!(axis in [0, 1] => place[axis].to_array());
            for lane in (0..LANES).filter(|lane| is_simple >> lane & 1 == 0) {
                let (object, distance) = (points.objects[lane], points.distance[lane]);
                let pixel = (points.at.0 + lane as u32, points.at.1);
                visible[lane] = byte(if is_still >> lane & 1 != 0 {
                    pixel.0 < self.object.width() && self.shows(pixel, object, distance)
                } else {
                    self.shows_partly([x[lane], y[lane]], object, distance)
                });
            }
        }
        visible
    }

    /// Returns the four pixels around each of eight positions.
    #[inline(always)]
    fn around<S: Simd>(&self, simd: S, place: [F32<S>; 2]) -> Around<S> {
        let (width, height) = self.object.size();
        let [x, y] = each!(axis in [0, 1] => place[axis] - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (first, at) = (column.to_array()[0], row.to_array()[0]);
        let is_adjacent =
            column.simd_eq(F32::from_slice(simd, &LANE_NUMBERS[..LANES]) + first) & row.simd_eq(F32::splat(simd, at));
        let is_inside = first >= 0.0 && at >= 0.0 && first + (LANES as f32) < width as f32 && at + 1.0 < height as f32;
        // Mostly, neighbours come from neighbours.
        if is_inside && is_adjacent.all_true() {
            let first = at as usize * width as usize + first as usize;
            let read = each!(start in [first, first + 1, first + width as usize, first + width as usize + 1] => {
                start..start + LANES
            });
            let zero = F32::splat(simd, 0.0);
            return Around {
                object: each!(i in [0, 1, 2, 3] => u32s(simd, &self.object.pixels()[read[i].clone()])),
                distance: each!(i in [0, 1, 2, 3] => F32::from_slice(simd, &self.distance.pixels()[read[i].clone()])),
                is_inside: zero.simd_eq(zero),
            };
        }
        let [zero, last_x, last_y] = each!(number in [0, width - 1, height - 1] => F32::splat(simd, number as f32));
        let is_inside = x.simd_ge(zero) & y.simd_ge(zero) & x.simd_lt(last_x) & y.simd_lt(last_y);
        let [column, row] =
            each!(place in [column, row] => is_inside.select(place, zero).to_int::<i32x8<S>>().to_array());
        let inside = is_inside.to_bitmask();
        let (mut object, mut distance) = ([[[0; 4]; LANES]; 4], [[0.0; LANES]; 4]);
        for lane in (0..LANES).filter(|lane| inside >> lane & 1 != 0) {
            let width = width as usize;
            let first = row[lane] as usize * width + column[lane] as usize;
            let read = first..first + width + 2;
            let (objects, distances) = (&self.object.pixels()[read.clone()], &self.distance.pixels()[read]);
            for (i, at) in [0, 1, width, width + 1].into_iter().enumerate() {
                (object[i][lane], distance[i][lane]) = (objects[at], distances[at]);
            }
        }
        Around {
            object: each!(i in [0, 1, 2, 3] => u32s(simd, &object[i])),
            distance: each!(i in [0, 1, 2, 3] => F32::load_array_ref(simd, &distance[i])),
            is_inside,
        }
    }

    /// Whether this frame shows an object at a position, at about the given distance, by the bilinear weights of the four
    /// pixels around it.
    #[inline(never)]
    fn shows_partly(&self, [x, y]: [f32; 2], object: Rgba8, distance: f32) -> bool {
        let (width, height) = self.object.size();
        // NaN fails every comparison, so it is not inside.
        let is_inside = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32 && distance > 0.0;
        if !is_inside {
            return false;
        }
        let (columns, right) = around(x, width);
        let (rows, down) = around(y, height);
        let (mut weight, mut nearest, mut farthest) = (0.0, f32::INFINITY, 0.0_f32);
        for (row, vertical) in [(rows[0], 1.0 - down), (rows[1], down)] {
            for (column, horizontal) in [(columns[0], 1.0 - right), (columns[1], right)] {
                let pixel = row * width as usize + column;
                if self.object.pixels()[pixel] == object {
                    let there = self.distance.pixels()[pixel];
                    weight += vertical * horizontal;
                    nearest = nearest.min(there);
                    farthest = farthest.max(there);
                }
            }
        }
        weight >= LEAST_WEIGHT && is_near(distance, nearest, farthest)
    }
}

/// Eight adjacent pixels, and the motion of the points that they show.
struct MovedPoints<'a> {
    /// Column and row of the first pixel.
    at: (u32, u32),
    objects: &'a [Rgba8; LANES],
    across_px: &'a [f32; LANES],
    down_px: &'a [f32; LANES],
    /// Distances in the preceding frame.
    distance: &'a [f32; LANES],
}

impl MovedPoints<'_> {
    #[inline(always)]
    fn across<S: Simd>(&self, simd: S) -> F32<S> {
        F32::load_array_ref(simd, self.across_px)
    }

    #[inline(always)]
    fn down<S: Simd>(&self, simd: S) -> F32<S> {
        F32::load_array_ref(simd, self.down_px)
    }

    /// Returns the positions in the preceding frame, in pixels.
    #[inline(always)]
    fn places<S: Simd>(&self, simd: S) -> [F32<S>; 2] {
        [
            F32::from_slice(simd, &LANE_NUMBERS[..LANES]) + (self.at.0 as f32 + 0.5) + self.across(simd),
            F32::splat(simd, self.at.1 as f32 + 0.5) + self.down(simd),
        ]
    }
}

/// The four pixels around each of eight positions: upper left, upper right, lower left, lower right.
struct Around<S: Simd> {
    object: [u32x8<S>; 4],
    distance: [F32<S>; 4],
    /// Whether all four pixels lie in the picture; where not, the other fields are not meaningful.
    is_inside: mask32x8<S>,
}

/// Loads eight objects as numbers.
#[inline(always)]
fn u32s<S: Simd>(simd: S, objects: &[Rgba8]) -> u32x8<S> {
    u8x32::from_slice(simd, objects.as_flattened()).bitcast()
}

/// Returns the pixels whose centres lie before and after a position along an axis of `length` px, and the interpolation
/// weight of the second. The position must be inside the axis.
#[inline(always)]
fn around(place: f32, length: u32) -> ([usize; 2], f32) {
    let floor = (place - 0.5).floor();
    let first = floor.max(0.0) as usize;
    let last = length as usize - 1;
    ([first, if floor < 0.0 { 0 } else { (first + 1).min(last) }], place - 0.5 - floor)
}
