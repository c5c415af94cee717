//! Vertex processing of tiled execution: transforms each mesh vertex once, eight at a time, from model space to the
//! screen.
//!
//! The arithmetic is the same as in the classic stages ([`super::super::vertex`], [`super::super::viewport`],
//! [`super::super::depth::DepthScale`]), operation by operation, so results are equal bit for bit.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::clusters::VisibleClusters;
use super::outcode::Outcode;
use super::packed::{PackedSurface, PackedVertex};
use crate::math::fixed::SUBPIXELS;
use crate::math::lanes::*;
use crate::math::prefetch::prefetch;
use crate::math::{unit_or, unit_or_lanes};
use crate::pipeline::clip::guard_band_widening;
use crate::pipeline::clip_space::{ClipVertex, Varyings};
use crate::pipeline::depth::DepthScale;
use crate::pipeline::plan::{DrawPlan, PipelinePart};
use crate::pipeline::settings::Settings;
use crate::pipeline::shade::to_working_space;
use crate::pipeline::shading::{Input, lambert};
use crate::pipeline::vertex::DrawMatrices;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Mesh, TriangleId};

/// Draw of one instance of the scene.
#[derive(Clone, Debug)]
pub(super) struct InstanceDraw<'a> {
    /// Index of the instance in the scene.
    pub(super) instance: u32,
    pub(super) mesh: &'a Mesh,
    pub(super) plan: DrawPlan,
    pub(super) matrices: DrawMatrices,
    /// Identifier of the draw's first triangle in the scene.
    pub(super) first: TriangleId,
    /// Index of the draw's first vertex in [`Arrays`].
    pub(super) first_vertex: usize,
    /// Triangles and vertices of the mesh that remain after cluster culling. Only these are processed.
    pub(super) kept: VisibleClusters,
}

impl InstanceDraw<'_> {
    /// Returns `true` if triangles of the draw may cross the boundary of the frustum, so that clipping is needed.
    pub(super) fn may_cross(&self) -> bool {
        self.plan.runs(PipelinePart::Clipping)
    }

    /// Returns the indices of a triangle's vertices in [`Arrays`].
    #[inline(always)]
    pub(super) fn corners(&self, id: u32) -> [usize; 3] {
        let [a, b, c] = self.mesh.triangles[(id - self.first.0) as usize];
        [a as usize + self.first_vertex, b as usize + self.first_vertex, c as usize + self.first_vertex]
    }

    /// Prefetches the vertex indices of a triangle, which is given by its identifier in the scene.
    #[inline(always)]
    pub(super) fn prefetch(&self, id: u32) {
        prefetch(&self.mesh.triangles, (id - self.first.0) as usize);
    }

    /// Returns a vertex in clip space, as the classic (scalar) path computes it.
    pub(super) fn clip_vertex(&self, index: usize, arrays: &Arrays) -> ClipVertex {
        let position = self.matrices.clip_from_model * self.mesh.positions[index - self.first_vertex].extend(1.0);
        ClipVertex { position, cut_at: None, varyings: self.varyings(index, arrays) }
    }

    /// Returns the varyings of a vertex, as the classic (scalar) path computes them.
    pub(super) fn varyings(&self, index: usize, arrays: &Arrays) -> Varyings {
        let vertex = &arrays.vertices[index];
        let surface = arrays.surfaces.get(index);
        let read = |part, places, otherwise| {
            surface.filter(|_| self.plan.runs(part)).map_or(otherwise, |surface| surface.vector(places))
        };
        Varyings {
            normal: read(PipelinePart::Normals, PackedSurface::NORMAL, Vec3::ZERO),
            uv: Vec2::from_array(PackedVertex::UV.map(|place| vertex.numbers[place])),
            color: read(PipelinePart::VertexColors, PackedSurface::COLOR, Vec3::ONE),
            light: vertex.numbers[PackedVertex::LIGHT],
            source_weights: Vec3::ZERO,
        }
    }
}

/// Vertex data of all draws of a frame, one entry per vertex. Entries of vertices that no remaining triangle refers to
/// are meaningless. The memory is reused from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Arrays {
    pub(super) vertices: Vec<PackedVertex>,
    /// World-space normals and vertex colours; empty if no draw of the frame reads them per pixel.
    pub(super) surfaces: Vec<PackedSurface>,
    /// Outcode of each vertex: the frustum planes that it is beyond. Empty if no triangle can need clipping.
    pub(super) outcodes: Vec<Outcode>,
    /// For each draw, whether any of its transformed vertices lies outside the frustum.
    pub(super) leaves_frustum: Vec<bool>,
}

