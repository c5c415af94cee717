//! Procedural pictures: chess tiles, marble, a wooden crate, bricks, a test card, stained glass, a leaf, and pairs for
//! cel shading.
//!
//! All pictures are sRGB-encoded, have row 0 at v = 0, and tile. A picture is a function from (u, v) in [0, 1) to an
//! sRGB colour, evaluated at texel centres. Colours are also mixed in sRGB, because they represent paint instead of
//! light.

use std::f32::consts::TAU;

use glam::{UVec2, Vec2, Vec3, Vec4};

use super::noise;
use crate::image::{Image, Rgba8, color};

/// Converts a colour code 0xRRGGBB to sRGB values in [0, 1].
pub(super) const fn srgb(code: u32) -> Vec3 {
    let [_, r, g, b] = code.to_be_bytes();
    Vec3::new(r as f32 / 255.0, g as f32 / 255.0, b as f32 / 255.0)
}

/// Returns a fully saturated colour of the colour wheel, as sRGB values. `hue` 0 and 1 are the same red.
pub(super) fn hue(hue: f32) -> Vec3 {
    let wave = |shift: f32| 0.5 + 0.5 * ((hue + shift) * TAU).cos();
    Vec3::new(wave(0.0), wave(-1.0 / 3.0), wave(1.0 / 3.0))
}

/// Returns an opaque picture of `size`² texels, with the colours that `paint` computes.
pub(super) fn picture(size: u32, paint: impl Fn(Vec2) -> Vec3) -> Image<Rgba8> {
    transparent_picture(size, |uv| paint(uv).extend(1.0))
}

/// Returns a picture of `size`² texels, with the colours and the straight alpha that `paint` computes.
fn transparent_picture(size: u32, paint: impl Fn(Vec2) -> Vec4) -> Image<Rgba8> {
    Image::from_fn(size, size, |x, y| {
        paint((UVec2::new(x, y).as_vec2() + 0.5) / size as f32).to_array().map(color::quantize)
    })
}

/// Returns a picture of 4 × 4 marble chess tiles with thin joints and soft edges.
pub(super) fn chess(size: u32, light: Vec3, dark: Vec3) -> Image<Rgba8> {
    const SIDE: f32 = 4.0;
    picture(size, |uv| {
        let tile = (uv * SIDE).floor();
        let within = uv * SIDE - tile;
        let number = (tile.x + tile.y * SIDE) as u32;
        let is_light = (tile.x + tile.y) % 2.0 == 0.0;
        let base = if is_light { light } else { dark };
        let vein = base.lerp(if is_light { dark } else { light }, if is_light { 0.22 } else { 0.16 });
        let shade = 0.95 + 0.08 * noise::hash(number, 0, 11);
        let stone = base.lerp(vein, veins(within, number)) * shade;
        let to_edge = within.min(1.0 - within).min_element();
        let joint = smoothstep(0.004, 0.016, to_edge);
        stone * (0.55 + 0.45 * joint) * (1.0 + 0.05 * (1.0 - smoothstep(0.016, 0.06, to_edge)))
    })
}

/// Returns a picture of polished stone with veins, in colours from `base` to `vein`.
pub(super) fn marble(size: u32, base: Vec3, vein: Vec3) -> Image<Rgba8> {
    picture(size, |uv| base.lerp(vein, veins(uv, 3)))
}

/// Returns the vein intensity at a position of a marble slab, from 0 to about 1; `seed` selects the slab. The pattern
/// tiles.
fn veins(uv: Vec2, seed: u32) -> f32 {
    const SCALE: u32 = 3;
    let p = uv * SCALE as f32;
    let bend = Vec2::new(noise::fractal(p, SCALE, 2, seed + 40), noise::fractal(p, SCALE, 2, seed + 80)) - 0.5;
    let field = noise::fractal(p + bend * 1.6, SCALE, 4, seed);
    let ridge = 1.0 - (2.0 * field - 1.0).abs();
    0.9 * ridge.powi(10) + 0.25 * field
}

