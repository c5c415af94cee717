//! Checks that every setting has an effect: none is declared, listed and stored, but never read.

use std::sync::Arc;

use crate::internal::common::{ground_and_cube, picture_in_motion, transparency_scene};
use crate::internal::switches::{WITHOUT_EFFECT, assignments_of, context_of};
use rasterscope::chain::{Recipe, SettingKey};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Scene, builtin};

/// Size of the pictures.
const SIZE: Viewport = Viewport { width: 24, height: 16 };

/// Scene with a recipe, and the picture that they give.
struct Context {
    scene: Arc<Scene>,
    recipe: Recipe,
    picture: Image<Rgba8>,
}

impl Context {
    fn new(scene: &Arc<Scene>, recipe: Recipe) -> Self {
        Self { scene: Arc::clone(scene), recipe, picture: picture_in_motion(scene, &recipe, SIZE) }
    }

    /// Whether a value of the setting changes the picture.
    fn is_changed_by(&self, key: SettingKey) -> bool {
        assignments_of(key).iter().any(|assignment| {
            let mut changed = self.recipe;
            changed.set(assignment).is_ok() && picture_in_motion(&self.scene, &changed, SIZE) != self.picture
        })
    }
}

#[test]
fn every_setting_changes_a_picture_in_its_context() {
    let built_in = ["shared-edges", "z-fighting", "chess"].map(|id| builtin::by_id(id).expect("its id").build());
    let scenes: Vec<_> = [ground_and_cube(), transparency_scene()].into_iter().chain(built_in).map(Arc::new).collect();
    let has_effect = |key: &&SettingKey| {
        let mut contexts = scenes.iter().map(|scene| Context::new(scene, context_of(**key)));
        contexts.any(|context| context.is_changed_by(**key))
    };
    let others = SettingKey::ALL.iter().filter(|key| !WITHOUT_EFFECT.contains(key));
    let unread: Vec<_> = others.filter(|key| !has_effect(key)).map(|key| key.id()).collect();
    assert!(unread.is_empty(), "no picture changes with {unread:?}, in the contexts of `tests/internal/switches.rs`");
}
