//! The inspector panel on the right. It shows the picked pixel with an explanation of its colour, a diagram of the
//! sample in its triangle, the history of the pixel, and the numeric values of the selected fragment.

mod context;

mod diagram;

mod history;

mod numbers;

use eframe::egui::{self, Button, Color32, Label, RichText, ScrollArea, Sense, Ui, Vec2};

use self::diagram::{SampleLocation, triangle_diagram, weights};
use self::history::{Chosen, HistoryView};
use self::numbers::{absent_numbers, numbers};
use crate::image::Rgba8;
use crate::inspect::view::Value;
use crate::inspect::{FragmentRecord, PixelReport};
use crate::manual::Chapter;
use crate::ui::format;
use crate::ui::panels::{PanelContext, PanelSpec, PanelWidgets, framed, overlays, temporal};
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::picked_point::PointVisibility;
use crate::ui::session::{Session, checks, trace, watch, what_if};
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{copy_button, empty_state, section_header, swatch, value_row};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::InspectingAPixel,
    grows: false,
    titled: true,
    controls: None,
    content: |ui, cx| {
        let PanelContext { session, widgets: PanelWidgets { canvas, inspector, .. }, commands } = cx;
        framed(ui, |ui| inspector.ui(ui, session, canvas.hovered, commands));
    },
};

/// State of the inspector panel.
#[derive(Default)]
pub(crate) struct Inspector {
    history: HistoryView,
    of_pixel: Option<(u32, u32)>,
}

impl Inspector {
    /// Draws the inspector panel.
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        hovered: Option<(u32, u32)>,
        commands: &mut Vec<Command>,
    ) {
        hover_line(ui, session, hovered);
        overlays::readout::ui(ui, session, hovered);
        ui.separator();
        let report = session.view.as_ref().and_then(|view| view.report.as_deref());
        let Some(report) = report else {
            if session.point_visibility() == Some(PointVisibility::Outside) {
                let how = "It is explained again when it comes back into view. Click a pixel to pick another point.";
                empty_state(ui, Icon::Crosshair, "The picked point lies outside the picture", how);
            } else {
                let how = "Click a pixel in the picture to list every fragment and explain the result.";
                empty_state(ui, Icon::Crosshair, "No pixel picked", how);
            }
            return;
        };
        if self.of_pixel != Some((report.x, report.y)) {
            (self.of_pixel, self.history.chosen) = (Some((report.x, report.y)), violating(session, report));
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            headline(ui, report, commands);
            hidden_point(ui, session);
            let (fragment, absent) = match self.history.chosen {
                Some(Chosen::Absent(index)) => (None, report.absent.get(index)),
                Some(Chosen::Fragment(index)) => (report.fragments.get(index), None),
                None => (report.visible().or(report.fragments.first()), None),
            };
            ui.horizontal_top(|ui| {
                if let Some(view) = what_if::visible_view(ui, session) {
                    context::ui(ui, view, (report.x, report.y), commands);
                }
                if let Some(fragment) = fragment {
                    triangle_diagram(ui, fragment.corners_px, SampleLocation::Inside, report);
                }
                if let Some(corners_px) = absent.and_then(|absent| absent.corners_px) {
                    let is_outside = absent.is_some_and(|absent| absent.distance_px.is_some());
                    triangle_diagram(
                        ui,
                        corners_px,
                        if is_outside { SampleLocation::Outside } else { SampleLocation::Inside },
                        report,
                    );
                }
            });
            if let Some(fragment) = fragment {
                weights(ui, fragment);
            }
            self.history.ui(ui, session, report, commands);
            if let Some(fragment) = fragment {
                arithmetic_button(ui, report, fragment, commands);
            }
            temporal::ui(ui, session, commands);
            samples(ui, report);
            sources(ui, report, commands);
            if let Some(absent) = absent {
                absent_numbers(ui, absent);
            }
            if let Some(fragment) = fragment {
                numbers(ui, fragment);
                let help = "Save the visible triangle of this pixel as a case file in the current folder, to report \
                            it or to open it again";
                if ui.button("Save triangle as case file").on_hover_text(help).clicked() {
                    commands.push(Command::File(FileCommand::SaveCase));
                }
            }
        });
    }
}

/// Draws a button that shows a fragment in the panel “Calculation”.
fn arithmetic_button(ui: &mut Ui, report: &PixelReport, fragment: &FragmentRecord, commands: &mut Vec<Command>) {
    let Some(index) = report.fragments.iter().position(|other| std::ptr::eq(other, fragment)) else { return };
    let help = "Every step from the corners of the triangle to the pixel, with numbers and rounding errors";
    if ui.button("Show calculation").on_hover_text(help).clicked() {
        commands.push(Command::Trace(trace::TraceChange::Fragment(index)));
    }
}

/// Returns the fragment of the first violation that the assertions found; `None` if there is no violation or if it is
/// at another pixel.
fn violating(session: &Session, report: &PixelReport) -> Option<Chosen> {
    let (found, frame) = session.features.checks.found.as_ref()?;
    let (_, violation) = found.first_violation()?;
    let is_here = checks::place(violation, frame) == (report.x, report.y);
    let index = report.fragments.iter().position(|fragment| is_here && fragment.triangle == violation.triangle)?;
    Some(Chosen::Fragment(index))
}

