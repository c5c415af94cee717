//! Reduced motion of the toolkit's widgets.

mod desktop;

use eframe::egui::{Context, Event, MouseWheelUnit, RawInput, TouchPhase, style::ScrollAnimation};

use super::theme;
pub(crate) use desktop::reduces_motion as desktop_reduces_motion;

/// Switches the motion of all widgets on or off, in both themes: animations, fading, the blinking of the text cursor, and
/// animated scrolling to a place.
pub(crate) fn set_motion(context: &Context, reduced: bool) {
    let seconds = if reduced { 0.0 } else { theme::ANIMATION_SECONDS };
    if context.global_style().animation_time == seconds {
        return;
    }
    context.all_styles_mut(|style| {
        style.animation_time = seconds;
        style.scroll_animation = if reduced { ScrollAnimation::none() } else { ScrollAnimation::default() };
        style.visuals.text_cursor.blink = !reduced;
    });
}

/// Longest movement of a mouse wheel that the toolkit applies at once, in points. It spreads longer ones over several
/// frames.
const IMMEDIATE_POINTS: f32 = 7.0;

/// Splits the movements of a mouse wheel into parts that the toolkit applies at once, so that scrolling and zooming are
/// not smoothed.
pub(crate) fn split_wheel_events(context: &Context, input: &mut RawInput) {
    let line = context.options(|options| options.input_options.line_scroll_speed);
    let page = context.content_rect().height();
    let split = |event: Event| match event {
        Event::MouseWheel { unit, delta, phase: TouchPhase::Move, modifiers, source } => {
            let points = match unit {
                MouseWheelUnit::Point => delta,
                MouseWheelUnit::Line => delta * line,
                MouseWheelUnit::Page => delta * page,
            };
            let count = (points.length() / IMMEDIATE_POINTS).ceil().clamp(1.0, MAX_WHEEL_PARTS);
            let (unit, delta, phase) = (MouseWheelUnit::Point, points / count, TouchPhase::Move);
            vec![Event::MouseWheel { unit, delta, phase, modifiers, source }; count as usize]
        }
        event => vec![event],
    };
    input.events = std::mem::take(&mut input.events).into_iter().flat_map(split).collect();
}

/// Maximum number of parts of one movement of a mouse wheel.
const MAX_WHEEL_PARTS: f32 = 1000.0;

#[cfg(test)]
mod tests {
    use eframe::egui::{Modifiers, MouseWheelSource, vec2};

    use super::*;

    /// Returns the points that a wheel movement of three lines scrolls in the first pass after it.
    fn scrolled(reduced: bool) -> f32 {
        let context = Context::default();
        theme::install(&context);
        set_motion(&context, reduced);
        let event = Event::MouseWheel {
            unit: MouseWheelUnit::Line,
            delta: vec2(0.0, -3.0),
            phase: TouchPhase::Move,
            modifiers: Modifiers::NONE,
            source: MouseWheelSource::Unknown,
        };
        let mut input = RawInput { events: vec![event], time: Some(1.0), ..RawInput::default() };
        if reduced {
            split_wheel_events(&context, &mut input);
        }
        let mut scrolled = 0.0;
        let output = context.run_ui(input, |ui| scrolled = ui.input(|input| input.smooth_scroll_delta().y));
        output.drop_without_applying_deltas();
        scrolled
    }

    #[test]
    fn reduced_motion_scrolls_at_once_and_stops_animations() {
        let all = -3.0 * Context::default().options(|options| options.input_options.line_scroll_speed);
        assert!((scrolled(true) - all).abs() < 0.01, "{} of {all}", scrolled(true));
        assert!(scrolled(false) > all * 0.9, "the toolkit smooths: {}", scrolled(false));
        let context = Context::default();
        theme::install(&context);
        for reduced in [true, false] {
            set_motion(&context, reduced);
            for theme in [eframe::egui::Theme::Dark, eframe::egui::Theme::Light] {
                let style = context.style_of(theme);
                assert_eq!((style.animation_time == 0.0, style.visuals.text_cursor.blink), (reduced, !reduced));
            }
        }
    }
}
