//! Legend of the stability probe's heat map.

use eframe::egui::Ui;

use crate::inspect::probe::map_color;
use crate::ui::legend::{ScaleLegend, note};
use crate::ui::session::probe::ProbeState;

/// Draws the legend: the colours of the numbers of runs in which a pixel changed.
pub(crate) fn legend(ui: &mut Ui, probing: &ProbeState) {
    let (Some(found), Some((_, most))) = (&probing.found, &probing.picture) else { return };
    if *most == 0 {
        note(ui, &format!("nothing changed in {} runs", found.findings.probe.runs));
        return;
    }
    let ends = ["changed in 1 run".to_owned(), format!("in {most} of {} runs", found.findings.probe.runs)];
    ScaleLegend { ends }.ui(ui, map_color);
}
