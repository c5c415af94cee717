//! Dark and light theme of the window in one table: colours, sizes, radii and fonts.
//!
//! [`install`] applies the table once to both styles of an egui context. Panels then use tokens, never literals:
//! `theme::tokens(ui).accent`, `theme::ROW_HEIGHT`. Neutral colours have no tint, because a tint around a picture would
//! distort how its colours are perceived. Colours with a meaning are used for that meaning only, and never alone: an
//! icon or a word accompanies them. The colours of `series` remain distinguishable under protanopia and deuteranopia (a
//! test simulates both).

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Atom, Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, FontTweak, Frame, Margin,
    Painter, Pos2, Rect, Shadow, Stroke, Style, TextStyle, Ui, Vec2, Visuals,
    epaint::FontColorTransferFunction,
    style::{HandleShape, ScrollStyle, Selection, WidgetVisuals, Widgets},
    vec2,
};
pub(crate) use lucide_icons::Icon;

use crate::image::color;

/// Spacing in points, on a grid of 4.
pub(crate) mod space {
    /// Space between parts of one item, in points.
    pub(crate) const XS: f32 = 4.0;
    /// Space between items, in points.
    pub(crate) const S: f32 = 8.0;
    /// Inner margin of panels, in points.
    pub(crate) const M: f32 = 12.0;
    /// Space between groups, in points.
    pub(crate) const L: f32 = 16.0;
}

/// Height of a row of a panel or a table, in points.
pub(crate) const ROW_HEIGHT: f32 = 24.0;

/// Height of buttons, fields and sliders, in points: a row minus the gap to the next.
pub(crate) const CONTROL_HEIGHT: f32 = ROW_HEIGHT - space::XS;

/// Duration of animations, such as opening a menu, in seconds.
pub(crate) const ANIMATION_SECONDS: f32 = 0.1;

/// Corner radius of controls, in points.
pub(crate) const RADIUS: u8 = 4;

/// Corner radius of windows, menus and tooltips, in points.
pub(crate) const WINDOW_RADIUS: u8 = 8;

/// Width and height of an icon, in points.
pub(crate) const ICON_SIZE: f32 = 14.0;

/// Font sizes in points. `MONOSPACE` is one less than `BODY`, because its glyphs are then as tall as those of `BODY`.
pub(crate) mod font_size {
    /// Font size of notes, table headers and axis labels.
    pub(crate) const SMALL: f32 = 11.0;
    /// Font size of body text.
    pub(crate) const BODY: f32 = 13.0;
    /// Font size of numbers that change or are aligned.
    pub(crate) const MONOSPACE: f32 = 12.0;
    /// Font size of titles, at most one per panel.
    pub(crate) const TITLE: f32 = 16.0;
}

/// Colours of one theme, named by their use.
pub(crate) struct Tokens {
    /// Background of the canvas, darker than most pictures, so that the picture is the brightest area on screen.
    pub(crate) canvas: Color32,
    /// Background of text fields and plots: the darkest or lightest neutral colour.
    pub(crate) field: Color32,
    /// Background of panels, menus and windows.
    pub(crate) panel: Color32,
    /// Background of blocks that stand out from their panel: cards, table stripes, headers.
    pub(crate) raised: Color32,
    /// Fill of buttons and sliders at rest.
    pub(crate) control: Color32,
    /// Fill of buttons and sliders under the pointer.
    pub(crate) control_hovered: Color32,
    /// Colour of separators and of the borders of swatches.
    pub(crate) border: Color32,
    /// Text colour of labels, units and hints.
    pub(crate) text_weak: Color32,
    /// Text colour of values and body text.
    pub(crate) text: Color32,
    /// Text colour of headings and emphasised values.
    pub(crate) text_strong: Color32,
    /// Colour of the selection, the focus and the picked pixel.
    pub(crate) accent: Color32,
    /// Background of selected items; `text_strong` is readable on it.
    pub(crate) accent_fill: Color32,
    /// Colour of a passed test.
    pub(crate) passed: Color32,
    /// Colour of a rejected fragment or a failed check.
    pub(crate) rejected: Color32,
    /// Colour of a warning.
    pub(crate) warning: Color32,
    /// Colour of an error.
    pub(crate) error: Color32,
    /// Colour of A, the first of two compared items, in labels, tile frames, plots and tables.
    pub(crate) a: Color32,
    /// Colour of B, the second of two compared items.
    pub(crate) b: Color32,
    /// Colours of plot lines, in the order of their use.
    pub(crate) series: [Color32; 8],
    shadow: Color32,
}

