//! Panel with the picture: toolbar, canvas, tiles of a comparison or pictures of a case, and the playback controls.

use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Panel, Ui};

use super::compare::tiles::TilesView;
use super::{
    PanelContext, PanelSpec, PanelWidgets, compare, filmstrip, legend_strip, onboarding, scene_time, scrub, sequences,
    transport, what_if,
};
use crate::manual::Chapter;
use crate::ui::theme;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec =
    PanelSpec { chapter: Chapter::GettingStarted, grows: true, titled: false, controls: None, content: ui };

/// Time after which a spinner is shown for an unanswered render request.
const SLOW_FRAME: Duration = Duration::from_millis(150);

/// Height of the bar above the canvas, in points.
const BAR_HEIGHT: f32 = theme::ROW_HEIGHT + 8.0;

fn ui(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let PanelContext { session, widgets, commands } = cx;
    if session.features.case.is_none() {
        widgets.case = Default::default();
    }
    let frame = theme::panel_frame(ui);
    widgets.picture_panel_height = ui.available_height();
    Panel::top("toolbar").frame(frame).exact_size(BAR_HEIGHT).show(ui, |ui| {
        transport::toolbar(ui, session, widgets.canvas.scale(), commands);
    });
    let compares = session.features.comparison.is_on() && session.features.case.is_none();
    if compares {
        // Compared pictures are complete: there is nothing to play back.
        Panel::top("compare").frame(frame).show(ui, |ui| {
            compare::bar::ui(ui, session, widgets, commands);
        });
    } else {
        Panel::bottom("scrubber").frame(frame).exact_size(scrub::HEIGHT).show(ui, |ui| {
            scrub::ui(ui, session, commands);
        });
    }
    if session.scene_frame_count().is_some() && session.features.case.is_none() {
        Panel::bottom("scene time").frame(frame).show(ui, |ui| scene_time::ui(ui, session, commands));
    }
    if compares && session.sequence_range().is_some() {
        Panel::bottom("sequences").frame(frame).show(ui, |ui| sequences::ui(ui, session, commands));
    }
    widgets.shows_filmstrip = compares && session.features.filmstrip.is_shown_in(widgets.picture_panel_height);
    if widgets.shows_filmstrip {
        let tight = frame.inner_margin(egui::Margin::symmetric(theme::space::S as i8, filmstrip::MARGIN));
        Panel::bottom("filmstrip").frame(tight).exact_size(filmstrip::HEIGHT).show(ui, |ui| {
            widgets.filmstrip.ui(ui, session, commands);
        });
    }
    let asks = session.features.what_if.open && !compares && session.features.case.is_none();
    if asks {
        Panel::top("what-if").frame(frame).show(ui, |ui| what_if::ui(ui, session, commands));
    }
    let shows_case = session.features.case.is_some();
    let strip = if shows_case { 0.0 } else { legend_strip::show(ui, frame, compares, session, commands) };
    CentralPanel::default().frame(theme::canvas_frame(ui)).show(ui, |ui| canvas(ui, cx, compares, strip));
}

/// Draws the canvas. `strip` is the height of the legend strip below it, in points. A picture that matches the window
/// does not become smaller when the strip appears.
fn canvas(ui: &mut Ui, cx: &mut PanelContext<'_>, compares: bool, strip: f32) {
    let PanelContext { session, widgets, commands } = cx;
    let PanelWidgets { canvas, tiles, case, thumbnails, canvas_px, visible_px, requested_at, is_synchronous, .. } =
        &mut **widgets;
    let rect = ui.max_rect();
    let size = if compares { TilesView::picture_size(rect, session) } else { ui.available_size() };
    let in_pixels = |size: egui::Vec2| {
        let size = size * ui.pixels_per_point();
        (size.x.max(1.0) as u32, size.y.max(1.0) as u32)
    };
    (*visible_px, *canvas_px) = (in_pixels(size), in_pixels(size + egui::vec2(0.0, strip)));
    if session.features.case.is_some() {
        case.ui(ui, session, *is_synchronous, commands);
    } else if compares {
        canvas.hovered = tiles.ui(ui, &mut canvas.zoom, session, commands);
    } else {
        canvas.ui(ui, session, commands);
        what_if::label(ui, rect, session);
    }
    if session.features.case.is_none() {
        let pictures = if compares { TilesView::pictures(rect, session) } else { rect };
        onboarding::card::ui(ui, pictures, session, thumbnails, commands);
        onboarding::coach::ui(ui, pictures, session, commands);
    }
    drop_hint(ui);
    busy_mark(ui, *requested_at);
}

/// Draws a spinner in the corner of the canvas if a render request has been unanswered for at least [`SLOW_FRAME`].
fn busy_mark(ui: &Ui, requested_at: Option<Instant>) {
    let Some(since) = requested_at else { return };
    if since.elapsed() >= SLOW_FRAME {
        let corner = ui.max_rect().right_top() + egui::vec2(-28.0, 8.0);
        egui::Spinner::new().paint_at(ui, egui::Rect::from_min_size(corner, egui::Vec2::splat(20.0)));
    } else {
        ui.request_repaint_after(SLOW_FRAME);
    }
}

fn drop_hint(ui: &Ui) {
    if ui.input(|i| !i.raw.hovered_files.is_empty()) {
        let rect = ui.max_rect();
        ui.painter().rect_filled(rect, 0.0, egui::Color32::from_black_alpha(170));
        let font = egui::FontId::proportional(theme::font_size::TITLE);
        ui.painter().text(
            rect.center(),
            egui::Align2::CENTER_CENTER,
            "Drop the file to open it",
            font,
            egui::Color32::WHITE,
        );
    }
}
