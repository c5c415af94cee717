//! Test cases for the coverage of individual triangles.

use super::rng::{Rng, to_f32};
use super::{CaseDraft, Class, Family};
use crate::pipeline::settings::FillRule;
use crate::report::stability::case::{Body, Coverage};
use crate::report::stability::metric::{Bound, Metric};

/// Side length of the image in most classes, in pixels.
const SIDE: u32 = 32;

/// Side length of the image in most classes, in pixels, as a floating-point number.
const SIDE_PX: f64 = SIDE as f64;

/// Bound: no pixel is wrong. The exact pixels are computed from vertices that are snapped as in the tested
/// configuration.
pub(super) const EXACT: &[Bound] = &[Bound::none(Metric::Wrong)];

pub(super) const CLASSES: &[Class] = &[
    Class {
        id: "benign",
        name: "Benign triangles",
        family: Family::Coverage,
        about: "Compact triangles at random positions: every method should draw all of them correctly, so this is the \
            baseline.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: benign,
    },
    Class {
        id: "on-centres",
        name: "Edges through centres",
        family: Family::Coverage,
        about: "Corners and edges lie exactly on pixel centres, so the fill rule alone decides; methods that step \
                along edges drift off the tie, and methods without a fill rule draw pixels twice.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: on_centres,
    },
    Class {
        id: "slivers",
        name: "Slivers",
        family: Family::Coverage,
        about: "Triangles 1e-6 to 0.5 px wide: the area is a difference of nearly equal numbers, and a triangle \
                thinner than the grid step vanishes when its corners are snapped.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: slivers,
    },
    Class {
        id: "needles",
        name: "Needles",
        family: Family::Coverage,
        about: "Hair-thin strips around a row or column of pixel centres: slopes become 0 or infinite, and rounding one \
                corner moves all pixels in or out at once.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: needles,
    },
    Class {
        id: "near-ties",
        name: "Ties within 2⁻⁴⁰ px",
        family: Family::Coverage,
        about: "An edge misses pixel centres by less than double precision can distinguish from zero: only exact \
                arithmetic, or snapping, which makes it a tie, decides consistently.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: near_ties,
    },
    Class {
        id: "tiny",
        name: "Tiny triangles",
        family: Family::Coverage,
        about: "Most of these triangles lie between pixel centres and cover nothing: they show the setup cost of a \
                triangle without pixels.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: tiny,
    },
    Class {
        id: "degenerate",
        name: "Degenerate triangles",
        family: Family::Coverage,
        about: "Points, lines and repeated corners have no area and must cover nothing; division by that area gives \
            NaN.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: degenerate,
    },
    Class {
        id: "huge",
        name: "Huge triangles",
        family: Family::Coverage,
        about: "Corners 1e7 to 3e38 px away: integers overflow, floats have no digits left for pixels, and loops over the \
                bounding box never end unless they are clamped to the picture.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: huge,
    },
    Class {
        id: "guard-band",
        name: "Long edges",
        family: Family::Coverage,
        about: "Edges of 2e5 to 2e7 px pass through the picture: the products of an edge function need more than 32 or 53 \
                bits, and f32 puts whole rows on the wrong side.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: guard_band,
    },
    Class {
        id: "subnormal",
        name: "Subnormal",
        family: Family::Coverage,
        about: "Corners differ from a centre by the smallest numbers that exist: flushing these to zero, or products \
                that underflow, create ties where there are none.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: subnormal,
    },
    Class {
        id: "wide",
        name: "Wide picture",
        family: Family::Coverage,
        about: "Long flat edges over many centres: values accumulated step by step collect the errors of 4096 steps.",
        headline: Metric::Wrong,
        bounds: EXACT,
        draft: wide,
    },
];

/// Creates a test case of triangles in a square image, with the top-left fill rule.
fn square(note: impl Into<String>, triangles: Vec<[[f32; 2]; 3]>) -> CaseDraft {
    coverage(note, [SIDE; 2], triangles)
}

pub(super) fn coverage(note: impl Into<String>, [width, height]: [u32; 2], triangles: Vec<[[f32; 2]; 3]>) -> CaseDraft {
    let rule = FillRule::TopLeft;
    CaseDraft::new(note, Body::TriCoverage(Coverage { width, height, rule, triangles, exactly_once: false }))
}

/// Creates `drafts` test cases of `triangles` triangles each; `one` generates a triangle.
fn several(
    dice: &mut Rng,
    drafts: usize,
    triangles: usize,
    mut one: impl FnMut(&mut Rng) -> [[f32; 2]; 3],
) -> Vec<CaseDraft> {
    (0..drafts).map(|_| square("", (0..triangles).map(|_| one(dice)).collect())).collect()
}

fn benign(dice: &mut Rng) -> Vec<CaseDraft> {
    several(dice, 4, 12, |dice| {
        let ([x, y], radius) = ([0, 1].map(|_| dice.uniform(8.0, 24.0)), dice.uniform(4.0, 20.0));
        let start = dice.direction();
        // Three directions about a third of a turn apart.
        let corner = |turn: f64| {
            let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
            let [dx, dy] = [start[0] * cos - start[1] * sin, start[0] * sin + start[1] * cos];
            to_f32([x + radius * dx, y + radius * dy])
        };
        let corners = [0.0, dice.uniform(0.25, 0.42), dice.uniform(0.58, 0.75)].map(corner);
        dice.shuffled(corners)
    })
}

