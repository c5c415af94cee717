//! Tests of the rows of the pipeline panel: an option chosen there is drawn, and can be undone.

use eframe::egui::{Event, Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterscope::chain::Recipe;
use rasterscope::inspect::Stage;
use rasterscope::pipeline::background::Background;
use rasterscope::pipeline::settings::{Choice as _, Culling, DepthFormat, DepthTest, FillRule, Interpolation, Shading};
use rasterscope::ui::session::PictureSize;
use rasterscope::upscale;

use super::bench::Bench;

/// A change in the panel: scene, stage to select first, row, option, and the same change of the recipe.
type Case = (&'static str, Stage, &'static str, &'static str, fn(&mut Recipe));

#[test]
fn an_option_chosen_in_a_row_is_drawn() {
    let cases: [Case; 7] = [
        ("triangle", Stage::Cull, "Culling", Culling::Front.name(), |r| r.pipeline.culling = Culling::Front),
        ("triangle", Stage::Shade, "Shading", Shading::Normals.name(), |r| r.pipeline.shading = Shading::Normals),
        ("shared-edges", Stage::Rasterize, "Fill rule", FillRule::Exclusive.name(), |r| {
            r.pipeline.fill_rule = FillRule::Exclusive;
        }),
        ("interpenetrating", Stage::Depth, "Test", DepthTest::Off.name(), |r| {
            r.pipeline.depth_test = DepthTest::Off;
        }),
        ("z-fighting", Stage::Depth, "Format", DepthFormat::ReversedF32.name(), |r| {
            r.pipeline.depth_format = DepthFormat::ReversedF32;
        }),
        ("triangle", Stage::Interpolate, "Attributes", Interpolation::Affine.name(), |r| {
            r.pipeline.interpolation = Interpolation::Affine;
        }),
        ("triangle", Stage::Upscale, "Method", "Checkerboard", |r| r.set("upscaler.method=checkerboard").unwrap()),
    ];
    for (scene, stage, row, option, change) in cases {
        let mut bench = Bench::new(scene);
        let before = bench.image();
        bench.select(stage);
        bench.choose(row, option);
        let mut recipe = Recipe::default();
        change(&mut recipe);
        assert_eq!(bench.session().state.recipe, recipe, "{row}: {option}");
        assert_ne!(bench.image(), before, "{row}: {option} changes the picture of {scene}");
        assert_eq!(bench.image(), *bench.expected().image(), "{row}: {option}");
    }
}

#[test]
fn settings_are_undone_and_redone_one_by_one() {
    let mut bench = Bench::small("triangle");
    let start = bench.image();
    bench.select(Stage::Shade);
    bench.choose("Shading", Shading::Normals.name());
    let normals = bench.image();
    bench.select(Stage::Cull);
    bench.choose("Culling", Culling::Front.name());
    let culled = bench.image();
    assert!(start != normals && normals != culled);

    for expected in [&normals, &start, &start] {
        bench.press_with(Modifiers::COMMAND, Key::Z);
        assert_eq!(&bench.image(), expected);
    }
    for expected in [&normals, &culled, &culled] {
        bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        assert_eq!(&bench.image(), expected);
    }
    bench.click("Edit");
    bench.click("Undo Ctrl + Z");
    assert_eq!(bench.image(), normals);
}

#[test]
fn a_setting_after_undo_clears_redo() {
    let mut bench = Bench::small("triangle");
    bench.select(Stage::Shade);
    bench.choose("Shading", Shading::Normals.name());
    bench.press_with(Modifiers::COMMAND, Key::Z);
    bench.select(Stage::Cull);
    bench.choose("Culling", Culling::Front.name());
    assert!(!bench.session().can_redo());
    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(bench.session().state.recipe.pipeline.shading, Recipe::default().pipeline.shading);
}

#[test]
fn all_settings_are_reset_by_one_button_and_by_one_undo_back() {
    let mut bench = Bench::small("triangle");
    bench.select(Stage::Shade);
    bench.choose("Shading", Shading::Normals.name());
    bench.select(Stage::Cull);
    bench.choose("Culling", Culling::None.name());
    let changed = bench.session().state.recipe;
    bench.click("Reset all settings");
    assert_eq!(bench.session().state.recipe, Recipe::default());
    bench.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.session().state.recipe, changed);
}

#[test]
fn number_keys_choose_the_first_nine_upscalers_in_their_order() {
    let mut bench = Bench::small("triangle");
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];
    assert!(keys.len() <= upscale::BUILT_IN.len());
    for (key, upscaler) in keys.into_iter().zip(upscale::BUILT_IN).rev() {
        bench.press(key);
        assert_eq!(bench.session().state.recipe.upscaler.method(), upscaler.id());
        assert_eq!(bench.image(), *bench.expected().image());
    }
}

