//! Panel with the picture: toolbar, canvas, tiles of a comparison or pictures of a case, and the playback controls.

use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Panel, Ui};

use super::compare::{self, tiles::TilesView};
use super::onboarding;
use super::panels::transport;
use super::scrub;
use super::theme;
use super::what_if;
use super::workspace::{PanelContext, PanelSpec, PanelWidgets};
use crate::manual::Chapter;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    id: "picture",
    name: "Picture",
    help: "Picture, with every buffer, stage and overlay",
    synonyms: &[],
    chapter: Chapter::GettingStarted,
    grows: true,
    titled: false,
    controls: None,
    content: ui,
};

/// Time after which a spinner is shown for an unanswered render request.
const SLOW_FRAME: Duration = Duration::from_millis(150);

/// Height of the bar above the canvas, in points.
const BAR_HEIGHT: f32 = theme::ROW_HEIGHT + 8.0;

fn ui(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let PanelContext { session, widgets, commands } = cx;
    if session.case.is_none() {
        widgets.case = Default::default();
    }
    let frame = theme::panel_frame(ui);
    Panel::top("toolbar").frame(frame).exact_size(BAR_HEIGHT).show(ui, |ui| {
        transport::toolbar(ui, session, widgets.canvas.scale(), commands);
    });
    Panel::bottom("scrubber").frame(frame).exact_size(scrub::transport::HEIGHT).show(ui, |ui| {
        scrub::transport::ui(ui, session, commands);
    });
    let compares = session.comparison.is_on() && session.case.is_none();
    if compares {
        Panel::top("compare").frame(frame).show(ui, |ui| {
            compare::bar::ui(ui, session, widgets.canvas.scale(), commands);
        });
    }
    let asks = session.what_if.open && !compares && session.case.is_none();
    if asks {
        Panel::top("what-if").frame(frame).show(ui, |ui| what_if::bar::ui(ui, session, commands));
    }
    CentralPanel::default().frame(theme::canvas_frame(ui)).show(ui, |ui| canvas(ui, cx, compares));
}

fn canvas(ui: &mut Ui, cx: &mut PanelContext<'_>, compares: bool) {
    let PanelContext { session, widgets, commands } = cx;
    let PanelWidgets { canvas, tiles, case, thumbnails, canvas_px, requested_at, is_synchronous, .. } = &mut **widgets;
    let rect = ui.max_rect();
    let size = if compares { TilesView::picture_size(rect, session) } else { ui.available_size() };
    let size = size * ui.pixels_per_point();
    *canvas_px = (size.x.max(1.0) as u32, size.y.max(1.0) as u32);
    if session.case.is_some() {
        case.ui(ui, session, *is_synchronous, commands);
    } else if compares {
        canvas.hovered = tiles.ui(ui, &mut canvas.zoom, session, commands);
    } else {
        canvas.ui(ui, session, commands);
        what_if::bar::label(ui, rect, session);
    }
    if session.case.is_none() {
        onboarding::card::ui(ui, rect, session, thumbnails, commands);
        onboarding::coach::ui(ui, rect, session, commands);
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
