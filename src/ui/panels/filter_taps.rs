//! Filter taps of the upscaler, in three parts: the samples from which the picked pixel was reconstructed, with their
//! weights, sum and clamping; the pixels that a sample contributes to; and the responses to an impulse, a step and a
//! zone plate.

use std::collections::BTreeSet;
use std::sync::{Arc, Weak};

use eframe::egui::{
    self, Align2, Color32, ColorImage, FontId, Rect, RichText, Role, ScrollArea, Sense, Stroke, StrokeKind,
    TextureHandle, TextureOptions, Ui, WidgetInfo, pos2, vec2,
};
use egui_plot::{HLine, Line, Plot, PlotPoints};

use crate::chain::Frame;
use crate::image::color::luma;
use crate::image::{Image, Rgba8};
use crate::inspect::feeds::{ContributingSample, Mixture, pixels_fed_by};
use crate::inspect::view::magnitude_color;
use crate::manual::Chapter;
use crate::measure::response::Responses;
use crate::ui::engine::RenderedView;
use crate::ui::format;
use crate::ui::panels::{PanelSpec, framed};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::theme::{Icon, ON_PIXEL, tokens};
use crate::ui::widgets::{empty_state, figure};
use crate::upscale::{FilterSpace, Upscaling};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::ComparingUpscalers,
    grows: false,
    titled: true,
    controls: None,
    content: |ui, cx| framed(ui, |ui| self::ui(ui, cx.session, cx.commands)),
};

/// Minimum and maximum side length of a cell in the grid of samples, in points.
const CELL: (f32, f32) = (16.0, 44.0);

/// Minimum side length of a grid cell in which its weight is shown, in points.
const WEIGHT_FROM: f32 = 30.0;

/// Width of each plot and of the two zone plate pictures, in points.
const PLOT: f32 = 190.0;

/// Samples from which the picked pixel was reconstructed, and the height of the diagrams that show them.
struct PickedMixture<'a> {
    view: &'a RenderedView,
    how: Upscaling,
    /// Picked pixel.
    at: (u32, u32),
    mixture: Mixture,
    /// Height of the diagrams, in points.
    height: f32,
}

/// Draws the panel “Filter taps” for the picked pixel.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    /// Height of the scroll bar at the bottom, in points.
    const BAR: f32 = 14.0;
    let height = (ui.available_height() - BAR).max(40.0);
    let picked = session.view.as_ref().and_then(|view| {
        let how = view.request.recipe.upscaler;
        let at = session.pick?;
        Some(PickedMixture { view, how, at, mixture: Mixture::of(&view.frame, how, at)?, height })
    });
    let Some(picked) = picked else {
        let how =
            "Click a pixel of the picture to list the samples that it was reconstructed from, with their weights.";
        ui.set_min_height(ui.available_height());
        empty_state(ui, Icon::ScanSearch, "No pixel picked", how);
        return;
    };
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            let hovered = ui.vertical(|ui| picked.sources(ui)).inner;
            ui.separator();
            let sample = hovered.or_else(|| heaviest(&picked.mixture));
            ui.vertical(|ui| {
                if let Some(sample) = sample {
                    picked.feeds(ui, sample, commands);
                }
            });
            ui.separator();
            ui.vertical(|ui| picked.sums(ui));
            ui.separator();
            responses(ui, picked.how, height);
        });
    });
}

fn heaviest(mixture: &Mixture) -> Option<(u32, u32)> {
    let weight = |source: &&ContributingSample| source.tap.weight;
    let heaviest = mixture.sources.iter().max_by(|a, b| weight(a).total_cmp(&weight(b)))?;
    Some((heaviest.tap.x, heaviest.tap.y))
}

fn heading(ui: &mut Ui, text: &str, help: &str) {
    ui.label(RichText::new(text).small().color(tokens(ui).text_weak)).on_hover_text(help);
}

/// Returns the distinct `values` in ascending order. The index of a value is its column or row in a grid without gaps.
fn ranks(values: impl Iterator<Item = u32>) -> Vec<u32> {
    values.collect::<BTreeSet<_>>().into_iter().collect()
}

fn cell_of(columns: usize, rows: usize, height: f32) -> f32 {
    let room = (height - 24.0) / rows.max(1) as f32;
    room.min(260.0 / columns.max(1) as f32).clamp(CELL.0, CELL.1).floor()
}

