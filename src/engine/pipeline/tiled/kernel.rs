//! SIMD shading of sixteen samples at a time, eight in each of two rows. Each visible sample is shaded once.
//!
//! The arithmetic is the same as in [`crate::pipeline::interpolate`] and [`crate::pipeline::shade`], operation by
//! operation. Shading modes without a SIMD kernel call those functions themselves.

use super::canvas::Canvas;
use super::edge_rows::{EdgeRows, ExactRows, IntegerRows};
use super::layout::BLOCK;
use super::mipmap::{Coordinates, LevelTapsMut};
use super::patch::Patch;
use super::queue::{Reserved, ReservedPair, RowTargets};
use super::record::{ShadedTriangle, TriangleSource};
use super::shader::{DrawShader, LightSource, PlannedShader, ShadingPlan, with_known_plan};
use super::weights::{AttributeWeights, StoredWeights, corner_weights};
use crate::math::lanes::*;
use crate::pipeline::settings::ColorSpace;
use crate::pipeline::shading::LightInputs;

/// Shades samples that all belong to one triangle and lie exactly on the points of the tile's lattice.
#[inline(never)]
pub(super) fn shade_uniform<S: Simd>(simd: S, subject: &ShadedTriangle<'_>, patch: &Patch, canvas: &mut Canvas<'_>) {
    simd.vectorize(
        #[inline(always)]
        || {
            let frame = canvas.frame;
            let lattice = &frame.lattice;
            let Some(edges) = subject.edges else {
                let mut edges = IntegerRows::new(simd, lattice, subject.one.record, patch);
                return shade_rows(simd, subject, patch, canvas, &mut edges);
            };
            let mut exact = ExactRows::new(simd, lattice, edges, patch);
            if frame.shader(subject.draw).on_lanes {
                return shade_rows(simd, subject, patch, canvas, &mut exact);
            }
            let whole = frame.classic(subject.key, subject.draw, canvas.place);
            for block in patch.blocks() {
                exact.begin(simd, &block);
                for (i, row) in (block.first..block.end).enumerate() {
                    whole.shade_row(&block, row, &exact.of_row(i), canvas.picture.row(&block, row));
                }
            }
        },
    );
}

/// Shades rows of samples that all belong to one triangle.
#[inline(always)]
pub(super) fn shade_rows<S: Simd>(
    simd: S,
    subject: &ShadedTriangle<'_>,
    patch: &Patch,
    canvas: &mut Canvas<'_>,
    edges: &mut impl EdgeRows<S>,
) {
    let shader = canvas.frame.shader(subject.draw);
    let mut rows = ShadedRows { subject, edges, ahead: &mut [StoredWeights::default(); BLOCK / 2] };
    with_known_plan!([GOURAUD], shader.plan, plan => rows.shade(simd, PlannedShader { shader, plan }, patch, canvas));
}

/// Rows of samples that all belong to one triangle.
///
/// The weights of all rows of a block are computed first. Each computation is a dependency chain with a division, and
/// the chains of several rows overlap.
struct ShadedRows<'a, E> {
    subject: &'a ShadedTriangle<'a>,
    edges: &'a mut E,
    /// Interpolation weights of each pair of rows of a block.
    ahead: &'a mut [StoredWeights; BLOCK / 2],
}

impl<E> ShadedRows<'_, E> {
    /// Shades a patch. The plan may be a compile-time constant.
    #[inline(always)]
    fn shade<S: Simd>(&mut self, simd: S, shader: PlannedShader<'_>, patch: &Patch, canvas: &mut Canvas<'_>)
    where
        E: EdgeRows<S>,
    {
        let number = canvas.frame.shader_of_draw[self.subject.draw];
        let pairs = (patch.end - patch.first).div_ceil(2);
        for block in patch.blocks() {
            self.edges.begin(simd, &block);
            let targets = RowTargets::new(&block, &canvas.picture);
            let room = canvas.reserve(simd, number, pairs);
            self.interpolate(simd, shader, targets, room);
        }
    }

    /// Interpolates all attributes in the rows of a block.
    #[inline(always)]
    fn interpolate<S: Simd>(
        &mut self,
        simd: S,
        shader: PlannedShader<'_>,
        mut targets: RowTargets,
        Reserved { pairs, taps, coarse }: Reserved<'_>,
    ) where
        E: EdgeRows<S>,
    {
        let (plan, one) = (shader.plan, self.subject.one);
        let relative_inv_w = one.relative_inv_w(simd);
        for (i, (pair, weights)) in pairs.iter_mut().zip(self.ahead.iter_mut()).enumerate() {
            // If the number of rows is odd, the last one is computed twice and written once.
            let (upper, lower) = (2 * i, (2 * i + 1).min(targets.rows - 1));
            weights.store(plan, corner_weights(simd, self.edges.at(simd, [upper, lower]), relative_inv_w));
            pair.rows = targets.next_two(lower > upper);
        }
        let mut coarse = coarse.iter_mut();
        for ((pair, fine), weights) in pairs.iter_mut().zip(taps).zip(self.ahead.iter()) {
            let coarse = if plan.mipmapped { coarse.next() } else { None };
            let out = ReservedPair { pair, taps: LevelTapsMut { fine, coarse } };
            interpolate_pair(simd, shader, one, weights.load(simd), out);
        }
    }
}

