//! Tests of error against time in the window, and of the analysis of the upscaler.

use eframe::egui::{Modifiers, Pos2, Role, Vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::measure::against::figures;
use rasterscope::measure::metric::Metric;
use rasterscope::measure::motion::Turn;
use rasterscope::report::upscaling::tradeoff::Standing;
use rasterscope::ui::session::PictureSize;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::compare::Mode;
use rasterscope::ui::session::timings::TimingsChange;
use rasterscope::ui::session::workspace::Panel;
use rasterscope::upscale::Upscaling;

use super::bench::Bench;

#[test]
fn every_upscaler_becomes_a_point_with_its_error_against_native() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::ErrorTime);
    assert!(bench.mentions("No measurement yet"));
    bench.click("Measure error and time");
    let points = bench.session().features.timings.tradeoff();
    assert_eq!(points.len(), Upscaling::every().count());
    let native = points.iter().find(|point| point.upscaling.is_native()).expect("native is measured");
    assert_eq!(native.error.still.codes.mse, 0.0);
    // At rest, other methods have no error either; the fastest of these is on the Pareto front.
    assert!(points.iter().any(|point| point.error.still.codes.mse == 0.0 && point.standing == Some(Standing::Front)));
    for point in &points {
        if let Some(Standing::Beaten(by)) = point.standing {
            let better = points.iter().find(|other| other.upscaling == by).expect("it is one of them");
            assert!(better.ms.median <= point.ms.median && better.error.still.flip <= point.error.still.flip);
        }
    }
    assert!(bench.mentions("noise floor ±") && bench.mentions("· still ·"));
    // The error matches the picture that the window draws with this method.
    let wanted = Upscaling::new("nearest", 4).expect("there is one");
    let before = bench.image();
    let recipe = rasterscope::chain::Recipe { upscaler: wanted, ..bench.session().state.recipe };
    bench.session_mut().state.recipe = recipe;
    bench.rest();
    let (expected, _) = figures(&bench.image(), &before).expect("same size");
    let point = points.iter().find(|point| point.upscaling == wanted).expect("it is measured");
    assert_eq!((point.error.still, point.error.motion.mean), (expected, expected));
}

#[test]
fn any_metric_ranks_the_upscalers_and_slow_ones_need_a_measurement() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::ErrorTime);
    bench.click("Measure error and time");
    let choose = |bench: &mut Bench, metric: Metric| {
        bench.session_mut().apply(Command::Timings(TimingsChange::Metric(metric)));
        bench.rest();
    };
    // A budget that every method keeps, however slow the machine is.
    bench.session_mut().apply(Command::Timings(TimingsChange::Budget(10_000.0)));
    choose(&mut bench, Metric::Psnr);
    for point in bench.session().features.timings.tradeoff() {
        assert_eq!((point.metric, point.mean()), (Metric::Psnr, point.error.motion.mean.codes.psnr_db));
        let label = format!("Point: {},", point.upscaling.label());
        assert!(bench.mentions(&label), "{label}");
    }
    assert!(bench.mentions("highest PSNR within"));
    choose(&mut bench, Metric::Ssimulacra2);
    assert!(bench.mentions("SSIMULACRA2 is not in this measurement, FLIP is shown"));
    bench.click("Measure error and time");
    let points = bench.session().features.timings.tradeoff();
    assert!(points.iter().all(|point| point.metric == Metric::Ssimulacra2 && point.mean() <= 100.0));
}

#[test]
fn errors_are_measured_in_motion_unless_the_still_view_is_chosen() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::ErrorTime);
    bench.click("In motion (0.5° per frame)");
    assert_eq!(bench.session().features.timings.turn, Turn::default());
    bench.click("Still");
    assert_eq!(bench.session().features.timings.turn, Turn::STILL);
    bench.session_mut().state.size = PictureSize::Fixed(48, 27);
    bench.session_mut().settle_silently();
    bench.session_mut().features.timings.turn = Turn { degrees: 4.0, frames: 2, ..Turn::STILL };
    bench.rest();
    bench.click("Measure error and time");
    assert!(bench.mentions("in motion: 2 of 2 frames, 4° per frame"));
    let points = bench.session().features.timings.tradeoff();
    assert!(points.iter().all(|point| point.error.motion.frames == 2));
    let temporal = Upscaling::new("checkerboard-temporal", 1).expect("there is one");
    let point = points.iter().find(|point| point.upscaling == temporal).expect("it is measured");
    assert!(point.error.still.codes.mse == 0.0 && point.error.motion.mean.codes.mse > 0.0, "{:?}", point.error);
}

