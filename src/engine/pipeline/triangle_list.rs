//! List of screen triangles that shares memory with its clones and stores a bounding box per triangle.
//!
//! When a single pixel is drawn, nearly all triangles are rejected by reading only their boxes.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use super::pixel_box::{PixelBox, box_around};
use super::screen_triangle::ScreenTriangle;

/// List of screen triangles, readable as a slice. Cloning and truncating take constant time, because all clones share
/// the memory.
#[derive(Clone, Debug, Default)]
pub struct TriangleList {
    all: Arc<Vec<ScreenTriangle>>,
    /// Number of triangles in this list, which are the first ones of `all`.
    len: usize,
    /// Bounding box of each triangle; `None` until [`TriangleList::find_boxes`] computes them.
    boxes: Option<Arc<[PixelBox]>>,
}

impl TriangleList {
    /// Truncates the list to its first `len` triangles, if there are more.
    pub(crate) fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }

    /// Removes all triangles.
    #[cfg(test)]
    pub(crate) fn clear(&mut self) {
        self.truncate(0);
    }

    /// Computes the bounding boxes of all triangles.
    pub(crate) fn find_boxes(&mut self) {
        self.boxes = Some(self.iter().map(|triangle| box_around(triangle.corners_px())).collect());
    }

    /// Returns the bounding box of the triangle at index `place`. Computes it if boxes are not stored.
    pub(crate) fn box_of(&self, place: usize) -> PixelBox {
        let found = self.boxes.as_ref().map(|boxes| boxes[place]);
        found.unwrap_or_else(|| box_around(self[place].corners_px()))
    }

    /// Returns the triangles as a vector, copied if other lists share the memory.
    pub(crate) fn into_vec(self) -> Vec<ScreenTriangle> {
        let mut all = Arc::unwrap_or_clone(self.all);
        all.truncate(self.len);
        all
    }
}

impl From<Vec<ScreenTriangle>> for TriangleList {
    fn from(all: Vec<ScreenTriangle>) -> Self {
        Self { len: all.len(), all: Arc::new(all), boxes: None }
    }
}

impl Deref for TriangleList {
    type Target = [ScreenTriangle];

    fn deref(&self) -> &[ScreenTriangle] {
        &self.all[..self.len]
    }
}

/// Mutable access: copies the triangles if other lists share the memory, and discards the boxes.
impl DerefMut for TriangleList {
    fn deref_mut(&mut self) -> &mut [ScreenTriangle] {
        self.boxes = None;
        &mut Arc::make_mut(&mut self.all)[..self.len]
    }
}

impl<'a> IntoIterator for &'a mut TriangleList {
    type Item = &'a mut ScreenTriangle;
    type IntoIter = std::slice::IterMut<'a, ScreenTriangle>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl<'a> IntoIterator for &'a TriangleList {
    type Item = &'a ScreenTriangle;
    type IntoIter = std::slice::Iter<'a, ScreenTriangle>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::clip_space::Varyings;
    use crate::pipeline::depth::DepthScale;
    use crate::pipeline::screen_triangle::TriangleOwner;
    use crate::pipeline::screen_vertex::ScreenVertex;
    use crate::scene::TriangleId;

    fn triangle(id: u32) -> ScreenTriangle {
        let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
        let corners = corners.map(|corner| ScreenVertex::at(corner, 0.5, 1.0, Varyings::default()));
        ScreenTriangle::new(
            TriangleOwner { id: TriangleId(id), instance: 0 },
            corners,
            16.0,
            &DepthScale::default(),
            false,
        )
    }

    #[test]
    fn the_first_share_memory_with_all_until_they_are_changed() {
        let mut all = TriangleList::from(vec![triangle(0), triangle(1), triangle(2)]);
        all.find_boxes();
        let mut first = all.clone();
        first.truncate(2);
        assert_eq!((all.len(), first.len(), first.as_ptr()), (3, 2, all.as_ptr()));
        first[0].id = TriangleId(7);
        assert_eq!((all[0].id, first[0].id), (TriangleId(0), TriangleId(7)));
        let moved = [[1.0, 2.0], [3.0, 0.5], [-1.0, 1.5]].map(|at| ScreenVertex::at(at, 0.5, 1.0, Varyings::default()));
        first[1].vertices = moved;
        assert_eq!((first.box_of(1), all.box_of(1)), ([-1.0, 3.0, 0.5, 2.0], [0.0, 4.0, 0.0, 4.0]));
        first.find_boxes();
        assert_eq!(first.box_of(1), [-1.0, 3.0, 0.5, 2.0]);
        first.truncate(9);
        assert_eq!(first.into_vec().iter().map(|t| t.id.0).collect::<Vec<_>>(), [7, 1]);
    }
}
