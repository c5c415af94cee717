//! Test cases of triangle meshes that cover every pixel of the image exactly once.

use std::f64::consts::TAU;

use super::rng::{Rng, to_f32};
use super::{CaseDraft, Class, Family};
use crate::pipeline::settings::FillRule;
use crate::report::stability::case::{Body, Coverage};
use crate::report::stability::metric::{Bound, Metric};

/// Width and height of an image, in pixels.
type Size = [u32; 2];

/// Image size of most mesh cases.
const SMALL: Size = [32, 32];

/// Image size of the cases with large meshes.
const LARGE: Size = [1024, 256];

/// Distance by which meshes extend beyond each edge of the image, in pixels.
const MARGIN: f64 = 4.0;

/// Bounds: every pixel is covered exactly once, and by the correct triangle.
const WATERTIGHT: &[Bound] = &[Bound::none(Metric::Cracks), Bound::none(Metric::Doubles), Bound::none(Metric::Wrong)];

pub(super) const CLASSES: &[Class] = &[
    Class {
        id: "mesh-fan",
        name: "Fans",
        family: Family::Mesh,
        about: "3 to 200 triangles around one corner where all edges meet: every rounding of that corner or of a slope \
                opens a crack or draws a pixel twice.",
        headline: Metric::Seams,
        bounds: WATERTIGHT,
        draft: fans,
    },
    Class {
        id: "mesh-grid",
        name: "Grids",
        family: Family::Mesh,
        about: "Up to 12 800 triangles that share all their edges, many of them through pixel centres: with inclusive \
                edges, every centre on an edge is drawn twice.",
        headline: Metric::Seams,
        bounds: WATERTIGHT,
        draft: grids,
    },
    Class {
        id: "mesh-strips",
        name: "Strips",
        family: Family::Mesh,
        about: "Long thin neighbours, down to less than a pixel wide: each pixel belongs to one triangle among many \
                that miss it.",
        headline: Metric::Seams,
        bounds: WATERTIGHT,
        draft: strips,
    },
    Class {
        id: "mesh-wide",
        name: "Wide meshes",
        family: Family::Mesh,
        about: "Fans and flat strips over 1024 × 256 px: edges are long enough for their two triangles to disagree \
            about a pixel.",
        headline: Metric::Seams,
        bounds: WATERTIGHT,
        draft: wide,
    },
];

fn mesh(dice: &mut Rng, note: impl Into<String>, [width, height]: Size, triangles: Vec<[[f32; 2]; 3]>) -> CaseDraft {
    let mut triangles: Vec<_> = triangles.into_iter().map(|t| dice.shuffled(t)).collect();
    dice.shuffle(&mut triangles);
    let rule = FillRule::TopLeft;
    CaseDraft::new(note, Body::TriCoverage(Coverage { width, height, rule, triangles, exactly_once: true }))
}

/// Creates a test case of `spokes` triangles around the vertex `hub`. The other vertices lie outside the image, at a
/// distance from `hub` that is proportional to `reach`.
fn fan(dice: &mut Rng, size: Size, hub: [f32; 2], spokes: usize, reach: f64) -> CaseDraft {
    let start = dice.uniform(0.0, TAU);
    let rim: Vec<[f32; 2]> = (0..spokes)
        .map(|i| {
            let angle = start + (i as f64 + dice.uniform(-0.05, 0.05)) / spokes as f64 * TAU;
            // With three spokes, the outer edges of the triangles come as near to the hub as 0.4 times this radius.
            // They must lie outside the image.
            let radius = reach * (4.0 * f64::from(size[0].max(size[1]))) * dice.uniform(1.0, 1.1);
            to_f32([f64::from(hub[0]) + radius * angle.cos(), f64::from(hub[1]) + radius * angle.sin()])
        })
        .collect();
    let triangles = (0..spokes).map(|i| [hub, rim[i], rim[(i + 1) % spokes]]).collect();
    mesh(dice, format!("{spokes} triangles around ({}, {})", hub[0], hub[1]), size, triangles)
}

fn fans(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut drafts = Vec::new();
    for spokes in [3, 8, 17, 64, 200] {
        let anywhere = to_f32([dice.uniform(2.0, 30.0), dice.uniform(2.0, 30.0)]);
        let centre = [dice.centre(2, 30), dice.centre(2, 30)];
        drafts.push(fan(dice, SMALL, anywhere, spokes, 1.0));
        drafts.push(fan(dice, SMALL, centre, spokes, 1.0));
    }
    let hub = to_f32([dice.uniform(2.0, 30.0), dice.uniform(2.0, 30.0)]);
    drafts.extend([100.0, 1e4].map(|reach| fan(dice, SMALL, hub, 12, reach)));
    drafts
}