/// Returns a picture of the side of a wooden crate: upright planks in a frame.
pub(super) fn crate_side(size: u32, wood: Vec3) -> Image<Rgba8> {
    const FRAME: f32 = 0.14;
    const PLANKS: f32 = 5.0;
    picture(size, |uv| {
        let edge = uv.min(1.0 - uv);
        let in_frame = edge.min_element() < FRAME;
        let upright = !in_frame || edge.x < edge.y;
        let (along, across) = if upright { (uv.y, uv.x) } else { (uv.x, uv.y) };
        let plank = if in_frame { 7 + u32::from(upright) } else { (across * PLANKS) as u32 };
        let grain = grain(along, across, plank);
        let groove = if in_frame {
            (edge.x - edge.y).abs().max(FRAME - edge.max_element())
        } else {
            let within = (across * PLANKS).fract();
            (within.min(1.0 - within) / PLANKS).min(edge.min_element() - FRAME)
        };
        let shade = if in_frame { 1.08 } else { 0.84 + 0.1 * noise::hash(plank, 0, 5) };
        wood * (0.74 + 0.32 * grain) * shade * (0.45 + 0.55 * smoothstep(0.0, 0.012, groove))
    })
}

/// Returns the intensity of wood grain in [0, 1]: stripes that meander along the plank.
fn grain(along: f32, across: f32, plank: u32) -> f32 {
    let p = Vec2::new(along * 4.0, across * 4.0);
    let wander = noise::fractal(p, 4, 3, plank * 17);
    let fibres = noise::value(Vec2::new(along * 8.0, across * 64.0), 64, plank * 29);
    let rings = 0.5 + 0.5 * ((across * 9.0 + wander * 3.0) * TAU).sin();
    0.5 * rings + 0.5 * fibres
}

/// Returns a picture of bricks in running bond.
pub(super) fn bricks(size: u32, brick: Vec3, mortar: Vec3) -> Image<Rgba8> {
    const COLUMNS: f32 = 4.0;
    const ROWS: f32 = 8.0;
    picture(size, |uv| {
        let row = (uv.y * ROWS).floor();
        let along = uv.x * COLUMNS + if row % 2.0 == 0.0 { 0.0 } else { 0.5 };
        let within = Vec2::new(along.fract() * 2.0, (uv.y * ROWS).fract());
        let to_edge = within.min(Vec2::new(2.0, 1.0) - within).min_element();
        let number = (along as u32 % COLUMNS as u32) + row as u32 * 8;
        let rough = noise::fractal(uv * 16.0, 16, 3, 9);
        let face = brick * (0.72 + 0.3 * noise::hash(number, 1, 2) + 0.24 * (rough - 0.5));
        let joint = mortar * (0.85 + 0.3 * rough);
        joint.lerp(face, smoothstep(0.05, 0.13, to_edge + 0.05 * (rough - 0.5)))
    })
}

/// Returns a test card that reveals flips and rotations: a frame, squares, an upward arrow and a marked corner.
pub(super) fn test_card(size: u32) -> Image<Rgba8> {
    const PAPER: Vec3 = srgb(0xF4_F1_EA);
    const INK: Vec3 = srgb(0x3A_3F_4A);
    const MARK: Vec3 = srgb(0xFF_B3_4D);
    picture(size, |uv| {
        let edge = uv.min(1.0 - uv).min_element();
        let square = (uv * 8.0).floor();
        let is_even = (square.x + square.y) % 2.0 == 0.0;
        let from_middle = (uv.x - 0.5).abs();
        let head = (0.25..0.5).contains(&uv.y) && from_middle < uv.y - 0.25;
        let shaft = (0.5..0.75).contains(&uv.y) && from_middle < 0.09;
        if edge < 0.05 || head || shaft {
            INK
        } else if uv.max_element() < 0.25 {
            MARK
        } else if is_even {
            PAPER
        } else {
            PAPER * 0.86
        }
    })
}

/// Returns a picture of a window with diamond panes between opaque strips of lead, in hues around `middle`.
///
/// The alpha of the glass varies with its thickness from 0.45 to 0.7, so it hides slightly more than half of the
/// background.
pub(super) fn stained_glass(size: u32, middle: f32) -> Image<Rgba8> {
    const PANES: f32 = 5.0;
    const LEAD: Vec3 = srgb(0x35_38_3E);
    transparent_picture(size, |uv| {
        let p = Vec2::new(uv.x + uv.y, uv.x - uv.y) * PANES;
        let within = p - p.floor();
        let to_lead = within.min(1.0 - within).min_element() / PANES;
        let to_frame = uv.min(1.0 - uv).min_element();
        if to_lead < 0.008 || to_frame < 0.03 {
            return LEAD.extend(1.0);
        }
        let number = (p.x as u32, (p.y + PANES) as u32);
        let glass = hue(middle + 0.3 * (noise::hash(number.0, number.1, 21) - 0.5)) * 0.7 + 0.25;
        let thickness = noise::fractal(uv * 8.0, 8, 3, 23);
        (glass * (0.85 + 0.15 * thickness)).extend(0.45 + 0.25 * thickness)
    })
}

