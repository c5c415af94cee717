use std::io::Cursor;
use std::path::PathBuf;

use ::exr::image::write::WritableImage as _;
use ::exr::prelude::Encoding;
use ::exr::prelude::{
    AnyChannel, AnyChannels, Compression, FlatSamples, Image as ExrImage, ImageAttributes, IntegerBounds,
    Layer as ExrLayer, LayerAttributes, SmallVec, Text, Vec2,
};
use image::{DynamicImage, ImageBuffer, ImageFormat, Rgb};

use super::*;

fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn read_bytes(name: &str, bytes: &[u8]) -> Picture {
    let (_folder, path) = written(name, bytes);
    Picture::read(&path).unwrap()
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Returns all samples of a picture, channel by channel.
fn samples(picture: &Picture) -> Vec<Vec<Sample>> {
    let of = |channel: &Channel| (0..channel.samples.len()).map(|index| channel.samples.at(index)).collect();
    picture.channels().iter().map(of).collect()
}

#[test]
fn sixteen_bits_and_floats_are_read_exactly_from_every_format_that_has_them() {
    let codes: Vec<u16> = (0..2 * 3 * 3).map(|index| index * 3641 + 1).collect();
    let deep: DynamicImage = ImageBuffer::<Rgb<u16>, _>::from_raw(2, 3, codes.clone()).unwrap().into();
    let red: Vec<Sample> = codes.iter().step_by(3).map(|code| Sample::U16(*code)).collect();
    for (name, format) in [("a.png", ImageFormat::Png), ("a.tiff", ImageFormat::Tiff)] {
        let picture = read_bytes(name, &encoded(&deep, format));
        assert_eq!(samples(&picture)[0], red, "{name}");
        assert_eq!(picture.channels()[0].kind(), "16-bit integer");
    }
    let floats: Vec<f32> = codes.iter().map(|code| f32::from(*code).exp2().min(1e30) + 0.1).collect();
    let image: DynamicImage = ImageBuffer::<Rgb<f32>, _>::from_raw(2, 3, floats.clone()).unwrap().into();
    let picture = read_bytes("a.tif", &encoded(&image, ImageFormat::Tiff));
    let blue: Vec<Sample> = floats.iter().skip(2).step_by(3).map(|value| Sample::F32(*value)).collect();
    assert_eq!((&samples(&picture)[2], picture.channels()[2].kind()), (&blue, "32-bit float"));
    // 4-byte pixels: the mantissas of red, green and blue and their common exponent.
    let radiance = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x40\x20\x84";
    assert_eq!(samples(&read_bytes("a.hdr", radiance)), [[8.0], [4.0], [2.0]].map(|one| one.map(Sample::F32)));
}

#[test]
fn tiff_files_of_one_float_per_pixel_are_read() {
    let mut bytes = Cursor::new(Vec::new());
    let values = [0.1_f32, -3.0, f32::INFINITY, 1e-40];
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut bytes).unwrap();
    encoder.write_image::<tiff::encoder::colortype::Gray32Float>(2, 2, &values).unwrap();
    let picture = read_bytes("depth.tiff", bytes.get_ref());
    assert_eq!(samples(&picture), [values.map(Sample::F32)]);
    assert_eq!(picture.description(), "TIFF, 2 × 2 px, Y (32-bit float)");
}

