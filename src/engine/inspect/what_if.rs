//! Effect of a recipe change on a frame: the pixels of the picture or of a buffer that differ.
//!
//! Pixels are compared by value, never by display colour. Two frames with different depth ranges may display equal
//! depths in different colours, but their pixels count as equal wherever their depths are equal.

use crate::chain::Frame;
use crate::image::color::luma;
use crate::image::{Image, Rgba8};

use super::buffers::{Buffer, Buffers};
use super::view::{Value, value};

/// Values of the pixels of a picture.
#[derive(Clone, Copy, Debug)]
pub struct PictureValues<F> {
    /// Size of the picture, in pixels.
    pub size: (u32, u32),
    /// Function that returns the value of the pixel in a column and a row.
    pub value: F,
}

/// Pixels that differ between two frames of the same size.
#[derive(Clone, Debug)]
pub struct Changes {
    /// Mask with the size of the frames: `true` for each pixel that differs.
    pub mask: Image<bool>,
    /// Number of pixels that differ.
    pub count: u64,
}

/// Returns the values of a buffer of a frame. `buffers` are the captured buffers of the frame; [`Buffer::Color`] needs
/// none.
pub fn values_of_buffer<'a>(
    buffer: Buffer,
    frame: &'a Frame,
    buffers: Option<&'a Buffers>,
) -> PictureValues<impl Fn(u32, u32) -> Value + 'a> {
    PictureValues { size: frame.image().size(), value: move |x, y| value(buffer, frame, buffers, x, y) }
}

impl Changes {
    /// Compares the values of two pictures. Returns `None` if the pictures have different sizes.
    pub fn of_values(
        a: &PictureValues<impl Fn(u32, u32) -> Value>,
        b: &PictureValues<impl Fn(u32, u32) -> Value>,
    ) -> Option<Self> {
        let (width, height) = a.size;
        let differs = |x, y| !same((a.value)(x, y), (b.value)(x, y));
        (a.size == b.size).then(|| Self::of_mask(Image::from_fn(width, height, differs)))
    }

    /// Compares the colours of two pictures, ignoring alpha. Returns `None` if the pictures have different sizes.
    pub fn of_pictures(a: &Image<Rgba8>, b: &Image<Rgba8>) -> Option<Self> {
        let (width, height) = a.size();
        (a.size() == b.size())
            .then(|| Self::of_mask(Image::from_fn(width, height, |x, y| a.at(x, y)[..3] != b.at(x, y)[..3])))
    }

    /// Counts the pixels of a mask.
    pub fn of_mask(mask: Image<bool>) -> Self {
        let count = mask.pixels().iter().filter(|changed| **changed).count() as u64;
        Self { mask, count }
    }

    /// Returns the fraction of pixels that differ, in [0, 1].
    pub fn share(&self) -> f64 {
        self.count as f64 / self.mask.pixels().len().max(1) as f64
    }

    /// Returns the next or previous changed pixel relative to `from` in row-major order, wrapping around at the end. If
    /// `from` is `None`, returns the first or the last changed pixel.
    pub fn next_changed(&self, from: Option<(u32, u32)>, forwards: bool) -> Option<(u32, u32)> {
        let (width, height) = self.mask.size();
        let all = width as usize * height as usize;
        let start =
            from.filter(|(x, y)| *x < width && *y < height).map(|(x, y)| y as usize * width as usize + x as usize);
        let places = (0..all).map(|step| match (start, forwards) {
            (Some(start), true) => (start + 1 + step) % all,
            (Some(start), false) => (start + 2 * all - 1 - step) % all,
            (None, true) => step,
            (None, false) => all - 1 - step,
        });
        let place = places.into_iter().find(|place| self.mask.pixels()[*place])?;
        Some(((place % width as usize) as u32, (place / width as usize) as u32))
    }

    /// Returns `picture` with its unchanged pixels mapped to dark greys.
    pub fn with_unchanged_dimmed(&self, picture: &Image<Rgba8>) -> Image<Rgba8> {
        /// Grey levels, in [0, 255], to which black and white are mapped: much darker than changed colours, but bright
        /// enough to recognise the scene.
        const GREYS: (f64, f64) = (16.0, 72.0);
        let (width, height) = picture.size();
        Image::from_fn(width, height, |x, y| {
            let color = picture.at(x, y);
            if self.mask.get(x, y) == Some(true) {
                return color;
            }
            let grey = (GREYS.0 + (GREYS.1 - GREYS.0) * f64::from(luma(color)) / 255.0) as u8;
            [grey, grey, grey, 255]
        })
    }
}

