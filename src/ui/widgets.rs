//! Building blocks of panels: rows, pickers, headers, chips and readouts.
//!
//! A panel is a column of rows as wide as the panel, one [`theme::ROW_HEIGHT`] apart. Each row has a label on the left,
//! truncated if necessary, and a control or a number on the right, so that both align down the panel. Every widget has
//! a name in the accessibility tree, by which tests also find it. A control in a row is named after the row's label.

use std::ops::RangeInclusive;
use std::sync::Arc;

use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{
    self, Align, Button, Color32, ComboBox, DragValue, FontId, Galley, Id, Label, Layout, Rect, Response, RichText,
    Role, Sense, Slider, SliderClamping, Stroke, StrokeKind, TextStyle, TextWrapMode, Ui, UiBuilder, Vec2, WidgetAtom,
    WidgetInfo, vec2,
};

use super::theme::{self, CONTROL_HEIGHT, Icon, space, tokens};

/// Fraction of a row's width that its label takes up.
const LABEL_SHARE: f32 = 0.4;

/// Minimum padding on both sides of the text in a segment of a picker, in points.
const SEGMENT_PADDING: f32 = space::XS;

/// Time for which a copy button confirms copying, in seconds.
const COPIED_SECONDS: f64 = 1.2;

/// Adds a row with `label` on the left and the controls added by `add_control` on the right.
///
/// Sliders and pickers fill the right column. Inputs without a name of their own are named `label` for accessibility.
/// `tooltip` describes the control in one sentence. Labels must be unique within one parent.
pub(crate) fn row<R>(ui: &mut Ui, label: &str, tooltip: &str, add_control: impl FnOnce(&mut Ui) -> R) -> R {
    let (row, label_width) = allocate_row(ui, |width| (width * LABEL_SHARE).floor());
    row_label(ui, Rect::from_min_size(row.min, vec2(label_width, row.height())), label, tooltip);
    let right = row.with_min_x(row.left() + label_width);
    let builder = UiBuilder::new().id_salt(label).max_rect(right).layout(Layout::left_to_right(Align::Center));
    let mut control = ui.new_child(builder);
    let spacing = control.spacing_mut();
    spacing.combo_width = right.width();
    // In a panel narrower than the number field, the slider has no width left.
    spacing.slider_width = (right.width() - spacing.interact_size.x - spacing.item_spacing.x).max(0.0);
    control.name_inputs(label, add_control)
}

/// Adds a row with `label` on the left and `value` on the right, right-aligned and in monospace.
///
/// The value can be selected with the mouse. Returns the response of the value, for example for a context menu.
pub(crate) fn value_row(ui: &mut Ui, label: &str, value: &str, tooltip: &str) -> Response {
    let text = RichText::new(value).text_style(TextStyle::Monospace);
    let value_width = monospace_width(ui, value);
    let (row, label_width) = allocate_row(ui, |width| (width - value_width - space::S).max(0.0));
    row_label(ui, Rect::from_min_size(row.min, vec2(label_width, row.height())), label, tooltip);
    let right = row.with_min_x(row.left() + label_width);
    let mut readout = ui.new_child(UiBuilder::new().max_rect(right).layout(Layout::right_to_left(Align::Center)));
    readout.add(Label::new(text).selectable(true).truncate())
}

/// Allocates a row as wide as the panel. Returns its rectangle, and the width of its label, which `label_width`
/// computes from the width of the row.
fn allocate_row(ui: &mut Ui, label_width: impl FnOnce(f32) -> f32) -> (Rect, f32) {
    let width = ui.available_width();
    let (row, _) = ui.allocate_exact_size(vec2(width, CONTROL_HEIGHT), Sense::hover());
    (row, label_width(width))
}

