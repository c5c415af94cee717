//! Cracks and double hits: samples along shared edges that a frame's rasterizer assigns to no triangle, or to two.
//!
//! Hits are counted twice at each sample, both times without a depth test: as the recipe draws, and for a reference.
//! The reference is correct by construction, because it uses the bounding-box rasterizer in exact arithmetic. Its
//! corners are those that the recipe's arithmetic uses (snapped in fixed point). Its fill rule is the recipe's, or
//! top-left if the recipe's rule is deliberately wrong.
//!
//! Triangles are looked up only at samples whose two hit counts differ. A difference is a fault of a *shared edge* if
//! two triangles of one instance share an edge there and lie on opposite sides of it. Other differences, such as at an
//! outline under the inclusive rule, are counted separately. Culled triangles are not counted at all. Faults of
//! overlapping surfaces are not detected at samples where they cancel each other out.
//!
//! Adjacent surfaces that share no vertices along their borders may have gaps even if every triangle is drawn
//! correctly. [`Hits::with_seams`] adds the faults along such borders once the [`Seams`] of the scene are known.

mod edges;

mod seams;

use serde::Serialize;

use self::edges::{EdgeTriangles, edges_near, edges_of};
pub(super) use self::seams::{border_in_picture, junction_pixels};
use crate::chain::{Frame, Recipe};
use crate::image::Image;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::raster::{CoverageRules, SampleArea, Scissor, Span};
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Arithmetic, FillRule, Rasterizer, Settings};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::Viewport;
use crate::scene::seams::{Junction, JunctionKind, SeamCounts, Seams};
use crate::scene::{Scene, TriangleId};

/// Kind of a rasterization fault at a sample along a shared edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// Crack: fewer triangles hit the sample than in the reference.
    Crack,
    /// Double hit: more triangles hit the sample than in the reference.
    DoubleHit,
}

/// A sample along a shared edge that too few or too many triangles hit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// Column of the sample in the full picture.
    pub x: u32,
    /// Row of the sample in the full picture.
    pub y: u32,
    /// Kind of the fault: too few hits (crack) or too many (double hit).
    pub kind: FaultKind,
    /// Triangles that hit the sample, in drawing order. A clipped triangle appears once for each piece that hits.
    pub hit_by: Vec<TriangleId>,
    /// Triangles that hit the sample in the reference.
    pub due: Vec<TriangleId>,
    /// Two triangles that share the edge at the sample. The first is the missing triangle of a crack, or the
    /// superfluous triangle of a double hit.
    pub sharing: [TriangleId; 2],
    /// T-junction or unwelded vertex that opens the edge; `None` if the two triangles share both endpoints of the edge.
    pub junction: Option<Junction>,
}

/// Hit counts of a frame, and its cracks and double hits.
#[derive(Clone, Debug, PartialEq)]
pub struct Hits {
    /// Number of triangles that cover each sample, in the packed layout of the frame's framebuffer.
    pub counts: Image<u32>,
    /// Cracks and double hits along shared edges, in reading order.
    pub faults: Vec<Fault>,
    /// Number of samples with a wrong hit count that do not lie along a shared edge.
    pub elsewhere: usize,
    /// Numbers of T-junctions and unwelded vertices of the scene; `None` until [`Hits::with_seams`] adds their faults.
    pub mesh: Option<SeamCounts>,
}

impl Hits {
    /// Counts the hits of a frame drawn with `settings` and finds the faults along its shared edges.
    pub(crate) fn of(frame: &Frame, settings: &Settings) -> Self {
        let Viewport { width, height } = frame.raster;
        FaultSearch::of(frame, settings, Scissor::full(width, height)).run()
    }

    /// Counts the hits of screen triangles on a grid of samples and finds the faults along their shared edges.
    #[cfg(test)]
    pub(crate) fn of_triangles(
        triangles: &[ScreenTriangle],
        settings: &Settings,
        grid: SampleGrid,
        Viewport { width, height }: Viewport,
    ) -> Self {
        FaultSearch::new(triangles, settings, grid, Scissor::full(width, height)).run()
    }

    /// Adds the cracks and double hits along the scene's open seams that lie in the picture.
    pub(crate) fn with_seams(mut self, scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams) -> Self {
        let Viewport { width, height } = frame.raster;
        let place = |fault: &Fault| (fault.y, fault.x);
        let mut added = seams::faults(scene, recipe, frame, seams, Scissor::full(width, height));
        added.retain(|fault| self.faults.binary_search_by_key(&place(fault), place).is_err());
        self.faults.append(&mut added);
        self.faults.sort_by_key(place);
        self.mesh = Some(seams.counts());
        self
    }

