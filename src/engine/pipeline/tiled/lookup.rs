//! Lookup of a frame's triangles by key, in the packed layout of SIMD kernels or in the layout of the classic path.

use super::TiledFrame;
use super::bins::TriangleKey;
use super::geometry::Arrays;
use super::packed::{PackedSurface, PackedVertex};
use super::record::BinEntry;
use super::setup::{self, SnappedVertex};
use super::shader::DrawShader;
use crate::math::fixed::to_pixels;
use crate::pipeline::plan::PipelinePart;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::screen_vertex::{ScreenVertex, relative_inv_w};
use crate::scene::TriangleId;
use crate::scene::material::Transparency;

impl TiledFrame<'_> {
    /// Returns `true` if samples of different draws can always be shaded together.
    pub(super) fn are_all_alike(&self) -> bool {
        self.shader_of_draw.iter().all(|first| *first == 0) && self.shaders.iter().all(|shader| shader.on_lanes)
    }

    #[inline(always)]
    pub(super) fn shader(&self, draw: usize) -> &DrawShader<'_> {
        &self.shaders[draw]
    }

    /// Returns the kind of transparency of a triangle's material.
    #[inline(always)]
    pub(super) fn transparency(&self, entrant: BinEntry) -> Transparency {
        self.shader(entrant.draw as usize).shader.transparency()
    }

    /// Returns the identifier of the scene triangle that a key refers to.
    #[inline(always)]
    pub(super) fn id_of(&self, key: TriangleKey) -> TriangleId {
        match key.as_piece() {
            Some((chunk, index)) => self.chunks[chunk].pieces[index].id,
            None => TriangleId(key.0),
        }
    }

    /// Returns the index of the draw that a triangle belongs to.
    #[inline(always)]
    pub(super) fn draw_of(&self, key: TriangleKey) -> usize {
        let id = self.id_of(key);
        self.draws.partition_point(|draw| draw.first <= id) - 1
    }

    #[inline(always)]
    pub(super) fn is_of_draw(&self, key: TriangleKey, draw: usize) -> bool {
        let first = self.draws[draw].first.0;
        let id = self.id_of(key).0;
        id >= first && id - first < self.draws[draw].mesh.triangles.len() as u32
    }

    #[inline(always)]
    pub(super) fn corners(&self, key: TriangleKey, draw: usize) -> [SnappedVertex; 3] {
        match key.as_piece() {
            Some((chunk, index)) => self.chunks[chunk].pieces[index].vertices.each_ref().map(SnappedVertex::from),
            None => {
                let [a, b, c] = self.draws[draw].corners(key.0);
                let vertices = &self.arrays.vertices;
                [(&vertices[a]).into(), (&vertices[b]).into(), (&vertices[c]).into()]
            }
        }
    }

    #[inline(always)]
    pub(super) fn vertices(&self, key: TriangleKey, draw: usize) -> [&PackedVertex; 3] {
        let [a, b, c] = self.records(key, draw);
        [a.0, b.0, c.0]
    }

    /// Returns the vertices of a triangle in the packed layout of SIMD kernels, with normals and colours if the frame
    /// reads any.
    #[inline(always)]
    pub(super) fn records(&self, key: TriangleKey, draw: usize) -> [(&PackedVertex, Option<&PackedSurface>); 3] {
        match key.as_piece() {
            Some((chunk, index)) => {
                let [a, b, c] = &self.chunks[chunk].corners[index];
                [(&a.0, Some(&a.1)), (&b.0, Some(&b.1)), (&c.0, Some(&c.1))]
            }
            None => {
                let [a, b, c] = self.draws[draw].corners(key.0);
                let Arrays { vertices, surfaces, .. } = self.arrays;
                [(&vertices[a], surfaces.get(a)), (&vertices[b], surfaces.get(b)), (&vertices[c], surfaces.get(c))]
            }
        }
    }

    /// Returns a triangle in the layout of the classic (scalar) path.
    pub(super) fn screen_triangle(&self, key: TriangleKey, draw: usize) -> ScreenTriangle {
        if let Some((chunk, index)) = key.as_piece() {
            return self.chunks[chunk].pieces[index];
        }
        let draw = &self.draws[draw];
        let mut corner = 0;
        let vertices = draw.corners(key.0).map(|index| {
            let vertex = &self.arrays.vertices[index];
            let mut varyings = draw.varyings(index, self.arrays);
            varyings.source_weights = glam::Vec3::AXES[corner];
            corner += 1;
            let [x, y] = vertex.position().map(|step| step as i32);
            ScreenVertex {
                position_px: [to_pixels(x.into()), to_pixels(y.into())],
                x,
                y,
                depth: vertex.depth(),
                inv_w: vertex.inv_w(),
                varyings,
            }
        });
        let corners = vertices.each_ref().map(SnappedVertex::from);
        let area = setup::EdgeFunctions::new(&corners, [0.0; 2]).map_or(0.0, |(_, doubled_area)| doubled_area);
        ScreenTriangle {
            id: TriangleId(key.0),
            instance: draw.instance,
            doubled_area: area,
            depth: self.scale.over(&vertices, area),
            relative_inv_w: if draw.plan.runs(PipelinePart::PerspectiveDivision) {
                relative_inv_w(&vertices)
            } else {
                [1.0; 3]
            },
            vertices,
        }
    }
}
