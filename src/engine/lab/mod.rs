//! The 2D lab: runs each algorithm of the 2D chapter on a small editable input and records it step by step. Recordings
//! can be scrubbed in the window and exported, and the methods of a page can be compared.
//!
//! The algorithms themselves are plain iterators of [`crate::flat2d`], [`crate::antialias`] and the pipeline. A
//! *lesson*, one per file, advances them by one item at a time and records their state in a [`recording`]. [`drawing`]
//! converts recordings to vector graphics and bitmaps.

pub mod recording;

pub mod drawing;

pub mod page;

pub(crate) mod picture;

pub mod lines;

pub mod circles;

pub mod polygons;

pub mod seed_fills;

pub mod primitives;

pub mod triangles;

pub mod sampling;

use glam::DVec2;

use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};
use circles::CircleLesson;
use lines::LineLesson;
use polygons::PolygonLesson;
use primitives::PrimitiveLesson;
use recording::{MethodComparison, Recording};
use sampling::SamplingLesson;
use seed_fills::SeedFillLesson;
use triangles::TriangleLesson;

choice! {
    /// Page of the lab, which teaches one topic.
    pub Page {
        Lines = "lines", "Lines",
            "Straight lines: by distance, by slope, DDA, midpoint, exact, and anti-aliased by area.";
        Circles = "circles", "Circles", "Circles and ellipses: midpoint method, explicit form and parametric form.";
        Polygons = "polygons", "Polygons", "Scanline fill with active edges, ear clipping, and the convex hull.";
        SeedFill = "seed-fill", "Seed fill",
            "Boundary fill and flood fill, 4-connected or 8-connected, by pixels or by spans.";
        Primitives = "primitives", "Primitives", "Points, lines, strips, fans, quads and polygons read from one list of vertices.";
        Triangles = "triangles", "Triangles",
            "Pixel order of the rasterizers, edge functions, shared edges, barycentric weights.";
        Sampling = "sampling", "Sampling",
            "Aliasing: jagged edges, moiré, wagon wheel; supersampling, area sampling, filter masks.";
    }
}

/// Input and settings of one page.
#[derive(Clone, Debug, PartialEq)]
pub enum Lesson {
    /// Lesson on straight lines.
    Lines(LineLesson),
    /// Lesson on circles and ellipses.
    Circles(CircleLesson),
    /// Lesson on filling polygons.
    Polygons(PolygonLesson),
    /// Lesson on seed fills.
    SeedFill(SeedFillLesson),
    /// Lesson on drawing primitives.
    Primitives(PrimitiveLesson),
    /// Lesson on rasterizing triangles.
    Triangles(TriangleLesson),
    /// Lesson on sampling and aliasing.
    Sampling(SamplingLesson),
}

/// Evaluates `$body` with `$lesson` bound to the lesson of any page.
macro_rules! each {
    ($any:expr, $lesson:ident => $body:expr) => {
        match $any {
            Lesson::Lines($lesson) => $body,
            Lesson::Circles($lesson) => $body,
            Lesson::Polygons($lesson) => $body,
            Lesson::SeedFill($lesson) => $body,
            Lesson::Primitives($lesson) => $body,
            Lesson::Triangles($lesson) => $body,
            Lesson::Sampling($lesson) => $body,
        }
    };
}

impl Lesson {
    /// Creates the lesson of a page with its default input.
    pub fn new(page: Page) -> Self {
        match page {
            Page::Lines => Self::Lines(LineLesson::default()),
            Page::Circles => Self::Circles(CircleLesson::default()),
            Page::Polygons => Self::Polygons(PolygonLesson::default()),
            Page::SeedFill => Self::SeedFill(SeedFillLesson::default()),
            Page::Primitives => Self::Primitives(PrimitiveLesson::default()),
            Page::Triangles => Self::Triangles(TriangleLesson::default()),
            Page::Sampling => Self::Sampling(SamplingLesson::default()),
        }
    }

    /// Returns the page of the lesson.
    pub fn page(&self) -> Page {
        match self {
            Self::Lines(_) => Page::Lines,
            Self::Circles(_) => Page::Circles,
            Self::Polygons(_) => Page::Polygons,
            Self::SeedFill(_) => Page::SeedFill,
            Self::Primitives(_) => Page::Primitives,
            Self::Triangles(_) => Page::Triangles,
            Self::Sampling(_) => Page::Sampling,
        }
    }

    /// Runs the algorithm and records its steps.
    pub fn record(&self) -> Recording {
        each!(self, lesson => lesson.record())
    }

    /// Runs the algorithm without recording, for timing. Returns the number of items that its iterator yields.
    pub fn walk(&self) -> usize {
        each!(self, lesson => lesson.walk())
    }

    /// Returns an explanation of the algorithm for students.
    pub fn explanation(&self) -> &'static str {
        each!(self, lesson => lesson.explanation())
    }

    /// Returns the draggable points of the input, in pixels.
    pub fn handles(&self) -> Vec<DVec2> {
        each!(self, lesson => lesson.handles())
    }

    /// Moves the point with this index to `to`, in pixels.
    pub fn move_handle(&mut self, handle: usize, to: DVec2) {
        each!(self, lesson => lesson.move_handle(handle, to));
    }

    /// Whether the page has a reference against which its methods can be compared.
    pub fn compare_is_possible(&self) -> bool {
        match self {
            Self::Primitives(lesson) => lesson.has_outlines(),
            _ => true,
        }
    }

    /// Replaces the input of the page by a picture. Returns `false` if the page does not take pictures.
    pub fn set_picture(&mut self, picture: &Image<Rgba8>) -> bool {
        match self {
            Self::SeedFill(lesson) => lesson.set_picture(picture),
            Self::Sampling(lesson) => lesson.set_picture(picture),
            _ => return false,
        }
        true
    }

    /// Compares all methods of the page with its reference; `None` if it has none.
    pub fn compare(&self) -> Option<MethodComparison> {
        match self {
            Self::Lines(lesson) => Some(lesson.compare()),
            Self::Circles(lesson) => Some(lesson.compare()),
            Self::Polygons(lesson) => Some(lesson.compare()),
            Self::Triangles(lesson) => Some(lesson.compare()),
            Self::Sampling(lesson) => Some(lesson.compare()),
            Self::SeedFill(lesson) => Some(lesson.compare()),
            Self::Primitives(lesson) => lesson.has_outlines().then(|| lesson.compare()),
        }
    }
}

#[cfg(test)]
mod tests;