    /// Returns the number of faults at one kind of junction: T-junctions or unwelded vertices.
    pub(crate) fn count_at(&self, kind: JunctionKind) -> usize {
        self.faults.iter().filter(|fault| fault.junction.is_some_and(|junction| junction.kind == kind)).count()
    }

    /// Returns the number of faults of one kind: cracks or double hits.
    pub fn count(&self, kind: FaultKind) -> usize {
        self.faults.iter().filter(|fault| fault.kind == kind).count()
    }

    /// Returns a summary such as “2 cracks · 0 double hits”. It includes the numbers of faults at T-junctions, faults
    /// at unwelded vertices, and wrong pixels elsewhere, unless they are 0.
    pub fn summary(&self) -> String {
        let number = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
        let cracks = number(self.count(FaultKind::Crack), "crack", "cracks");
        let doubles = number(self.count(FaultKind::DoubleHit), "double hit", "double hits");
        let elsewhere = match self.elsewhere {
            0 => String::new(),
            count => format!(" · {} elsewhere", number(count, "wrong pixel", "wrong pixels")),
        };
        let [junctions, unwelded] =
            [(JunctionKind::TJunction, "at T-junctions"), (JunctionKind::Unwelded, "at unwelded vertices")].map(
                |(kind, place)| match self.count_at(kind) {
                    0 => String::new(),
                    count => format!(" · {count} of them {place}"),
                },
            );
        format!("{cracks} · {doubles}{junctions}{unwelded}{elsewhere}")
    }

    /// Returns the first fault after the pixel `from`, or the last fault before it if not `forwards`. Wraps around at
    /// both ends of the list.
    pub fn neighbour(&self, from: Option<(u32, u32)>, forwards: bool) -> Option<&Fault> {
        let place = |fault: &Fault| (fault.y, fault.x);
        let Some((x, y)) = from else {
            return if forwards { self.faults.first() } else { self.faults.last() };
        };
        if forwards {
            let after = self.faults.partition_point(|fault| place(fault) <= (y, x));
            self.faults.get(after).or(self.faults.first())
        } else {
            let before = self.faults.partition_point(|fault| place(fault) < (y, x));
            self.faults[..before].last().or(self.faults.last())
        }
    }
}

/// Returns the crack or double hit at a pixel of the drawn picture, if any.
pub(crate) fn fault_at(frame: &Frame, settings: &Settings, x: u32, y: u32) -> Option<Fault> {
    let Viewport { width, height } = frame.raster;
    let around_px = if settings.rasterizer.is_published() { REACH_SAMPLES * WIDEST_STEP_PX } else { 0 };
    let end = |at: u32, limit: u32| at.saturating_add(around_px).saturating_add(1).min(limit);
    let (left, top) = (x.saturating_sub(around_px), y.saturating_sub(around_px));
    let scissor = Scissor { left, top, right: end(x, width), bottom: end(y, height) };
    let hits = FaultSearch::of(frame, settings, scissor).run();
    hits.faults.into_iter().find(|fault| (fault.x, fault.y) == (x, y))
}

/// Returns the crack or double hit along an open seam of the scene at a pixel of the drawn picture, if any.
pub(super) fn seam_fault_at(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    seams: &Seams,
    (x, y): (u32, u32),
) -> Option<Fault> {
    seams::faults(scene, recipe, frame, seams, Scissor::pixel(x, y)).into_iter().next()
}

/// Maximum distance, in samples, by which a naive rasterizer (implemented as published) moves the outline of a surface.
const REACH_SAMPLES: u32 = 2;

/// Maximum distance in pixels between neighbouring samples of any grid.
const WIDEST_STEP_PX: u32 = 4;

/// A search for faults within a scissor rectangle.
struct FaultSearch<'a> {
    triangles: &'a [ScreenTriangle],
    /// Copy of `triangles` with precomputed bounding boxes; `None` if they were not precomputed.
    list: Option<&'a TriangleList>,
    settings: &'a Settings,
    grid: SampleGrid,
    scissor: Scissor,
    /// Column and row of the first sample within the scissor, in the packed framebuffer.
    origin: (u32, u32),
    /// Number of columns and rows within the scissor, in the packed framebuffer.
    size: (u32, u32),
}

/// Settings with which hits are counted: the recipe's or the reference's.
#[derive(Clone, Copy)]
enum CountMode {
    Drawn,
    Reference,
}

/// A sample at which the hit counts of the drawn frame and of the reference differ. `drawn` and `due` contain the
/// indices of the triangles that hit the sample, in ascending order.
struct CountDifference {
    pixel: (u32, u32),
    drawn: Vec<usize>,
    due: Vec<usize>,
}

