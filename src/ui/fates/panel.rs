//! The panel “Triangle fates”: funnels of triangles and fragments, table of objects, and list of filtered triangles.

use std::sync::Arc;

use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{Align, Color32, FontId, Galley, Layout, RichText, ScrollArea, Ui, vec2};

use super::{funnel, list, objects};
use crate::inspect::fates::{FragmentFate, TriangleFate};
use crate::manual::Chapter;
use crate::ui::command::Command;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, space, tokens};
use crate::ui::widgets::{Status, chip, empty_state};
use crate::ui::workspace::PanelSpec;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    id: "triangle-fates",
    name: "Triangle fates",
    help: "Fate of every triangle and fragment, such as culled or visible; click a fate to select its triangles",
    synonyms: &[],
    chapter: Chapter::Stages,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Widths of the two funnels and of the table of objects, as fractions of the tab's width; the list takes the rest.
const SHARES: [f32; 3] = [0.18, 0.16, 0.31];

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
    let size = ui.available_size();
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = space::M;
        let column = |ui: &mut Ui, share: f32, content: &mut dyn FnMut(&mut Ui)| {
            let width = (size.x - SHARES.len() as f32 * space::M) * share;
            ui.allocate_ui_with_layout(vec2(width, size.y), Layout::top_down_justified(Align::Min), |ui| {
                ui.set_max_width(width);
                content(ui);
            });
        };
        let funnel = |ui: &mut Ui, what: &str, content: &mut dyn FnMut(&mut Ui)| {
            ScrollArea::vertical().id_salt(what).auto_shrink(false).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                content(ui);
            });
        };
        column(ui, SHARES[0], &mut |ui| {
            funnel(ui, "triangles", &mut |ui| {
                let counts = fates.triangle_counts();
                let head = ("Triangles", "Every triangle of the scene has exactly one of these fates");
                funnel::ui::<TriangleFate>(ui, head, view.bin, |fate| counts.of(fate), commands);
            });
        });
        column(ui, SHARES[1], &mut |ui| {
            funnel(ui, "fragments", &mut |ui| {
                let counts = fates.fragment_counts();
                let head = ("Fragments", "Every sample that a triangle covers has exactly one of these fates");
                funnel::ui::<FragmentFate>(ui, head, view.bin, |fate| counts.of(fate), commands);
            });
        });
        column(ui, SHARES[2], &mut |ui| objects::ui(ui, &fates.objects, view.object, commands));
        column(ui, 1.0 - SHARES.iter().sum::<f32>(), &mut |ui| list::ui(ui, view, fates, picked, commands));
    });
}

/// Lays out a line of text, truncated with `…` if it exceeds `width` points.
pub(super) fn elided(ui: &Ui, text: &str, font: FontId, color: Color32, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), font, color);
    job.wrap = TextWrapping::truncate_at_width(width.max(0.0));
    ui.painter().layout_job(job)
}
