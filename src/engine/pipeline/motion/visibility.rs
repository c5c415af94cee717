//! Visibility of moved surface points in the preceding frame.

use crate::image::Rgba8;
use crate::pipeline::gbuffer::{GBuffer, SAME_DISTANCE};

/// Motion vector of a pixel, and the distance of its surface point in the preceding frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct MovedPoint {
    /// Position in the preceding frame minus the position in the current one, in pixels to the right and downwards.
    pub(super) vector_px: [f32; 2],
    /// Distance in the preceding frame along its view axis, in world units.
    pub(super) distance: f32,
}

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
    /// Whether this frame shows an object at the position and distance to which the vector of pixel `at` of the next frame
    /// leads.
    ///
    /// The four pixels around the position decide, by their bilinear weights, so that silhouettes are found to a fraction
    /// of a pixel. The distances of those that show the object must agree with that of the point, or the object hides
    /// itself; the range is extended by its own size, because the point may lie outside the pixels that show the object.
    #[inline(always)]
    pub(super) fn shows_moved(&self, at: (u32, u32), object: Rgba8, point: &MovedPoint) -> bool {
        let MovedPoint { vector_px: [across_px, down_px], distance } = *point;
        let (width, height) = self.object.size();
        let [x, y] = [at.0 as f32 + 0.5 + across_px, at.1 as f32 + 0.5 + down_px];
        // NaN fails every comparison, so it is not inside.
        let is_inside = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32 && distance > 0.0;
        if !is_inside {
            return false;
        }
        if across_px == 0.0 && down_px == 0.0 {
            return self.shows(at, object, distance);
        }
        if let Some([nearest, farthest]) = self.range_of_one_object([x, y], object) {
            return is_near(distance, nearest, farthest);
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

    /// Returns the least and the greatest distance of the four pixels around a position, if all of them show `object`.
    /// Nearly all positions are like that, and need no weights.
    #[inline(always)]
    fn range_of_one_object(&self, [x, y]: [f32; 2], object: Rgba8) -> Option<[f32; 2]> {
        let (width, height) = self.object.size();
        let [x, y] = [x - 0.5, y - 0.5];
        if !(x >= 0.0 && y >= 0.0 && x < (width - 1) as f32 && y < (height - 1) as f32) {
            return None;
        }
        let upper = y as usize * width as usize + x as usize;
        let lower = upper + width as usize;
        let (objects, distances) = (self.object.pixels(), self.distance.pixels());
        if objects[upper..upper + 2] != [object; 2] || objects[lower..lower + 2] != [object; 2] {
            return None;
        }
        let [a, b] = [upper, lower].map(|at| [distances[at], distances[at + 1]]);
        Some([a[0].min(a[1]).min(b[0].min(b[1])), a[0].max(a[1]).max(b[0].max(b[1]))])
    }
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
