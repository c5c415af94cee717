//! URIs of buffers and images: embedded data, and paths of files beside the model.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use crate::scene::file_names;
use crate::text;

/// Base64 of data URIs. Some exporters omit the padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Content or location that a URI describes.
pub(super) enum Target<'a> {
    /// Data in the URI itself, encoded as base64 or with percent signs.
    Embedded(Embedded<'a>),
    /// Path of a file.
    File(PathBuf),
}

/// Data in a URI.
pub(super) struct Embedded<'a> {
    payload: &'a str,
    is_base64: bool,
}

impl Embedded<'_> {
    /// Returns the maximum length of the data, in bytes.
    pub(super) fn max_length(&self) -> u64 {
        self.payload.len() as u64
    }

    /// Decodes the data.
    pub(super) fn decode(&self) -> Result<Vec<u8>, String> {
        if self.is_base64 {
            return BASE64.decode(self.payload).map_err(|error| format!("its data URI is not base64: {error}"));
        }
        Ok(percent_decoded(self.payload).into_owned())
    }
}

/// Returns the content or location that `uri` describes. A path is relative to the folder of `model`; names that differ
/// in Unicode form or in case are found, too.
///
/// # Errors
/// Returns an error for an absolute path or another scheme than `data`. Nothing is fetched from a network.
pub(super) fn target<'a>(uri: &'a str, model: &Path) -> Result<Target<'a>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (kind, payload) = data.split_once(',').ok_or("its data URI has no comma")?;
        return Ok(Target::Embedded(Embedded { payload, is_base64: kind.ends_with(";base64") }));
    }
    let shown = || text::message(&uri.chars().take(80).collect::<String>());
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme).filter(|scheme| !scheme.contains(['/', '%']));
    if let Some(scheme) = scheme {
        return Err(format!("{:?} is not read: {}: is not a file beside the model", shown(), text::message(scheme)));
    }
    let decoded = percent_decoded(uri);
    let relative = std::str::from_utf8(&decoded).map_err(|_| format!("{:?} is not a file name", shown()))?;
    if relative.is_empty() || relative.contains('\0') || Path::new(relative).is_absolute() {
        return Err(format!("{:?} is not a path relative to the model", shown()));
    }
    let written = model.parent().unwrap_or(Path::new("")).join(relative);
    Ok(Target::File(file_names::existing(&written).map_or(written, |(path, _)| path)))
}

/// Replaces each `%` with two hexadecimal digits by the byte that they denote.
fn percent_decoded(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let mut rest = text.as_bytes();
    let mut bytes = Vec::with_capacity(rest.len());
    while let [first, tail @ ..] = rest {
        let digit = |at: usize| tail.get(at).and_then(|digit| char::from(*digit).to_digit(16));
        match (*first, digit(0), digit(1)) {
            (b'%', Some(high), Some(low)) => {
                bytes.push((high * 16 + low) as u8);
                rest = &tail[2..];
            }
            (byte, ..) => {
                bytes.push(byte);
                rest = tail;
            }
        }
    }
    Cow::Owned(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn embedded(uri: &str) -> Result<Vec<u8>, String> {
        match target(uri, Path::new("a.gltf"))? {
            Target::Embedded(data) => data.decode(),
            Target::File(path) => panic!("{}", path.display()),
        }
    }

    #[test]
    fn embedded_data_is_decoded_with_and_without_padding() {
        assert_eq!(embedded("data:application/octet-stream;base64,AAEC/w==").unwrap(), [0, 1, 2, 255]);
        assert_eq!(embedded("data:;base64,AAEC/w").unwrap(), [0, 1, 2, 255]);
        assert_eq!(embedded("data:,a%20b%").unwrap(), b"a b%");
        assert!(embedded("data:;base64,&").unwrap_err().contains("base64"));
        assert!(embedded("data:nothing").unwrap_err().contains("comma"));
    }

    #[test]
    fn paths_are_relative_to_the_model_and_decoded() {
        let path = |uri| match target(uri, Path::new("models/a.gltf")) {
            Ok(Target::File(path)) => Ok(path),
            Ok(Target::Embedded(_)) => panic!("{uri}"),
            Err(error) => Err(error),
        };
        assert_eq!(path("b%20c.bin"), Ok("models/b c.bin".into()));
        assert_eq!(path("../x/%C3%A4.png"), Ok("models/../x/ä.png".into()));
        for refused in ["http://example.org/a.bin", "file:///etc/passwd", "/etc/passwd", "", "a%00b", "%FF"] {
            assert!(path(refused).is_err(), "{refused}");
        }
    }
}