#[test]
fn settings_that_the_scene_cannot_use_are_replaced_by_the_reason() {
    let offers = |bench: &Bench, row: &str| bench.says(row);
    let mut untextured = Bench::small("triangle");
    untextured.select(Stage::Shade);
    assert!(!offers(&untextured, "Filter") && !offers(&untextured, "Texture wrap"));
    assert!(untextured.mentions("the mesh has no texture coordinates"));
    let mut textured = Bench::small("chess");
    textured.select(Stage::Shade);
    assert!(offers(&textured, "Filter") && offers(&textured, "Texture wrap"));
}

#[test]
fn a_depth_format_is_offered_only_with_a_depth_test() {
    let mut bench = Bench::small("interpenetrating");
    bench.select(Stage::Depth);
    assert!(bench.says("Format"));
    bench.choose("Test", DepthTest::Off.name());
    assert!(!bench.says("Format"));
    assert!(bench.mentions("no depth is stored"));
}

#[test]
fn a_depth_bias_is_offered_only_with_a_depth_test() {
    let mut bench = Bench::small("interpenetrating");
    bench.select(Stage::Depth);
    assert!(bench.says("Constant bias") && bench.says("Slope-scaled bias"));
    bench.session_mut().state.recipe.pipeline.depth_bias.slope = 2.0;
    bench.rest();
    assert_eq!(bench.image(), *bench.expected().image());
    bench.choose("Test", DepthTest::Off.name());
    assert!(!bench.says("Constant bias") && bench.mentions("no format and no bias"));
}

#[test]
fn a_button_restores_the_background_of_the_scene() {
    let mut bench = Bench::small("triangle");
    bench.select(Stage::Shade);
    let (plain, color) = (bench.image(), [0xd0, 0x40, 0x10]);
    bench.session_mut().state.recipe.pipeline.background = Background::Color(color);
    bench.rest();
    assert_eq!(bench.image().at(0, 0)[..3], color);
    bench.click("Use scene colour");
    assert_eq!(bench.session().state.recipe, Recipe::default());
    assert_eq!(bench.image(), plain);
}

#[test]
fn a_far_plane_is_offered_only_where_there_is_one() {
    let mut bench = Bench::small("interpenetrating");
    bench.select(Stage::Transform);
    assert!(bench.says("Far plane"));
    bench.select(Stage::Depth);
    bench.choose("Format", DepthFormat::ReversedInfinite.name());
    bench.select(Stage::Transform);
    assert!(!bench.says("Far plane") && bench.mentions("the far plane is at infinity"));
    bench.choose("Projection", "Orthographic");
    assert!(bench.says("Far plane"), "an orthographic view has a far plane");
}

#[test]
fn light_is_offered_only_where_it_is_computed() {
    let mut bench = Bench::small("triangle");
    bench.select(Stage::Shade);
    assert!(bench.says("Ambient"));
    bench.choose("Shading", Shading::Normals.name());
    assert!(!bench.says("Ambient"));
}

#[test]
fn the_picture_size_is_chosen_in_the_toolbar() {
    let mut bench = Bench::new("triangle");
    assert_eq!(bench.image().size(), (480, 270));
    bench.click("480 × 270");
    bench.click("320 × 180");
    assert_eq!(bench.session().state.size, PictureSize::Fixed(320, 180));
    assert_eq!(bench.image().size(), (320, 180));
    bench.click("320 × 180");
    bench.click("Match window");
    assert_eq!(bench.image().size(), bench.session().features.canvas.size_px);
}

#[test]
fn tabbing_through_the_fields_changes_nothing() {
    for (stage, change) in [
        (Stage::Shade, "light.direction=0.3,0.7,0.2"),
        (Stage::Shade, "light.ambient=0.123456789"),
        (Stage::Upscale, "antialias.method=jittered"),
        (Stage::Depth, "depth_bias.slope=0.123456789"),
    ] {
        let mut bench = Bench::small("cubes");
        bench.session_mut().state.recipe.set(change).unwrap();
        bench.session_mut().state.recipe.antialias.seed = 0x1234_5678;
        bench.session_mut().settle_silently();
        bench.select(stage);
        let recipe = bench.session().state.recipe;
        let mut fields = 0;
        for _ in 0..120 {
            bench.window.key_press(Key::Tab);
            bench.window.run_steps(2);
            fields += usize::from(bench.window.ctx.text_edit_focused());
            assert_eq!(bench.session().state.recipe, recipe, "{change}");
        }
        assert!(fields > 0, "{change}: a number field was focused");
        let bits = |recipe: &Recipe| recipe.pipeline.light.direction.to_array().map(f32::to_bits);
        assert_eq!(bits(&bench.session().state.recipe), bits(&recipe));
    }
}

#[test]
fn typed_numbers_are_taken_over() {
    let mut bench = Bench::small("triangle");
    bench.select(Stage::Shade);
    let field = bench.window.get_all_by_role_and_label(Role::SpinButton, "Ambient").next().unwrap();
    field.focus();
    bench.rest();
    bench.press_with(Modifiers::COMMAND, Key::A);
    bench.window.event(Event::Text("0,75".to_owned()));
    bench.press(Key::Tab);
    assert_eq!(bench.session().state.recipe.pipeline.light.ambient, 0.75);
}
