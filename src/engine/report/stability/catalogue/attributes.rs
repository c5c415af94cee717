//! Test cases for the interpolation of weights, attributes and depth. Vertices lie on the 1/256 px grid, so snapping
//! does not move them.

use super::rng::{Rng, to_f32};
use super::{CaseDraft, Class, Family};
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;
use crate::report::stability::case::{AttributeCase, Body, CoplanarPairCase};
use crate::report::stability::metric::{Bound, Metric};
use crate::report::stability::oracle::{ExactRegion, ScreenCorner, Snap};

/// Maximum number of pixels evaluated per triangle.
const SAMPLES: usize = 24;

/// Side length of the image in most test cases, in pixels.
const SIDE: u32 = 64;

/// Side length of the image in the test cases with a large image, in pixels.
const LARGE: u32 = 4096;

/// Bounds: all values are finite, and weight errors are at most 1e-5, less than 1/100 of an 8-bit step.
const CLOSE: &[Bound] = &[Bound::none(Metric::NotFinite), Bound::new(Metric::WeightError, 1e-5)];

/// Bounds for images 4096 px wide: all values are finite, and weight errors are at most 2⁻²⁰.
const CLOSE_WIDE: &[Bound] = &[Bound::none(Metric::NotFinite), Bound::new(Metric::WeightError, 1.0 / 1_048_576.0)];

/// Bounds: all values are finite, and errors of texture coordinates are at most 1/1000 of a texel.
const CLOSE_TEXELS: &[Bound] = &[Bound::none(Metric::NotFinite), Bound::new(Metric::UvTexels, 1e-3)];

/// Bounds: all values are finite, and the two triangles have equal depths at every evaluated pixel.
const EQUAL: &[Bound] = &[Bound::none(Metric::NotFinite), Bound::none(Metric::Flips)];

pub(super) const CLASSES: &[Class] = &[
    Class {
        id: "affine",
        name: "Without perspective",
        family: Family::Weights,
        about: "Equal w at all corners: perspective-correct and affine weights are equal, so all errors come from the \
            arithmetic.",
        headline: Metric::WeightError,
        bounds: CLOSE,
        draft: affine,
    },
    Class {
        id: "perspective",
        name: "Moderate perspective",
        family: Family::Weights,
        about: "Corners up to a hundred times as far as others: affine interpolation on the screen is wrong by half of \
                the texture.",
        headline: Metric::WeightError,
        bounds: CLOSE,
        draft: perspective,
    },
    Class {
        id: "w-ratio",
        name: "Extreme perspective",
        family: Family::Weights,
        about: "Distances that differ by a factor of 1e3 to 1e15: the nearest corner takes nearly all the weight, and \
                its rounding errors must not exceed the other weights.",
        headline: Metric::WeightError,
        bounds: CLOSE,
        draft: w_ratio,
    },
    Class {
        id: "thin",
        name: "Thin triangles",
        family: Family::Weights,
        about: "Slivers through pixel centres: weights are quotients of small differences, and leave the range 0…1 \
                when these are rounded.",
        headline: Metric::WeightError,
        bounds: CLOSE,
        draft: thin,
    },
    Class {
        id: "wide-thin",
        name: "Long thin triangles",
        family: Family::Weights,
        about: "Slivers across a large picture: in f32, products of coordinates lose the digits that the small area \
                needs, and textures tear.",
        headline: Metric::WeightError,
        bounds: CLOSE_WIDE,
        draft: wide_thin,
    },
    Class {
        id: "huge-uv",
        name: "Huge texture coordinates",
        family: Family::Weights,
        about: "Texture coordinates of 1e2 to 1e6 repeats: a float of that size has few digits left for the position \
                within the texture.",
        headline: Metric::UvTexels,
        bounds: CLOSE_TEXELS,
        draft: huge_uv,
    },
    Class {
        id: "coplanar",
        name: "Coplanar triangles",
        family: Family::Weights,
        about: "Two different triangles in one plane: their depths should be equal everywhere, but differ by rounding, \
                which causes z-fighting.",
        headline: Metric::Flips,
        bounds: EQUAL,
        draft: coplanar,
    },
];