impl CountDifference {
    /// Returns the indices of the triangles that hit the sample in the drawn frame, but not in the reference.
    fn extra(&self) -> impl Iterator<Item = usize> {
        self.drawn.iter().copied().filter(|index| self.due.binary_search(index).is_err())
    }

    /// Returns the indices of the triangles that hit the sample in the reference, but not in the drawn frame.
    fn missing(&self) -> impl Iterator<Item = usize> {
        self.due.iter().copied().filter(|index| self.drawn.binary_search(index).is_err())
    }

    fn kind(&self) -> FaultKind {
        if self.drawn.len() < self.due.len() { FaultKind::Crack } else { FaultKind::DoubleHit }
    }
}

impl<'a> FaultSearch<'a> {
    fn new(triangles: &'a [ScreenTriangle], settings: &'a Settings, grid: SampleGrid, scissor: Scissor) -> Self {
        let rows = grid.rows(scissor.top, scissor.bottom);
        let columns = rows.clone().map(|row| grid.columns(row, scissor.left, scissor.right)).filter(|c| !c.is_empty());
        let columns = columns.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or_default();
        let (origin, size) = ((columns.start, rows.start), (columns.len() as u32, rows.len() as u32));
        Self { triangles, list: None, settings, grid, scissor, origin, size }
    }

    fn of(frame: &'a Frame, settings: &'a Settings, scissor: Scissor) -> Self {
        let list = &frame.geometry().triangles;
        Self { list: Some(list), ..Self::new(list, settings, frame.drawn.grid, scissor) }
    }

    /// Whether the triangle at index `place` may cover samples within the scissor.
    fn may_have_samples(&self, place: usize) -> bool {
        match self.list {
            Some(list) => self.scissor.may_overlap_box(list.box_of(place)),
            None => self.scissor.may_overlap(self.triangles[place].corners_px()),
        }
    }

    fn run(&self) -> Hits {
        let (counts, due) = (self.count(CountMode::Drawn), self.count(CountMode::Reference));
        let differences = self.differences(&counts, &due);
        let missing = self.edges_of_missing(&differences);
        let faults: Vec<Fault> = differences
            .iter()
            .filter_map(|difference| {
                let sharing = match difference.kind() {
                    FaultKind::Crack => self.crack(difference, &missing, &due)?,
                    FaultKind::DoubleHit => self.double_hit(difference)?,
                };
                Some(self.fault(difference, sharing))
            })
            .collect();
        Hits { counts, elsewhere: differences.len() - faults.len(), faults, mesh: None }
    }

    fn count(&self, way: CountMode) -> Image<u32> {
        let mut counts = Image::filled(self.size.0, self.size.1, 0);
        self.each_hit(way, |_, (column, row)| counts.set(column, row, counts.at(column, row) + 1));
        counts
    }

    /// Calls `sink` for every hit, with the index of the triangle, and the column and row of the sample relative to
    /// `origin`.
    fn each_hit(&self, way: CountMode, mut sink: impl FnMut(usize, (u32, u32))) {
        let drawn = self.settings.coverage_rules();
        let sound_rule = if drawn.fill_rule.draws_shared_edges_once() { drawn.fill_rule } else { FillRule::TopLeft };
        let rules = match way {
            CountMode::Drawn => drawn,
            CountMode::Reference => CoverageRules {
                rasterizer: Rasterizer::BoundingBox,
                arithmetic: Arithmetic::Exact,
                fill_rule: sound_rule,
            },
        };
        let mut spans: Vec<Span> = Vec::new();
        for (index, triangle) in self.triangles.iter().enumerate() {
            if !self.may_have_samples(index) {
                continue;
            }
            let corners_px = match way {
                CountMode::Drawn => triangle.corners_px(),
                CountMode::Reference => self.corners_px(index),
            };
            spans.clear();
            rules.cover_within(corners_px, SampleArea { grid: self.grid, scissor: self.scissor }, &mut spans);
            for span in &spans {
                let row = span.row - self.origin.1;
                (span.left..span.right).for_each(|column| sink(index, (column - self.origin.0, row)));
            }
        }
    }

    /// Returns the corners that determine a triangle's coverage, in px: snapped to the subpixel grid in fixed point,
    /// otherwise unsnapped.
    fn corners_px(&self, index: usize) -> [[f32; 2]; 3] {
        match self.settings.arithmetic {
            Arithmetic::Fixed => self.triangles[index].snapped_px(),
            Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => self.triangles[index].corners_px(),
        }
    }