/// Creates a test case of a grid of `cells` × `cells` quads over the image and its margin. Inner vertices are displaced
/// at random by up to `jitter` quad widths, then rounded to multiples of 1/`lattice` px if `lattice` is set.
fn grid(dice: &mut Rng, cells: usize, jitter: f64, lattice: Option<f64>) -> CaseDraft {
    let size = SMALL;
    let step = (f64::from(size[0]) + 2.0 * MARGIN) / cells as f64;
    let corners: Vec<Vec<[f32; 2]>> = (0..=cells)
        .map(|row| {
            let place = |column: usize, dice: &mut Rng| {
                let inner = row > 0 && row < cells && column > 0 && column < cells;
                let mut along = |n: usize| {
                    let at = -MARGIN + (n as f64 + if inner { dice.uniform(-jitter, jitter) } else { 0.0 }) * step;
                    lattice.filter(|_| inner).map_or(at, |lattice| (at * lattice).round() / lattice)
                };
                to_f32([along(column), along(row)])
            };
            (0..=cells).map(|column| place(column, dice)).collect()
        })
        .collect();
    let mut triangles = Vec::with_capacity(2 * cells * cells);
    for row in 0..cells {
        for column in 0..cells {
            let [a, b] = [corners[row][column], corners[row][column + 1]];
            let [d, c] = [corners[row + 1][column], corners[row + 1][column + 1]];
            triangles.extend(if dice.bool() { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    let lattice = lattice.map_or("any position".to_owned(), |l| format!("multiples of 1/{l} px"));
    mesh(dice, format!("{cells} × {cells} cells, corners at {lattice}"), size, triangles)
}

fn grids(dice: &mut Rng) -> Vec<CaseDraft> {
    let kinds = [(4, 0.3, None), (16, 0.3, None), (33, 0.3, None), (20, 0.0, Some(2.0)), (20, 0.3, Some(2.0))];
    let large = [(50, 0.3, Some(256.0)), (60, 0.25, None), (80, 0.0, Some(2.0))];
    kinds.into_iter().chain(large).map(|(cells, jitter, lattice)| grid(dice, cells, jitter, lattice)).collect()
}

/// Creates a test case of adjacent quads, each split into two triangles. `sides` lists the edges between the quads and
/// at both ends, each as a pair of endpoints.
fn strip(dice: &mut Rng, note: String, size: Size, sides: &[[[f32; 2]; 2]]) -> CaseDraft {
    let quads = sides.windows(2).flat_map(|pair| {
        let ([a, b], [d, c]) = (pair[0], pair[1]);
        [[a, b, c], [a, c, d]]
    });
    let triangles = quads.collect();
    mesh(dice, note, size, triangles)
}

/// Creates a test case of `count` horizontal strips across the image. Their borders lie at random heights and are
/// nearly horizontal: each endpoint is displaced by up to `tilt` px.
fn level(dice: &mut Rng, size: Size, count: usize, tilt: f64) -> CaseDraft {
    let [width, height] = size.map(f64::from);
    let mut heights: Vec<f64> = (1..count).map(|_| dice.uniform(-MARGIN, height + MARGIN)).collect();
    heights.extend([-MARGIN - tilt, height + MARGIN + tilt]);
    heights.sort_by(f64::total_cmp);
    let mut sides: Vec<[[f32; 2]; 2]> = heights
        .iter()
        .map(|y| {
            [to_f32([-MARGIN, y + dice.uniform(0.0, tilt)]), to_f32([width + MARGIN, y + dice.uniform(0.0, tilt)])]
        })
        .collect();
    // Borders that would cross share an endpoint instead.
    for end in 0..2 {
        for i in 1..sides.len() {
            sides[i][end][1] = sides[i][end][1].max(sides[i - 1][end][1]);
        }
    }
    strip(dice, format!("{count} strips from left to right"), size, &sides)
}

/// Creates a test case of `count` slanted strips of equal width, from above the image to below it.
fn slanted(dice: &mut Rng, count: usize) -> CaseDraft {
    let [width, height] = SMALL.map(f64::from);
    let slant = dice.uniform(5.0, 15.0);
    let step = (width + 2.0 * MARGIN + slant) / count as f64;
    let sides: Vec<_> = (0..=count)
        .map(|i| {
            let x = -MARGIN - slant + i as f64 * step;
            [to_f32([x, -MARGIN]), to_f32([x + slant, height + MARGIN])]
        })
        .collect();
    strip(dice, format!("{count} slanted strips, {step:.3} px wide"), SMALL, &sides)
}

fn strips(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut drafts: Vec<_> = [3, 12, 60].map(|count| level(dice, SMALL, count, 0.0)).into();
    drafts.extend([40, 300].map(|count| slanted(dice, count)));
    drafts
}

fn wide(dice: &mut Rng) -> Vec<CaseDraft> {
    let anywhere = to_f32([dice.uniform(300.0, 700.0), dice.uniform(60.0, 200.0)]);
    let hubs = [(9, [512.5, 128.5]), (40, anywhere), (160, [1000.25, 3.5])];
    let mut drafts: Vec<_> = hubs.map(|(spokes, hub)| fan(dice, LARGE, hub, spokes, 1.0)).into();
    drafts.extend([6, 60].map(|count| level(dice, LARGE, count, 2.0)));
    drafts
}
