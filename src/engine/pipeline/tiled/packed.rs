//! Packed layouts of vertices, which SIMD code loads whole.

use glam::Vec3;

use crate::math::lanes::*;

/// Screen-space vertex with the attributes that most shading modes read, in half a cache line. It is a single array, so
/// that SIMD code can load it whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(super) struct PackedVertex {
    pub(super) numbers: [f32; LANES],
}

impl PackedVertex {
    /// Index of the snapped x coordinate. The coordinate is an integer below 2²⁴, in steps of 1/256 px, and increases
    /// to the right.
    pub(super) const X: usize = 0;
    /// Index of the snapped y coordinate, in steps of 1/256 px, increasing downward.
    pub(super) const Y: usize = 1;
    /// Index of the lower 32 bits of the depth, an f64. The upper 32 bits follow.
    const DEPTH: usize = 2;
    /// Index of 1/w, the reciprocal of clip-space w.
    pub(super) const INV_W: usize = 4;
    /// Index of the light intensity at the vertex, for Gouraud shading only.
    pub(super) const LIGHT: usize = 5;
    /// Indices of the texture coordinates u and v, with v pointing down.
    pub(super) const UV: [usize; 2] = [6, 7];

    pub(super) fn new([x, y]: [f32; 2], depth: f64, inv_w: f32, light: f32, [u, v]: [f32; 2]) -> Self {
        let bits = depth.to_bits();
        let [low, high] = [bits as u32, (bits >> 32) as u32].map(f32::from_bits);
        Self { numbers: [x, y, low, high, inv_w, light, u, v] }
    }

    /// Returns the bits of the snapped position, with x in the lower 32 bits and y in the upper 32 bits.
    #[inline(always)]
    pub(super) fn position_bits(&self) -> u64 {
        let [x, y] = self.position().map(f32::to_bits);
        u64::from(x) | u64::from(y) << 32
    }

    /// Returns the snapped position in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn position(&self) -> [f32; 2] {
        [self.numbers[Self::X], self.numbers[Self::Y]]
    }

    /// Returns the depth in [0, 1], before quantisation.
    #[inline(always)]
    pub(super) fn depth(&self) -> f64 {
        let half = |i: usize| u64::from(self.numbers[Self::DEPTH + i].to_bits());
        f64::from_bits(half(0) | half(1) << 32)
    }

    /// Returns 1/w, the reciprocal of clip-space w.
    #[inline(always)]
    pub(super) fn inv_w(&self) -> f32 {
        self.numbers[Self::INV_W]
    }

    /// Returns 1/w, light, u and v of eight vertices.
    #[inline(always)]
    pub(super) fn attributes<S: Simd>(simd: S, vertices: &[&Self; LANES]) -> [F32<S>; 4] {
        transpose_quads(each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => f32x4::from_slice(simd, &vertices[i].numbers[4..])))
    }

    /// Returns the snapped positions of eight vertices, in steps of 1/256 px, and their depths.
    #[inline(always)]
    pub(super) fn positions_and_depths<S: Simd>(simd: S, vertices: &[&Self; LANES]) -> ([F32<S>; 2], F64<S>) {
        let rows = each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => f32x4::from_slice(simd, &vertices[i].numbers[..4]));
        let [x, y, low, high] = transpose_quads(rows);
        let (first, last) = low.interleave(high);
        ([x, y], first.bitcast::<f64x4<S>>().combine(last.bitcast::<f64x4<S>>()))
    }
}

/// Normal and colour of a vertex, for shading that reads them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(super) struct PackedSurface {
    pub(super) numbers: [f32; LANES],
}

impl PackedSurface {
    /// Indices of the components of the world-space normal.
    pub(super) const NORMAL: [usize; 3] = [0, 1, 2];
    /// Indices of the red, green and blue channels of the vertex colour.
    pub(super) const COLOR: [usize; 3] = [4, 5, 6];

    pub(super) fn new(normal: Vec3, color: Vec3) -> Self {
        let ([nx, ny, nz], [r, g, b]) = (normal.to_array(), color.to_array());
        Self { numbers: [nx, ny, nz, 0.0, r, g, b, 0.0] }
    }

    /// Returns the vector of the three numbers with these indices.
    pub(super) fn vector(&self, places: [usize; 3]) -> Vec3 {
        Vec3::from_array(places.map(|place| self.numbers[place]))
    }
}
