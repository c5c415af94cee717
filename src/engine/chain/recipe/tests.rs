use super::*;
use crate::pipeline::settings::{Culling, Shading};

#[test]
fn settings_are_reached_by_dotted_keys_in_either_case() {
    let mut recipe = Recipe::default();
    for assignment in [
        "shading=gouraud",
        "culling=none",
        "color-space=bytes",
        "light.direction=1,2,3",
        "light.ambient=0.5",
        "fill_rule=top_left",
    ] {
        recipe.set(assignment).unwrap();
    }
    assert_eq!(recipe.pipeline.shading, Shading::Gouraud);
    assert_eq!(recipe.pipeline.culling, Culling::None);
    assert_eq!(recipe.pipeline.light.direction, glam::Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(recipe.pipeline.light.ambient, 0.5);
}

#[test]
fn wrong_settings_are_named_and_change_nothing() {
    let mut recipe = Recipe::default();
    for (assignment, word) in [
        ("shading", "key=value"),
        ("shadign=gouraud", "fill_rule"),
        ("shading=phong", "lambert"),
        ("light=1", "light.direction"),
        ("light.direction=1,2", "3 comma-separated numbers"),
        ("light.direction=0,0,0", "zero"),
        ("light.ambient=2", "0…1"),
        ("wireframe=maybe", "true"),
        ("mip_bias=-4.5", "-4…4"),
        ("upscaler.method=dlss", "native"),
        ("upscaler.scale=3", "offers"),
    ] {
        let message = recipe.set(assignment).unwrap_err().to_string();
        assert!(message.contains(word), "{assignment}: {message}");
    }
    assert_eq!(recipe, Recipe::default());
}

#[test]
fn the_scale_may_precede_its_method() {
    let mut recipe = Recipe::default();
    recipe.set_all(&["upscaler.scale=4", "upscaler.method=bicubic"]).unwrap();
    assert_eq!((recipe.upscaler.method(), recipe.upscaler.scale()), ("bicubic", Scale::FOUR));
    let before = recipe;
    assert!(recipe.set_all(&["wireframe=true", "Upscaler.scale=2"]).is_err(), "keys are in lower case");
    assert!(recipe.set_all(&["wireframe=true", "upscaler.scale=5"]).is_err());
    assert_eq!(recipe, before);
}

#[test]
fn a_method_chosen_by_name_has_the_configuration_that_the_registry_gives_it() {
    for upscaler in Upscaling::every() {
        let mut recipe = Recipe::default();
        let scale = format!("upscaler.scale={}", upscaler.scale());
        let method = format!("upscaler.method={}", upscaler.method());
        recipe.set_all(&[&scale, &method]).unwrap();
        assert_eq!(recipe.upscaler, upscaler, "from native");
        let mut after_another = Recipe::default();
        let other = if upscaler.method() == "bicubic" { "bilinear" } else { "bicubic" };
        let other = format!("upscaler.method={other}");
        after_another.set_all(&[other.as_str(), "upscaler.anchor=centre", "upscaler.light=linear"]).unwrap();
        after_another.set_all(&[&scale, &method]).unwrap();
        assert_eq!(after_another.upscaler, upscaler, "after another method with its own options");
        let short = format!("{{\"method\":\"{}\",\"scale\":{}}}", upscaler.method(), upscaler.scale());
        let parsed = serde_json::from_str::<Upscaling>(&short).unwrap();
        assert_eq!(parsed, upscaler, "from a file without anchor and light");
    }
}

#[test]
fn temporal_upscalers_of_fewer_samples_want_a_negative_mip_bias() {
    for (method, scale, expected) in
        [("fsr2", 2.0, -2.0), ("fsr2", 1.5, -1.58), ("taa", 1.0, 0.0), ("bicubic", 2.0, 0.0), ("native", 1.0, 0.0)]
    {
        let upscaler = Upscaling::new(method, scale).unwrap();
        assert_eq!(Recipe { upscaler, ..Recipe::default() }.recommended_mip_bias(), expected, "{method} {scale}");
    }
}

#[test]
fn filter_strengths_are_limited_by_the_largest_mask() {
    for (filter, most, beyond) in [("blur", 15.0, "16"), ("gaussian", 5.0, "5.5"), ("motion", 30.0, "31")] {
        let mut recipe = Recipe::default();
        let set = [format!("post.strength={most}"), format!("post.filter={filter}")];
        recipe.set_all(&set).unwrap();
        let message = recipe.set(&format!("post.strength={beyond}")).unwrap_err().to_string();
        assert_eq!(
            message,
            format!("post.strength: the strength of the filter `{filter}` must lie in 0…{most}, not {beyond}")
        );
        recipe.set("post.filter=gaussian").unwrap();
        assert_eq!(recipe.post.strength, 5.0, "the strength is clamped to the range of the new filter");
    }
}

#[test]
fn recipes_survive_json() {
    let text = serde_json::to_string(&Recipe::default()).unwrap();
    assert_eq!(serde_json::from_str::<Recipe>(&text).unwrap(), Recipe::default());
}

#[test]
fn numbers_of_files_are_checked() {
    let mut recipe = Recipe::default();
    assert_eq!(recipe.check(), Ok(()));
    recipe.pipeline.checker.squares = f32::INFINITY;
    assert_eq!(recipe.check(), Err("checker.squares: must be finite".to_owned()));
    recipe = Recipe::default();
    recipe.pipeline.light.ambient = 1.5;
    assert_eq!(recipe.check(), Err("light.ambient: must lie in 0…1, not 1.5".to_owned()));
}
