//! Size of a picture, and the transform from clip space to its pixels.

use glam::Vec3;

use crate::scene::SubView;

/// Size of a picture in pixels, which defines the transform from clip space to its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
}

/// Maximum side length of a picture, in pixels. It keeps coordinates well within the range of the rasterizer's fixed
/// point.
pub const MAX_SIDE_PX: u32 = 16_384;

/// Maximum number of pixels of a picture: enough for 8K (7680 × 4320). A picture of this size takes about 2 GB of
/// memory if every buffer is kept.
pub(crate) const MAX_PIXELS: u64 = 1 << 25;

impl Viewport {
    /// Checks that a picture of this size is supported. Returns an error message if it is not.
    pub fn check(self) -> Result<(), String> {
        let sides = 1..=MAX_SIDE_PX;
        if !sides.contains(&self.width) || !sides.contains(&self.height) {
            return Err(format!("each side must be 1 to {MAX_SIDE_PX} pixels long"));
        }
        if u64::from(self.width) * u64::from(self.height) > MAX_PIXELS {
            return Err(format!("at most {MAX_PIXELS} pixels are supported"));
        }
        Ok(())
    }

    /// Returns the aspect ratio: width divided by height.
    pub fn aspect(self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// Returns the part of a view that a picture of this size shows. The whole view has the size `full`, in pixels. The
    /// centre of pixel (i, j) of the picture lies at (i + ½, j + ½) · `step_px` + `origin_px`, in pixels of the view.
    /// The right and lower borders of the picture may lie outside or inside the view.
    pub(crate) fn window(self, full: Self, step_px: f64, origin_px: [f64; 2]) -> SubView {
        let axis = |full: u32, own: u32, origin: f64| {
            let (full, own) = (f64::from(full), step_px * f64::from(own));
            // Solves (ndc + 1) / 2 · full = (ndc' + 1) / 2 · own + origin for ndc'. Both sides are x in pixels of the
            // view; ndc belongs to the view, ndc' to the picture.
            ((full / own) as f32, ((full - 2.0 * origin) / own - 1.0) as f32)
        };
        let (scale_x, shift_x) = axis(full.width, self.width, origin_px[0]);
        let (scale_y, shift_down) = axis(full.height, self.height, origin_px[1]);
        SubView { aspect: full.aspect(), scale: [scale_x, scale_y], shift: [shift_x, -shift_down] }
    }

    /// Returns the pixel position, before snapping, of a point in normalised device coordinates (y up).
    pub(crate) fn pixels_from_ndc(self, ndc: Vec3) -> (f32, f32) {
        ((ndc.x * 0.5 + 0.5) * self.width as f32, (0.5 - ndc.y * 0.5) * self.height as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_puts_pixels_where_they_are_seen_in_the_view() {
        let (full, small) = (Viewport { width: 37, height: 20 }, Viewport { width: 13, height: 7 });
        for (step, origin) in [(3.0, [0.0, 0.0]), (3.0, [-1.0, -1.0]), (1.5, [0.25, -0.4])] {
            let window = small.window(full, step, origin);
            for (x, y) in [(0.0, 0.0), (0.5, -0.75), (-1.0, 1.0)] {
                let (full_x, full_y) = full.pixels_from_ndc(Vec3::new(x, y, 0.0));
                let own = Vec3::new(x * window.scale[0] + window.shift[0], y * window.scale[1] + window.shift[1], 0.0);
                let (own_x, own_y) = small.pixels_from_ndc(own);
                for (full, own, origin) in [(full_x, own_x, origin[0]), (full_y, own_y, origin[1])] {
                    let seen_at = f64::from(own) * step + origin;
                    assert!((seen_at - f64::from(full)).abs() < 1e-4, "{step} {origin}: {seen_at}, not {full}");
                }
            }
        }
    }
}
