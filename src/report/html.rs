//! HTML report pages: self-contained, without scripts, in the light or dark theme of the reader's system.

use std::io;

use crate::image::file::encode_png;
use crate::image::{Image, Rgba8};

/// Colours and layout shared by all pages.
const STYLE: &str = include_str!("page.css");

/// Escapes text for use in HTML content and quoted attributes.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns a complete HTML page. `style` is appended to the shared style sheet; `body` is HTML.
pub(crate) fn document(title: &str, style: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{} · Rasterscope</title>\n<style>\n{STYLE}{style}</style>\n\
         </head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        escaped(title)
    )
}

/// Returns an HTML paragraph that says that the measurement was interrupted; empty if it was completed.
pub(super) fn partial(is_partial: bool) -> &'static str {
    if is_partial { "<p><b>Partial: interrupted before everything was measured.</b></p>\n" } else { "" }
}

/// Returns the HTML for a row of tiles, each with a value and its name.
pub(super) fn tiles<const N: usize>(tiles: [(String, &str); N]) -> String {
    let tile = |(value, name): (String, &str)| {
        format!("<div class=\"tile\"><b>{}</b><span>{name}</span></div>", escaped(&value))
    };
    format!("<div class=\"tiles\">{}</div>\n", tiles.map(tile).concat())
}

/// Returns an image as a data URL of a PNG file, the value of an `src` attribute.
///
/// # Errors
/// Returns an error if the image cannot be encoded.
pub(crate) fn image_source(picture: &Image<Rgba8>) -> io::Result<String> {
    Ok(format!("data:image/png;base64,{}", base64(&encode_png(picture)?)))
}

/// Encodes bytes in padded base64 (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let number = group.iter().fold(0_u32, |n, byte| n << 8 | u32::from(*byte)) << (8 * (3 - group.len()));
        for place in 0..4 {
            let letter = LETTERS[(number >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= group.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("<a \"b\" & c>"), "&lt;a &quot;b&quot; &amp; c&gt;");
    }

    #[test]
    fn base64_matches_the_standard() {
        let cases = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in cases {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
        assert_eq!(base64(&[0xFB, 0xFF, 0xBF]), "+/+/");
    }
}
