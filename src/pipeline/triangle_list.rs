//! A list of triangles that many may hold, whole or only its first.

use std::ops::Deref;
use std::sync::Arc;

use super::viewport::ScreenTriangle;

/// Triangles on the screen, read as a slice. A copy costs nothing, and neither does one that ends earlier: all of them share
/// the memory.
#[derive(Clone, Debug, Default)]
pub struct TriangleList {
    all: Arc<Vec<ScreenTriangle>>,
    /// How many of them are in this list.
    len: usize,
}

impl TriangleList {
    /// Keeps the first `len` alone, if there are more.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }

    /// The triangles, in memory of their own if others hold them too.
    pub fn into_vec(self) -> Vec<ScreenTriangle> {
        let mut all = Arc::unwrap_or_clone(self.all);
        all.truncate(self.len);
        all
    }
}

impl From<Vec<ScreenTriangle>> for TriangleList {
    fn from(all: Vec<ScreenTriangle>) -> Self {
        Self { len: all.len(), all: Arc::new(all) }
    }
}

impl Deref for TriangleList {
    type Target = [ScreenTriangle];

    fn deref(&self) -> &[ScreenTriangle] {
        &self.all[..self.len]
    }
}

impl<'a> IntoIterator for &'a TriangleList {
    type Item = &'a ScreenTriangle;
    type IntoIter = std::slice::Iter<'a, ScreenTriangle>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
