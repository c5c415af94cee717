//! The panel “Skipped work”: for each part of the pipeline, the number of draws that run or skip it, the measured time saved, and
//! the reasons for skipping.

use std::collections::BTreeMap;

use eframe::egui::{Button, Grid, ProgressBar, RichText, Ui};

use crate::chain::KeepDepth;
use crate::chain::whole::FramePart;
use crate::manual::Chapter;
use crate::measure::noise;
use crate::measure::skipped_work::{Saving, Savings};
use crate::pipeline::plan::{CullStats, DrawPlan, PipelinePart, PlanStep};
use crate::ui::engine::RenderedView;
use crate::ui::format;
use crate::ui::panels::{PanelSpec, scrolling};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::long_tasks::MeasureCommand;
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::empty_state;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::SkippedWork,
    grows: true,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| scrolling(ui, |ui| self::ui(ui, cx.session)),
};

/// Draws the controls of the panel “Skipped work”.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(progress) = session.features.tasks.savings.progress {
        if ui.button("Cancel").on_hover_text("Stop the measurement").clicked() {
            commands.push(Command::Measure(MeasureCommand::CancelPlan));
        }
        ui.add(ProgressBar::new(progress).desired_width(200.0).show_percentage());
        return;
    }
    let measure = Button::new((crate::ui::theme::icon(Icon::Timer), "Measure savings"));
    let help = "Measure the time that skipping saves: draw this view with every skip enabled, and with each skip \
                disabled in turn. Takes a few seconds";
    if ui.add(measure).on_hover_text(help).clicked() {
        commands.push(Command::Measure(MeasureCommand::MeasurePlan));
    }
    if let Some((savings, of)) = &session.features.tasks.savings.found {
        let Savings { planned_ms, noise, .. } = &**savings;
        let text = format!(
            "{}: {:.2} ms with every skip enabled, median of {} rounds; noise floor {}",
            of.scene.name,
            planned_ms.median,
            planned_ms.n,
            noise.words()
        );
        ui.label(RichText::new(text).color(tokens(ui).text_weak));
    }
}

/// Draws the table of all parts of the pipeline: in how many draws each part runs, and why it is skipped.
pub(crate) fn ui(ui: &mut Ui, session: &Session) {
    let Some(view) = &session.view else {
        empty_state(ui, Icon::ListChecks, "No frame yet", "The plan appears with the first frame.");
        return;
    };
    let plans = &view.frame.plans;
    Grid::new("plan").num_columns(4).striped(true).spacing([24.0, 4.0]).show(ui, |ui| {
        for heading in ["Part", "Runs in", "Time saved", "Skipped because"] {
            ui.label(RichText::new(heading).small().color(tokens(ui).text_weak));
        }
        ui.end_row();
        for part in PipelinePart::ALL {
            ui.label(part.name());
            let running = plans.iter().filter(|p| p.runs(part)).count();
            let color = if running > 0 { tokens(ui).text_strong } else { tokens(ui).text_weak };
            let text = format!("{} of {} draws", format::count(running as u64), format::count(plans.len() as u64));
            ui.label(RichText::new(text).monospace().color(color));
            saved(ui, session, view, part);
            ui.label(RichText::new(reasons(plans, part)).color(tokens(ui).text_weak));
            ui.end_row();
        }
        let frame = &view.frame;
        let keeps = if frame.drawn.depth.is_some() { KeepDepth::Yes } else { KeepDepth::No };
        for part in FramePart::ALL {
            let step = part.step(&view.request.scene, &view.request.recipe, keeps, frame.view_change());
            ui.label(part.name());
            let color = if step.runs() { tokens(ui).text_strong } else { tokens(ui).text_weak };
            let drawn = format!("{:.2} % of pixels", frame.drawn_share() * 100.0);
            let text = match step {
                PlanStep::Skipped(_) if part == FramePart::EveryPixel => &drawn,
                PlanStep::Skipped(_) => "skipped",
                PlanStep::Run => "whole frame",
            };
            ui.label(RichText::new(text).monospace().color(color));
            ui.label(RichText::new("–").color(tokens(ui).text_weak));
            ui.label(RichText::new(step.reason().unwrap_or_default()).color(tokens(ui).text_weak));
            ui.end_row();
        }
    });
}

/// Draws the time saved by skipping a part in this view, or a dash if it was not measured.
fn saved(ui: &mut Ui, session: &Session, view: &RenderedView, part: PipelinePart) {
    let found = session.features.tasks.savings.found.as_ref();
    let of_part = |saving: &&Saving| saving.part == Some(part);
    let measured = found.and_then(|(savings, of)| Some((savings.savings.iter().find(of_part)?, of)));
    let fitting = measured.filter(|(_, of)| of.same_complete_frame(&view.request));
    let Some((Saving { saved_ms, within_noise, draws, same_picture, .. }, _)) = fitting else {
        let nothing = ui.label(RichText::new("–").color(tokens(ui).text_weak));
        if measured.is_some() {
            nothing.on_hover_text("Measured on a different view; measure again for this one");
        }
        return;
    };
    let picture = if *same_picture { "the picture is identical" } else { "the picture changed: internal error" };
    let help = format!(
        "If this part is not skipped in {draws} draws, the time of a frame changes by {:+.3} ms in the median round \
         (p10 {:+.3}, p90 {:+.3}), {}; {picture}",
        saved_ms.median,
        saved_ms.p10,
        saved_ms.p90,
        noise::label(*within_noise)
    );
    let color = if *within_noise { tokens(ui).text_weak } else { tokens(ui).text_strong };
    let text = format!("{:+.2} ms", saved_ms.median);
    ui.label(RichText::new(text).monospace().color(color)).on_hover_text(help);
}

/// Returns the reasons why all draws skip a part; `None` if a draw runs it. A reason that all draws share stands alone,
/// different reasons with the number of their draws.
pub(crate) fn reasons_in_all(plans: &[DrawPlan], part: PipelinePart) -> Option<String> {
    let first = plans.first()?.step(part).reason()?;
    if plans.iter().all(|plan| plan.step(part).reason() == Some(first)) {
        return Some(first.to_owned());
    }
    plans.iter().all(|plan| !plan.runs(part)).then(|| reasons(plans, part))
}

/// Returns the reasons why draws skip a part, each with the number of such draws, as text.
pub(crate) fn reasons(plans: &[DrawPlan], part: PipelinePart) -> String {
    let mut counts = BTreeMap::new();
    for plan in plans {
        if let PlanStep::Skipped(reason) = plan.step(part) {
            *counts.entry(reason).or_insert(0_u64) += 1;
        }
    }
    let text = |(reason, n): (&&str, &u64)| match plans.iter().find(|plan| plan.step(part).reason() == Some(reason)) {
        Some(plan) if part == PipelinePart::EveryCluster && plan.clusters().culled() > 0 => {
            CullStats::of(plans).describe()
        }
        _ => format!("{} × {reason}", format::count(*n)),
    };
    counts.iter().map(text).collect::<Vec<_>>().join(", ")
}