/// Whether two values are equal. Floats are compared by their bits, and alpha is ignored.
fn same(a: Value, b: Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => a.to_bits() == b.to_bits(),
        (Value::Weights(a), Value::Weights(b)) => a.map(f32::to_bits) == b.map(f32::to_bits),
        (Value::Color(a), Value::Color(b)) => a[..3] == b[..3],
        (a, b) => a == b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Recipe, run};
    use crate::inspect::capture;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 96, height: 64 };

    fn frame(scene: &str, set: &[&str]) -> (Frame, Buffers) {
        let scene = builtin::by_id(scene).unwrap().build();
        let mut recipe = Recipe::default();
        recipe.set_all(set).unwrap();
        let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
        let buffers = capture(&scene, &recipe, &frame);
        (frame, buffers)
    }

    /// Returns the differences of a buffer between two frames.
    fn differing(buffer: Buffer, a: &(Frame, Buffers), b: &(Frame, Buffers)) -> Changes {
        let a = values_of_buffer(buffer, &a.0, Some(&a.1));
        Changes::of_values(&a, &values_of_buffer(buffer, &b.0, Some(&b.1))).unwrap()
    }

    #[test]
    fn equal_frames_have_no_changed_pixels_in_any_buffer() {
        let (a, b) = (frame("interpenetrating", &[]), frame("interpenetrating", &["execution=classic"]));
        for buffer in [Buffer::Color, Buffer::Depth, Buffer::TriangleId, Buffer::Lambda, Buffer::Overdraw] {
            let changes = differing(buffer, &a, &b);
            assert_eq!((changes.count, changes.next_changed(None, true)), (0, None), "{buffer:?}");
        }
    }

    #[test]
    fn values_with_equal_display_colours_can_differ() {
        let of = |size, number: f32| {
            let value = move |x: u32, _: u32| Value::Number(if x == 1 { number } else { f32::NAN });
            PictureValues { size, value }
        };
        let changes = |number| Changes::of_values(&of((3, 2), 1.0), &of((3, 2), number)).unwrap().count;
        assert_eq!((changes(1.0), changes(1.0_f32.next_up())), (0, 2));
        assert!(Changes::of_values(&of((3, 2), 1.0), &of((2, 3), 1.0)).is_none());
    }

    #[test]
    fn changes_from_an_inclusive_fill_rule_match_a_manual_count() {
        let (a, b) = (frame("shared-edges", &[]), frame("shared-edges", &["fill_rule=inclusive"]));
        let changes = Changes::of_pictures(a.0.image(), b.0.image()).unwrap();
        let mut by_hand = 0;
        for y in 0..SIZE.height {
            for x in 0..SIZE.width {
                let ([r0, g0, b0, _], [r1, g1, b1, _]) = (a.0.image().at(x, y), b.0.image().at(x, y));
                by_hand += u64::from(r0 != r1 || g0 != g1 || b0 != b1);
            }
        }
        assert!(by_hand > 0);
        assert_eq!(changes.count, by_hand);
        // Colours need no captured buffers.
        let [before, after] = [&a.0, &b.0].map(|frame| values_of_buffer(Buffer::Color, frame, None));
        let same = Changes::of_values(&before, &after).unwrap();
        assert_eq!(same.mask, changes.mask);
        // Pixels on the edges are covered twice under the inclusive rule, so overdraw differs exactly there.
        let overdraw = differing(Buffer::Overdraw, &a, &b);
        let doubled = b.1.overdraw.pixels().iter().zip(a.1.overdraw.pixels()).filter(|(b, a)| b != a).count() as u64;
        assert_eq!(overdraw.count, doubled);
        assert!(doubled >= by_hand, "a pixel changes its colour only where another triangle won it");
    }

    #[test]
    fn depths_are_compared_by_value_and_not_by_colour() {
        let (a, b) = (frame("interpenetrating", &[]), frame("interpenetrating", &["depth_format=unorm16"]));
        let changes = differing(Buffer::Depth, &a, &b);
        let values = |x, y| [&a, &b].map(|(frame, buffers)| value(Buffer::Depth, frame, Some(buffers), x, y));
        for y in 0..SIZE.height {
            for x in 0..SIZE.width {
                let [before, after] = values(x, y);
                assert_eq!(changes.mask.at(x, y), before != after);
            }
        }
        assert!(changes.count > 100);
    }

    #[test]
    fn changed_pixels_are_visited_in_reading_order_and_wrap_around() {
        let before = Image::filled(5, 4, [9, 9, 9, 255]);
        let mut after = before.clone();
        let changed = [(3, 0), (0, 2), (4, 3)];
        changed.iter().for_each(|(x, y)| after.set(*x, *y, [200, 0, 0, 255]));
        let changes = Changes::of_pictures(&before, &after).unwrap();
        assert_eq!((changes.count, changes.share()), (3, 0.15));
        let mut at = None;
        for expected in changed.into_iter().chain(changed) {
            at = changes.next_changed(at, true);
            assert_eq!(at, Some(expected));
        }
        assert_eq!(changes.next_changed(Some((3, 0)), false), Some((4, 3)));
        assert_eq!(changes.next_changed(None, false), Some((4, 3)));
        assert_eq!(changes.next_changed(Some((2, 2)), false), Some((0, 2)));
        let marked = changes.with_unchanged_dimmed(&after);
        assert_eq!(marked.at(3, 0), [200, 0, 0, 255]);
        assert!(marked.at(1, 1)[0] < 72);
        assert!(Changes::of_pictures(&before, &Image::filled(4, 5, [0; 4])).is_none());
    }
}
