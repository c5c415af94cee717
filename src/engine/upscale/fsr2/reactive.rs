//! Reactive mask: surfaces whose history counts less, because their motion vectors do not describe all they show.
//!
//! A blended surface shows what is behind it, which moves in another way, and an alpha-tested surface has holes. AMD's
//! documentation of FSR 2 (“Reactive mask”) proposes the alpha of a blended surface as its reactivity, and at most about
//! 0.9. The limit of the accumulated weight and the lifetime of locks are multiplied by 1 − reactivity.

use std::ops::Range;

use super::super::FrameInputs;
use super::super::history::{Around, SurfaceGrid};
use super::super::quads::window;
use super::super::row_parts::RowSpan;
use crate::math::lanes::*;
use crate::pipeline::gbuffer::GBuffer;

/// For every output pixel of a row, the greatest reactivity of the surfaces around it, as vectors are dilated too.
pub(super) struct ReactiveRow {
    /// Rows of the G-buffer, and output pixels, that the numbers belong to.
    holds: Option<(Around, Range<usize>)>,
    grid: SurfaceGrid,
    /// Reactivity of every output pixel, with spare ones.
    greatest: Vec<f32>,
}

impl ReactiveRow {
    /// Returns a buffer for a frame.
    pub(super) fn new(frame: &FrameInputs<'_>) -> Self {
        Self { holds: None, grid: frame.surface_grid(), greatest: vec![0.0; frame.size.0 as usize + WIDE] }
    }

    /// Reads the reactivities around a range of pixels. `reactivity` holds one number per instance.
    pub(super) fn fill(&mut self, gbuffer: &GBuffer, reactivity: &[f32], RowSpan { columns, y }: &RowSpan) {
        let rows = self.grid.rows(*y);
        if self.holds.as_ref().is_some_and(|(held, filled)| (held, filled) == (&rows, columns)) {
            return;
        }
        for pixel in columns.clone() {
            let of_column = |column: u32| {
                let of_row = |row: &u32| {
                    let instance = u32::from_le_bytes(gbuffer.object.at(column, *row));
                    reactivity.get(instance as usize).copied().unwrap_or_default()
                };
                rows.iter().map(of_row).fold(0.0, f32::max)
            };
            self.greatest[pixel] = self.grid.columns(pixel as u32).into_iter().map(of_column).fold(0.0, f32::max);
        }
        self.holds = Some((rows, columns.clone()));
    }

    /// Returns 1 − reactivity of 16 pixels from column `from` on.
    #[inline(always)]
    pub(super) fn kept<S: Simd>(&self, simd: S, from: usize) -> f32x16<S> {
        f32x16::splat(simd, 1.0) - f32x16::load_array_ref(simd, window(&self.greatest, from))
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
    use crate::upscale::{Anchor, Lattice, Sampling, Scale};

    #[test]
    fn the_greatest_reactivity_of_the_surfaces_around_a_pixel_counts() {
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
        let sampling = Sampling::Lattice(Lattice { scale: Scale::TWO, anchor: Anchor::Centre });
        let size = (2 * width, 2 * height);
        let frame = FrameInputs {
            size,
            sampling,
            gbuffer: &gbuffer,
            motion: None,
            history: None,
            reactivity: Some(&reactivity),
        };
        let mut row = ReactiveRow::new(&frame);
        for y in 0..size.1 {
            row.fill(&gbuffer, &reactivity, &RowSpan { columns: 0..size.0 as usize, y });
            for x in 0..size.0 {
                // An odd pixel lies behind the middle of its sample, an even one before it.
                let [first_x, first_y] = [x, y].map(|at| i64::from(at / 2) - i64::from(at % 2 == 0));
                let around = (0..2).flat_map(|down| (0..2).map(move |right| (first_x + right, first_y + down)));
                let expected = 1.0 - around.map(|(x, y)| of(x, y)).fold(0.0, f32::max);
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