/// Computes the texture taps of sixteen samples and prefetches their texels. The anisotropic filter reads them at once.
/// Does nothing without a texture.
#[inline(always)]
pub(super) fn locate_texels<S: Simd, O: TriangleSource>(
    simd: S,
    PlannedShader { shader, plan }: PlannedShader<'_>,
    source: O,
    weights: AttributeWeights<S>,
    LevelTapsMut { fine, coarse }: LevelTapsMut<'_>,
) {
    let (Some(texture), Some(layout)) = (&shader.texture, plan.texture) else { return };
    match coarse {
        Some(coarse) if texture.is_anisotropic() => {
            texture.filter_along_axis(simd, layout, &Coordinates::new(simd, source, weights), coarse);
            return;
        }
        Some(coarse) if plan.mipmapped => {
            texture.locate_in_levels(simd, &Coordinates::new(simd, source, weights), fine, coarse);
            if let Some(step) = O::PREFETCH_STEP {
                coarse.prefetch(texture, step);
            }
        }
        _ => {
            let [u, v] = source.uv(simd);
            texture.locate(simd, layout, [u.at(weights.of_corners), v.at(weights.of_corners)], fine);
        }
    }
    let step = match plan.space {
        ColorSpace::Bytes => O::PREFETCH_STEP,
        ColorSpace::Linear => O::PREFETCH_STEP_IN_LIGHT,
    };
    if let Some(step) = step {
        texture.prefetch(fine, step);
    }
}

/// Interpolates all attributes of sixteen samples from their weights.
#[inline(always)]
pub(super) fn interpolate_pair<S: Simd>(
    simd: S,
    planned: PlannedShader<'_>,
    source: impl TriangleSource,
    weights: AttributeWeights<S>,
    ReservedPair { pair, taps }: ReservedPair<'_>,
) {
    let PlannedShader { shader, plan } = planned;
    let of_corners = weights.of_corners;
    let zero = f32x16::splat(simd, 0.0);
    let inputs = LaneInputs { simd, shader, normal: [zero; 3], vertex_light: zero };
    match plan.light {
        LightSource::None => {}
        LightSource::Vertices => {
            let inputs = LaneInputs { vertex_light: source.light(simd).at(of_corners), ..inputs };
            plan.shading.light(&inputs).store_array(&mut pair.light);
        }
        LightSource::Normals => {
            let normal = source.normal(simd);
            let normal = each!(axis in [0, 1, 2] => normal[axis].at(of_corners));
            let inputs = LaneInputs { normal: unit(simd, normal), ..inputs };
            plan.shading.light(&inputs).store_array(&mut pair.light);
        }
    }
    if plan.colored {
        let (diffuse, color) = (shader.shader.diffuse.to_array(), source.color(simd));
        for channel in 0..3 {
            let color = f32x16::splat(simd, diffuse[channel]) * color[channel].at(of_corners);
            color.store_array(&mut pair.color[channel]);
        }
    }
    // Done last, because it needs the most registers.
    locate_texels(simd, planned, source, weights, taps);
}

/// Normalises vectors; those of length zero remain zero.
#[inline(always)]
fn unit<S: Simd>(simd: S, [x, y, z]: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    let reciprocal = f32x16::splat(simd, 1.0) / (x * x + y * y + z * z).sqrt();
    let has_length = reciprocal.is_finite() & reciprocal.simd_gt(0.0);
    each!(component in [x, y, z] => has_length.select(component * reciprocal, f32x16::splat(simd, 0.0)))
}

/// Inputs of the light at sixteen samples.
#[derive(Clone, Copy)]
struct LaneInputs<'a, S: Simd> {
    simd: S,
    shader: &'a DrawShader<'a>,
    normal: [f32x16<S>; 3],
    vertex_light: f32x16<S>,
}

impl<S: Simd> LightInputs for LaneInputs<'_, S> {
    type Number = f32x16<S>;

    #[inline(always)]
    fn constant(&self, value: f32) -> f32x16<S> {
        f32x16::splat(self.simd, value)
    }

    #[inline(always)]
    fn normal(&self) -> [f32x16<S>; 3] {
        self.normal
    }

    #[inline(always)]
    fn vertex_light(&self) -> f32x16<S> {
        self.vertex_light
    }

    #[inline(always)]
    fn light_direction(&self) -> [f32x16<S>; 3] {
        let direction = self.shader.shader.light_direction.to_array();
        each!(axis in [0, 1, 2] => f32x16::splat(self.simd, direction[axis]))
    }

    #[inline(always)]
    fn ambient(&self) -> f32x16<S> {
        f32x16::splat(self.simd, self.shader.shader.settings.light.ambient)
    }

    #[inline(always)]
    fn dark_factor(&self) -> f32x16<S> {
        f32x16::splat(self.simd, self.shader.shader.dark_factor())
    }
}