fn row_label(ui: &mut Ui, rect: Rect, label: &str, tooltip: &str) {
    let mut column = ui.new_child(UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
    let text = RichText::new(label).color(tokens(ui).text_weak);
    let shown = column.add(Label::new(text).truncate().show_tooltip_when_elided(false));
    if !tooltip.is_empty() {
        ui.ctx().accesskit_node_builder(shown.id, |node| node.set_description(tooltip));
    }
    ui.interact(rect, shown.id.with("hover"), Sense::hover()).on_hover_ui(|ui| {
        ui.strong(label);
        if !tooltip.is_empty() {
            ui.label(tooltip);
        }
    });
}

/// Adds a picker for one of `options`, each (value, name, tooltip). Returns whether the user changed `value`.
///
/// The picker is as wide as `ui.spacing().combo_width`, which fills the column in a [`row`]. It consists of joined
/// buttons if all names fit, otherwise of a drop-down list. Outside a row, wrap it in [`Ui::push_id`] and
/// [`Ui::name_inputs`].
pub(crate) fn choice<T: Copy + PartialEq>(ui: &mut Ui, value: &mut T, options: &[(T, &str, &str)]) -> bool {
    let before = *value;
    let segment = vec2((ui.spacing().combo_width / options.len().max(1) as f32).floor(), CONTROL_HEIGHT);
    if options.iter().all(|(_, name, _)| text_width(ui, name) + 2.0 * SEGMENT_PADDING <= segment.x) {
        segments(ui, value, options, segment);
    } else {
        drop_down(ui, value, options);
    }
    *value != before
}

/// Returns the width of a text in a button, in points.
pub(crate) fn text_width(ui: &Ui, text: &str) -> f32 {
    width_in(ui, text, &TextStyle::Button)
}

/// Returns the width of a text in the monospace font, in points.
pub(crate) fn monospace_width(ui: &Ui, text: &str) -> f32 {
    width_in(ui, text, &TextStyle::Monospace)
}

fn width_in(ui: &Ui, text: &str, style: &TextStyle) -> f32 {
    ui.painter().layout_no_wrap(text.to_owned(), style.resolve(ui.style()), Color32::WHITE).size().x
}

fn segments<T: Copy + PartialEq>(ui: &mut Ui, value: &mut T, options: &[(T, &str, &str)], segment: Vec2) {
    let size = vec2(segment.x * options.len() as f32, segment.y);
    let (trough, _) = ui.allocate_exact_size(size, Sense::hover());
    ui.painter().rect_filled(trough, theme::RADIUS, tokens(ui).control);
    for (index, (option, name, tooltip)) in options.iter().enumerate() {
        let min = trough.min + vec2(index as f32 * segment.x, 0.0);
        let centered = UiBuilder::new()
            .max_rect(Rect::from_min_size(min, segment))
            .layout(Layout::centered_and_justified(egui::Direction::LeftToRight));
        let button = Button::selectable(*value == *option, *name);
        let mut place = ui.new_child(centered);
        place.spacing_mut().button_padding.x = SEGMENT_PADDING;
        if place.add(button).on_hover_text(*tooltip).clicked() {
            *value = *option;
        }
    }
}

fn drop_down<T: Copy + PartialEq>(ui: &mut Ui, value: &mut T, options: &[(T, &str, &str)]) {
    let (shown, tooltip) =
        options.iter().find(|option| option.0 == *value).map_or(("", ""), |option| (option.1, option.2));
    let response = combo("choice", shown, ui.spacing().combo_width)
        .show_ui(ui, |ui| {
            for (option, name, tooltip) in options {
                ui.selectable_value(value, *option, *name).on_hover_text(*tooltip);
            }
        })
        .response;
    if !tooltip.is_empty() {
        response.on_hover_ui(|ui| {
            ui.label(tooltip);
        });
    }
}

/// Returns a drop-down list of `width` points that displays the text `shown`. The caller adds the entries.
pub(crate) fn combo(id_salt: &str, shown: &str, width: f32) -> ComboBox<'static> {
    ComboBox::from_id_salt(id_salt.to_owned()).selected_text(shown.to_owned()).width(width).truncate().icon(
        |ui, rect, visuals, _open| {
            let color = visuals.fg_stroke.color;
            theme::paint_icon(ui.painter(), rect.center(), Icon::ChevronDown, theme::ICON_SIZE, color);
        },
    )
}

/// Adds a number, right-aligned in a column of `width` points, so that columns line up and do not move.
pub(crate) fn figure(ui: &mut Ui, text: &str, width: f32, color: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(width, CONTROL_HEIGHT), Sense::hover());
    let font = TextStyle::Monospace.resolve(ui.style());
    ui.painter().text(rect.right_center(), egui::Align2::RIGHT_CENTER, text, font, color);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
    response
}

/// Lays out a line of text, truncated with `…` if it exceeds `width` points.
pub(crate) fn elided(ui: &Ui, text: &str, font: FontId, color: Color32, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), font, color);
    job.wrap = TextWrapping::truncate_at_width(width.max(0.0));
    ui.painter().layout_job(job)
}

