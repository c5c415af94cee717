//! Contact sheets: pictures and error maps of all methods in one frame of a clip, as one small JPEG file.
//!
//! The first row has the reference and its disoccluded pixels in white, each further row the picture of a method and its
//! FLIP error. Lossy compression is sufficient to look at them; the errors are measured before.

use std::io;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

use crate::image::{Image, Rgba8};
use crate::measure::difference::{self, Difference};
use crate::report::html::reduced;

/// Largest number of sheets of a clip. Longer clips have one for every second frame, every third one, and so on.
const MAX_SHEETS: u32 = 48;

/// Largest number of bytes of all sheets of a clip, before they are encoded as Base64 (a third larger).
const MAX_BYTES: usize = 1_050_000;

/// Largest width of a picture in a sheet, in pixels.
const MAX_WIDTH: u32 = 320;

/// JPEG quality from 1 to 100.
const QUALITY: u8 = 75;

/// Side of a JPEG block, in pixels. Pictures begin at blocks, so that they do not bleed into each other.
const BLOCK: u32 = 8;

/// Colour between the pictures.
const GAP: Rgba8 = [24, 24, 24, 255];

/// Distance in frames between the frames of a clip that have a sheet.
pub(super) fn step(frames: u32) -> u32 {
    frames.div_ceil(MAX_SHEETS).max(1)
}

/// Returns the largest number of bytes for each sheet of a clip.
pub(super) fn bytes_per_sheet(frames: u32) -> usize {
    MAX_BYTES / frames.div_ceil(step(frames)).max(1) as usize
}

/// Row of a sheet: a picture, and a picture computed from it.
#[derive(Debug)]
pub(super) struct SheetRow {
    pub(super) picture: Image<Rgba8>,
    pub(super) map: Image<Rgba8>,
}

impl SheetRow {
    /// Returns the row of a method. `flip` has the FLIP error of every pixel.
    pub(super) fn of_method(picture: &Image<Rgba8>, flip: &Image<f32>) -> Self {
        Self { picture: picture.clone(), map: difference::picture(Difference::Flip, 1, flip) }
    }

    /// Returns the row of a reference, with its disoccluded pixels in white.
    pub(super) fn of_reference(picture: &Image<Rgba8>, is_disoccluded: impl Fn(u32, u32) -> bool) -> Self {
        let (width, height) = picture.size();
        let map = Image::from_fn(width, height, |x, y| if is_disoccluded(x, y) { [255; 4] } else { [0, 0, 0, 255] });
        Self { picture: picture.clone(), map }
    }
}

/// Contact sheet of one frame.
#[derive(Debug)]
pub(super) struct FrameSheet {
    /// Number of the frame in the clip.
    pub(super) frame: u32,
    jpeg: Vec<u8>,
    layout: Layout,
}

/// Sizes in a sheet, in pixels.
#[derive(Clone, Copy, Debug)]
struct Layout {
    picture: [u32; 2],
    rows: u32,
}

impl Layout {
    /// Returns the distance between the corners of neighbouring pictures, horizontally and vertically.
    fn pitch(self) -> [u32; 2] {
        self.picture.map(|side| side.next_multiple_of(BLOCK))
    }
}

impl FrameSheet {
    /// Encodes the rows of a frame, at least one. Divides the sides of all pictures by the smallest number that gives at
    /// most `max_bytes`; pictures of one pixel are not reduced further.
    ///
    /// # Errors
    /// Returns an error if the sheet is too large for a JPEG file.
    pub(super) fn new(frame: u32, rows: &[SheetRow], max_bytes: usize) -> io::Result<Self> {
        let (width, height) = rows.first().map_or((1, 1), |row| row.picture.size());
        let mut factor = width.div_ceil(MAX_WIDTH).max(1);
        loop {
            let picture = [width, height].map(|side| side.div_ceil(factor));
            let layout = Layout { picture, rows: rows.len() as u32 };
            let jpeg = encoded(&drawn(rows, factor, layout))?;
            if jpeg.len() <= max_bytes || factor >= width.max(height) {
                return Ok(Self { frame, jpeg, layout });
            }
            factor += 1;
        }
    }