impl PickedMixture<'_> {
    /// Draws the samples from which the picked pixel was reconstructed, arranged by position. Returns the sample under
    /// the pointer.
    fn sources(&self, ui: &mut Ui) -> Option<(u32, u32)> {
        let Self { how, at, ref mixture, height, .. } = *self;
        let title =
            format!("Pixel {}, {} · {} · {}", at.0, at.1, how.label(), counted(mixture.sources.len(), "sample"));
        heading(ui, &title, "Drawn samples from which this pixel was reconstructed, with their weights");
        let columns = ranks(mixture.sources.iter().map(|source| source.tap.x));
        let rows = ranks(mixture.sources.iter().map(|source| source.tap.y));
        let cell = cell_of(columns.len(), rows.len(), height);
        let (area, _) = ui.allocate_exact_size(vec2(columns.len() as f32, rows.len() as f32) * cell, Sense::hover());
        let mut hovered = None;
        for source in &mixture.sources {
            let place = |ranks: &[u32], value: u32| ranks.binary_search(&value).unwrap_or(0) as f32;
            let min = area.min + vec2(place(&columns, source.tap.x), place(&rows, source.tap.y)) * cell;
            let rect = Rect::from_min_size(min, egui::Vec2::splat(cell - 1.0));
            let [r, g, b, _] = source.color;
            ui.painter().rect_filled(rect, 1.0, Color32::from_rgb(r, g, b));
            let ink = ON_PIXEL[usize::from(luma(source.color) >= 128.0)];
            if cell >= WEIGHT_FROM {
                let text = format::fixed(f64::from(source.tap.weight), 3);
                ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, FontId::monospace(10.0), ink);
            }
            let id = ui.scope_id().with(("source", source.tap.x, source.tap.y));
            let response = ui.interact(rect, id, Sense::hover());
            let words = format!("Sample {}, {}: weight {}", source.tap.x, source.tap.y, source.tap.weight);
            response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &words));
            if response.hovered() {
                hovered = Some((source.tap.x, source.tap.y));
                ui.painter().rect_stroke(rect, 1.0, Stroke::new(2.0, tokens(ui).accent), StrokeKind::Inside);
            }
            response.on_hover_text(format!("{words}\nsRGB codes {r} {g} {b}"));
        }
        hovered
    }

    /// Draws the full-resolution pixels that a sample contributes to. A click picks one of them.
    fn feeds(&self, ui: &mut Ui, sample: (u32, u32), commands: &mut Vec<Command>) {
        let fed = known_fed(ui, self.view, self.how, sample);
        let title = format!("Sample {}, {} contributes to {}", sample.0, sample.1, counted(fed.len(), "pixel"));
        heading(
            ui,
            &title,
            "Weight of this sample in each pixel: brighter is greater, and a dot marks a negative weight. Hover over \
             another sample on the left to show its pixels",
        );
        let (columns, rows) = (ranks(fed.iter().map(|(at, _)| at.0)), ranks(fed.iter().map(|(at, _)| at.1)));
        let room = (self.height - 24.0) / rows.len().max(1) as f32;
        let cell = room.clamp(3.0, CELL.0);
        let (area, response) = ui.allocate_exact_size(
            vec2((columns.len() as f32 * cell).max(150.0), rows.len() as f32 * cell),
            Sense::click(),
        );
        let most = fed.iter().map(|(_, weight)| weight.abs()).fold(f32::MIN_POSITIVE, f32::max);
        let pointer = response.hover_pos();
        for ((x, y), weight) in fed.iter() {
            let place = |ranks: &[u32], value: u32| ranks.binary_search(&value).unwrap_or(0) as f32;
            let min = area.min + vec2(place(&columns, *x), place(&rows, *y)) * cell;
            let rect = Rect::from_min_size(min, egui::Vec2::splat(cell));
            let [r, g, b, _] = magnitude_color(weight.abs() / most);
            ui.painter().rect_filled(rect, 0.0, Color32::from_rgb(r, g, b));
            if *weight < 0.0 {
                ui.painter().circle_filled(rect.center(), cell * 0.18, tokens(ui).b);
            }
            if (*x, *y) == self.at {
                ui.painter().rect_stroke(rect, 0.0, Stroke::new(1.5, tokens(ui).accent), StrokeKind::Inside);
            }
            if pointer.is_some_and(|at| rect.contains(at)) {
                let words = format!("Pixel {x}, {y}: weight {weight}");
                response.clone().on_hover_text(words);
                if response.clicked() {
                    commands.push(Command::Pick(Some((*x, *y))));
                }
            }
        }
    }

    /// Draws the sum of the weights, the weighted sum of the colours, and the effect of clamping and rounding.
    fn sums(&self, ui: &mut Ui) {
        const COLUMN: f32 = 66.0;
        let Self { how, ref mixture, height, .. } = *self;
        let what = if how.light() == FilterSpace::Linear { "linear light" } else { "sRGB codes" };
        heading(ui, &format!("Weighted sum of {what}"), "Weighted sum of all samples, for red, green and blue");
        ScrollArea::vertical().id_salt("weights").max_height((height - 20.0).max(60.0)).show(ui, |ui| {
            egui::Grid::new("sums").num_columns(4).spacing([6.0, 1.0]).show(ui, |ui| {
                let mut line = |name: &str, values: [String; 3], strong: bool| {
                    let color = if strong { tokens(ui).text_strong } else { tokens(ui).text };
                    ui.label(RichText::new(name).small().color(tokens(ui).text_weak));
                    values.iter().for_each(|value| {
                        figure(ui, value, COLUMN, color);
                    });
                    ui.end_row();
                };
                let codes = |values: [f64; 3]| values.map(|value| format::fixed(value, 3));
                line("Σ weights", [format::fixed(mixture.weight, 6), String::new(), String::new()], false);
                line("Σ weight · colour", codes(mixture.sum), false);
                line("clamped to 0…255", codes(mixture.clamped()), false);
                let [r, g, b, _] = mixture.pixel;
                line("pixel", [r, g, b].map(|code| code.to_string()), true);
            });
            let clamps = mixture.sum != mixture.clamped();
            let differs = |(sum, code): (&f64, u8)| (sum - f64::from(code)).abs() > 2.0;
            let far = mixture.clamped().iter().zip(mixture.pixel).any(differs);
            let note = match (clamps, far) {
                _ if mixture.uses_history => {
                    "These are the samples of the current frame. The rest of the pixel comes from the history of \
                     earlier frames."
                }
                (_, true) => "The upscaler also clamps the result to the range of the nearest samples, or sharpens it.",
                (true, false) => "The sum was outside 0…255 and was clamped.",
                (false, false) => "The sum was within 0…255, so it was not clamped.",
            };
            ui.add(egui::Label::new(RichText::new(note).small().color(tokens(ui).text_weak)).wrap());
        });
    }
}

