//! Conversion between distances and depths: the depth of a vertex, and the world-space distance between two depths.
//!
//! In a perspective view, the depth of a point depends only on its distance, which is w. Depth is therefore computed
//! from w in f64, and not as the quotient of z and w, which are both rounded to f32. Rounded to f32, the result is the
//! float nearest to the exact depth in all but about one case in a hundred million.
//!
//! Depth preserves order: of two vertices in perspective, the one with the larger w is never stored as nearer. The
//! formulas consist of a difference, a quotient and a product with a constant, each correctly rounded. If the
//! difference is exact, depth is therefore monotonic in w. The difference between w and the distance of a plane is
//! rounded only if one of the two is more than 2²⁹ times the other. With reversed depth, w is then so small that
//! neighbouring f32 values of w differ in depth by far more than the rounding error. With standard depth, w is then so
//! large that its stored depth is the same as for the far plane.
//!
//! This guarantee has limits:
//! - w is a rounded sum, so points closer together than its rounding error may already be in the wrong order.
//! - Vertices created by clipping get the depth of the near or far plane, or a depth computed from an interpolated w.
//! - Inside a triangle, depth is interpolated from the triangle's own corners.
//! - In orthographic views, depth is clip-space z over w, with all rounding of the matrix product.

use super::bias::{BiasRule, TriangleBias};
use super::function::DepthFunction;
use crate::math::lanes::*;
use crate::pipeline::clip_space::{ClipPlane, ClipVertex};
use crate::pipeline::depth_format::DepthEncoding;
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::pipeline::settings::{DepthFormat, Settings};
use crate::scene::{Camera, DepthCurve, DepthMapping, Projection};

/// Mapping between distances and stored depths for one view. Distances are measured from the eye along the view
/// direction, in world units.
///
/// The default applies to vertices without a camera: depth is z/w, stored as a float. Distances and depths of vertices
/// exclude depth bias, which is computed per triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthScale {
    law: DepthLaw,
    encoding: DepthEncoding,
    near: f64,
    far: f64,
    /// Distance of the plane where depth is 0. Not read if it is infinite.
    zero: f64,
    /// Constant factor of [`DepthMapping::depth`].
    factor: f64,
    bias: BiasRule,
}

/// Relation between distance and depth, which also determines how the depth of a vertex is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DepthLaw {
    /// Mapping between distance and depth. In orthographic views it is linear.
    pub(crate) mapping: DepthMapping,
    /// Source of the depth of a vertex.
    pub(crate) source: DepthSource,
}

/// Source of the depth of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DepthSource {
    /// Perspective projection: the distance is w, and depth is computed from it.
    Distance,
    /// Orthographic projection: depth is z/w.
    ClipSpace,
}

impl DepthLaw {
    fn perspective(mapping: DepthMapping) -> Self {
        Self { mapping, source: DepthSource::Distance }
    }

    fn orthographic(mapping: DepthMapping) -> Self {
        Self { mapping: mapping.in_orthographic_view(), source: DepthSource::ClipSpace }
    }

    /// Returns whether depth is linear in world space rather than in screen space.
    #[inline(always)]
    fn is_linear_in_space(self) -> bool {
        self.source == DepthSource::Distance && self.mapping.curve == DepthCurve::Linear
    }
}

impl Default for DepthScale {
    fn default() -> Self {
        Self::with_law(DepthLaw::orthographic(DepthMapping::STANDARD), DepthEncoding::F32, [0.0, 1.0])
    }
}

impl DepthScale {
    /// Returns the mapping of a view drawn with the given settings.
    pub(crate) fn of(settings: &Settings, camera: &Camera) -> Self {
        Self { bias: BiasRule::new(settings), ..Self::new(settings.depth_format, camera) }
    }

    /// Returns the mapping of a view with the given depth format, without depth bias.
    pub(crate) fn new(format: DepthFormat, camera: &Camera) -> Self {
        let law = match camera.projection {
            Projection::Perspective { .. } => DepthLaw::perspective(format.mapping()),
            Projection::Orthographic { .. } => DepthLaw::orthographic(format.mapping()),
        };
        Self::with_law(law, format.encoding(), [camera.near, camera.far])
    }

    /// Returns the mapping of a perspective view with the given planes, 0 < `near` < `far`.
    /// Mappings without a far plane ignore `far`.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::pipeline::depth::DepthScale;
    /// use rasterscope_engine::pipeline::depth_format::DepthEncoding;
    /// use rasterscope_engine::scene::DepthMapping;
    ///
    /// let scale = DepthScale::perspective(DepthMapping::STANDARD, DepthEncoding::Unorm16, 1.0, 100.0);
    /// assert_eq!((scale.stored(1.0), scale.stored(100.0)), (0.0, 1.0));
    /// assert_eq!(scale.encoding().code(scale.stored(100.0)), Some(65_535));
    ///
    /// // The first unit of distance takes more than half of all codes.
    /// assert!(scale.stored(2.0) > 0.5);
    /// assert!(scale.resolution(scale.stored(90.0)) > 1000.0 * scale.resolution(scale.stored(2.0)));
    /// ```
    pub fn perspective(mapping: DepthMapping, encoding: DepthEncoding, near: f32, far: f32) -> Self {
        Self::with_law(DepthLaw::perspective(mapping), encoding, [near, far])
    }

