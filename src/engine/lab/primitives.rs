//! Lab page on primitive topologies, applied to one list of vertices.

use glam::{DVec2, DVec3};

use super::polygons::by_crossings;
use super::recording::{
    Ink, InkedPixel, Mark, MethodComparison, MethodResult, RecordedStep, Recording, Tone, cell, number, pair, time_of,
};
use crate::flat2d::ear_clip::clip_ears;
use crate::flat2d::polygon::{Corners, FillParameters, InsideRule, SamplePoint, fill};
use crate::flat2d::primitives::{OutlineProperties, Piece, Primitive, check_outline, pieces};
use crate::flat2d::real_line::real_line;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Primitive topology: the rule by which vertices are assembled into points, lines, triangles or polygons.
    pub PrimitiveKind {
        Points = "points", "Points", "Each vertex is a point.";
        Lines = "lines", "Lines", "Each pair of vertices is a line.";
        LineStrip = "line-strip", "Line strip", "A line from each vertex to the next.";
        LineLoop = "line-loop", "Line loop", "A line strip with a line from the last vertex to the first.";
        Triangles = "triangles", "Triangles", "Each three vertices are a triangle.";
        TriangleStrip = "triangle-strip", "Triangle strip",
            "Each vertex forms a triangle with the previous two; every second triangle is reversed to keep its \
            orientation.";
        TriangleFan = "triangle-fan", "Triangle fan",
            "Each vertex forms a triangle with the previous and the first vertex.";
        Quads = "quads", "Quads", "Each four vertices are a quad of two triangles.";
        QuadStrip = "quad-strip", "Quad strip", "Each pair of vertices forms a quad with the previous pair.";
        Polygon = "polygon", "Polygon",
            "All vertices are one polygon, drawn as a fan: correct if the polygon is simple, convex and planar.";
    }
}

impl PrimitiveKind {
    fn primitive(self) -> Primitive {
        match self {
            Self::Points => Primitive::Points,
            Self::Lines => Primitive::Lines,
            Self::LineStrip => Primitive::LineStrip,
            Self::LineLoop => Primitive::LineLoop,
            Self::Triangles => Primitive::Triangles,
            Self::TriangleStrip => Primitive::TriangleStrip,
            Self::TriangleFan => Primitive::TriangleFan,
            Self::Quads => Primitive::Quads,
            Self::QuadStrip => Primitive::QuadStrip,
            Self::Polygon => Primitive::Polygon,
        }
    }
}

choice! {
    /// Preset list of vertices.
    pub VertexPreset {
        Zigzag = "zigzag", "Zigzag", "Vertex order of strips.";
        Ring = "ring", "Ring", "Vertex order of fans, loops and polygons.";
        Concave = "concave", "Concave", "A ring with a reflex corner: a fan covers pixels outside it.";
        Crossing = "crossing", "Self-crossing", "Two edges cross: the triangles of a fan overlap.";
        Bent = "bent", "Not planar",
            "One vertex lies off the plane of the others (z = 6): the surface depends on the choice of triangles.";
    }
}

impl VertexPreset {
    /// Returns the vertices of the preset: x and y in pixels, z without a unit.
    pub fn vertices(self) -> Vec<DVec3> {
        let ring = |radii: [f64; 8]| {
            let at = |i: usize| {
                DVec2::from_angle(i as f64 / 8.0 * std::f64::consts::TAU) * radii[i] + DVec2::new(16.0, 12.0)
            };
            (0..8).map(|i| at(i).extend(0.0)).collect::<Vec<_>>()
        };
        match self {
            Self::Zigzag => {
                (0..8).map(|i| DVec3::new(3.5 + f64::from(i / 2) * 8.0, 19.0 - f64::from(i % 2) * 14.0, 0.0)).collect()
            }
            Self::Ring => ring([10.0; 8]),
            Self::Concave => ring([10.0, 3.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0]),
            Self::Crossing => {
                let mut vertices = ring([10.0; 8]);
                vertices.swap(2, 5);
                vertices
            }
            Self::Bent => {
                let mut vertices = ring([10.0; 8]);
                vertices[3].z = 6.0;
                vertices
            }
        }
    }
}

/// Size of the grid, in columns and rows.
const SIZE: (u32, u32) = (32, 24);

/// Input and settings of the lab page on primitives.
#[derive(Clone, Debug, PartialEq)]
pub struct PrimitiveLesson {
    /// Vertices: x and y in pixels, z without a unit.
    pub vertices: Vec<DVec3>,
    /// Selected topology.
    pub kind: PrimitiveKind,
}

impl Default for PrimitiveLesson {
    fn default() -> Self {
        Self { vertices: VertexPreset::Zigzag.vertices(), kind: PrimitiveKind::TriangleStrip }
    }
}

