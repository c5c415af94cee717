//! Shared edges of triangles, and the edges of a triangle near a pixel.

use std::collections::HashMap;

use crate::pipeline::raster::{AnyTriangle, doubled_area};
use crate::pipeline::settings::{Arithmetic, FillRule};

/// Maximum distance by which a rasterizer moves an edge, in px. The published rasterizers test the pixel's corner
/// instead of its centre. They also round both ends of a span towards the start of the row, and the middle corner of a
/// triangle to whole pixels.
const REACH_PX: f64 = 2.0;

/// Key of an edge: its instance, and the bit patterns of its endpoints in an order that does not depend on the
/// triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct EdgeEnds {
    instance: u32,
    bits: [[u32; 2]; 2],
}

/// An edge of a triangle, and the side of the edge on which the triangle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SidedEdge {
    ends: EdgeEnds,
    side: EdgeSide,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EdgeSide {
    One,
    Other,
}

impl EdgeSide {
    fn opposite(self) -> Self {
        match self {
            Self::One => Self::Other,
            Self::Other => Self::One,
        }
    }
}

/// Returns the edges of a triangle, each opposite to the corner with the same index; empty if the triangle has no area.
pub(super) fn edges_of(instance: u32, corners_px: [[f32; 2]; 3]) -> Vec<SidedEdge> {
    (0..3).filter_map(|opposite| edge(instance, corners_px, opposite)).collect()
}

fn edge(instance: u32, corners_px: [[f32; 2]; 3], opposite: usize) -> Option<SidedEdge> {
    // Adding zero turns −0 into 0, which is the same position.
    let bits = |corner: [f32; 2]| corner.map(|c| (c + 0.0).to_bits());
    let (from, to) = (corners_px[(opposite + 1) % 3], corners_px[(opposite + 2) % 3]);
    let [from, to] = if bits(from) <= bits(to) { [from, to] } else { [to, from] };
    let (area, _) = doubled_area(Arithmetic::Exact, [from, to, corners_px[opposite]]);
    let side = if area == 0.0 { None } else { Some(if area > 0.0 { EdgeSide::One } else { EdgeSide::Other }) }?;
    Some(SidedEdge { ends: EdgeEnds { instance, bits: [bits(from), bits(to)] }, side })
}

/// Returns the edge of a triangle that is nearest to a pixel's centre, or several edges if they are equally near. The
/// centre must lie inside the triangle. Returns no edge if all are farther away than [`REACH_PX`].
pub(super) fn edges_near(instance: u32, corners_px: [[f32; 2]; 3], pixel: (u32, u32)) -> Vec<SidedEdge> {
    let Some(triangle) = AnyTriangle::new(Arithmetic::Exact, corners_px, FillRule::TopLeft) else { return Vec::new() };
    let sample = triangle.sample(pixel);
    let (_, scale) = doubled_area(Arithmetic::Exact, corners_px);
    let distances_px = [0, 1, 2].map(|opposite| {
        let (from, to) = (corners_px[(opposite + 1) % 3], corners_px[(opposite + 2) % 3]);
        let along = [0, 1].map(|axis| f64::from(to[axis]) - f64::from(from[axis]));
        sample.edges[opposite] / scale / along[0].hypot(along[1])
    });
    let nearest_px = distances_px.into_iter().fold(REACH_PX, f64::min);
    (0..3).filter(|i| distances_px[*i] <= nearest_px).filter_map(|i| edge(instance, corners_px, i)).collect()
}

/// Map from edges to the first recorded triangle on each side.
#[derive(Default)]
pub(super) struct EdgeTriangles(HashMap<EdgeEnds, [Option<usize>; 2]>);

impl EdgeTriangles {
    /// Whether no edge is recorded.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Records an edge with no triangle on either side, unless it is already recorded.
    pub(super) fn expect(&mut self, edge: SidedEdge) {
        self.0.entry(edge.ends).or_default();
    }

    /// Records a triangle on its side of an edge, and the edge itself if necessary.
    pub(super) fn add(&mut self, edge: SidedEdge, triangle: usize) {
        self.expect(edge);
        self.add_expected(edge, triangle);
    }

    /// Records a triangle on its side of an edge, but only if the edge is already recorded.
    pub(super) fn add_expected(&mut self, edge: SidedEdge, triangle: usize) {
        if let Some(sides) = self.0.get_mut(&edge.ends) {
            sides[edge.side as usize].get_or_insert(triangle);
        }
    }

    /// Returns the first triangle recorded on the other side of an edge; `None` if there is none.
    pub(super) fn across(&self, edge: SidedEdge) -> Option<usize> {
        self.0.get(&edge.ends)?[edge.side.opposite() as usize]
    }
}
