//! Legend of a difference image.

use eframe::egui::{Align2, Color32, FontId, Rect, Ui, Vec2, vec2};

use super::small;
use crate::inspect::what_if::Changes;
use crate::measure::difference::Difference;
use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::ui::theme::{RADIUS, font_size, space, tokens};

/// Draws the legend of the difference image in the lower left corner of the picture.
pub(super) fn legend(ui: &Ui, picture: Rect, (kind, gain): (Difference, u32)) {
    const WIDTH: f32 = 220.0;
    const BAR: f32 = 8.0;
    let painter = ui.painter().with_clip_rect(picture);
    let text = format!("{} difference ×{gain}: {}", kind.name(), kind.help());
    let text = painter.layout(text, small(), tokens(ui).text, WIDTH);
    let size = vec2(WIDTH, text.size().y + BAR + 20.0) + Vec2::splat(2.0 * space::S);
    let frame = Rect::from_min_size(picture.left_bottom() + vec2(space::S, -space::S - size.y), size);
    painter.rect_filled(frame, RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    let inner = frame.shrink(space::S);
    let bar = Rect::from_min_size(inner.min + vec2(0.0, text.size().y + 4.0), vec2(WIDTH, BAR));
    painter.galley(inner.min, text, tokens(ui).text);
    for step in 0..WIDTH as u32 {
        let [r, g, b, _] = kind.color(f64::from(step) / f64::from(WIDTH - 1.0));
        let column = Rect::from_min_size(bar.min + vec2(step as f32, 0.0), vec2(1.0, BAR));
        painter.rect_filled(column, 0.0, Color32::from_rgb(r, g, b));
    }
    let (low, high) = kind.range(gain);
    let mono = FontId::monospace(font_size::SMALL);
    let number = |value: f64| format::fixed(value, if high >= 10.0 { 0 } else { 3 });
    painter.text(bar.left_bottom() + vec2(0.0, 2.0), Align2::LEFT_TOP, number(low), mono.clone(), tokens(ui).text);
    painter.text(bar.right_bottom() + vec2(0.0, 2.0), Align2::RIGHT_TOP, number(high), mono, tokens(ui).text);
}

/// Draws the number of changed pixels in the lower left corner of the picture.
pub(super) fn changed(ui: &Ui, picture: Rect, changes: &Changes) {
    let words = match changes.count {
        0 => "No pixel differs between A and B".to_owned(),
        1 => "1 pixel differs between A and B, marked over the dimmed B".to_owned(),
        count => format!("{} pixels differ between A and B, marked over the dimmed B", format::count(count)),
    };
    let painter = ui.painter().with_clip_rect(picture);
    let text = painter.layout_no_wrap(words, small(), tokens(ui).text);
    let size = text.size() + Vec2::splat(2.0 * space::S);
    let frame = Rect::from_min_size(picture.left_bottom() + vec2(space::S, -space::S - size.y), size);
    painter.rect_filled(frame, RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    painter.galley(frame.shrink(space::S).min, text, tokens(ui).text);
}
