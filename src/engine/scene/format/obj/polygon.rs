//! Triangulation of a polygon in space.
//!
//! Input: the corners of one face, in order. Output: triples of corner indices with the winding of the face. The face
//! is projected along its normal by Newell's method (Sutherland, Sproull and Schumacker, 1974), which also handles
//! corners that are not exactly coplanar. The first suitable method in this list is used:
//!
//! - a fan, if all its triangles have positive area: O(n), and keeps corners that lie in the middle of an edge;
//! - ear clipping (Meisters, 1975; Held, 2001, by the crate `earcut`), if there are few corners: O(n³) at worst;
//! - a sweep ([`sweep`]), if the outline does not touch itself: O(n log n);
//! - regions by winding number ([`winding`]), which adds the points where the outline crosses itself;
//! - a plain fan, if the face is far from flat and its projection crosses itself, or if it crosses itself too often.
//!
//! Triangles without area are skipped, because they cover nothing. The projection is computed in f64, where products of
//! f32 coordinates neither overflow nor underflow.

mod grid;
mod sweep;
mod winding;

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

pub(super) use self::winding::OutlineCrossing;

/// Number of corners tried as the apex of a fan. More than one is tried, because a fan has a triangle without area if
/// its apex lies in the middle of a straight edge.
const FAN_APEXES: usize = 4;

/// Maximum number of corners of a face for ear clipping, which takes 0.1 ms at worst.
const MAX_EAR_CORNERS: usize = 64;

/// If the area of a face and the total area of its triangles differ by at most this fraction, the difference is
/// attributed to rounding.
const AREA_TOLERANCE: f64 = 1e-6;

/// Minimum area of a triangle relative to its face; smaller areas are attributed to rounding.
const SLIVER: f64 = 1e-14;

/// Newell's normal is used if its length is at least this fraction of the length that it would have without
/// cancellation. In a bow tie, its clockwise and counter-clockwise terms cancel.
const CANCELLATION: f64 = 1e-4;

/// A face is flat if the distance of every corner from its plane is at most this fraction of the square root of twice
/// the face's area.
const FLATNESS: f64 = 1e-4;

/// Result of triangulating a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TriangulationOutcome {
    /// The triangles cover exactly the area of the face.
    Whole,
    /// No triangles: the corners lie on a line or a point, or the windings cancel everywhere.
    NoArea,
    /// The face crosses itself; the triangles cover its regions by winding number.
    Crossing,
    /// The face is far from flat and its outline crosses itself in projection; the triangles are a fan.
    NotFlat,
    /// The face crosses itself too often; the triangles are a fan.
    TooManyCrossings,
}

/// Area of a face, and distance of its corners from its plane.
struct Flat {
    /// Twice the signed area of the face, with clockwise regions subtracted; 0 if it has no normal.
    doubled_area: f64,
    /// Twice the area of the face, to which slivers and heights are compared. Equals `doubled_area` unless clockwise
    /// and counter-clockwise regions cancel; then, all regions are counted as positive.
    scale: f64,
    /// Maximum distance of a corner from the plane through the first corner, in model units.
    height: f64,
}

impl Flat {
    fn is_flat(&self) -> bool {
        self.height <= FLATNESS * self.scale.sqrt()
    }
}

/// Triangulation of one polygon: its triangles, and the points where its outline crosses itself.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Triangulation {
    /// Corner indices of each triangle. Indices from the number of corners on refer to `crossings`.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Points where the outline crosses itself.
    pub(super) crossings: Vec<OutlineCrossing>,
}

/// Triangulator for polygons that reuses its buffers.
#[derive(Default)]
pub(super) struct Triangulator {
    flat: Vec<DVec2>,
    earcut: Earcut<f64>,
    ears: Vec<u32>,
}

impl Triangulator {
    /// Triangulates the polygon with these corners, and replaces the content of `result`. After cancellation, the
    /// result is a fan.
    pub(super) fn triangulate(
        &mut self,
        corners: &[Vec3],
        result: &mut Triangulation,
        is_cancelled: &dyn Fn() -> bool,
    ) -> TriangulationOutcome {
        let Triangulation { triangles, crossings } = result;
        triangles.clear();
        crossings.clear();
        let flat = self.project(corners);
        if flat.scale <= 0.0 {
            return TriangulationOutcome::NoArea;
        }
        let count = corners.len();
        let least = SLIVER * flat.scale;
        if let Some(apex) = (0..count.min(FAN_APEXES)).find(|apex| self.is_fan(*apex, least)) {
            triangles.extend(fan(apex, count).map(|t| t.map(|corner| corner as u32)));
            return TriangulationOutcome::Whole;
        }
        let is_whole = self.cut(flat.doubled_area, least, triangles, is_cancelled);
        if is_whole && (triangles.len() == count - 2 || flat.is_flat()) {
            return TriangulationOutcome::Whole;
        }
        triangles.clear();
        if !flat.is_flat() {
            // A triangle whose projection has no area may have an area in space; omitting it would leave a hole.
            triangles.extend(solid_fan(corners));
            return if is_whole { TriangulationOutcome::Whole } else { TriangulationOutcome::NotFlat };
        }
        match winding::triangulate(&grid::to_grid(&self.flat), crossings, is_cancelled) {
            Some(regions) if regions.is_empty() => TriangulationOutcome::NoArea,
            Some(regions) => {
                triangles.extend(regions);
                let only_touches = crossings.is_empty() && {
                    let area = |t: &[u32; 3]| self.doubled_area(t.map(|corner| corner as usize));
                    let covered: f64 = triangles.iter().map(area).sum();
                    let turns_alike = triangles.iter().all(|t| area(t) >= -least);
                    turns_alike && (covered - flat.doubled_area).abs() <= AREA_TOLERANCE * flat.doubled_area
                };
                if only_touches { TriangulationOutcome::Whole } else { TriangulationOutcome::Crossing }
            }
            None => {
                triangles.extend(solid_fan(corners));
                TriangulationOutcome::TooManyCrossings
            }
        }
    }

