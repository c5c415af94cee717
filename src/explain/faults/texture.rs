//! Faults of texture mapping: interpolation, origin, wrap, filter, offset.

use glam::Vec2;

use crate::fault::{Change, Fault, Slot};
use crate::geometry;
use crate::polygons::{Clipping, interpolate_affinely};

/// Declares affine interpolation with the triangles of a way of clipping.
macro_rules! affine {
    ($is_at_all_planes:literal, $first:literal) => {
        Change::Setup(|setup| {
            interpolate_affinely(setup, Clipping { is_at_all_planes: $is_at_all_planes, first: $first });
        })
    };
}

pub(super) const FAULTS: &[Fault] = &[
    Fault::error(
        "affine-interpolation",
        "attributes are interpolated linearly in screen space (affine), not perspective-correct",
        Slot::Interpolation,
        Change::Settings(&["interpolation=affine"]),
    )
    .or(&[affine!(false, 0), affine!(false, 1), affine!(true, 0), affine!(true, 1)]),
    Fault::error(
        "texture-u-flipped",
        "u is mirrored",
        Slot::TextureU,
        Change::Setup(|setup| geometry::change_uv(setup, Vec2::new(-1.0, 1.0), Vec2::X)),
    ),
    Fault::error(
        "texture-clamped",
        "textures are clamped instead of repeated",
        Slot::TextureWrap,
        Change::Settings(&["address=clamp"]),
    ),
    Fault::error(
        "texture-mirrored",
        "textures are mirrored instead of repeated",
        Slot::TextureWrap,
        Change::Settings(&["address=mirror"]),
    ),
    Fault::error("texture-repeated", "textures are repeated", Slot::TextureWrap, Change::Settings(&["address=repeat"])),
    Fault::error(
        "filter-point",
        "textures are not filtered: the nearest texel is taken",
        Slot::TextureFilter,
        Change::Settings(&["filter=point"]),
    ),
    Fault::convention(
        "filter-bilinear",
        "textures are filtered bilinearly, without mip levels",
        Slot::TextureFilter,
        Change::Settings(&["filter=bilinear"]),
    ),
    Fault::convention(
        "filter-trilinear",
        "textures are filtered with mip levels (trilinear)",
        Slot::TextureFilter,
        Change::Settings(&["filter=trilinear"]),
    ),
    Fault::error(
        "half-texel-offset",
        "texel centres lie at whole coordinates: textures are shifted by half a texel",
        Slot::TexelOffset,
        Change::Setup(|setup| geometry::move_texels(setup, Vec2::splat(0.5))),
    ),
    Fault::error(
        "half-texel-offset-twice",
        "half a texel is subtracted twice",
        Slot::TexelOffset,
        Change::Setup(|setup| geometry::move_texels(setup, Vec2::splat(-0.5))),
    ),
    Fault::error(
        "texture-missing",
        "textures are not applied",
        Slot::Shading,
        Change::Setup(geometry::remove_textures),
    ),
    Fault::convention(
        "texture-alpha-premultiplied",
        "texels are filtered with premultiplied alpha",
        Slot::TextureAlpha,
        Change::Settings(&["alpha=premultiplied"]),
    ),
];
