//! Reactive mask: surfaces whose history counts less, because their motion vectors do not describe all they show.
//!
//! A blended surface shows what is behind it, which moves in another way, and an alpha-tested surface has holes. AMD's
//! documentation of FSR 2 (“Reactive mask”) proposes the alpha of a blended surface as its reactivity, and at most about
//! 0.9. The limit of the accumulated weight and the lifetime of locks are multiplied by 1 − reactivity.

use std::ops::Range;

use super::super::FrameInputs;
use super::super::quads::window;
use crate::math::lanes::*;
use crate::pipeline::gbuffer::GBuffer;

/// For every pixel of a row, the greatest reactivity of the 3 × 3 pixels around it, as vectors are dilated too.
pub(super) struct ReactiveRow {
    /// Greatest reactivity of three pixels of each column. Column `x` is at index `x + 1`.
    columns: Vec<f32>,
}

impl ReactiveRow {
    /// Returns a buffer for rows of `width` pixels.
    pub(super) fn new(width: u32) -> Self {
        Self { columns: vec![0.0; width as usize + 2 + WIDE] }
    }

    /// Reads the reactivities around a range of pixels of row `y`. `reactivity` holds one number per instance.
    pub(super) fn fill(&mut self, gbuffer: &GBuffer, reactivity: &[f32], (columns, y): (&Range<usize>, u32)) {
        let (width, height) = gbuffer.object.size();
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|row| gbuffer.object.row(row));
        for column in columns.start.saturating_sub(1)..(columns.end + 1).min(width as usize) {
            let of_row = |row: &&[[u8; 4]]| {
                reactivity.get(u32::from_le_bytes(row[column]) as usize).copied().unwrap_or_default()
            };
            self.columns[column + 1] = rows.iter().map(of_row).fold(0.0, f32::max);
        }
    }

    /// Returns 1 − reactivity of 16 pixels from column `from` on.
    #[inline(always)]
    pub(super) fn kept<S: Simd>(&self, simd: S, from: usize) -> f32x16<S> {
        let [left, at, right] = each!(by in [0, 1, 2] => {
            f32x16::load_array_ref(simd, window(&self.columns, from + by))
        });
        f32x16::splat(simd, 1.0) - left.max(at).max(right)
    }
}

/// Returns the reactivity of every instance if it affects a frame: in a still view, the history of all surfaces is valid.
pub(super) fn reactivity<'a>(frame: Option<FrameInputs<'a>>) -> Option<&'a [f32]> {
    frame.filter(|frame| frame.motion.is_some())?.reactivity
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn the_greatest_reactivity_of_nine_pixels_counts() {
        let mut random = fastrand::Rng::with_seed(3);
        let reactivity = [0.0, 0.25, 0.9];
        let (width, height) = (37, 5);
        let object = Image::from_fn(width, height, |_, _| match random.u32(0..20) {
            // Some have no entry.
            number @ 0..6 => number.to_le_bytes(),
            6 => GBuffer::NO_OBJECT,
            _ => [0; 4],
        });
        let gbuffer = GBuffer { object, distance: Image::filled(width, height, 1.0) };
        let of = |x: i64, y: i64| {
            let inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
            let number = inside.then(|| u32::from_le_bytes(gbuffer.object.at(x as u32, y as u32)));
            number.and_then(|number| reactivity.get(number as usize)).copied().unwrap_or(0.0)
        };
        for y in 0..height {
            let mut row = ReactiveRow::new(width);
            row.fill(&gbuffer, &reactivity, (&(0..width as usize), y));
            for x in 0..width {
                let around = (-1..=1).flat_map(|down| (-1..=1).map(move |right| (right, down)));
                let greatest = around.map(|(right, down)| of(i64::from(x) + right, i64::from(y) + down));
                let expected = 1.0 - greatest.fold(0.0, f32::max);
                let alone = |lanes: Lanes| on_lanes!(lanes, simd => row.kept(simd, x as usize).to_array()[0]);
                assert_eq!(
                    Lanes::all().map(alone).collect::<Vec<_>>(),
                    vec![expected; Lanes::all().count()],
                    "{x}, {y}"
                );
            }
        }
    }
}
