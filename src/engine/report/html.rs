//! HTML report pages: self-contained, without scripts, in the light or dark theme of the reader's system.

use std::io;

use base64::prelude::{BASE64_STANDARD, Engine as _};

use crate::image::file::encode_png;
use crate::image::{Image, Rgba8};

/// Colours and layout shared by all pages.
const STYLE: &str = include_str!("page.css");

/// Escapes text for use in HTML content and quoted attributes.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns a complete HTML page. `style` is appended to the shared style sheet; `body` is HTML.
pub fn document(title: &str, style: &str, body: &str) -> String {
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
pub fn image_source(picture: &Image<Rgba8>) -> io::Result<String> {
    Ok(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(encode_png(picture)?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("<a \"b\" & c>"), "&lt;a &quot;b&quot; &amp; c&gt;");
    }
}
