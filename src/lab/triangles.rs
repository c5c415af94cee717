//! A triangle and its neighbour on a coarse grid: every rasterizer in its own order, edge functions, weights.

use glam::{DVec2, Vec2};

use super::recording::{Comparison, Ink, Mark, Recording, Rival, Step, Tone, cell, number, pair, time_of};
use crate::flat2d::barycentric::{along_sides_then_row, weights_by_area};
use crate::pipeline::raster::{AnyTriangle, Span, cover};
use crate::pipeline::settings::{Arithmetic, Choice, FillRule, Rasterizer, choice};
use crate::pipeline::viewport::Viewport;

choice! {
    /// What is shown of a triangle.
    TriangleView {
        Pixels = "pixels", "Pixels of both", "Who owns which pixel, in the order of the rasterizer; the two triangles share a side.";
        EdgeA = "edge-a", "Edge opposite of A", "The half-plane where the first edge function is positive.";
        EdgeB = "edge-b", "Edge opposite of B", "The half-plane where the second edge function is positive.";
        EdgeC = "edge-c", "Edge opposite of C", "The half-plane where the third edge function is positive.";
        Weights = "weights", "Weights α β γ", "Each weight as one of three colours: the ratios of areas.";
        Rows = "rows", "Along sides, then row", "A value interpolated along two sides and then along the row, beside the one by areas.";
    }
}

/// Columns and rows of the grid.
const SIZE: (u32, u32) = (32, 24);

/// Values at the corners that are interpolated, on a scale from 0 to 1.
const VALUES: [f32; 3] = [0.0, 0.5, 1.0];

/// Two triangles ABC and CBD to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleLesson {
    /// A, B, C, D in px.
    pub corners: [DVec2; 4],
    /// How covered samples are found.
    pub rasterizer: Rasterizer,
    /// In which numbers.
    pub arithmetic: Arithmetic,
    /// Who owns a centre on an edge.
    pub rule: FillRule,
    /// What is shown.
    pub view: TriangleView,
}

impl Default for TriangleLesson {
    fn default() -> Self {
        Self {
            corners: [(4.5, 3.5), (25.5, 7.5), (9.5, 20.5), (28.5, 21.5)].map(DVec2::from),
            rasterizer: Rasterizer::Scanline,
            arithmetic: Arithmetic::Fixed,
            rule: FillRule::TopLeft,
            view: TriangleView::Pixels,
        }
    }
}

/// The arithmetic that tells coverage from truth.
const TRUTH: (Rasterizer, Arithmetic) = (Rasterizer::BoundingBox, Arithmetic::Exact);

impl TriangleLesson {
    fn triangle(&self, which: [usize; 3]) -> [Vec2; 3] {
        which.map(|corner| self.corners[corner].as_vec2())
    }

    fn first(&self) -> [Vec2; 3] {
        self.triangle([0, 1, 2])
    }

    fn second(&self) -> [Vec2; 3] {
        self.triangle([2, 1, 3])
    }

    fn spans(&self, corners: [Vec2; 3]) -> Vec<Span> {
        let viewport = Viewport { width: SIZE.0, height: SIZE.1 };
        cover(self.rasterizer, self.arithmetic, corners.map(Vec2::into), self.rule, viewport)
    }

    fn pixels(&self, corners: [Vec2; 3]) -> impl Iterator<Item = (u32, u32)> + use<> {
        self.spans(corners).into_iter().flat_map(|span| (span.left..span.right).map(move |x| (x, span.row)))
    }

