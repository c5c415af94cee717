//! Colours of upscalers in plots and lists: one hue per method, and a lightness per scale. Many methods have similar
//! hues, so a name always accompanies the colour.

use eframe::egui::{Color32, Rgba, Ui};
use glam::{Mat3, Vec3, mat3, vec3};

use super::theme::tokens;
use crate::report::upscaling::hue_degrees;
use crate::upscale::{Scale, Upscaling};

/// Chroma of the colours, reduced where the sRGB gamut ends earlier.
const CHROMA: f32 = 0.15;

/// Lightness at ×1 and at ×4 in the dark theme, in Oklab.
const DARK_LIGHTNESS: [f32; 2] = [0.86, 0.6];

/// Lightness at ×1 and at ×4 in the light theme, in Oklab.
const LIGHT_LIGHTNESS: [f32; 2] = [0.42, 0.62];

/// Returns the colour of an upscaler in the theme of `ui`. Native rendering has the colour of text.
pub(crate) fn method_color(ui: &Ui, upscaling: Upscaling) -> Color32 {
    match hue_degrees(upscaling) {
        None => tokens(ui).text,
        Some(degrees) => hue_color(ui.visuals().dark_mode, degrees, upscaling.scale()),
    }
}

/// Returns the colour of a hue in degrees, whose lightness depends on the scale.
fn hue_color(dark_mode: bool, degrees: f32, scale: Scale) -> Color32 {
    let [native, coarsest] = if dark_mode { DARK_LIGHTNESS } else { LIGHT_LIGHTNESS };
    let share = (scale.value().log2() / Scale::FOUR.value().log2()) as f32;
    let lightness = native + (coarsest - native) * share;
    let hue = degrees.to_radians();
    let linear = |chroma: f32| linear_from_oklab(vec3(lightness, chroma * hue.cos(), chroma * hue.sin()));
    /// Chroma is reduced in this many steps until the colour is in the gamut.
    const STEPS: u8 = 30;
    let colors = (0..=STEPS).map(|step| linear(CHROMA * (1.0 - f32::from(step) / f32::from(STEPS))));
    let is_displayable = |color: &Vec3| color.min_element() >= 0.0 && color.max_element() <= 1.0;
    let color = colors.into_iter().find(is_displayable).unwrap_or(Vec3::splat(lightness.powi(3)));
    Rgba::from_rgb(color.x, color.y, color.z).into()
}

/// Converts an Oklab colour (lightness, a, b) to linear sRGB; components outside [0, 1] are not displayable.
fn linear_from_oklab(lab: Vec3) -> Vec3 {
    /// Cone responses, to the power of ⅓, from Oklab (Ottosson 2020).
    const CONES_FROM_LAB: Mat3 = mat3(
        vec3(1.0, 1.0, 1.0),
        vec3(0.396_337_78, -0.105_561_346, -0.089_484_18),
        vec3(0.215_803_76, -0.063_854_17, -1.291_485_5),
    );
    /// Linear sRGB from cone responses (Ottosson 2020).
    const LINEAR_FROM_CONES: Mat3 = mat3(
        vec3(4.076_741_7, -1.268_438, -0.004_196_086_3),
        vec3(-3.307_711_6, 2.609_757_4, -0.703_418_6),
        vec3(0.230_969_94, -0.341_319_38, 1.707_614_7),
    );
    LINEAR_FROM_CONES * (CONES_FROM_LAB * lab).powf(3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::theme::{DARK, LIGHT};

    fn luminance(color: Color32) -> f32 {
        let color = Rgba::from(color);
        vec3(color.r(), color.g(), color.b()).dot(vec3(0.2126, 0.7152, 0.0722))
    }

    /// Returns the contrast ratio of two colours, as defined by the Web Content Accessibility Guidelines.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let [a, b] = [a, b].map(|color| luminance(color) + 0.05);
        a.max(b) / a.min(b)
    }

    fn color(dark_mode: bool, upscaling: Upscaling) -> Color32 {
        hue_color(dark_mode, hue_degrees(upscaling).unwrap(), upscaling.scale())
    }

    #[test]
    fn every_colour_is_visible_on_panels_and_plots() {
        for (dark_mode, tokens) in [(true, &DARK), (false, &LIGHT)] {
            for upscaling in Upscaling::every().filter(|upscaling| !upscaling.is_native()) {
                for ground in [tokens.panel, tokens.field] {
                    let ratio = contrast(color(dark_mode, upscaling), ground);
                    assert!(ratio >= 3.0, "{} on {ground:?}: {ratio}", upscaling.label());
                }
            }
        }
    }

    #[test]
    fn all_colours_differ() {
        for dark_mode in [true, false] {
            let methods = || Upscaling::every().filter(|upscaling| !upscaling.is_native());
            let mut colors: Vec<_> = methods().map(|upscaling| color(dark_mode, upscaling).to_array()).collect();
            colors.sort_unstable();
            colors.dedup();
            assert_eq!(colors.len(), methods().count());
        }
    }

    #[test]
    fn the_conversion_from_oklab_maps_white_and_red() {
        let white = linear_from_oklab(vec3(1.0, 0.0, 0.0));
        assert!((white - Vec3::ONE).abs().max_element() < 1e-3, "{white}");
        let red = linear_from_oklab(vec3(0.627_955, 0.224_863, 0.125_846));
        assert!((red - Vec3::X).abs().max_element() < 1e-3, "{red}");
    }
}
