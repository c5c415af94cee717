//! Fuzz target: damaged examples of all formats of models. The targets of single formats share its check of a model.

use std::path::Path;
use std::sync::Arc;

use fastrand::Rng;
use rasterscope::chain::Recipe;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::obj::TrMeaning;
use rasterscope::scene::{SceneFormat, SceneSource};
use rasterscope::text;

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::equal;
use crate::fuzz::images::check_message;
use crate::fuzz::input::Input;
use crate::fuzz::mutate::{self, pick};
use crate::internal::sound::sound;

/// Size of the picture that is drawn of every loaded model, in pixels.
const SIZE: Viewport = Viewport { width: 21, height: 17 };

/// Fuzz target that loads and draws damaged examples.
pub(crate) struct Models;

impl Target for Models {
    fn name(&self) -> &'static str {
        "models"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let format = pick(rng, SceneFormat::ALL);
        let mut bytes = format.example.to_vec();
        mutate::bytes(rng, &mut bytes);
        Input::file(&format!("model.{}", pick(rng, format.extensions)), bytes)
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let names = SceneFormat::all_extensions().into_iter().map(|extension| format!("model.{extension}"));
        let mut present = names.filter(|name| folder.join(name).is_file());
        present.try_for_each(|name| check(&folder.join(&name), TrMeaning::Auto, &name))
    }
}

/// Loads and draws a model. The name of its file must be in the error; every warning must contain `warned`.
pub(crate) fn check(path: &Path, tr: TrMeaning, warned: &str) -> Result<(), Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let loaded = match SceneSource::File(path.to_owned(), tr).load() {
        Ok(loaded) => loaded,
        Err(error) => return check_message(&text::one_line(&error.to_string()), &name),
    };
    for warning in loaded.warnings.iter().chain(&loaded.notes) {
        // Formatted like in the program's output, because names in files may contain anything.
        check_message(&text::one_line(&warning.to_string()), warned)?;
    }
    sound(&loaded).map_err(|fault| Failure::Wrong(format!("{fault}: {:?}", loaded.scene.bounds())))?;
    let scene = Arc::new(loaded.scene);
    for view in &scene.views {
        view.camera.check().map_err(Failure::Wrong)?;
    }
    // Both executions draw the same picture, also of a pose in the middle of the motion.
    equal::check(&scene, &scene.home, &Recipe::default(), SIZE)?;
    let Some(animation) = &scene.animation else { return Ok(()) };
    equal::check(&scene.at(animation.duration_s() * 0.4), &scene.home, &Recipe::default(), SIZE)
}
