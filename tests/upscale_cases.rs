//! Upscalers against answers in exact arithmetic.
#![expect(clippy::print_stderr, reason = "says what was checked, and what was not")]

mod cases;

use rasterscope::image::{Image, Rgba8};
use rasterscope::upscale::{self, Upscaler};
use serde_json::Value;

#[test]
fn pictures_are_the_exact_ones_rounded_half_up() {
    let all = cases::of_class("upscale");
    let mut checked = 0;
    for (case, expected) in &all {
        let Some((upscaler, scale, drawn)) = ours(case) else { continue };
        let (width, height) = (drawn.width() * scale, drawn.height() * scale);
        let full = upscaler.upscale(&drawn, scale, width, height);
        let values: Vec<Vec<f64>> = serde_json::from_value(expected["values"].clone()).expect("rows of numbers");
        let exact = Image::from_fn(width, height, |x, y| {
            let value = values[y as usize][x as usize];
            [(value.clamp(0.0, 255.0) + 0.5).floor() as u8; 4]
        });
        assert_eq!(full, exact, "{}", case["id"]);
        checked += 1;
    }
    eprintln!("{checked} upscaling cases checked, {} of other kernels, phases or scales skipped", all.len() - checked);
    assert!(all.is_empty() || checked > 0, "not one case was fit for checking");
}

/// The method of this crate that a case is about, with its picture in grey; `None` if there is none, or the picture
/// does not hold codes.
fn ours(case: &Value) -> Option<(&'static dyn Upscaler, u32, Image<Rgba8>)> {
    let id = match case["kernel"].as_str()? {
        "nearest_floor" => "nearest",
        "bilinear" => "bilinear",
        "lagrange" => "bicubic",
        _ => return None,
    };
    let upscaler = *upscale::ALL.iter().find(|upscaler| upscaler.id() == id)?;
    let scale = u32::try_from(case["scale"].as_u64()?).ok()?;
    if case["phase"] != "corner" || !upscaler.scales().contains(&scale) {
        return None;
    }
    let rows: Vec<Vec<u8>> = serde_json::from_value(case["image"].clone()).ok()?;
    let drawn = Image::from_fn(rows.first()?.len() as u32, rows.len() as u32, |x, y| [rows[y as usize][x as usize]; 4]);
    Some((upscaler, scale, drawn))
}
