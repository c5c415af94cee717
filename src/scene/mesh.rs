//! Triangle meshes.

use std::ops::Deref;

use glam::{Vec2, Vec3};
use thiserror::Error;

use super::clusters::{Clusters, visible_bounds};
use crate::math::{Aabb, unit_or};
use crate::text;

/// The arrays of a mesh before they are checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// What a person calls it.
    pub name: String,
    /// One per vertex, model space.
    pub positions: Vec<Vec3>,
    /// One per vertex, unit length, or none at all: then they are computed.
    pub normals: Vec<Vec3>,
    /// One per vertex, or none at all. v runs down the picture (already flipped).
    pub uvs: Vec<Vec2>,
    /// One per vertex, or none at all; sRGB values in [0, 1].
    pub colors: Vec<Vec3>,
    /// Vertex numbers, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

/// Why arrays do not make a mesh.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MeshError {
    /// An index beyond the vertices.
    #[error("triangle {triangle} refers to vertex {vertex} of {count}")]
    IndexOutOfRange {
        /// Number of the triangle.
        triangle: usize,
        /// The index that it holds.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// An attribute array of another length than the positions.
    #[error("{count} {attribute} for {positions} positions")]
    LengthMismatch {
        /// Which array.
        attribute: &'static str,
        /// Its length.
        count: usize,
        /// The length that it should have.
        positions: usize,
    },
    /// A NaN or an infinity.
    #[error("{attribute} {index} is not finite")]
    NotFinite {
        /// Which array.
        attribute: &'static str,
        /// Where in it.
        index: usize,
    },
}

/// A checked mesh: indices in range, arrays of equal length, one unit normal per vertex, or a zero one where the one that
/// was given was no number. Positions may be NaN or infinite: the clipper rejects triangles that use them. All other
/// numbers are finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    data: MeshData,
    bounds: Aabb,
    visible_bounds: Aabb,
    clusters: Clusters,
    lost_normals: usize,
}

impl Mesh {
    /// Checks the arrays. Missing normals are computed ([`super::mesh::smooth_normals`]).
    pub fn new(mut data: MeshData) -> Result<Self, MeshError> {
        data.name = text::clean(&data.name).into_owned();
        let count = data.positions.len();
        for (triangle, corners) in data.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|v| **v as usize >= count) {
                return Err(MeshError::IndexOutOfRange { triangle, vertex, count });
            }
        }
        if data.normals.is_empty() {
            data.normals = smooth_normals(&data.positions, &data.triangles);
        }
        check_array("normals", &data.normals, count, false, |n| n.is_finite())?;
        check_array("texture coordinates", &data.uvs, count, true, |t| t.is_finite())?;
        check_array("vertex colours", &data.colors, count, true, |c| c.is_finite())?;
        Ok(Self::of(data, 0))
    }

    /// As [`Mesh::new`], but for normals that are no finite numbers: they become zero, so that no direct light reaches the
    /// vertex, and are counted.
    pub fn without_lost_normals(mut data: MeshData) -> Result<Self, MeshError> {
        let mut lost_normals = 0;
        for normal in data.normals.iter_mut().filter(|normal| !normal.is_finite()) {
            *normal = Vec3::ZERO;
            lost_normals += 1;
        }
        Ok(Self { lost_normals, ..Self::new(data)? })
    }

    /// From arrays that were checked.
    fn of(data: MeshData, lost_normals: usize) -> Self {
        let bounds = Aabb::around(data.positions.iter().copied().filter(|position| position.is_finite()));
        let visible_bounds = visible_bounds(data.positions.iter().copied());
        let clusters = Clusters::new(&data.positions, &data.triangles);
        Self { data, bounds, visible_bounds, clusters, lost_normals }
    }

    /// How many vertices have no normal because the one that was given was no finite number.
    pub fn lost_normals(&self) -> usize {
        self.lost_normals
    }

    /// Returns the box around all vertices whose position is finite, model space.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Returns the box for visibility tests, model space: [`Mesh::bounds`], or [`Aabb::EVERYTHING`] if a position is NaN or
    /// infinite.
    pub fn visible_bounds(&self) -> Aabb {
        self.visible_bounds
    }

    /// The parts that are looked at as a whole; none of a small mesh.
    pub fn clusters(&self) -> &Clusters {
        &self.clusters
    }

    /// The mirror image in z: for models made for a world of the other handedness. Two corners of each triangle change
    /// places, so that front faces stay front faces.
    pub fn mirrored_z(&self) -> Self {
        let mut data = self.data.clone();
        for vector in data.positions.iter_mut().chain(&mut data.normals) {
            vector.z = -vector.z;
        }
        for triangle in &mut data.triangles {
            triangle.swap(1, 2);
        }
        Self::of(data, self.lost_normals)
    }

    /// Bytes held by the arrays.
    pub fn bytes(&self) -> usize {
        let MeshData { name: _, positions, normals, uvs, colors, triangles } = &self.data;
        (positions.capacity() + normals.capacity() + colors.capacity()) * size_of::<Vec3>()
            + uvs.capacity() * size_of::<Vec2>()
            + triangles.capacity() * size_of::<[u32; 3]>()
            + self.clusters.bytes()
    }
}

