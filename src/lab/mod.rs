//! The 2D lab: each algorithm of the two-dimensional chapter run on a small input that one can change, and recorded step by
//! step, to be scrubbed in the window, exported, and compared with its rivals.
//!
//! The algorithms themselves are plain iterators of [`crate::flat2d`], [`crate::antialias`] and the pipeline; a *lesson*, one
//! per file, only asks them one item at a time and writes down what they know. [`recording`] is what it writes;
//! [`drawing`] turns that into vector graphics and bitmaps.

pub mod recording;

pub mod drawing;

pub mod picture;

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
use recording::{Comparison, Recording};
use sampling::SamplingLesson;
use seed_fills::SeedFillLesson;
use triangles::TriangleLesson;

choice! {
    /// A page of the lab.
    Page {
        Lines = "lines", "Lines", "Straight lines: by distance, by slope, by adding, by the midpoint, exactly, and smoothed by area.";
        Circles = "circles", "Circles", "Circles and ellipses: by the midpoint, and by their explicit and parametric forms.";
        Polygons = "polygons", "Polygons", "Filling row by row with active edges, cutting into triangles, and the convex hull.";
        SeedFill = "seed-fill", "Seed fill", "Boundary fill and flood fill, over sides or corners, by pixels or by spans.";
        Primitives = "primitives", "Primitives", "Points, lines, strips, fans, quads and polygons read from one list of vertices.";
        Triangles = "triangles", "Triangles", "Rasterizers in their own order, edge functions, shared edges, weights by area.";
        Sampling = "sampling", "Sampling", "Stairs, moiré, turning wheels; supersampling, area sampling, masks and blur.";
    }
}

/// An input and the settings of one page.
#[derive(Clone, Debug, PartialEq)]
pub enum Lesson {
    /// Straight lines.
    Lines(LineLesson),
    /// Circles and ellipses.
    Circles(CircleLesson),
    /// Polygons.
    Polygons(PolygonLesson),
    /// Seed fill.
    SeedFill(SeedFillLesson),
    /// Drawing primitives.
    Primitives(PrimitiveLesson),
    /// Triangles.
    Triangles(TriangleLesson),
    /// Sampling.
    Sampling(SamplingLesson),
}

/// Calls `$body` with `$lesson` standing for the lesson of whatever page.
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
    /// A page as it is first seen.
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

    /// The page that it belongs to.
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

    /// Runs it.
    pub fn record(&self) -> Recording {
        each!(self, lesson => lesson.record())
    }

    /// Runs the bare algorithm, to be timed. Returns how many items it gave.
    pub fn walk(&self) -> usize {
        each!(self, lesson => lesson.walk())
    }

    /// What a student should know of it.
    pub fn explanation(&self) -> &'static str {
        each!(self, lesson => lesson.explanation())
    }

    /// Points that can be dragged, px.
    pub fn handles(&self) -> Vec<DVec2> {
        each!(self, lesson => lesson.handles())
    }

    /// Drags one of them.
    pub fn move_handle(&mut self, handle: usize, to: DVec2) {
        each!(self, lesson => lesson.move_handle(handle, to));
    }

    /// Whether there is a truth that ways to do the same could differ from.
    pub fn compare_is_possible(&self) -> bool {
        match self {
            Self::Primitives(lesson) => lesson.has_outlines(),
            _ => true,
        }
    }

    /// Makes a picture the canvas of the page, if it has one. Whether it has.
    pub fn set_picture(&mut self, picture: &Image<Rgba8>) -> bool {
        match self {
            Self::SeedFill(lesson) => lesson.set_picture(picture),
            Self::Sampling(lesson) => lesson.set_picture(picture),
            _ => return false,
        }
        true
    }

    /// Runs all ways to do the same against the truth, where there is one.
    pub fn compare(&self) -> Option<Comparison> {
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
