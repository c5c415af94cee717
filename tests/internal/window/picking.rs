//! Tests of picking pixels by pointer, by keys and by coordinates, and of the explanations of the inspector.

use eframe::egui::{Key, Modifiers, PointerButton, Vec2};
use rasterscope::chain::Recipe;
use rasterscope::inspect::{Buffer, Stage};
use rasterscope::pipeline::settings::{Choice as _, Culling, DepthFormat};
use rasterscope::ui;
use rasterscope::ui::engine::Shown;
use rasterscope::ui::session::PictureSize;

use super::bench::Bench;

#[test]
fn a_new_window_explains_a_pixel_of_its_scene() {
    let bench = Bench::new("chess");
    let (x, y) = bench.session().pick.expect("a pixel is picked at first");
    let report = bench.view().report.clone().expect("it is explained");
    assert!(bench.says(&format!("Pixel {x}, {y}")));
    assert!(bench.says(&report.verdict), "{}", report.verdict);
    assert!(report.verdict.contains("triangle"), "a triangle is visible there: {}", report.verdict);
}

#[test]
fn the_inspector_shows_the_colour_that_the_chain_draws() {
    let mut bench = Bench::small("chess");
    let frame = bench.expected();
    for pixel in [(12, 20), (80, 45), (150, 88)] {
        let place = bench.place_of(pixel);
        bench.click_at(place);
        let [r, g, b, a] = frame.image().at(pixel.0, pixel.1);
        assert_eq!(bench.view().report.as_ref().map(|report| report.color), Some([r, g, b, a]));
        assert!(bench.says(&format!("{r} {g} {b}")), "{pixel:?}");
    }
}

#[test]
fn the_inspector_shows_depths_with_their_code_and_their_step_in_world_units() {
    let mut bench = Bench::small("triangle");
    let place = bench.place_of((80, 45));
    bench.click_at(place);
    bench.select(Stage::Depth);
    for format in DepthFormat::ALL {
        if *format != Recipe::default().pipeline.depth_format {
            bench.choose("Format", format.name());
        }
        assert_eq!(bench.session().state.recipe.pipeline.depth_format, *format);
        let report = bench.view().report.clone().expect("a pixel is picked");
        let depth = report.visible().expect("a triangle is there").depth;
        assert!(bench.says(&ui::format::f32_full(depth.value)), "{format:?}");
        assert!(bench.says(&ui::format::f32_full(depth.resolution as f32)), "{format:?}");
        match depth.code {
            Some(code) => assert!(bench.says(&code.to_string()), "{format:?}"),
            None => assert!(!bench.says("Stored as integer"), "{format:?}"),
        }
    }
}

#[test]
fn a_click_picks_the_pixel_under_the_pointer() {
    let mut bench = Bench::small("triangle");
    for pixel in [(0, 0), (159, 0), (0, 89), (159, 89), (77, 31)] {
        let place = bench.place_of(pixel);
        bench.click_at(place);
        assert_eq!(bench.session().pick, Some(pixel));
        assert!(bench.says(&format!("Pixel {}, {}", pixel.0, pixel.1)));
    }
    let outside = bench.place_of((0, 0)) - Vec2::splat(8.0);
    bench.click_at(outside);
    assert_eq!(bench.session().pick, Some((77, 31)), "there is no pixel beside the picture");
}

#[test]
fn at_the_canvas_s_own_size_picture_pixels_are_screen_pixels() {
    let mut bench = Bench::new("triangle");
    bench.session_mut().state.size = PictureSize::MatchWindow;
    bench.rest();
    let corner = bench.canvas().min;
    let (width, height) = bench.image().size();
    assert_eq!(bench.canvas().size().floor(), Vec2::new(width as f32, height as f32));
    bench.click_at(corner + Vec2::new(123.5, 45.5));
    assert_eq!(bench.session().pick, Some((123, 45)));
}

#[test]
fn pixels_are_picked_along_a_right_drag() {
    let mut bench = Bench::small("triangle");
    let (from, to) = (bench.place_of((20, 20)), bench.place_of((60, 50)));
    bench.drag(PointerButton::Secondary, from, to - from);
    assert_eq!(bench.session().pick, Some((60, 50)));
}

