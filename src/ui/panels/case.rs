//! A case file on the canvas: the pixels that the engine draws beside those that exact arithmetic says, large, and how they
//! differ. The rasterizer and the arithmetic are those of the recipe.

use std::sync::Arc;

use eframe::egui::{
    Align2, Color32, ColorImage, FontId, Label, Pos2, Rect, RichText, Role, ScrollArea, Sense, Stroke, TextureHandle,
    TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use crate::case::{Case, Options};
use crate::report::comparison::{Agreement, Comparison, parts};
use crate::ui::command::Command;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, font_size, space, tokens};
use crate::ui::widgets::{combo, icon_button};

/// Screen points that a pixel must have for the grid to be drawn.
const GRID_FROM: f32 = 7.0;

/// Largest screen points per pixel.
const LARGEST_PIXEL: f32 = 64.0;

/// Neither covers the pixel.
const OUTSIDE: Color32 = Color32::from_rgb(0x22, 0x25, 0x2B);

/// Both cover it.
const COVERED: Color32 = Color32::from_rgb(0xB9, 0xC3, 0xD2);

/// The engine alone covers it: orange, told from blue by everybody.
const EXTRA: Color32 = Color32::from_rgb(0xF5, 0x8A, 0x1F);

/// The exact answer alone covers it.
const MISSING: Color32 = Color32::from_rgb(0x2F, 0x7D, 0xF6);

/// A case that is open, and what it was last compared with.
#[derive(Default)]
pub struct CaseView {
    shown: Option<Shown>,
    /// Which of the wrong pixels the view was moved to.
    visited: Option<usize>,
    /// Points per pixel and the pixel in the middle; fitted if none.
    view: Option<(f32, Vec2)>,
}

/// What one comparison gave, as pictures.
struct Shown {
    key: (Arc<Case>, usize, Options),
    comparison: Result<Comparison, String>,
    wrong: Vec<(u32, u32)>,
    ours: Option<TextureHandle>,
    exact: Option<TextureHandle>,
}

impl CaseView {
    /// Draws the case that the session has open.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
        let Some(open) = &session.case else { return };
        let settings = &session.state.recipe.pipeline;
        let options = Options { rasterizer: settings.rasterizer, arithmetic: settings.arithmetic };
        let key = (open.case.clone(), open.part, options);
        let same_case = self.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(&shown.key.0, &key.0));
        if !same_case {
            self.view = None;
        }
        if !same_case || self.shown.as_ref().is_some_and(|shown| (shown.key.1, shown.key.2) != (key.1, key.2)) {
            self.shown = Some(Shown::new(ui, key));
            self.visited = None;
        }
        ui.add_space(space::XS);
        ui.horizontal_wrapped(|ui| {
            ui.add_space(space::S);
            self.bar(ui, session, &open.case, open.part, commands);
        });
        let Some(shown) = &self.shown else { return };
        match &shown.comparison {
            Err(reason) => {
                ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                    ui.add(Label::new(RichText::new(reason).monospace().color(tokens(ui).text)).extend());
                });
            }
            Ok(comparison) => pictures(ui, shown, comparison, &mut self.view),
        }
    }

    fn bar(&mut self, ui: &mut Ui, session: &Session, case: &Case, part: usize, commands: &mut Vec<Command>) {
        if icon_button(ui, Icon::X, "Close the case (Esc)").clicked() {
            commands.push(Command::CloseCase);
        }
        ui.label(RichText::new(&case.id).strong());
        let parts = parts(case);
        if parts > 1 {
            if icon_button(ui, Icon::ChevronLeft, "Triangle before").clicked() {
                commands.push(Command::ShowPart(part.saturating_sub(1)));
            }
            ui.label(format!("triangle {} of {parts}", part + 1));
            if icon_button(ui, Icon::ChevronRight, "Triangle after").clicked() {
                commands.push(Command::ShowPart((part + 1).min(parts - 1)));
            }
        }
        let mut recipe = session.state.recipe;
        choose(ui, "Rasterizer of the case", &mut recipe.pipeline.rasterizer);
        choose(ui, "Arithmetic of the case", &mut recipe.pipeline.arithmetic);
        if recipe != session.state.recipe {
            commands.push(Command::SetRecipe(recipe));
        }
        let Some(shown) = &self.shown else { return };
        let Ok(comparison) = &shown.comparison else { return };
        if comparison.exact.is_none() {
            let text = format!("{} pixels; no second answer in the program for this kind", comparison.covered());
            ui.add(Label::new(RichText::new(text).color(tokens(ui).text_weak)).truncate());
            return;
        }
        let text = format!("{} of {} pixels differ", shown.wrong.len(), comparison.concerned());
        let color = if shown.wrong.is_empty() { tokens(ui).passed } else { tokens(ui).warning };
        ui.label(RichText::new(text).color(color).strong());
        if !shown.wrong.is_empty() {
            let count = shown.wrong.len();
            let before = icon_button(ui, Icon::ArrowLeft, "Differing pixel before").clicked();
            let after = icon_button(ui, Icon::ArrowRight, "Next differing pixel").clicked();
            if before || after {
                let next = match (self.visited, before) {
                    (None, _) => 0,
                    (Some(at), true) => (at + count - 1) % count,
                    (Some(at), false) => (at + 1) % count,
                };
                self.visited = Some(next);
                let (x, y) = shown.wrong[next];
                let scale = self.view.map_or(24.0, |(scale, _)| scale.max(16.0));
                self.view = Some((scale, vec2(x as f32 + 0.5, y as f32 + 0.5)));
            }
        }
    }
}

