//! Test cases of triangles that cannot be projected without special treatment: vertices lie behind the eye, have
//! extremely large coordinates, or are not finite.

use super::rng::{Rng, to_f32};
use super::{CaseDraft, Class, Family};
use crate::report::stability::case::{Body, ClipSpace};
use crate::report::stability::metric::{Bound, Metric};

/// Side length of the image, in pixels.
const SIDE: u32 = 32;

/// Distance of the near plane from the eye, in view-space units; [`FAR`] is the distance of the far plane.
const NEAR: f64 = 0.1;
const FAR: f64 = 100.0;

/// Bounds: no pixel is clearly wrong or drawn twice, all values are finite, and weight errors are at most 1e-6.
const CLIPPED: &[Bound] = &[
    Bound::none(Metric::WrongStrict),
    Bound::none(Metric::Doubles),
    Bound::none(Metric::NotFinite),
    Bound::new(Metric::WeightError, 1e-6),
];

pub(super) const CLASSES: &[Class] = &[
    Class {
        id: "near-crossing",
        name: "Through the near plane",
        family: Family::ClipSpace,
        about: "Triangles that reach behind the eye: division by a negative w mirrors the corner, so a triangle that \
                is not clipped before the division appears on the wrong side of the picture.",
        headline: Metric::WrongStrict,
        bounds: CLIPPED,
        draft: near_crossing,
    },
    Class {
        id: "zero-w",
        name: "w at and near zero",
        family: Family::ClipSpace,
        about: "Corners beside the eye, with w of exactly 0, 1e-7 or 1e-30: the division gives infinity or NaN unless \
                the corner is clipped first.",
        headline: Metric::WrongStrict,
        bounds: CLIPPED,
        draft: zero_w,
    },
    Class {
        id: "eye-inside",
        name: "Around the eye",
        family: Family::ClipSpace,
        about: "Planes close to the eye or through it, with corners all around: seen edge-on they shrink to a line, \
                and each weight becomes a quotient of two vanishing numbers.",
        headline: Metric::WrongStrict,
        bounds: CLIPPED,
        draft: eye_inside,
    },
    Class {
        id: "clip-huge",
        name: "The largest coordinates",
        family: Family::ClipSpace,
        about: "Clip coordinates up to 3e38: products of two of them overflow, and differences lose the part inside \
            the picture.",
        headline: Metric::WrongStrict,
        bounds: CLIPPED,
        draft: huge,
    },
    Class {
        id: "not-finite",
        name: "NaN and infinity",
        family: Family::ClipSpace,
        about: "A triangle with a NaN or infinite corner must be discarded without affecting others: nothing may be \
                drawn, and no loop may run forever.",
        headline: Metric::WrongStrict,
        bounds: CLIPPED,
        draft: not_finite,
    },
];

fn clip_space(note: impl Into<String>, triangles: Vec<[[f32; 4]; 3]>) -> CaseDraft {
    CaseDraft::new(note, Body::ClipTri(ClipSpace { width: SIDE, height: SIDE, triangles }))
}

/// Projects a view-space point, given by x, y and its distance from the eye, to clip space. z/w ranges from 0 at
/// [`NEAR`] to 1 at [`FAR`].
fn project([x, y, distance]: [f64; 3]) -> [f32; 4] {
    to_f32([x, y, (distance - NEAR) * FAR / (FAR - NEAR), distance])
}

fn near_crossing(dice: &mut Rng) -> Vec<CaseDraft> {
    let random = |dice: &mut Rng| {
        [(); 3].map(|()| project([dice.uniform(-4.0, 4.0), dice.uniform(-4.0, 4.0), dice.uniform(-3.0, 5.0)]))
    };
    let mut drafts: Vec<_> =
        (0..16).map(|_| clip_space("corners before and behind the eye", vec![random(dice)])).collect();
    let floor = |corners: [[f64; 2]; 3]| corners.map(|[x, distance]| project([x, -1.0, distance]));
    drafts.push(clip_space("a floor with one corner behind", vec![floor([[-5.0, 8.0], [5.0, 8.0], [0.0, -6.0]])]));
    drafts.push(clip_space("a floor with two corners behind", vec![floor([[-9.0, -2.0], [9.0, -2.0], [0.0, 40.0]])]));
    drafts.push(clip_space("all behind", vec![floor([[-5.0, -8.0], [5.0, -8.0], [0.0, -0.5]])]));
    drafts
}

