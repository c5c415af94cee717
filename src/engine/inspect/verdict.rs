//! Verdict on a pixel in a few sentences: the winning triangle, its rivals, and whether rounding decided the outcome.

mod background;

mod black;

mod flaw;

mod history;

mod order;

pub(super) use order::is_blended_wrongly;

use std::collections::BTreeSet;

use super::hits::{Fault, FaultKind};
use super::pixel::{Absent, FragmentOutcome, FragmentRecord, PixelReport};
use crate::chain::{Frame, Recipe};
use crate::pipeline::depth::DepthComparison;
use crate::pipeline::settings::{Choice as _, Settings};
use crate::scene::{Instance, Scene, TriangleId};

/// Beginning of the verdict on a pixel that one triangle won unambiguously.
const UNAMBIGUOUS_WIN: &str = "Won by ";

/// Explains the colour of a pixel in a few sentences. A fault along a shared edge or a wrong blending order comes
/// first, then the outcome of the depth test. Sentences about a black pixel or a defective scene file follow. If one
/// triangle won unambiguously, the reason why the pixel is black comes before the outcome of the depth test, because
/// that is the most likely question.
pub(super) fn verdict(report: &PixelReport, scene: &Scene, recipe: &Recipe, frame: &Frame) -> String {
    let fault = report.fault.as_ref().map(|fault| fault_verdict(fault, &recipe.pipeline));
    let story = story(report, frame.is_drawn(report.x, report.y), DepthComparison::of(&recipe.pipeline));
    let order = order::verdict(report, scene, recipe, frame);
    let black = black::why(report, scene, recipe);
    let flaw = flaw::describe_flaws(report, scene, recipe, frame, black.as_deref().unwrap_or_default());
    let (before, after) = if story.starts_with(UNAMBIGUOUS_WIN) { (black, None) } else { (None, black) };
    let sentences: Vec<_> = [fault, before, order, Some(story), after, flaw].into_iter().flatten().collect();
    sentences.join(" ")
}

/// Returns the index of the instance that contains a triangle, and that instance.
fn instance_of(scene: &Scene, id: TriangleId) -> Option<(usize, &Instance)> {
    let index = scene.first_triangles().partition_point(|first| *first <= id).checked_sub(1)?;
    Some((index, scene.instances.get(index)?))
}

fn story(report: &PixelReport, drawn: bool, comparison: DepthComparison) -> String {
    let story = smooth_verdict(report) + &fragment_verdict(&report.fragments, &report.absent, comparison);
    if let Some(triangle) = report.wireframe {
        return format!("Covered by a wireframe line of triangle {}. {story}", triangle.0);
    }
    if drawn {
        return story;
    }
    let history = report.history.as_ref().map(history::verdict).unwrap_or_default();
    if report.history.as_ref().is_some_and(|step| step.past.is_ok()) {
        if report.sources.is_empty() {
            return format!("{history} This frame draws none of the pixels around it.");
        }
        return format!("{history} Drawn sample with the largest weight: {story}");
    }
    let [x, y] = report.drawn_at;
    let count = report.sources.len();
    let made_of = if count == 1 {
        "copied from one drawn pixel".to_owned()
    } else {
        format!("interpolated from {count} drawn pixels")
    };
    let history = if history.is_empty() { history } else { format!("{history} ") };
    format!("{history}Not drawn: {made_of}. Pixel with the largest weight, ({x}, {y}): {story}")
}

/// Returns the introduction to the verdict on a pixel with several samples; empty for a pixel with a single sample.
fn smooth_verdict(report: &PixelReport) -> String {
    let colors: BTreeSet<_> = report.samples.iter().map(|sample| sample.color).collect();
    match (report.samples.len(), colors.len()) {
        (0, _) => String::new(),
        (count, 1) => format!("The mean of {count} equal samples. At its centre: "),
        (count, colors) => format!("The mean of {count} samples of {colors} colours. At its centre: "),
    }
}