#[test]
fn a_row_becomes_picture_a_or_b() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::ErrorTime);
    bench.click("Measure error and time");
    let (first, second) = (Upscaling::new("lanczos3", 2), Upscaling::new("nearest", 4));
    let (first, second) = (first.expect("there is one"), second.expect("there is one"));
    bench.click(&format!("Show {} as B", first.label()));
    assert_eq!(bench.session().features.comparison.mode, Mode::Wipe);
    bench.show_panel(Panel::ErrorTime);
    bench.click(&format!("Show {} as A", second.label()));
    let tiles = &bench.session().features.comparison.compared.as_ref().expect("two are compared").tiles;
    assert_eq!([tiles[0].recipe.upscaler, tiles[1].recipe.upscaler], [second, first]);
}

/// Returns the points of the plot with their screen positions, most isolated first, so that a click cannot hit another
/// point.
fn lonely_points(bench: &Bench) -> Vec<(Upscaling, Pos2)> {
    let place = |upscaling: Upscaling| {
        let name = format!("Point: {},", upscaling.label());
        bench.window.query_all_by_label_contains(&name).next().expect("every point is named").rect().center()
    };
    let points = bench.session().features.timings.tradeoff();
    let places: Vec<_> = points.iter().map(|point| (point.upscaling, place(point.upscaling))).collect();
    let room = |of: &(Upscaling, Pos2)| {
        let others = places.iter().filter(|other| other.0 != of.0);
        others.map(|other| other.1.distance(of.1)).fold(f32::INFINITY, f32::min)
    };
    // The line of the time budget takes clicks beside it.
    let line = bench.window.get_by_role_and_label(Role::Splitter, "Time budget").rect().center().x;
    let mut lonely: Vec<_> = places.iter().copied().filter(|(_, place)| (place.x - line).abs() > 16.0).collect();
    lonely.sort_by(|a, b| room(b).total_cmp(&room(a)));
    lonely
}

#[test]
fn a_point_of_the_plot_becomes_picture_b_and_with_shift_a() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::ErrorTime);
    bench.click("Measure error and time");
    let (second, place) = lonely_points(&bench)[0];
    bench.click_at(place);
    assert_eq!(bench.session().features.comparison.mode, Mode::Wipe);
    bench.show_panel(Panel::ErrorTime);
    let (first, place) = lonely_points(&bench)[1];
    bench.click_at_with(Modifiers::SHIFT, place);
    let tiles = &bench.session().features.comparison.compared.as_ref().expect("two are compared").tiles;
    assert_eq!([tiles[0].recipe.upscaler, tiles[1].recipe.upscaler], [first, second]);
}

#[test]
fn the_method_of_the_point_under_the_pointer_is_shared() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::ErrorTime);
    bench.click("Measure error and time");
    let (upscaling, place) = lonely_points(&bench)[0];
    bench.window.hover_at(place);
    bench.rest();
    assert_eq!(bench.session().features.timings.list.hovered(), Some(upscaling));
    bench.window.hover_at(Pos2::new(1.0, 1.0));
    bench.rest();
    assert_eq!(bench.session().features.timings.list.hovered(), None);
}

#[test]
fn a_measurement_says_which_reference_it_is_against() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::ErrorTime);
    bench.click("Measure error and time");
    assert!(bench.mentions("Reference: Native, 1 sample"));
    bench.choose("Reference to measure against", "Converged, 256 samples");
    assert!(bench.mentions("Reference: Native, 1 sample"), "until it is measured again");
    bench.click("Measure error and time");
    assert!(bench.mentions("Reference: Converged, 256 samples"));
    let points = bench.session().features.timings.tradeoff();
    let native = points.iter().find(|point| point.upscaling.is_native()).expect("native is measured");
    assert!(native.error.still.codes.mse > 0.0, "edges of one sample per pixel have aliasing");
    assert_eq!(points.len(), Upscaling::every().count());
}

#[test]
fn the_picked_pixel_s_samples_are_shown_with_their_weights() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::FilterTaps);
    bench.session_mut().state.recipe.set_all(&["upscaler.method=bilinear", "upscaler.scale=4"]).unwrap();
    bench.session_mut().pick = Some((82, 50));
    bench.rest();
    // The pixel lies half way between columns 80 and 84, and between rows 48 and 52.
    for (x, y) in [(80, 48), (84, 48), (80, 52), (84, 52)] {
        assert!(bench.says(&format!("Sample {x}, {y}: weight 0.25")), "{x}, {y}");
    }
    assert!(bench.mentions("Pixel 82, 50 · Bilinear ×4 · 4 samples"));
    assert!(bench.mentions("contributes to 49 pixels"), "a tent of ±4 px, without its ends");
    let plate = bench.window.get_by_role_and_label(Role::Image, "Zone plate").rect();
    assert!(plate.size() != Vec2::ZERO);
    bench.session_mut().pick = None;
    bench.rest();
    assert!(bench.mentions("No pixel picked"));
}
