//! Error metrics below a picture, for the whole picture and for the region.

use eframe::egui::{self, Align2, Color32, FontId, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::small;
use crate::measure::against::ErrorMetrics;
use crate::ui::engine::replay::ReplayProgress;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::compare::compute::Compared;
use crate::ui::session::picture_role::letter;
use crate::ui::theme::{font_size, space, tokens};

/// Height of a row of error metrics, in points.
pub(super) const LINE: f32 = 13.0;

/// Width of one error metric including its name, in points.
const FIGURE: f32 = 108.0;

/// Returns the number of rows that a picture's error metrics take in a column `width` points wide.
pub(super) fn figure_lines(width: f32) -> usize {
    if width < 2.0 * FIGURE { NAMED.len().div_ceil(2) } else { NAMED.len().div_ceil((width / FIGURE) as usize) }
}

/// Returns the number of error metrics shown in a column `width` points wide; the most informative ones come first.
fn figure_count(width: f32) -> usize {
    if width < 2.0 * FIGURE { NAMED.len().div_ceil(2) } else { NAMED.len() }
}

/// Name of an error metric, and the function that formats its value.
type Named = (&'static str, fn(&ErrorMetrics) -> String);

/// All error metrics, the most informative first.
const NAMED: [Named; 6] = [
    ("PSNR", |f| {
        if f.codes.mse == 0.0 { "identical".to_owned() } else { format!("{} dB", format::fixed(f.codes.psnr_db, 2)) }
    }),
    ("SSIM", |f| format::fixed(f.codes.ssim, 4)),
    ("FLIP", |f| format::fixed(f.flip, 4)),
    ("MSE", |f| format::fixed(f.codes.mse, 2)),
    ("max", |f| f.codes.max_abs.to_string()),
    ("differ", |f| format!("{} px", format::count(f.codes.differing_pixels))),
];

/// Tooltip that explains the error metrics.
const FIGURES_HELP: &str = "Errors against the reference. PSNR and MSE are computed from sRGB codes. SSIM: 1 means \
                            equal. FLIP: 0 means equal, 1 means black against white. max: largest difference of a \
                            code. differ: number of differing pixels. Reference";

pub(super) fn figures_of_both(ui: &Ui, footer: Rect, compared: &Compared, session: &Session) {
    let (left, right) = footer.split_left_right_at_fraction(0.5);
    figures_of(ui, 0, left, compared, session);
    figures_of(ui, 1, right, compared, session);
}

/// Draws the error metrics of a tile, and below them the error metrics of the region.
pub(super) fn figures_of(ui: &Ui, index: usize, footer: Rect, compared: &Compared, session: &Session) {
    let Some(tile) = compared.tiles.get(index) else { return };
    let response = ui.interact(footer, egui::Id::unique(("figures of tile", index)), Sense::hover());
    let drawn = match &tile.file {
        Some(file) => file.picture.description(),
        None => format!("{} of the pixels drawn", format::percent(tile.drawn_share)),
    };
    let lines = figure_lines(footer.width()) as f32 * LINE;
    let words = match (&tile.measured, tile.replay) {
        (None, Some(_)) if compared.complete => "history incomplete · not measured".to_owned(),
        (None, Some(ReplayProgress { done, of })) => format!("history incomplete · drawing frame {done} of {of} …"),
        (None, None) => "measuring…".to_owned(),
        (Some(measured), _) => match &measured.figures {
            None => "not measured: this picture and the reference have different sizes".to_owned(),
            Some(figures) => draw_figures(ui, footer, figures, tokens(ui).text),
        },
    };
    if tile.measured.as_ref().is_none_or(|measured| measured.figures.is_none()) {
        let at = footer.min + vec2(space::XS, 2.0);
        ui.painter().with_clip_rect(footer).text(at, Align2::LEFT_TOP, &words, small(), tokens(ui).text_weak);
    }
    if let Some(figures) = &tile.region_figures {
        draw_figures(ui, footer.translate(vec2(0.0, lines)), figures, tokens(ui).accent);
    }
    let name = format!("Figures of {}: {words}", letter(index));
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &name));
    response.on_hover_ui(|ui| {
        ui.label(egui::RichText::new(tile.title()).strong());
        ui.label(&drawn);
        if tile.replay.is_some() {
            ui.label("The upscaler's history lacks earlier frames until they are drawn");
        }
        for (figures, of) in
            [(tile.measured.as_ref().and_then(|m| m.figures), "Whole picture"), (tile.region_figures, "Region")]
        {
            if let Some(figures) = figures {
                ui.label(format!("{of}: {}", words_of_all(&figures)));
            }
        }
        ui.label(format!("{FIGURES_HELP}: {}", session.features.comparison.reference_name(&session.state.tiles)));
    });
}

/// Returns all error metrics as text, the most informative first.
pub(in crate::ui::panels::compare) fn words_of_all(figures: &ErrorMetrics) -> String {
    words_of(figures, NAMED.len())
}

/// Returns a row for each error metric: its name, and its value for each picture, or a dash where it is not measured.
pub(in crate::ui::panels::compare) fn metric_rows(pictures: &[Option<ErrorMetrics>]) -> Vec<Vec<String>> {
    let row = |(name, value): &Named| {
        let values = pictures.iter().map(|figures| figures.as_ref().map_or_else(|| "–".to_owned(), value));
        std::iter::once((*name).to_owned()).chain(values).collect()
    };
    NAMED.iter().map(row).collect()
}

fn words_of(figures: &ErrorMetrics, count: usize) -> String {
    let words = NAMED[..count].iter().map(|(name, value)| format!("{name} {}", value(figures)));
    words.collect::<Vec<_>>().join(" · ")
}

/// Draws error metrics in columns, starting at the top of `rect`, and returns them as text.
fn draw_figures(ui: &Ui, rect: Rect, figures: &ErrorMetrics, color: Color32) -> String {
    let painter = ui.painter();
    let count = figure_count(rect.width());
    let columns = count.div_ceil(figure_lines(rect.width()));
    let step = rect.width() / columns as f32;
    for (place, (name, value)) in NAMED[..count].iter().enumerate() {
        let at = rect.min + vec2((place % columns) as f32 * step + space::XS, (place / columns) as f32 * LINE + 2.0);
        let name = painter.text(at, Align2::LEFT_TOP, name, small(), tokens(ui).text_weak);
        let font = FontId::monospace(font_size::SMALL);
        painter.text(pos2(name.right() + space::XS, at.y), Align2::LEFT_TOP, value(figures), font, color);
    }
    words_of(figures, count)
}
