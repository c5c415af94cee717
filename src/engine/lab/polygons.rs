//! Lab page on polygons of one or more contours: scanline fill with active edges, triangulation, and the convex hull.

use glam::DVec2;

use super::recording::{
    Ink, Mark, MethodComparison, MethodResult, RecordedStep, Recording, Tone, cell, number, pair, time_of,
};
use crate::flat2d::PixelSpan;
use crate::flat2d::ear_clip::clip_ears;
use crate::flat2d::hull::{HullStep, convex_hull, convex_weights};
use crate::flat2d::polygon::{ActiveEdge, Corners, FillParameters, InsideRule, PolygonFill, SamplePoint, fill};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Operation that the page applies to its polygon.
    pub PolygonMethod {
        EvenOdd = "even-odd", "Fill, even-odd", "A pixel is inside if a ray from it crosses an odd number of edges.";
        NonZero = "non-zero", "Fill, non-zero", "Edges count +1 down and −1 up; a pixel is inside if the sum up to it is not zero.";
        Triangulate = "triangulate", "Ear clipping",
            "Triangulates the first contour: cuts off one ear, a corner whose triangle is empty, after another.";
        Hull = "hull", "Convex hull", "The convex hull of all corners, and the weights t₁ … tₙ of a point inside it.";
    }
}

choice! {
    /// Preset polygon.
    pub PolygonPreset {
        Star = "star", "Star", "Five corners, self-intersecting: the winding number of the middle is 2.";
        Hole = "hole", "Square with a hole", "Two contours with opposite orientation.";
        Overlap = "overlap", "Overlapping squares", "Two contours with the same orientation.";
        Horizontal = "horizontal", "Horizontal edges and tips",
            "Horizontal edges, local highest and lowest corners: the cases where pairing crossings can fail.";
        Concave = "concave", "Concave", "One simple contour with reflex corners.";
        BowTie = "bow-tie", "Bow tie", "Four corners; two of the edges cross.";
    }
}

impl PolygonPreset {
    /// Returns the contours of the preset, in pixels.
    pub fn contours(self) -> Vec<Vec<DVec2>> {
        let contour = |corners: &[(f64, f64)]| corners.iter().copied().map(DVec2::from).collect::<Vec<_>>();
        let square = |low: f64, high: f64| {
            contour(&[(low + 4.0, low), (high + 4.0, low), (high + 4.0, high), (low + 4.0, high)])
        };
        match self {
            Self::Star => vec![contour(&[(16.0, 1.5), (24.5, 22.0), (3.0, 9.0), (29.0, 9.0), (7.5, 22.0)])],
            Self::Hole => vec![square(2.0, 22.0), square(8.0, 16.0).into_iter().rev().collect()],
            Self::Overlap => vec![square(2.0, 15.0), square(9.0, 22.0)],
            Self::Horizontal => vec![contour(&[
                (3.0, 4.5),
                (11.0, 4.5),
                (11.0, 10.5),
                (16.0, 4.5),
                (21.0, 10.5),
                (28.0, 3.0),
                (28.0, 19.5),
                (20.0, 19.5),
                (20.0, 14.5),
                (12.0, 14.5),
                (8.0, 21.0),
                (3.0, 16.0),
            ])],
            Self::Concave => vec![contour(&[
                (4.0, 3.0),
                (16.0, 9.0),
                (28.0, 2.0),
                (22.0, 12.0),
                (29.0, 22.0),
                (15.0, 15.0),
                (5.0, 21.0),
                (10.0, 11.0),
            ])],
            Self::BowTie => vec![contour(&[(5.0, 3.0), (27.0, 21.0), (27.0, 3.0), (5.0, 21.0)])],
        }
    }
}

/// Size of the grid, in columns and rows.
const SIZE: (u32, u32) = (32, 24);

/// Input and settings of the lab page on polygons.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonLesson {
    /// Closed contours of the polygon, in pixels.
    pub contours: Vec<Vec<DVec2>>,
    /// Selected operation.
    pub method: PolygonMethod,
    /// Point that is shown as a convex combination of the hull's corners, in pixels.
    pub(crate) probe: DVec2,
}

impl Default for PolygonLesson {
    fn default() -> Self {
        Self { contours: PolygonPreset::Star.contours(), method: PolygonMethod::EvenOdd, probe: DVec2::new(15.0, 11.0) }
    }
}

impl PolygonLesson {
    fn corners(&self) -> Vec<DVec2> {
        self.contours.concat()
    }

    fn filling(&self, (width, height): (u32, u32)) -> FillParameters {
        let rule = if self.method == PolygonMethod::NonZero { InsideRule::NonZero } else { InsideRule::EvenOdd };
        FillParameters { rule, corners: Corners::AsGiven, sample: SamplePoint::Center, width, height }
    }