    fn with_law(law: DepthLaw, encoding: DepthEncoding, planes: [f32; 2]) -> Self {
        let [near, far] = planes.map(f64::from);
        let [zero, _] = law.mapping.zero_and_one([near, far]);
        Self { law, encoding, near, far, zero, factor: law.mapping.factor([near, far]), bias: BiasRule::OFF }
    }

    /// Returns the relation between distance and depth.
    pub(crate) fn law(&self) -> DepthLaw {
        self.law
    }

    /// Returns the distance of the plane where depth is 0, and the constant factor of [`DepthMapping::depth`].
    pub(crate) fn zero_and_factor(&self) -> [f64; 2] {
        [self.zero, self.factor]
    }

    /// Returns the number format of stored depths.
    pub fn encoding(&self) -> DepthEncoding {
        self.encoding
    }

    /// Returns the stored depth of a point at `distance` > 0, with the arithmetic that the pipeline uses for vertices
    /// in perspective.
    pub fn stored(&self, distance: f32) -> f32 {
        self.encoding.quantize(self.depth(distance.into()).clamp(0.0, 1.0))
    }

    /// Returns the distance that a stored depth represents, up to rounding. The result is infinite for the depth of
    /// points at infinity.
    pub fn distance_of(&self, stored: f32) -> f64 {
        let [depth, _] = self.encoding.depth_and_next(stored);
        self.law.mapping.distance(depth, self.zero, self.factor)
    }

    /// Replaces each stored depth by the distance that it represents ([`DepthScale::distance_of`]), rounded to the
    /// nearest float.
    pub(crate) fn replace_by_distances(&self, lanes: Lanes, depths: &mut [f32]) {
        let (eights, rest) = depths.as_chunks_mut();
        on_lanes!(lanes, simd => {
            for eight in eights {
                narrow(simd, self.distances_of(simd, F32::load_array_ref(simd, eight))).store_array(eight);
            }
        });
        for depth in rest {
            *depth = self.distance_of(*depth) as f32;
        }
    }

    /// Returns the distances that eight stored depths represent, with the arithmetic of [`DepthScale::distance_of`].
    #[inline(always)]
    fn distances_of<S: Simd>(&self, simd: S, stored: F32<S>) -> F64<S> {
        let depth = self.encoding.depths_of(simd, stored);
        self.law.mapping.distance(depth, F64::splat(simd, self.zero), F64::splat(simd, self.factor))
    }

    /// Returns the depth resolution at a stored depth: the distance between the points that this depth and the next
    /// storable depth represent. Surfaces closer together than this may get equal depths. The result is infinite if the
    /// next depth represents infinity.
    pub fn resolution(&self, stored: f32) -> f64 {
        let Self { near, far, law: DepthLaw { mapping, .. }, .. } = *self;
        let [a, b] = self.encoding.depth_and_next(stored);
        let step = (b - a).abs();
        // The closed form avoids cancellation: the two distances may agree in all digits, so they are not subtracted.
        let [zero, one] = mapping.zero_and_one([near, far]);
        match mapping.curve {
            DepthCurve::Hyperbolic => {
                let factor = |depth: f64| (1.0 - depth) * one + depth * zero;
                near * far * (far - near) * step / (factor(a) * factor(b))
            }
            DepthCurve::HyperbolicInfinite if mapping.reversed => near * step / (a * b),
            DepthCurve::HyperbolicInfinite => near * step / ((1.0 - a) * (1.0 - b)),
            DepthCurve::Linear => (far - near) * step,
        }
    }

    /// Returns the depth of a vertex in [0, 1], before it is quantised.
    #[inline]
    pub(crate) fn of_vertex(&self, vertex: &ClipVertex) -> f64 {
        let (z, w) = (f64::from(vertex.position.z), f64::from(vertex.position.w));
        let depth = match (vertex.cut_at, self.law.source) {
            (Some(plane), _) => self.of_plane(plane),
            (None, DepthSource::Distance) => self.depth(w),
            (None, DepthSource::ClipSpace) => z / w,
        };
        // Adding 0 turns −0, whose bits are far from those of its neighbours, into +0.
        depth.clamp(0.0, 1.0) + 0.0
    }

    /// Returns the depths in [0, 1] of eight unclipped vertices from their z and w, before quantisation. The arithmetic
    /// is that of [`DepthScale::of_vertex`].
    #[inline(always)]
    pub(crate) fn of_lanes<S: Simd>(&self, simd: S, z: F32<S>, w: F32<S>) -> F64<S> {
        let distance = widen(simd, w);
        let depth = match self.law.source {
            DepthSource::Distance => {
                let [zero, factor] = each!(number in [self.zero, self.factor] => F64::splat(simd, number));
                self.law.mapping.depth(distance, zero, factor)
            }
            DepthSource::ClipSpace => widen(simd, z) / distance,
        };
        clamp_f64(depth, 0.0, 1.0) + 0.0
    }

