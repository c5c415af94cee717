//! Shading of samples that lie elsewhere in each pixel, where they belong to one triangle.
//!
//! The edge values of eight in a row differ by other steps each: they are computed from the samples' places. All else is as for
//! samples on a lattice.

use super::Frame;
use super::kernel::{Band, Patch, exact_at, one_by_one, shade_rows};
use super::locations::Locations;
use super::queue::Queue;
use super::record::{Source as _, Subject};
use super::setup::Edges;
use crate::math::lanes::*;

/// Shades some rows of samples.
#[inline(never)]
pub(super) fn shade_displaced<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    subject: &Subject<'_>,
    (patch, locations): (&Patch, impl Locations),
    queue: &mut Queue,
    band: &mut Band<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let Some(edges) = subject.edges else {
                return shade_rows(
                    simd,
                    frame,
                    subject,
                    patch,
                    (queue, band),
                    #[inline(always)]
                    |rows| {
                        let e = subject.one.edge_values(simd, places(simd, patch, locations, rows));
                        each!(i in [0, 1, 2] => e[i].to_float::<f32x16<S>>())
                    },
                );
            };
            if !frame.shader(subject.draw).on_lanes {
                let whole = frame.screen_triangle(subject.key, subject.draw);
                for row in patch.first..patch.end {
                    let places = locations.places(simd, patch.column, [row; 2]);
                    let e = edges_of_row(edges, each!(axis in [0, 1] => places[axis].to_array()));
                    one_by_one(frame, frame.shader(subject.draw), &whole, patch, row, &e, band.row(patch, row));
                }
                return;
            }
            shade_rows(
                simd,
                frame,
                subject,
                patch,
                (queue, band),
                #[inline(always)]
                |rows| exact_at(simd, edges, places(simd, patch, locations, rows)),
            );
        },
    );
}

/// Where the samples of two rows of a patch lie.
#[inline(always)]
fn places<S: Simd>(simd: S, patch: &Patch, locations: impl Locations, rows: [usize; 2]) -> [i32x16<S>; 2] {
    locations.places(simd, patch.column, each!(row in [rows[0], rows[1]] => patch.first + row))
}

/// The edge values of eight samples, the first of some places.
fn edges_of_row(edges: &Edges, [x, y]: [[i32; WIDE]; 2]) -> [[f64; LANES]; 3] {
    let mut of_row = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        for (values, value) in of_row.iter_mut().zip(edges.at([x[lane], y[lane]])) {
            values[lane] = value;
        }
    }
    of_row
}
