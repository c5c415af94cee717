//! Export of a comparison as one HTML page: every picture with its error metrics and the command that shows it.

use std::io;
use std::sync::Arc;

use super::compute::Compared;
use super::letter;
use super::tiles::figures::words_of_all;
use crate::image::{Image, Rgba8};
use crate::inspect::place::InspectionState;
use crate::measure::region::PixelRegion;
use crate::pipeline::settings::Choice as _;
use crate::report::html::{document, escaped, image_source};
use crate::ui::session::Session;

/// CSS rules specific to this page.
const STYLE: &str = ".pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 420px), 1fr)); \
                     gap: 20px; margin-top: 20px; }\n\
                     .pictures figure { margin: 0; min-width: 0; }\n\
                     .pictures img { width: 100%; image-rendering: pixelated; display: block; }\n";

/// Content of the page.
#[derive(Clone, Debug)]
pub(crate) struct ComparisonPage {
    title: String,
    /// Picture size, reference and region, as HTML.
    summary: String,
    figures: Vec<Figure>,
}

/// One of the pictures on the page.
#[derive(Clone, Debug)]
struct Figure {
    label: String,
    picture: Arc<Image<Rgba8>>,
    /// Error metrics of the whole picture and, if there is a region, of the region; empty for a difference image.
    metrics: Vec<String>,
    /// Command that shows the picture in the window; `None` for a difference image and for a picture file.
    command: Option<String>,
}

impl ComparisonPage {
    /// Collects the pictures that are being compared.
    ///
    /// # Errors
    /// Returns the reason why there is no complete comparison.
    pub(crate) fn of(session: &Session) -> Result<Self, &'static str> {
        if !session.comparison.is_on() {
            return Err("No comparison to save: press T to compare pictures");
        }
        let complete = session.compared.as_ref().filter(|compared| compared.complete);
        let compared = complete.ok_or("The errors of the pictures are still being measured: save again in a moment")?;
        let request = &compared.request;
        let size = format!("{} × {} px", request.viewport.width, request.viewport.height);
        let mut summary = format!(
            "{size} · reference: {}",
            request.files.reference.as_ref().map_or_else(|| request.reference.name().to_owned(), |file| file.name())
        );
        if let Some(region) = request.region {
            let PixelRegion { left, top, right, bottom } = region;
            summary += &format!(" · region: columns {left} to {}, rows {top} to {}", right - 1, bottom - 1);
        }
        let mut figures: Vec<_> = (0..compared.tiles.len()).map(|tile| Figure::of(session, compared, tile)).collect();
        figures.extend(compared.difference.as_ref().map(|difference| {
            let (kind, gain) = difference.kind;
            Figure {
                label: format!("Difference of A and B: {}, × {gain}", kind.name().to_lowercase()),
                picture: difference.picture.clone(),
                metrics: Vec::new(),
                command: None,
            }
        }));
        Ok(Self { title: format!("Comparison: {}", request.scene.name), summary: escaped(&summary), figures })
    }

    /// Returns the page as HTML, with all pictures embedded.
    ///
    /// # Errors
    /// Returns an error if a picture cannot be encoded.
    pub(crate) fn html(&self) -> io::Result<String> {
        let figures: io::Result<String> = self.figures.iter().map(Figure::html).collect();
        let body = format!(
            "<h1>{}</h1>\n<p class=\"soft\">{}</p>\n<div class=\"pictures\">\n{}</div>\n",
            escaped(&self.title),
            self.summary,
            figures?
        );
        Ok(document(&self.title, STYLE, &body))
    }
}

impl Figure {
    fn of(session: &Session, compared: &Compared, tile: usize) -> Self {
        let (request, result) = (&compared.request, &compared.tiles[tile]);
        let whole = result.measured.as_ref().and_then(|measured| measured.figures);
        let whole = whole.map(|metrics| words_of_all(&metrics));
        let region = result.region_figures.map(|metrics| format!("Region: {}", words_of_all(&metrics)));
        let state = InspectionState {
            camera: request.camera,
            recipe: result.recipe,
            picture: Some((request.viewport.width, request.viewport.height)),
            ..session.place()
        };
        Self {
            label: format!("{} · {}", letter(tile), result.title()),
            picture: result.picture.clone(),
            metrics: whole.into_iter().chain(region).collect(),
            command: result.file.is_none().then(|| state.command_line()),
        }
    }

    fn html(&self) -> io::Result<String> {
        let label = escaped(&self.label);
        let metrics: String = self.metrics.iter().map(|text| format!("<br>{}", escaped(text))).collect();
        let command = self.command.as_ref().map_or_else(String::new, |command| {
            format!("<details><summary>Command</summary><pre>{}</pre></details>", escaped(command))
        });
        Ok(format!(
            "<figure><img alt=\"{label}\" src=\"{}\"><figcaption><b>{label}</b>{metrics}</figcaption>{command}</figure>\n",
            image_source(&self.picture)?
        ))
    }
}