/// Returns a number field whose text is `text(value)`. A field that is only focused, for example with Tab, leaves the
/// value unchanged, even if the text is rounded or the value is out of range.
pub(crate) fn number_field<'a, N: egui::emath::Numeric>(
    value: &'a mut N,
    text: impl Fn(f64) -> String + 'a,
) -> DragValue<'a> {
    let parser = edited(text(value.to_f64()));
    DragValue::new(value)
        .clamp_existing_to_range(false)
        .custom_formatter(move |value, _| text(value))
        .custom_parser(parser)
}

/// Returns a number field for an integer. It changes `value` only on user input.
pub(crate) fn integer_field<N: egui::emath::Numeric>(value: &mut N) -> DragValue<'_> {
    number_field(value, |value| format!("{value:.0}"))
}

/// Returns a parser of typed numbers, with or without a unit, that rejects `shown`, the text of the unedited field. The
/// toolkit parses the text whenever a field loses the focus, so it would replace an exact value by its rounded text.
fn edited(shown: String) -> impl Fn(&str) -> Option<f64> {
    move |typed| {
        let number: String = typed.chars().filter(|letter| !letter.is_whitespace()).collect();
        let number = number.trim_end_matches(|letter: char| letter.is_alphabetic() || "°%".contains(letter));
        (typed != shown).then(|| number.replace('−', "-").replace(',', ".").parse().ok()).flatten()
    }
}

/// Adds a slider that changes `value` only on user input: out-of-range values stay, and only the text is rounded to
/// `decimals`. Returns whether the value changed.
pub(crate) fn slider(ui: &mut Ui, value: &mut f32, range: RangeInclusive<f32>, suffix: &str, decimals: usize) -> bool {
    let text = move |value: f64| super::format::fixed(value, decimals);
    let parser = edited(text(f64::from(*value)));
    let slider = Slider::new(value, range).clamping(SliderClamping::Edits).suffix(suffix);
    ui.add(slider.custom_formatter(move |value, _| text(value)).custom_parser(parser)).changed()
}

/// Adds a number field that changes `value` only on user input. Dragging by one point changes the value by 2 %. Returns
/// whether the value changed.
pub(crate) fn drag(ui: &mut Ui, value: &mut f32, range: RangeInclusive<f32>) -> bool {
    let speed = f64::from(*value) * 0.02;
    ui.add(number_field(value, exact).speed(speed).range(range)).changed()
}

/// Adds a number field that accepts any finite number and changes `value` only on user input. Dragging by one point
/// changes the value by `step`. Returns whether the value changed.
pub(crate) fn drag_by(ui: &mut Ui, value: &mut f32, step: f64) -> bool {
    ui.add(number_field(value, exact).speed(step).range(f32::MIN..=f32::MAX)).changed()
}

/// Formats a single-precision number with all digits that distinguish it from other numbers.
fn exact(value: f64) -> String {
    (value as f32).to_string()
}

/// Adds the title of a group of rows, with space above it. `add_actions` adds small controls at the right end, from
/// right to left.
pub(crate) fn section_header(ui: &mut Ui, title: &str, add_actions: impl FnOnce(&mut Ui)) {
    ui.add_space(space::S);
    ui.horizontal(|ui| {
        ui.set_min_height(CONTROL_HEIGHT);
        ui.add(Label::new(RichText::new(title).strong()).truncate());
        ui.with_layout(Layout::right_to_left(Align::Center), add_actions);
    });
}

/// Fills the remaining space with a placeholder: `what` names the missing content, and `how` says how to get it.
pub(crate) fn empty_state(ui: &mut Ui, icon: Icon, what: &str, how: &str) {
    const ICON_POINTS: f32 = 28.0;
    const CONTENT_POINTS: f32 = 84.0;
    ui.vertical_centered(|ui| {
        let height = ui.available_height();
        if height.is_finite() {
            ui.add_space(((height - CONTENT_POINTS) / 2.0).max(space::M));
        }
        let (place, _) = ui.allocate_exact_size(Vec2::splat(ICON_POINTS), Sense::hover());
        theme::paint_icon(ui.painter(), place.center(), icon, ICON_POINTS, tokens(ui).border);
        ui.add_space(space::XS);
        ui.label(RichText::new(what).color(tokens(ui).text));
        ui.label(RichText::new(how).color(tokens(ui).text_weak));
    });
}

/// Meaning of a [`chip`], expressed by its icon and its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    /// The test passed.
    Passed,
    /// The fragment was rejected, or a check failed.
    Rejected,
    /// Something needs attention, but nothing failed.
    Warning,
    /// An operation failed.
    Error,
    /// The chip states a fact that is neither good nor bad.
    Neutral,
}