impl Deref for Mesh {
    type Target = MeshData;

    fn deref(&self) -> &MeshData {
        &self.data
    }
}

fn check_array<T>(
    attribute: &'static str,
    values: &[T],
    positions: usize,
    may_be_absent: bool,
    is_finite: impl Fn(&T) -> bool,
) -> Result<(), MeshError> {
    if may_be_absent && values.is_empty() {
        return Ok(());
    }
    if values.len() != positions {
        return Err(MeshError::LengthMismatch { attribute, count: values.len(), positions });
    }
    match values.iter().position(|v| !is_finite(v)) {
        Some(index) => Err(MeshError::NotFinite { attribute, index }),
        None => Ok(()),
    }
}

/// One normal per vertex: the mean of the normals of its triangles, weighted by area.
///
/// Computed in f64, and scaled by the largest component before the length is taken, so that neither huge nor tiny
/// triangles overflow or vanish. A vertex without a triangle of positive area gets +z.
pub fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![glam::DVec3::ZERO; positions.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|i| positions[i as usize].as_dvec3());
        let doubled_area_normal = (b - a).cross(c - a);
        for i in corners {
            sums[*i as usize] += doubled_area_normal;
        }
    }
    sums.into_iter().map(|sum| unit_or(sum, Vec3::Z)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> MeshData {
        MeshData { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]], ..MeshData::default() }
    }

    #[test]
    fn missing_normals_are_computed() {
        assert_eq!(Mesh::new(triangle()).unwrap().normals, vec![Vec3::Z; 3]);
    }

    #[test]
    fn a_dangling_index_is_refused() {
        let data = MeshData { triangles: vec![[0, 1, 3]], ..triangle() };
        assert_eq!(Mesh::new(data), Err(MeshError::IndexOutOfRange { triangle: 0, vertex: 3, count: 3 }));
    }

    #[test]
    fn a_mirrored_mesh_keeps_its_front_and_comes_back_whole() {
        let mut data = triangle();
        data.positions[2].z = 2.0;
        let mesh = Mesh::new(data).unwrap();
        let mirrored = mesh.mirrored_z();
        assert_eq!(mirrored.positions[2].z, -2.0);
        let computed = smooth_normals(&mirrored.positions, &mirrored.triangles);
        assert!(computed[0].dot(mirrored.normals[0]) > 0.999, "{computed:?}");
        assert_eq!(mirrored.mirrored_z(), mesh);
    }

    #[test]
    fn positions_that_are_not_finite_are_kept_and_left_out_of_the_bounds() {
        for broken in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            let mut data = triangle();
            let finite = Mesh::new(data.clone()).unwrap();
            assert_eq!(finite.bounds(), finite.visible_bounds());
            data.positions.push(Vec3::new(7.0, broken, 7.0));
            data.triangles.push([0, 1, 3]);
            data.normals = vec![Vec3::Z; 4];
            let mesh = Mesh::new(data).unwrap();
            assert_eq!((mesh.bounds(), mesh.visible_bounds()), (finite.bounds(), Aabb::EVERYTHING));
        }
    }

    #[test]
    fn infinite_texture_coordinates_are_refused() {
        let uvs = vec![Vec2::ZERO, Vec2::ONE, Vec2::new(0.0, f32::INFINITY)];
        assert!(matches!(
            Mesh::new(MeshData { uvs, ..triangle() }),
            Err(MeshError::NotFinite { attribute: "texture coordinates", index: 2 })
        ));
    }

    #[test]
    fn normals_that_are_no_numbers_are_refused_or_taken_out_and_counted() {
        let normals = vec![Vec3::Z, Vec3::NAN, Vec3::new(0.0, f32::INFINITY, 0.0)];
        let data = MeshData { normals, ..triangle() };
        assert!(matches!(Mesh::new(data.clone()), Err(MeshError::NotFinite { attribute: "normals", index: 1 })));
        let mesh = Mesh::without_lost_normals(data).unwrap();
        assert_eq!((mesh.normals.as_slice(), mesh.lost_normals()), ([Vec3::Z, Vec3::ZERO, Vec3::ZERO].as_slice(), 2));
        assert_eq!(mesh.mirrored_z().lost_normals(), 2);
    }

    #[test]
    fn normals_of_extreme_triangles_are_finite_units() {
        for scale in [1e-30_f32, 1e30] {
            let data = triangle();
            let positions: Vec<_> = data.positions.iter().map(|p| *p * scale).collect();
            assert_eq!(smooth_normals(&positions, &data.triangles), vec![Vec3::Z; 3]);
        }
    }
}
