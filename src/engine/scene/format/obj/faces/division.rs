//! Division of a face into triangles.

use super::{FaceCorner, FaceReader, NONE};
use crate::math::unit_or;
use crate::scene::format::obj::polygon::{OutlineCrossing, Triangulation, TriangulationOutcome};

/// Cost of triangulating a self-intersecting face, relative to a simple face with the same number of corners.
const WORK_OF_CROSSING: usize = 100;

/// Memory per corner of a face during triangulation, in bytes.
const CUTTING_BYTES: u64 = 256;

impl FaceReader<'_, '_> {
    /// Whether a corner of the current face is not finite.
    pub(super) fn has_broken_corner(&self) -> bool {
        self.corners.iter().any(|corner| !self.lists.positions[corner.position as usize].is_finite())
    }

    /// Triangulates the current face as a fan, because a face with a corner that is not finite has no plane.
    pub(super) fn fan(&mut self) -> TriangulationOutcome {
        self.local = Triangulation::default();
        self.local.triangles.extend((2..self.corners.len() as u32).map(|corner| [0, corner - 1, corner]));
        TriangulationOutcome::Whole
    }

    /// Triangulates the current face in its plane.
    pub(super) fn triangulate(&mut self) -> Result<TriangulationOutcome, String> {
        let bytes = CUTTING_BYTES * self.corners.len() as u64;
        self.load.charge(bytes)?;
        self.outline.clear();
        self.outline.extend(self.corners.iter().map(|c| self.lists.positions[c.position as usize]));
        let load = &*self.load;
        let outcome = self.triangulator.triangulate(&self.outline, &mut self.local, &|| load.is_cancelled());
        self.load.release(bytes);
        let crosses = matches!(outcome, TriangulationOutcome::Crossing | TriangulationOutcome::TooManyCrossings);
        self.cut_corners = self.corners.len() * if crosses { WORK_OF_CROSSING } else { 1 };
        Ok(outcome)
    }

    /// Appends the self-intersection points of the current face to its corners.
    pub(super) fn add_crossings(&mut self) -> Result<(), String> {
        let count = self.corners.len();
        for OutlineCrossing { edge, place } in std::mem::take(&mut self.local.crossings) {
            let ends = [self.corners[edge as usize], self.corners[(edge as usize + 1) % count]];
            let corner = self.between(ends, place)?;
            self.load.push(&mut self.corners, corner)?;
        }
        Ok(())
    }

    /// Creates a corner that is linearly interpolated between two others. `place` is 0 at the first corner and 1 at the
    /// second.
    fn between(&mut self, [a, b]: [FaceCorner; 2], place: f64) -> Result<FaceCorner, String> {
        let number = |list_length: usize| {
            u32::try_from(list_length).ok().filter(|n| *n != NONE).ok_or("more vertices than 32-bit indices allow")
        };
        let Self { lists, load, .. } = self;
        let position = number(lists.positions.len())?;
        let ends = [a, b].map(|corner| lists.positions[corner.position as usize].as_dvec3());
        load.push(&mut lists.positions, ends[0].lerp(ends[1], place).as_vec3())?;
        if !lists.colors.is_empty() {
            let [from, to] = [a, b].map(|corner| lists.colors[corner.position as usize]);
            load.push(&mut lists.colors, from.lerp(to, place as f32))?;
        }
        let (mut uv, mut normal) = (NONE, NONE);
        if a.uv != NONE && b.uv != NONE {
            uv = number(lists.uvs.len())?;
            let [from, to] = [a, b].map(|corner| lists.uvs[corner.uv as usize]);
            load.push(&mut lists.uvs, from.lerp(to, place as f32))?;
        }
        if a.normal != NONE && b.normal != NONE {
            normal = number(lists.normals.len())?;
            let [from, to] = [a, b].map(|corner| lists.normals[corner.normal as usize]);
            load.push(&mut lists.normals, unit_or(from.as_dvec3().lerp(to.as_dvec3(), place), from))?;
        }
        Ok(FaceCorner { position, uv, normal })
    }
}
