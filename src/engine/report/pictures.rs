//! Comparison of pictures as one HTML page: the pictures, a wipe, their difference, and a table of error metrics.

use std::io;
use std::sync::Arc;

use super::html::{FittedPictures, MAX_PAGE_BYTES, command_section, document, escaped, table};
use crate::image::{Image, Rgba8};

/// Script that adds the wipe, which shows the first picture to the left of a movable line and the second to its right.
const WIPE: &str = include_str!("wipe.js");

/// Part of the page that remains for text, in bytes.
const TEXT_BYTES: usize = 200_000;

/// Content of the page.
#[derive(Clone, Debug, Default)]
pub struct PicturePage {
    /// Title of the page.
    pub title: String,
    /// Sentences below the title: sizes, reference, region, and settings that differ.
    pub summary: Vec<String>,
    /// Compared pictures, and pictures computed from them. The wipe shows the first two.
    pub figures: Vec<PictureFigure>,
    /// Error metrics: the heads of the columns, and rows of as many cells.
    pub metrics: Option<MetricTable>,
    /// Command that writes the page again; `None` if the page shows a state that no command restores.
    pub command: Option<String>,
}

/// Picture of the page.
#[derive(Clone, Debug)]
pub struct PictureFigure {
    /// Name of the picture.
    pub label: String,
    /// The picture.
    pub picture: Arc<Image<Rgba8>>,
    /// Lines below the name.
    pub lines: Vec<String>,
    /// Command that shows the picture in the window.
    pub command: Option<String>,
}

/// Table of error metrics.
#[derive(Clone, Debug, Default)]
pub struct MetricTable {
    /// Heads of the columns, such as `A against B`, after that of the names.
    pub columns: Vec<String>,
    /// Name of each metric and its values.
    pub rows: Vec<Vec<String>>,
}

impl PicturePage {
    /// Returns the page as HTML with all pictures embedded. Pictures are reduced if the page would exceed
    /// [`MAX_PAGE_BYTES`].
    ///
    /// # Errors
    /// Returns an error if a picture cannot be encoded.
    pub fn html(&self) -> io::Result<String> {
        let pictures: Vec<&Image<Rgba8>> = self.figures.iter().map(|figure| &*figure.picture).collect();
        let fitted = FittedPictures::new(&pictures, MAX_PAGE_BYTES - TEXT_BYTES)?;
        let note = fitted.note();
        let summary = self.summary.iter().chain(Some(&note)).filter(|line| !line.is_empty());
        let summary: String = summary.map(|line| format!("<p class=\"soft\">{}</p>\n", escaped(line))).collect();
        let figures: String =
            self.figures.iter().zip(&fitted.sources).map(|(figure, source)| figure.html(source)).collect();
        let metrics = self.metrics.as_ref().map_or_else(String::new, MetricTable::html);
        let command = self.command.as_deref().map_or_else(String::new, command_section);
        let body = format!(
            "<h1>{}</h1>\n{summary}<section id=\"wipe\" hidden>\n<h2>Wipe</h2>\n<div class=\"wipe\"><img alt=\"\"><img \
             alt=\"\"></div>\n<label class=\"wipe-bar\"><span></span><input type=\"range\" min=\"0\" max=\"100\" \
             step=\"0.1\" value=\"50\" aria-label=\"Position of the wipe\"><span></span></label>\n</section>\n<div \
             class=\"pictures\">\n{figures}</div>\n{metrics}{command}<script>\n{WIPE}</script>\n",
            escaped(&self.title)
        );
        Ok(document(&self.title, "", &body))
    }
}

impl PictureFigure {
    fn html(&self, source: &str) -> String {
        let label = escaped(&self.label);
        let lines: String = self.lines.iter().map(|text| format!("<br>{}", escaped(text))).collect();
        let command = self.command.as_ref().map_or_else(String::new, |command| {
            format!("<details><summary>Command</summary><pre>{}</pre></details>", escaped(command))
        });
        format!(
            "<figure><img alt=\"{label}\" src=\"{source}\"><figcaption><b>{label}</b>{lines}</figcaption>{command}\
             </figure>\n"
        )
    }
}

impl MetricTable {
    fn html(&self) -> String {
        let heads: Vec<&str> = std::iter::once("Metric").chain(self.columns.iter().map(String::as_str)).collect();
        format!(
            "<section>\n<h2>Errors</h2>\n<div class=\"narrow\">{}</div></section>\n",
            table(&heads, self.rows.iter().cloned(), false)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn untrusted_names_are_escaped_and_pages_stay_small() {
        let mut random = fastrand::Rng::with_seed(3);
        let noise = Arc::new(Image::from_fn(1280, 720, |_, _| [random.u8(..), random.u8(..), random.u8(..), 255]));
        let attack = "\"><script>alert(1)</script>";
        let figure = || PictureFigure {
            label: attack.to_owned(),
            picture: noise.clone(),
            lines: vec![attack.to_owned()],
            command: Some(attack.to_owned()),
        };
        let page = PicturePage {
            title: attack.to_owned(),
            summary: vec![attack.to_owned()],
            figures: vec![figure(), figure(), figure()],
            metrics: Some(MetricTable { columns: vec![attack.to_owned()], rows: vec![vec![attack.to_owned(); 2]] }),
            command: Some(attack.to_owned()),
        };
        let html = page.html().unwrap();
        assert!(!html.contains("<script>alert"));
        assert!(html.len() <= MAX_PAGE_BYTES, "{}", html.len());
        assert!(html.contains("Pictures are reduced to 1/"));
    }
}
