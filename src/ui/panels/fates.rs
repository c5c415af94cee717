//! The panel “Triangle fates”: funnels of triangles and fragments, table of objects, and list of filtered triangles.

mod funnel;
mod list;
mod objects;
pub(super) mod overlay;

use eframe::egui::{Align, Layout, RichText, ScrollArea, Ui, Vec2, vec2};

use crate::inspect::fates::{Fates, FragmentFate, TriangleFate};
use crate::manual::Chapter;
use crate::scene::TriangleId;
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::fates::FatesView;
use crate::ui::theme::{Icon, space, tokens};
use crate::ui::widgets::{Status, chip, empty_state};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Stages,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Widths of the two funnels, of the table of objects and of the list, as fractions of the panel's width.
const SHARES: [f32; 4] = [0.18, 0.16, 0.31, 0.35];

/// Widths of the two funnels and of the table of objects above the list, as fractions of the panel's width.
const COUNTS_SHARES: [f32; 3] = [0.25, 0.22, 0.53];

/// Minimum width for all columns in one row, in points. In a narrower panel, the list is below the others.
const ONE_ROW_FROM: f32 = 900.0;

/// Height of the columns above the list in a narrow panel, in points.
const COUNTS_HEIGHT: f32 = 170.0;

/// Height of the list in a narrow panel, in points.
const LIST_HEIGHT: f32 = 200.0;

/// Draws, chips that show whether the fate counts add up to the totals.
pub(crate) fn controls(ui: &mut Ui, session: &Session) {
    let Some(fates) = &session.features.fates.fates else { return };
    let complaints = fates.account.complaints();
    if complaints.is_empty() {
        let help = "Every submitted triangle and every generated fragment has exactly one fate";
        chip(ui, Status::Passed, "all sums match", help);
    }
    for complaint in complaints {
        chip(ui, Status::Error, &complaint, "Internal error: some triangle or fragment does not have exactly one fate");
    }
    if !session.state.recipe.antialias.is_off() {
        let text = "counted at pixel centres only";
        ui.label(RichText::new(text).color(tokens(ui).text_weak))
            .on_hover_text("The other samples of an anti-aliased pixel are not counted");
    }
}

/// Draws the content of the panel “Triangle fates”.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let view = &session.features.fates;
    let Some(fates) = &view.fates else {
        let how = "The frame is drawn once more with counters.";
        empty_state(ui, Icon::ListChecks, "Counting the fates of triangles and fragments…", how);
        return;
    };
    let report = session.view.as_ref().and_then(|view| view.report.as_ref());
    let picked = report.and_then(|report| report.visible()).map(|fragment| fragment.triangle);
    let picked = PickedFates { view, fates, picked };
    let size = ui.available_size();
    if size.x >= ONE_ROW_FROM {
        columns(ui, size, &SHARES, |ui, column| picked.column(ui, column, commands));
        return;
    }
    ScrollArea::vertical().id_salt("rows").auto_shrink(false).show(ui, |ui| {
        let top = vec2(ui.available_width(), COUNTS_HEIGHT);
        columns(ui, top, &COUNTS_SHARES, |ui, column| picked.column(ui, column, commands));
        let below = vec2(ui.available_width(), LIST_HEIGHT);
        columns(ui, below, &[1.0], |ui, _| list::ui(ui, view, fates, picked.picked, commands));
    });
}

/// Inputs of the columns.
struct PickedFates<'a> {
    view: &'a FatesView,
    fates: &'a Fates,
    /// Triangle that is visible at the picked pixel.
    picked: Option<TriangleId>,
}

impl PickedFates<'_> {
    /// Draws a column of the panel: the fates of triangles, of fragments, the objects, or the list of triangles.
    fn column(&self, ui: &mut Ui, column: usize, commands: &mut Vec<Command>) {
        let Self { view, fates, picked } = *self;
        match column {
            0 => funnel(ui, "triangles", |ui| {
                let counts = fates.triangle_counts();
                funnel::ui::<TriangleFate>(ui, view.bin, |fate| counts.of(fate), commands);
            }),
            1 => funnel(ui, "fragments", |ui| {
                let counts = fates.fragment_counts();
                funnel::ui::<FragmentFate>(ui, view.bin, |fate| counts.of(fate), commands);
            }),
            2 => objects::ui(ui, &fates.objects, view.object, commands),
            _ => list::ui(ui, view, fates, picked, commands),
        }
    }
}

/// Divides `size` into columns with these fractions of its width.
fn columns(ui: &mut Ui, size: Vec2, shares: &[f32], mut content: impl FnMut(&mut Ui, usize)) {
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = space::M;
        let room = size.x - (shares.len() - 1) as f32 * space::M;
        for (column, share) in shares.iter().enumerate() {
            let width = room * share;
            ui.allocate_ui_with_layout(vec2(width, size.y), Layout::top_down_justified(Align::Min), |ui| {
                ui.set_max_size(vec2(width, size.y));
                content(ui, column);
            });
        }
    });
}

/// Draws the fates of one kind, which scroll.
fn funnel(ui: &mut Ui, what: &str, content: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().id_salt(what).auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        content(ui);
    });
}
