//! Colours of the lab's grid, derived from the theme.

use eframe::egui::Color32;

use crate::lab::recording::{Ink, Tone};
use crate::ui::theme::Tokens;

/// Returns the background colour of the grid.
pub(super) fn paper(tokens: &Tokens) -> Color32 {
    tokens.field
}

/// Returns the display colour of a grid pixel filled with `ink`.
pub(super) fn ink(ink: Ink, tokens: &Tokens) -> Color32 {
    /// Opacity, in [0, 1], of the tint drawn over the background. The tint shows on which side of a curve a pixel lies.
    const SIDE_SHARE: f32 = 0.28;
    let full = tokens.text;
    match ink {
        Ink::Full => full,
        Ink::Share(share) => paper(tokens).lerp_to_gamma(full, share as f32),
        Ink::Wall => tokens.border,
        Ink::Group(number) => series(number, tokens),
        Ink::Side(positive) => paper(tokens).lerp_to_gamma(if positive { tokens.a } else { tokens.b }, SIDE_SHARE),
        Ink::Color([red, green, blue]) => Color32::from_rgb(red, green, blue),
    }
}

/// Returns the display colour of a mark with this tone.
pub(super) fn tone(tone: Tone, tokens: &Tokens) -> Color32 {
    /// Index of the series colour of focused marks. It differs from the colour of the ideal shape and from all colours
    /// of pixels, except that of one pixel group.
    const FOCUS_SERIES: usize = 3;
    match tone {
        Tone::Ideal => tokens.accent,
        Tone::Weak => tokens.text_weak,
        Tone::Focus => series(FOCUS_SERIES, tokens),
        Tone::A => tokens.a,
        Tone::B => tokens.b,
    }
}

fn series(number: usize, tokens: &Tokens) -> Color32 {
    tokens.series[number % tokens.series.len()]
}
