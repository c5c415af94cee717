//! Tests of polygon filling against the definition of the winding number, decided in integers.

use super::*;

const SIZE: u32 = 24;

const RULES: [InsideRule; 2] = [InsideRule::EvenOdd, InsideRule::NonZero];

fn filling(rule: InsideRule, corners: Corners, sample: SamplePoint) -> FillParameters {
    FillParameters { rule, corners, sample, width: SIZE, height: SIZE }
}

fn as_given(rule: InsideRule) -> FillParameters {
    filling(rule, Corners::AsGiven, SamplePoint::Center)
}

fn pixels(contours: &[Vec<DVec2>], filling: FillParameters) -> Vec<(u32, u32)> {
    fill(contours, filling).flat_map(|span| (span.x0..span.x1).map(move |x| (x, span.y))).collect()
}

/// Converts the corners of a contour from units of 1/`unit` px to pixels.
fn real(contour: &[(i64, i64)], unit: i64) -> Vec<DVec2> {
    contour.iter().map(|(x, y)| DVec2::new(*x as f64, *y as f64) / unit as f64).collect()
}

/// Returns the pixels inside the contours by the definition of the winding number. Counts, in integers, the crossings
/// of a ray from each sample to the left. `unit` is even.
fn by_definition(contours: &[Vec<(i64, i64)>], unit: i64, rule: InsideRule, sample: SamplePoint) -> Vec<(u32, u32)> {
    let offset = if sample == SamplePoint::Center { unit / 2 } else { 0 };
    let crosses = |(a, b): ((i64, i64), (i64, i64)), (x, y): (i64, i64)| {
        let (top, bottom) = if a.1 < b.1 { (a, b) } else { (b, a) };
        let cross =
            i128::from(bottom.0 - top.0) * i128::from(y - top.1) - i128::from(x - top.0) * i128::from(bottom.1 - top.1);
        (top.1 <= y && y < bottom.1 && cross <= 0).then_some(if a.1 < b.1 { 1_i64 } else { -1 })
    };
    let all = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
    all.filter(|(x, y)| {
        let place = (i64::from(*x) * unit + offset, i64::from(*y) * unit + offset);
        let sides = contours.iter().flat_map(|c| (0..c.len()).map(move |i| (c[i], c[(i + 1) % c.len()])));
        let crossings: Vec<_> = sides.filter_map(|side| crosses(side, place)).collect();
        match rule {
            InsideRule::EvenOdd => crossings.len() % 2 == 1,
            InsideRule::NonZero => crossings.iter().sum::<i64>() != 0,
        }
    })
    .collect()
}

fn random_contours(random: &mut fastrand::Rng, reach: i64, unit: i64) -> Vec<Vec<(i64, i64)>> {
    let contours = random.usize(1..4);
    let mut coordinate = |_: usize| {
        // Some corners lie outside the picture, and about half of the coordinates are multiples of half a pixel.
        let coordinate = random.i64(-reach..reach);
        if random.bool() { coordinate / (unit / 2) * (unit / 2) } else { coordinate }
    };
    (0..contours).map(|c| (0..3 + 4 * c).map(|i| (coordinate(i), coordinate(i) + 7 * unit)).collect()).collect()
}

#[test]
fn pixels_are_those_of_the_winding_number() {
    let mut random = fastrand::Rng::with_seed(61);
    for round in 0..3_000 {
        let unit = [2, 4, 1 << 10, 1 << 20][round % 4];
        let reach = if round % 3 == 0 { 3_000 * unit } else { 30 * unit };
        let contours = random_contours(&mut random, reach, unit);
        let given: Vec<_> = contours.iter().map(|c| real(c, unit)).collect();
        for rule in RULES {
            for sample in [SamplePoint::Center, SamplePoint::Lattice] {
                let found = pixels(&given, filling(rule, Corners::AsGiven, sample));
                assert_eq!(
                    found,
                    by_definition(&contours, unit, rule, sample),
                    "{contours:?} in 1/{unit} px, {rule:?}"
                );
            }
        }
    }
}

#[test]
fn snapped_corners_are_rounded_to_the_grid_with_ties_to_even() {
    let mut random = fastrand::Rng::with_seed(62);
    let nearest = |n: i64| {
        let (below, rest) = (n.div_euclid(8), n.rem_euclid(8));
        below + i64::from(rest > 4 || (rest == 4 && below % 2 != 0))
    };
    for _ in 0..1_000 {
        // Corners are in 1/2048 px, so one in eight coordinates is a tie of the 1/256 px grid.
        let contours = random_contours(&mut random, 30 * 2048, 2048);
        let given: Vec<_> = contours.iter().map(|c| real(c, 2048)).collect();
        let snapped: Vec<Vec<_>> =
            contours.iter().map(|c| c.iter().map(|(x, y)| (nearest(*x), nearest(*y))).collect()).collect();
        let found = pixels(&given, filling(InsideRule::NonZero, Corners::Snapped, SamplePoint::Center));
        assert_eq!(found, by_definition(&snapped, 256, InsideRule::NonZero, SamplePoint::Center), "{contours:?}");
    }
}

