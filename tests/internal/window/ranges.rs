//! Tests of the range control on the canvas: fitting, handles, channels and boxes, none of which changes a value.

use eframe::egui::{Key, Modifiers, PointerButton, Role, Vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::inspect::Buffer;
use rasterscope::inspect::range::{RangeFit, Rule};
use rasterscope::inspect::view::Value;
use rasterscope::measure::region::PixelRegion;
use rasterscope::ui::engine::Shown;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::range::RangeChange;
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

const DEPTH: Shown = Shown::Buffer(Buffer::Depth);

fn showing_depth() -> Bench {
    let mut bench = Bench::small("interpenetrating");
    bench.session_mut().apply(Command::Show(DEPTH));
    bench.session_mut().apply(Command::Range(RangeChange::Open(true)));
    bench.rest();
    bench
}

fn values(bench: &Bench) -> Vec<Value> {
    let view = bench.view();
    let (width, height) = view.picture.size();
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| view.value(x, y)).collect()
}

fn rule(bench: &Bench) -> Rule {
    bench.session().features.range.setting(DEPTH).display.rule
}

#[test]
fn handles_set_the_range_and_change_no_value() {
    let mut bench = showing_depth();
    let (before, picture) = (values(&bench), bench.view().picture.clone());
    let natural = bench.view().range.expect("depth has a range");
    let plot = bench.window.get_by_role_and_label(Role::Image, "Histogram").rect();
    let (from, to) = (plot.left_top() + Vec2::new(3.0, 20.0), plot.left_top() + Vec2::new(plot.width() / 4.0, 20.0));
    bench.drag(PointerButton::Primary, from, to - from);
    let Rule::Fixed(range) = rule(&bench) else { panic!("the handle sets the range") };
    let share = (range.low - natural.low) / (natural.high - natural.low);
    assert!((share - 0.25).abs() < 0.01 && range.high == natural.high, "{range:?} of {natural:?}");
    assert_eq!(bench.view().range, Some(range));
    assert_ne!(bench.view().picture, picture);
    assert_eq!(values(&bench), before);
    bench.press(Key::R);
    assert_eq!((rule(&bench), bench.view().range), (Rule::Natural, Some(natural)));
    assert_eq!(bench.view().picture, picture);
}

#[test]
fn keys_fit_the_range_once_and_to_the_visible_part() {
    let mut bench = showing_depth();
    let natural = bench.view().range.expect("depth has a range");
    bench.press(Key::N);
    assert_eq!(rule(&bench), Rule::Fixed(natural));
    bench.press(Key::Num0);
    bench.session_mut().pick = Some((80, 45));
    bench.session_mut().features.range.visible = Some(PixelRegion { left: 70, top: 40, right: 90, bottom: 50 });
    let expected = {
        let view = bench.view();
        let near = (40..50).flat_map(|y| (70..90).map(move |x| (x, y))).filter_map(|(x, y)| match view.value(x, y) {
            Value::Number(depth) => Some(depth),
            _ => None,
        });
        near.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), depth| (low.min(depth), high.max(depth)))
    };
    bench.session_mut().apply(Command::Range(RangeChange::FitVisible));
    let Rule::Fixed(range) = rule(&bench) else { panic!("fitting sets the range") };
    assert_eq!((range.low, range.high), expected);
    bench.press_with(Modifiers::SHIFT, Key::N);
    assert_eq!(rule(&bench), Rule::Fixed(natural), "all of the picture is on screen");
}

#[test]
fn a_sticky_range_follows_the_picture_and_a_fixed_one_does_not() {
    let mut bench = showing_depth();
    bench.session_mut().apply(Command::Range(RangeChange::Rule(Rule::Sticky(RangeFit::Most))));
    bench.rest();
    let before = bench.view().range;
    bench.session_mut().state.camera.dolly(0.5);
    bench.rest();
    let sticky = bench.view().range;
    assert_ne!(sticky, before);
    bench.press(Key::N);
    let fixed = bench.view().range;
    bench.session_mut().state.camera.dolly(0.5);
    bench.rest();
    assert_eq!(bench.view().range, fixed);
}

#[test]
fn a_dragged_box_has_figures() {
    let mut bench = showing_depth();
    let (from, to) = (bench.place_of((60, 30)), bench.place_of((99, 59)));
    bench.session_mut().apply(Command::Range(RangeChange::DrawRegion(true)));
    bench.rest();
    bench.drag(PointerButton::Primary, from, to - from);
    let region = PixelRegion { left: 60, top: 30, right: 100, bottom: 60 };
    assert_eq!(bench.session().features.range.region, Some(region));
    let measured = bench.view().look_result.measured.clone().expect("figures are wanted");
    let (of, channels) = measured.part.clone().expect("a box was drawn");
    let inside = (30..60).flat_map(|y| (60..100).map(move |x| (x, y)));
    let finite = inside.filter(|(x, y)| matches!(bench.view().value(*x, *y), Value::Number(_))).count();
    assert_eq!((of, channels[0].finite), (region, finite as u64));
    assert!(bench.says("Box 60, 30 · 40 × 30 px"));
    bench.click("Clear the box");
    assert_eq!(bench.session().features.range.region, None);
}

#[test]
fn channels_are_switched_off_and_shown_alone() {
    let mut bench = Bench::small("triangle");
    bench.session_mut().apply(Command::Range(RangeChange::Open(true)));
    bench.rest();
    let image = bench.image();
    bench.click("R");
    for (shown, drawn) in bench.view().picture.pixels().iter().zip(image.pixels()) {
        assert_eq!(*shown, [0, drawn[1], drawn[2], 255]);
    }
    bench.session_mut().apply(Command::Range(RangeChange::Solo(1)));
    bench.rest();
    for (shown, drawn) in bench.view().picture.pixels().iter().zip(image.pixels()) {
        assert_eq!(*shown, [drawn[1], drawn[1], drawn[1], 255]);
    }
    assert_eq!(bench.image(), image, "the frame itself stays");
}

#[test]
fn the_histogram_tab_has_figures_only_while_it_is_open() {
    let mut bench = Bench::small("triangle");
    assert!(bench.view().look_result.measured.is_none());
    bench.show_panel(Panel::Histogram);
    let measured = bench.view().look_result.measured.clone().expect("the tab wants figures");
    assert_eq!(measured.whole.len(), 3);
    let first = &measured.whole[0];
    assert_eq!(first.finite + first.nan + first.infinite, 160 * 90);
    bench.show_panel(Panel::Log);
    assert!(bench.view().look_result.measured.is_none());
}