impl PrimitiveLesson {
    fn place(&self, vertex: usize) -> DVec2 {
        self.vertices[vertex].truncate()
    }

    /// Returns the intended outlines of quads and polygons, as vertex indices. The pipeline draws each outline as a
    /// triangle fan.
    fn outlines(&self) -> Vec<Vec<usize>> {
        let count = self.vertices.len();
        match self.kind {
            PrimitiveKind::Quads => (0..count / 4).map(|i| (4 * i..4 * i + 4).collect()).collect(),
            PrimitiveKind::QuadStrip => {
                (0..(count / 2).saturating_sub(1)).map(|i| vec![2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2]).collect()
            }
            PrimitiveKind::Polygon => vec![(0..count).collect()],
            _ => Vec::new(),
        }
    }

    pub(super) fn record(&self) -> Recording {
        let mut recording = Recording::new(SIZE);
        for (number, vertex) in self.vertices.iter().enumerate() {
            recording.figure.push(Mark::Text(vertex.truncate() - DVec2::Y * 0.9, number.to_string(), Tone::Ideal));
        }
        for outline in self.outlines() {
            recording
                .figure
                .push(Mark::Outline(outline.iter().map(|vertex| self.place(*vertex)).collect(), Tone::Ideal));
        }
        let pieces = pieces(self.kind.primitive(), self.vertices.len());
        recording.collect(pieces.iter().enumerate().map(|(number, piece)| self.step(number, *piece)));
        let count = |is: fn(&Piece) -> bool| pieces.iter().filter(|piece| is(piece)).count().to_string();
        recording.fact("vertices", self.vertices.len().to_string());
        recording.fact("lines", count(|piece| matches!(piece, Piece::Line(_))));
        recording.fact("triangles", count(|piece| matches!(piece, Piece::Triangle(_))));
        for (number, outline) in self.outlines().iter().enumerate() {
            let corners: Vec<_> = outline.iter().map(|vertex| self.vertices[*vertex]).collect();
            recording.facts.push((format!("outline {}", number + 1), in_words(check_outline(&corners))));
        }
        recording
    }

    fn step(&self, number: usize, piece: Piece) -> RecordedStep {
        let ink = Ink::Group(number);
        match piece {
            Piece::Point(vertex) => {
                let place = self.place(vertex).floor();
                RecordedStep {
                    cells: vec![cell((place.x as i64, place.y as i64), ink)],
                    description: format!("Vertex {vertex} is a point."),
                    state: vec![pair("vertex", vertex.to_string())],
                    ..RecordedStep::default()
                }
            }
            Piece::Line([a, b]) => RecordedStep {
                cells: line_cells(self.place(a), self.place(b), ink),
                marks: vec![Mark::Line(self.place(a), self.place(b), Tone::Focus)],
                description: format!("Line {}: from vertex {a} to vertex {b}.", number + 1),
                state: vec![pair("vertices", format!("{a}, {b}"))],
            },
            Piece::Triangle(corners) => self.triangle_step(number, corners),
        }
    }

    fn triangle_step(&self, piece: usize, corners: [usize; 3]) -> RecordedStep {
        let places = corners.map(|corner| self.place(corner));
        let area = (places[1] - places[0]).perp_dot(places[2] - places[0]) / 2.0;
        let turn = match area {
            area if area > 0.0 => "clockwise ↻",
            area if area < 0.0 => "counter-clockwise ↺",
            _ => "no area",
        };
        let middle = (places[0] + places[1] + places[2]) / 3.0;
        let (width, height) = SIZE;
        let filling = FillParameters {
            rule: InsideRule::EvenOdd,
            corners: Corners::AsGiven,
            sample: SamplePoint::Center,
            width,
            height,
        };
        let spans = fill(&[places.to_vec()], filling);
        let pixels = spans.flat_map(|span| (span.x0..span.x1).map(move |x| (i64::from(x), i64::from(span.y))));
        RecordedStep {
            cells: pixels.map(|pixel| cell(pixel, Ink::Group(piece))).collect(),
            marks: vec![
                Mark::Outline(places.to_vec(), Tone::Focus),
                Mark::Text(middle, (piece + 1).to_string(), Tone::Focus),
            ],
            description: format!(
                "Triangle {}: vertices {}, {}, {}, {turn} on the screen.",
                piece + 1,
                corners[0],
                corners[1],
                corners[2]
            ),
            state: vec![
                pair("vertices", format!("{}, {}, {}", corners[0], corners[1], corners[2])),
                pair("orientation", turn),
                pair("signed area", format!("{} px²", number(area, 2))),
            ],
        }
    }

    pub(super) fn walk(&self) -> usize {
        pieces(self.kind.primitive(), self.vertices.len()).len()
    }

    /// Whether the topology consists of quads or polygons, whose outlines a triangle fan may not match.
    pub(super) fn has_outlines(&self) -> bool {
        !self.outlines().is_empty()
    }

