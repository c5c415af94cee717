//! Serialisation of images as Base64 text of PNG files, for `#[serde(with = "crate::image::png_text")]`.

use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize as _, Deserializer, Serialize as _, Serializer};

use super::file::{PictureFile, encode_png};
use super::{Image, Rgba8};

/// Serialises an image as the text of a PNG file in Base64.
pub fn serialize<S: Serializer>(image: &Image<Rgba8>, to: S) -> Result<S::Ok, S::Error> {
    BASE64_STANDARD.encode(encode_png(image).map_err(S::Error::custom)?).serialize(to)
}

/// Deserialises an image that [`serialize`] has written, within the limits of picture files.
pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Image<Rgba8>, D::Error> {
    let file = BASE64_STANDARD.decode(String::deserialize(from)?).map_err(D::Error::custom)?;
    PictureFile::of_bytes(Path::new("picture"), file).and_then(PictureFile::decode).map_err(D::Error::custom)
}

#[cfg(test)]
mod tests {
    use serde::{Deserialize, Serialize};

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Holder(#[serde(with = "super")] Image<Rgba8>);

    #[test]
    fn images_keep_every_code_and_others_are_refused() {
        for alpha in [255, 7] {
            let held = Holder(Image::from_fn(33, 9, |x, y| [(x * 7) as u8, (y * 28) as u8, (x ^ y) as u8, alpha]));
            let json = serde_json::to_string(&held).unwrap();
            assert_eq!(serde_json::from_str::<Holder>(&json).unwrap(), held);
        }
        for bad in ["\"%%\"", "\"AAAA\"", "7"] {
            assert!(serde_json::from_str::<Holder>(bad).is_err(), "{bad}");
        }
    }
}