fn zero_w(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut with_w = |w: f32| {
        // z is approximately the value that `project` returns for this w. It is negative, so the near plane cuts off
        // the vertex.
        let odd = [dice.uniform(-2.0, 2.0) as f32, dice.uniform(-2.0, 2.0) as f32, w - NEAR as f32, w];
        let other =
            |dice: &mut Rng| project([dice.uniform(-2.0, 2.0), dice.uniform(-2.0, 2.0), dice.uniform(0.5, 4.0)]);
        let corners = [odd, other(dice), other(dice)];
        dice.shuffled(corners)
    };
    let ws = [0.0, -0.0, 1e-7, 1e-30, -1e-30, 1e-38, 1e-45];
    let mut drafts: Vec<_> =
        ws.iter().cycle().take(14).map(|w| clip_space(format!("w = {w:e}"), vec![with_w(*w)])).collect();
    // A vertex on the near plane although w is (almost) 0: no camera produces it, but a renderer must handle it.
    drafts.extend([0.0, 1e-30].map(|w| {
        let odd = [1.0, 0.5, 0.0, w];
        clip_space(format!("z = 0, w = {w:e}"), vec![[odd, project([-1.0, -1.0, 2.0]), project([1.0, -1.0, 3.0])]])
    }));
    drafts.push(clip_space(
        "a corner of four zeros",
        vec![[[0.0; 4], project([-1.0, -1.0, 2.0]), project([1.0, -1.0, 3.0])]],
    ));
    drafts
}

fn eye_inside(dice: &mut Rng) -> Vec<CaseDraft> {
    let around = |dice: &mut Rng, height: f64| {
        let start = dice.uniform(0.0, 1.0);
        let tilt = dice.direction();
        [0.0, 1.0, 2.0].map(|third| {
            let (sin, cos) = ((start + third / 3.0) * std::f64::consts::TAU).sin_cos();
            let reach = dice.uniform(3.0, 30.0);
            let [x, distance] = [cos * reach, sin * reach];
            // Rotated about the view axis, so that the plane is seen from all sides.
            project([x * tilt[0] - height * tilt[1], x * tilt[1] + height * tilt[0], distance])
        })
    };
    let heights = [0.0, 1e-7, 1e-5, 1e-3, 0.01, 0.1, 0.5, 1.0].into_iter().cycle().take(16);
    heights.map(|height| clip_space(format!("a plane {height:e} from the eye"), vec![around(dice, height)])).collect()
}

fn huge(dice: &mut Rng) -> Vec<CaseDraft> {
    let far = |dice: &mut Rng| dice.sign() * dice.log_uniform(1e6, 3.4e38);
    let mut drafts = Vec::new();
    for _ in 0..6 {
        // Vertices in front of the eye, with x and y up to the limits of f32.
        let corners = [(); 3].map(|()| to_f32([far(dice), far(dice), 0.5, 1.0]));
        drafts.push(clip_space("x and y beyond all bounds", vec![corners]));
        // Vertices in front of and behind the eye: w of any magnitude and sign, with z proportional to w.
        let corners = [(); 3].map(|()| {
            let w = far(dice);
            to_f32([w * dice.uniform(-2.0, 2.0), w * dice.uniform(-2.0, 2.0), w * 0.5, w])
        });
        drafts.push(clip_space("w beyond all bounds", vec![corners]));
    }
    let most = f32::MAX;
    let corners = [[-most, -most, 0.5, 1.0], [most, -most, 0.5, 1.0], [0.0, most, 0.5, 1.0]];
    drafts.push(clip_space("the largest finite numbers", vec![corners]));
    drafts
}

fn not_finite(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut drafts = Vec::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..4 {
            let mut corners =
                [(); 3].map(|()| project([dice.uniform(-2.0, 2.0), dice.uniform(-2.0, 2.0), dice.uniform(1.0, 4.0)]));
            corners[dice.integer(0..3) as usize][axis] = bad;
            drafts.push(clip_space(format!("{bad} as {}", ["x", "y", "z", "w"][axis]), vec![corners]));
        }
    }
    drafts
}
