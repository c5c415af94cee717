//! Dialogs over the window.

use eframe::egui::{Frame, Id, Modal, Ui};

/// Shows `content` as a dialog; `content` returns `true` to close it. Returns whether the dialog stays open.
pub(crate) fn modal(ui: &Ui, title: &str, content: impl FnOnce(&mut Ui) -> bool) -> bool {
    /// Width of a dialog that contains little text and one field, in points.
    const WIDTH: f32 = 440.0;
    modal_of_width(ui, title, WIDTH, content)
}

/// Shows `content` as a dialog with a width in points, like [`modal`].
pub(crate) fn modal_of_width(ui: &Ui, title: &str, width: f32, content: impl FnOnce(&mut Ui) -> bool) -> bool {
    let modal =
        Modal::new(Id::unique(("dialog", title.to_owned()))).frame(Frame::window(ui.style())).show(ui.ctx(), |ui| {
            ui.set_width(width);
            ui.heading(title);
            ui.add_space(8.0);
            content(ui)
        });
    !modal.should_close() && !modal.inner
}
