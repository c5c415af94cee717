//! Checkpoints: copies of the framebuffer after selected triangles.

use crate::image::Image;
use crate::pipeline::Geometry;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::viewport::Viewport;

/// Maximum number of checkpoints. With more, drawing from one checkpoint to the next would take less time than copying
/// the framebuffer.
const MAX_COPIES: usize = 64;

/// Estimated fixed cost of drawing a triangle, relative to the cost of one pixel.
const TRIANGLE_COST_PX: f64 = 60.0;

/// Checkpoints of one frame: their positions, and the framebuffer copies made so far.
#[derive(Debug)]
pub(super) struct Checkpoints {
    /// For each checkpoint, the number of triangles drawn before it, ascending from 0, and its copy of the framebuffer.
    /// The copy is `None` until it is made.
    copies: Vec<(usize, Option<Framebuffer>)>,
}

impl Checkpoints {
    /// Distributes checkpoints so that the estimated drawing cost between neighbouring checkpoints is about equal.
    /// `cleared` is the framebuffer before the first triangle; `budget` is in bytes.
    pub(super) fn new(geometry: &Geometry, raster: Viewport, cleared: &Framebuffer, budget: usize) -> Self {
        let count = (budget / bytes(cleared).max(1)).clamp(2, MAX_COPIES);
        let costs = || geometry.triangles.iter().map(|triangle| cost(triangle, raster));
        let share = costs().sum::<f64>() / count as f64;
        let mut copies = vec![(0, Some(cleared.clone()))];
        let mut sum = 0.0;
        for (place, cost) in costs().enumerate() {
            sum += cost;
            if sum >= share * copies.len() as f64 && copies.len() < count {
                copies.push((place + 1, None));
            }
        }
        Self { copies }
    }

    /// Restores `frame` from the last stored copy that contains at most `triangles` triangles, and returns the number
    /// of triangles in that copy. `frame` contains `at` triangles. If these are at most `triangles`, but at least as
    /// many as in the copy, leaves `frame` unchanged and returns `None`.
    pub(super) fn restore_before(&self, triangles: usize, at: usize, frame: &mut Framebuffer) -> Option<usize> {
        let before = &self.copies[..self.copies.partition_point(|(place, _)| *place <= triangles)];
        let (place, copy) = before.iter().rev().find_map(|(place, copy)| Some((*place, copy.as_ref()?)))?;
        if at <= triangles && place <= at {
            return None;
        }
        // Copies into the existing buffers to avoid allocations.
        frame.color.pixels_mut().copy_from_slice(copy.color.pixels());
        if let (Some(depth), Some(copy)) = (&mut frame.depth, &copy.depth) {
            depth.pixels_mut().copy_from_slice(copy.pixels());
        }
        Some(place)
    }

    /// Returns the number of triangles at the next checkpoint after `at` triangles, or `usize::MAX` if there is none.
    pub(super) fn next_after(&self, at: usize) -> usize {
        let next = self.copies.partition_point(|(place, _)| *place <= at);
        self.copies.get(next).map_or(usize::MAX, |(place, _)| *place)
    }

    /// Stores a copy of `frame`, which contains `at` triangles, if the checkpoint after that many triangles exists but
    /// has no copy yet.
    pub(super) fn store_checkpoint(&mut self, at: usize, frame: &Framebuffer) {
        if let Ok(found) = self.copies.binary_search_by_key(&at, |(place, _)| *place) {
            self.copies[found].1.get_or_insert_with(|| frame.clone());
        }
    }

    /// Returns the number of stored framebuffer copies and their total size in bytes.
    pub(super) fn memory(&self) -> (usize, usize) {
        let made = self.copies.iter().filter_map(|(_, copy)| copy.as_ref());
        made.fold((0, 0), |(count, sum), copy| (count + 1, sum + bytes(copy)))
    }
}

fn bytes(frame: &Framebuffer) -> usize {
    frame.color.bytes() + frame.depth.as_ref().map_or(0, Image::bytes)
}

/// Estimates the cost of drawing a triangle, in pixels: half its bounding box within the picture, plus a fixed cost.
fn cost(triangle: &ScreenTriangle, Viewport { width, height }: Viewport) -> f64 {
    let corners = triangle.corners_px();
    let side = |axis: usize, length: u32| {
        let inside = corners.map(|corner| f64::from(corner[axis]).clamp(0.0, f64::from(length)));
        inside.iter().fold(0.0_f64, |most, at| most.max(*at))
            - inside.iter().fold(f64::from(length), |least, at| least.min(*at))
    };
    TRIANGLE_COST_PX + side(0, width) * side(1, height) / 2.0
}