    /// Returns the samples whose hit counts in `drawn` and `due` differ, in reading order. If there are any, rasterizes
    /// the triangles again to record which of them hit these samples.
    fn differences(&self, drawn: &Image<u32>, due: &Image<u32>) -> Vec<CountDifference> {
        const NONE: u32 = u32::MAX;
        let (width, height) = self.size;
        let mut numbers = Image::filled(width, height, NONE);
        let mut differences = Vec::new();
        for (column, row) in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))) {
            if drawn.at(column, row) != due.at(column, row) {
                numbers.set(column, row, differences.len() as u32);
                let pixel = self.grid.pixel(column + self.origin.0, row + self.origin.1);
                differences.push(CountDifference { pixel, drawn: Vec::new(), due: Vec::new() });
            }
        }
        if differences.is_empty() {
            return differences;
        }
        for way in [CountMode::Drawn, CountMode::Reference] {
            self.each_hit(way, |index, (column, row)| {
                let Some(difference) = differences.get_mut(numbers.at(column, row) as usize) else { return };
                match way {
                    CountMode::Drawn => difference.drawn.push(index),
                    CountMode::Reference => difference.due.push(index),
                }
            });
        }
        differences
    }

    /// Examines the samples with too few hits. For each triangle that is missing at a sample, finds its edges nearest
    /// to the sample. Returns the triangles on both sides of these edges.
    fn edges_of_missing(&self, differences: &[CountDifference]) -> EdgeTriangles {
        let mut meetings = EdgeTriangles::default();
        for difference in differences.iter().filter(|d| d.kind() == FaultKind::Crack) {
            for index in difference.missing() {
                for edge in edges_near(self.triangles[index].instance, self.corners_px(index), difference.pixel) {
                    meetings.expect(edge);
                }
            }
        }
        if !meetings.is_empty() {
            for (index, triangle) in self.triangles.iter().enumerate() {
                for edge in edges_of(triangle.instance, self.corners_px(index)) {
                    meetings.add_expected(edge, index);
                }
            }
        }
        meetings
    }

    /// Returns a triangle that should have hit the sample but did not, and its neighbour across an edge near the
    /// sample. Returns `None` if there is no such neighbour, or if the rasterizer may have moved an outline past the
    /// sample.
    fn crack(&self, difference: &CountDifference, meetings: &EdgeTriangles, due: &Image<u32>) -> Option<[usize; 2]> {
        if self.settings.rasterizer.is_published() && self.is_near_outline(difference, due) {
            return None;
        }
        difference.missing().find_map(|index| {
            let edges = edges_near(self.triangles[index].instance, self.corners_px(index), difference.pixel);
            edges.into_iter().find_map(|edge| Some([index, meetings.across(edge)?]))
        })
    }

    /// Whether the reference has fewer hits at a nearby sample than at this one. If so, the rasterizer may have moved
    /// the outline of a surface past this sample, so the missing hit may not be a crack.
    fn is_near_outline(&self, difference: &CountDifference, due: &Image<u32>) -> bool {
        let Some((column, row)) = self.grid.sample_at(difference.pixel.0, difference.pixel.1) else { return false };
        let (column, row) = (column - self.origin.0, row - self.origin.1);
        let around = |at: u32, size: u32| at.saturating_sub(REACH_SAMPLES)..(at + REACH_SAMPLES + 1).min(size);
        let (width, height) = self.size;
        let mut near = around(row, height).flat_map(|row| around(column, width).map(move |column| (column, row)));
        near.any(|(column, row)| (due.at(column, row) as usize) < difference.due.len())
    }

    /// Returns a triangle that should not have hit the sample, and another triangle that hits it from the other side of
    /// a shared edge; `None` if there is no such pair.
    fn double_hit(&self, difference: &CountDifference) -> Option<[usize; 2]> {
        let edges = |index: usize| edges_of(self.triangles[index].instance, self.corners_px(index));
        let mut meetings = EdgeTriangles::default();
        for index in &difference.drawn {
            for edge in edges(*index) {
                meetings.add(edge, *index);
            }
        }
        difference
            .extra()
            .find_map(|index| edges(index).into_iter().find_map(|edge| Some([index, meetings.across(edge)?])))
    }

    fn fault(&self, difference: &CountDifference, sharing: [usize; 2]) -> Fault {
        let (x, y) = difference.pixel;
        let id = |index: usize| self.triangles[index].id;
        let ids = |indices: &[usize]| indices.iter().copied().map(id).collect();
        let (hit_by, due) = (ids(&difference.drawn), ids(&difference.due));
        Fault { x, y, kind: difference.kind(), hit_by, due, sharing: sharing.map(id), junction: None }
    }
}