/// Explains which fragment won the depth test and how closely. Pieces of a clipped triangle count as one triangle, not
/// as rivals. Fragments that failed the alpha test do not count.
fn fragment_verdict(fragments: &[FragmentRecord], absent: &[Absent], comparison: DepthComparison) -> String {
    let Some(winner) = fragments.iter().find(|f| f.outcome == FragmentOutcome::Visible) else {
        return background::verdict(fragments, absent);
    };
    if !winner.covers_all() {
        return blended_verdict(fragments, winner);
    }
    let name = name(winner);
    let there = || fragments.iter().filter(|f| f.outcome != FragmentOutcome::AlphaRejected);
    let triangles = count_triangles(there());
    let Some((steps, rival)) = closest_rival(fragments, winner) else {
        let others = if there().count() < fragments.len() { " that passes the alpha test" } else { "" };
        return format!("Won by {name}, the only one here{others}.");
    };
    match Margin::of(winner, steps, comparison) {
        Margin::NoTest => format!("Won by {name}, drawn last of {triangles} (no depth test)."),
        Margin::AllPass => format!("Won by {name}, drawn last of {triangles} (every fragment passes)."),
        Margin::Tie => {
            let rival = self::name(rival);
            format!("Depth tie: {name} and {rival} have exactly the same depth, so drawing order decides. {SEPARATE}")
        }
        Margin::OneCode => {
            format!(
                "Z-fight: {name} won by {Z_FIGHT_CODES} step of depth, the smallest difference that the buffer can \
                 store. {SEPARATE}"
            )
        }
        Margin::FewUlps => {
            let unit = if steps == 1 { "step" } else { "steps" };
            format!("Z-fight: {name} won by {steps} ulp of depth, the smallest {unit} of a float. {SEPARATE}")
        }
        Margin::Clear if triangles == 2 => format!("Won by {name} against one other."),
        Margin::Clear => format!("Won by {name} against {} others.", triangles - 1),
    }
}

/// Returns the fragment of another triangle whose depth is closest to that of the winner, and its distance in steps of
/// the depth buffer. Fragments that failed the alpha test do not count.
fn closest_rival<'a>(fragments: &'a [FragmentRecord], winner: &FragmentRecord) -> Option<(u32, &'a FragmentRecord)> {
    let there = fragments.iter().filter(|f| f.outcome != FragmentOutcome::AlphaRejected);
    let rivals = there.filter(|f| f.triangle != winner.triangle);
    rivals.map(|f| (f.depth.steps_from(&winner.depth), f)).min_by_key(|(steps, _)| *steps)
}

/// Margin by which a fragment won the depth test against its closest rival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Margin {
    /// There is no depth test.
    NoTest,
    /// Every fragment passes the depth test.
    AllPass,
    /// Both depths are equal.
    Tie,
    /// The depths differ by [`Z_FIGHT_CODES`] code of an integer format.
    OneCode,
    /// The depths differ by at most [`Z_FIGHT_ULPS`] ulp of a float.
    FewUlps,
    /// The depths differ by more than rounding alone may cause.
    Clear,
}

impl Margin {
    /// Returns the margin of the winner over a rival `steps` steps of the depth buffer away.
    fn of(winner: &FragmentRecord, steps: u32, comparison: DepthComparison) -> Self {
        match (winner.stored_depth, comparison, steps) {
            (None, _, _) => Self::NoTest,
            (_, DepthComparison::Always, _) => Self::AllPass,
            (_, _, 0) => Self::Tie,
            (_, _, Z_FIGHT_CODES) if winner.depth.code.is_some() => Self::OneCode,
            (_, _, 1..=Z_FIGHT_ULPS) if winner.depth.code.is_none() => Self::FewUlps,
            _ => Self::Clear,
        }
    }
}

/// Whether rounding or drawing order decided which of two opaque fragments is visible.
pub(super) fn is_depth_contested(fragments: &[FragmentRecord], comparison: DepthComparison) -> bool {
    let winner = fragments.iter().find(|f| f.outcome == FragmentOutcome::Visible).filter(|winner| winner.covers_all());
    let margin = winner
        .and_then(|winner| closest_rival(fragments, winner).map(|(steps, _)| Margin::of(winner, steps, comparison)));
    matches!(margin, Some(Margin::Tie | Margin::OneCode | Margin::FewUlps))
}

fn name(fragment: &FragmentRecord) -> String {
    format!("triangle {} of “{}”", fragment.triangle.0, fragment.instance)
}

fn count_triangles<'a>(fragments: impl Iterator<Item = &'a FragmentRecord>) -> usize {
    fragments.map(|f| f.triangle).collect::<BTreeSet<_>>().len()
}

