//! Visibility of moved surface points in the preceding frame.

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
    /// Whether this frame shows the points of a block, of which the first pixel is `at`, at the positions and distances
    /// to which their vectors lead. `objects` are those of the points.
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
    ) -> [bool; BLOCK] {
        let [across, down, distance] = each!(numbers in [&block.across_px, &block.down_px, &block.distance] => f32x16::load_array_ref(simd, numbers));
        let [x, y] = [
            f32x16::load_array(simd, COLUMNS) + (at.0 as f32 + 0.5) + across,
            f32x16::splat(simd, at.1 as f32 + 0.5) + down,
        ];
        let places = Places { x: x.to_array(), y: y.to_array() };
        let mut visible = [false; BLOCK];
        // Distances of the four pixels around the positions at which all of them show the object.
        let (mut around, mut shows_object) = ([[0.0; BLOCK]; 4], [false; BLOCK]);
        for lane in 0..BLOCK {
            let (object, vector) = (objects[lane], [block.across_px[lane], block.down_px[lane]]);
            if vector == [0.0; 2] {
                let pixel = (at.0 + lane as u32, at.1);
                visible[lane] = pixel.0 < self.object.width() && self.shows(pixel, object, block.distance[lane]);
            } else if let Some(distances) = self.distances_of_one_object(places.at(lane), object) {
                shows_object[lane] = true;
                for (all, distance) in around.iter_mut().zip(distances) {
                    all[lane] = distance;
                }
            } else {
                visible[lane] = self.shows_partly(places.at(lane), object, block.distance[lane]);
            }
        }
        let [a, b, c, d] = each!(i in [0, 1, 2, 3] => f32x16::load_array(simd, around[i]));
        let (nearest, farthest) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        let slack = farthest - nearest + distance * SAME_DISTANCE;
        let is_near =
            distance.simd_eq(nearest) | (distance.simd_ge(nearest - slack) & distance.simd_le(farthest + slack));
        let zero = f32x16::splat(simd, 0.0);
        let near = (is_near & distance.simd_gt(zero)).select(f32x16::splat(simd, 1.0), zero).to_array();
        for lane in 0..BLOCK {
            visible[lane] |= shows_object[lane] & (near[lane] != 0.0);
        }
        visible
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

    /// Returns the distances of the four pixels around a position, if all of them show `object`. Nearly all positions are
    /// like that, and need no weights.
    #[inline(always)]
    fn distances_of_one_object(&self, [x, y]: [f32; 2], object: Rgba8) -> Option<[f32; 4]> {
        let (width, height) = self.object.size();
        let [x, y] = [x - 0.5, y - 0.5];
        if !(x >= 0.0 && y >= 0.0 && x < (width - 1) as f32 && y < (height - 1) as f32) {
            return None;
        }
        let width = width as usize;
        let first = y as usize * width + x as usize;
        let objects = &self.object.pixels()[first..][..width + 2];
        let distances = &self.distance.pixels()[first..][..width + 2];
        let [a, b, c, d] = [0, 1, width, width + 1].map(|at| u32::from_le_bytes(objects[at]));
        let own = u32::from_le_bytes(object);
        let differences = (a ^ own) | (b ^ own) | (c ^ own) | (d ^ own);
        (differences == 0).then(|| [distances[0], distances[1], distances[width], distances[width + 1]])
    }
}

/// Positions in the preceding frame, in pixels.
struct Places {
    x: [f32; BLOCK],
    y: [f32; BLOCK],
}

impl Places {
    #[inline(always)]
    fn at(&self, lane: usize) -> [f32; 2] {
        [self.x[lane], self.y[lane]]
    }
}

/// Columns of the pixels of a block.
const COLUMNS: [f32; BLOCK] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Returns the pixels whose centres lie before and after a position along an axis of `length` px, and the interpolation
/// weight of the second. The position must be inside the axis.
#[inline(always)]
fn around(place: f32, length: u32) -> ([usize; 2], f32) {
    let floor = (place - 0.5).floor();
    let first = floor.max(0.0) as usize;
    let last = length as usize - 1;
    ([first, if floor < 0.0 { 0 } else { (first + 1).min(last) }], place - 0.5 - floor)
}