    /// Compares fans and ear clipping on the outlines, enlarged 16 times. The reference is a crossing test for every
    /// pixel.
    pub(super) fn compare(&self) -> MethodComparison {
        const LARGER: f64 = 16.0;
        let size = (SIZE.0 * LARGER as u32, SIZE.1 * LARGER as u32);
        let place = |vertex: &usize| self.place(*vertex) * LARGER;
        let outlines: Vec<Vec<DVec2>> =
            self.outlines().iter().map(|outline| outline.iter().map(place).collect()).collect();
        // Outlines are drawn on top of each other, so a pixel inside two of them counts as inside.
        let union = |covers: Vec<Vec<bool>>| {
            covers.into_iter().reduce(|a, b| a.iter().zip(&b).map(|(a, b)| *a || *b).collect()).unwrap_or_default()
        };
        let one_by_one = |outlines: &[Vec<DVec2>]| {
            let covers = outlines.iter().map(|o| by_crossings(std::slice::from_ref(o), size, InsideRule::EvenOdd));
            union(covers.collect())
        };
        let truth = one_by_one(&outlines);
        let rival = |name, triangles: &dyn Fn() -> Vec<Vec<DVec2>>| {
            let wrong = one_by_one(&triangles()).iter().zip(&truth).filter(|(a, b)| a != b).count();
            MethodResult { name, error: wrong as f64, time: time_of(|| triangles().len()) }
        };
        let fans = || {
            let fan = |o: &Vec<DVec2>| -> Vec<_> { (2..o.len()).map(|i| vec![o[0], o[i - 1], o[i]]).collect() };
            outlines.iter().flat_map(fan).collect()
        };
        let ears = || {
            let ears = |o: &Vec<DVec2>| -> Vec<_> { clip_ears(o).map(|ear| ear.map(|i| o[i]).to_vec()).collect() };
            outlines.iter().flat_map(ears).collect()
        };
        MethodComparison {
            task: format!("triangulating the outlines, on {} × {} px", size.0, size.1),
            error: "wrong pixels",
            methods: vec![rival("Fan from the first vertex", &fans), rival("Ear clipping", &ears)],
            note: None,
        }
    }

    pub(super) fn explanation(&self) -> &'static str {
        match self.kind {
            PrimitiveKind::Points | PrimitiveKind::Lines | PrimitiveKind::LineStrip | PrimitiveKind::LineLoop => {
                "All primitives are assembled from one list of vertices. Strips and loops share vertices between \
                 neighbours, so n vertices give n − 1 or n lines instead of n / 2, and each vertex is transformed once."
            }
            PrimitiveKind::Triangles | PrimitiveKind::TriangleStrip | PrimitiveKind::TriangleFan => {
                "Triangles are always planar and convex, so renderers reduce all surfaces to triangles. A strip of n \
                 triangles needs n + 2 vertices instead of 3n. The vertex order of every second triangle is reversed, \
                 so that all triangles of the strip have the same orientation. The number in each triangle is its \
                 position in the order; the state shows its orientation."
            }
            PrimitiveKind::Quads | PrimitiveKind::QuadStrip | PrimitiveKind::Polygon => {
                "Outlines of more than three corners are drawn as a fan of triangles. The fan covers the outline \
                 exactly if it is simple (no two edges cross), convex (no reflex corner) and planar (all corners in \
                 one plane). Try the presets: at a reflex corner the fan covers pixels outside, where edges cross it \
                 overlaps itself, and off the plane another choice of triangles gives another surface."
            }
        }
    }

    pub(super) fn handles(&self) -> Vec<DVec2> {
        self.vertices.iter().map(|vertex| vertex.truncate()).collect()
    }

    pub(super) fn move_handle(&mut self, handle: usize, to: DVec2) {
        let place = (to * 2.0).round() / 2.0;
        if let Some(vertex) = self.vertices.get_mut(handle) {
            (vertex.x, vertex.y) = (place.x, place.y);
        }
    }
}

/// Returns the pixels nearest to a line between two positions, which are given in pixels.
fn line_cells(from: DVec2, to: DVec2, ink: Ink) -> Vec<InkedPixel> {
    real_line(from - 0.5, to - 0.5).into_iter().flatten().map(|pixel| cell(pixel, ink)).collect()
}

/// Describes in words the properties of an outline, and whether a triangle fan covers it exactly.
fn in_words(OutlineProperties { simple, convex, flat }: OutlineProperties) -> String {
    let mut words = Vec::new();
    words.push(if simple { "simple" } else { "self-crossing" });
    if simple {
        words.push(if convex { "convex" } else { "concave" });
    }
    words.push(if flat { "planar" } else { "not planar" });
    let right = simple && convex && flat;
    format!("{}: {}", words.join(", "), if right { "a fan covers it" } else { "a fan does not match it" })
}
