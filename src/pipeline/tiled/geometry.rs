//! Vertices of the tiled way: each mesh vertex once, eight at a time, straight to the screen.
//!
//! The arithmetic is that of the classic stages ([`super::super::vertex`], [`super::super::viewport`],
//! [`super::super::depth::DepthScale`]), operation by operation, so every bit agrees.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::math::fixed::SUBPIXELS;
use crate::math::lanes::*;
use crate::math::prefetch::prefetch;
use crate::math::{unit_or, unit_or_lanes};
use crate::pipeline::clip::Plane;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::plan::{DrawPlan, Part};
use crate::pipeline::settings::{Settings, Shading};
use crate::pipeline::shade::to_working_space;
use crate::pipeline::vertex::{ClipVertex, DrawMatrices, Varyings};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Mesh, TriangleId};

/// A vertex on the screen with what most shading reads, in half a cache line. One array, so that lanes can load it whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Vertex {
    pub(super) numbers: [f32; LANES],
}

impl Vertex {
    /// Snapped position in grid steps, x right: a whole number below 2²⁴.
    pub(super) const X: usize = 0;
    /// Snapped position in grid steps, y down.
    pub(super) const Y: usize = 1;
    /// The lower half of the bits of the depth, and after it the upper one.
    const DEPTH: usize = 2;
    /// 1/w.
    pub(super) const INV_W: usize = 4;
    /// Light (Gouraud only).
    pub(super) const LIGHT: usize = 5;
    /// Texture coordinates, v down.
    pub(super) const UV: [usize; 2] = [6, 7];

    pub(super) fn new([x, y]: [f32; 2], depth: f64, inv_w: f32, light: f32, [u, v]: [f32; 2]) -> Self {
        let bits = depth.to_bits();
        let [low, high] = [bits as u32, (bits >> 32) as u32].map(f32::from_bits);
        Self { numbers: [x, y, low, high, inv_w, light, u, v] }
    }

    /// Snapped position in grid steps.
    #[inline(always)]
    pub(super) fn position(&self) -> [f32; 2] {
        [self.numbers[Self::X], self.numbers[Self::Y]]
    }

    /// Depth in [0, 1], before it is quantised.
    #[inline(always)]
    pub(super) fn depth(&self) -> f64 {
        let half = |i: usize| u64::from(self.numbers[Self::DEPTH + i].to_bits());
        f64::from_bits(half(0) | half(1) << 32)
    }

    /// 1/w.
    #[inline(always)]
    pub(super) fn inv_w(&self) -> f32 {
        self.numbers[Self::INV_W]
    }

    /// 1/w, light and texture coordinates of eight vertices.
    #[inline(always)]
    pub(super) fn attributes<S: Simd>(simd: S, vertices: &[&Self; LANES]) -> [F32<S>; 4] {
        transpose_quads(each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => f32x4::from_slice(simd, &vertices[i].numbers[4..])))
    }

    /// Positions and depths of eight vertices.
    #[inline(always)]
    pub(super) fn positions_and_depths<S: Simd>(simd: S, vertices: &[&Self; LANES]) -> ([F32<S>; 2], F64<S>) {
        let rows = each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => f32x4::from_slice(simd, &vertices[i].numbers[..4]));
        let [x, y, low, high] = transpose_quads(rows);
        let (first, last) = low.interleave(high);
        ([x, y], first.bitcast::<f64x4<S>>().combine(last.bitcast::<f64x4<S>>()))
    }
}

/// What further attributes a vertex has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Surface {
    pub(super) numbers: [f32; LANES],
}

impl Surface {
    /// Where the components of the world-space normal stand.
    pub(super) const NORMAL: [usize; 3] = [0, 1, 2];
    /// Where those of the colour stand.
    pub(super) const COLOR: [usize; 3] = [4, 5, 6];

    pub(super) fn new(normal: Vec3, color: Vec3) -> Self {
        let ([nx, ny, nz], [r, g, b]) = (normal.to_array(), color.to_array());
        Self { numbers: [nx, ny, nz, 0.0, r, g, b, 0.0] }
    }

    fn vector(&self, places: [usize; 3]) -> Vec3 {
        Vec3::from_array(places.map(|place| self.numbers[place]))
    }
}