    /// Inserts a corner at `at`, in pixels, into the nearest edge. Starts a contour if there are none.
    pub fn add_corner(&mut self, at: DVec2) {
        let distance = |a: DVec2, b: DVec2| {
            let along = b - a;
            let t = ((at - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            (a + along * t).distance(at)
        };
        let sides = self.contours.iter().enumerate().flat_map(|(number, contour)| {
            let ends = move |i: usize| (contour[i], contour[(i + 1) % contour.len()]);
            (0..contour.len()).map(move |i| (number, i, distance(ends(i).0, ends(i).1)))
        });
        match sides.min_by(|a, b| a.2.total_cmp(&b.2)) {
            Some((contour, side, _)) => self.contours[contour].insert(side + 1, at),
            None => self.contours.push(vec![at]),
        }
    }

    /// Removes the corner with the handle index `handle`. Removes its contour, too, if no other corners are left.
    pub fn remove_corner(&mut self, handle: usize) {
        let mut number = handle;
        for contour in &mut self.contours {
            if number < contour.len() {
                contour.remove(number);
                break;
            }
            number -= contour.len();
        }
        self.contours.retain(|contour| !contour.is_empty());
    }

    /// Adds a contour: a small triangle in the middle of the grid.
    pub fn add_contour(&mut self) {
        let middle = DVec2::new(SIZE.0.into(), SIZE.1.into()) / 2.0;
        let corners = [(0.0, -3.0), (3.0, 2.5), (-3.0, 2.5)].map(|corner| middle + DVec2::from(corner));
        self.contours.push(corners.to_vec());
    }

    pub(super) fn record(&self) -> Recording {
        let mut recording = Recording::new(SIZE);
        let outlines = self.contours.iter().filter(|contour| contour.len() > 1);
        recording.figure.extend(outlines.map(|contour| Mark::Outline(contour.clone(), Tone::Ideal)));
        match self.method {
            PolygonMethod::EvenOdd | PolygonMethod::NonZero => self.record_fill(&mut recording),
            PolygonMethod::Triangulate => self.record_triangles(&mut recording),
            PolygonMethod::Hull => self.record_hull(&mut recording),
        }
        recording
    }

    fn record_fill(&self, recording: &mut Recording) {
        let mut walk = fill(&self.contours, self.filling(SIZE));
        for (row, top, bottom) in walk.edge_table() {
            let places = format!(
                "({}, {}) to ({}, {})",
                number(top.x, 1),
                number(top.y, 1),
                number(bottom.x, 1),
                number(bottom.y, 1)
            );
            recording.facts.push((format!("starts in row {row}"), places));
        }
        recording.facts.insert(0, pair("edge table", "edges by their first row"));
        let mut pixels = 0;
        let steps = std::iter::from_fn(|| {
            let span = walk.next()?;
            pixels += span.x1 - span.x0;
            Some(span_step(&walk, span))
        });
        recording.collect(steps);
        recording.facts.insert(0, pair("pixels", pixels.to_string()));
        recording.facts.insert(1, pair("signed area (shoelace)", format!("{} px²", number(self.signed_area(), 2))));
    }

    /// Returns the sum of the contours' signed areas in square pixels, positive for contours that are clockwise on the
    /// screen.
    fn signed_area(&self) -> f64 {
        let side_sum = |contour: &Vec<DVec2>| -> f64 {
            contour.iter().zip(contour.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum()
        };
        self.contours.iter().map(side_sum).sum::<f64>() / 2.0
    }

    fn record_triangles(&self, recording: &mut Recording) {
        let Some(contour) = self.contours.first() else { return };
        let mut walk = clip_ears(contour);
        let mut count = 0;
        let steps = std::iter::from_fn(|| {
            let corners = walk.next()?;
            let triangle = corners.map(|corner| contour[corner]);
            let spans = fill(&[triangle.to_vec()], self.filling(SIZE));
            let pixels = spans.flat_map(|span| (span.x0..span.x1).map(move |x| (i64::from(x), i64::from(span.y))));
            let step = RecordedStep {
                cells: pixels.map(|pixel| cell(pixel, Ink::Group(count))).collect(),
                marks: vec![Mark::Outline(triangle.to_vec(), Tone::Focus)],
                description: format!(
                    "Corner {} is an ear: no corner lies in the triangle {corners:?}. It is cut off.",
                    corners[1]
                ),
                state: vec![pair("remaining corners", format!("{:?}", walk.remaining()))],
            };
            count += 1;
            Some(step)
        });
        recording.collect(steps);
        recording.fact("triangles", count.to_string());
        if walk.remaining().len() > 2 {
            recording.fact("incomplete", "no ear is left: the contour crosses itself");
        }
        label_corners(recording, contour);
    }

    fn record_hull(&self, recording: &mut Recording) {
        let points = self.corners();
        let mut walk = convex_hull(&points);
        let mut chain: Vec<usize> = Vec::new();
        let steps = std::iter::from_fn(|| {
            let step = walk.next()?;
            let says = match step {
                HullStep::Added(point) => {
                    chain.push(point);
                    format!("Point {point} is appended to the chain.")
                }
                HullStep::Dropped(point) => {
                    chain.pop();
                    format!("At point {point} the chain does not turn right: the point is removed.")
                }
            };
            let lines = chain.windows(2).map(|two| Mark::Line(points[two[0]], points[two[1]], Tone::Focus));
            Some(RecordedStep {
                marks: lines.collect(),
                description: says,
                state: vec![pair("chain", format!("{chain:?}"))],
                ..RecordedStep::default()
            })
        });
        recording.collect(steps);
        let hull: Vec<_> = walk.corners().to_vec();
        recording.fact("corners of the hull", format!("{hull:?}"));
        let corners: Vec<_> = hull.iter().map(|corner| points[*corner]).collect();
        recording.figure.push(Mark::Dot(self.probe, Tone::B));
        match convex_weights(&corners, self.probe) {
            Some(weights) => {
                for (corner, t) in hull.iter().zip(weights) {
                    recording.facts.push((format!("t of point {corner}"), number(t, 4)));
                }
            }
            None => recording.fact("orange point", "outside the hull: a weight would be negative"),
        }
        label_corners(recording, &points);
    }

    pub(super) fn walk(&self) -> usize {
        match self.method {
            PolygonMethod::EvenOdd | PolygonMethod::NonZero => fill(&self.contours, self.filling(SIZE)).count(),
            PolygonMethod::Triangulate => self.contours.first().map_or(0, |contour| clip_ears(contour).count()),
            PolygonMethod::Hull => convex_hull(&self.corners()).count(),
        }
    }

    pub(super) fn explanation(&self) -> &'static str {
        match self.method {
            PolygonMethod::EvenOdd => {
                "The edge table lists all edges by the first row that they cross. The active edges of a row are those \
                 that cross it; pixels between an odd and an even crossing are inside. An edge is active from its \
                 upper end to just before its lower end, so a corner between two edges counts once, a tip twice or not \
                 at all, and a horizontal edge never. The numbers on the row count crossings."
            }
            PolygonMethod::NonZero => {
                "Each crossing adds +1 if the edge runs down and −1 if it runs up. The sum is the winding number: how \
                 often the contour goes around the pixel. Pixels with a winding number other than zero are inside, so \
                 overlaps of equal orientation stay filled, and a hole needs the opposite orientation. The row shows \
                 crossings and winding numbers; compare the star with even-odd."
            }
            PolygonMethod::Triangulate => {
                "Another way to fill a concave polygon is to cut it into triangles, which any rasterizer can fill. An \
                 ear is a convex corner whose triangle contains no other corner. Every simple polygon with more than \
                 three corners has at least two ears, so cutting them off one by one gives n − 2 triangles. A contour \
                 that crosses itself may run out of ears."
            }
            PolygonMethod::Hull => {
                "A convex combination t₁P₁ + … + tₙPₙ, with all t ≥ 0 and sum 1, lies in the convex hull; therefore a \
                 point whose barycentric weights are between 0 and 1 lies in its triangle. The algorithm visits the \
                 corners from left to right and back; where the chain does not turn right, its last point is not a \
                 corner of the hull and is removed. Drag the orange point out of the hull to see that no such weights \
                 exist there."
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        let mut handles = self.corners();
        handles.extend((self.method == PolygonMethod::Hull).then_some(self.probe));
        handles
    }

    pub(super) fn move_handle(&mut self, handle: usize, to: DVec2) {
        let place = (to * 2.0).round() / 2.0;
        let corner = self.contours.iter_mut().flatten().nth(handle);
        *corner.unwrap_or(&mut self.probe) = place;
    }

    /// Compares the fill algorithms on the polygon, enlarged 16 times. The reference is a crossing test for every
    /// pixel.
    pub(super) fn compare(&self) -> MethodComparison {
        const LARGER: f64 = 16.0;
        let contours: Vec<Vec<DVec2>> =
            self.contours.iter().map(|contour| contour.iter().map(|corner| *corner * LARGER).collect()).collect();
        let size = (SIZE.0 * LARGER as u32, SIZE.1 * LARGER as u32);
        let truth = by_crossings(&contours, size, self.filling(size).rule);
        let wrong = |found: &[bool]| found.iter().zip(&truth).filter(|(a, b)| a != b).count() as f64;
        let rival = |name, run: &dyn Fn() -> Vec<bool>| MethodResult {
            name,
            error: wrong(&run()),
            time: time_of(|| run().len()),
        };
        let spans = |contours: &[Vec<DVec2>]| {
            let mut inside = vec![false; (size.0 * size.1) as usize];
            for PixelSpan { y, x0, x1 } in fill(contours, self.filling(size)) {
                inside[(y * size.0 + x0) as usize..(y * size.0 + x1) as usize].fill(true);
            }
            inside
        };
        let triangles = || {
            let mut inside = vec![false; (size.0 * size.1) as usize];
            for [a, b, c] in contours.iter().take(1).flat_map(|contour| clip_ears(contour)) {
                let triangle = [a, b, c].map(|corner| contours[0][corner]).to_vec();
                inside.iter_mut().zip(spans(&[triangle])).for_each(|(all, one)| *all |= one);
            }
            inside
        };
        let rivals = vec![
            rival("Active edges", &|| spans(&contours)),
            rival("Ear clipping, first contour", &triangles),
            rival("Crossing test per pixel", &|| by_crossings(&contours, size, self.filling(size).rule)),
        ];
        MethodComparison {
            task: format!("the polygon on {} × {} px", size.0, size.1),
            error: "wrong pixels",
            methods: rivals,
            note: None,
        }
    }
}

/// Returns for each pixel, in row-major order, whether its centre is inside. Counts the crossings of a ray to the left,
/// testing every edge for every pixel.
pub(super) fn by_crossings(contours: &[Vec<DVec2>], (width, height): (u32, u32), rule: InsideRule) -> Vec<bool> {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| DVec2::new(x.into(), y.into()) + 0.5));
    pixels
        .map(|p| {
            let sides = contours.iter().flat_map(|contour| contour.iter().zip(contour.iter().cycle().skip(1)));
            let crossing = sides.filter(|(a, b)| (a.y <= p.y) != (b.y <= p.y)).filter_map(|(a, b)| {
                let (top, bottom, sign) = if a.y <= b.y { (*a, *b, 1) } else { (*b, *a, -1) };
                ((bottom - top).perp_dot(p - top) <= 0.0).then_some(sign)
            });
            match rule {
                InsideRule::EvenOdd => crossing.count() % 2 == 1,
                InsideRule::NonZero => crossing.sum::<i32>() != 0,
            }
        })
        .collect()
}

/// Returns the recorded step for one span of a fill. Its state lists the active edges of the row; its marks show the
/// crossing count and the winding number between the crossings.
fn span_step(walk: &PolygonFill, span: PixelSpan) -> RecordedStep {
    let y = f64::from(span.y) + 0.5;
    let mut active: Vec<ActiveEdge> = walk.active_edges().collect();
    active.sort_by(|a, b| a.crossing_px.total_cmp(&b.crossing_px));
    let mut marks = vec![Mark::Line(DVec2::new(0.0, y), DVec2::new(SIZE.0.into(), y), Tone::Weak)];
    let (mut winding, mut crossings) = (0, 0);
    let mut state = Vec::new();
    for (place, edge) in active.iter().enumerate() {
        winding += edge.winding;
        crossings += 1;
        marks.push(Mark::Dot(DVec2::new(edge.crossing_px, y), Tone::Focus));
        let end = active.get(place + 1).map_or(f64::from(SIZE.0), |next| next.crossing_px);
        if end - edge.crossing_px > 1.0 {
            let middle = DVec2::new(f64::midpoint(edge.crossing_px, end), y - 0.9);
            marks.push(Mark::Text(middle, format!("{crossings} | {}", number(winding.into(), 0)), Tone::Focus));
        }
        let sign = if edge.winding > 0 { "+1" } else { "−1" };
        let name = format!("edge to ({}, {})", number(edge.bottom.x, 1), number(edge.bottom.y, 1));
        state.push((name, format!("x {}  {sign}", number(edge.crossing_px, 3))));
    }
    state.insert(0, pair("active edges", active.len().to_string()));
    RecordedStep {
        cells: (span.x0..span.x1).map(|x| cell((x.into(), span.y.into()), Ink::Full)).collect(),
        marks,
        description: format!(
            "Row {}: {} active edges; pixels {} to {} are inside. Labels above the row: crossings | winding number.",
            span.y,
            active.len(),
            span.x0,
            span.x1 - 1
        ),
        state,
    }
}

fn label_corners(recording: &mut Recording, corners: &[DVec2]) {
    let labels = corners
        .iter()
        .enumerate()
        .map(|(place, corner)| Mark::Text(*corner - DVec2::Y * 0.9, place.to_string(), Tone::Ideal));
    recording.figure.extend(labels);
}
