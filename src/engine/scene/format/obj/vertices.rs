//! Conversion of face corners, which refer to three lists, to meshes with one index per vertex.
//!
//! OBJ indexes positions, texture coordinates and normals separately; a mesh has one index for all. Corners of one part
//! that agree in all three indices become one vertex, numbered in order of first use. The numbering matches that of the
//! crate `tobj`, with which the tests compare it.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::attributes::AttributeLists;
use super::faces::{FaceCorner, Faces, MeshPart, NONE};
use crate::scene::load::{Load, bytes_of};
use crate::scene::{MeshData, SceneError};

/// Number of triangles between progress reports.
const TRIANGLES_PER_REPORT: usize = 1 << 14;

/// Minimum number of vertices at one position for which a hash map replaces the linear search.
const CROWD: usize = 16;

/// Returns the meshes of all parts, in the order of the parts. The names of the meshes are empty.
///
/// # Errors
/// Returns an error if the load is cancelled or memory does not suffice.
pub(super) fn meshes(lists: &AttributeLists, faces: &Faces, load: &mut Load<'_>) -> Result<Vec<MeshData>, Stopped> {
    let mut numbering = Numbering::default();
    load.reserve(&mut numbering.newest, lists.positions.len())?;
    numbering.newest.resize(lists.positions.len(), NONE);
    let mut meshes = Vec::new();
    let mut done = 0;
    for part in &faces.parts {
        let triangles = numbering.triangles(faces, part, &mut done, load)?;
        let mesh = numbering.mesh(lists, triangles, load)?;
        load.push(&mut meshes, mesh)?;
        numbering.clear();
    }
    load.free(numbering.newest);
    load.free(numbering.vertices);
    load.release(numbering.crowded_bytes);
    Ok(meshes)
}

/// Reason why a step of the load ended early.
#[derive(Debug)]
pub(super) enum Stopped {
    /// The memory did not suffice; the message is one sentence.
    Memory(String),
    /// The load was cancelled.
    Cancelled(SceneError),
}

impl From<String> for Stopped {
    fn from(reason: String) -> Self {
        Self::Memory(reason)
    }
}

impl From<SceneError> for Stopped {
    fn from(error: SceneError) -> Self {
        Self::Cancelled(error)
    }
}

/// Vertex numbering of one part.
#[derive(Default)]
struct Numbering {
    /// Index of the most recent vertex at each position; [`NONE`] if there is none.
    newest: Vec<u32>,
    vertices: Vec<NumberedVertex>,
    /// Indices of the vertices at positions with at least [`CROWD`] vertices, by face corner.
    crowded: HashMap<FaceCorner, u32>,
    crowded_bytes: u64,
}

#[derive(Clone, Copy)]
struct NumberedVertex {
    corner: FaceCorner,
    /// Index of the previous vertex at the same position; [`NONE`] if there is none.
    older: u32,
}

impl Numbering {
    /// Numbers the vertices of a part, and returns its triangles. `done` counts the triangles of all parts so far.
    fn triangles(
        &mut self,
        faces: &Faces,
        part: &MeshPart,
        done: &mut usize,
        load: &mut Load<'_>,
    ) -> Result<Vec<[u32; 3]>, Stopped> {
        let mut triangles = Vec::new();
        let count = part.runs.iter().map(ExactSizeIterator::len).sum();
        load.reserve(&mut triangles, count)?;
        for triangle in part.runs.iter().flat_map(|run| &faces.triangles[run.clone()]) {
            if done.is_multiple_of(TRIANGLES_PER_REPORT) {
                load.advance(*done as f32 / faces.triangles.len() as f32)?;
            }
            *done += 1;
            let mut numbers = [0; 3];
            for (number, corner) in numbers.iter_mut().zip(triangle) {
                *number = self.number(*corner, load)?;
            }
            triangles.push(numbers);
        }
        Ok(triangles)
    }

    /// Returns the mesh of the numbered vertices, without a name.
    fn mesh(&self, lists: &AttributeLists, triangles: Vec<[u32; 3]>, load: &mut Load<'_>) -> Result<MeshData, Stopped> {
        let corners = || self.vertices.iter().map(|vertex| vertex.corner);
        let has_uvs = corners().next().is_some_and(|corner| corner.uv != NONE);
        let has_colors = corners().any(|c| lists.colors.get(c.position as usize).is_some_and(|c| *c != Vec3::ONE));
        let attributes_bytes = size_of::<Vec3>() * 2
            + if has_uvs { size_of::<Vec2>() } else { 0 }
            + if has_colors { size_of::<Vec3>() } else { 0 };
        load.charge(bytes_of::<u8>(attributes_bytes * self.vertices.len()))?;
        Ok(MeshData {
            name: String::new(),
            positions: corners().map(|corner| lists.positions[corner.position as usize]).collect(),
            normals: corners().map(|corner| lists.normals[corner.normal as usize]).collect(),
            // v points up in the file and down in a mesh.
            uvs: if has_uvs {
                corners().map(|corner| lists.uvs[corner.uv as usize]).map(|uv| Vec2::new(uv.x, 1.0 - uv.y)).collect()
            } else {
                Vec::new()
            },
            colors: if has_colors {
                corners().map(|corner| lists.colors[corner.position as usize]).collect()
            } else {
                Vec::new()
            },
            triangles,
        })
    }

