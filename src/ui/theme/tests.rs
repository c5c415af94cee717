use glam::{Mat3, Vec3, mat3, vec3};

use super::*;
use crate::image::Rgba8;
use crate::inspect::{Buffer, view};
use crate::ui::headless::Headless;
use eframe::egui::{Rgba, Theme, epaint::text::MissingGlyphPolicy, pos2};

const BOTH: [&Tokens; 2] = [&DARK, &LIGHT];

fn linear(color: Color32) -> Vec3 {
    let color = Rgba::from(color);
    vec3(color.r(), color.g(), color.b())
}

/// Returns the contrast ratio of two colours, as defined by the Web Content Accessibility Guidelines, from 1 to 21.
fn contrast(a: Color32, b: Color32) -> f32 {
    let [a, b] = [a, b].map(|color| linear(color).dot(vec3(0.2126, 0.7152, 0.0722)) + 0.05);
    a.max(b) / a.min(b)
}

/// Returns the distance between two linear colours in Oklab; 0.02 is just noticeable side by side.
fn oklab_distance(a: Vec3, b: Vec3) -> f32 {
    let lms = mat3(
        vec3(0.412_221_46, 0.211_903_5, 0.088_302_46),
        vec3(0.536_332_55, 0.680_699_5, 0.281_718_85),
        vec3(0.051_445_995, 0.107_396_96, 0.629_978_7),
    );
    let lab = mat3(
        vec3(0.210_454_26, 1.977_998_5, 0.025_904_037),
        vec3(0.793_617_8, -2.428_592_2, 0.782_771_77),
        vec3(-0.004_072_047, 0.450_593_7, -0.808_675_77),
    );
    let [a, b] = [a, b].map(|color| lab * (lms * color.max(Vec3::ZERO)).map(f32::cbrt));
    a.distance(b)
}

/// Returns the matrices that simulate complete protanopia and deuteranopia on linear colours (Machado, Oliveira and
/// Fernandes 2009).
fn colour_blindness() -> [Mat3; 2] {
    [
        mat3(
            vec3(0.152_286, 0.114_503, -0.003_882),
            vec3(1.052_583, 0.786_281, -0.048_116),
            vec3(-0.204_868, 0.099_216, 1.051_998),
        ),
        mat3(
            vec3(0.367_322, 0.280_085, -0.011_82),
            vec3(0.860_646, 0.672_501, 0.042_94),
            vec3(-0.227_968, 0.047_413, 0.968_881),
        ),
    ]
}

#[test]
fn neutral_colours_have_no_tint() {
    for t in BOTH {
        for gray in [t.canvas, t.field, t.panel, t.raised, t.control, t.control_hovered, t.border] {
            assert!(gray.r() == gray.g() && gray.g() == gray.b() && gray.is_opaque());
        }
    }
}

#[test]
fn text_and_status_colours_are_readable_on_every_background() {
    for t in BOTH {
        for ground in [t.panel, t.raised] {
            let colors =
                [t.text_weak, t.text, t.text_strong, t.accent, t.passed, t.rejected, t.warning, t.error, t.a, t.b];
            for (index, color) in colors.into_iter().enumerate() {
                assert!(contrast(color, ground) >= 4.5, "colour {index} on {ground:?}: {}", contrast(color, ground));
            }
        }
        assert!(contrast(t.text, t.control_hovered) >= 4.5);
        assert!(contrast(t.text_weak, t.canvas) >= 4.5);
        assert!(contrast(t.text_strong, t.accent_fill) >= 4.5);
    }
}

#[test]
fn plot_lines_are_distinguishable_with_colour_blindness() {
    for t in BOTH {
        for (index, color) in t.series.iter().enumerate() {
            assert!(contrast(*color, t.panel) >= 3.0, "line {index}: {}", contrast(*color, t.panel));
            for other in &t.series[..index] {
                for eye in colour_blindness() {
                    let distance = oklab_distance(eye * linear(*color), eye * linear(*other));
                    assert!(distance > 0.06, "{color:?} and {other:?} are {distance} apart");
                }
            }
        }
    }
}