    pub(super) fn record(&self) -> Recording {
        let mut recording = Recording::new(SIZE);
        let outline = |corners: [Vec2; 3]| Mark::Outline(corners.map(Vec2::as_dvec2).to_vec(), Tone::Ideal);
        recording.figure.push(outline(self.first()));
        if self.view == TriangleView::Pixels {
            recording.figure.push(outline(self.second()));
        }
        let names =
            ["A", "B", "C", "D"].iter().zip(self.corners).take(if self.view == TriangleView::Pixels { 4 } else { 3 });
        recording
            .figure
            .extend(names.map(|(name, at)| Mark::Text(at - DVec2::Y * 0.9, (*name).to_owned(), Tone::Ideal)));
        match self.view {
            TriangleView::Pixels => self.record_both(&mut recording),
            TriangleView::EdgeA => self.record_edge(0, &mut recording),
            TriangleView::EdgeB => self.record_edge(1, &mut recording),
            TriangleView::EdgeC => self.record_edge(2, &mut recording),
            TriangleView::Weights => recording.collect(self.pixels(self.first()).map(|pixel| self.weight_step(pixel))),
            TriangleView::Rows => self.record_rows(&mut recording),
        }
        recording
    }

    fn record_both(&self, recording: &mut Recording) {
        let mut order = 0;
        for (group, corners) in [self.first(), self.second()].into_iter().enumerate() {
            let Some(triangle) = AnyTriangle::new(self.arithmetic, corners.map(Vec2::into), self.rule) else {
                continue;
            };
            let name = ["ABC", "CBD"][group];
            let steps = self.pixels(corners).map(|(x, y)| {
                order += 1;
                let edges = triangle.sample((x, y)).edges;
                let on_edge = edges.contains(&0.0);
                let owner = if on_edge { ", exactly on an edge: the fill rule gives it away" } else { "" };
                Step {
                    cells: vec![cell((x.into(), y.into()), Ink::Group(group))],
                    marks: vec![Mark::Dot(DVec2::new(x.into(), y.into()) + 0.5, Tone::Focus)],
                    says: format!("{name}: pixel ({x}, {y}) is number {order} to be drawn{owner}."),
                    state: edge_state(edges, triangle.doubled_area()),
                }
            });
            recording.collect(steps);
        }
        let (first, second): (Vec<_>, Vec<_>) =
            (self.pixels(self.first()).collect(), self.pixels(self.second()).collect());
        recording.fact("pixels of ABC", first.len().to_string());
        recording.fact("pixels of CBD", second.len().to_string());
        recording.fact("drawn twice", first.iter().filter(|pixel| second.contains(pixel)).count().to_string());
        let missed = self.missed(&first, &second);
        recording.fact("missed along the shared side", missed.to_string());
        recording.fact("spans of ABC", self.spans(self.first()).len().to_string());
    }

    /// Pixels whose centre lies on the side that both share, drawn by neither.
    fn missed(&self, first: &[(u32, u32)], second: &[(u32, u32)]) -> usize {
        let inclusive =
            Self { rule: FillRule::Inclusive, rasterizer: TRUTH.0, arithmetic: self.arithmetic, ..self.clone() };
        let other: Vec<_> = inclusive.pixels(self.second()).collect();
        // At its ends, others may own the centre.
        let is_end = |(x, y): (u32, u32)| self.corners[1..3].contains(&(DVec2::new(x.into(), y.into()) + 0.5));
        let shared = inclusive.pixels(self.first()).filter(|pixel| other.contains(pixel) && !is_end(*pixel));
        shared.filter(|pixel| !first.contains(pixel) && !second.contains(pixel)).count()
    }

