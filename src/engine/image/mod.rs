//! Images in memory, colour spaces, and image files.

pub mod color;

mod decoder;

pub mod file;

pub mod pfm;

pub mod picture;

pub mod png_text;

pub mod sequence;

/// Four 8-bit channels: red, green, blue (sRGB codes) and alpha (straight, not premultiplied).
pub type Rgba8 = [u8; 4];

/// Two-dimensional array of values of type `T`, stored row by row from the top, and from left to right in each row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image<T> {
    width: u32,
    height: u32,
    pixels: Vec<T>,
}

impl<T: Copy> Image<T> {
    /// Creates an image of `width` × `height` px filled with `value`.
    pub fn filled(width: u32, height: u32, value: T) -> Self {
        Self { width, height, pixels: vec![value; width as usize * height as usize] }
    }

    /// Creates an image in the buffer of `memory`, if there is one. Reused pixels keep arbitrary old values; newly
    /// allocated pixels have `value`.
    pub(crate) fn reusing(memory: Option<Self>, width: u32, height: u32, value: T) -> Self {
        let mut pixels = memory.map_or_else(Vec::new, |image| image.pixels);
        pixels.resize(width as usize * height as usize, value);
        Self { width, height, pixels }
    }

    /// Creates an image from its pixels, row by row from the top. Panics if their number is not `width` × `height`.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<T>) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize, "pixel count does not match {width}×{height}");
        Self { width, height, pixels }
    }

    /// Creates an image by calling `value` with the coordinates (x, y) of every pixel, row by row from the top.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::image::Image;
    ///
    /// let image = Image::from_fn(64, 36, |x, y| x + 100 * y);
    /// assert_eq!(image.size(), (64, 36));
    /// assert_eq!(image.at(5, 2), 205);
    /// assert_eq!(image.get(64, 2), None);
    /// assert_eq!(image.at_clamped(-3, 99), 3500, "the value at (0, 35)");
    /// ```
    pub fn from_fn(width: u32, height: u32, mut value: impl FnMut(u32, u32) -> T) -> Self {
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            pixels.extend((0..width).map(|x| value(x, y)));
        }
        Self { width, height, pixels }
    }

    /// Returns the width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Returns the value at (`x`, `y`), which must lie inside the picture.
    #[inline]
    pub fn at(&self, x: u32, y: u32) -> T {
        self.pixels[self.index(x, y)]
    }

    /// Returns the value at (`x`, `y`), or `None` if it lies outside the picture.
    pub fn get(&self, x: u32, y: u32) -> Option<T> {
        (x < self.width && y < self.height).then(|| self.at(x, y))
    }

    /// Returns the value nearest to (`x`, `y`): coordinates are clamped to the border. Panics on an empty picture.
    #[inline]
    pub fn at_clamped(&self, x: i64, y: i64) -> T {
        let x = x.clamp(0, i64::from(self.width) - 1) as u32;
        let y = y.clamp(0, i64::from(self.height) - 1) as u32;
        self.at(x, y)
    }

    /// Sets the value at (`x`, `y`), which must lie inside the picture.
    #[inline]
    pub fn set(&mut self, x: u32, y: u32, value: T) {
        let index = self.index(x, y);
        self.pixels[index] = value;
    }

    /// Returns row `y`, from left to right. Panics if it lies outside the picture.
    pub fn row(&self, y: u32) -> &[T] {
        let start = y as usize * self.width as usize;
        &self.pixels[start..start + self.width as usize]
    }

    /// Returns all values, row by row.
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// Returns the pixels, row by row from the top.
    pub(crate) fn into_pixels(self) -> Vec<T> {
        self.pixels
    }

    /// Returns all values as a mutable slice, row by row.
    pub fn pixels_mut(&mut self) -> &mut [T] {
        &mut self.pixels
    }

    /// Returns a picture of the same size with `f` applied to every value.
    pub fn map<U>(&self, f: impl FnMut(T) -> U) -> Image<U> {
        Image { width: self.width, height: self.height, pixels: self.pixels.iter().copied().map(f).collect() }
    }

    /// Returns the number of bytes allocated for the pixels.
    pub(crate) fn bytes(&self) -> usize {
        self.pixels.capacity() * size_of::<T>()
    }

    #[inline]
    fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width && y < self.height, "({x}, {y}) outside {}×{}", self.width, self.height);
        y as usize * self.width as usize + x as usize
    }
}

impl Image<Rgba8> {
    /// Returns the pixels as bytes, four per pixel.
    pub fn as_bytes(&self) -> &[u8] {
        self.pixels.as_flattened()
    }
}
