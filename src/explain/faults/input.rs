//! Differences of inputs: the other renderer draws correctly, but not the same data.

use glam::Vec2;

use crate::fault::{Change, Fault, Slot};
use crate::geometry;

pub(super) const FAULTS: &[Fault] = &[
    Fault::input("background-colour", "the background has another colour", Slot::Background, Change::Background(None)),
    Fault::input(
        "texture-v-flipped",
        "textures are upside down: their origin, v = 0, is the other edge of the image",
        Slot::TextureV,
        Change::Setup(|setup| geometry::change_uv(setup, Vec2::new(1.0, -1.0), Vec2::Y)),
    ),
];