    /// Returns the sheet as a data URL.
    pub(super) fn source(&self) -> String {
        format!("data:image/jpeg;base64,{}", BASE64_STANDARD.encode(&self.jpeg))
    }

    /// Returns the width of a row divided by its height.
    pub(super) fn aspect(&self) -> f64 {
        f64::from(2 * self.layout.pitch()[0]) / f64::from(self.layout.picture[1])
    }

    /// Returns the vertical position of a row in CSS: the percentage for `background-position` of an element that is as
    /// large as a row.
    pub(super) fn position_percent(&self, row: u32) -> f64 {
        let [_, pitch] = self.layout.pitch();
        let hidden = self.layout.rows * pitch - self.layout.picture[1];
        if hidden == 0 { 0.0 } else { f64::from(row * pitch) / f64::from(hidden) * 100.0 }
    }
}

/// Draws a sheet whose pictures have their sides divided by `factor`.
fn drawn(rows: &[SheetRow], factor: u32, layout: Layout) -> Image<Rgba8> {
    let [across, down] = layout.pitch();
    let mut sheet = Image::filled(2 * across, layout.rows * down, GAP);
    for (row, top) in rows.iter().zip((0..).step_by(down as usize)) {
        for (picture, left) in [(&row.picture, 0), (&row.map, across)] {
            let small = reduced(picture, factor);
            let places = (0..small.height()).flat_map(|y| (0..small.width()).map(move |x| (x, y)));
            places.for_each(|(x, y)| sheet.set(left + x, top + y, small.at(x, y)));
        }
    }
    sheet
}

fn encoded(sheet: &Image<Rgba8>) -> io::Result<Vec<u8>> {
    let rgb: Vec<u8> = sheet.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let mut jpeg = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut jpeg, QUALITY);
    encoder.encode(&rgb, sheet.width(), sheet.height(), ExtendedColorType::Rgb8).map_err(io::Error::other)?;
    Ok(jpeg)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(seed: u64) -> SheetRow {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut noise = || Image::from_fn(100, 60, |_, _| [random.u8(..), random.u8(..), random.u8(..), 255]);
        SheetRow { picture: noise(), map: noise() }
    }

    #[test]
    fn sheets_fit_into_their_bytes_and_rows_lie_at_their_positions() {
        let rows = [row(1), row(2), row(3)];
        let large = FrameSheet::new(0, &rows, usize::MAX).unwrap();
        let small = FrameSheet::new(0, &rows, 5_000).unwrap();
        assert!(small.jpeg.len() <= 5_000 && small.jpeg.len() < large.jpeg.len());
        assert_eq!(large.layout.picture, [100, 60]);
        let decoded = image::load_from_memory(&large.jpeg).unwrap();
        assert_eq!((decoded.width(), decoded.height()), (208, 192), "pictures begin at multiples of 8 px");
        // A background is moved by the percentage of the sheet that its element does not show: 192 − 60 px.
        let tops = [0, 1, 2].map(|row| large.position_percent(row) / 100.0 * (192.0 - 60.0));
        assert!(tops.iter().zip([0.0, 64.0, 128.0]).all(|(top, wanted)| (top - wanted).abs() < 1e-9), "{tops:?}");
    }

    #[test]
    fn long_clips_have_no_more_sheets_than_short_ones() {
        assert_eq!([1, 24, 48, 49, 10_000].map(step), [1, 1, 1, 2, 209]);
        for frames in [2, 48, 49, 10_000] {
            assert!(bytes_per_sheet(frames) * frames.div_ceil(step(frames)) as usize <= MAX_BYTES);
        }
    }
}