/// Returns up to [`SAMPLES`] random pixels whose centres lie inside all triangles.
fn samples(dice: &mut Rng, side: u32, triangles: &[&[ScreenCorner; 3]]) -> Vec<[u32; 2]> {
    let viewport = Viewport { width: side, height: side };
    let regions: Vec<_> = triangles
        .iter()
        .map(|corners| ExactRegion::triangle(corners.map(|c| [c.x, c.y]), Snap::Unsnapped, FillRule::TopLeft))
        .collect();
    let spans = regions.first().map(|region| region.spans(viewport)).unwrap_or_default();
    let mut pixels: Vec<[u32; 2]> = Vec::new();
    // Take only a few pixels per row, because large triangles cover millions.
    for span in spans {
        let width = span.right - span.left;
        let step = (width as usize / SAMPLES).max(1);
        pixels.extend((span.left..span.right).step_by(step).map(|column| [column, span.row]));
    }
    pixels.retain(|[column, row]| regions.iter().all(|region| region.contains(*column, *row)));
    dice.shuffle(&mut pixels);
    pixels.truncate(SAMPLES);
    pixels.sort_unstable();
    pixels
}

/// Creates a test case of one triangle, or returns `None` if the triangle contains no pixel centre.
fn draft(dice: &mut Rng, note: impl Into<String>, side: u32, vertices: [ScreenCorner; 3]) -> Option<CaseDraft> {
    let eval = samples(dice, side, &[&vertices]);
    let body = Body::TriAttr(AttributeCase { width: side, height: side, vertices, eval: eval.clone() });
    (!eval.is_empty()).then(|| CaseDraft::new(note, body))
}

/// Returns a vertex with the given w, at a random position in the image, with random depth and texture coordinates.
fn corner(dice: &mut Rng, side: u32, w: f64) -> ScreenCorner {
    let [x, y] = [(); 2].map(|()| dice.on_grid(0, side as i32));
    let [z, u, v] = to_f32([(); 3].map(|()| dice.uniform(0.0, 1.0)));
    ScreenCorner { x, y, z, w: w as f32, uv: [u, v] }
}

/// Creates eight test cases of one random triangle each; `w` returns the w of the next vertex.
fn eight(dice: &mut Rng, side: u32, note: &str, mut w: impl FnMut(&mut Rng) -> f64) -> Vec<CaseDraft> {
    let mut drafts = Vec::new();
    while drafts.len() < 8 {
        let corners = [(); 3].map(|()| {
            let w = w(dice);
            corner(dice, side, w)
        });
        drafts.extend(draft(dice, note, side, corners));
    }
    drafts
}

fn affine(dice: &mut Rng) -> Vec<CaseDraft> {
    eight(dice, SIDE, "w = 1", |_| 1.0)
}

fn perspective(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut drafts = eight(dice, SIDE, "w from 0.1 to 10", |dice| dice.log_uniform(0.1, 10.0));
    drafts.extend(eight(dice, LARGE, "w from 0.1 to 10, 4096 px", |dice| dice.log_uniform(0.1, 10.0)));
    drafts
}

fn w_ratio(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut exponents = [3.0, 6.0, 9.0, 12.0, 15.0].into_iter().cycle();
    let mut drafts = Vec::new();
    while drafts.len() < 10 {
        let ratio: f64 = exponents.next().unwrap_or_default();
        let near = 10.0_f64.powf(-ratio / 2.0);
        let ws = dice.shuffled([near, near * 10.0_f64.powf(ratio), near * 10.0_f64.powf(ratio * 0.5)]);
        let corners = ws.map(|w| corner(dice, SIDE, w));
        drafts.extend(draft(dice, format!("w ratio 1e{ratio}"), SIDE, corners));
    }
    drafts
}