fn on_centres(dice: &mut Rng) -> Vec<CaseDraft> {
    let mut drafts = several(dice, 4, 12, |dice| [(); 3].map(|()| [(); 2].map(|()| dice.centre(-2, 34))));
    // Vertices on a half-pixel lattice: edges pass through pixel centres and pixel corners alike.
    drafts.extend(several(dice, 3, 12, |dice| [(); 3].map(|()| [(); 2].map(|()| dice.integer(-4..68) as f32 * 0.5))));
    let [a, b, c, d] = [[4.5, 4.5], [14.5, 4.5], [14.5, 14.5], [4.5, 14.5]];
    drafts.push(square("a square cut by its diagonal through centres", vec![[a, b, c], [c, d, a]]));
    drafts
}

fn slivers(dice: &mut Rng) -> Vec<CaseDraft> {
    let anywhere = |dice: &mut Rng| {
        let (start, along) = ([dice.uniform(0.0, SIDE_PX), dice.uniform(0.0, SIDE_PX)], dice.direction());
        let (length, width) = (dice.uniform(10.0, 60.0), dice.log_uniform(1e-6, 0.5));
        let end = [start[0] + along[0] * length, start[1] + along[1] * length];
        [to_f32(start), to_f32(end), to_f32([end[0] - along[1] * width, end[1] + along[0] * width])]
    };
    // The short side is centred on a pixel centre and the tip lies on another, so the sliver contains all pixel centres
    // on its axis.
    let between_centres = |dice: &mut Rng| {
        let (from, to) = ([dice.centre(0, 4), dice.centre(0, 31)], [dice.centre(28, 32), dice.centre(0, 31)]);
        let half = dice.log_uniform(1e-6, 0.1) as f32;
        [to, [from[0], from[1] - half], [from[0], from[1] + half]]
    };
    let mut drafts = several(dice, 6, 8, anywhere);
    drafts.extend(several(dice, 6, 4, between_centres));
    drafts
}

fn needles(dice: &mut Rng) -> Vec<CaseDraft> {
    let strip = |dice: &mut Rng| {
        let (middle, half) = (dice.centre(2, 30), dice.log_uniform(1e-6, 4e-3) as f32);
        let upright = dice.bool();
        let at = |along: f32, across: f32| if upright { [across, along] } else { [along, across] };
        let [a, b, c, d] =
            [at(0.25, middle - half), at(31.75, middle - half), at(31.75, middle + half), at(0.25, middle + half)];
        [[a, b, c], [c, d, a]]
    };
    (0..12).map(|_| square("a strip of two triangles around a centre line", strip(dice).to_vec())).collect()
}

fn near_ties(dice: &mut Rng) -> Vec<CaseDraft> {
    // An edge from the origin to `parts` · (dx, dy) consists of `parts` steps. dx and dy are odd, so the middle of each
    // step is a pixel centre. The start of the edge is then moved by less than f64 resolves at the coordinates of the
    // end.
    const STEPS: [[f32; 2]; 6] = [[1.0, 1.0], [3.0, 1.0], [1.0, 3.0], [3.0, 5.0], [5.0, 3.0], [7.0, 5.0]];
    let one = |dice: &mut Rng, [dx, dy]: [f32; 2]| {
        let parts = ((SIDE as f32 / dx.max(dy)) as i32 - 1) | 1;
        let end = [dx * parts as f32, dy * parts as f32];
        let tiny = |dice: &mut Rng| (dice.sign() * 2.0_f64.powi(-dice.integer(62..100))) as f32;
        let start = [tiny(dice), tiny(dice)];
        let third = if dice.bool() { [end[0], -3.0] } else { [-3.0, end[1]] };
        dice.shuffled([start, end, third])
    };
    (0..10)
        .map(|i| square("an edge misses centres by less than 2⁻⁴⁰ px", vec![one(dice, STEPS[i % STEPS.len()])]))
        .collect()
}

fn tiny(dice: &mut Rng) -> Vec<CaseDraft> {
    several(dice, 4, 64, |dice| {
        let ([x, y], size) = ([0, 1].map(|_| dice.uniform(0.0, SIDE_PX)), dice.log_uniform(1e-3, 1.0));
        [(); 3].map(|()| to_f32([x + dice.uniform(-size, size), y + dice.uniform(-size, size)]))
    })
}