/// Returns an OpenEXR file with the layers `beauty` (half and float) and `id` (integers). The data window lies a pixel
/// to the left of the display window of 4 × 2 px.
fn layered_exr(encoding: Encoding) -> Vec<u8> {
    let channel = |name: &str, sample_data| AnyChannel {
        name: Text::from(name),
        sample_data,
        quantize_linearly: false,
        sampling: Vec2(1, 1),
    };
    let layer = |name: &str, channels: Vec<AnyChannel<FlatSamples>>| {
        let attributes = LayerAttributes { layer_position: Vec2(9, 20), ..LayerAttributes::named(name) };
        let channels = AnyChannels::sort(SmallVec::from_vec(channels));
        ExrLayer::new((3, 2), attributes, encoding, channels)
    };
    let half = |start: f32| FlatSamples::F16((0..6_u8).map(|index| f16::from_f32(start + f32::from(index))).collect());
    let layers = vec![
        layer(
            "beauty",
            vec![
                channel("R", half(0.5)),
                channel("G", half(10.5)),
                channel("B", half(20.5)),
                channel("Z", FlatSamples::F32(vec![0.1, 0.2, 0.3, f32::INFINITY, f32::MIN_POSITIVE, 1e-45])),
            ],
        ),
        layer("id", vec![channel("object", FlatSamples::U32(vec![0, 1, 2, u32::MAX, 16_777_217, 5]))]),
    ];
    let window = IntegerBounds { position: Vec2(10, 20), size: Vec2(4, 2) };
    let mut bytes = Cursor::new(Vec::new());
    let image = ExrImage::from_layers(ImageAttributes::new(window), SmallVec::<[_; 2]>::from_vec(layers));
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn layers_and_windows_of_exr_files_are_kept() {
    let picture = read_bytes("a.exr", &layered_exr(Encoding::SMALL_LOSSLESS));
    assert_eq!(picture.size(), (4, 2));
    let layers: Vec<_> = picture.layers().iter().map(|layer| (layer.name.as_str(), layer.is_color)).collect();
    assert_eq!(layers, [("beauty", true), ("beauty.Z", false), ("id.object", false)]);
    let at = |name: &str, x, y| {
        let channel = picture.channels().iter().find(|channel| channel.name == name).unwrap();
        channel.sample(x, y)
    };
    // The first column of the data lies outside the picture, and the last two columns of the picture have no data.
    assert_eq!(at("beauty.R", 0, 0), Some(Sample::F16(f16::from_f32(1.5))));
    assert_eq!(at("beauty.Z", 0, 0), Some(Sample::F32(0.2)));
    assert_eq!(at("id.object", 0, 1), Some(Sample::U32(16_777_217)));
    assert_eq!(at("id.object", 2, 0), None);
    let value = |x, y| picture.value(&picture.layers()[0], x, y);
    assert_eq!([value(1, 1), value(3, 1)], [[5.5, 15.5, 25.5], [0.0; 3]]);
    assert_eq!(
        picture.description(),
        "OpenEXR, 4 × 2 px, beauty.B beauty.G beauty.R (16-bit float), beauty.Z (32-bit float), id.object (32-bit \
         integer), data window 3 × 2 px at -1, 0"
    );
}

#[test]
fn a_cut_exr_file_is_an_error_that_names_it() {
    let bytes = layered_exr(Encoding::SMALL_LOSSLESS);
    for end in 4..bytes.len() {
        let (_folder, path) = written("cut.exr", &bytes[..end]);
        let message = Picture::read(&path).map(|_| end).unwrap_err().to_string();
        assert!(message.contains("cut.exr: cannot decode this OpenEXR file: "), "{message}");
    }
}

#[test]
fn huge_sizes_anywhere_in_a_dwa_file_allocate_nothing() {
    let encoding = Encoding { compression: Compression::DWAA(None), ..Encoding::SMALL_LOSSLESS };
    let bytes = layered_exr(encoding);
    let whole = super::exr::decode(&bytes).unwrap();
    assert_eq!(whole.size(), (4, 2));
    let refused = (0..bytes.len() - 8).filter(|at| {
        let mut damaged = bytes.clone();
        damaged[*at..*at + 8].copy_from_slice(&(1_u64 << 42).to_le_bytes());
        // Without a check, the process would abort.
        super::exr::decode(&damaged).is_err_and(|error| error == "invalid: size of DWA data")
    });
    assert!(refused.count() >= 5);
}

#[test]
fn every_format_is_recognised_by_its_own_suffix_or_content() {
    for format in &formats::ALL {
        for suffix in suffixes().filter(|suffix| format.has_suffix_of(&PathBuf::from(format!("a.{suffix}")))) {
            assert!(crate::image::file::is_named_picture(&PathBuf::from(format!("a.{}", suffix.to_uppercase()))));
        }
    }
    assert_eq!(formats::names(), "PNG, JPEG, BMP, TGA, GIF, TIFF, Radiance HDR, OpenEXR or PFM");
}
