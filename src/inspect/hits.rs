//! Cracks and double hits: samples along shared edges that a frame's rasterizer gives to no triangle, or to two.
//!
//! Each sample's hits are counted twice, both times without a depth test: as the recipe draws, and as it should. The second
//! count is right by construction: exact arithmetic and the plainest rasterizer, on the corners that the recipe's arithmetic
//! works on (in fixed point the snapped ones), by the recipe's fill rule or, if that one is wrong on purpose, by top-left.
//!
//! Where the counts differ the triangles are looked up. A difference is a fault of a *shared edge* if two triangles of one
//! instance that have an edge in common, one on each side of it, are at odds there. Other differences, such as those of an
//! outline under the inclusive rule, are counted apart. Triangles that culling dropped take part in neither count, and faults
//! of surfaces behind each other that cancel at a sample are not seen.
//!
//! Surfaces whose borders run along one another without sharing vertices come apart even if everything is drawn as it should
//! be. Their faults are added by [`Hits::with_seams`], once the [`Seams`] of the scene are known.

mod edges;

mod seams;

use serde::Serialize;

use self::edges::{Meetings, edges_near, edges_of};
pub(super) use self::seams::{border_in_picture, junction_pixels};
use crate::chain::{Frame, Recipe};
use crate::image::Image;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::raster::{Scissor, Span, cover_within};
use crate::pipeline::settings::{Arithmetic, FillRule, Rasterizer, Settings};
use crate::pipeline::triangle_list::TriangleList;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::scene::seams::{Junction, JunctionKind, SeamCounts, Seams};
use crate::scene::{Scene, TriangleId};

/// What is wrong at a sample along a shared edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// Fewer triangles hit it than should.
    Crack,
    /// More triangles hit it than should.
    DoubleHit,
}

/// A sample along a shared edge that is hit too seldom or too often.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// Column in the full picture.
    pub x: u32,
    /// Row in the full picture.
    pub y: u32,
    /// What is wrong.
    pub kind: FaultKind,
    /// Triangles that hit it, in drawing order; one that was cut appears once for each piece.
    pub hit_by: Vec<TriangleId>,
    /// Triangles that should hit it.
    pub due: Vec<TriangleId>,
    /// Two triangles that share an edge here: of a crack, the one that is missing first; of a double hit, one that should not
    /// be there first.
    pub sharing: [TriangleId; 2],
    /// The T-junction or unwelded vertex that opens the edge; `None` if the two triangles share its ends.
    pub junction: Option<Junction>,
}

/// The hits of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Hits {
    /// Triangles that cover each sample, packed as the frame's framebuffer is.
    pub counts: Image<u32>,
    /// Faults along shared edges, in reading order.
    pub faults: Vec<Fault>,
    /// Samples that are hit too seldom or too often, but not along a shared edge.
    pub elsewhere: usize,
    /// Numbers of T-junctions and unwelded vertices of the scene; `None` until their faults are added.
    pub mesh: Option<SeamCounts>,
}

impl Hits {
    /// Of a frame that `settings` made.
    pub fn of(frame: &Frame, settings: &Settings) -> Self {
        let Viewport { width, height } = frame.raster;
        Search::of(frame, settings, Scissor::full(width, height)).run()
    }

    /// Of triangles on the screen that are drawn onto a grid of samples.
    pub fn of_triangles(
        triangles: &[ScreenTriangle],
        settings: &Settings,
        grid: SampleGrid,
        Viewport { width, height }: Viewport,
    ) -> Self {
        Search::new(triangles, settings, grid, Scissor::full(width, height)).run()
    }

    /// Adds the faults along the open seams of the scene that the frame shows.
    pub fn with_seams(mut self, scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams) -> Self {
        let Viewport { width, height } = frame.raster;
        let place = |fault: &Fault| (fault.y, fault.x);
        let mut added = seams::faults(scene, recipe, frame, seams, Scissor::full(width, height));
        added.retain(|fault| self.faults.binary_search_by_key(&place(fault), place).is_err());
        self.faults.append(&mut added);
        self.faults.sort_by_key(place);
        self.mesh = Some(seams.counts());
        self
    }

    /// Counts the faults at T-junctions, or those at unwelded vertices.
    pub fn count_at(&self, kind: JunctionKind) -> usize {
        self.faults.iter().filter(|fault| fault.junction.is_some_and(|junction| junction.kind == kind)).count()
    }

    /// How many faults of a kind there are.
    pub fn count(&self, kind: FaultKind) -> usize {
        self.faults.iter().filter(|fault| fault.kind == kind).count()
    }

    /// Both numbers of faults in words, how many of them are at T-junctions and unwelded vertices, and how many samples are
    /// wrong elsewhere, if any are.
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