/// Colours of the dark theme: white text on dark grey.
pub(crate) static DARK: Tokens = Tokens {
    canvas: Color32::from_gray(0x12),
    field: Color32::from_gray(0x12),
    panel: Color32::from_gray(0x1C),
    raised: Color32::from_gray(0x26),
    control: Color32::from_gray(0x33),
    control_hovered: Color32::from_gray(0x42),
    border: Color32::from_gray(0x4A),
    text_weak: Color32::from_gray(0x9C),
    text: Color32::from_gray(0xD2),
    text_strong: Color32::from_gray(0xFA),
    accent: rgb(0x4C_A6FF),
    accent_fill: rgb(0x1D_5590),
    passed: rgb(0x4F_C48A),
    rejected: rgb(0xF0_8A5D),
    warning: rgb(0xE8_C547),
    error: rgb(0xFF_6B6E),
    a: rgb(0xA9_97FF),
    b: rgb(0xF5_A142),
    series: [
        rgb(0xE4_9613),
        rgb(0x6B_75F2),
        rgb(0x11_C689),
        rgb(0xEB_7ADE),
        rgb(0xB4_F3F8),
        rgb(0xC2_EE31),
        rgb(0xED_232B),
        rgb(0x80_8080),
    ],
    shadow: Color32::from_black_alpha(0x70),
};

/// Colours of the light theme: black text on light grey.
pub(crate) static LIGHT: Tokens = Tokens {
    canvas: Color32::from_gray(0xD0),
    field: Color32::from_gray(0xFF),
    panel: Color32::from_gray(0xF2),
    raised: Color32::from_gray(0xE8),
    control: Color32::from_gray(0xDC),
    control_hovered: Color32::from_gray(0xCC),
    border: Color32::from_gray(0xBC),
    text_weak: Color32::from_gray(0x54),
    text: Color32::from_gray(0x26),
    text_strong: Color32::from_gray(0x00),
    accent: rgb(0x0A_63CC),
    accent_fill: rgb(0xAE_D2FA),
    passed: rgb(0x0E_7040),
    rejected: rgb(0xA8_450E),
    warning: rgb(0x7A_5B00),
    error: rgb(0xBE_1B28),
    a: rgb(0x62_4BD8),
    b: rgb(0x9A_5500),
    series: [
        rgb(0xBC_7D0F),
        rgb(0x19_6BD9),
        rgb(0x28_9E77),
        rgb(0xC3_13A9),
        rgb(0x09_0F6D),
        rgb(0x48_250F),
        rgb(0xBD_1D1E),
        rgb(0x5F_5F5F),
    ],
    shadow: Color32::from_black_alpha(0x28),
};

/// Colours of the three barycentric weights and of their corners: λ0 red, λ1 green, λ2 blue.
pub(crate) const WEIGHTS: [Color32; 3] = [rgb(0xE0_5A5A), rgb(0x4F_B06A), rgb(0x5A_86E8)];

/// Text colours on a dark pixel and on a light pixel of the picture.
pub(crate) const ON_PIXEL: [Color32; 2] = [Color32::from_gray(0xEB), Color32::from_gray(0x14)];

/// Colour of the pixel grid, visible on any colour.
pub(crate) const PIXEL_GRID: Color32 = Color32::from_gray(0x80);

