//! Triangle meshes: vertex and index arrays, validation, and computed normals.

use std::ops::Deref;

use glam::{Vec2, Vec3};
use thiserror::Error;

use super::clusters::{Clusters, visible_bounds};
use crate::math::{Aabb, unit_or};
use crate::text;

/// Arrays of a mesh before validation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Display name of the mesh.
    pub name: String,
    /// Position of each vertex, in model space.
    pub positions: Vec<Vec3>,
    /// Unit normal of each vertex, in model space. If empty, normals are computed.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of each vertex, or empty. v points down, so coordinates from a file are already flipped.
    pub uvs: Vec<Vec2>,
    /// Colour of each vertex as sRGB values in [0, 1], or empty.
    pub colors: Vec<Vec3>,
    /// Vertex indices of each triangle, counter-clockwise as seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

/// Reason why arrays do not form a valid mesh.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MeshError {
    /// A vertex index is out of range.
    #[error("triangle {triangle} refers to vertex {vertex} of {count}")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// Invalid vertex index.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// The length of an attribute array differs from the number of positions.
    #[error("{count} {attribute} for {positions} positions")]
    LengthMismatch {
        /// Name of the attribute.
        attribute: &'static str,
        /// Length of the attribute array.
        count: usize,
        /// Number of positions, the required length.
        positions: usize,
    },
    /// An attribute is NaN or infinite.
    #[error("{attribute} {index} is not finite")]
    NotFinite {
        /// Name of the attribute.
        attribute: &'static str,
        /// Index of the non-finite value in the attribute array.
        index: usize,
    },
}

/// Validated mesh: indices are in range, arrays have equal length, and each vertex has a normal.
///
/// Normals are unit vectors; a normal that was not finite is replaced by zero. Positions may be NaN or infinite; the
/// clipper rejects triangles that use them. All other numbers are finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    data: MeshData,
    bounds: Aabb,
    visible_bounds: Aabb,
    clusters: Clusters,
    lost_normals: usize,
    /// Indices of the triangles with a normal or texture coordinate that was not finite, in ascending order.
    broken: Vec<u32>,
}

impl Mesh {
    /// Creates a mesh, or returns an error if the arrays are invalid. Missing normals are computed by
    /// [`smooth_normals`].
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
        Ok(Self::of(data))
    }

    /// Creates a mesh like [`Mesh::new`], but repairs normals and texture coordinates that are not finite.
    ///
    /// A repaired normal is zero, so no direct light reaches its vertex. A repaired texture coordinate is (0, 1), which
    /// corresponds to `vt 0 0` in the file.
    pub(crate) fn repaired(mut data: MeshData) -> Result<Self, MeshError> {
        let lost_normals = data.normals.iter().filter(|normal| !normal.is_finite()).count();
        let lost_uvs = data.uvs.iter().filter(|uv| !uv.is_finite()).count();
        if lost_normals + lost_uvs == 0 {
            return Self::new(data);
        }
        let is_lost = |vertex: u32| {
            data.normals.get(vertex as usize).is_some_and(|normal| !normal.is_finite())
                || data.uvs.get(vertex as usize).is_some_and(|uv| !uv.is_finite())
        };
        let is_broken = |corners: &[u32; 3]| corners.iter().any(|vertex| is_lost(*vertex));
        let broken =
            (0..).zip(&data.triangles).filter(|(_, corners)| is_broken(corners)).map(|(number, _)| number).collect();
        data.normals.iter_mut().filter(|normal| !normal.is_finite()).for_each(|normal| *normal = Vec3::ZERO);
        data.uvs.iter_mut().filter(|uv| !uv.is_finite()).for_each(|uv| *uv = Vec2::Y);
        Ok(Self { lost_normals, broken, ..Self::new(data)? })
    }

    /// Creates a mesh from validated arrays.
    fn of(data: MeshData) -> Self {
        let bounds = finite_bounds(&data.positions);
        let visible_bounds = visible_bounds(data.positions.iter().copied());
        let clusters = Clusters::new(&data.positions, &data.triangles);
        Self { data, bounds, visible_bounds, clusters, lost_normals: 0, broken: Vec::new() }
    }

    /// Returns the number of vertices whose normal was not finite and was replaced by zero.
    pub(crate) fn lost_normals(&self) -> usize {
        self.lost_normals
    }

    /// Returns the indices of the triangles with a normal or texture coordinate that was not finite, in ascending
    /// order.
    pub(crate) fn broken_triangles(&self) -> &[u32] {
        &self.broken
    }

    /// Returns the bounding box of all vertices with finite positions, in model space.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Returns the bounding box for visibility tests, in model space: [`Mesh::bounds`], or [`Aabb::EVERYTHING`] if a
    /// position is NaN or infinite.
    pub(crate) fn visible_bounds(&self) -> Aabb {
        self.visible_bounds
    }

    /// Returns the clusters of the mesh for culling; empty for a small mesh.
    pub(crate) fn clusters(&self) -> &Clusters {
        &self.clusters
    }

    /// Returns the mesh mirrored in z, for models made for a coordinate system of the opposite handedness. Two corners
    /// of each triangle are swapped, so that front faces stay front faces.
    pub(crate) fn mirrored_z(&self) -> Self {
        let mut data = self.data.clone();
        for vector in data.positions.iter_mut().chain(&mut data.normals) {
            vector.z = -vector.z;
        }
        for triangle in &mut data.triangles {
            triangle.swap(1, 2);
        }
        Self { lost_normals: self.lost_normals, broken: self.broken.clone(), ..Self::of(data) }
    }

    /// Returns the mesh with other positions and normals, as many as before, and with the same triangles. Normals must be
    /// finite.
    pub(super) fn moved(&self, positions: Vec<Vec3>, normals: Vec<Vec3>) -> Self {
        assert!(positions.len() == self.positions.len() && normals.len() == self.normals.len());
        let MeshData { name, uvs, colors, triangles, .. } = self.data.clone();
        let data = MeshData { name, positions, normals, uvs, colors, triangles };
        Self {
            bounds: finite_bounds(&data.positions),
            visible_bounds: visible_bounds(data.positions.iter().copied()),
            clusters: self.clusters.moved(&data.positions, &data.triangles),
            lost_normals: self.lost_normals,
            broken: self.broken.clone(),
            data,
        }
    }

    /// Returns the heap memory used by the arrays and clusters, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let MeshData { name: _, positions, normals, uvs, colors, triangles } = &self.data;
        (positions.capacity() + normals.capacity() + colors.capacity()) * size_of::<Vec3>()
            + uvs.capacity() * size_of::<Vec2>()
            + triangles.capacity() * size_of::<[u32; 3]>()
            + self.clusters.bytes()
    }
}

