//! Settings of the last pipeline stage: anti-aliasing of drawn pixels, the upscaler that reconstructs the other pixels,
//! and the post filter.

use eframe::egui::{Grid, Ui};

use super::pick;
use super::switches::note;
use crate::antialias::settings::{AntialiasMethod, Antialiasing, PostFilter, PostFilterKind};
use crate::chain::Recipe;
use crate::ui::theme::space;
use crate::ui::widgets::{choice, integer_field, number_field, row, slider};
use crate::upscale::{self, Upscaling};

/// Draws the anti-aliasing settings.
pub(super) fn antialias(ui: &mut Ui, antialias: &mut Antialiasing) {
    row(ui, "Anti-aliasing", "Reduction of jagged edges and moiré: method and sample pattern", |ui| {
        pick(ui, &mut antialias.method)
    });
    note(ui, crate::pipeline::settings::Choice::help(antialias.method));
    if antialias.is_off() {
        return;
    }
    if antialias.method != AntialiasMethod::RotatedGrid {
        row(ui, "Samples", "Samples per rendered pixel", |ui| pick(ui, &mut antialias.samples));
    }
    if antialias.method == AntialiasMethod::Jittered {
        row(ui, "Seed", "Different seeds give different sample positions", |ui| {
            ui.add(integer_field(&mut antialias.seed))
        });
    }
    row(ui, "Averaged values", "Values that are averaged into a pixel: linear light or sRGB codes", |ui| {
        pick(ui, &mut antialias.light)
    });
}

/// Draws the settings of the upscaler: its method and the options of the method.
pub(super) fn upscaler(ui: &mut Ui, recipe: &mut Recipe) {
    let before = recipe.upscaler;
    let mut method = before.method();
    let methods: Vec<_> = upscale::all().iter().map(|u| (u.id(), u.name(), u.help())).collect();
    row(ui, "Method", "Upscaling method, which reconstructs the pixels that are not drawn", |ui| {
        choice(ui, &mut method, &methods)
    });
    let chosen = before.with_method(method).unwrap_or(before);
    recipe.upscaler = choices(ui, chosen);
    note(ui, recipe.upscaler.upscaler().help());
    if let Some(failure) = recipe.upscaler.upscaler().failure() {
        note(ui, &failure);
    }
}

/// Draws the options of the current upscaling method. Returns the upscaler with the selected options.
fn choices(ui: &mut Ui, chosen: Upscaling) -> Upscaling {
    let offers = chosen.upscaler().offers();
    let mut result = chosen;
    if offers.scales.len() > 1 {
        let mut scale = chosen.scale();
        let names: Vec<_> = offers.scales.iter().map(|s| (*s, format!("×{s}"))).collect();
        let options: Vec<_> = names.iter().map(|(s, name)| (*s, name.as_str(), "Scale factor per axis")).collect();
        row(ui, "Scale", "Scale factor per axis: ×4 draws one of sixteen pixels", |ui| {
            choice(ui, &mut scale, &options)
        });
        result = result.with_scale(scale);
    }
    if offers.anchors.len() > 1 {
        let mut anchor = chosen.anchor();
        row(ui, "Anchor", "Position of a drawn sample in the block of pixels that it represents", |ui| {
            pick(ui, &mut anchor)
        });
        result = result.with_anchor(anchor);
    }
    if offers.lights.len() > 1 {
        let mut light = chosen.light();
        row(ui, "Filtered values", "Values that are filtered: sRGB codes or linear light", |ui| pick(ui, &mut light));
        result = result.with_light(light);
    }
    if offers.deringing {
        let mut deringing = chosen.deringing();
        row(ui, "De-ringing", "Clamps each pixel to the range of the drawn pixels around it", |ui| {
            ui.checkbox(&mut deringing, "")
        });
        result = result.with_deringing(deringing);
    }
    if offers.sharpening {
        let mut sharpening = chosen.sharpening() as f32;
        row(ui, "Sharpening", "Strength, in percent of the strongest sharpening that creates no new extremes", |ui| {
            slider(ui, &mut sharpening, 0.0..=100.0, " %", 0)
        });
        result = result.with_sharpening(sharpening.round() as u32);
    }
    if offers.history {
        let mut history = chosen.history();
        row(ui, "Rectification", "Change of the history so that it agrees with the samples around the pixel", |ui| {
            pick(ui, &mut history.rectification)
        });
        row(ui, "History filter", "Filter that reads the history between its pixels", |ui| {
            pick(ui, &mut history.filter)
        });
        row(ui, "Luminance weighting", "Blends colours with weights 1 / (1 + luminance)", |ui| {
            ui.checkbox(&mut history.luminance_weighting, "")
        });
        result = result.with_history(history);
    }
    result
}

/// Draws the settings of the post filter.
pub(super) fn post(ui: &mut Ui, post: &mut PostFilter) {
    let mut filter = post.filter;
    row(ui, "Post filter", "Filter applied to the finished picture", |ui| pick(ui, &mut filter));
    *post = post.with_filter(filter);
    if post.is_off() {
        return;
    }
    note(ui, crate::pipeline::settings::Choice::help(post.filter));
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
        row(ui, "Direction", "Direction of the motion, clockwise from the right", |ui| {
            slider(ui, &mut post.angle_degrees, -180.0..=180.0, "°", 0)
        });
    }
    if post.filter == PostFilterKind::Custom {
        mask(ui, post);
    }
    row(ui, "Filter space", "Values that the post filter mixes: linear light or sRGB codes", |ui| {
        pick(ui, &mut post.light)
    });
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
