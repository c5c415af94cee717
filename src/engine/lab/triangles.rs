//! Lab page on a triangle and its neighbour on a coarse grid: the visiting order of each rasterizer, edge functions,
//! and barycentric weights.

use glam::{DVec2, Vec2};

use super::recording::{
    Ink, Mark, MethodComparison, MethodResult, RecordedStep, Recording, Tone, cell, number, pair, time_of,
};
use crate::flat2d::barycentric::{along_sides_then_row, weights_by_area};
use crate::pipeline::raster::{AnyTriangle, Span, cover};
use crate::pipeline::settings::{Arithmetic, Choice, FillRule, Rasterizer, choice};
use crate::pipeline::viewport::Viewport;

choice! {
    /// Aspect of the triangle that the page shows.
    pub TriangleView {
        Pixels = "pixels", "Pixels of both",
            "Owner of each pixel, in the order of the rasterizer; the two triangles share an edge.";
        EdgeA = "edge-a", "Edge opposite A", "The half-plane where the first edge function is positive.";
        EdgeB = "edge-b", "Edge opposite B", "The half-plane where the second edge function is positive.";
        EdgeC = "edge-c", "Edge opposite C", "The half-plane where the third edge function is positive.";
        Weights = "weights", "Weights α β γ",
            "Barycentric weights as ratios of areas, each in a colour of its own.";
        Rows = "rows", "Along edges, then row",
            "A value interpolated along two edges and then along the row, compared with interpolation by areas.";
    }
}

/// Size of the grid, in columns and rows.
const SIZE: (u32, u32) = (32, 24);

/// Values at the three corners, in [0, 1]. The page interpolates these values over the triangle.
const VALUES: [f32; 3] = [0.0, 0.5, 1.0];

/// Input and settings of the lab page on triangles: triangle ABC and its neighbour CBD.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleLesson {
    /// Corners A, B, C and D, in pixels.
    pub(crate) corners: [DVec2; 4],
    /// Algorithm that finds the covered pixels.
    pub rasterizer: Rasterizer,
    /// Arithmetic of the edge functions.
    pub arithmetic: Arithmetic,
    /// Fill rule for pixel centres on an edge.
    pub rule: FillRule,
    /// Selected view.
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

