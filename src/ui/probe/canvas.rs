//! Legend of the stability probe's heat map, in a corner of the canvas.

use eframe::egui::{Align2, Color32, FontId, Rect, Ui, Vec2, vec2};

use super::ProbeState;
use crate::inspect::probe::map_color;
use crate::pipeline::settings::Choice as _;
use crate::ui::theme::{RADIUS, font_size, space, tokens};

/// Width of the colour bar, in points.
const WIDTH: f32 = 220.0;

/// Height of the colour bar, in points.
const BAR: f32 = 8.0;

/// Draws the legend in the lower left corner of the canvas.
pub(crate) fn legend(ui: &Ui, canvas: Rect, probing: &ProbeState) {
    let (Some(found), Some(heat), Some((_, most))) = (&probing.found, probing.heat, &probing.picture) else { return };
    let painter = ui.painter().with_clip_rect(canvas);
    let words = if *most == 0 {
        format!("{}: nothing changed in {} runs.", heat.name(), found.probe.runs)
    } else {
        format!("{} changes: {}", heat.name(), heat.help())
    };
    let small = FontId::proportional(font_size::SMALL);
    let text = painter.layout(words, small.clone(), tokens(ui).text, WIDTH);
    let bar_height = if *most == 0 { 0.0 } else { BAR + 20.0 };
    let size = vec2(WIDTH, text.size().y + bar_height) + Vec2::splat(2.0 * space::S);
    let frame = Rect::from_min_size(canvas.left_bottom() + vec2(space::S, -space::S - size.y), size);
    painter.rect_filled(frame, RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    let inner = frame.shrink(space::S);
    let text_height = text.size().y;
    painter.galley(inner.min, text, tokens(ui).text);
    if *most == 0 {
        return;
    }
    let bar = Rect::from_min_size(inner.min + vec2(0.0, text_height + space::XS), vec2(WIDTH, BAR));
    for step in 0..WIDTH as u32 {
        let [r, g, b, _] = map_color(step as f32 / (WIDTH - 1.0));
        let column = Rect::from_min_size(bar.min + vec2(step as f32, 0.0), vec2(1.0, BAR));
        painter.rect_filled(column, 0.0, Color32::from_rgb(r, g, b));
    }
    let under = vec2(0.0, 2.0);
    painter.text(bar.left_bottom() + under, Align2::LEFT_TOP, "1 run", small.clone(), tokens(ui).text);
    let end = format!("{most} of {} runs", found.probe.runs);
    painter.text(bar.right_bottom() + under, Align2::RIGHT_TOP, end, small, tokens(ui).text);
}
