//! Triangle that was drawn last at a playback position, and the silhouette of its object.

use std::collections::HashMap;
use std::sync::Arc;

use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::scene::TriangleId;

/// Maximum number of triangles of an object whose silhouette is computed, which takes about 50 ms.
const MAX_TRIANGLES: usize = 200_000;

/// Triangle that was drawn last at a playback position.
#[derive(Clone, Debug, PartialEq)]
pub struct LastTriangle {
    /// Scene triangle. Several triangles in a row have the same id if they are pieces of a clipped triangle.
    pub id: TriangleId,
    /// Index of the instance that the triangle belongs to.
    pub instance: u32,
    /// Corners, in pixels of the full picture.
    pub corners_px: [[f32; 2]; 3],
    /// Silhouette of the instance as line segments, in pixels of the full picture. It includes triangles that are not
    /// drawn yet, and parts that other surfaces hide.
    pub silhouette: Arc<Vec<[[f32; 2]; 2]>>,
}

/// Numbers of triangles that share an edge, by facing.
#[derive(Clone, Copy, Debug)]
struct EdgeUse {
    ends_px: [[f32; 2]; 2],
    front: u32,
    back: u32,
}

impl EdgeUse {
    /// Whether the edge separates the object from the background, or a front-facing triangle from a back-facing one.
    fn is_silhouette(&self) -> bool {
        self.front + self.back == 1 || (self.front == 1 && self.back == 1)
    }
}

/// Returns the silhouette of an object with these rasterized triangles: the edges that only one of them has, or that
/// lie between a front-facing and a back-facing one. `scale` converts positions of the triangles to pixels of the full
/// picture. Returns an empty list if the object has more than [`MAX_TRIANGLES`] triangles.
pub(super) fn silhouette<'a>(
    triangles: impl Iterator<Item = &'a ScreenTriangle>,
    scale: [f32; 2],
) -> Vec<[[f32; 2]; 2]> {
    let mut places = HashMap::new();
    let mut edges: Vec<EdgeUse> = Vec::new();
    for (count, triangle) in triangles.enumerate() {
        if count == MAX_TRIANGLES {
            return Vec::new();
        }
        let [a, b, c] = &triangle.vertices;
        let is_front = is_clockwise(triangle.corners_px());
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from_key, to_key) = (key(from), key(to));
            let place = *places.entry((from_key.min(to_key), from_key.max(to_key))).or_insert(edges.len());
            if place == edges.len() {
                let ends_px = [from, to].map(|vertex| scaled(vertex.position_px, scale));
                edges.push(EdgeUse { ends_px, front: 0, back: 0 });
            }
            edges[place].front += u32::from(is_front);
            edges[place].back += u32::from(!is_front);
        }
    }
    edges.iter().filter(|edge| edge.is_silhouette()).map(|edge| edge.ends_px).collect()
}

/// Returns a position in px, multiplied by `scale`.
pub(super) fn scaled([x, y]: [f32; 2], scale: [f32; 2]) -> [f32; 2] {
    [x * scale[0], y * scale[1]]
}

/// Identifies a vertex by its position: vertices of adjacent triangles may differ in their attributes.
fn key(vertex: &ScreenVertex) -> (i32, i32, u64) {
    (vertex.x, vertex.y, vertex.depth.to_bits())
}

/// Whether corners in px, with y down, are in clockwise order on the screen.
fn is_clockwise([a, b, c]: [[f32; 2]; 3]) -> bool {
    let [ab, ac] = [b, c].map(|p| [f64::from(p[0]) - f64::from(a[0]), f64::from(p[1]) - f64::from(a[1])]);
    ab[0] * ac[1] - ab[1] * ac[0] > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Recipe, run};
    use crate::inspect::scrub::{Moment, Scrubber};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    fn scrubber(set: &[&str]) -> Scrubber {
        let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
        let mut recipe = Recipe::default();
        recipe.set_all(set).unwrap();
        let frame = run(&scene, &scene.home, &recipe, Viewport { width: 96, height: 64 }, &mut ());
        Scrubber::new(&scene, &recipe, &frame, 0)
    }

    #[test]
    fn the_silhouette_of_a_cube_is_a_hexagon_with_and_without_culling() {
        for culling in ["back", "none"] {
            let scrubber = scrubber(&[&format!("culling={culling}")]);
            let last = scrubber.last_triangle(Moment::after(1), [1.0; 2], None).unwrap();
            let ends = |end: usize| last.silhouette.iter().map(move |line| line[end].map(f32::to_bits));
            assert_eq!(last.silhouette.len(), 6, "culling={culling}");
            let (mut from, mut to): (Vec<_>, Vec<_>) = (ends(0).collect(), ends(1).collect());
            if culling == "back" {
                from.sort_unstable();
                to.sort_unstable();
                assert_eq!(from, to, "the lines form a closed outline");
            }
        }
    }

    #[test]
    fn positions_are_scaled_to_the_full_picture() {
        let scrubber = scrubber(&[]);
        let [one, two] = [1.0, 2.0].map(|s| scrubber.last_triangle(Moment::after(3), [s; 2], None).unwrap());
        assert_eq!(two.corners_px, one.corners_px.map(|corner| corner.map(|value| 2.0 * value)));
        assert_eq!(two.silhouette[0], one.silhouette[0].map(|corner| corner.map(|value| 2.0 * value)));
        assert_eq!(one.id, scrubber.geometry().triangles[2].id);
        assert_eq!(scrubber.last_triangle(Moment::after(0), [1.0; 2], None), None);
    }
}