/// Rasterizer and arithmetic that compute the reference coverage.
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
                let owner = if on_edge { ", exactly on an edge: the fill rule decides" } else { "" };
                RecordedStep {
                    cells: vec![cell((x.into(), y.into()), Ink::Group(group))],
                    marks: vec![Mark::Dot(DVec2::new(x.into(), y.into()) + 0.5, Tone::Focus)],
                    description: format!("{name}: pixel ({x}, {y}) is drawn as number {order}{owner}."),
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
        recording.fact("missed on the shared edge", missed.to_string());
        recording.fact("spans of ABC", self.spans(self.first()).len().to_string());
    }

    /// Counts the pixels whose centre lies on the shared edge and that neither triangle covers.
    fn missed(&self, first: &[(u32, u32)], second: &[(u32, u32)]) -> usize {
        let inclusive =
            Self { rule: FillRule::Inclusive, rasterizer: TRUTH.0, arithmetic: self.arithmetic, ..self.clone() };
        let other: Vec<_> = inclusive.pixels(self.second()).collect();
        // A pixel centre at an endpoint of the shared edge may belong to a third triangle.
        let is_end = |(x, y): (u32, u32)| self.corners[1..3].contains(&(DVec2::new(x.into(), y.into()) + 0.5));
        let shared = inclusive.pixels(self.first()).filter(|pixel| other.contains(pixel) && !is_end(*pixel));
        shared.filter(|pixel| !first.contains(pixel) && !second.contains(pixel)).count()
    }

    /// Colours all pixels by the sign of one edge function, and records a step for each pixel of the triangle.
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
            RecordedStep {
                cells: vec![cell((pixel.0.into(), pixel.1.into()), Ink::Full)],
                description: format!(
                    "Pixel ({}, {}): the value of this edge function is {}. No edge function excludes the pixel, so it is inside.",
                    pixel.0,
                    pixel.1,
                    if edges[edge] == 0.0 { "zero" } else { "positive" }
                ),
                state: edge_state(edges, triangle.doubled_area()),
                ..RecordedStep::default()
            }
        }));
        recording.fact("doubled area", number(triangle.doubled_area(), 2));
    }

    fn weight_step(&self, (x, y): (u32, u32)) -> RecordedStep {
        let center = Vec2::new(x as f32, y as f32) + 0.5;
        let weights = weights_by_area(self.first(), center);
        let color = weights.map(|weight| (weight.clamp(0.0, 1.0) * 255.0).round() as u8);
        let to_corner = |corner: Vec2| Mark::Line(center.as_dvec2(), corner.as_dvec2(), Tone::Focus);
        RecordedStep {
            cells: vec![cell((x.into(), y.into()), Ink::Color(color))],
            marks: self.first().map(to_corner).to_vec(),
            description: format!(
                "Pixel ({x}, {y}): the areas of the three small triangles over the whole area are α, β, γ."
            ),
            state: vec![
                pair("α (area opposite A)", number(weights[0].into(), 6)),
                pair("β (area opposite B)", number(weights[1].into(), 6)),
                pair("γ (area opposite C)", number(weights[2].into(), 6)),
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
            Some(RecordedStep {
                cells: vec![cell((x.into(), y.into()), Ink::Color([level; 3]))],
                marks: vec![
                    Mark::Line(ends[0], ends[1], Tone::Focus),
                    Mark::Dot(ends[0], Tone::A),
                    Mark::Dot(ends[1], Tone::B),
                ],
                description: format!(
                    "Pixel ({x}, {y}): {} on one edge, {} on the other, {} between them.",
                    number(row.long.1.into(), 4),
                    number(row.short.1.into(), 4),
                    number(row.value.into(), 4)
                ),
                state: vec![
                    pair("along edges, then row", number(row.value.into(), 9)),
                    pair("by areas", number(by_area.into(), 9)),
                    pair("difference", number(difference, 10)),
                ],
            })
        });
        recording.collect(steps);
        recording.fact("greatest difference", format!("{greatest:.3e}").replace('-', "−"));
        recording.fact("bit-identical", format!("{equal} of {count} pixels"));
        recording.fact("values at A, B, C", "0, 0.5, 1");
    }

    pub(super) fn walk(&self) -> usize {
        self.spans(self.first()).len() + self.spans(self.second()).len()
    }

    pub(super) fn explanation(&self) -> &'static str {
        match self.view {
            TriangleView::Pixels => {
                "All rasterizers except the published ones find the same pixels; they differ in their order and in the \
                 pixels that they test. Step through to see it: rows, a walk along the longest edge, or blocks of 8 × \
                 8. Centres exactly on the shared edge belong to one of the two triangles: set the fill rule to \
                 Inclusive or Exclusive to see them drawn twice or missed."
            }
            TriangleView::EdgeA | TriangleView::EdgeB | TriangleView::EdgeC => {
                "The implicit form of a line, E(x, y) = a x + b y + c, is positive on one side and negative on the \
                 other. A triangle is the intersection of three half-planes: all three functions are positive inside. \
                 One pixel to the right adds a, one pixel down adds b, so the test costs one addition per edge and \
                 pixel. E divided by the doubled area is the weight of the opposite corner."
            }
            TriangleView::Weights => {
                "A point P forms three small triangles with the edges. Their areas divided by the whole area are α, β, \
                 γ: they sum to 1, and P = αA + βB + γC. Any value given at the corners is interpolated in the same \
                 way. A weight is 0 on the opposite edge and negative beyond it. If all three are between 0 and 1, P \
                 is a convex combination of the corners and lies in the triangle."
            }
            TriangleView::Rows => {
                "Scanline interpolation interpolates along the two edges that a row crosses, and then between them. On \
                 a triangle this gives the same plane as interpolation by areas, so the two differ only by rounding: \
                 the facts show by how much. (For four corners they would differ: there the result depends on the \
                 rotation of the polygon.)"
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

    /// Compares all rasterizers on the first triangle, enlarged 20 times. The reference is coverage in exact
    /// arithmetic.
    pub(super) fn compare(&self) -> MethodComparison {
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
            MethodResult { name: rasterizer.name(), error, time }
        });
        let task = format!("ABC on {} × {} px", viewport.width, viewport.height);
        MethodComparison { task, error: "wrong pixels", methods: rivals.collect(), note: None }
    }
}

/// Returns the values of the three edge functions as text, each with its barycentric weight, and their sum.
fn edge_state(edges: [f64; 3], doubled_area: f64) -> Vec<(String, String)> {
    let names = ["opposite the 1st corner", "opposite the 2nd", "opposite the 3rd"];
    let decimals = if edges.iter().all(|edge| edge.fract() == 0.0) { 0 } else { 4 };
    let named = names.iter().zip(edges);
    let named = named
        .map(|(name, edge)| pair(name, format!("{}  ({})", number(edge, decimals), number(edge / doubled_area, 3))));
    let sum = pair("sum = doubled area", number(edges.iter().sum::<f64>(), decimals));
    named.chain([sum]).collect()
}
