//! Parts of legends: a colour scale, which is a bar of colours between two numbers, and notes.

use eframe::egui::{
    Align2, Color32, FontId, Label, Mesh, Painter, Rect, Response, RichText, Role, Sense, Ui, WidgetInfo, vec2,
};

use crate::image::Rgba8;
use crate::ui::theme::{CONTROL_HEIGHT, font_size, space, tokens};

/// Width of the colour bar, in points.
const WIDTH: f32 = 120.0;

/// Height of the colour bar, in points.
const BAR: f32 = 10.0;

/// Colour scale with the values at its ends.
pub(crate) struct ScaleLegend {
    /// Texts at the left and at the right end.
    pub(crate) ends: [String; 2],
}

impl ScaleLegend {
    /// Draws the scale. `color` returns the colour at a fraction of the bar's width, in [0, 1].
    pub(crate) fn ui(&self, ui: &mut Ui, color: impl Fn(f32) -> Rgba8) {
        let font = FontId::monospace(font_size::SMALL);
        let texts =
            self.ends.each_ref().map(|text| ui.painter().layout_no_wrap(text.clone(), font.clone(), tokens(ui).text));
        let [low, high] = texts.each_ref().map(|text| text.size().x);
        let size = vec2(low + high + WIDTH + 2.0 * space::XS, CONTROL_HEIGHT);
        let (place, response) = ui.allocate_exact_size(size, Sense::hover());
        let name = format!("Colours from {} to {}", self.ends[0], self.ends[1]);
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
        let left = place.left() + low + space::XS;
        let bar = Rect::from_min_size([left, place.center().y - BAR / 2.0].into(), vec2(WIDTH, BAR));
        color_bar(ui.painter(), bar, color);
        let [low, high] = texts;
        for (text, at, align) in
            [(low, place.left_center(), Align2::LEFT_CENTER), (high, place.right_center(), Align2::RIGHT_CENTER)]
        {
            let corner = align.anchor_size(at, text.size()).min;
            ui.painter().galley(corner, text, tokens(ui).text);
        }
    }
}

/// Draws a bar of colours. `color` returns the colour at a fraction of the width, in [0, 1].
pub(crate) fn color_bar(painter: &Painter, bar: Rect, color: impl Fn(f32) -> Rgba8) {
    // A mesh has no smoothed edges, which would look like stripes where columns are not aligned to screen pixels.
    let mut mesh = Mesh::default();
    let last = (bar.width() - 1.0).max(1.0);
    for point in 0..bar.width() as u32 {
        let [r, g, b, _] = color(point as f32 / last);
        let column = Rect::from_min_size(bar.min + vec2(point as f32, 0.0), vec2(1.0, bar.height()));
        mesh.add_colored_rect(column, Color32::from_rgb(r, g, b));
    }
    painter.add(mesh);
}

/// Draws a note in small, weak text.
pub(crate) fn note(ui: &mut Ui, text: &str) -> Response {
    ui.add(Label::new(RichText::new(text).small().color(tokens(ui).text_weak)).extend())
}
