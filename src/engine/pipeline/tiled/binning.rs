//! Culling and binning: finds the triangles that may be visible, and the tiles that each of them overlaps.
//!
//! Triangles are processed in chunks, in submission order. Each chunk culls eight triangles at a time and sorts the
//! survivors by tile. Chunks run in parallel.

use std::ops::Range;

use rayon::prelude::*;

use super::bins::{CHUNK, Chunk, ChunkPart, TileRange, TriangleKey};
use super::geometry::{Arrays, InstanceDraw};
use super::lattice::TileLattice;
use super::layout::{TILE, TileGrid};
use super::outcode::{ClipVerdict, Outcode};
use super::packed::{PackedSurface, PackedVertex};
use crate::math::lanes::*;
use crate::pipeline::Geometry;
use crate::pipeline::clip_space::Varyings;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::geometry_stages::{ClipSpaceDraw, GeometryStages};
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::settings::{Culling, Settings};
use crate::pipeline::viewport::Viewport;
use crate::scene::TriangleId;

/// Inputs of binning that are common to all triangles of a frame.
pub(super) struct Binning<'a> {
    pub(super) draws: &'a [InstanceDraw<'a>],
    pub(super) arrays: &'a Arrays,
    pub(super) settings: &'a Settings,
    pub(super) viewport: Viewport,
    pub(super) scale: DepthScale,
    pub(super) lattice: TileLattice,
    /// Width and height, in samples, of the packed picture, which holds only the drawn samples.
    pub(super) packed: (u32, u32),
    pub(super) tiles: TileGrid,
}

impl Binning<'_> {
    /// Culls and bins all triangles into `chunks`, whose memory is reused.
    pub(super) fn run(&self, lanes: Lanes, chunks: &mut Vec<Chunk>) {
        self.split_into_chunks(chunks);
        chunks.par_iter_mut().with_max_len(1).for_each(|chunk| {
            for part in 0..chunk.parts.len() {
                let ChunkPart { draw, ids } = chunk.parts[part].clone();
                on_lanes!(lanes, simd => self.cull(simd, draw, ids, chunk));
            }
            chunk.sort(self.tiles);
        });
    }

    /// Divides the triangles that remain after cluster culling into chunks.
    fn split_into_chunks(&self, chunks: &mut Vec<Chunk>) {
        chunks.iter_mut().for_each(Chunk::clear);
        let (mut number, mut room) = (0, CHUNK as u32);
        let draws = self.draws.iter().enumerate();
        for (index, draw, own) in
            draws.flat_map(|(index, draw)| draw.kept.triangles.as_slice().iter().map(move |own| (index, draw, own)))
        {
            let (mut first, end) = (draw.first.0 + own.start as u32, draw.first.0 + own.end as u32);
            while first < end {
                if chunks.len() <= number {
                    chunks.push(Chunk::new(number));
                }
                let take = room.min(end - first);
                chunks[number].parts.push(ChunkPart { draw: index, ids: first..first + take });
                first += take;
                room -= take;
                if room == 0 {
                    (number, room) = (number + 1, CHUNK as u32);
                }
            }
        }
        chunks.truncate(number + usize::from(room < CHUNK as u32));
    }

    /// Culls a range of triangles of one draw, and appends those that may be visible to a chunk.
    #[inline(always)]
    fn cull<S: Simd>(&self, simd: S, draw: usize, ids: Range<u32>, chunk: &mut Chunk) {
        let leaves_frustum = self.arrays.leaves_frustum[draw];
        let draw = &self.draws[draw];
        let offset = (ids.start - draw.first.0) as usize;
        let triangles = &draw.mesh.triangles[offset..offset + ids.len()];
        let own = draw.first_vertex..draw.first_vertex + draw.mesh.positions.len();
        let vertices = &self.arrays.vertices[own.clone()];
        let outcodes = if leaves_frustum { &self.arrays.outcodes[own] } else { &[] };
        let mut padded = [[0; 3]; LANES];
        for (first_id, group) in ids.step_by(LANES).zip(triangles.chunks(LANES)) {
            let corners = match group.as_array() {
                Some(corners) => corners,
                None => {
                    padded[..group.len()].copy_from_slice(group);
                    &padded
                }
            };
            let (mut whole, mut cut) = (u64::MAX, 0);
            if leaves_frustum {
                (whole, cut) = crossings(outcodes, group);
                if whole | cut == 0 {
                    continue;
                }
            }
            // Excludes the padding lanes. All three vertices of a padding lane are vertex 0 of the draw, so its area is
            // zero, or NaN if the screen position of that vertex is NaN.
            whole &= u64::from(u32::MAX) >> (u32::BITS as usize - group.len());
            let positions = corner_positions(simd, vertices, corners);
            let (shown, alive, tiles) = self.cull_lanes(simd, positions, whole, draw.plan.culling());
            chunk.rasterized += shown.count_ones() as usize;
            let count = alive.count_ones();
            if cut != 0 {
                let tiles = tiles.to_array();
                for (lane, corners) in group.iter().enumerate() {
                    let id = first_id + lane as u32;
                    if cut >> lane & 1 != 0 {
                        self.cut(draw, id, *corners, chunk);
                    } else if alive >> lane & 1 != 0 {
                        chunk.survivors.push(TriangleKey(id), TileRange(tiles[lane] as u32));
                    }
                }
            } else if count != 0 {
                let keys = i32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]) + first_id as i32;
                chunk.survivors.push_lanes(keys, tiles, mask32x8::from_bitmask(simd, alive), count);
            }
        }
    }

    /// Culls eight triangles, given by the positions of their corners. Those that `whole` does not select are always
    /// culled. Returns the bit mask of the triangles that pass face culling, the bit mask of the triangles that also
    /// may cover a sample, and the tile range of each triangle.
    #[inline(always)]
    fn cull_lanes<S: Simd>(
        &self,
        simd: S,
        positions: [[F32<S>; 2]; 3],
        whole: u64,
        culling: Culling,
    ) -> (u64, u64, i32x8<S>) {
        let [dx, dy] = each!(axis in [0, 1] => each!(corner in [0, 1, 2] => widen(simd, positions[corner][axis])));
        let area = (dx[1] - dx[0]) * (dy[2] - dy[0]) - (dx[2] - dx[0]) * (dy[1] - dy[0]);
        let shown = match culling {
            Culling::Back => area.simd_lt(0.0),
            Culling::Front => area.simd_gt(0.0),
            Culling::None => area.simd_ne(0.0),
        };
        let shown = shown.to_bitmask() & whole;
        if shown == 0 {
            return (0, 0, i32x8::splat(simd, 0));
        }
        let [columns, rows] = each!((axis, size) in [(0, self.packed.0), (1, self.packed.1)] => {
            let [a, b, c] = each!(corner in [0, 1, 2] => positions[corner][axis]);
            let [first, last] = self.lattice.range_lanes(simd, axis, a.min(b).min(c), a.max(b).max(c));
            [first.max(0.0), last.min(size as f32 - 1.0)]
        });
        let has_samples = columns[0].simd_le(columns[1]) & rows[0].simd_le(rows[1]);
        let [first, last] = each!(end in [0, 1] => {
            each!(range in [columns, rows] => (range[end] * (1.0 / TILE as f32)).to_int::<i32x8<S>>())
        });
        (shown, shown & has_samples.to_bitmask(), TileRange::of_lanes(first, last, self.tiles.columns))
    }

    /// Clips one triangle with the code of the classic (scalar) path, and bins its pieces.
    fn cut(&self, draw: &InstanceDraw<'_>, id: u32, corners: [u32; 3], chunk: &mut Chunk) {
        let vertices = corners.map(|corner| draw.clip_vertex(draw.first_vertex + corner as usize, self.arrays));
        let one = ClipSpaceDraw {
            instance: draw.instance,
            vertices: &vertices,
            triangles: &[[0, 1, 2]],
            first: TriangleId(id),
            may_cross: true,
            divides_by_w: draw.plan.runs(PipelinePart::PerspectiveDivision),
            culling: draw.plan.culling(),
        };
        let mut out = Geometry { depth_scale: self.scale, ..Geometry::default() };
        GeometryStages { settings: self.settings, viewport: self.viewport, out: &mut out, observer: &mut () }
            .finish_draw(&one);
        chunk.rasterized += out.triangles.len();
        for piece in out.triangles.into_vec() {
            let axis = |values: [i32; 3], axis: usize, size: u32| {
                let [a, b, c] = values.map(|v| v as f32);
                let [first, last] = self.lattice.range(axis, a.min(b).min(c), a.max(b).max(c));
                let (first, last) = (first.max(0.0), last.min(size as f32 - 1.0));
                (first <= last).then_some([first as u32 / TILE as u32, last as u32 / TILE as u32])
            };
            let columns = axis(piece.vertices.each_ref().map(|v| v.x), 0, self.packed.0);
            let rows = axis(piece.vertices.each_ref().map(|v| v.y), 1, self.packed.1);
            if let Some(([x0, x1], [y0, y1])) = columns.zip(rows) {
                let key = chunk.next_piece();
                chunk.corners.push(piece.vertices.each_ref().map(|vertex| {
                    let Varyings { normal, uv, color, light, .. } = vertex.varyings;
                    let position = [vertex.x as f32, vertex.y as f32];
                    (
                        PackedVertex::new(position, vertex.depth, vertex.inv_w, light, uv.to_array()),
                        PackedSurface::new(normal, color),
                    )
                }));
                chunk.pieces.push(piece);
                chunk.survivors.push(key, TileRange::new([x0, y0], [x1, y1], self.tiles.columns));
            }
        }
    }
}

