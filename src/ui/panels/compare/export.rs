//! Export of a comparison as one HTML page: every picture with its error metrics and the command that shows it.

use std::sync::Arc;

use super::tiles::figures::{metric_rows, words_of_all};
use crate::inspect::place::InspectionState;
use crate::measure::region::PixelRegion;
use crate::pipeline::settings::Choice as _;
use crate::report::pictures::{MetricTable, PictureFigure, PicturePage};
use crate::ui::session::Session;
use crate::ui::session::compare::compute::Compared;
use crate::ui::session::picture_role::letter;

/// Collects the pictures that are being compared, as the content of a page.
///
/// # Errors
/// Returns the reason why there is no complete comparison.
pub(crate) fn comparison_page(session: &Session) -> Result<PicturePage, &'static str> {
    if !session.features.comparison.is_on() {
        return Err("No comparison to save: press T to compare pictures");
    }
    let complete = session.features.comparison.compared.as_ref().filter(|compared| compared.complete);
    let compared = complete.ok_or("The errors of the pictures are still being measured: save again in a moment")?;
    if compared.tiles.iter().any(|tile| tile.replay.is_some()) {
        return Err("A picture lacks earlier frames in its history: show another frame, and save after they are drawn");
    }
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
    let tiles = 0..compared.tiles.len();
    let mut figures: Vec<_> = tiles.clone().map(|tile| figure(session, compared, tile)).collect();
    figures.extend(compared.difference.as_ref().map(|difference| {
        let (kind, gain) = difference.kind;
        PictureFigure {
            label: format!("Difference of A and B: {}, × {gain}", kind.name().to_lowercase()),
            picture: difference.picture.clone(),
            lines: Vec::new(),
            command: None,
        }
    }));
    let measured: Vec<_> = compared.tiles.iter().map(|tile| tile.measured.as_ref()?.figures).collect();
    Ok(PicturePage {
        title: format!("Comparison: {}", request.scene.name),
        summary: vec![summary],
        figures,
        metrics: Some(MetricTable {
            columns: tiles.map(|tile| letter(tile).to_string()).collect(),
            rows: metric_rows(&measured),
        }),
        command: None,
    })
}

/// Returns a compared picture with its metrics and, unless it is a file, the command that shows it.
fn figure(session: &Session, compared: &Compared, tile: usize) -> PictureFigure {
    let (request, result) = (&compared.request, &compared.tiles[tile]);
    let state = InspectionState {
        camera: request.camera,
        recipe: result.recipe,
        picture: Some((request.viewport.width, request.viewport.height)),
        ..session.place()
    };
    let whole = result.measured.as_ref().and_then(|measured| measured.figures);
    let whole = whole.map(|metrics| words_of_all(&metrics));
    let region = result.region_figures.map(|metrics| format!("Region: {}", words_of_all(&metrics)));
    PictureFigure {
        label: format!("{} · {}", letter(tile), result.title()),
        picture: Arc::clone(&result.picture),
        lines: whole.into_iter().chain(region).collect(),
        command: result.file.is_none().then(|| state.command_line()),
    }
}