/// Explains a pixel whose nearest fragment is blended.
fn blended_verdict(fragments: &[FragmentRecord], nearest: &FragmentRecord) -> String {
    let seen_through = || fragments.iter().rev().filter(|f| f.outcome == FragmentOutcome::BlendedOver);
    let behind = seen_through().find(|f| f.covers_all()).map_or("the background".to_owned(), name);
    let between = match seen_through().filter(|f| !f.covers_all()).count() {
        0 => String::new(),
        count => format!("{count} more and "),
    };
    let alpha = nearest.alpha.unwrap_or(1.0);
    format!("Blended: {} with alpha {alpha} over {between}{behind}.", name(nearest))
}

/// Explains a crack or a double hit along a shared edge or an open seam, in one or two sentences.
fn fault_verdict(fault: &Fault, settings: &Settings) -> String {
    let [one, other] = fault.sharing.map(|id| id.0);
    let (hits, due) = (fault.hit_by.len(), fault.due.len());
    let cause = cause(settings);
    if let Some(junction) = fault.junction {
        let gap = match fault.kind {
            FaultKind::Crack => format!("A crack: no triangle covers the gap between triangles {one} and {other} here"),
            FaultKind::DoubleHit => format!("Hit twice: triangles {one} and {other} overlap here"),
        };
        return format!("{gap}. {}.", junction.text());
    }
    match (fault.kind, hits) {
        (FaultKind::DoubleHit, _) => {
            let count = match (hits, due) {
                (2, ..=1) => "Hit twice".to_owned(),
                (_, 0) => format!("Hit {hits} times instead of 0"),
                (_, 1) => format!("Hit {hits} times instead of once"),
                _ => format!("Hit {hits} times instead of {due}"),
            };
            let pair = if one == other {
                format!("two pieces of triangle {one}")
            } else {
                format!("triangles {} and {}", one.min(other), one.max(other))
            };
            format!("{count}: {pair} share an edge here and {cause}.")
        }
        (FaultKind::Crack, 0) => {
            format!(
                "A crack: no triangle covers this pixel, though triangle {one} should; {}.",
                beside(one, other, &cause)
            )
        }
        (FaultKind::Crack, _) => {
            format!(
                "A crack: {hits} instead of {due} triangles cover this pixel, triangle {one} is missing; {}.",
                beside(one, other, &cause)
            )
        }
    }
}

fn beside(one: u32, other: u32, cause: &str) -> String {
    let neighbour = if one == other { "another piece of it".to_owned() } else { format!("triangle {other}") };
    format!("it shares an edge here with {neighbour} and {cause}")
}

/// Names the setting that causes faults along shared edges, and the remedy.
fn cause(settings: &Settings) -> String {
    if settings.rasterizer.is_published() {
        format!("the rasterizer is “{}”. To fix it, choose another rasterizer", settings.rasterizer.name())
    } else if settings.fill_rule.draws_shared_edges_once() {
        format!("the arithmetic is {}. To fix it, set arithmetic to fixed", settings.arithmetic.name())
    } else {
        format!("the fill rule is {}. To fix it, set fill_rule to top-left", settings.fill_rule.id())
    }
}

/// Maximum depth difference, in ulp, that rounding alone may cause: depth is computed from w, a sum of four products.
const Z_FIGHT_ULPS: u32 = 8;

/// Maximum depth difference, in codes, that rounding alone may cause: a code represents all depths within half a step.
const Z_FIGHT_CODES: u32 = 1;

