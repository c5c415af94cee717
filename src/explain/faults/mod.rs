//! Registry of the known faults, one file per part of a renderer.

mod blending;
mod camera;
mod coverage;
mod depth;
mod input;
mod lighting;
mod output;
mod sampling;
mod texture;

use std::sync::LazyLock;

use crate::fault::Fault;

/// All known faults. Among faults that give the same picture, the first is named first.
pub static ALL: LazyLock<Vec<Fault>> = LazyLock::new(|| {
    [
        input::FAULTS,
        output::FAULTS,
        camera::FAULTS,
        coverage::FAULTS,
        depth::FAULTS,
        texture::FAULTS,
        lighting::FAULTS,
        blending::FAULTS,
        sampling::FAULTS,
    ]
    .concat()
});

/// Finds a fault by its [`Fault::id`].
pub fn by_id(id: &str) -> Option<&'static Fault> {
    ALL.iter().find(|fault| fault.id == id)
}