impl Arrays {
    /// Returns the memory use of the arrays in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<PackedVertex>()
            + self.surfaces.capacity() * size_of::<PackedSurface>()
            + self.outcodes.capacity() * size_of::<Outcode>()
            + self.leaves_frustum.capacity()
    }
}

/// Batch of a draw's vertices that one task transforms.
struct VertexBatch<'a, 'b> {
    /// Index of the batch's draw in the frame's list of draws.
    number: usize,
    draw: &'b InstanceDraw<'a>,
    /// Index of the batch's first vertex in the mesh.
    first: usize,
    vertices: &'b mut [PackedVertex],
    surfaces: &'b mut [PackedSurface],
    outcodes: &'b mut [Outcode],
}

/// Number of vertices per batch: enough to outweigh the overhead of a task, and few enough to balance the threads.
const BATCH: usize = 4096;

/// Inputs of vertex processing that are common to all vertices of a frame.
pub(super) struct TransformContext<'a> {
    settings: &'a Settings,
    viewport: Viewport,
    scale: DepthScale,
    /// Factor by which the side planes of the frustum are moved outward to bound the guard band.
    widening: f32,
    light_direction: Vec3,
    /// Whether light is computed at the vertices.
    lights_vertices: bool,
}

impl<'a> TransformContext<'a> {
    pub(super) fn new(settings: &'a Settings, viewport: Viewport, scale: DepthScale) -> Self {
        Self {
            settings,
            viewport,
            scale,
            widening: guard_band_widening(viewport.width, viewport.height),
            light_direction: unit_or(settings.light.direction.as_dvec3(), Vec3::Y),
            lights_vertices: settings.shading.reads(Input::VertexLight),
        }
    }

    /// Transforms the vertices of all draws into `arrays`, on all threads.
    pub(super) fn transform(&self, draws: &[InstanceDraw<'_>], lanes: Lanes, arrays: &mut Arrays) {
        self.resize(draws, arrays);
        let outside: Vec<(usize, bool)> = batches(draws, arrays)
            .into_par_iter()
            .map(|batch| (batch.number, on_lanes!(lanes, simd => self.run(simd, batch))))
            .collect();
        arrays.leaves_frustum.clear();
        arrays.leaves_frustum.resize(draws.len(), false);
        for (draw, leaves) in outside {
            arrays.leaves_frustum[draw] |= leaves;
        }
    }

    /// Resizes the arrays that the draws need, and empties the others.
    fn resize(&self, draws: &[InstanceDraw<'_>], arrays: &mut Arrays) {
        let total = draws.last().map_or(0, |draw| draw.first_vertex + draw.mesh.positions.len());
        let needs = |part| if draws.iter().any(|draw| draw.plan.runs(part)) { total } else { 0 };
        arrays.vertices.resize(total, PackedVertex::default());
        // Normals that only the light of the vertices reads are not stored.
        let stores_normals = !self.lights_vertices || self.settings.shading.reads(Input::Normal);
        let normals = if stores_normals { needs(PipelinePart::Normals) } else { 0 };
        arrays.surfaces.resize(normals.max(needs(PipelinePart::VertexColors)), PackedSurface::default());
        arrays.outcodes.resize(needs(PipelinePart::Clipping), Outcode::default());
    }
}

fn batches<'a, 'b>(draws: &'b [InstanceDraw<'a>], arrays: &'b mut Arrays) -> Vec<VertexBatch<'a, 'b>> {
    let Arrays { vertices, surfaces, outcodes, .. } = arrays;
    let (mut vertices, mut surfaces) = (vertices.as_mut_slice(), surfaces.as_mut_slice());
    let mut outcodes = outcodes.as_mut_slice();
    let mut take =
        |len| (take_front(&mut vertices, len), take_front(&mut surfaces, len), take_front(&mut outcodes, len));
    let mut batches = Vec::new();
    for (number, draw) in draws.iter().enumerate() {
        let mut next = 0;
        for range in draw.kept.vertices.as_slice() {
            take(range.start - next);
            for first in range.clone().step_by(BATCH) {
                let (vertices, surfaces, outcodes) = take(BATCH.min(range.end - first));
                batches.push(VertexBatch { number, draw, first, vertices, surfaces, outcodes });
            }
            next = range.end;
        }
        take(draw.mesh.positions.len() - next);
    }
    batches
}

/// Splits off the first `len` entries of a slice, or all entries if there are fewer.
fn take_front<'b, T>(slice: &mut &'b mut [T], len: usize) -> &'b mut [T] {
    let len = len.min(slice.len());
    let (front, rest) = std::mem::take(slice).split_at_mut(len);
    *slice = rest;
    front
}

/// Mesh data of eight vertices. Attributes that the draw does not read are `None`.
#[derive(Clone, Copy)]
struct VertexGroup<'a> {
    positions: &'a [Vec3; LANES],
    normals: Option<&'a [Vec3; LANES]>,
    uvs: Option<&'a [Vec2; LANES]>,
}