/// Formats a count with its noun, which is in the plural unless the count is 1.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Pixels that a sample contributes to, each with the weight of the sample in that pixel.
type FedPixels = Arc<[((u32, u32), f32)]>;

/// Cache of the pixels that a sample contributes to. Finding them visits all surrounding pixels, which is too slow to
/// do in every pass.
#[derive(Clone)]
struct FedPixelCache {
    frame: Weak<Frame>,
    how: Upscaling,
    sample: (u32, u32),
    fed: FedPixels,
}

fn known_fed(ui: &Ui, view: &RenderedView, how: Upscaling, sample: (u32, u32)) -> FedPixels {
    let id = egui::Id::unique("pixels that the sample feeds");
    let frame = Arc::downgrade(&view.frame);
    let is_same = |known: &FedPixelCache| known.frame.ptr_eq(&frame) && (known.how, known.sample) == (how, sample);
    if let Some(known) = ui.data(|data| data.get_temp::<FedPixelCache>(id)).filter(is_same) {
        return known.fed;
    }
    let fed: FedPixels = pixels_fed_by(&view.frame, how, sample).into();
    ui.data_mut(|data| data.insert_temp(id, FedPixelCache { frame, how, sample, fed: fed.clone() }));
    fed
}

/// Cached responses of an upscaler to test signals, with its zone plates as textures.
#[derive(Clone)]
struct ResponseCache {
    how: Upscaling,
    responses: Arc<Responses>,
    plates: [TextureHandle; 2],
}

fn known(ui: &Ui, how: Upscaling) -> ResponseCache {
    let id = egui::Id::unique("responses of the upscaler");
    if let Some(known) = ui.data(|data| data.get_temp::<ResponseCache>(id)).filter(|known| known.how == how) {
        return known;
    }
    let responses = Responses::of(how);
    let texture = |name: &str, picture: &Image<Rgba8>| {
        let (width, height) = picture.size();
        let image = ColorImage::from_rgba_premultiplied([width as usize, height as usize], picture.as_bytes());
        ui.ctx().load_texture(name, image, TextureOptions::NEAREST)
    };
    let plates =
        [texture("zone plate", &responses.zone_plate), texture("native zone plate", &responses.zone_plate_native)];
    let known = ResponseCache { how, responses: Arc::new(responses), plates };
    ui.data_mut(|data| data.insert_temp(id, known.clone()));
    known
}

fn responses(ui: &mut Ui, how: Upscaling, height: f32) {
    let ResponseCache { responses, plates, .. } = known(ui, how);
    let (low, high) = responses.overshoot();
    let overshoot =
        format!("Step: undershoot {}, overshoot {}", format::percent(0.0 - low), format::percent(high - 1.0));
    curve(ui, "Impulse", "Response to one bright sample among dark ones, along its row", &responses.impulse, height);
    curve(
        ui,
        &overshoot,
        "Response to a step from dark (0) to bright (1): values outside 0…1 are ringing",
        &responses.step,
        height,
    );
    let side = (height - 24.0).clamp(48.0, PLOT);
    let names = ["Zone plate", "Native"];
    for (texture, name) in plates.iter().zip(names) {
        ui.vertical(|ui| {
            ui.set_min_width(side);
            heading(
                ui,
                name,
                "Concentric rings, as fine as 2 px at the border. Rings around other centres are aliasing",
            );
            let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::hover());
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture.id(), rect, uv, Color32::WHITE);
            response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
        });
    }
}

fn curve(ui: &mut Ui, title: &str, help: &str, points: &[[f64; 2]], height: f32) {
    ui.vertical(|ui| {
        heading(ui, title, help);
        let color = tokens(ui).series[0];
        let weak = tokens(ui).border;
        Plot::new(("response", help))
            .width(PLOT)
            .height((height - 24.0).max(48.0))
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false)
            .include_y(-0.2)
            .include_y(1.2)
            .show(ui, |plot| {
                plot.hline(HLine::new("0", 0.0).color(weak));
                plot.hline(HLine::new("1", 1.0).color(weak));
                plot.line(Line::new(title, PlotPoints::from(points.to_vec())).color(color).width(1.5));
            });
    });
}