    /// All pixels by the sign of one edge function, and then those of the triangle.
    fn record_edge(&self, edge: usize, recording: &mut Recording) {
        let corners = self.first();
        let Some(triangle) = AnyTriangle::new(self.arithmetic, corners.map(Vec2::into), self.rule) else { return };
        let places = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        let side = |pixel| triangle.sample(pixel).edges[edge] >= 0.0;
        recording.ground.extend(places.map(|(x, y)| cell((x.into(), y.into()), Ink::Side(side((x, y))))));
        let ends = [corners[(edge + 1) % 3], corners[(edge + 2) % 3]].map(Vec2::as_dvec2);
        recording.figure.push(Mark::Line(ends[0], ends[1], Tone::Focus));
        recording.collect(self.pixels(corners).map(|pixel| {
            let edges = triangle.sample(pixel).edges;
            Step {
                cells: vec![cell((pixel.0.into(), pixel.1.into()), Ink::Full)],
                says: format!(
                    "Pixel ({}, {}): the function of this edge is {}, and so are the others: inside.",
                    pixel.0,
                    pixel.1,
                    if edges[edge] == 0.0 { "zero" } else { "positive" }
                ),
                state: edge_state(edges, triangle.doubled_area()),
                ..Step::default()
            }
        }));
        recording.fact("doubled area", number(triangle.doubled_area(), 2));
    }

    fn weight_step(&self, (x, y): (u32, u32)) -> Step {
        let center = Vec2::new(x as f32, y as f32) + 0.5;
        let weights = weights_by_area(self.first(), center);
        let color = weights.map(|weight| (weight.clamp(0.0, 1.0) * 255.0).round() as u8);
        let to_corner = |corner: Vec2| Mark::Line(center.as_dvec2(), corner.as_dvec2(), Tone::Focus);
        Step {
            cells: vec![cell((x.into(), y.into()), Ink::Color(color))],
            marks: self.first().map(to_corner).to_vec(),
            says: format!("Pixel ({x}, {y}): the three small triangles over the whole are α, β, γ."),
            state: vec![
                pair("α (area opposite of A)", number(weights[0].into(), 6)),
                pair("β (area opposite of B)", number(weights[1].into(), 6)),
                pair("γ (area opposite of C)", number(weights[2].into(), 6)),
                pair("sum", number(weights.iter().copied().map(f64::from).sum(), 8)),
            ],
        }
    }

    fn record_rows(&self, recording: &mut Recording) {
        let corners = self.first();
        let (mut greatest, mut equal, mut count) = (0.0_f64, 0, 0);
        let steps = self.pixels(corners).filter_map(|(x, y)| {
            let center = Vec2::new(x as f32, y as f32) + 0.5;
            let weights = weights_by_area(corners, center);
            let by_area: f32 = weights.iter().zip(VALUES).map(|(weight, value)| weight * value).sum();
            let row = along_sides_then_row(corners, VALUES, center)?;
            let difference = f64::from(row.value) - f64::from(by_area);
            greatest = greatest.max(difference.abs());
            (equal, count) = (equal + usize::from(difference == 0.0), count + 1);
            let level = (row.value.clamp(0.0, 1.0) * 255.0).round() as u8;
            let ends = [row.long.0, row.short.0].map(|x| DVec2::new(x.into(), center.y.into()));
            Some(Step {
                cells: vec![cell((x.into(), y.into()), Ink::Color([level; 3]))],
                marks: vec![
                    Mark::Line(ends[0], ends[1], Tone::Focus),
                    Mark::Dot(ends[0], Tone::A),
                    Mark::Dot(ends[1], Tone::B),
                ],
                says: format!(
                    "Pixel ({x}, {y}): {} on one side, {} on the other, {} between.",
                    number(row.long.1.into(), 4),
                    number(row.short.1.into(), 4),
                    number(row.value.into(), 4)
                ),
                state: vec![
                    pair("along sides, then row", number(row.value.into(), 9)),
                    pair("by areas", number(by_area.into(), 9)),
                    pair("difference", number(difference, 10)),
                ],
            })
        });
        recording.collect(steps);
        recording.fact("greatest difference", format!("{greatest:.3e}").replace('-', "−"));
        recording.fact("equal to the last bit", format!("{equal} of {count} pixels"));
        recording.fact("values at A, B, C", "0, 0.5, 1");
    }

    pub(super) fn walk(&self) -> usize {
        self.spans(self.first()).len() + self.spans(self.second()).len()
    }