#[test]
fn a_row_has_its_spans_in_order_and_apart() {
    let mut random = fastrand::Rng::with_seed(63);
    for _ in 0..500 {
        let contours = random_contours(&mut random, 60, 2);
        let given: Vec<_> = contours.iter().map(|c| real(c, 2)).collect();
        for rule in RULES {
            let spans: Vec<_> = fill(&given, as_given(rule)).collect();
            assert!(spans.iter().all(|span| span.x0 < span.x1 && span.x1 <= SIZE && span.y < SIZE));
            assert!(spans.windows(2).all(|two| (two[0].y, two[0].x1) < (two[1].y, two[1].x0)), "{spans:?}");
        }
    }
}

#[test]
fn a_hole_is_one_under_both_rules_only_if_it_turns_the_other_way() {
    let square = |from: i64, to: i64| vec![(from, from), (to, from), (to, to), (from, to)];
    let area = |inner: Vec<(i64, i64)>, rule: InsideRule| {
        pixels(&[real(&square(0, 20), 1), real(&inner, 1)], as_given(rule)).len()
    };
    let reversed: Vec<_> = square(5, 15).into_iter().rev().collect();
    assert_eq!(RULES.map(|rule| area(square(5, 15), rule)), [300, 400]);
    assert_eq!(RULES.map(|rule| area(reversed.clone(), rule)), [300, 300]);
}

#[test]
fn contours_without_area_and_no_contours_have_no_pixels() {
    for contour in [&[][..], &[(3, 3)], &[(3, 3), (9, 9)], &[(3, 3), (9, 3), (3, 3), (9, 9)]] {
        for rule in RULES {
            assert_eq!(pixels(&[real(contour, 1)], as_given(rule)), [], "{contour:?}");
        }
    }
    assert_eq!(pixels(&[], as_given(InsideRule::EvenOdd)), []);
}

#[test]
fn corners_at_the_limits_of_the_range_are_filled_exactly() {
    let far: f64 = f32::MAX.into();
    let tiny = 2.0_f64.powi(-149);
    let everything = [vec![DVec2::new(-far, -far), DVec2::new(far, -far), DVec2::new(far, far), DVec2::new(-far, far)]];
    let diagonal = [vec![DVec2::splat(-far), DVec2::splat(far), DVec2::new(-far, far)]];
    // The polygon is everything right of a nearly vertical line through (0, 0), tilted by 10⁻⁸³.
    let tilted = [vec![DVec2::new(-tiny, -far), DVec2::new(far, -far), DVec2::new(far, far), DVec2::new(tiny, far)]];
    let count = (SIZE * SIZE) as usize;
    for rule in RULES {
        assert_eq!(pixels(&everything, as_given(rule)).len(), count);
        let below = pixels(&diagonal, as_given(rule));
        assert!(below.iter().all(|(x, y)| x < y), "a sample on a right edge is outside");
        assert_eq!(below.len(), count / 2 - SIZE as usize / 2);
        let right = pixels(&tilted, filling(rule, Corners::AsGiven, SamplePoint::Lattice));
        let left_out = (1..SIZE).map(|y| (0, y));
        assert!(left_out.clone().all(|place| !right.contains(&place)), "column 0 lies left of the line below row 0");
        assert_eq!(right.len(), count - left_out.count());
    }
}

#[test]
fn the_state_lists_the_edges_that_cross_the_row() {
    let mut walk = fill(&[real(&[(4, 2), (8, 10), (0, 10)], 1)], as_given(InsideRule::NonZero));
    assert_eq!(walk.edge_table().map(|(row, _, _)| row).collect::<Vec<_>>(), [2, 2]);
    assert_eq!(walk.nth(2), Some(PixelSpan { y: 5, x0: 2, x1: 6 }));
    assert_eq!(walk.row(), 5);
    let mut crossings: Vec<_> = walk.active_edges().map(|e| (e.crossing_px, e.column, e.winding)).collect();
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(crossings, [(2.25, 2, -1), (5.75, 6, 1)]);
    assert!(walk.active_edges().all(|e| e.top == DVec2::new(4.0, 2.0) && e.bottom.y == 10.0));
}