#[test]
fn cracks_double_hits_and_counts_are_distinguishable_with_colour_blindness() {
    let linear_of = |[r, g, b, _]: Rgba8| linear(Color32::from_rgb(r, g, b));
    let [crack, double] = [view::CRACK, view::DOUBLE_HIT].map(linear_of);
    let greys = (0..=32).map(|step| linear_of(view::map_color(Buffer::Hits, step as f32 / 32.0)));
    let greys: Vec<Vec3> = greys.collect();
    for eye in colour_blindness().into_iter().chain([Mat3::IDENTITY]) {
        assert!(oklab_distance(eye * crack, eye * double) > 0.2);
        for grey in &greys {
            for fault in [crack, double] {
                let distance = oklab_distance(eye * *grey, eye * fault);
                assert!(distance > 0.1, "{fault} and {grey} are {distance} apart");
            }
        }
    }
}

#[test]
fn both_styles_take_their_colours_from_the_table() {
    let context = egui::Context::default();
    install(&context);
    for (theme, tokens) in [(Theme::Dark, &DARK), (Theme::Light, &LIGHT)] {
        let style = context.style_of(theme);
        assert_eq!(style.visuals.panel_fill, tokens.panel);
        assert_eq!(style.visuals.strong_text_color(), tokens.text_strong);
        assert_eq!(style.spacing.interact_size.y + style.spacing.item_spacing.y, ROW_HEIGHT);
    }
}

#[test]
fn all_characters_of_the_window_have_glyphs() {
    let mut headless = Headless::new(vec2(400.0, 100.0), 1.0, Theme::Dark);
    headless.context().set_missing_glyph_policy(MissingGlyphPolicy::Panic);
    headless.pass(Vec::new(), |ui| {
        let signs = "−×÷·±≈≤≥≠→←↑↓…–°²³₀₁₂λμαβγΔΣ∞√∂\u{2009}ms “quoted”";
        ui.label(signs);
        ui.monospace(signs);
    });
}

#[test]
fn monospace_digits_and_the_minus_are_equally_wide() {
    let mut headless = Headless::new(vec2(100.0, 100.0), 1.0, Theme::Dark);
    headless.pass(Vec::new(), |ui| {
        let font = TextStyle::Monospace.resolve(ui.style());
        let width = |sign: char| ui.fonts_mut(|fonts| fonts.glyph_width(&font, sign));
        assert!("0123456789−.e".chars().all(|sign| width(sign) == width('8')));
    });
}

#[test]
fn icons_are_centred_at_the_requested_position() {
    for (scale, size) in [(1.0, ICON_SIZE), (1.5, ICON_SIZE), (2.0, 28.0)] {
        let center = pos2(20.0, 20.0);
        let mut headless = Headless::new(vec2(40.0, 40.0), scale, Theme::Dark);
        headless.pass(Vec::new(), |ui| {
            paint_icon(ui.painter(), center, Icon::CircleCheck, size, Color32::WHITE);
        });
        let picture = headless.picture();
        let lit = |x, y| picture.at(x, y)[0] > 0x80;
        let range = 0..picture.width();
        let columns: Vec<u32> = range.clone().filter(|x| range.clone().any(|y| lit(*x, y))).collect();
        let rows: Vec<u32> = range.clone().filter(|y| range.clone().any(|x| lit(x, *y))).collect();
        for (lit, asked) in [(columns, center.x), (rows, center.y)] {
            let [first, last] = [lit[0], lit[lit.len() - 1]];
            let found = (first + last + 1) as f32 / 2.0;
            assert!((found - asked * scale).abs() <= 0.5, "{found} px instead of {} px", asked * scale);
            assert!((last - first) as f32 > 0.7 * size * scale, "the icon has the requested size");
        }
    }
}