    pub(super) fn explanation(&self) -> &'static str {
        match self.view {
            TriangleView::Pixels => {
                "All rasterizers but the published ones find the same pixels; they differ in their order and in what they look at on the way. Step \
                 through to see it: rows, a walk along the longest edge, or squares of 8 × 8. Centres exactly on the shared side belong to one of the two: \
                 choose Inclusive or Exclusive as the fill rule to see them drawn twice, or missed."
            }
            TriangleView::EdgeA | TriangleView::EdgeB | TriangleView::EdgeC => {
                "The implicit form of a line, E(x, y) = a x + b y + c, is positive on one side and negative on the other. A triangle is where \
                 all three are positive: the intersection of three half-planes. Stepping one pixel to the right adds a, one down adds b, so the test costs \
                 an addition per edge and pixel. Divided by the doubled area, E is the weight of the opposite corner."
            }
            TriangleView::Weights => {
                "A point P makes three small triangles with the sides. Their areas over the whole are α, β, γ: they sum to 1, and P = αA + βB + γC. \
                 Any value given at the corners follows in the same way. A weight is 0 on the opposite side and negative behind it, so all three \
                 between 0 and 1 means inside: a convex combination never leaves the triangle."
            }
            TriangleView::Rows => {
                "The scan-line way interpolates along the two sides that a row crosses, and then between them. On a triangle that is the same plane as \
                 by areas, so both agree but for the rounding of floats: the facts say by how much. (For four corners they would not agree: \
                 there the result depends on how the polygon is turned.)"
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        self.corners[..if self.view == TriangleView::Pixels { 4 } else { 3 }].to_vec()
    }

    pub(super) fn move_handle(&mut self, handle: usize, to: DVec2) {
        if let Some(corner) = self.corners.get_mut(handle) {
            *corner = (to * 2.0).round() / 2.0;
        }
    }

    /// All rasterizers on the first triangle, twenty times as large, against exact arithmetic.
    pub(super) fn compare(&self) -> Comparison {
        const LARGER: f32 = 20.0;
        let corners = self.first().map(|corner| (corner * LARGER).to_array());
        let viewport = Viewport { width: SIZE.0 * LARGER as u32, height: SIZE.1 * LARGER as u32 };
        let covered = |rasterizer, arithmetic| {
            let mut inside = vec![false; (viewport.width * viewport.height) as usize];
            for span in cover(rasterizer, arithmetic, corners, self.rule, viewport) {
                let row = (span.row * viewport.width) as usize;
                inside[row + span.left as usize..row + span.right as usize].fill(true);
            }
            inside
        };
        let truth = covered(TRUTH.0, TRUTH.1);
        let rivals = Rasterizer::ALL.iter().map(|rasterizer| {
            let found = covered(*rasterizer, self.arithmetic);
            let error = found.iter().zip(&truth).filter(|(a, b)| a != b).count() as f64;
            let time = time_of(|| cover(*rasterizer, self.arithmetic, corners, self.rule, viewport).len());
            Rival { name: rasterizer.name(), error, time }
        });
        let task = format!("ABC on {} × {} px", viewport.width, viewport.height);
        Comparison { task, error: "wrong pixels", rivals: rivals.collect(), note: None }
    }
}

/// The three edge values, and what they are as weights.
fn edge_state(edges: [f64; 3], doubled_area: f64) -> Vec<(String, String)> {
    let names = ["opposite of the 1st corner", "opposite of the 2nd", "opposite of the 3rd"];
    let decimals = if edges.iter().all(|edge| edge.fract() == 0.0) { 0 } else { 4 };
    let named = names.iter().zip(edges);
    let named = named
        .map(|(name, edge)| pair(name, format!("{}  ({})", number(edge, decimals), number(edge / doubled_area, 3))));
    let sum = pair("sum: the doubled area", number(edges.iter().sum::<f64>(), decimals));
    named.chain([sum]).collect()
}
