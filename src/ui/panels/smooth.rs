//! Settings of the last pipeline stage: anti-aliasing of drawn pixels, the upscaler that reconstructs the other pixels,
//! and the post filter.

use eframe::egui::{Grid, Ui};

use super::setting_row::{note, setting, setting_row};
use crate::antialias::settings::{AntialiasMethod, PostFilter, PostFilterKind};
use crate::chain::{Recipe, SettingKey};
use crate::pipeline::settings::Choice;
use crate::ui::theme::space;
use crate::ui::widgets::{choice, number_field, row, slider};

/// Draws the anti-aliasing settings.
pub(super) fn antialias(ui: &mut Ui, recipe: &mut Recipe) {
    setting(ui, SettingKey::AntialiasMethod, recipe);
    let antialias = recipe.antialias;
    note(ui, antialias.method.help());
    if antialias.is_off() {
        return;
    }
    if antialias.method != AntialiasMethod::RotatedGrid {
        setting(ui, SettingKey::AntialiasSamples, recipe);
    }
    if antialias.method == AntialiasMethod::Jittered {
        setting(ui, SettingKey::AntialiasSeed, recipe);
    }
    setting(ui, SettingKey::AntialiasLight, recipe);
}

/// Draws the settings of the upscaler: its method and the options of the method.
pub(super) fn upscaler(ui: &mut Ui, recipe: &mut Recipe) {
    setting(ui, SettingKey::UpscalerMethod, recipe);
    options(ui, recipe);
    note(ui, recipe.upscaler.upscaler().help());
    if let Some(failure) = recipe.upscaler.upscaler().failure() {
        note(ui, &failure);
    }
}

/// Draws the options of which the upscaling method offers a choice.
fn options(ui: &mut Ui, recipe: &mut Recipe) {
    let offers = recipe.upscaler.upscaler().offers();
    if offers.scales.len() > 1 {
        scale(ui, recipe);
    }
    let options = [
        (SettingKey::UpscalerAnchor, offers.anchors.len() > 1),
        (SettingKey::UpscalerLight, offers.lights.len() > 1),
        (SettingKey::UpscalerDeringing, offers.deringing),
        (SettingKey::UpscalerSharpening, offers.sharpening),
        (SettingKey::UpscalerRectification, offers.history),
        (SettingKey::UpscalerHistoryFilter, offers.history),
        (SettingKey::UpscalerLuminanceWeighting, offers.history),
    ];
    for (key, _) in options.into_iter().filter(|(_, is_offered)| *is_offered) {
        setting(ui, key, recipe);
    }
}

/// Draws the scale of the upscaler, with the factors written as ×2.
fn scale(ui: &mut Ui, recipe: &mut Recipe) {
    let mut scale = recipe.upscaler.scale();
    let scales = recipe.upscaler.upscaler().offers().scales;
    let names: Vec<_> = scales.iter().map(|scale| (*scale, format!("×{scale}"))).collect();
    let options: Vec<_> = names.iter().map(|(s, name)| (*s, name.as_str(), "Scale factor per axis")).collect();
    setting_row(ui, SettingKey::UpscalerScale, |ui| choice(ui, &mut scale, &options));
    recipe.upscaler = recipe.upscaler.with_scale(scale);
}

/// Draws the settings of the post filter.
pub(super) fn post(ui: &mut Ui, recipe: &mut Recipe) {
    setting(ui, SettingKey::PostFilter, recipe);
    let post = &mut recipe.post;
    if post.is_off() {
        return;
    }
    note(ui, post.filter.help());
    let strength = match post.filter {
        PostFilterKind::Blur => Some(("Radius", "Distance from the centre of the blur mask to its edge", " px", 0)),
        PostFilterKind::Gaussian => Some(("Deviation", "Standard deviation of the Gaussian blur", " px", 1)),
        PostFilterKind::Sharpen => {
            Some(("Amount", "Fraction of a pixel's difference from its neighbours that is added to it", "", 2))
        }
        PostFilterKind::Motion => Some(("Distance", "Length of the motion blur", " px", 1)),
        PostFilterKind::None | PostFilterKind::Fxaa | PostFilterKind::Smaa | PostFilterKind::Custom => None,
    };
    if let Some(((label, help, unit, decimals), most)) = strength.zip(post.filter.max_strength()) {
        row(ui, label, help, |ui| slider(ui, &mut post.strength, 0.0..=most, unit, decimals));
    }
    if post.filter == PostFilterKind::Motion {
        setting_row(ui, SettingKey::PostAngle, |ui| slider(ui, &mut post.angle_degrees, -180.0..=180.0, "°", 0));
    }
    if post.filter == PostFilterKind::Custom {
        mask(ui, post);
    }
    setting(ui, SettingKey::PostLight, recipe);
}

/// Draws a grid for editing the 5 × 5 weights of the convolution mask.
fn mask(ui: &mut Ui, post: &mut PostFilter) {
    /// Change of a weight per dragged point.
    const SPEED: f64 = 0.01;
    /// Space between two weights, in points.
    const GAP: f32 = space::XS;
    // Five weights share the width of the panel, which they would widen otherwise.
    let width = (ui.available_width() - 4.0 * GAP) / 5.0;
    Grid::new("mask").num_columns(5).min_col_width(width).spacing([GAP, GAP]).show(ui, |ui| {
        ui.spacing_mut().interact_size.x = width;
        ui.spacing_mut().button_padding.x = 0.0;
        for row in post.mask.chunks_mut(5) {
            for weight in row {
                let text = |value: f64| ((value * 1e3).round() / 1e3).to_string();
                ui.add(number_field(weight, text).speed(SPEED).range(-100.0..=100.0));
            }
            ui.end_row();
        }
    });
}
