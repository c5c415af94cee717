//! Fuzzing: random inputs for the window and for every part of the program that reads external data.
//!
//! [`driver`] describes the environment variables and the files saved for failing inputs. To add a target, implement
//! [`driver::Target`] in a new file and add a line to `targets!`.

mod cases;
mod driver;
mod equal;
mod gltf;
mod images;
mod input;
mod models;
mod mutate;
mod obj;
mod panics;
#[cfg(feature = "ui")]
mod preferences;
mod process;
mod recipes;
mod seeds;
mod self_test;
mod strings;
#[cfg(feature = "window-tests")]
mod window;

macro_rules! targets {
    ($($(#[$condition:meta])* $test:ident: $target:expr;)+) => {
        $(#[test] $(#[$condition])* fn $test() {
            driver::fuzz($target);
        })+
    };
}

targets! {
    models: models::Models;
    obj: obj::Obj;
    gltf: gltf::Gltf;
    images: images::Images;
    cases: cases::Cases;
    strings: strings::Strings;
    recipes: recipes::Recipes;
    #[cfg(feature = "ui")] preferences: preferences::StoredPreferences;
    #[cfg(feature = "window-tests")] window: window::Window;
}