impl Status {
    /// Returns the icon of this status. It accompanies the colour, so that the meaning does not depend on colour alone.
    pub(crate) fn icon(self) -> Icon {
        match self {
            Self::Passed => Icon::CircleCheck,
            Self::Rejected => Icon::CircleX,
            Self::Warning => Icon::TriangleAlert,
            Self::Error => Icon::OctagonAlert,
            Self::Neutral => Icon::Info,
        }
    }

    /// Returns the colour of this status in a theme.
    pub(crate) fn color(self, tokens: &theme::Tokens) -> Color32 {
        match self {
            Self::Passed => tokens.passed,
            Self::Rejected => tokens.rejected,
            Self::Warning => tokens.warning,
            Self::Error => tokens.error,
            Self::Neutral => tokens.text_weak,
        }
    }
}

/// Adds a chip: an icon and a word on a background in the colour of the status.
pub(crate) fn chip(ui: &mut Ui, status: Status, word: &str, tooltip: &str) -> Response {
    const GROUND_OPACITY: f32 = 0.16;
    let color = status.color(tokens(ui));
    let frame = egui::Frame::new()
        .fill(color.gamma_multiply(GROUND_OPACITY))
        .corner_radius(CONTROL_HEIGHT / 2.0)
        .inner_margin(egui::Margin::symmetric(space::XS as i8 + 2, 1));
    let text = RichText::new(word).color(tokens(ui).text_strong);
    let response = WidgetAtom::new((theme::icon(status.icon()), text))
        .gap(space::XS)
        .frame(frame)
        .fallback_text_color(color)
        .min_size(vec2(0.0, CONTROL_HEIGHT))
        .wrap_mode(TextWrapMode::Extend)
        .sense(Sense::hover())
        .show(ui)
        .response;
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, word));
    if tooltip.is_empty() { response } else { response.on_hover_text(tooltip) }
}

/// Adds a square filled with `color`. Its accessible name is the colour code, such as "#4CA6FF". Alpha is ignored.
pub(crate) fn swatch(ui: &mut Ui, color: Color32) -> Response {
    let (place, response) = ui.allocate_exact_size(Vec2::splat(theme::ICON_SIZE), Sense::hover());
    ui.painter().rect(place, 2.0, color.to_opaque(), Stroke::new(1.0, tokens(ui).border), StrokeKind::Inside);
    let [red, green, blue, _] = color.to_array();
    let code = format!("#{red:02X}{green:02X}{blue:02X}");
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &code));
    response.on_hover_text(code)
}

/// Adds a square button with only an icon; `name` is its tooltip and its accessible name.
pub(crate) fn icon_button(ui: &mut Ui, icon: Icon, name: &str) -> Response {
    let button = Button::new(theme::icon(icon)).frame_when_inactive(false).min_size(Vec2::splat(CONTROL_HEIGHT));
    let padding = Vec2::splat((CONTROL_HEIGHT - theme::ICON_SIZE) / 2.0);
    // A scope of its own would not wrap to the next row of a full bar.
    let usual = std::mem::replace(&mut ui.spacing_mut().button_padding, padding);
    let response = ui.add(button).on_hover_text(name);
    ui.spacing_mut().button_padding = usual;
    response
}

/// Adds a button “…” with a menu of the controls that have no room in their bar. `name` is the tooltip and the
/// accessible name of the button.
pub(crate) fn overflow_menu(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui)) {
    let button = Button::new(theme::icon(Icon::Ellipsis)).frame_when_inactive(false);
    let (response, _) = egui::containers::menu::MenuButton::from_button(button).ui(ui, content);
    response.on_hover_text(name).widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
}

/// Adds a button that copies `text` to the clipboard and briefly confirms the copy. Its tooltip is “Copy” followed by
/// `what`.
pub(crate) fn copy_button(ui: &mut Ui, what: &str, text: impl FnOnce() -> String) -> Response {
    let id = Id::unique(("copied", ui.next_auto_id()));
    let now = ui.input(|input| input.time);
    let copied_at: Option<f64> = ui.data(|data| data.get_temp(id));
    let confirms = copied_at.is_some_and(|then| now - then < COPIED_SECONDS);
    let response = icon_button(ui, if confirms { Icon::Check } else { Icon::Copy }, &format!("Copy {what}"));
    if response.clicked() {
        ui.copy_text(text());
        ui.data_mut(|data| data.insert_temp(id, now));
        ui.request_repaint_after_secs(COPIED_SECONDS as f32);
    }
    response
}

#[cfg(test)]
mod tests;