/// One instance that is drawn.
#[derive(Clone, Debug)]
pub(super) struct Draw<'a> {
    /// Its number in the scene.
    pub(super) instance: u32,
    pub(super) mesh: &'a Mesh,
    pub(super) plan: DrawPlan,
    matrices: DrawMatrices,
    /// Identifier of its first triangle.
    pub(super) first: TriangleId,
    /// Position of its first vertex in the arrays of all draws.
    pub(super) first_vertex: usize,
}

impl<'a> Draw<'a> {
    pub(super) fn new(
        instance: u32,
        mesh: &'a Mesh,
        plan: DrawPlan,
        matrices: DrawMatrices,
        first: TriangleId,
        first_vertex: usize,
    ) -> Self {
        Self { instance, mesh, plan, matrices, first, first_vertex }
    }

    /// Whether triangles may cross the frustum.
    pub(super) fn may_cross(&self) -> bool {
        self.plan.runs(Part::Clipping)
    }

    /// The corners of one of its triangles as positions in the arrays of all draws.
    #[inline(always)]
    pub(super) fn corners(&self, id: u32) -> [usize; 3] {
        let [a, b, c] = self.mesh.triangles[(id - self.first.0) as usize];
        [a as usize + self.first_vertex, b as usize + self.first_vertex, c as usize + self.first_vertex]
    }

    /// Asks for the corners of one of its triangles.
    #[inline(always)]
    pub(super) fn prefetch(&self, id: u32) {
        prefetch(&self.mesh.triangles, (id - self.first.0) as usize);
    }

    /// A vertex in clip space as the classic way has it.
    pub(super) fn clip_vertex(&self, index: usize, arrays: &Arrays) -> ClipVertex {
        let position = self.matrices.clip_from_model * self.mesh.positions[index - self.first_vertex].extend(1.0);
        ClipVertex { position, cut_at: None, varyings: self.varyings(index, arrays) }
    }

    /// What comes along with a vertex, as the classic way has it.
    pub(super) fn varyings(&self, index: usize, arrays: &Arrays) -> Varyings {
        let vertex = &arrays.vertices[index];
        let surface = arrays.surfaces.get(index);
        let read = |part, places, otherwise| {
            surface.filter(|_| self.plan.runs(part)).map_or(otherwise, |surface| surface.vector(places))
        };
        Varyings {
            normal: read(Part::Normals, Surface::NORMAL, Vec3::ZERO),
            uv: Vec2::from_array(Vertex::UV.map(|place| vertex.numbers[place])),
            color: read(Part::VertexColors, Surface::COLOR, Vec3::ONE),
            light: vertex.numbers[Vertex::LIGHT],
            source_weights: Vec3::ZERO,
        }
    }
}

/// What all draws write and later stages read, one entry per vertex; memory is kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Arrays {
    pub(super) vertices: Vec<Vertex>,
    /// World-space normals and vertex colours; empty if no draw of the frame reads them in pixels.
    pub(super) surfaces: Vec<Surface>,
    /// On which sides of the frustum a vertex lies; empty if no triangle may cross it.
    pub(super) outcodes: Vec<Outcode>,
}

impl Arrays {
    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<Vertex>()
            + self.surfaces.capacity() * size_of::<Surface>()
            + self.outcodes.capacity() * size_of::<Outcode>()
    }
}

/// Where a vertex lies: a bit for each plane of the frustum that it is beyond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Outcode(u16);

impl Outcode {
    const NOT_FINITE: u16 = 1 << 14;
    const CROSSES: u16 = 1 << 15;
    const PLANES: u16 = (1 << Plane::ALL.len()) - 1;

    fn new(vertex: &ClipVertex, widening: f32) -> Self {
        if !vertex.position.is_finite() {
            return Self(Self::NOT_FINITE | Self::CROSSES);
        }
        let mut bits = 0;
        for (bit, plane) in Plane::ALL.iter().enumerate() {
            if plane.distance(vertex.position, 1.0) < 0.0 {
                bits |= 1 << bit;
                if plane.distance(vertex.position, widening) < 0.0 {
                    bits |= Self::CROSSES;
                }
            }
        }
        Self(bits)
    }

    /// What becomes of a triangle with these corners.
    pub(super) fn verdict(corners: [Self; 3]) -> Crossing {
        let any = corners[0].0 | corners[1].0 | corners[2].0;
        let all = corners[0].0 & corners[1].0 & corners[2].0;
        if any & Self::NOT_FINITE != 0 || all & Self::PLANES != 0 {
            Crossing::Gone
        } else if any & Self::CROSSES != 0 {
            Crossing::Cut
        } else {
            Crossing::Whole
        }
    }
}