/// Returns the bounding box of the finite positions.
fn finite_bounds(positions: &[Vec3]) -> Aabb {
    Aabb::around(positions.iter().copied().filter(|position| position.is_finite()))
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

/// Computes one normal per vertex: the mean of the normals of its triangles, weighted by area.
///
/// The sums are in f64 and are divided by their largest component before the length is computed, so that huge triangles
/// do not overflow and tiny ones do not vanish. A vertex without a triangle of positive area gets the normal +z.
pub(crate) fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
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
    fn mirroring_keeps_front_faces_and_mirroring_twice_restores_the_mesh() {
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
    fn normals_that_are_not_finite_are_refused_or_repaired_and_counted() {
        let normals = vec![Vec3::Z, Vec3::NAN, Vec3::new(0.0, f32::INFINITY, 0.0)];
        let data = MeshData { normals, ..triangle() };
        assert!(matches!(Mesh::new(data.clone()), Err(MeshError::NotFinite { attribute: "normals", index: 1 })));
        let mesh = Mesh::repaired(data).unwrap();
        assert_eq!((mesh.normals.as_slice(), mesh.lost_normals()), ([Vec3::Z, Vec3::ZERO, Vec3::ZERO].as_slice(), 2));
        assert_eq!(mesh.mirrored_z().lost_normals(), 2);
    }

    #[test]
    fn triangles_with_repaired_attributes_are_listed() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE, Vec3::Z].to_vec();
        let triangles = vec![[0, 1, 2], [1, 3, 2], [0, 1, 4], [0, 2, 4]];
        let data = MeshData { positions, triangles, normals: vec![Vec3::Z; 5], ..MeshData::default() };
        for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (mut uvs, mut normals) = (vec![Vec2::ONE; 5], data.normals.clone());
            assert!(
                Mesh::repaired(MeshData { uvs: uvs.clone(), ..data.clone() }).unwrap().broken_triangles().is_empty()
            );
            uvs[3].x = broken;
            normals[4].y = broken;
            let mesh = Mesh::repaired(MeshData { uvs, normals, ..data.clone() }).unwrap();
            assert_eq!((mesh.broken_triangles(), mesh.uvs[3]), ([1, 2, 3].as_slice(), Vec2::Y));
            assert_eq!(mesh.mirrored_z().broken_triangles(), [1, 2, 3]);
        }
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
