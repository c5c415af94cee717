//! Serialisation of the window layout as text: positions and sizes of windows and panels, and the state of collapsible
//! headings.

use eframe::egui::Context;

/// Serialises the layout of windows, panels and headings as a string. Returns an empty string if that fails.
pub(super) fn text(context: &Context) -> String {
    // If serialisation fails, the next window has the default layout.
    context.memory(ron::to_string).unwrap_or_default()
}

/// Restores a layout that was serialised by [`text`]. Ignores any other text.
pub(super) fn restore(context: &Context, layout: &str) {
    if let Ok(memory) = ron::from_str(layout) {
        context.memory_mut(|current| *current = memory);
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Id, Theme, Window, vec2};

    use super::*;
    use crate::ui::headless::Headless;

    #[test]
    fn the_layout_is_restored_and_damaged_text_ignored() {
        let mut headless = Headless::new(vec2(800.0, 600.0), 1.0, Theme::Dark);
        let (before, after) = (headless.context().clone(), Context::default());
        let id = Id::unique("heading");
        before.data_mut(|data| data.insert_persisted(id, 12.5_f32));
        // A floating window adds entries to the maps of areas.
        headless.pass(Vec::new(), |ui| drop(Window::new("floating").show(ui, |ui| ui.label("text"))));
        let kept = text(&before);
        for layout in ["", "{", &kept[..kept.len() / 2], &*kept] {
            restore(&after, layout);
            let expected = (layout == kept).then_some(12.5_f32);
            assert_eq!(after.data_mut(|data| data.get_persisted::<f32>(id)), expected, "{layout}");
        }
    }
}