fn choose<C: crate::pipeline::settings::Choice>(ui: &mut Ui, name: &str, value: &mut C) {
    let list = combo(name, value.name(), 112.0).show_ui(ui, |ui| {
        for choice in C::ALL {
            ui.selectable_value(value, *choice, choice.name()).on_hover_text(choice.help());
        }
    });
    list.response.on_hover_text(name).widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
}

impl Shown {
    fn new(ui: &Ui, key: (Arc<Case>, usize, Options)) -> Self {
        let comparison = Comparison::new(&key.0, key.1, key.2);
        let (mut ours, mut exact, mut wrong) = (None, None, Vec::new());
        if let Ok(comparison) = &comparison {
            wrong = comparison.wrong();
            ours = Some(texture(ui, "case, ours", comparison, |c, x, y| match c.agreement(x, y) {
                Agreement::Outside | Agreement::Missing => OUTSIDE,
                Agreement::Covered => OUTSIDE.lerp_to_gamma(COVERED, c.ours.at(x, y)),
                Agreement::Extra => EXTRA,
            }));
            exact = comparison.exact.as_ref().map(|_| {
                texture(ui, "case, exact", comparison, |c, x, y| match c.agreement(x, y) {
                    Agreement::Outside | Agreement::Extra => OUTSIDE,
                    Agreement::Covered => COVERED,
                    Agreement::Missing => MISSING,
                })
            });
        }
        Self { key, comparison, wrong, ours, exact }
    }
}

fn texture(
    ui: &Ui,
    name: &str,
    comparison: &Comparison,
    color: impl Fn(&Comparison, u32, u32) -> Color32,
) -> TextureHandle {
    let (width, height) = comparison.ours.size();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| color(comparison, x, y));
    let image = ColorImage::new([width as usize, height as usize], pixels.collect());
    ui.ctx().load_texture(name, image, TextureOptions::NEAREST)
}