/// Outline colour of marks on the picture, which makes them visible on any colour.
pub(crate) const MARK_EDGE: Color32 = Color32::from_black_alpha(0xC8);

/// Signal colour of marks on the picture.
pub(crate) const SIGNAL: Color32 = Color32::from_rgb(color::SIGNAL[0], color::SIGNAL[1], color::SIGNAL[2]);

const fn rgb(hex: u32) -> Color32 {
    let [_, red, green, blue] = hex.to_be_bytes();
    Color32::from_rgb(red, green, blue)
}

/// Returns the colours of the current theme of `ui`.
pub(crate) fn tokens(ui: &Ui) -> &'static Tokens {
    of(ui.visuals().dark_mode)
}

fn of(dark_mode: bool) -> &'static Tokens {
    if dark_mode { &DARK } else { &LIGHT }
}

/// Installs the fonts and the styles of both themes. Call it once, when the window is created.
pub(crate) fn install(context: &egui::Context) {
    context.set_fonts(fonts());
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        context.set_style_of(theme, style(theme == egui::Theme::Dark));
    }
}

/// Returns the frame of a side, top or bottom panel.
pub(crate) fn panel_frame(ui: &Ui) -> Frame {
    Frame::new().fill(tokens(ui).panel).inner_margin(Margin::same(space::S as i8))
}

/// Returns the frame around a picture: the canvas colour without a margin.
pub(crate) fn canvas_frame(ui: &Ui) -> Frame {
    Frame::new().fill(tokens(ui).canvas)
}

/// Returns the frame of a block that stands out from its panel.
pub(crate) fn card_frame(ui: &Ui) -> Frame {
    Frame::new().fill(tokens(ui).raised).corner_radius(RADIUS).inner_margin(Margin::same(space::S as i8))
}

/// Returns an icon for use beside the text of a button, menu entry or chip, in the colour of that text. It adds nothing
/// to the accessible name.
pub(crate) fn icon(icon: Icon) -> Atom<'static> {
    Atom::paint(Vec2::splat(ICON_SIZE), move |ui, place| {
        paint_icon(ui.painter(), place.rect.center(), icon, ICON_SIZE, place.fallback_text_color);
    })
}

/// Paints an icon of `size` points, centred on `center` and snapped to whole pixels. Returns its rectangle.
pub(crate) fn paint_icon(painter: &Painter, center: Pos2, icon: Icon, size: f32, color: Color32) -> Rect {
    // Aligned at the top: vertical centring would include the gap below each line of this font.
    let top = center - vec2(0.0, size / 2.0);
    painter.text(top, Align2::CENTER_TOP, icon.unicode(), FontId::new(size, icon_family()), color)
}

fn icon_family() -> FontFamily {
    FontFamily::Name("icons".into())
}

/// Returns the toolkit's fonts and the icon font. The icons are a separate family, because their private code points
/// collide with those of other fonts. For arrows and mathematical symbols, proportional text falls back to the
/// monospace font.
fn fonts() -> FontDefinitions {
    const ICON_FONT: &str = "lucide";
    let mut fonts = FontDefinitions::default();
    // Hinting would distort the outlines of the icons, which are designed on their own grid.
    let unhinted = FontTweak { hinting: Some(false), ..FontTweak::default() };
    let icons = FontData::from_static(lucide_icons::LUCIDE_FONT_BYTES).tweak(unhinted);
    fonts.font_data.insert(ICON_FONT.to_owned(), Arc::new(icons));
    fonts.families.insert(icon_family(), vec![ICON_FONT.to_owned()]);
    if let Some(proportional) = fonts.families.get_mut(&FontFamily::Proportional) {
        proportional.insert(1, "Hack".to_owned());
    }
    fonts
}

