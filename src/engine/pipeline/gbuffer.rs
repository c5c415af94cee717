//! G-buffer: the visible object of every rasterized pixel and its distance, for upscalers that read more than colours.

use crate::image::{Image, Rgba8};

/// Visible surface of every rasterized pixel, determined without shading. Alpha-tested and transparent surfaces count as
/// opaque.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GBuffer {
    /// Index of the instance in each pixel, as four bytes, least significant first; [`GBuffer::NO_OBJECT`] where there
    /// is none.
    pub(crate) object: Image<Rgba8>,
    /// Distance along the view axis, in world units. Where there is no surface, it is infinite or the distance of the
    /// far plane.
    pub(crate) distance: Image<f32>,
}

/// Relative difference up to which two distances count as equal: depths are rounded, and pixels sample slightly
/// different positions.
pub(crate) const SAME_DISTANCE: f32 = 0.02;

impl GBuffer {
    /// Value of [`GBuffer::object`] in pixels without a surface.
    pub(crate) const NO_OBJECT: Rgba8 = [u8::MAX; 4];

    /// Whether a pixel shows this object at about this distance.
    pub(crate) fn shows(&self, (x, y): (u32, u32), object: Rgba8, distance: f32) -> bool {
        let there = self.distance.at(x, y);
        let near = (there - distance).abs() <= SAME_DISTANCE * distance.abs();
        self.object.at(x, y) == object && (near || there == distance)
    }

    /// Whether two pixels show the same object at about the same distance.
    pub(crate) fn same_surface(&self, a: (u32, u32), b: (u32, u32)) -> bool {
        self.shows(a, self.object.at(b.0, b.1), self.distance.at(b.0, b.1))
    }
}