/// Returns the positions of the corners of eight triangles, given by the indices of their vertices.
#[inline(always)]
fn corner_positions<S: Simd>(simd: S, vertices: &[PackedVertex], corners: &[[u32; 3]; LANES]) -> [[F32<S>; 2]; 3] {
    let nowhere = PackedVertex::default();
    each!(corner in [0, 1, 2] => {
        let (x, y) = halves(simd, each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => {
            vertices.get(corners[lane][corner] as usize).unwrap_or(&nowhere).position_bits()
        }));
        [x.bitcast::<F32<S>>(), y.bitcast::<F32<S>>()]
    })
}

/// Returns two bit masks: the triangles that need no clipping, and those that must be clipped. Triangles that are
/// entirely outside the frustum are in neither.
#[inline(always)]
fn crossings(outcodes: &[Outcode], triangles: &[[u32; 3]]) -> (u64, u64) {
    let codes = triangles.as_flattened().iter().map(|corner| outcodes[*corner as usize]);
    let (any, all) = codes.fold((Outcode::default(), Outcode::ALL), |(any, all), code| (any | code, all & code));
    if any.is_inside() {
        return (u64::MAX, 0);
    } else if all.is_beyond() {
        return (0, 0);
    }
    let (mut whole, mut cut) = (0, 0);
    for (lane, triangle) in triangles.iter().enumerate() {
        match Outcode::verdict(triangle.map(|corner| outcodes[corner as usize])) {
            ClipVerdict::Rejected => {}
            ClipVerdict::Whole => whole |= 1 << lane,
            ClipVerdict::Cut => cut |= 1 << lane,
        }
    }
    (whole, cut)
}
