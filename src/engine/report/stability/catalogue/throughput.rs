//! Test cases of triangles with a high cost per pixel. Each case is timed against compact triangles that cover about as
//! many pixels.

use super::rng::{Rng, to_f32};
use super::single::{EXACT, coverage};
use super::{CaseDraft, Class, Family};
use crate::report::stability::metric::Metric;

pub(super) const CLASSES: &[Class] = &[
    Class {
        id: "long-slivers",
        name: "Long slivers",
        family: Family::Throughput,
        about: "One pixel wide from corner to corner of 512 × 512 px: a test of every pixel of the bounding box tests \
                some hundred pixels for each one drawn.",
        headline: Metric::Stiffness,
        bounds: EXACT,
        draft: long_slivers,
    },
    Class {
        id: "small-triangles",
        name: "One-pixel triangles",
        family: Family::Throughput,
        about: "Thousands of triangles of about one pixel: triangle setup takes nearly all of the time.",
        headline: Metric::Stiffness,
        bounds: EXACT,
        draft: small_triangles,
    },
    Class {
        id: "columns",
        name: "Upright columns",
        family: Family::Throughput,
        about: "Upright strips one pixel wide: every row holds a single pixel, the worst case of methods that work row \
                by row.",
        headline: Metric::Stiffness,
        bounds: EXACT,
        draft: columns,
    },
    Class {
        id: "full-screen",
        name: "Beyond the screen",
        family: Family::Throughput,
        about: "Corners 1e4 to 3e38 px away around a picture that is filled completely: the time must depend on the \
                picture, not on the triangle.",
        headline: Metric::Stiffness,
        bounds: EXACT,
        draft: full_screen,
    },
];

/// Side length of the image in most classes, in pixels.
const SIDE: u32 = 512;

fn long_slivers(dice: &mut Rng) -> Vec<CaseDraft> {
    let side = f64::from(SIDE);
    let sliver = |dice: &mut Rng| {
        let (from, to) = (dice.uniform(2.0, side * 0.2), dice.uniform(side * 0.8, side - 2.0));
        let start = [from, dice.uniform(2.0, side * 0.2)];
        let end = [to, dice.uniform(side * 0.8, side - 2.0)];
        let corners = [to_f32(start), to_f32([start[0] + 1.4, start[1] - 1.4]), to_f32(end)];
        // About half of the slivers are mirrored.
        if dice.bool() { corners.map(|[x, y]| [SIDE as f32 - x, y]) } else { corners }
    };
    (0..2).map(|_| coverage("", [SIDE; 2], (0..8).map(|_| sliver(dice)).collect())).collect()
}

fn small_triangles(dice: &mut Rng) -> Vec<CaseDraft> {
    const SIZE: u32 = 128;
    let small = |dice: &mut Rng| {
        let [x, y] = [(); 2].map(|()| dice.uniform(1.0, f64::from(SIZE) - 2.0));
        let corners = [[x, y], [x + dice.uniform(1.0, 1.8), y], [x, y + dice.uniform(1.0, 1.8)]];
        dice.shuffled(corners.map(to_f32))
    };
    vec![coverage("2000 triangles", [SIZE; 2], (0..2000).map(|_| small(dice)).collect())]
}

fn columns(dice: &mut Rng) -> Vec<CaseDraft> {
    let side = f64::from(SIDE);
    let column = |dice: &mut Rng| {
        let x = dice.uniform(4.0, side - 8.0);
        let corners = [[x, 1.0], [x + 1.0, 1.0], [x + dice.uniform(0.0, 1.0), side - 1.0]];
        dice.shuffled(corners.map(to_f32))
    };
    (0..2).map(|_| coverage("", [SIDE; 2], (0..16).map(|_| column(dice)).collect())).collect()
}

fn full_screen(dice: &mut Rng) -> Vec<CaseDraft> {
    let around = |dice: &mut Rng, distance: f64| {
        let start = dice.uniform(0.0, 1.0);
        [0.0, 1.0, 2.0].map(|third| {
            let (sin, cos) = ((start + third / 3.0) * std::f64::consts::TAU).sin_cos();
            to_f32([cos * distance, sin * distance])
        })
    };
    let distances = [1e4, 1e6, 1e12, 3e38];
    distances.map(|d| coverage(format!("corners {d:e} px away"), [SIDE; 2], vec![around(dice, d)])).into()
}
