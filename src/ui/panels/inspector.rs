//! The picked pixel at the right: what it shows and why, where the sample lies in its triangle, every fragment that touched
//! it, and the numbers of the chosen one.

use eframe::egui::{self, Align2, Color32, FontId, Label, Pos2, RichText, ScrollArea, Sense, Stroke, Ui, Vec2, vec2};

use crate::image::Rgba8;
use crate::inspect::pixel::{ShadingRecord, sample_position_px};
use crate::inspect::view::Value;
use crate::inspect::{DepthRecord, FragmentRecord, Outcome, PixelReport};
use crate::pipeline::settings::Arithmetic;
use crate::scene::Transparency;
use crate::ui::command::Command;
use crate::ui::format;
use crate::ui::overlays;
use crate::ui::panels::bottom::Tab;
use crate::ui::session::Session;
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::trace;
use crate::ui::watch;
use crate::ui::what_if;
use crate::ui::widgets::{Status, chip, copy_button, empty_state, section_header, swatch, value_row};

/// What a step of the depth buffer is.
const STEP_HELP: &str = "World units along the line of sight between the fragment's depth and the next that the buffer can \
                         hold: surfaces closer than that may fight";

/// Fragments listed from the first and from the last one on; a pixel may have ten thousand.
const LISTED_AT_AN_END: usize = 50;

/// Which fragment of the list is explained; the visible one if none was chosen.
#[derive(Default)]
pub struct Inspector {
    chosen: Option<usize>,
    of_pixel: Option<(u32, u32)>,
}

impl Inspector {
    /// Draws the panel.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, hovered: Option<(u32, u32)>, commands: &mut Vec<Command>) {
        hover_line(ui, session, hovered);
        overlays::readout::ui(ui, session, hovered);
        ui.separator();
        let report = session.view.as_ref().and_then(|view| view.report.as_deref());
        let Some(report) = report else {
            empty_state(
                ui,
                Icon::Crosshair,
                "No pixel is picked",
                "Click one in the picture: its whole story appears here.",
            );
            return;
        };
        if self.of_pixel != Some((report.x, report.y)) {
            (self.of_pixel, self.chosen) = (Some((report.x, report.y)), None);
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            headline(ui, report, commands);
            let explained = self.chosen.and_then(|i| report.fragments.get(i)).or_else(|| report.visible());
            let explained = explained.or(report.fragments.first());
            if let Some(fragment) = explained {
                triangle_diagram(ui, fragment, report);
                weights(ui, fragment);
            }
            self.fragments(ui, report);
            if let Some(fragment) = explained {
                arithmetic_button(ui, report, fragment, commands);
            }
            samples(ui, report);
            sources(ui, report, commands);
            if let Some(fragment) = explained {
                numbers(ui, fragment);
                let help = "Writes the triangle that this pixel shows into a case file in the current folder: the smallest \
                            thing to report, or to open again";
                if ui.button("Save triangle as case").on_hover_text(help).clicked() {
                    commands.push(Command::SaveCase);
                }
            }
        });
    }

    fn fragments(&mut self, ui: &mut Ui, report: &PixelReport) {
        section_header(ui, &format!("Fragments ({})", report.fragments.len()), |_| {});
        if report.fragments.is_empty() {
            ui.label(RichText::new("No triangle covers this pixel's centre.").color(tokens(ui).text_weak));
        }
        let count = report.fragments.len();
        for (index, fragment) in report.fragments.iter().enumerate() {
            if count > 2 * LISTED_AT_AN_END && (LISTED_AT_AN_END..count - LISTED_AT_AN_END).contains(&index) {
                if index == LISTED_AT_AN_END {
                    let left_out = count - 2 * LISTED_AT_AN_END;
                    ui.weak(format!("… {} more, all in the copied JSON …", format::count(left_out as u64)));
                }
                continue;
            }
            let chosen = self.chosen.map_or(fragment.outcome == Outcome::Visible, |c| c == index);
            if fragment_row(ui, fragment, chosen) {
                self.chosen = Some(index);
            }
        }
    }
}