    /// Returns whether depth is linear in world space rather than in screen space.
    pub(crate) fn is_linear_in_space(&self) -> bool {
        self.law.is_linear_in_space()
    }

    /// Returns the distance of a corner from the eye: w in perspective, otherwise the distance that its depth
    /// represents.
    pub(crate) fn distance(&self, corner: &ScreenVertex) -> f64 {
        let range = self.far - self.near;
        match self.law.source {
            DepthSource::Distance => 1.0 / f64::from(corner.inv_w),
            DepthSource::ClipSpace if self.law.mapping.reversed => self.far - corner.depth * range,
            DepthSource::ClipSpace => self.near + corner.depth * range,
        }
    }

    /// Returns whether a depth bias is added to the depths of triangles.
    #[inline(always)]
    pub(crate) fn is_biased(&self) -> bool {
        !self.bias.is_off()
    }

    /// Returns the depth bias of a triangle, or `None` if no bias is set.
    pub(crate) fn bias_of(&self, corners: &[ScreenVertex; 3]) -> Option<TriangleBias> {
        let depths = corners.each_ref().map(|v| v.depth);
        self.is_biased().then(|| self.bias.of(self.bias.positions_px(corners), depths, self.encoding))
    }

    /// Returns the offset that the depth bias adds to a triangle's depths; 0 without a bias. The arguments are the
    /// snapped corners in pixels and the corner depths.
    #[inline(always)]
    pub(in crate::pipeline) fn offset(&self, snapped_px: [[f64; 2]; 3], depths: [f64; 3]) -> f64 {
        if self.is_biased() { self.bias.of(snapped_px, depths, self.encoding).offset } else { 0.0 }
    }

    /// Returns the depth function of a triangle, including depth bias. `doubled_area` is in the unit of edge values.
    pub(crate) fn over(&self, corners: &[ScreenVertex; 3], doubled_area: f64) -> DepthFunction {
        let function = self.function(corners.each_ref().map(|v| v.depth), doubled_area);
        match self.bias_of(corners) {
            Some(bias) => function.offset_by(bias.offset),
            None => function,
        }
    }

    /// Returns the smallest corner depth of a triangle, and one factor per corner, both without depth bias. Each factor
    /// multiplies the corner's edge value or, if depth is linear in world space, its perspective-correct weight.
    #[inline(always)]
    pub(in crate::pipeline) fn terms(&self, depths: [f64; 3], doubled_area: f64) -> (f64, [f64; 3]) {
        self.function(depths, doubled_area).terms()
    }

    #[inline(always)]
    fn function(&self, depths: [f64; 3], doubled_area: f64) -> DepthFunction {
        if self.law.is_linear_in_space() {
            DepthFunction::linear_in_space(depths, self.encoding)
        } else {
            DepthFunction::affine_on_screen(depths, doubled_area, self.encoding)
        }
    }

    /// Returns the depth that corresponds to a distance. It lies outside [0, 1] for distances in front of the near
    /// plane or beyond the far plane.
    #[inline]
    fn depth(&self, distance: f64) -> f64 {
        self.law.mapping.depth(distance, self.zero, self.factor)
    }

    /// Returns the depth of a vertex that clipping placed on the plane z = 0 (near) or z = w (far) of clip space.
    fn of_plane(&self, plane: ClipPlane) -> f64 {
        let mapping = self.law.mapping;
        // The clip-space z of linear depth in perspective is that of another mapping.
        let mirrored = match self.law.source {
            DepthSource::Distance => mapping.in_clip_space().is_reversed() != mapping.is_reversed(),
            DepthSource::ClipSpace => false,
        };
        f64::from(u8::from((plane == ClipPlane::Far) != mirrored))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::Choice as _;

    #[test]
    fn simd_lanes_return_the_distances_of_scalar_code() {
        let mut random = fastrand::Rng::with_seed(9);
        let camera = Camera { near: 0.03, far: 700.0, ..Camera::look_at(glam::Vec3::Z, glam::Vec3::ZERO) };
        for (format, orthographic) in DepthFormat::ALL.iter().flat_map(|format| [(format, false), (format, true)]) {
            let scale = DepthScale::new(*format, &camera.with_orthographic(orthographic));
            let ends = [0.0, 1.0, 1.0_f32.next_down(), f32::MIN_POSITIVE];
            let random = std::iter::repeat_with(|| random.f32().powi(random.i32(1..9)));
            let stored: Vec<_> =
                ends.into_iter().chain(random.take(99)).map(|d| scale.encoding.quantize(d.into())).collect();
            let alone: Vec<_> = stored.iter().map(|depth| (scale.distance_of(*depth) as f32).to_bits()).collect();
            for lanes in Lanes::all() {
                let mut together = stored.clone();
                scale.replace_by_distances(lanes, &mut together);
                let together: Vec<_> = together.iter().map(|distance| distance.to_bits()).collect();
                assert_eq!(together, alone, "{format:?} by {}", lanes.name());
            }
        }
    }
}
