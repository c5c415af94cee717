//! PFM files: lossless images of 32-bit floats, including NaN and infinity.
//!
//! Format: a line `Pf` (one number per pixel) or `PF` (three), a line with width and height, and a line `-1.0` for
//! little-endian or `1.0` for big-endian byte order. Then follow the rows from bottom to top, each from left to right.
//! Files are written in little-endian order and read in both, by [`super::picture`].

use std::path::Path;

use super::Image;
use super::file::ImageFileError;
use crate::disk;

/// Picture with one or three 32-bit floats per pixel, to be written as PFM.
#[derive(Clone, Debug, PartialEq)]
pub enum Floats {
    /// Image with one float per pixel.
    One(Image<f32>),
    /// Image with three floats per pixel.
    Three(Image<[f32; 3]>),
}

impl Floats {
    /// Encodes the picture as the bytes of a PFM file.
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::One(image) => encode("Pf", image, |value| [value].to_vec()),
            Self::Three(image) => encode("PF", image, |values| values.to_vec()),
        }
    }
}

fn encode<T: Copy>(magic: &str, image: &Image<T>, numbers: impl Fn(T) -> Vec<f32>) -> Vec<u8> {
    let (width, height) = image.size();
    let mut bytes = format!("{magic}\n{width} {height}\n-1.0\n").into_bytes();
    for y in (0..height).rev() {
        let row = image.row(y).iter().flat_map(|value| numbers(*value));
        bytes.extend(row.flat_map(f32::to_le_bytes));
    }
    bytes
}

/// Writes a picture as a PFM file. Replaces an existing file; creates no folders.
pub fn write_pfm(path: &Path, floats: &Floats) -> Result<(), ImageFileError> {
    disk::write(path, &floats.encode()).map_err(|source| ImageFileError::Unwritable { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::picture::pfm::decode;

    #[test]
    fn written_files_read_back_bit_by_bit_in_both_byte_orders() {
        let values = vec![1.5, f32::NAN, -0.0, 1e-42, f32::INFINITY, 3.0];
        let image = Image::from_pixels(2, 3, values);
        let mut bytes = Floats::One(image.clone()).encode();
        let expected: Vec<u64> = image.pixels().iter().map(|value| f64::from(*value).to_bits()).collect();
        let read = |bytes: &[u8]| {
            let picture = decode(bytes).unwrap();
            let bits = |x, y| picture.value(&picture.layers()[0], x, y)[0].to_bits();
            (0..3).flat_map(|y| [bits(0, y), bits(1, y)]).collect::<Vec<_>>()
        };
        assert_eq!(read(&bytes), expected);
        let start = bytes.len() - 4 * expected.len();
        bytes[start..].chunks_exact_mut(4).for_each(<[u8]>::reverse);
        bytes[start - 5] = b' ';
        assert_eq!(read(&bytes), expected);
        assert_eq!(decode(&bytes[..bytes.len() - 1]).unwrap_err(), "it ends before its last sample");
        for broken in ["PF\n", "PF\n3\n", "PF 1 1 zero\n", "PF 1 1 0\n", "PF -1 1 -1\n"] {
            assert!(decode(broken.as_bytes()).is_err(), "{broken}");
        }
    }

    #[test]
    fn bits_are_kept_and_rows_run_upwards() {
        let image = Image::from_pixels(2, 2, vec![1.5, f32::NAN, -0.0, 1e-42]);
        let bytes = Floats::One(image.clone()).encode();
        let header = b"Pf\n2 2\n-1.0\n";
        assert_eq!(&bytes[..header.len()], header);
        let words: Vec<u32> =
            bytes[header.len()..].as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
        let expected: Vec<u32> = [2, 3, 0, 1].map(|place: usize| image.pixels()[place].to_bits()).to_vec();
        assert_eq!(words, expected);
        let three = Floats::Three(Image::filled(1, 1, [1.0, 2.0, 3.0])).encode();
        assert!(three.starts_with(b"PF\n1 1\n-1.0\n") && three.ends_with(&3.0_f32.to_le_bytes()));
    }
}
