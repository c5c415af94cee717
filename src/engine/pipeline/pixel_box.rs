//! Bounding boxes of triangles in pixels.

/// Bounding box of a triangle in pixels, before snapping: minimum and maximum x, then minimum and maximum y.
pub(crate) type PixelBox = [f32; 4];

/// Returns the bounding box of a triangle's corners, in pixels.
pub(crate) fn box_around([a, b, c]: [[f32; 2]; 3]) -> PixelBox {
    let least = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
    let greatest = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
    [least(0), greatest(0), least(1), greatest(1)]
}