/// Colour of a green leaf.
pub(super) const LEAF_GREEN: Vec3 = srgb(0x4E_8F_3C);

/// Returns a picture of a leaf of this colour with five lobes and its stalk pointing down, on a transparent background.
pub(super) fn leaf(size: u32, color: Vec3) -> Image<Rgba8> {
    const VEIN: Vec3 = srgb(0xA9_CB_7A);
    transparent_picture(size, |uv| {
        let p = uv - Vec2::new(0.5, 0.55);
        // Angle around the centre from the upward tip, in fifths of a turn: one lobe each.
        let lobes = p.x.atan2(-p.y) / TAU * 5.0;
        let from_lobe = (lobes - lobes.round()).abs() * 2.0;
        let tip = if lobes.abs() < 0.5 { 0.5 } else { 0.42 };
        let reach = 0.2 + (tip - 0.2) * (1.0 - from_lobe).powf(0.8);
        let stalk = p.y > 0.0 && p.x.abs() < 0.022;
        let vein = 1.0 - smoothstep(0.012, 0.03, from_lobe * p.length());
        let blade = color * (0.8 + 0.4 * noise::fractal(uv * 8.0, 8, 3, 31));
        let shown = if stalk { VEIN * 0.8 } else { blade.lerp(VEIN, 0.7 * vein) };
        shown.extend(if stalk || p.length() < reach { 1.0 } else { 0.0 })
    })
}

/// Returns a picture for the lit side and a cooler, darker version of it for the unlit side.
pub(super) fn cel_pair(size: u32, paint: impl Fn(Vec2) -> Vec3) -> [Image<Rgba8>; 2] {
    /// Colour factors of the unlit side. Shade removes more red than blue, as under an open sky.
    const SHADE: Vec3 = Vec3::new(0.56, 0.60, 0.76);
    [picture(size, &paint), picture(size, |uv| paint(uv) * SHADE)]
}

/// Returns 0 below `from`, 1 above `to`, and a smooth Hermite transition between them.
pub(super) fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Alpha, Texture};

    #[test]
    fn chess_tiles_alternate() {
        let image = chess(64, Vec3::ONE, Vec3::splat(0.2));
        let tile = |x: u32, y: u32| color::luma(image.at(x * 16 + 8, y * 16 + 8)) > 128.0;
        for (x, y) in (0..4).flat_map(|y| (0..4).map(move |x| (x, y))) {
            assert_eq!(tile(x, y), (x + y) % 2 == 0, "{x} {y}");
        }
    }

    #[test]
    fn the_test_card_has_no_symmetry() {
        let card = test_card(64);
        let flips = [
            Image::from_fn(64, 64, |x, y| card.at(63 - x, y)),
            Image::from_fn(64, 64, |x, y| card.at(x, 63 - y)),
            Image::from_fn(64, 64, |x, y| card.at(y, x)),
        ];
        assert_eq!(flips.iter().position(|flip| *flip == card), None);
    }

    #[test]
    fn glass_is_graded_and_leaves_are_all_or_nothing() {
        let alpha = |image| Texture::new(image).unwrap().alpha();
        assert_eq!(alpha(stained_glass(64, 0.5)), Alpha::Graded);
        let leaf = leaf(64, LEAF_GREEN);
        let drawn = leaf.pixels().iter().filter(|p| p[3] == 255).count();
        assert!((64 * 64 / 4..64 * 64 * 3 / 4).contains(&drawn), "{drawn}");
        assert_eq!(alpha(leaf), Alpha::AllOrNothing);
    }

    #[test]
    fn the_dark_picture_of_a_pair_is_darker_everywhere() {
        let [light, dark] = cel_pair(8, |uv| Vec3::new(uv.x, uv.y, 0.5));
        assert!(light.pixels().iter().zip(dark.pixels()).all(|(l, d)| color::luma(*d) < color::luma(*l)));
    }

    #[test]
    fn hues_are_red_green_and_blue_at_thirds() {
        for (third, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            assert!(hue(third as f32 / 3.0).distance(axis * 0.75 + 0.25) < 1e-5);
        }
    }
}
