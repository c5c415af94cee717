//! Vertices of a primitive: which of the file it reads, and their attributes.

use gltf_json::accessor::Type;
use gltf_json::{Index, accessor};

use super::Failure;
use super::accessors::{Accessors, Elements};
use crate::scene::load::Load;

/// Number of elements that are read between progress reports, in units of [`Load::work`].
const WORK_PER_VERTEX: usize = 1;

/// Returns an attribute, which must have as many elements as there are vertices.
pub(super) fn matching<'a>(
    accessors: &mut Accessors<'a>,
    index: Index<accessor::Accessor>,
    types: &[Type],
    vertices: usize,
) -> Result<Elements<'a>, String> {
    let elements = accessors.get(index, types)?;
    if elements.count() != vertices {
        let count = elements.count();
        return Err(format!("accessors[{}]: it has {count} elements for {vertices} vertices", index.value()));
    }
    Ok(elements)
}

/// Vertices of the file that a primitive reads, in the order of the mesh.
pub(super) enum Vertices {
    /// The first vertices of the file, as many as given.
    All(usize),
    /// Indices of vertices of the file.
    Some(Vec<u32>),
}

impl Vertices {
    /// Chooses the vertices for the triangles, and renumbers their corners. If `are_apart`, each triangle gets vertices
    /// of its own. If the file has more vertices than the triangles have corners, the unused ones are left out.
    pub(super) fn choose(
        triangles: &mut [[u32; 3]],
        count: usize,
        are_apart: bool,
        load: &mut Load<'_>,
    ) -> Result<Self, String> {
        let corners = triangles.as_flattened_mut();
        if !are_apart && count <= corners.len() {
            return Ok(Self::All(count));
        }
        let mut vertices = Vec::new();
        load.reserve(&mut vertices, corners.len())?;
        vertices.extend_from_slice(corners);
        if are_apart {
            corners.iter_mut().zip(0..).for_each(|(corner, number)| *corner = number);
        } else {
            vertices.sort_unstable();
            vertices.dedup();
            for corner in corners {
                *corner = vertices.partition_point(|vertex| vertex < corner) as u32;
            }
        }
        Ok(Self::Some(vertices))
    }

    /// Reads an attribute of the vertices. `make` converts the components of an element.
    pub(super) fn read<T, const N: usize>(
        &self,
        elements: &Elements<'_>,
        load: &mut Load<'_>,
        make: impl Fn([f32; N]) -> T,
    ) -> Result<Vec<T>, Failure> {
        let count = match self {
            Self::All(count) => *count,
            Self::Some(vertices) => vertices.len(),
        };
        let mut values = Vec::new();
        load.reserve(&mut values, count)?;
        for place in 0..count {
            load.work(WORK_PER_VERTEX, || 1.0)?;
            let vertex = match self {
                Self::All(_) => place,
                Self::Some(vertices) => vertices[place] as usize,
            };
            values.push(make(elements.vector(vertex)));
        }
        Ok(values)
    }
}