/// A button that writes out the arithmetic of a fragment.
fn arithmetic_button(ui: &mut Ui, report: &PixelReport, fragment: &FragmentRecord, commands: &mut Vec<Command>) {
    let Some(index) = report.fragments.iter().position(|other| std::ptr::eq(other, fragment)) else { return };
    let help = "Every step from the corners of the triangle to the pixel, with the numbers and what each step rounded";
    if ui.button("Write out its arithmetic").on_hover_text(help).clicked() {
        commands.push(Command::Trace(trace::Change::Fragment(index)));
    }
}

/// What the shown buffer holds under the pointer.
fn hover_line(ui: &mut Ui, session: &Session, hovered: Option<(u32, u32)>) {
    let here = hovered.and_then(|(x, y)| {
        let view = what_if::seen(ui, session)?;
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
        Value::Nothing => "nothing".to_owned(),
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
                commands.push(Command::Watch(watch::Change::Add(report.x, report.y)));
                commands.push(Command::OpenTab(Tab::Watch));
            }
            if crate::ui::widgets::icon_button(ui, Icon::X, "Drop the pick  (Esc)").clicked() {
                commands.push(Command::Pick(None));
            }
        });
    });
    ui.add(Label::new(RichText::new(&report.verdict).color(tokens(ui).text_strong)).wrap().selectable(true));
    ui.add_space(theme::space::XS);
}

/// The triangle on the screen with the sample in it; sub-triangles in the colours of their weights.
fn triangle_diagram(ui: &mut Ui, fragment: &FragmentRecord, report: &PixelReport) {
    const HEIGHT: f32 = 132.0;
    let (response, painter) = ui.allocate_painter(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let frame = response.rect;
    painter.rect_filled(frame, theme::RADIUS, tokens(ui).canvas);
    let corners = fragment.corners_px.map(|[x, y]| vec2(x, y));
    let [x, y] = sample_position_px(report.drawn_at[0], report.drawn_at[1]);
    let low = corners[0].min(corners[1]).min(corners[2]);
    let high = corners[0].max(corners[1]).max(corners[2]);
    let inner = frame.shrink(22.0);
    let extent = (high - low).max(Vec2::splat(1e-3));
    let scale = (inner.width() / extent.x).min(inner.height() / extent.y);
    let offset = inner.center() - (low + high) * 0.5 * scale;
    let place = |p: Vec2| -> Pos2 { offset + p * scale };
    let (sample, corners) = (place(vec2(x, y)), corners.map(place));
    for (i, color) in theme::WEIGHTS.into_iter().enumerate() {
        let part = vec![corners[(i + 1) % 3], corners[(i + 2) % 3], sample];
        painter.add(egui::Shape::convex_polygon(part, color.gamma_multiply(0.45), Stroke::NONE));
    }
    painter.add(egui::Shape::closed_line(corners.to_vec(), Stroke::new(1.0, tokens(ui).text)));
    for (i, corner) in corners.into_iter().enumerate() {
        painter.line_segment([sample, corner], Stroke::new(1.0, tokens(ui).text_weak.gamma_multiply(0.5)));
        let outward = (corner - corners_center(&corners)).normalized() * 11.0;
        painter.circle_filled(corner, 2.5, theme::WEIGHTS[i]);
        painter.text(
            corner + outward,
            Align2::CENTER_CENTER,
            format!("v{i}"),
            FontId::monospace(11.0),
            tokens(ui).text,
        );
    }
    painter.circle(sample, 3.5, tokens(ui).accent, Stroke::new(1.0, Color32::BLACK));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Barycentric diagram"));
    response.on_hover_text("The triangle on the screen and the pixel's centre in it. The area opposite to a corner, over the whole area, is that corner's weight λ");
}

fn corners_center(corners: &[Pos2; 3]) -> Pos2 {
    ((corners[0].to_vec2() + corners[1].to_vec2() + corners[2].to_vec2()) / 3.0).to_pos2()
}

fn weights(ui: &mut Ui, fragment: &FragmentRecord) {
    egui::Grid::new("weights").num_columns(3).spacing([12.0, 2.0]).min_col_width(92.0).show(ui, |ui| {
        ui.label("");
        for (heading, help) in [
            ("λ on screen", "Area opposite to the corner over the whole area, on the screen"),
            ("λ in space", "The weight that attributes are interpolated with: λ/w over the sum of all three, unless interpolation is affine"),
        ] {
            ui.label(RichText::new(heading).small().color(tokens(ui).text_weak)).on_hover_text(help);
        }
        ui.end_row();
        for (i, color) in theme::WEIGHTS.into_iter().enumerate() {
            ui.label(RichText::new(format!("λ{i}")).monospace().color(color));
            for value in [fragment.affine_weights[i], fragment.attribute_weights[i]] {
                ui.label(RichText::new(format::f32_full(value)).monospace()).on_hover_text(format::bits(value));
            }
            ui.end_row();
        }
    });
}

/// One fragment; true when clicked.
fn fragment_row(ui: &mut Ui, fragment: &FragmentRecord, chosen: bool) -> bool {
    let (status, word) = match fragment.outcome {
        Outcome::Visible => (Status::Passed, "visible"),
        Outcome::Overwritten => (Status::Neutral, "overwritten"),
        Outcome::BlendedOver => (Status::Passed, "seen through"),
        Outcome::DepthRejected => (Status::Rejected, "rejected"),
        Outcome::CutOut => (Status::Rejected, "cut out"),
    };
    let fill = if chosen { tokens(ui).raised } else { Color32::TRANSPARENT };
    let frame = egui::Frame::new().fill(fill).corner_radius(theme::RADIUS).inner_margin(4);
    let response = frame
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.horizontal(|ui| {
                chip(ui, status, word, "");
                let title = format!("{} “{}”", fragment.triangle.0, fragment.instance);
                ui.add(Label::new(RichText::new(title).strong()).truncate());
            });
            ui.add(Label::new(RichText::new(&fragment.reason).small().color(tokens(ui).text)).wrap());
        })
        .response
        .interact(Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(
            egui::Role::Button,
            true,
            chosen,
            format!("Fragment of triangle {}", fragment.triangle.0),
        )
    });
    response.on_hover_text("Click to see its numbers").clicked()
}