/// What the frustum leaves of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// Nothing.
    Gone,
    /// A part.
    Cut,
    /// All of it.
    Whole,
}

/// Vertices of a draw that are transformed together.
struct Batch<'a, 'b> {
    draw: &'b Draw<'a>,
    /// Position of the first in the mesh.
    first: usize,
    vertices: &'b mut [Vertex],
    surfaces: &'b mut [Surface],
    outcodes: &'b mut [Outcode],
}

/// Vertices per batch: enough to be worth handing to a thread, few enough to share out evenly.
const BATCH: usize = 4096;

/// Transforms the vertices of all draws.
pub(super) fn transform(
    draws: &[Draw<'_>],
    settings: &Settings,
    viewport: Viewport,
    scale: &DepthScale,
    widening: f32,
    lanes: Lanes,
    arrays: &mut Arrays,
) {
    let total = draws.last().map_or(0, |draw| draw.first_vertex + draw.mesh.positions.len());
    let needs = |part| if draws.iter().any(|draw| draw.plan.runs(part)) { total } else { 0 };
    arrays.vertices.resize(total, Vertex::default());
    let normals = if settings.shading == Shading::Gouraud { 0 } else { needs(Part::Normals) };
    arrays.surfaces.resize(normals.max(needs(Part::VertexColors)), Surface::default());
    arrays.outcodes.resize(needs(Part::Clipping), Outcode::default());

    let job = Job {
        settings,
        viewport,
        scale: *scale,
        widening,
        light_direction: unit_or(settings.light.direction.as_dvec3(), Vec3::Y),
    };
    batches(draws, arrays).into_par_iter().for_each(|batch| on_lanes!(lanes, simd => job.run(simd, batch)));
}

fn batches<'a, 'b>(draws: &'b [Draw<'a>], arrays: &'b mut Arrays) -> Vec<Batch<'a, 'b>> {
    let Arrays { vertices, surfaces, outcodes } = arrays;
    let (mut vertices, mut surfaces) = (vertices.as_mut_slice(), surfaces.as_mut_slice());
    let mut outcodes = outcodes.as_mut_slice();
    let mut batches = Vec::new();
    for draw in draws {
        let count = draw.mesh.positions.len();
        for first in (0..count).step_by(BATCH) {
            let len = BATCH.min(count - first);
            batches.push(Batch {
                draw,
                first,
                vertices: take_front(&mut vertices, len),
                surfaces: take_front(&mut surfaces, len),
                outcodes: take_front(&mut outcodes, len),
            });
        }
    }
    batches
}

/// Splits off the first `len` entries; none of an array that is not kept.
fn take_front<'b, T>(slice: &mut &'b mut [T], len: usize) -> &'b mut [T] {
    let len = len.min(slice.len());
    let (front, rest) = std::mem::take(slice).split_at_mut(len);
    *slice = rest;
    front
}

/// What is the same for all vertices of a frame.
struct Job<'a> {
    settings: &'a Settings,
    viewport: Viewport,
    scale: DepthScale,
    widening: f32,
    light_direction: Vec3,
}

