//! What this scene needs: every part of the work with the draws that run it and those that leave it out, and why.

use std::collections::BTreeMap;

use eframe::egui::{Grid, RichText, Ui};

use crate::pipeline::plan::{DrawPlan, Part, Step};
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::empty_state;

/// Draws the table.
pub fn ui(ui: &mut Ui, session: &Session) {
    let Some(view) = &session.view else {
        empty_state(ui, Icon::ListChecks, "No frame yet", "The plan is made with the first frame.");
        return;
    };
    let plans = &view.frame.plans;
    Grid::new("plan").num_columns(3).striped(true).spacing([24.0, 4.0]).show(ui, |ui| {
        for heading in ["Part", "Runs for", "Left out"] {
            ui.label(RichText::new(heading).small().color(tokens(ui).text_weak));
        }
        ui.end_row();
        for part in Part::ALL {
            ui.label(part.name());
            let running = plans.iter().filter(|p| p.runs(part)).count();
            let color = if running > 0 { tokens(ui).text_strong } else { tokens(ui).text_weak };
            let text = format!("{} of {} draws", format::count(running as u64), format::count(plans.len() as u64));
            ui.label(RichText::new(text).monospace().color(color));
            ui.label(RichText::new(reasons(plans, part)).color(tokens(ui).text_weak));
            ui.end_row();
        }
    });
}

/// The reasons for which draws leave a part out, each with its number of draws.
pub fn reasons(plans: &[DrawPlan], part: Part) -> String {
    let mut counts = BTreeMap::new();
    for plan in plans {
        if let Step::LeftOut(reason) = plan.step(part) {
            *counts.entry(reason).or_insert(0_u64) += 1;
        }
    }
    let texts: Vec<_> = counts.iter().map(|(reason, n)| format!("{} × {reason}", format::count(*n))).collect();
    texts.join(", ")
}