#[test]
fn the_pointer_line_reads_the_pixel_under_it() {
    let mut bench = Bench::small("chess");
    let place = bench.place_of((33, 44));
    bench.window.hover_at(place);
    bench.rest();
    let [r, g, b, _] = bench.image().at(33, 44);
    assert!(bench.says(&format!("33, 44   {r} {g} {b}")));
}

#[test]
fn arrows_nudge_the_pick_and_stop_at_the_border() {
    let mut bench = Bench::small("triangle");
    let place = bench.place_of((80, 40));
    bench.click_at(place);
    let steps: [(Modifiers, Key, (u32, u32)); 8] = [
        (Modifiers::NONE, Key::ArrowLeft, (79, 40)),
        (Modifiers::NONE, Key::ArrowUp, (79, 39)),
        (Modifiers::NONE, Key::ArrowRight, (80, 39)),
        (Modifiers::NONE, Key::ArrowDown, (80, 40)),
        (Modifiers::SHIFT, Key::ArrowDown, (80, 50)),
        (Modifiers::SHIFT, Key::ArrowRight, (90, 50)),
        (Modifiers::SHIFT, Key::ArrowUp, (90, 40)),
        (Modifiers::SHIFT, Key::ArrowLeft, (80, 40)),
    ];
    for (modifiers, key, pixel) in steps {
        bench.press_with(modifiers, key);
        assert_eq!(bench.session().pick, Some(pixel), "{modifiers:?} {key:?}");
        assert_eq!(bench.view().report.as_ref().map(|r| (r.x, r.y)), Some(pixel));
    }
    let corner = bench.place_of((0, 89));
    bench.click_at(corner);
    bench.press(Key::ArrowLeft);
    bench.press_with(Modifiers::SHIFT, Key::ArrowDown);
    assert_eq!(bench.session().pick, Some((0, 89)));
}

#[test]
fn escape_drops_the_pick_first_and_the_shown_stage_next() {
    let mut bench = Bench::small("triangle");
    bench.click_eye(Stage::Shade);
    bench.press(Key::Home);
    assert!(bench.session().pick.is_some() && bench.session().features.scrub.triangle_limit == Some(0));
    bench.press(Key::Escape);
    assert_eq!(bench.session().pick, None);
    assert!(bench.says("No pixel picked"));
    assert!(matches!(bench.session().shown, Shown::Stage(_)), "one thing at a time");
    bench.press(Key::Escape);
    assert_eq!(bench.session().shown, Shown::Buffer(Buffer::Color));
    assert_eq!(bench.session().features.scrub.triangle_limit, None);
}

#[test]
fn a_pixel_is_picked_by_its_coordinates() {
    let mut bench = Bench::small("triangle");
    bench.press_with(Modifiers::COMMAND, Key::G);
    assert!(bench.says("Column and row, from 0,0 to 159,89."));
    bench.window.event(eframe::egui::Event::Text("160,0".to_owned()));
    bench.press(Key::Enter);
    assert!(bench.says("Go to"), "there is no such pixel, so the dialog stays");
    for _ in 0..5 {
        bench.press(Key::Backspace);
    }
    bench.window.event(eframe::egui::Event::Text("12,34".to_owned()));
    bench.press(Key::Enter);
    assert_eq!(bench.session().pick, Some((12, 34)));
    assert!(!bench.says("Go to"));
}

#[test]
fn a_remedy_is_applied_by_its_button_and_undone() {
    let mut bench = Bench::small("triangle");
    let place = bench.place_of((84, 44));
    bench.click_at(place);
    assert!(!bench.mentions("Turn culling off"));
    bench.session_mut().state.recipe.pipeline.culling = Culling::Front;
    bench.rest();
    assert!(bench.mentions("Background: triangle 0"));
    bench.click("Turn culling off");
    assert_eq!(bench.session().state.recipe.pipeline.culling, Culling::None);
    assert!(bench.mentions("Won by triangle 0") && !bench.mentions("Turn culling off"));
    bench.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.session().state.recipe.pipeline.culling, Culling::Front);
}