/// Creates a test case of a sliver whose axis joins a pixel centre on the left of the image to one on the right and
/// passes through pixel centres between them. The left edge is vertical and extends `half` px above and below the axis.
fn sliver(dice: &mut Rng, side: u32, half: f32) -> Option<CaseDraft> {
    let rises = dice.integer(3..(side as i32 / 8).min(100));
    let run = (side as i32 - 4) / rises * rises;
    let start = [dice.centre(1, 4), dice.centre(1, side as i32 - rises - 1)];
    let end = [start[0] + run as f32, start[1] + rises as f32];
    let mut at =
        |[x, y]: [f32; 2], z: f32, uv: [f32; 2]| ScreenCorner { x, y, z, w: dice.uniform(1.0, 9.0) as f32, uv };
    let upper = at([start[0], start[1] - half], 0.1, [0.0, 0.0]);
    let lower = at([start[0], start[1] + half], 0.5, [0.0, 1.0]);
    let tip = at(end, 0.9, [1.0, 0.0]);
    let corners = dice.shuffled([upper, lower, tip]);
    draft(dice, format!("{half} px high on both sides"), side, corners)
}

/// Half the length of the slivers' left edges, in pixels; all values are multiples of the snapping step, 1/256 px.
const HALF_HEIGHTS: [f32; 5] = [0.5, 0.125, 0.031_25, 0.007_812_5, 0.003_906_25];

fn thin(dice: &mut Rng) -> Vec<CaseDraft> {
    HALF_HEIGHTS.into_iter().cycle().take(10).filter_map(|half| sliver(dice, SIDE, half)).collect()
}

fn wide_thin(dice: &mut Rng) -> Vec<CaseDraft> {
    HALF_HEIGHTS.into_iter().cycle().take(10).filter_map(|half| sliver(dice, LARGE, half)).collect()
}

fn huge_uv(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut drafts = Vec::new();
    for offset in [1e2, 1e3, 1e4, 1e5, 1e6] {
        let mut corners = [(); 3].map(|()| {
            let w = dice.uniform(1.0, 4.0);
            corner(dice, SIDE, w)
        });
        for corner in &mut corners {
            let [u, v] = corner.uv.map(f64::from);
            corner.uv = to_f32([offset + u, v - offset]);
        }
        drafts.extend(draft(dice, format!("{offset:e} repeats"), SIDE, corners));
    }
    drafts
}

fn coplanar(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut drafts = Vec::new();
    while drafts.len() < 8 {
        // A parallelogram is always planar, and f32 represents all its vertices exactly: positions are multiples of
        // 1/256 px, depths multiples of 2⁻²⁴ in [½, 1). The first triangle is one half of the parallelogram, cut along
        // one diagonal. The second triangle is one half of it, cut along the other diagonal, so the two overlap.
        let mut at = |_: usize| {
            let depth = 0.5 + f64::from(dice.integer(0..1 << 23)) / 16_777_216.0;
            [dice.on_grid(0, SIDE as i32).into(), dice.on_grid(0, SIDE as i32).into(), depth]
        };
        let [a, b, c]: [[f64; 3]; 3] = std::array::from_fn(&mut at);
        let d = [0, 1, 2].map(|axis| a[axis] + c[axis] - b[axis]);
        if !(0.5..1.0).contains(&d[2]) {
            continue;
        }
        let corner = |[x, y, z]: [f64; 3]| ScreenCorner { x: x as f32, y: y as f32, z: z as f32, w: 1.0, uv: [0.0; 2] };
        let (first, second) = ([a, b, c].map(corner), [a, b, d].map(corner));
        let (first, second) = (dice.shuffled(first), dice.shuffled(second));
        let eval = samples(dice, SIDE, &[&first, &second]);
        if eval.len() >= SAMPLES / 2 {
            let body = Body::CoplanarPair(CoplanarPairCase { width: SIDE, height: SIDE, first, second, eval });
            drafts.push(CaseDraft::new("two triangles in one plane", body));
        }
    }
    drafts
}