/// Returns eight items, starting at index `first`. If there are fewer, copies them to `padded` and repeats the last
/// one.
#[inline(always)]
fn eight<'a, T: Copy + Default>(items: &'a [T], first: usize, padded: &'a mut [T; LANES]) -> &'a [T; LANES] {
    let items = items.get(first..).unwrap_or_default();
    if let Some(whole) = items.first_chunk() {
        return whole;
    }
    *padded = [items.last().copied().unwrap_or_default(); LANES];
    for (out, item) in padded.iter_mut().zip(items) {
        *out = *item;
    }
    padded
}

/// Copies eight items to the start of `out`, or as many of them as fit.
#[inline(always)]
fn put<T: Copy>(out: &mut [T], items: &[T; LANES]) {
    match out.first_chunk_mut() {
        Some(whole) => *whole = *items,
        None => out.iter_mut().zip(items).for_each(|(out, item)| *out = *item),
    }
}

/// Eight vertices in SIMD layout, one vector per attribute, before they are stored.
struct VertexColumns<S: Simd> {
    position: [F32<S>; 2],
    depth: F64<S>,
    inv_w: F32<S>,
    light: F32<S>,
    /// Texture coordinates: u and v of each vertex as the bits of one f64.
    uv: F64<S>,
}

impl<S: Simd> VertexColumns<S> {
    #[inline(always)]
    fn store(self, simd: S, out: &mut [PackedVertex; LANES]) {
        let Self { position: [x, y], depth, inv_w, light, uv } = self;
        let (first, last) = pairs(simd, x, y).interleave(depth);
        let (other_first, other_last) = pairs(simd, inv_w, light).interleave(uv);
        let halves = each!(half in [first, last, other_first, other_last] => quads(simd, half));
        for i in 0..LANES {
            let (one, other) = out[i].numbers.split_at_mut(LANES / 2);
            halves[i / 4][i % 4].store_slice(one);
            halves[2 + i / 4][i % 4].store_slice(other);
        }
    }
}

/// Interleaves two vectors of floats into pairs, each as the bits of an f64.
#[inline(always)]
fn pairs<S: Simd>(simd: S, a: F32<S>, b: F32<S>) -> F64<S> {
    let (first, last) = a.interleave(b);
    simd.combine_f64x4(first.bitcast(), last.bitcast())
}

/// Reinterprets eight doubles as four vectors of four floats.
#[inline(always)]
fn quads<S: Simd>(simd: S, doubles: F64<S>) -> [f32x4<S>; 4] {
    let (first, last) = simd.split_f64x8(doubles);
    let ((a, b), (c, d)) = (simd.split_f64x4(first), simd.split_f64x4(last));
    [a.bitcast(), b.bitcast(), c.bitcast(), d.bitcast()]
}