fn degenerate(dice: &mut Rng) -> Vec<CaseDraft> {
    let point = [dice.centre(4, 28), dice.centre(4, 28)];
    let [x, y] = point;
    let ulp = 2.0_f32.powi(-19);
    vec![
        square("a point on a centre", vec![[point; 3]]),
        square("two corners at one position", vec![[point, point, [x + 7.0, y - 3.0]]]),
        square("all on a diagonal through centres", vec![[[2.5, 2.5], [9.5, 9.5], [20.5, 20.5]]]),
        square("all on a row of centres", vec![[[2.5, y], [19.5, y], [9.5, y]]]),
        square("all on a column of centres", vec![[[x, 2.5], [x, 19.5], [x, 9.5]]]),
        square("on one line in decimals, not in binary", vec![[[0.1, 0.1], [0.2, 0.2], [30.3, 30.3]]]),
        square("on one line in decimals, not in binary", vec![[[0.1, 0.3], [10.1, 10.3], [31.1, 31.3]]]),
        square("two corners at nearly one position", vec![[[4.5, 4.5], [4.5 + ulp, 4.5], [28.5, 28.5]]]),
        square("nearly on one line", vec![[[4.5, 4.5], [16.5, 16.5 + ulp], [28.5, 28.5]]]),
    ]
}

fn huge(dice: &mut Rng) -> Vec<CaseDraft> {
    let far = |dice: &mut Rng| dice.log_uniform(1e7, 3.4e38);
    // Vertices in three directions around the image, so that most triangles contain or cross it.
    let mut drafts: Vec<_> = (0..12)
        .map(|_| {
            let start = dice.uniform(0.0, 1.0);
            let corners = [0.0, 1.0, 2.0].map(|third| {
                let (sin, cos) = ((start + third / 3.0 + dice.uniform(-0.1, 0.1)) * std::f64::consts::TAU).sin_cos();
                let distance = far(dice);
                to_f32([cos * distance, sin * distance])
            });
            square(format!("corners up to {:.0e} px away", largest(&corners)), vec![corners])
        })
        .collect();
    // One vertex inside the image.
    drafts.extend((0..4).map(|_| {
        let near = [dice.uniform(0.0, SIDE_PX), dice.uniform(0.0, SIDE_PX)];
        let [a, b] = [(); 2].map(|()| to_f32([dice.sign() * far(dice), dice.sign() * far(dice)]));
        let corners = [to_f32(near), a, b];
        square(format!("from the picture to {:.0e} px away", largest(&corners)), vec![corners])
    }));
    let most = f32::MAX;
    drafts.push(square("the largest finite numbers", vec![[[-most, -most], [most, -most], [0.0, most]]]));
    drafts
}

fn largest(corners: &[[f32; 2]; 3]) -> f32 {
    corners.iter().flatten().fold(0.0, |most, c| c.abs().max(most))
}

fn guard_band(dice: &mut Rng) -> Vec<CaseDraft> {
    let through_picture = |dice: &mut Rng, length: f64| {
        let (at, along) = ([dice.uniform(4.0, 28.0), dice.uniform(4.0, 28.0)], dice.direction());
        let (before, after) = (length * dice.uniform(0.2, 0.8), length * dice.uniform(0.2, 0.8));
        let start = [at[0] - along[0] * before, at[1] - along[1] * before];
        let end = [at[0] + along[0] * after, at[1] + along[1] * after];
        let third = [at[0] - along[1] * length, at[1] + along[0] * length];
        [to_f32(start), to_f32(end), to_f32(third)]
    };
    let lengths = [2e5, 1e6, 2e6, 2e7].into_iter().cycle().take(16);
    lengths.map(|length| square(format!("an edge of {length:.0e} px"), vec![through_picture(dice, length)])).collect()
}

fn subnormal(dice: &mut Rng) -> Vec<CaseDraft> {
    let tiny = |dice: &mut Rng| f32::from_bits(dice.integer(1..1 << 23) as u32) * dice.sign() as f32;
    let least = f32::from_bits(1);
    let mut drafts = vec![
        square("a corner one subnormal right of the border", vec![[[0.0, 0.0], [least, 16.0], [16.0, 0.0]]]),
        square("a left edge one subnormal left of the border", vec![[[-least, 0.0], [16.0, 8.0], [-least, 16.0]]]),
        square("all coordinates subnormal", vec![[[0.0, 0.0], [least * 9.0, least], [least, least * 7.0]]]),
    ];
    // Edges that miss pixel centres on the diagonal by a subnormal number.
    drafts.extend((0..5).map(|_| {
        let corners = [[tiny(dice), tiny(dice)], [31.0, 31.0], [31.0, tiny(dice)]];
        square("a diagonal through centres but for a subnormal", vec![dice.shuffled(corners)])
    }));
    drafts
}

fn wide(dice: &mut Rng) -> Vec<CaseDraft> {
    const WIDE: [u32; 2] = [4096, 48];
    let through_centres = |dice: &mut Rng| {
        let corners = [[0.5, 0.5], [dice.centre(1000, 3000), dice.centre(20, 48)], [4095.5, dice.centre(0, 48)]];
        dice.shuffled(corners)
    };
    let mut drafts: Vec<_> =
        (0..2).map(|_| coverage("corners on centres", WIDE, vec![through_centres(dice)])).collect();
    drafts.extend((0..4).map(|_| {
        let corners = [(); 3].map(|()| [dice.on_grid(-20, 4116), dice.on_grid(-4, 52)]);
        coverage("corners on the 1/256 px grid", WIDE, vec![corners])
    }));
    drafts
}
