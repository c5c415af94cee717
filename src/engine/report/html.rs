//! HTML pages: self-contained, in the light or dark theme of the reader's system, and complete without their scripts.

use std::borrow::Cow;
use std::io;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use image::RgbaImage;

use crate::image::file::encode_png;
use crate::image::{Image, Rgba8};

/// Colours and layout shared by all pages.
const STYLE: &str = include_str!("page.css");

/// Largest size of a page about a pixel, a comparison or a lab run, in bytes.
pub const MAX_PAGE_BYTES: usize = 2_000_000;

/// Rule that keeps the browser from loading anything, whatever a name in the page contains.
const NO_REQUESTS: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

/// Escapes text for use in HTML content and quoted attributes.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns a complete HTML page. `style` is appended to the shared style sheet; `body` is HTML.
pub fn document(title: &str, style: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta \
         http-equiv=\"Content-Security-Policy\" content=\"{NO_REQUESTS}\">\n<meta name=\"viewport\" \
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

/// Pictures as data URLs, reduced so that they fit into a page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FittedPictures {
    /// Data URL of each picture.
    pub(crate) sources: Vec<String>,
    /// Factor by which the sides of all pictures are divided; 1 if they are shown unchanged.
    factor: u32,
}

impl FittedPictures {
    /// Encodes pictures so that their URLs have at most `max_bytes` in total. Divides their sides by the smallest
    /// sufficient number; pictures of one pixel are not reduced further.
    ///
    /// # Errors
    /// Returns an error if a picture cannot be encoded.
    pub(crate) fn new(pictures: &[&Image<Rgba8>], max_bytes: usize) -> io::Result<Self> {
        let largest = pictures.iter().map(|picture| picture.width().max(picture.height())).max().unwrap_or(1);
        let mut factor = 1;
        loop {
            let sources: io::Result<Vec<_>> =
                pictures.iter().map(|picture| image_source(&reduced(picture, factor))).collect();
            let sources = sources?;
            if factor >= largest || sources.iter().map(String::len).sum::<usize>() <= max_bytes {
                return Ok(Self { sources, factor });
            }
            factor += 1;
        }
    }

    /// Returns a sentence that says by how much the pictures are reduced; empty if they are not.
    pub(crate) fn note(&self) -> String {
        match self.factor {
            1 => String::new(),
            factor => format!(
                "Pictures are reduced to 1/{factor} of their width and height, so that the page has at most {} MB.",
                MAX_PAGE_BYTES / 1_000_000
            ),
        }
    }
}

/// Returns a picture with its sides divided by `factor` and rounded up; each pixel is a mean of the covered pixels.
pub(super) fn reduced(picture: &Image<Rgba8>, factor: u32) -> Cow<'_, Image<Rgba8>> {
    let (width, height) = picture.size();
    let source = RgbaImage::from_raw(width, height, picture.as_bytes().to_vec());
    match source.filter(|_| factor > 1) {
        Some(source) => {
            let (width, height) = (width.div_ceil(factor), height.div_ceil(factor));
            let small = image::imageops::thumbnail(&source, width, height);
            Cow::Owned(Image::from_fn(width, height, |x, y| small.get_pixel(x, y).0))
        }
        None => Cow::Borrowed(picture),
    }
}

/// Returns a table as HTML. Its cells are text; numbers are aligned to the right from the second column on, unless
/// `is_text` is `true`.
pub(crate) fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>, is_text: bool) -> String {
    let class = if is_text { "rows prose" } else { "rows" };
    let cells = |tag: &str, cells: &mut dyn Iterator<Item = String>| {
        cells.map(|cell| format!("<{tag}>{}</{tag}>", escaped(&cell))).collect::<String>()
    };
    let head = cells("th", &mut heads.iter().map(|head| (*head).to_owned()));
    let rows: String =
        rows.into_iter().map(|row| format!("<tr>{}</tr>\n", cells("td", &mut row.into_iter()))).collect();
    format!(
        "<div class=\"scroll\"><table class=\"{class}\">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\
         </table></div>\n"
    )
}

/// Returns a section with the command that writes the page.
pub(crate) fn command_section(command: &str) -> String {
    format!(
        "<section>\n<h2>Command</h2>\n<p class=\"soft\">This command writes this page again.</p>\n<pre>{}</pre>\n\
         </section>\n",
        escaped(command)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("<a \"b\" & c>"), "&lt;a &quot;b&quot; &amp; c&gt;");
    }

    #[test]
    fn pictures_are_reduced_until_they_fit() {
        let mut random = fastrand::Rng::with_seed(1);
        let noise = Image::from_fn(200, 100, |_, _| [random.u8(..), random.u8(..), random.u8(..), 255]);
        let whole = FittedPictures::new(&[&noise], MAX_PAGE_BYTES).unwrap();
        assert_eq!((whole.note(), &whole.sources[..]), (String::new(), &[image_source(&noise).unwrap()][..]));
        let small = FittedPictures::new(&[&noise, &noise], 20_000).unwrap();
        assert!(small.sources.iter().map(String::len).sum::<usize>() <= 20_000);
        assert!(small.note().contains(&format!("1/{}", small.factor)) && small.factor > 1, "{}", small.note());
        let tiny = FittedPictures::new(&[&noise], 0).unwrap();
        assert_eq!(tiny.factor, 200);
    }
}