    /// Triangulates the face if its outline does not cross itself. Returns whether the triangles cover exactly the area
    /// of the face.
    fn cut(
        &mut self,
        doubled_area: f64,
        least: f64,
        triangles: &mut Vec<[u32; 3]>,
        is_cancelled: &dyn Fn() -> bool,
    ) -> bool {
        let count = self.flat.len();
        let swept = || sweep::triangulate(&grid::to_grid(&self.flat), is_cancelled);
        if count <= MAX_EAR_CORNERS {
            self.earcut.earcut(self.flat.iter().map(DVec2::to_array), &[], &mut self.ears);
            triangles.extend(self.ears.as_chunks::<3>().0);
        } else if let Some(swept) = swept() {
            triangles.extend(swept);
        }
        let area = |triangle: &[u32; 3]| self.doubled_area(triangle.map(|corner| corner as usize));
        let turns_alike = triangles.iter().all(|triangle| area(triangle) >= -least);
        triangles.retain(|triangle| area(triangle) > least);
        let covered: f64 = triangles.iter().map(area).sum();
        // If ears are missing, the total area may still be right, because the areas of the missing ears can cancel. The
        // sweep then decides whether the outline is simple.
        let is_complete = triangles.len() == count - 2 || count > MAX_EAR_CORNERS || swept().is_some();
        covered > 0.0 && turns_alike && is_complete && (covered - doubled_area).abs() <= AREA_TOLERANCE * doubled_area
    }

    /// Projects the corners along the face normal, so that they appear counter-clockwise.
    ///
    /// Projecting along the nearest axis instead would fold faces whose corners are not coplanar.
    fn project(&mut self, corners: &[Vec3]) -> Flat {
        let origin = corners.first().map_or(DVec3::ZERO, |c| c.as_dvec3());
        let relative = |i: usize| corners[i % corners.len()].as_dvec3() - origin;
        let areas = || (0..corners.len()).map(|i| relative(i).cross(relative(i + 1)));
        let newell: DVec3 = areas().sum();
        // Areas that oppose the largest one are negated, so that the sum does not cancel.
        let largest = areas().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec3::ZERO);
        let aligned: DVec3 = areas().map(|area| if area.dot(largest) < 0.0 { -area } else { area }).sum();
        let is_cancelled = newell.length() < CANCELLATION * aligned.length();
        let normal = match is_cancelled {
            true if newell.dot(aligned) < 0.0 => -aligned,
            true => aligned,
            false => newell,
        };
        let Some(unit) = (normal / normal.abs().max_element()).try_normalize() else {
            return Flat { doubled_area: 0.0, scale: 0.0, height: 0.0 };
        };
        let (u, v) = unit.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend((0..corners.len()).map(|i| DVec2::new(relative(i).dot(u), relative(i).dot(v))));
        let height = (0..corners.len()).map(|i| relative(i).dot(unit).abs()).fold(0.0, f64::max);
        Flat { doubled_area: newell.dot(unit), scale: normal.dot(unit), height }
    }

    fn doubled_area(&self, [a, b, c]: [usize; 3]) -> f64 {
        (self.flat[b] - self.flat[a]).perp_dot(self.flat[c] - self.flat[a])
    }

    /// Whether all triangles of the fan from `apex` have the winding of the polygon and a doubled area above `least`.
    fn is_fan(&self, apex: usize, least: f64) -> bool {
        fan(apex, self.flat.len()).all(|triangle| self.doubled_area(triangle) > least)
    }
}

/// Returns the triangles of a fan from corner `apex` of `count` corners.
fn fan(apex: usize, count: usize) -> impl Iterator<Item = [usize; 3]> {
    (1..count - 1).map(move |i| [apex, (apex + i) % count, (apex + i + 1) % count])
}

/// Returns the triangles of the fan from the first corner, except those whose area in space is zero.
fn solid_fan(corners: &[Vec3]) -> impl Iterator<Item = [u32; 3]> {
    let has_area = |[a, b, c]: &[usize; 3]| {
        let [a, b, c] = [a, b, c].map(|corner| corners[*corner].as_dvec3());
        (b - a).cross(c - a) != DVec3::ZERO
    };
    fan(0, corners.len()).filter(has_area).map(|triangle| triangle.map(|corner| corner as u32))
}

#[cfg(test)]
mod tests;
