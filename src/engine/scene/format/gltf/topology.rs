//! Triangles of a primitive: lists, strips and fans of indices.

use gltf_json::mesh::Mode;

use super::Failure;
use crate::scene::load::Load;

/// Returns the triangles of `count` indices; `index` returns the index at a place. Triangles of a strip alternate in
/// their winding, so that all of them face the same side.
///
/// Returns `None` for points and lines.
pub(super) fn triangles(
    mode: Mode,
    count: usize,
    index: impl Fn(usize) -> u32,
    load: &mut Load<'_>,
) -> Result<Option<Vec<[u32; 3]>>, Failure> {
    let number = match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return Ok(None),
        Mode::Triangles => count / 3,
        Mode::TriangleStrip | Mode::TriangleFan => count.saturating_sub(2),
    };
    let mut triangles = Vec::new();
    load.reserve(&mut triangles, number)?;
    for i in 0..number {
        load.work(1, || 1.0)?;
        let places = match mode {
            Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
            Mode::TriangleFan => [i + 1, i + 2, 0],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        };
        triangles.push(places.map(&index));
    }
    Ok(Some(triangles))
}

/// Returns the plural of the primitives that `mode` draws.
pub(super) fn name(mode: Mode) -> &'static str {
    match mode {
        Mode::Points => "points",
        Mode::Lines | Mode::LineLoop | Mode::LineStrip => "lines",
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan => "triangles",
    }
}
