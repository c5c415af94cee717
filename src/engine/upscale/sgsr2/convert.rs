//! First pass: the motion vector and the depth clip of every sample, from the distances of the samples around it.

use super::super::{Lattice, UpscaleInputs};
use crate::image::Image;

/// Relative difference of two distances up to which they belong to one surface, per pixel of the diagonal of the drawn
/// picture.
const SEPARATION: f32 = 1.37e-5;

/// Motion and depth clip of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Converted {
    /// Pixel whose motion vector applies: that of the nearest surface among the 3 × 3 samples around the sample.
    pub(super) vector_of: (u32, u32),
    /// Share of depth edges around the sample, in [0, 1].
    pub(super) depth_clip: f32,
}

/// Distances of the visible surfaces at all samples.
#[derive(Clone, Debug)]
pub(super) struct Convert<'a> {
    distance: &'a Image<f32>,
    /// Column of the pixel that contains the centre of each column of samples.
    columns: Vec<u32>,
    /// Row of the pixel that contains the centre of each row of samples.
    rows: Vec<u32>,
    /// Relative difference of two distances up to which they belong to one surface.
    separation: f32,
}

impl<'a> Convert<'a> {
    /// Prepares the pass; returns `None` if there is no G-buffer.
    pub(super) fn new(lattice: Lattice, drawn: &UpscaleInputs<'a>) -> Option<Self> {
        let distance = &drawn.frame?.gbuffer.distance;
        let (width, height) = drawn.color.size();
        let pixels = |samples: u32, length: u32| {
            (0..samples).map(|index| (lattice.position_px(index) as u32).min(length - 1)).collect()
        };
        let (columns, rows) = (pixels(width, distance.width()), pixels(height, distance.height()));
        let (width, height) = (width as f32, height as f32);
        Some(Self { distance, columns, rows, separation: SEPARATION * (width * width + height * height).sqrt() })
    }

    /// Returns the motion and the depth clip of a sample.
    #[inline(always)]
    pub(super) fn sample(&self, (column, row): (u32, u32)) -> Converted {
        let around = |at: u32, pixels: &[u32]| {
            let last = pixels.len() as i64 - 1;
            [-1, 0, 1, 2].map(|by| pixels[(i64::from(at) + by).clamp(0, last) as usize])
        };
        let (columns, rows) = (around(column, &self.columns), around(row, &self.rows));
        let distances = rows.map(|row| {
            let row = self.distance.row(row);
            columns.map(|column| row[column as usize])
        });
        // The sample itself wins ties.
        let (mut nearest, mut vector_of) = (distances[1][1], (columns[1], rows[1]));
        for (row, distances) in rows.into_iter().zip(distances).take(3) {
            for (column, distance) in columns.into_iter().zip(distances).take(3) {
                if distance < nearest {
                    (nearest, vector_of) = (distance, (column, row));
                }
            }
        }
        Converted { vector_of, depth_clip: self.depth_clip(&distances) }
    }

    /// Returns the share of depth edges among 4 × 4 distances. The nearest distance of each quarter is compared with that
    /// of the middle 2 × 2.
    #[inline(always)]
    fn depth_clip(&self, distances: &[[f32; 4]; 4]) -> f32 {
        let nearest = |row: usize, column: usize| {
            let [above, below] = [row, row + 1].map(|row| distances[row][column].min(distances[row][column + 1]));
            above.min(below)
        };
        let middle = nearest(1, 1);
        if !middle.is_finite() {
            return 0.0;
        }
        let continuity = |(row, column): (usize, usize)| {
            // The relative difference, also if one distance is infinite.
            let difference = (1.0 - middle / nearest(row, column)).abs();
            if difference > self.separation { self.separation / difference } else { 1.0 }
        };
        let [a, b, c, d] = [(0, 0), (0, 2), (2, 0), (2, 2)].map(continuity);
        (1.0 - 0.25 * (a + b + c + d)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Rgba8;
    use crate::pipeline::gbuffer::GBuffer;
    use crate::upscale::{Anchor, FrameInputs, Scale};

    fn converted(distance: Image<f32>, at: (u32, u32)) -> Converted {
        let (width, height) = distance.size();
        let gbuffer = GBuffer { object: Image::filled(width, height, [0; 4]), distance };
        let frame = Some(FrameInputs { gbuffer: &gbuffer, motion: None, history: None, reactivity: None });
        let color: Image<Rgba8> = Image::filled(width / 2, height / 2, [0; 4]);
        let lattice = Lattice { scale: Scale::TWO, anchor: Anchor::Centre };
        Convert::new(lattice, &UpscaleInputs { color: &color, frame }).unwrap().sample(at)
    }

    #[test]
    fn depth_edges_clip_the_samples_behind_them_and_lend_them_their_motion() {
        // A surface at distance 2 on the left of column 20, before one at distance 10.
        let edge = |x: u32, _| if x < 20 { 2.0 } else { 10.0 };
        let at = |column| converted(Image::from_fn(64, 48, edge), (column, 12));
        // In front of the edge, all quarters are as near as the middle, or half of them are far behind it.
        assert_eq!(at(3).depth_clip, 0.0);
        assert!((0.49..=0.5).contains(&at(9).depth_clip), "{:?}", at(9));
        // Just behind the edge, half of the quarters are nearer.
        assert!((0.49..=0.5).contains(&at(10).depth_clip), "{:?}", at(10));
        assert_eq!(at(15).depth_clip, 0.0);
        // Sample 10 lies behind the edge. Of the equally near samples in column 9, the uppermost one is taken.
        assert_eq!(at(10).vector_of, (19, 23));
        assert_eq!(at(11).vector_of, (23, 25));
    }

    #[test]
    fn slanted_surfaces_and_the_background_have_no_edges() {
        let slanted = Image::from_fn(64, 48, |x, y| 5.0 + 1e-4 * (x + y) as f32);
        assert_eq!(converted(slanted, (16, 12)).depth_clip, 0.0);
        assert_eq!(converted(Image::filled(64, 48, f32::INFINITY), (16, 12)).depth_clip, 0.0);
        let horizon = Image::from_fn(64, 48, |_, y| if y < 24 { f32::INFINITY } else { 3.0 });
        let clip = converted(horizon, (16, 11)).depth_clip;
        assert!((0.49..=0.5).contains(&clip), "{clip}");
    }
}
