//! Tests of comparing pictures in the window: tiles, wipe, flip, difference, and errors against the reference.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use eframe::egui::{Event, Key, PointerButton, Pos2, Rect, Role, Vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterscope::chain::run;
use rasterscope::inspect::Stage;
use rasterscope::measure::error::compare;
use rasterscope::measure::region::PixelRegion;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::compare::Mode;
use rasterscope::ui::session::compare::compute::Compared;
use rasterscope::ui::session::window_task::DialogCommand;
use rasterscope::ui::session::workspace::Panel;
use rasterscope::upscale::{BUILT_IN, Scale, Upscaling};

use super::bench::Bench;

fn compared(bench: &Bench) -> &Compared {
    bench.session().features.comparison.compared.as_ref().expect("something is compared")
}

fn rect(bench: &Bench, picture: &str) -> Rect {
    bench.window.get_by_role_and_label(Role::Image, picture).rect()
}

/// Returns the screen position of a pixel's centre in the fitted picture of a tile, in points.
fn place_of(bench: &Bench, picture: &str, (x, y): (u32, u32)) -> Pos2 {
    let tile = rect(bench, picture);
    let viewport = bench.session().viewport();
    let size = Vec2::new(viewport.width as f32, viewport.height as f32);
    let exact = (tile.width() / size.x).min(tile.height() / size.y);
    let scale = if exact >= 1.0 { exact.floor() } else { exact };
    let corner = (tile.min + ((tile.size() - size * scale) / 2.0).floor()).round();
    corner + (Vec2::new(x as f32, y as f32) + Vec2::splat(0.5)) * scale
}

#[test]
fn two_tiles_show_two_recipes_with_figures_against_the_reference() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::T);
    let [a, b] = &compared(&bench).tiles[..] else { panic!("two tiles") };
    assert!(a.recipe.upscaler.is_native() && !b.recipe.upscaler.is_native());
    let request = bench.session().request();
    for tile in [a, b] {
        let frame = run(&request.scene, &request.camera, &tile.recipe, request.viewport, &mut ());
        assert_eq!(*tile.picture, *frame.image());
    }
    let figures = b.measured.as_ref().and_then(|measured| measured.figures).expect("measured");
    assert_eq!(Some(figures.codes), compare(&b.picture, &a.picture), "the reference is native");
    assert!(bench.mentions("Figures of A: PSNR identical"));
    assert!(bench.mentions(&format!("Figures of B: PSNR {:.2} dB", figures.codes.psnr_db)));
    rect(&bench, "Picture A");
    rect(&bench, "Picture B");
    bench.press(Key::T);
    assert!(!bench.session().features.comparison.is_on() && bench.session().features.comparison.compared.is_none());
    bench.canvas();
}

#[test]
fn clicking_a_tile_picks_the_pixel_and_explains_it_by_the_recipe_of_the_tile() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::T);
    let position = place_of(&bench, "Picture B", (80, 50));
    bench.click_at(position);
    assert_eq!(bench.session().pick, Some((80, 50)));
    assert_eq!(bench.session().state.tiles.active, 1);
    assert_eq!(bench.session().state.recipe, compared(&bench).tiles[1].recipe);
    assert_eq!(bench.view().request.recipe, compared(&bench).tiles[1].recipe);
    // Changes now apply to that tile only.
    bench.show_panel(Panel::Stages);
    bench.select(Stage::Cull);
    bench.choose("Culling", "None");
    let [a, b] = &compared(&bench).tiles[..] else { panic!("two tiles") };
    assert_ne!(a.recipe.pipeline.culling, b.recipe.pipeline.culling);
    bench.press_with(eframe::egui::Modifiers::COMMAND, Key::Z);
    let [a, b] = &compared(&bench).tiles[..] else { panic!("two tiles") };
    assert_eq!(a.recipe.pipeline.culling, b.recipe.pipeline.culling);
}

#[test]
fn all_tiles_show_every_upscaler_at_the_same_size() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::T);
    bench.click("All");
    assert_eq!(compared(&bench).tiles.len(), BUILT_IN.len());
    assert!(compared(&bench).complete);
    let sizes: Vec<_> =
        (b'A'..).take(BUILT_IN.len()).map(|l| rect(&bench, &format!("Picture {}", l as char)).size()).collect();
    assert!(sizes.iter().all(|size| (*size - sizes[0]).length() < 0.01), "{sizes:?}");
    bench.click("4 tiles");
    assert_eq!(compared(&bench).tiles.len(), 4);
    bench.click("Remove D");
    assert_eq!(compared(&bench).tiles.len(), 3);
}