    /// The first fault after the pixel `from`, or the last one before it; begins anew at the end.
    pub fn beside(&self, from: Option<(u32, u32)>, forwards: bool) -> Option<&Fault> {
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

/// The fault at a pixel of the picture that was drawn, if there is one.
pub fn fault_at(frame: &Frame, settings: &Settings, x: u32, y: u32) -> Option<Fault> {
    let Viewport { width, height } = frame.raster;
    let around_px = if settings.rasterizer.is_published() { REACH_SAMPLES * WIDEST_STEP_PX } else { 0 };
    let end = |at: u32, limit: u32| at.saturating_add(around_px).saturating_add(1).min(limit);
    let (left, top) = (x.saturating_sub(around_px), y.saturating_sub(around_px));
    let scissor = Scissor { left, top, right: end(x, width), bottom: end(y, height) };
    let hits = Search::of(frame, settings, scissor).run();
    hits.faults.into_iter().find(|fault| (fault.x, fault.y) == (x, y))
}

/// Finds the fault along an open seam of the scene at a pixel of the picture that was drawn.
pub(super) fn seam_fault_at(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    seams: &Seams,
    (x, y): (u32, u32),
) -> Option<Fault> {
    seams::faults(scene, recipe, frame, seams, Scissor::pixel(x, y)).into_iter().next()
}

/// Published rasterizers move an outline no farther than past so many samples.
const REACH_SAMPLES: u32 = 2;

/// Most pixels from one sample to the next of any grid.
const WIDEST_STEP_PX: u32 = 4;

/// Where faults are looked for.
struct Search<'a> {
    triangles: &'a [ScreenTriangle],
    /// The same with their boxes, if they are known.
    list: Option<&'a TriangleList>,
    settings: &'a Settings,
    grid: SampleGrid,
    scissor: Scissor,
    /// Packed column and row of the first sample within the scissor.
    origin: (u32, u32),
    /// Packed columns and rows within the scissor.
    size: (u32, u32),
}

/// The two ways of counting.
#[derive(Clone, Copy)]
enum Way {
    Drawn,
    Due,
}

/// A sample with a wrong count, and the triangles there by their places in the list, ascending.
struct Difference {
    pixel: (u32, u32),
    drawn: Vec<usize>,
    due: Vec<usize>,
}

impl Difference {
    /// Triangles that hit the sample and should not.
    fn extra(&self) -> impl Iterator<Item = usize> {
        self.drawn.iter().copied().filter(|index| self.due.binary_search(index).is_err())
    }

    /// Triangles that should hit the sample and do not.
    fn missing(&self) -> impl Iterator<Item = usize> {
        self.due.iter().copied().filter(|index| self.drawn.binary_search(index).is_err())
    }

    fn kind(&self) -> FaultKind {
        if self.drawn.len() < self.due.len() { FaultKind::Crack } else { FaultKind::DoubleHit }
    }
}

impl<'a> Search<'a> {
    fn new(triangles: &'a [ScreenTriangle], settings: &'a Settings, grid: SampleGrid, scissor: Scissor) -> Self {
        let rows = grid.rows(scissor.top, scissor.bottom);
        let columns = rows.clone().map(|row| grid.columns(row, scissor.left, scissor.right)).filter(|c| !c.is_empty());
        let columns = columns.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or_default();
        let (origin, size) = ((columns.start, rows.start), (columns.len() as u32, rows.len() as u32));
        Self { triangles, list: None, settings, grid, scissor, origin, size }
    }

    fn of(frame: &'a Frame, settings: &'a Settings, scissor: Scissor) -> Self {
        let list = &frame.geometry.triangles;
        Self { list: Some(list), ..Self::new(list, settings, frame.drawn.grid, scissor) }
    }

    /// Whether a triangle of the list may have samples within the scissor.
    fn may_meet(&self, place: usize) -> bool {
        match self.list {
            Some(list) => self.scissor.may_meet_box(list.box_of(place)),
            None => self.scissor.may_meet(self.triangles[place].corners_px()),
        }
    }

