//! Colour and depth of a frame.

use glam::DVec3;

use super::color::{from_codes, to_codes};
use super::{Fault, Faults, Picture, Size};

/// Shaded sample of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment {
    /// z/w at the sample: 0 at the near plane, 1 at the far plane.
    pub(crate) depth: f64,
    /// Colour, not multiplied by the opacity.
    pub(crate) color: DVec3,
    /// Opacity, 0…1; fragments below 1 are blended and do not write depth.
    pub(crate) opacity: f64,
    /// Number of the object that the triangle belongs to.
    pub(crate) object: u32,
}

/// Number that stands for no object.
pub(crate) const NO_OBJECT: u32 = u32::MAX;

/// Finished frame with its buffers, row by row from the top left.
pub(crate) struct Finished {
    pub(crate) picture: Picture,
    /// Depth buffer.
    pub(crate) depths: Vec<f32>,
    /// Object drawn last in each pixel, or [`NO_OBJECT`].
    pub(crate) objects: Vec<u32>,
}

/// Colour and depth buffer.
pub(crate) struct Frame {
    size: Size,
    colors: Vec<DVec3>,
    depths: Vec<f32>,
    objects: Vec<u32>,
    faults: Faults,
}

impl Frame {
    /// Returns a frame filled with a background, in sRGB codes.
    pub(crate) fn new(size: Size, background: [u8; 3], faults: Faults) -> Self {
        let pixels = size.width * size.height;
        let clear = if faults.has(Fault::DepthReversed) { 0.0 } else { 1.0 };
        let colors = vec![from_codes(background, faults); pixels];
        Self { size, colors, depths: vec![clear; pixels], objects: vec![NO_OBJECT; pixels], faults }
    }

    /// Returns the value that the depth buffer stores for z/w.
    fn stored(&self, depth: f64) -> f32 {
        let rounded = |steps: f64| (depth * steps).round() / steps;
        match () {
            () if self.faults.has(Fault::Depth8) => rounded(255.0) as f32,
            () if self.faults.has(Fault::Depth16) => rounded(65535.0) as f32,
            () => depth as f32,
        }
    }

    /// Whether a depth passes the test against the buffer.
    fn passes(&self, depth: f32, stored: f32) -> bool {
        match () {
            () if self.faults.has(Fault::DepthOff) || self.faults.has(Fault::Painter) => true,
            () if self.faults.has(Fault::DepthReversed) => depth > stored,
            () => depth < stored,
        }
    }

    /// Tests a fragment in the pixel (x, y) and writes or blends it.
    pub(crate) fn draw(&mut self, x: usize, y: usize, fragment: Fragment) {
        let index = y * self.size.width + x;
        let depth = self.stored(fragment.depth);
        if !self.passes(depth, self.depths[index]) {
            return;
        }
        let Fragment { color, opacity, object, .. } = fragment;
        self.objects[index] = object;
        if opacity >= 1.0 {
            self.depths[index] = depth;
        }
        let weight = if self.faults.has(Fault::Premultiplied) { 1.0 } else { opacity };
        self.colors[index] = color * weight + self.colors[index] * (1.0 - opacity);
    }

    /// Returns the finished picture and its buffers.
    pub(crate) fn finish(self) -> Finished {
        let codes: Vec<_> = self.colors.iter().map(|&color| to_codes(color, self.faults)).collect();
        let pixels = self.placed(&codes);
        Finished {
            picture: Picture { size: self.size, pixels },
            depths: self.placed(&self.depths),
            objects: self.placed(&self.objects),
        }
    }

    /// Returns the values of pixels, in reverse order of rows or columns if the faults say so.
    fn placed<T: Clone>(&self, values: &[T]) -> Vec<T> {
        let mut rows: Vec<Vec<T>> = values.chunks(self.size.width).map(<[T]>::to_vec).collect();
        if self.faults.has(Fault::FlipVertical) {
            rows.reverse();
        }
        if self.faults.has(Fault::FlipHorizontal) {
            rows.iter_mut().for_each(|row| row.reverse());
        }
        rows.concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws fragments of (depth, grey in linear light, opacity) into one pixel on black.
    fn drawn(fragments: &[[f64; 3]], faults: &[Fault]) -> u8 {
        let mut frame = Frame::new(Size { width: 1, height: 1 }, [0; 3], Faults::new(faults));
        for &[depth, grey, opacity] in fragments {
            frame.draw(0, 0, Fragment { depth, color: DVec3::splat(grey), opacity, object: 0 });
        }
        frame.finish().picture.pixels[0][0]
    }

    #[test]
    fn the_nearest_fragment_wins() {
        let fragments = [[0.5, 0.25, 1.0], [0.25, 1.0, 1.0], [0.75, 0.0, 1.0]];
        assert_eq!(drawn(&fragments, &[]), 255);
        assert_eq!(drawn(&fragments, &[Fault::DepthReversed]), 0);
        assert_eq!(drawn(&fragments[..2], &[Fault::DepthReversed]), 137);
        assert_eq!(drawn(&fragments, &[Fault::DepthOff]), 0);
    }

    #[test]
    fn close_depths_tie_in_few_bits() {
        let fragments = [[0.4, 0.0, 1.0], [0.399_999, 1.0, 1.0]];
        assert_eq!(drawn(&fragments, &[]), 255);
        assert_eq!(drawn(&fragments, &[Fault::Depth16]), 0);
    }

    #[test]
    fn blended_fragments_mix_in_linear_light_and_write_no_depth() {
        let fragments = [[0.2, 1.0, 0.25], [0.5, 0.5, 0.5]];
        // 0.25, then 0.25 + 0.125 = 0.375; code 164.5 rounds to 165.
        assert_eq!(drawn(&fragments, &[]), 165);
        assert_eq!(drawn(&fragments, &[Fault::Premultiplied]), 255);
    }
}