impl Job<'_> {
    #[inline(always)]
    fn run<S: Simd>(&self, simd: S, batch: Batch<'_, '_>) {
        let Batch { draw, first, vertices, surfaces, outcodes } = batch;
        let mesh = draw.mesh;
        let positions = &mesh.positions[first..first + vertices.len()];
        let (reads_normals, reads_uvs) = (draw.plan.runs(Part::Normals), draw.plan.runs(Part::TextureCoordinates));
        let reads_colors = draw.plan.runs(Part::VertexColors);
        let color_space = self.settings.color_space;
        for (group, out) in vertices.chunks_mut(LANES).enumerate() {
            let (start, end) = (first + group * LANES, first + group * LANES + out.len());
            let normals = if reads_normals { &mesh.normals[start..end] } else { &[] };
            let uvs = if reads_uvs { &mesh.uvs[start..end] } else { &[] };
            let normals = self.vertices(simd, draw, &mesh.positions[start..end], normals, uvs, out);
            if !surfaces.is_empty() {
                for (i, surface) in surfaces[group * LANES..][..out.len()].iter_mut().enumerate() {
                    let color =
                        if reads_colors { to_working_space(mesh.colors[start + i], color_space) } else { Vec3::ONE };
                    *surface = Surface::new(Vec3::from_array(normals.map(|axis| axis[i])), color);
                }
            }
        }
        if draw.may_cross() {
            for (position, outcode) in positions.iter().zip(outcodes) {
                let position = draw.matrices.clip_from_model * position.extend(1.0);
                let vertex = ClipVertex { position, cut_at: None, varyings: Varyings::default() };
                *outcode = Outcode::new(&vertex, self.widening);
            }
        }
    }

    /// Eight vertices, whose world-space unit normals are handed back; zero if none are read.
    #[inline(never)]
    fn vertices<S: Simd>(
        &self,
        simd: S,
        draw: &Draw<'_>,
        positions: &[Vec3],
        normals: &[Vec3],
        uvs: &[Vec2],
        out: &mut [Vertex],
    ) -> [[f32; LANES]; 3] {
        simd.vectorize(
            #[inline(always)]
            || {
                let ([x, y], depth, inv_w) = self.project(simd, draw, positions);
                let mut unit_normals = [[0.0; LANES]; 3];
                let mut light = F32::splat(simd, 0.0);
                if !normals.is_empty() {
                    let [nx, ny, nz] = split(simd, normals);
                    let columns = draw.matrices.world_from_model_normal.to_cols_array_2d();
                    let turned = each!(row in [0, 1, 2] => widen(simd, nx * columns[0][row] + ny * columns[1][row] + nz * columns[2][row]));
                    let normal = unit_or_lanes(simd, turned, Vec3::ZERO);
                    unit_normals = each!(axis in [0, 1, 2] => normal[axis].to_array());
                    if self.settings.shading == Shading::Gouraud {
                        light = lambert_lanes(normal, self.light_direction, self.settings.light.ambient);
                    }
                }
                let mut uv = [[0.0; LANES]; 2];
                for (i, v) in uvs.iter().enumerate().take(LANES) {
                    (uv[0][i], uv[1][i]) = (v.x, v.y);
                }
                let [u, v] = each!(axis in [0, 1] => F32::load_array(simd, uv[axis]));
                let (first, second) = simd.split_f64x8(depth);
                let (low, high) = first.bitcast::<F32<S>>().deinterleave(second.bitcast::<F32<S>>());
                let front = rows_of_quads([x, y, low, high]);
                let back = rows_of_quads([inv_w, light, u, v]);
                for (i, vertex) in out.iter_mut().enumerate().take(LANES) {
                    let (one, other) = vertex.numbers.split_at_mut(LANES / 2);
                    front[i].store_slice(one);
                    back[i].store_slice(other);
                }
                unit_normals
            },
        )
    }

    /// Model space to the screen: snapped position, depth and 1/w.
    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, draw: &Draw<'_>, positions: &[Vec3]) -> ([F32<S>; 2], F64<S>, F32<S>) {
        let [px, py, pz] = split(simd, positions);
        let columns = draw.matrices.clip_from_model.to_cols_array_2d();
        let [x, y, z, w] = each!(row in [0, 1, 2, 3] => {
            px * columns[0][row] + py * columns[1][row] + pz * columns[2][row] + columns[3][row]
        });
        let inv_w = F32::splat(simd, 1.0) / w;
        let Viewport { width, height } = self.viewport;
        let steps = SUBPIXELS as f32;
        let x = ((x * inv_w * 0.5 + 0.5) * width as f32 * steps).round_ties_even();
        let y = ((F32::splat(simd, 0.5) - y * inv_w * 0.5) * height as f32 * steps).round_ties_even();
        ([x, y], self.scale.of_lanes(simd, z, w), inv_w)
    }
}

/// [`lambert`] for as many unit normals as there are lanes.
///
/// [`lambert`]: crate::pipeline::shade::lambert
#[inline(always)]
pub(super) fn lambert_lanes<S: Simd, V: SimdFloat<S> + SimdBase<S, Element = f32>>(
    [x, y, z]: [V; 3],
    direction: Vec3,
    ambient: f32,
) -> V {
    let cosine = x * direction.x + y * direction.y + z * direction.z;
    cosine.max(0.0) * (1.0 - ambient) + ambient
}

/// Eight vectors by component; what is missing is zero.
#[inline(always)]
fn split<S: Simd>(simd: S, vectors: &[Vec3]) -> [F32<S>; 3] {
    let mut parts = [[0.0_f32; LANES]; 3];
    for (i, vector) in vectors.iter().enumerate().take(LANES) {
        for (part, value) in parts.iter_mut().zip(vector.to_array()) {
            part[i] = value;
        }
    }
    each!(axis in [0, 1, 2] => F32::load_array(simd, parts[axis]))
}