fn style(dark_mode: bool) -> Style {
    let tokens = of(dark_mode);
    let mut style = Style {
        text_styles: [
            (TextStyle::Small, FontId::proportional(font_size::SMALL)),
            (TextStyle::Body, FontId::proportional(font_size::BODY)),
            (TextStyle::Button, FontId::proportional(font_size::BODY)),
            (TextStyle::Heading, FontId::proportional(font_size::TITLE)),
            (TextStyle::Monospace, FontId::monospace(font_size::MONOSPACE)),
        ]
        .into(),
        drag_value_text_style: TextStyle::Monospace,
        animation_time: ANIMATION_SECONDS,
        visuals: visuals(dark_mode, tokens),
        ..Style::default()
    };
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(space::S, space::XS);
    spacing.button_padding = vec2(space::S, 2.0);
    spacing.interact_size = vec2(60.0, CONTROL_HEIGHT);
    spacing.icon_width = 16.0;
    spacing.icon_width_inner = 8.0;
    spacing.icon_spacing = 6.0;
    spacing.indent = space::L;
    spacing.slider_rail_height = 4.0;
    spacing.combo_height = 12.0 * ROW_HEIGHT;
    spacing.menu_margin = Margin::same(space::XS as i8);
    spacing.window_margin = Margin::same(space::M as i8);
    spacing.tooltip_width = 320.0;
    spacing.scroll = ScrollStyle { bar_width: 8.0, ..ScrollStyle::thin() };
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.4;
    style
}

fn visuals(dark_mode: bool, tokens: &Tokens) -> Visuals {
    let base = if dark_mode { Visuals::dark() } else { Visuals::light() };
    let shadow = Shadow { offset: [0, 4], blur: 16, spread: 0, color: tokens.shadow };
    let mut visuals = Visuals {
        widgets: widgets(tokens),
        selection: Selection { bg_fill: tokens.accent_fill, stroke: Stroke::new(1.0, tokens.text_strong) },
        weak_text_color: Some(tokens.text_weak),
        hyperlink_color: tokens.accent,
        faint_bg_color: tokens.raised,
        extreme_bg_color: tokens.field,
        code_bg_color: tokens.raised,
        warn_fg_color: tokens.warning,
        error_fg_color: tokens.error,
        window_fill: tokens.panel,
        window_stroke: Stroke::new(1.0, tokens.border),
        window_corner_radius: CornerRadius::same(WINDOW_RADIUS),
        menu_corner_radius: CornerRadius::same(WINDOW_RADIUS),
        window_shadow: shadow,
        popup_shadow: shadow,
        panel_fill: tokens.panel,
        slider_trailing_fill: true,
        handle_shape: HandleShape::Circle,
        indent_has_left_vline: false,
        ..base
    };
    visuals.text_cursor.stroke = Stroke::new(2.0, tokens.accent);
    if !dark_mode {
        visuals.text_options.color_transfer_function = FontColorTransferFunction::Gamma(LIGHT_TEXT_GAMMA);
    }
    visuals
}

/// Gamma of text in the light theme. Values below 1 thicken dark text, whose thin stems would look washed out on a
/// light background.
const LIGHT_TEXT_GAMMA: f32 = 0.7;

/// Returns the visuals of controls at rest, hovered, and pressed or focused. They differ only in colour, so nothing
/// moves.
fn widgets(tokens: &Tokens) -> Widgets {
    let state = |fill, line, text| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: line,
        fg_stroke: Stroke::new(1.5, text),
        corner_radius: CornerRadius::same(RADIUS),
        expansion: 0.0,
    };
    let line = |color| Stroke::new(1.0, color);
    Widgets {
        noninteractive: WidgetVisuals {
            fg_stroke: Stroke::new(1.0, tokens.text),
            ..state(tokens.panel, line(tokens.border), tokens.text)
        },
        inactive: state(tokens.control, Stroke::NONE, tokens.text),
        hovered: state(tokens.control_hovered, Stroke::NONE, tokens.text_strong),
        active: state(tokens.control_hovered, line(tokens.accent), tokens.text_strong),
        open: state(tokens.control_hovered, Stroke::NONE, tokens.text_strong),
    }
}

#[cfg(test)]
mod tests;
