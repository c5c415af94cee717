//! Faults of lighting: colour space, direction of the light, normals.

use glam::Mat3;

use crate::fault::{Change, Fault, Slot};
use crate::geometry;
use crate::terminator::skip_normalisation;

pub(super) const FAULTS: &[Fault] = &[
    Fault::error(
        "srgb-lighting",
        "light is computed on sRGB codes instead of linear values",
        Slot::ColorSpace,
        Change::Settings(&["color-space=bytes"]),
    ),
    Fault::convention(
        "linear-lighting",
        "light is computed in linear values",
        Slot::ColorSpace,
        Change::Settings(&["color-space=linear"]),
    ),
    Fault::error(
        "light-negated",
        "the direction of the light is negated",
        Slot::LightDirection,
        Change::Setup(|setup| setup.recipe.pipeline.light.direction *= -1.0),
    ),
    Fault::error(
        "light-z-negated",
        "the light comes from the other side in z",
        Slot::LightDirection,
        Change::Setup(|setup| setup.recipe.pipeline.light.direction.z *= -1.0),
    ),
    Fault::error("ambient-missing", "there is no ambient light", Slot::Ambient, Change::Settings(&["light.ambient=0"])),
    Fault::error(
        "normals-negated",
        "normals point inwards",
        Slot::Normals,
        Change::Setup(|setup| geometry::change_normals(setup, |normal| -normal)),
    ),
    Fault::error(
        "normals-flat",
        "each triangle has its own normal instead of interpolated ones (flat shading)",
        Slot::Normals,
        Change::Setup(geometry::use_face_normals),
    ),
    Fault::error(
        "normals-recomputed",
        "normals are computed from the positions instead of read from the file",
        Slot::Normals,
        Change::Setup(geometry::recompute_normals),
    ),
    Fault::error(
        "normals-untransformed",
        "normals stay in model space",
        Slot::Normals,
        Change::Setup(|setup| geometry::transform_normals_by(setup, |_| Mat3::IDENTITY)),
    ),
    Fault::error(
        "normals-as-positions",
        "normals are transformed like positions, without the inverse transpose",
        Slot::Normals,
        Change::Setup(|setup| geometry::transform_normals_by(setup, |transform| transform)),
    ),
    Fault::error(
        "normals-not-normalised",
        "normals are not normalised after interpolation",
        Slot::Shading,
        Change::Setup(skip_normalisation),
    ),
    Fault::error(
        "lit-per-vertex",
        "light is computed at the vertices and interpolated (Gouraud)",
        Slot::Shading,
        Change::Settings(&["shading=gouraud"]),
    ),
    Fault::error("unlit", "there is no lighting", Slot::Shading, Change::Settings(&["shading=texture"])),
];
