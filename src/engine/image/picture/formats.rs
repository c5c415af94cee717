//! Registry of picture formats.

use std::path::Path;

use image::ImageFormat;

use super::{Picture, exr, pfm, standard};

/// Function that returns the width and height in pixels from the header of a file.
type SizeReader = fn(&[u8]) -> Result<(u32, u32), String>;

/// Function that decodes a whole file.
type Decoder = fn(&[u8]) -> Result<Picture, String>;

/// Decoder of a format.
#[derive(Debug)]
pub(in crate::image) enum Codec {
    /// Decoder of the crate `image`.
    Image(ImageFormat),
    /// Decoder of this project.
    Own(SizeReader, Decoder),
}

/// Picture format.
#[derive(Debug)]
pub(in crate::image) struct Format {
    /// Name in messages, such as `PNG`.
    pub(in crate::image) name: &'static str,
    /// File name suffixes in lower case.
    suffixes: &'static [&'static str],
    /// First bytes of a file, one of which identifies the format. Empty if the format has no signature and is
    /// recognised by its suffix.
    signatures: &'static [&'static [u8]],
    pub(in crate::image) codec: Codec,
}

/// All picture formats that can be read.
pub(in crate::image) static ALL: [Format; 9] = [
    Format::new("PNG", &["png"], &[b"\x89PNG\r\n\x1A\n"], Codec::Image(ImageFormat::Png)),
    Format::new("JPEG", &["jpg", "jpeg"], &[b"\xFF\xD8\xFF"], Codec::Image(ImageFormat::Jpeg)),
    Format::new("BMP", &["bmp"], &[b"BM"], Codec::Image(ImageFormat::Bmp)),
    Format::new("TGA", &["tga"], &[], Codec::Image(ImageFormat::Tga)),
    Format::new("GIF", &["gif"], &[b"GIF87a", b"GIF89a"], Codec::Image(ImageFormat::Gif)),
    Format::new(
        "TIFF",
        &["tiff", "tif"],
        &[b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"],
        Codec::Own(standard::tiff_size, standard::decode_tiff),
    ),
    Format::new("Radiance HDR", &["hdr"], &[b"#?RADIANCE", b"#?RGBE"], Codec::Image(ImageFormat::Hdr)),
    Format::new("OpenEXR", &["exr"], &[b"\x76\x2F\x31\x01"], Codec::Own(exr::size, exr::decode)),
    Format::new(
        "PFM",
        &["pfm"],
        &[b"PF\n", b"Pf\n", b"PF\r", b"Pf\r", b"PF ", b"Pf "],
        Codec::Own(pfm::size, pfm::decode),
    ),
];

impl Format {
    const fn new(
        name: &'static str,
        suffixes: &'static [&'static str],
        signatures: &'static [&'static [u8]],
        codec: Codec,
    ) -> Self {
        Self { name, suffixes, signatures, codec }
    }

    /// Returns the format of a file with this path and content, or `None` if it is in none of the formats.
    pub(in crate::image) fn of(path: &Path, bytes: &[u8]) -> Option<&'static Self> {
        let signed = ALL.iter().find(|format| format.signatures.iter().any(|start| bytes.starts_with(start)));
        // Another program's format, such as WebP, is not read as TGA even if it is named so.
        let is_unknown = !bytes.is_empty() && image::guess_format(bytes).is_err();
        signed.or_else(|| {
            ALL.iter().find(|format| is_unknown && format.signatures.is_empty() && format.has_suffix_of(path))
        })
    }

    /// Returns whether the suffix of a path is one of the format's suffixes.
    pub(in crate::image) fn has_suffix_of(&self, path: &Path) -> bool {
        let suffix = path.extension().and_then(|suffix| suffix.to_str()).unwrap_or_default();
        self.suffixes.iter().any(|own| suffix.eq_ignore_ascii_case(own))
    }
}

/// Returns the file name suffixes of all formats, in lower case without a dot.
pub fn suffixes() -> impl Iterator<Item = &'static str> {
    ALL.iter().flat_map(|format| format.suffixes).copied()
}

/// Returns the names of all formats as a list in words.
pub fn names() -> String {
    let names: Vec<_> = ALL.iter().map(|format| format.name).collect();
    let (last, others) = names.split_last().unwrap_or((&"", &[]));
    format!("{} or {last}", others.join(", "))
}