    fn run(&self) -> Hits {
        let (counts, due) = (self.count(Way::Drawn), self.count(Way::Due));
        let differences = self.differences(&counts, &due);
        let missing = self.meetings_of_missing(&differences);
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

    fn count(&self, way: Way) -> Image<u32> {
        let mut counts = Image::filled(self.size.0, self.size.1, 0);
        self.each_hit(way, |_, (column, row)| counts.set(column, row, counts.at(column, row) + 1));
        counts
    }

    /// Calls `sink` with the place in the list and the sample, counted from the origin, of every hit.
    fn each_hit(&self, way: Way, mut sink: impl FnMut(usize, (u32, u32))) {
        let Settings { rasterizer, arithmetic, fill_rule, .. } = *self.settings;
        let sound_rule = if fill_rule.is_sound() { fill_rule } else { FillRule::TopLeft };
        let how = match way {
            Way::Drawn => (rasterizer, arithmetic, fill_rule),
            Way::Due => (Rasterizer::BoundingBox, Arithmetic::Exact, sound_rule),
        };
        let mut spans: Vec<Span> = Vec::new();
        for (index, triangle) in self.triangles.iter().enumerate() {
            if !self.may_meet(index) {
                continue;
            }
            let corners_px = match way {
                Way::Drawn => triangle.corners_px(),
                Way::Due => self.corners_px(index),
            };
            spans.clear();
            cover_within(how, corners_px, (self.grid, self.scissor), &mut spans);
            for span in &spans {
                let row = span.row - self.origin.1;
                (span.left..span.right).for_each(|column| sink(index, (column - self.origin.0, row)));
            }
        }
    }

    /// The corners that the recipe's arithmetic works on.
    fn corners_px(&self, index: usize) -> [[f32; 2]; 3] {
        match self.settings.arithmetic {
            Arithmetic::Fixed => self.triangles[index].snapped_px(),
            Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => self.triangles[index].corners_px(),
        }
    }

    /// The samples whose counts differ, in reading order. Only if there are any is anything drawn again.
    fn differences(&self, drawn: &Image<u32>, due: &Image<u32>) -> Vec<Difference> {
        const NONE: u32 = u32::MAX;
        let (width, height) = self.size;
        let mut numbers = Image::filled(width, height, NONE);
        let mut differences = Vec::new();
        for (column, row) in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))) {
            if drawn.at(column, row) != due.at(column, row) {
                numbers.set(column, row, differences.len() as u32);
                let pixel = self.grid.pixel(column + self.origin.0, row + self.origin.1);
                differences.push(Difference { pixel, drawn: Vec::new(), due: Vec::new() });
            }
        }
        if differences.is_empty() {
            return differences;
        }
        for way in [Way::Drawn, Way::Due] {
            self.each_hit(way, |index, (column, row)| {
                let Some(difference) = differences.get_mut(numbers.at(column, row) as usize) else { return };
                match way {
                    Way::Drawn => difference.drawn.push(index),
                    Way::Due => difference.due.push(index),
                }
            });
        }
        differences
    }

    /// Who meets at the edges that missing triangles may have lost their samples at.
    fn meetings_of_missing(&self, differences: &[Difference]) -> Meetings {
        let mut meetings = Meetings::default();
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

    /// A missing triangle, and the one on the other side of the edge that it lost the sample at.
    fn crack(&self, difference: &Difference, meetings: &Meetings, due: &Image<u32>) -> Option<[usize; 2]> {
        if self.settings.rasterizer.is_published() && self.is_near_outline(difference, due) {
            return None;
        }
        difference.missing().find_map(|index| {
            let edges = edges_near(self.triangles[index].instance, self.corners_px(index), difference.pixel);
            edges.into_iter().find_map(|edge| Some([index, meetings.across(edge)?]))
        })
    }

    /// Whether fewer triangles are due close by, so that a rasterizer that moves samples may have moved this one off the
    /// surface instead of into a crack.
    fn is_near_outline(&self, difference: &Difference, due: &Image<u32>) -> bool {
        let Some((column, row)) = self.grid.sample_at(difference.pixel.0, difference.pixel.1) else { return false };
        let (column, row) = (column - self.origin.0, row - self.origin.1);
        let around = |at: u32, size: u32| at.saturating_sub(REACH_SAMPLES)..(at + REACH_SAMPLES + 1).min(size);
        let (width, height) = self.size;
        let mut near = around(row, height).flat_map(|row| around(column, width).map(move |column| (column, row)));
        near.any(|(column, row)| (due.at(column, row) as usize) < difference.due.len())
    }

    /// A triangle that should not be there, and one that is there, too, on the other side of an edge of both.
    fn double_hit(&self, difference: &Difference) -> Option<[usize; 2]> {
        let edges = |index: usize| edges_of(self.triangles[index].instance, self.corners_px(index));
        let mut meetings = Meetings::default();
        for index in &difference.drawn {
            for edge in edges(*index) {
                meetings.add(edge, *index);
            }
        }
        difference
            .extra()
            .find_map(|index| edges(index).into_iter().find_map(|edge| Some([index, meetings.across(edge)?])))
    }

    fn fault(&self, difference: &Difference, sharing: [usize; 2]) -> Fault {
        let (x, y) = difference.pixel;
        let id = |index: usize| self.triangles[index].id;
        let ids = |indices: &[usize]| indices.iter().copied().map(id).collect();
        let (hit_by, due) = (ids(&difference.drawn), ids(&difference.due));
        Fault { x, y, kind: difference.kind(), hit_by, due, sharing: sharing.map(id), junction: None }
    }
}
