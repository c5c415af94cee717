//! Viewpoint of a camera, from which directions towards the eye are computed.

use glam::Vec3;
use serde::Serialize;

use crate::scene::{Camera, Projection};

/// Viewpoint of a camera: a position or, in orthographic views, a direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) enum Viewpoint {
    /// World-space position of the eye.
    At(Vec3),
    /// World-space unit vector towards the eye, which is the same everywhere in orthographic views.
    Towards(Vec3),
}

impl Viewpoint {
    /// Returns the viewpoint of a camera.
    pub(crate) fn of(camera: &Camera) -> Self {
        match camera.projection {
            Projection::Perspective { .. } => Self::At(camera.eye),
            Projection::Orthographic { .. } => Self::Towards(-camera.forward()),
        }
    }

    /// Returns a vector from a world-space position towards the eye, not normalised.
    pub(crate) fn vector_from(self, position: Vec3) -> Vec3 {
        match self {
            Self::At(eye) => eye - position,
            Self::Towards(direction) => direction,
        }
    }
}