/// What the pixel is the mean of, if it has several samples, and what it was before the filter over the picture.
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
            swatch(ui, to_color(sample.color)).on_hover_text(format!("at {x:.3}, {y:.3} in the pixel"));
        }
    });
}

fn sources(ui: &mut Ui, report: &PixelReport, commands: &mut Vec<Command>) {
    let drawn_itself = report.sources.len() == 1 && report.drawn_at == [report.x, report.y];
    if drawn_itself {
        return;
    }
    section_header(ui, "Mixed from drawn pixels", |_| {});
    for source in &report.sources {
        ui.horizontal(|ui| {
            swatch(ui, to_color(source.color));
            let text = format!("{:>4}, {:<4}  {}", source.tap.x, source.tap.y, format::f32_full(source.tap.weight));
            let label = ui.add(Label::new(RichText::new(text).monospace()).sense(Sense::click()));
            if label.on_hover_text("Go to this pixel").clicked() {
                commands.push(Command::Pick(Some((source.tap.x, source.tap.y))));
            }
        });
    }
    let sum: f32 = report.sources.iter().map(|s| s.tap.weight).sum();
    value_row(ui, "Sum of weights", &format::f32_full(sum), "One, so that a flat area keeps its colour");
}

fn numbers(ui: &mut Ui, fragment: &FragmentRecord) {
    section_header(ui, "Depth", |_| {});
    depth_rows(ui, "Depth of the fragment", fragment.depth, "As it is stored if the fragment wins");
    match fragment.stored_depth {
        Some(stored) => {
            depth_rows(ui, "Stored before", stored, "What the depth buffer held when this fragment came");
            let step = format::f32_full(fragment.depth.resolution as f32);
            value_row(ui, "One step here", &step, STEP_HELP);
        }
        None => {
            value_row(ui, "Stored before", "–", "There is no depth test, so nothing is stored");
        }
    }
    section_header(ui, "Corners", |_| {});
    corner_table(ui, fragment);
    section_header(ui, "Edges", |_| {});
    let (exact, unit) = match fragment.arithmetic {
        Arithmetic::Fixed => ("Exact edge value in 1/65536 px²", "The sum of the three edge values, exactly"),
        Arithmetic::Exact => {
            ("Edge value in px² times a power of two; its sign is exact", "The sum of the three, but for rounding")
        }
        Arithmetic::F32 | Arithmetic::F64 => {
            ("Edge value in px² times a power of two, rounded", "The sum of the three, but for rounding")
        }
    };
    for (i, edge) in fragment.edges.into_iter().enumerate() {
        let help = format!("{exact}: above zero is inside, zero lies on the edge");
        value_row(ui, &format!("Opposite to v{i}"), &format::edge(edge), &help);
    }
    value_row(ui, "Doubled area", &format::edge(fragment.doubled_area), unit);
    let triangle = fragment.triangle.0.to_string();
    value_row(ui, "Triangle", &triangle, "Its number in the scene, in drawing order, counted from 0");
    value_row(
        ui,
        "Rasterized as",
        &(fragment.submission + 1).to_string(),
        "Where the triangle slider must stand for this fragment to be there",
    );
    if let Some(alpha) = fragment.alpha {
        let help = if fragment.transparency == Transparency::Blended {
            "The share with which the fragment covers what lies behind: opacity × alpha of the texture"
        } else {
            "Alpha of the texture; below one half the surface is not there"
        };
        section_header(ui, "Transparency", |_| {});
        float_row(ui, "Alpha", alpha, help);
    }
    if let Some(shading) = &fragment.shading {
        shading_numbers(ui, shading);
    }
}