impl TransformContext<'_> {
    /// Transforms a batch of vertices. Returns `true` if any of them lies outside the frustum.
    #[inline(always)]
    fn run<S: Simd>(&self, simd: S, batch: VertexBatch<'_, '_>) -> bool {
        let VertexBatch { draw, first, vertices, surfaces, outcodes, .. } = batch;
        let mesh = draw.mesh;
        let (reads_normals, reads_uvs) =
            (draw.plan.runs(PipelinePart::Normals), draw.plan.runs(PipelinePart::TextureCoordinates));
        let mut leaves_frustum = false;
        let (mut positions, mut normals, mut uvs) = Default::default();
        for start in (0..vertices.len()).step_by(LANES) {
            let from = first + start;
            let mut group = VertexGroup {
                positions: eight(&mesh.positions, from, &mut positions),
                normals: if reads_normals { Some(eight(&mesh.normals, from, &mut normals)) } else { None },
                uvs: if reads_uvs { Some(eight(&mesh.uvs, from, &mut uvs)) } else { None },
            };
            let moved;
            if let (Some(uvs), Some([scale, offset])) = (group.uvs, draw.plan.uv_transform()) {
                moved = uvs.map(|uv| uv * scale + offset);
                group.uvs = Some(&moved);
            }
            let (columns, clip, normals) = self.vertices(simd, draw, group);
            let out = &mut vertices[start..];
            if let Some(whole) = out.first_chunk_mut() {
                columns.store(simd, whole);
            } else {
                let mut padded = [PackedVertex::default(); LANES];
                columns.store(simd, &mut padded);
                put(out, &padded);
            }
            if draw.may_cross() {
                let (codes, any) = Outcode::of_lanes(simd, clip, self.widening);
                put(&mut outcodes[start..], &codes);
                leaves_frustum |= any;
            }
            if !surfaces.is_empty() {
                let normals = each!(axis in [0, 1, 2] => normals[axis].to_array());
                let len = LANES.min(surfaces.len() - start);
                self.surfaces(draw, from, normals, &mut surfaces[start..start + len]);
            }
        }
        leaves_frustum
    }

    /// Stores the given world-space normals and the colours of up to eight vertices, starting at vertex `first` of the
    /// mesh.
    fn surfaces(&self, draw: &InstanceDraw<'_>, first: usize, normals: [[f32; LANES]; 3], out: &mut [PackedSurface]) {
        let reads_colors = draw.plan.runs(PipelinePart::VertexColors);
        for (i, surface) in out.iter_mut().enumerate() {
            let color = if reads_colors {
                to_working_space(draw.mesh.colors[first + i], self.settings.color_space)
            } else {
                Vec3::ONE
            };
            *surface = PackedSurface::new(Vec3::from_array(normals.map(|axis| axis[i])), color);
        }
    }

    /// Transforms eight vertices. Returns them with their clip-space positions and world-space unit normals. The
    /// normals are zero if none are read.
    #[inline(always)]
    fn vertices<S: Simd>(
        &self,
        simd: S,
        draw: &InstanceDraw<'_>,
        group: VertexGroup<'_>,
    ) -> (VertexColumns<S>, [F32<S>; 4], [F32<S>; 3]) {
        let zero = F32::splat(simd, 0.0);
        let clip = clip_positions(simd, draw, group.positions);
        let (position, depth, inv_w) = self.project(simd, clip);
        let (mut normal, mut light) = ([zero; 3], zero);
        if let Some(normals) = group.normals {
            let [x, y, z] = split(simd, normals);
            let columns = draw.matrices.world_from_model_normal.to_cols_array_2d();
            let turned =
                each!(row in [0, 1, 2] => widen(simd, x * columns[0][row] + y * columns[1][row] + z * columns[2][row]));
            normal = unit_or_lanes(simd, turned, Vec3::ZERO);
            if self.lights_vertices {
                let direction = self.light_direction.to_array();
                let direction = each!(axis in [0, 1, 2] => F32::splat(simd, direction[axis]));
                light = lambert(&normal, &direction, F32::splat(simd, self.settings.light.ambient));
            }
        }
        let mut uv = F64::splat(simd, 0.0);
        if let Some(uvs) = group.uvs {
            let [a, b, c, d] = each!(i in [0, 2, 4, 6] => {
                f32x4::load_array(simd, [uvs[i].x, uvs[i].y, uvs[i + 1].x, uvs[i + 1].y])
            });
            uv = simd.combine_f64x4(a.combine(b).bitcast(), c.combine(d).bitcast());
        }
        (VertexColumns { position, depth, inv_w, light, uv }, clip, normal)
    }

    /// Projects clip-space positions to the screen. Returns snapped positions in steps of 1/256 px, depths and 1/w.
    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, [x, y, z, w]: [F32<S>; 4]) -> ([F32<S>; 2], F64<S>, F32<S>) {
        let inv_w = F32::splat(simd, 1.0) / w;
        // The number of steps per pixel is a power of two, so the product is not rounded.
        let Viewport { width, height } = self.viewport;
        let [width, height] = [width, height].map(|pixels| pixels as f32 * SUBPIXELS as f32);
        let x = ((x * inv_w * 0.5 + 0.5) * width).round_ties_even();
        let y = ((F32::splat(simd, 0.5) - y * inv_w * 0.5) * height).round_ties_even();
        ([x, y], self.scale.of_lanes(simd, z, w), inv_w)
    }
}

/// Transforms eight positions from model space to clip space. Returns x, y, z and w.
#[inline(always)]
fn clip_positions<S: Simd>(simd: S, draw: &InstanceDraw<'_>, positions: &[Vec3; LANES]) -> [F32<S>; 4] {
    let [x, y, z] = split(simd, positions);
    let columns = draw.matrices.clip_from_model.to_cols_array_2d();
    each!(row in [0, 1, 2, 3] => x * columns[0][row] + y * columns[1][row] + z * columns[2][row] + columns[3][row])
}

/// Splits eight vectors into their x, y and z components.
#[inline(always)]
fn split<S: Simd>(simd: S, vectors: &[Vec3; LANES]) -> [F32<S>; 3] {
    // The fourth float is ignored. In all arrays except the last, it is the one after z in memory, so that one
    // instruction loads all four.
    let rows = each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => {
        let Vec3 { x, y, z } = vectors[i];
        f32x4::load_array(simd, [x, y, z, vectors[(i + 1) % LANES].x])
    });
    let [x, y, z, _] = transpose_quads(rows);
    [x, y, z]
}