    /// Returns the index of the vertex with this corner's attributes, and adds the vertex if it is new.
    fn number(&mut self, corner: FaceCorner, load: &mut Load<'_>) -> Result<u32, String> {
        let newest = self.newest[corner.position as usize];
        let (mut older, mut compared) = (newest, 0);
        while older != NONE && compared < CROWD {
            let vertex = &self.vertices[older as usize];
            if vertex.corner == corner {
                return Ok(older);
            }
            older = vertex.older;
            compared += 1;
        }
        let new = self.vertices.len() as u32;
        if compared == CROWD {
            if older == NONE {
                self.note_crowd(newest);
            }
            if let Some(known) = self.crowded.get(&corner) {
                return Ok(*known);
            }
            let bytes = bytes_of::<(FaceCorner, u32)>(2);
            load.charge(bytes)?;
            self.crowded_bytes += bytes;
            self.crowded.insert(corner, new);
        }
        load.push(&mut self.vertices, NumberedVertex { corner, older: newest })?;
        self.newest[corner.position as usize] = new;
        Ok(new)
    }

    /// Adds every vertex at the position of `newest` to the hash map. Called when a position reaches [`CROWD`]
    /// vertices.
    fn note_crowd(&mut self, newest: u32) {
        let mut number = newest;
        while number != NONE {
            let NumberedVertex { corner, older } = self.vertices[number as usize];
            self.crowded.insert(corner, number);
            number = older;
        }
    }

    /// Removes all vertices, so that the numbering can be reused for the next part of the file.
    fn clear(&mut self) {
        for vertex in &self.vertices {
            self.newest[vertex.corner.position as usize] = NONE;
        }
        self.vertices.clear();
        self.crowded.clear();
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;
    use std::path::Path;

    use super::super::attributes::tests::unlimited;
    use super::super::{attributes, faces};
    use super::*;
    use crate::scene::warnings::Warnings;

    /// Reads the OBJ text with this module and with `tobj`, and returns the meshes of both.
    fn both(text: &str) -> (Vec<MeshData>, Vec<tobj::Mesh>) {
        let path = Path::new("a.obj");
        let (mut warnings, mut load) = (Warnings::default(), unlimited(path));
        let mut lists = attributes::read(path, text, &mut warnings, &mut load).unwrap();
        let faces = faces::read(path, text, &mut lists, &mut warnings, &mut load).unwrap();
        let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
        let (models, _) =
            tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| tobj::MTLLoadResult::Ok(Default::default()))
                .unwrap();
        (meshes(&lists, &faces, &mut load).unwrap(), models.into_iter().map(|model| model.mesh).collect())
    }

    #[test]
    fn vertices_match_those_of_tobj() {
        let mut random = fastrand::Rng::with_seed(3);
        // Few positions with many normals create crowded positions; many positions with few faces create none.
        for (positions, others, triangles) in [(3, 2, 50), (5, 60, 3000), (500, 3, 400), (40, 40, 2000)] {
            let mut text = String::new();
            for i in 0..positions {
                let height = random.i32(-50..50);
                writeln!(text, "v {i} {} {height} 0.5 {} 1", i * i, f32::from(random.bool())).unwrap();
            }
            for i in 0..others {
                writeln!(text, "vt 0.{i} 0.25\nvn {} 0 0", if i % 2 == 0 { 1 } else { -1 }).unwrap();
            }
            for object in 0..3 {
                writeln!(text, "o {object}").unwrap();
                for _ in 0..triangles {
                    let first = random.usize(0..positions - 2);
                    text.push('f');
                    for corner in first..first + 3 {
                        write!(text, " {}/{}/{}", corner + 1, random.usize(0..others) + 1, random.usize(0..others) + 1)
                            .unwrap();
                    }
                    text.push('\n');
                }
            }
            let (own, expected) = both(&text);
            assert_eq!(own.len(), 3);
            for (own, expected) in own.iter().zip(&expected) {
                assert_eq!(own.triangles.as_flattened(), expected.indices);
                let positions: Vec<f32> = own.positions.iter().flat_map(Vec3::to_array).collect();
                assert_eq!(positions, expected.positions);
                let normals: Vec<f32> = own.normals.iter().flat_map(Vec3::to_array).collect();
                assert_eq!(normals, expected.normals);
                let uvs: Vec<f32> = own.uvs.iter().flat_map(|uv| [uv.x, 1.0 - uv.y]).collect();
                assert_eq!(
                    uvs,
                    expected
                        .texcoords
                        .as_chunks::<2>()
                        .0
                        .iter()
                        .flat_map(|[u, v]| [*u, 1.0 - (1.0 - v)])
                        .collect::<Vec<_>>()
                );
                let colors: Vec<f32> = own.colors.iter().flat_map(Vec3::to_array).collect();
                assert_eq!(colors, expected.vertex_color);
            }
        }
    }

    #[test]
    fn a_position_with_a_hundred_thousand_normals_takes_no_quadratic_time() {
        let count = 100_000;
        let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
        for i in 1..=count {
            writeln!(text, "vn 0 0 1\nf 1//{i} 2//{i} 3//{i}").unwrap();
        }
        let (own, _) = both(&text);
        assert_eq!(own[0].positions.len(), 3 * count);
    }
}
