//! Vertices in clip space, and the planes at which triangles are clipped.

use glam::{DVec4, Vec2, Vec3, Vec4};

/// Attributes interpolated over a triangle besides position. Attributes that the draw plan skips are zero, except that
/// the colour is white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Varyings {
    /// World-space normal, of unit length only at vertices.
    pub normal: Vec3,
    /// Texture coordinates, with v pointing down.
    pub uv: Vec2,
    /// Vertex colour in the working colour space; white if the mesh has none.
    pub color: Vec3,
    /// Light intensity computed at the vertex; 0 unless the shading reads it.
    pub light: f32,
    /// Barycentric weights of the three vertices of the unclipped triangle.
    pub source_weights: Vec3,
}

impl Varyings {
    /// Interpolates linearly from `self` at t = 0 to `other` at t = 1. A value that is equal in both stays exactly
    /// equal.
    pub(crate) fn lerp(&self, other: &Self, t: f32) -> Self {
        Self {
            normal: self.normal + (other.normal - self.normal) * t,
            uv: self.uv + (other.uv - self.uv) * t,
            color: self.color + (other.color - self.color) * t,
            light: self.light + (other.light - self.light) * t,
            source_weights: self.source_weights + (other.source_weights - self.source_weights) * t,
        }
    }
}

/// Vertex in clip space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClipVertex {
    /// Homogeneous position in clip space. Inside the frustum 0 ≤ z ≤ w, |x| ≤ w and |y| ≤ w.
    pub(crate) position: Vec4,
    /// Near or far plane if clipping created the vertex on it; `None` for all other vertices.
    pub(crate) cut_at: Option<ClipPlane>,
    /// Attributes of the vertex, to be interpolated.
    pub(crate) varyings: Varyings,
}

impl ClipVertex {
    /// Returns an unclipped vertex with default attributes.
    pub(crate) fn at(position: Vec4) -> Self {
        Self { position, cut_at: None, varyings: Varyings::default() }
    }
}

/// Smallest w that is projected: the smallest normal f32, so that 1/w is finite.
pub(crate) const MIN_W: f32 = f32::MIN_POSITIVE;

/// Clipping plane of the view frustum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipPlane {
    /// Plane z = 0, with z ≥ 0 inside. With reversed depth it is the far plane of the view: see [`Self::of_view`].
    Near,
    /// Plane w = [`MIN_W`], with w ≥ `MIN_W` inside. It replaces the condition w > 0. If a camera projected the
    /// vertices, a vertex inside the near plane of the view is also inside this plane, except for rounding errors.
    Eye,
    /// Plane z = w, with z ≤ w inside.
    Far,
    /// Plane x = −w, with x ≥ −w inside.
    Left,
    /// Plane x = w, with x ≤ w inside.
    Right,
    /// Plane y = −w, with y ≥ −w inside.
    Bottom,
    /// Plane y = w, with y ≤ w inside.
    Top,
}

impl ClipPlane {
    /// All planes, in the order of clipping: depth first, so that w > 0 when the sides are cut.
    pub(crate) const ALL: [Self; 7] =
        [Self::Near, Self::Eye, Self::Far, Self::Left, Self::Right, Self::Bottom, Self::Top];

    /// Returns the signed distance of a point from the plane, in clip-space units; ≥ 0 inside. The four side planes are
    /// moved outwards by the factor `widening`.
    #[inline]
    pub(crate) fn distance(self, p: Vec4, widening: f32) -> f64 {
        let DVec4 { x, y, z, w } = p.as_dvec4();
        let side = w * f64::from(widening);
        match self {
            Self::Near => z,
            Self::Eye => w - f64::from(MIN_W),
            Self::Far => w - z,
            Self::Left => side + x,
            Self::Right => side - x,
            Self::Bottom => side + y,
            Self::Top => side - y,
        }
    }

    /// Converts a clip-space plane to the plane of the view frustum that it represents, or the other way round: swaps
    /// near and far if z = 0 is the far plane.
    pub(crate) fn of_view(self, has_zero_at_far: bool) -> Self {
        match self {
            Self::Near if has_zero_at_far => Self::Far,
            Self::Far if has_zero_at_far => Self::Near,
            plane => plane,
        }
    }

    /// Returns the largest magnitude among the clip-space components from which [`Self::distance`] is computed. The
    /// argument holds the magnitudes of x, y, z and w.
    pub(super) fn magnitude(self, DVec4 { x, y, z, w }: DVec4) -> f64 {
        match self {
            Self::Near => z,
            Self::Eye => w,
            Self::Far => w.max(z),
            Self::Left | Self::Right => w.max(x),
            Self::Bottom | Self::Top => w.max(y),
        }
    }

    /// Returns whether the plane is the near or the far plane, all of whose points have the same depth.
    pub(super) fn is_of_depth(self) -> bool {
        matches!(self, Self::Near | Self::Far)
    }

    /// Returns `p` moved exactly onto the plane by changing one of its components.
    pub(super) fn pin(self, p: Vec4, widening: f32) -> Vec4 {
        let side = p.w * widening;
        match self {
            Self::Near => p.with_z(0.0),
            Self::Eye => p.with_w(MIN_W),
            Self::Far => p.with_z(p.w),
            Self::Left => p.with_x(-side),
            Self::Right => p.with_x(side),
            Self::Bottom => p.with_y(-side),
            Self::Top => p.with_y(side),
        }
    }
}
