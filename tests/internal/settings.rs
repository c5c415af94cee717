//! Checks that every setting has an effect: none is declared, listed and stored, but never read.

use std::sync::Arc;

use crate::internal::common::{assignments_of, ground_and_cube, recipe, transparency_scene};
use rasterscope::chain::{KeepDepth, Recipe, Renderer, SettingKey};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Scene, builtin};

/// Size of the pictures.
const SIZE: Viewport = Viewport { width: 24, height: 16 };

/// Number of frames that are drawn with an upscaler that reads earlier frames.
const FRAMES: u8 = 3;

/// Angle by which the camera orbits between two frames, in radians.
const TURN: f32 = 0.02;

/// Settings under which other settings have an effect.
const CONTEXTS: [&[&str]; 11] = [
    &[],
    &["filter=trilinear"],
    &["filter=anisotropic"],
    &["shading=checker"],
    &["antialias.method=jittered"],
    &["post.filter=blur"],
    &["post.filter=motion", "post.strength=9"],
    &["post.filter=own"],
    &["upscaler.method=lanczos3", "upscaler.scale=2"],
    &["upscaler.method=fsr1", "upscaler.scale=2"],
    &["upscaler.method=taa"],
];

/// Settings that change no picture by design, as other tests check.
const WITHOUT_EFFECT: [SettingKey; 2] = [SettingKey::Execution, SettingKey::Force];

/// Scene with a recipe, and the picture that they give.
struct Context {
    scene: Arc<Scene>,
    recipe: Recipe,
    picture: Image<Rgba8>,
}

impl Context {
    fn new(scene: &Arc<Scene>, assignments: &[&str]) -> Self {
        let recipe = recipe(assignments);
        Self { scene: Arc::clone(scene), recipe, picture: picture(scene, &recipe) }
    }

    /// Whether a value of the setting changes the picture.
    fn is_changed_by(&self, key: SettingKey) -> bool {
        assignments_of(key).iter().any(|assignment| {
            let mut changed = self.recipe;
            changed.set(assignment).is_ok() && picture(&self.scene, &changed) != self.picture
        })
    }
}

/// Returns the picture of the home view; with history, the last of several frames of an orbiting camera.
fn picture(scene: &Arc<Scene>, recipe: &Recipe) -> Image<Rgba8> {
    let mut renderer = Renderer::default();
    let frames = if recipe.upscaler.upscaler().reads().history { FRAMES } else { 1 };
    let pictures = (0..frames).rev().map(|frames_left| {
        let mut camera = scene.home;
        camera.orbit(TURN * f32::from(frames_left), 0.0);
        renderer.render(scene, &camera, recipe, SIZE, KeepDepth::Yes).image().clone()
    });
    pictures.last().expect("at least one frame")
}

#[test]
fn every_setting_changes_a_picture() {
    let [shared_edges, chess] = ["shared-edges", "chess"].map(|id| builtin::by_id(id).expect("its id").build());
    let scenes = [ground_and_cube(), transparency_scene(), shared_edges, chess].map(Arc::new);
    let of_scene = |scene| CONTEXTS.iter().map(move |assignments| Context::new(scene, assignments));
    let contexts: Vec<_> = scenes.iter().flat_map(of_scene).collect();
    let has_effect = |key: &&SettingKey| contexts.iter().any(|context| context.is_changed_by(**key));
    let others = SettingKey::ALL.iter().filter(|key| !WITHOUT_EFFECT.contains(key));
    let unread: Vec<_> = others.filter(|key| !has_effect(key)).map(|key| key.id()).collect();
    assert!(unread.is_empty(), "no picture changes with {unread:?}");
}