/// A depth, and the code that the buffer holds for it if it holds codes.
fn depth_rows(ui: &mut Ui, label: &str, depth: DepthRecord, help: &str) {
    float_row(ui, label, depth.value, help);
    if let Some(code) = depth.code {
        value_row(ui, "… as a code", &code.to_string(), "The whole number that the buffer holds for it");
    }
}

fn float_row(ui: &mut Ui, label: &str, value: f32, help: &str) {
    value_row(ui, label, &format::f32_full(value), &format!("{help}. Bits: {}", format::bits(value)));
}

fn corner_table(ui: &mut Ui, fragment: &FragmentRecord) {
    egui::Grid::new("corners").num_columns(5).spacing([8.0, 2.0]).show(ui, |ui| {
        for heading in ["", "x px", "y px", "depth", "1/w"] {
            ui.label(RichText::new(heading).small().color(tokens(ui).text_weak));
        }
        ui.end_row();
        for (i, color) in theme::WEIGHTS.into_iter().enumerate() {
            ui.label(RichText::new(format!("v{i}")).monospace().color(color));
            let [x, y] = fragment.corners_px[i];
            let texts = [
                format::fixed(f64::from(x), 3),
                format::fixed(f64::from(y), 3),
                format::fixed(f64::from(fragment.corner_depths[i]), 5),
                format!("{:.3e}", fragment.inv_w[i]),
            ];
            for text in texts {
                ui.label(RichText::new(text).monospace());
            }
            ui.end_row();
        }
    });
}

fn shading_numbers(ui: &mut Ui, shading: &ShadingRecord) {
    section_header(ui, "Shading", |_| {});
    if let Some([u, v]) = shading.uv {
        value_row(ui, "Texture coordinates", &format!("{u:.6}  {v:.6}"), "u to the right, v down");
    }
    if let Some([x, y, z]) = shading.normal {
        value_row(ui, "Normal", &format!("{x:.3} {y:.3} {z:.3}"), "Unit normal, world space");
    }
    if let Some(cosine) = shading.cosine {
        float_row(ui, "N·L", cosine, "Cosine between normal and light");
    }
    if let Some(light) = shading.light {
        float_row(ui, "Light", light, "The factor that light multiplies the colour with");
    }
    for texel in &shading.texels {
        ui.horizontal(|ui| {
            swatch(ui, to_color(texel.color));
            let level = if texel.level > 0 { format!("level {} ", texel.level) } else { String::new() };
            let place = format!("{:>4}, {:<4}", texel.tap.x, texel.tap.y);
            let text = format!("{level}texel {place}  {}", format::f32_full(texel.tap.weight));
            ui.label(RichText::new(text).monospace());
        });
    }
    if let Some(below) = shading.below {
        ui.horizontal(|ui| {
            swatch(ui, to_color(below));
            ui.label(RichText::new(format!("over     {}", codes(below))).monospace());
        });
    }
    ui.horizontal(|ui| {
        swatch(ui, to_color(shading.color));
        ui.label(RichText::new(format!("written  {}", codes(shading.color))).monospace());
    });
}
