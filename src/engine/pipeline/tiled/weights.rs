//! Interpolation weights of attributes, for sixteen samples.

use super::record::TriangleSource;
use super::shader::ShadingPlan;
use crate::math::lanes::*;
use crate::pipeline::formulas::{sum_of_three, weight_products};

/// Interpolation weights of attributes at sixteen samples.
#[derive(Clone, Copy)]
pub(super) struct AttributeWeights<S: Simd> {
    /// Weights of the second and third vertex.
    pub(super) of_corners: [f32x16<S>; 2],
    /// Reciprocal of Σ edge value × relative 1/w, with one term per vertex.
    inverse_sum: f32x16<S>,
}

/// Interpolation weights of sixteen samples, stored in memory: see [`AttributeWeights`].
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct StoredWeights {
    of_corners: [[f32; WIDE]; 2],
    /// Reciprocal of Σ edge value × relative 1/w, with one term per vertex. Only valid if the texture is mip-mapped.
    inverse_sum: [f32; WIDE],
}

impl StoredWeights {
    #[inline(always)]
    pub(super) fn store<S: Simd>(
        &mut self,
        plan: &ShadingPlan,
        AttributeWeights { of_corners: [second, third], inverse_sum }: AttributeWeights<S>,
    ) {
        second.store_array(&mut self.of_corners[0]);
        third.store_array(&mut self.of_corners[1]);
        if plan.mipmapped {
            inverse_sum.store_array(&mut self.inverse_sum);
        }
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S) -> AttributeWeights<S> {
        let [second, third, inverse_sum] = each!(of in [&self.of_corners[0], &self.of_corners[1], &self.inverse_sum] => f32x16::load_array_ref(simd, of));
        AttributeWeights { of_corners: [second, third], inverse_sum }
    }
}

impl<S: Simd> AttributeWeights<S> {
    /// Replaces the weights of the samples that `mine` does not select, which may be infinite or NaN, by the weights at
    /// the first vertex.
    #[inline(always)]
    pub(super) fn of_some(self, simd: S, mine: u32) -> Self {
        let (wanted, nothing) = (mask32x16::from_bitmask(simd, mine.into()), f32x16::splat(simd, 0.0));
        Self { of_corners: each!(i in [0, 1] => wanted.select(self.of_corners[i], nothing)), ..self }
    }

    /// Returns the gradients of the second and the third vertex's weights: the changes per pixel in x and in y.
    #[inline(always)]
    pub(super) fn gradient(&self, simd: S, source: impl TriangleSource) -> [[f32x16<S>; 2]; 2] {
        let (slopes, relative_inv_w) = (source.edge_slopes(simd), source.relative_inv_w(simd));
        each!(slopes in [slopes[0], slopes[1]] => {
            let q = weight_products(slopes, relative_inv_w);
            let sum = sum_of_three(q);
            each!(i in [0, 1] => (q[i + 1] - self.of_corners[i] * sum) * self.inverse_sum)
        })
    }
}

/// Computes interpolation weights from edge values and the relative 1/w of the vertices.
#[inline(always)]
pub(super) fn corner_weights<S: Simd>(
    simd: S,
    e: [f32x16<S>; 3],
    relative_inv_w: [f32x16<S>; 3],
) -> AttributeWeights<S> {
    let q = weight_products(e, relative_inv_w);
    let inverse_sum = f32x16::splat(simd, 1.0) / sum_of_three(q);
    AttributeWeights { of_corners: [q[1] * inverse_sum, q[2] * inverse_sum], inverse_sum }
}
