//! Differences in sampling: antialiasing, upscaling, post filters.

use crate::fault::{Change, Fault, Slot};

/// Declares an antialiasing method with a number of samples.
macro_rules! antialiased {
    ($id:literal, $name:literal, $method:literal, $samples:literal) => {
        Fault::convention(
            $id,
            $name,
            Slot::Antialiasing,
            Change::Settings(&[concat!("antialias.method=", $method), concat!("antialias.samples=", $samples)]),
        )
    };
}

/// Declares an upscaler with a scale.
macro_rules! upscaled {
    ($id:literal, $name:literal, $method:literal, $scale:literal) => {
        Fault::error(
            $id,
            $name,
            Slot::Upscaling,
            Change::Settings(&[concat!("upscaler.method=", $method), concat!("upscaler.scale=", $scale)]),
        )
    };
}

pub(super) const FAULTS: &[Fault] = &[
    antialiased!("msaa-4", "edges are antialiased by multisampling with 4 samples (rotated grid)", "multisample", "4"),
    antialiased!("msaa-16", "edges are antialiased by multisampling with 16 samples", "multisample", "16"),
    antialiased!("ssaa-4", "pixels are supersampled with 2 × 2 samples", "regular", "4"),
    antialiased!("ssaa-16", "pixels are supersampled with 4 × 4 samples", "regular", "16"),
    antialiased!("ssaa-rotated", "pixels are supersampled with 4 samples (rotated grid)", "rotated-grid", "4"),
    upscaled!("upscaled-nearest-2", "the picture is drawn at half size and enlarged without a filter", "nearest", "2"),
    upscaled!("upscaled-bilinear-2", "the picture is drawn at half size and enlarged bilinearly", "bilinear", "2"),
    upscaled!("upscaled-bicubic-2", "the picture is drawn at half size and enlarged bicubically", "bicubic", "2"),
    upscaled!("upscaled-lanczos-2", "the picture is drawn at half size and enlarged by Lanczos-3", "lanczos3", "2"),
    Fault::convention("fxaa", "edges are smoothed by FXAA", Slot::PostFilter, Change::Settings(&["post.filter=fxaa"])),
    Fault::convention("blurred", "the picture is blurred", Slot::PostFilter, Change::Settings(&["post.filter=blur"])),
    Fault::convention(
        "sharpened",
        "the picture is sharpened",
        Slot::PostFilter,
        Change::Settings(&["post.filter=sharpen"]),
    ),
];