/// Remedy for depth ties and z-fighting.
const SEPARATE: &str =
    "To separate the surfaces, move them apart or raise the depth precision (near plane, depth format).";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::DepthRecord;
    use crate::inspect::pixel::SampleState;
    use crate::pipeline::depth::DepthScale;
    use crate::pipeline::depth_format::DepthEncoding;
    use crate::pipeline::settings::{Arithmetic, FillRule, Rasterizer};
    use crate::scene::{DepthMapping, Transparency, TriangleId};

    const PREVIOUS_STATE: SampleState = SampleState { color: [9, 9, 9, 255], depth: None };

    /// Returns the verdict on `fragments`, each given as triangle and depth. The last one is visible.
    fn story(fragments: &[(u32, f32)], stored: Option<f32>, comparison: DepthComparison) -> String {
        story_in(DepthEncoding::F32, fragments, stored, comparison)
    }

    fn story_in(
        encoding: DepthEncoding,
        fragments: &[(u32, f32)],
        stored: Option<f32>,
        comparison: DepthComparison,
    ) -> String {
        fragment_verdict(&records(encoding, fragments, stored), &[], comparison)
    }

    fn records(encoding: DepthEncoding, fragments: &[(u32, f32)], stored: Option<f32>) -> Vec<FragmentRecord> {
        let scale = DepthScale::perspective(DepthMapping::STANDARD, encoding, 1.0, 2.0);
        let depth = |depth: f32| DepthRecord::new(encoding.quantize(depth.into()), &scale);
        let record = |(place, (id, value)): (usize, &(u32, f32))| FragmentRecord {
            triangle: TriangleId(*id),
            instance: "cube".into(),
            submission: place,
            transparency: Transparency::Opaque,
            outcome: if place + 1 == fragments.len() { FragmentOutcome::Visible } else { FragmentOutcome::Overwritten },
            reason: String::new(),
            corners_px: [[0.0; 2]; 3],
            arithmetic: Arithmetic::Fixed,
            edges: [1.0; 3],
            doubled_area: 3.0,
            affine_weights: [0.0; 3],
            attribute_weights: [0.0; 3],
            inv_w: [1.0; 3],
            corner_depths: [*value; 3],
            depth_bias: None,
            depth: depth(*value),
            stored_depth: stored.map(depth),
            alpha: None,
            shading: None,
            before: PREVIOUS_STATE,
            after: PREVIOUS_STATE,
        };
        fragments.iter().enumerate().map(record).collect()
    }

    #[test]
    fn a_fault_is_explained_with_its_triangles_and_its_cause() {
        let fault = |kind, hit_by: &[u32], due: &[u32], sharing: [u32; 2]| {
            let ids = |list: &[u32]| list.iter().copied().map(TriangleId).collect();
            Fault {
                x: 0,
                y: 0,
                kind,
                hit_by: ids(hit_by),
                due: ids(due),
                sharing: sharing.map(TriangleId),
                junction: None,
            }
        };
        let by_rule = |fill_rule| Settings { fill_rule, ..Settings::default() };
        let double = fault(FaultKind::DoubleHit, &[3, 4], &[3], [4, 3]);
        assert_eq!(
            fault_verdict(&double, &by_rule(FillRule::Inclusive)),
            "Hit twice: triangles 3 and 4 share an edge here and the fill rule is inclusive. To fix it, set fill_rule \
             to top-left."
        );
        let crack = fault(FaultKind::Crack, &[], &[4], [4, 3]);
        assert_eq!(
            fault_verdict(&crack, &by_rule(FillRule::Exclusive)),
            "A crack: no triangle covers this pixel, though triangle 4 should; it shares an edge here with triangle 3 and \
             the fill rule is exclusive. To fix it, set fill_rule to top-left."
        );
        let deep = fault(FaultKind::DoubleHit, &[1, 3, 3], &[1, 3], [3, 3]);
        assert_eq!(
            fault_verdict(&deep, &Settings { arithmetic: Arithmetic::F32, ..Settings::default() }),
            "Hit 3 times instead of 2: two pieces of triangle 3 share an edge here and the arithmetic is f32. To fix \
             it, set arithmetic to fixed."
        );
        let behind = fault(FaultKind::Crack, &[9], &[5, 9], [5, 6]);
        let published = Settings { rasterizer: Rasterizer::ScanlinePublished, ..Settings::default() };
        assert_eq!(
            fault_verdict(&behind, &published),
            "A crack: 1 instead of 2 triangles cover this pixel, triangle 5 is missing; it shares an edge here with \
             triangle 6 and the rasterizer is “Scanline (as published)”. To fix it, choose another rasterizer."
        );
    }

    #[test]
    fn a_fault_at_an_open_seam_names_the_vertex_and_the_edge() {
        use crate::scene::seams::{Junction, JunctionKind, TriangleCorner, TriangleEdge};
        let fault = |kind, junction_kind| Fault {
            x: 0,
            y: 0,
            kind,
            hit_by: Vec::new(),
            due: vec![TriangleId(0)],
            sharing: [0, 7].map(TriangleId),
            junction: Some(Junction {
                kind: junction_kind,
                vertex: TriangleCorner { triangle: TriangleId(7), corner: 1 },
                edge: TriangleEdge { triangle: TriangleId(0), opposite: 2 },
                distance: 4e-7,
            }),
        };
        assert_eq!(
            fault_verdict(&fault(FaultKind::Crack, JunctionKind::TJunction), &Settings::default()),
            "A crack: no triangle covers the gap between triangles 0 and 7 here. T-junction: v1 of triangle 7 lies within \
             the edge of triangle 0 opposite to v2, 4.00e-7 units off it, but is not a vertex of that triangle, so the \
             two sides round differently; to fix it, split the edge there."
        );
        assert_eq!(
            fault_verdict(&fault(FaultKind::DoubleHit, JunctionKind::Unwelded), &Settings::default()),
            "Hit twice: triangles 0 and 7 overlap here. Unwelded vertex: v1 of triangle 7 lies 4.00e-7 units from an \
             end of the edge of triangle 0 opposite to v2, but is not the same vertex, so the two sides do not meet; to \
             fix it, weld the vertices."
        );
    }

    #[test]
    fn a_blended_pixel_names_the_surfaces_behind() {
        let mut records = records(DepthEncoding::F32, &[(3, 0.9), (5, 0.6), (4, 0.5), (6, 0.4)], Some(0.9));
        for record in &mut records[1..] {
            (record.transparency, record.alpha) = (Transparency::Blended, Some(0.25));
        }
        let story = |records: &[FragmentRecord]| fragment_verdict(records, &[], DepthComparison::Less);
        for record in &mut records[..3] {
            record.outcome = FragmentOutcome::BlendedOver;
        }
        assert_eq!(
            story(&records),
            "Blended: triangle 6 of “cube” with alpha 0.25 over 2 more and triangle 3 of “cube”."
        );
        assert_eq!(
            story(&records[2..]),
            "Blended: triangle 6 of “cube” with alpha 0.25 over 1 more and the background."
        );
        assert!(story(&records[3..]).ends_with("over the background."));
    }

    #[test]
    fn fragments_that_fail_the_alpha_test_are_no_rivals() {
        let mut records = records(DepthEncoding::F32, &[(3, 0.5), (4, 0.5)], Some(0.9));
        let story = |records: &[FragmentRecord]| fragment_verdict(records, &[], DepthComparison::Less);
        (records[0].transparency, records[0].outcome) = (Transparency::AlphaTested, FragmentOutcome::AlphaRejected);
        assert_eq!(story(&records), "Won by triangle 4 of “cube”, the only one here that passes the alpha test.");
        assert_eq!(story(&records[..1]), "Background: the only triangle here failed the alpha test.");
        records[1].outcome = FragmentOutcome::DepthRejected;
        assert!(story(&records).ends_with("of the triangles here, 1 failed the depth test and 1 the alpha test."));
        records[1].outcome = FragmentOutcome::AlphaRejected;
        assert_eq!(story(&records), "Background: all 2 triangles here failed the alpha test.");
    }

    #[test]
    fn close_depths_are_a_z_fight_only_if_the_depth_test_decides() {
        let close = [(0, 0.5), (1, 0.5_f32.next_down())];
        assert!(
            story(&close, Some(0.5), DepthComparison::Less).starts_with("Z-fight: triangle 1 of “cube” won by 1 ulp")
        );
        assert!(story(&close, Some(0.5), DepthComparison::Always).contains("drawn last of 2 (every fragment passes)"));
        assert!(story(&close, None, DepthComparison::Always).contains("drawn last of 2 (no depth test)"));
        let equal = [(0, 0.5), (1, 0.5)];
        assert!(story(&equal, Some(0.5), DepthComparison::LessEqual).starts_with("Depth tie"));
        assert!(story(&equal, Some(0.5), DepthComparison::Always).starts_with("Won by"));
    }

    #[test]
    fn unorm_depths_are_compared_in_codes() {
        let story = |a, b| story_in(DepthEncoding::Unorm16, &[(0, a), (1, b)], Some(0.5), DepthComparison::LessEqual);
        let step = 1.0 / 65_535.0;
        assert!(story(0.5, 0.5 - step).contains("won by 1 step of depth"));
        assert!(story(0.5, 0.5 - 2.0 * step).starts_with("Won by"));
        assert!(story(0.4, 0.4 - 1e-7).starts_with("Depth tie"));
    }

    #[test]
    fn pieces_of_one_triangle_are_no_rivals() {
        assert!(story(&[(3, 0.5), (3, 0.5)], Some(0.5), DepthComparison::LessEqual).ends_with("the only one here."));
        let others = [(1, 0.9), (1, 0.9), (3, 0.5), (3, 0.5)];
        assert!(story(&others, Some(0.5), DepthComparison::LessEqual).ends_with("against one other."));
        let more = [(1, 0.9), (2, 0.9), (3, 0.5)];
        assert!(story(&more, Some(0.9), DepthComparison::Less).ends_with("against 2 others."));
    }
}