#[test]
fn the_upscaler_of_a_tile_is_chosen_above_it() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::T);
    let wanted = Upscaling::new("lanczos3", 3).expect("there is one");
    bench.choose("Upscaler of B", &wanted.label());
    assert_eq!(compared(&bench).tiles[1].recipe.upscaler, wanted);
    assert!(bench.session().state.recipe.upscaler.is_native(), "A stays the active tile");
}

#[test]
fn the_line_of_the_wipe_is_dragged() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::W);
    let canvas = rect(&bench, "Compared pictures");
    bench.drag(PointerButton::Primary, canvas.center(), Vec2::new(-canvas.width() / 4.0, 0.0));
    let wipe = bench.session().features.comparison.wipe;
    assert!((wipe - 0.25).abs() < 0.02, "{wipe}");
    // Dragging elsewhere pans the picture and leaves the line.
    bench.drag(PointerButton::Primary, canvas.center(), Vec2::new(40.0, 0.0));
    assert_eq!(bench.session().features.comparison.wipe, wipe);
    bench.click_at(canvas.center());
    assert_eq!(bench.session().state.tiles.active, 1, "right of the line lies B");
}

#[test]
fn a_difference_is_amplified_and_its_kind_is_chosen() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::D);
    let first = compared(&bench).difference.clone().expect("there is a difference");
    bench.choose("Gain", "×16");
    let second = compared(&bench).difference.clone().expect("there is a difference");
    assert_eq!((first.kind.1, second.kind.1), (1, 16));
    assert_ne!(first.picture, second.picture);
    bench.choose("Difference to show", "FLIP");
    let flip = compared(&bench).difference.clone().expect("there is a difference");
    assert!(flip.values.pixels().iter().all(|value| (0.0..=1.0).contains(value)));
}

#[test]
fn a_dragged_rectangle_has_figures_of_its_own() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::T);
    bench.click("Region");
    let from = place_of(&bench, "Picture A", (60, 30));
    let to = place_of(&bench, "Picture A", (99, 59));
    bench.drag(PointerButton::Primary, from, to - from);
    let region = PixelRegion { left: 60, top: 30, right: 100, bottom: 60 };
    assert_eq!(bench.session().features.comparison.region, Some(region));
    let [a, b] = &compared(&bench).tiles[..] else { panic!("two tiles") };
    let within = b.region_figures.expect("the region is measured");
    assert_eq!(Some(within.codes), region.compare(&b.picture, &a.picture));
    bench.click("Clear the region");
    assert!(compared(&bench).tiles.iter().all(|tile| tile.region_figures.is_none()));
}

#[test]
fn a_saved_comparison_holds_the_pictures_the_errors_and_the_commands() {
    let mut bench = Bench::small("triangle");
    let folder = tempfile::tempdir().unwrap();
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.press(Key::D);
    bench.click("Save comparison (HTML)");
    let page = std::fs::read_to_string(folder.path().join("comparison.html")).expect("a page");
    let pictures = page.split("base64,").skip(1).map(|rest| {
        let text = rest.split('"').next().expect("the end of the attribute");
        image::load_from_memory(&BASE64_STANDARD.decode(text).expect("base64"))
            .expect("a picture")
            .into_rgba8()
            .into_raw()
    });
    let Compared { tiles, difference, .. } = compared(&bench);
    let shown = tiles.iter().map(|tile| &tile.picture).chain(difference.as_ref().map(|image| &image.picture));
    assert!(pictures.eq(shown.map(|picture| picture.as_bytes().to_vec())));
    let figures = tiles[1].measured.as_ref().and_then(|measured| measured.figures).expect("measured");
    let expected = format!("PSNR {:.2} dB · SSIM {:.4}", figures.codes.psnr_db, figures.codes.ssim);
    assert!(page.contains("PSNR identical") && page.contains(&expected), "{expected}");
    for method in [tiles[0].recipe.upscaler.method(), tiles[1].recipe.upscaler.method()] {
        let setting = format!("--set upscaler.method={method}");
        assert!(method == "native" || page.contains(&setting), "{setting}");
    }
}