/// One picture or two side by side, moved and enlarged together.
fn pictures(ui: &mut Ui, shown: &Shown, comparison: &Comparison, view: &mut Option<(f32, Vec2)>) {
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let count = if shown.exact.is_some() { 2.0 } else { 1.0 };
    let (width, height) = comparison.ours.size();
    let size = vec2(width as f32, height as f32);
    let tile = vec2((area.width() - space::S * (count + 1.0)) / count, area.height() - space::L - 2.0 * space::S);
    let fitted = (tile / size).min_elem().min(LARGEST_PIXEL);
    let (mut scale, mut center) = view.unwrap_or((fitted, size / 2.0));
    if response.dragged() {
        center -= response.drag_delta() / scale;
    }
    let wheel = if response.hovered() { ui.input(|i| i.smooth_scroll_delta().y) } else { 0.0 };
    if wheel != 0.0 {
        scale = (scale * (wheel * 0.005).exp()).clamp(fitted * 0.5, LARGEST_PIXEL);
    }
    if response.dragged() || wheel != 0.0 {
        *view = Some((scale, center));
    }
    if response.double_clicked() {
        *view = None;
    }
    let tiles = [("What is drawn", &shown.ours), ("Exact answer", &shown.exact)];
    let mut hovered = None;
    for (index, (title, texture)) in tiles.into_iter().enumerate() {
        let Some(texture) = texture else { continue };
        let left = area.left() + space::S + index as f32 * (tile.x + space::S);
        let rect = Rect::from_min_size(pos2(left, area.top() + space::L + space::S), tile);
        let small = FontId::proportional(font_size::SMALL);
        let anchor = rect.left_top() - vec2(0.0, 4.0);
        ui.painter().text(anchor, Align2::LEFT_BOTTOM, title, small, tokens(ui).text_weak);
        let place = |p: Vec2| rect.center() + (p - center) * scale;
        picture(ui, rect, texture, comparison, (scale, &place));
        if let Some(pointer) = response.hover_pos().filter(|pointer| rect.contains(*pointer)) {
            let pixel = (pointer - rect.center()) / scale + center;
            hovered = Some((pixel.x.floor() as i64, pixel.y.floor() as i64));
        }
    }
    if let Some((x, y)) = hovered.filter(|(x, y)| (0..width.into()).contains(x) && (0..height.into()).contains(y)) {
        let word = match comparison.agreement(x as u32, y as u32) {
            Agreement::Outside => "not covered",
            Agreement::Covered => "covered",
            Agreement::Extra => "drawn, though it is outside",
            Agreement::Missing => "not drawn, though it is inside",
        };
        let (column, row) = (x + comparison.origin.0, y + comparison.origin.1);
        response.on_hover_text_at_pointer(format!("pixel {column}, {row}: {word}"));
    }
}

fn picture(
    ui: &Ui,
    rect: Rect,
    texture: &TextureHandle,
    comparison: &Comparison,
    (scale, place): (f32, &dyn Fn(Vec2) -> Pos2),
) {
    let (width, height) = comparison.ours.size();
    let painter = ui.painter().with_clip_rect(rect);
    let size = vec2(width as f32, height as f32);
    let whole = Rect::from_min_max(place(Vec2::ZERO), place(size));
    painter.image(texture.id(), whole, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
    if scale >= GRID_FROM {
        let stroke = Stroke::new(1.0, Color32::from_white_alpha(18));
        for x in 0..=width {
            painter.vline(place(vec2(x as f32, 0.0)).x, whole.y_range(), stroke);
        }
        for y in 0..=height {
            painter.hline(whole.x_range(), place(vec2(0.0, y as f32)).y, stroke);
        }
    }
    let stroke = Stroke::new(1.5, tokens(ui).accent);
    for outline in &comparison.outlines {
        // Corners up to 10³⁸ px away: clipped to what floats of the painter bear.
        let near = |c: f64| c.clamp(-1e5, 1e5) as f32;
        let corner = |index: usize| {
            let [x, y] = outline[index % outline.len()];
            place(vec2(near(x), near(y)))
        };
        // Side by side, not as one line: joined at the tip of a needle, that is as long as the needle again.
        for side in 0..outline.len() {
            painter.line_segment([corner(side), corner(side + 1)], stroke);
        }
    }
}
