//! Colours of the lab's grid, from those of the theme.

use eframe::egui::Color32;

use crate::lab::recording::{Ink, Tone};
use crate::ui::theme::Tokens;

/// Below the pixels.
pub(super) fn paper(tokens: &Tokens) -> Color32 {
    tokens.field
}

/// Of a pixel.
pub(super) fn ink(ink: Ink, tokens: &Tokens) -> Color32 {
    /// How much the colour of a side shows on the paper.
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

/// Of a mark.
pub(super) fn tone(tone: Tone, tokens: &Tokens) -> Color32 {
    /// Told from every ink of the grid but one, and from the true shape.
    const FOCUS_SERIES: usize = 3;
    match tone {
        Tone::Ideal => tokens.accent,
        Tone::Weak => tokens.text_weak,
        Tone::Focus => series(FOCUS_SERIES, tokens),
        Tone::A => tokens.a,
        Tone::B => tokens.b,
        Tone::Group(number) => series(number, tokens),
    }
}

fn series(number: usize, tokens: &Tokens) -> Color32 {
    tokens.series[number % tokens.series.len()]
}