#[test]
fn escape_stops_comparing_after_the_pick_is_dropped() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::B);
    assert_eq!(bench.session().features.comparison.mode, Mode::Flip);
    bench.press(Key::Escape);
    assert_eq!((bench.session().pick, bench.session().features.comparison.mode), (None, Mode::Flip));
    bench.press(Key::Escape);
    assert_eq!(bench.session().features.comparison.mode, Mode::Off);
}

/// Returns the accessible names of the frames of the filmstrip, from left to right.
fn strip(bench: &Bench) -> Vec<String> {
    let mut frames: Vec<_> = bench
        .window
        .query_all_by_role(Role::Button)
        .filter_map(|node| Some((node.rect().left(), node.accesskit_node().label()?)))
        .filter(|(_, label)| label.starts_with("Compare with "))
        .collect();
    frames.sort_by(|a, b| a.0.total_cmp(&b.0));
    frames.into_iter().map(|(_, label)| label).collect()
}

#[test]
fn the_filmstrip_has_a_frame_of_every_method_and_a_click_shows_it_as_b() {
    let mut bench = Bench::small("chess");
    bench.press(Key::T);
    bench.click("Filmstrip");
    let frames = strip(&bench);
    assert_eq!(frames.len(), BUILT_IN.len());
    assert!(frames.iter().all(|frame| frame.contains("FLIP ")), "every error is measured: {frames:?}");
    let drawn = bench.session().features.filmstrip.drawn.as_ref().expect("they are drawn");
    let request = bench.session().request();
    for tile in &drawn.tiles {
        if !tile.recipe.upscaler.upscaler().reads().history {
            let frame = run(&request.scene, &request.camera, &tile.recipe, request.viewport, &mut ());
            assert_eq!(*tile.picture, *frame.image(), "{}", tile.recipe.upscaler.label());
        }
    }
    let nearest = Upscaling::new("nearest", 4).unwrap();
    let label = frames.iter().find(|frame| frame.starts_with("Compare with Nearest ×4")).expect("it has a frame");
    bench.click(label);
    let recipe = bench.session().state.tiles.recipe(1, bench.session().state.recipe);
    assert_eq!(recipe.upscaler, nearest);
    bench.click("Filmstrip");
    assert!(strip(&bench).is_empty());
}

#[test]
fn the_filmstrip_is_sorted_by_error_and_has_one_scale() {
    let mut bench = Bench::small("chess");
    bench.press(Key::T);
    bench.click("Filmstrip");
    bench.window.get_by_label("Order of all methods").click();
    bench.rest();
    bench.click("By error");
    let flip = |frame: &str| frame.rsplit("FLIP ").next().and_then(|number| number.parse::<f64>().ok());
    let errors: Vec<_> = strip(&bench).iter().map(|frame| flip(frame).expect("it is measured")).collect();
    assert!(errors.is_sorted() && errors[0] < errors[errors.len() - 1], "{errors:?}");
    bench.window.get_by_label("Scale of all methods").click();
    bench.rest();
    bench.click("×2");
    assert!(strip(&bench).iter().any(|frame| frame.starts_with("Compare with Nearest ×2")));
    assert!(!strip(&bench).iter().any(|frame| frame.contains("×4")));
    bench.click("All");
    let scales: Vec<_> = compared(&bench).tiles.iter().map(|tile| tile.recipe.upscaler.scale()).collect();
    assert!(scales.iter().all(|scale| [Scale::ONE, Scale::TWO].contains(scale)), "{scales:?}");
}

#[test]
fn an_upscaler_process_that_cannot_be_added_is_refused_in_its_dialog() {
    let mut bench = Bench::small("triangle");
    let before = bench.session().state.recipe;
    for (text, reason) in [
        ("nearest=python3 net.py", "there is already an upscaler `nearest`; choose another id"),
        ("my-net:2=", "the command after `=` is empty"),
        ("My Net=python3 net.py", "`My Net` is not an id of an upscaler"),
    ] {
        bench.window.state_mut().queue(vec![Command::Dialog(DialogCommand::AddUpscaler)]);
        bench.rest();
        bench.window.event(Event::Text(text.to_owned()));
        bench.rest();
        bench.click("Add");
        assert!(bench.mentions(reason), "{text}");
        bench.click("Cancel");
        assert!(!bench.mentions(reason));
    }
    assert_eq!(bench.session().state.recipe, before);
}