/// Draws the position of the pixel under the pointer, and the value of the shown quantity at that pixel.
fn hover_line(ui: &mut Ui, session: &Session, hovered: Option<(u32, u32)>) {
    let here = hovered.and_then(|(x, y)| {
        let view = what_if::visible_view(ui, session)?;
        let color = view.picture.get(x, y)?;
        Some((x, y, color, view.value(x, y)))
    });
    ui.horizontal(|ui| {
        ui.set_height(theme::CONTROL_HEIGHT);
        ui.label(RichText::new("Pointer").color(tokens(ui).text_weak));
        if let Some((x, y, color, value)) = here {
            swatch(ui, to_color(color));
            ui.add(Label::new(RichText::new(format!("{x}, {y}   {}", one_line(value))).monospace()).truncate());
        } else {
            ui.label(RichText::new("–").monospace().color(tokens(ui).text_weak));
        }
    });
}

fn one_line(value: Value) -> String {
    match value {
        Value::NotDrawn => "not drawn".to_owned(),
        Value::Nothing => "no value".to_owned(),
        Value::Color(color) => codes(color),
        Value::Number(number) => format::f32_full(number),
        Value::Count(count) => format!("{count} ×"),
        Value::Weights([a, b, c]) => format!("{a:.4} {b:.4} {c:.4}"),
        Value::Triangle(id) => format!("triangle {}", id.0),
    }
}

fn to_color([r, g, b, _]: Rgba8) -> Color32 {
    Color32::from_rgb(r, g, b)
}

fn codes([r, g, b, _]: Rgba8) -> String {
    format!("{r} {g} {b}")
}

fn headline(ui: &mut Ui, report: &PixelReport, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(28.0), Sense::hover());
        ui.painter().rect_filled(rect, theme::RADIUS, to_color(report.color));
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.label(RichText::new(format!("Pixel {}, {}", report.x, report.y)).strong());
            ui.label(RichText::new(codes(report.color)).monospace().color(tokens(ui).text));
        });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            copy_button(ui, "everything about this pixel as JSON", || {
                serde_json::to_string_pretty(report).unwrap_or_default()
            });
            if crate::ui::widgets::icon_button(ui, Icon::Pin, "Watch this pixel  (Enter)").clicked() {
                commands.push(Command::Watch(watch::WatchChange::Add(report.x, report.y)));
            }
            if crate::ui::widgets::icon_button(ui, Icon::X, "Clear the selection  (Esc)").clicked() {
                commands.push(Command::Pick(None));
            }
        });
    });
    ui.add(Label::new(RichText::new(&report.verdict).color(tokens(ui).text_strong)).wrap().selectable(true));
    remedies(ui, report, commands);
    ui.add_space(theme::space::XS);
}

/// Draws a button for each remedy of the pixel.
fn remedies(ui: &mut Ui, report: &PixelReport, commands: &mut Vec<Command>) {
    if report.remedies.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        for remedy in &report.remedies {
            let button = Button::new((theme::icon(Icon::Wrench), remedy.label()));
            let help = format!("{}. Changes {}; Ctrl+Z undoes it", remedy.effect(), remedy.change());
            if ui.add(button).on_hover_text(help).clicked() {
                commands.push(Command::ApplyRemedy(*remedy));
            }
        }
    });
}

/// Draws a note if the pixel does not show the picked point because another surface hides it.
fn hidden_point(ui: &mut Ui, session: &Session) {
    if session.point_visibility() != Some(PointVisibility::Hidden) {
        return;
    }
    let Some(point) = &session.features.picking.point else { return };
    let object = session.scene.instances.get(point.instance).map_or("", |instance| &instance.name);
    let text = format!("The picked point, on triangle {} of “{object}”, is hidden here", point.triangle.0);
    let help = "The pick follows a point on a triangle. This pixel is at the place of the point, but its centre shows \
                another surface, or the triangle is not drawn";
    ui.add(Label::new(RichText::new(text).color(tokens(ui).warning)).wrap()).on_hover_text(help);
    ui.add_space(theme::space::XS);
}

/// Draws the colours of the samples that are averaged for an anti-aliased pixel, and the pixel's colour before the post
/// filter.
fn samples(ui: &mut Ui, report: &PixelReport) {
    if let Some(before) = report.unfiltered {
        section_header(ui, "Before the post filter", |_| {});
        swatch(ui, to_color(before));
    }
    if report.samples.is_empty() {
        return;
    }
    section_header(ui, &format!("Mean of {} samples", report.samples.len()), |_| {});
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::Vec2::splat(2.0);
        for sample in &report.samples {
            let [x, y] = sample.place;
            swatch(ui, to_color(sample.color)).on_hover_text(format!("Sample at {x:.3}, {y:.3} in the pixel"));
        }
    });
}

fn sources(ui: &mut Ui, report: &PixelReport, commands: &mut Vec<Command>) {
    let drawn_itself = report.sources.len() == 1 && report.drawn_at == [report.x, report.y];
    if drawn_itself {
        return;
    }
    section_header(ui, "Reconstructed from drawn pixels", |_| {});
    for source in &report.sources {
        ui.horizontal(|ui| {
            swatch(ui, to_color(source.color));
            let text = format!("{:>4}, {:<4}  {}", source.tap.x, source.tap.y, format::f32_full(source.tap.weight));
            let label = ui.add(Label::new(RichText::new(text).monospace()).sense(Sense::click()));
            if label.on_hover_text("Pick this pixel").clicked() {
                commands.push(Command::Pick(Some((source.tap.x, source.tap.y))));
            }
        });
    }
    let sum: f32 = report.sources.iter().map(|s| s.tap.weight).sum();
    value_row(
        ui,
        "Sum of weights",
        &format::f32_full(sum),
        "The weights sum to 1 to preserve the colour of flat areas",
    );
}
