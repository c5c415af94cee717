//! Axis-aligned bounding boxes.

use glam::{Mat4, Vec3};

/// Axis-aligned bounding box. [`Aabb::EMPTY`] contains nothing and is the neutral element of [`Aabb::union`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Corner with the smallest x, y and z.
    pub min: Vec3,
    /// Corner with the largest x, y and z.
    pub max: Vec3,
}

impl Aabb {
    /// Box that contains every point with finite coordinates.
    pub(crate) const EVERYTHING: Self = Self { min: Vec3::MIN, max: Vec3::MAX };

    /// Box that contains no point.
    pub(crate) const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Returns the smallest box that contains all `points`, or [`Aabb::EMPTY`] if there are none.
    pub(crate) fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Returns whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Returns the smallest box that contains both boxes.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Returns the centre. Each corner is halved before the sum, so the result is finite even for the largest
    /// coordinates.
    pub(crate) fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Returns the radius of the sphere around [`Aabb::center`] through the corners. Computed in `f64`, so it cannot
    /// overflow.
    pub(crate) fn radius(&self) -> f32 {
        let half = self.max.as_dvec3() * 0.5 - self.min.as_dvec3() * 0.5;
        half.length() as f32
    }

    /// Returns the eight corners. Bits 0, 1 and 2 of the index select the maximum of x, y and z.
    pub(crate) fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Returns the smallest box around the eight corners after a transformation. `target_from_source` must be affine.
    pub(crate) fn transformed(&self, target_from_source: Mat4) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::around(self.corners().map(|c| target_from_source.transform_point3(c)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_empty() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert!(Aabb::EMPTY.is_empty());
        assert_eq!(Aabb::EMPTY.union(unit), unit);
    }

    #[test]
    fn the_largest_box_has_a_finite_center_and_radius() {
        let b = Aabb { min: Vec3::splat(-1.5e38), max: Vec3::splat(1.5e38) };
        assert_eq!(b.center(), Vec3::ZERO);
        assert!(b.radius().is_finite());
    }
}
